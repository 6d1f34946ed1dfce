"""The readings, their errors, notes on them, and what was left out."""

from __future__ import annotations

from typing import Any, TypedDict

import numpy as np

from stickslip._util.columns import SAID_FIRST
from stickslip._util.html import VERSION
from stickslip._util.note import Note
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.terms import amounts

ROUTINE = (
    "no-block-column", "errors-correlated", "noise-repeats", "noise-free-fit", "frame-noise",
    "frames-correlated",
)  # fmt: skip
"""Codes of notes that nearly every measurement has: the page has them last, the command never."""


class Numbers(TypedDict, total=False):
    name: str
    """Title of the report."""
    headline: str
    """The verdict in a sentence."""
    offered: int
    """How many causes were tried."""
    of_measurement: bool
    """Whether the data are a measurement file."""
    seed: int
    """Seed of the random draws."""
    version: str
    """Version of this package."""
    sides: dict[str, dict[str, float]]
    """For a comparison alone: parameters of the model `before` and `after`, by name."""
    paired: bool
    """For a comparison alone: whether differences at equal settings were fitted."""
    notes: list[dict[str, Any]]
    """Further notes for a reader, `{code, text, routine}`: those that nearly every report
    has (`routine`) come last."""
    left_out: list[str]
    """Sentences on what was not used, and why."""
    gaps: list[str]
    """Sentences on columns of which more than a twentieth are gaps; a summary begins with them."""
    conditions: list[dict[str, Any]]
    """Each reading: `table`, `number`, `settings`, `unit`, `reading`, `sd` (null where it is not
    known), `readings` (how many its mean is of), and what the `stated`, the `recalibrated` and the
    `extended` model predict."""
    channels: dict[str, dict[str, Any]]
    """Each table: `title`, `unit`, how many `readings` and `conditions`, its `errors` (`s0`, `rho`,
    `phi`, `shift`, `gain`) with their `dof`, `median_sd` (null where it is not known), the `digits`
    of a reading, `chi2_per_condition` of both models, `notes`."""


def numbers(facts: Facts) -> Numbers:
    source = facts.measurement
    of_all: list[Any] = [] if source is None else [*source.left_out]
    lost = [*((note, str(note)) for note in of_all), *_of_tables(facts, "left_out")]
    told = [*((note, str(note)) for note in facts.notes), *_of_tables(facts, "notes")]
    notes = [{"code": note.code, "text": text, "routine": note.code in ROUTINE}
             for note, text in told if note.code not in SAID_FIRST]  # fmt: skip
    sides = facts.rivals.sides(facts.best.params["value"].to_dict() if facts.fitted else {})
    paired = any(table.less is not None for table in facts.problem.tables)
    compared: Numbers = {"sides": sides, "paired": paired} if sides else {}
    return {
        "name": "Diagnosis" if source is None else source.name,
        "offered": sum(cause.listed for cause in facts.findings.models.offered),
        "of_measurement": source is not None, "seed": facts.findings.seed, "version": VERSION,
        "notes": sorted(notes, key=lambda row: bool(row["routine"])),
        "left_out": [text for note, text in lost if note.code not in SAID_FIRST],
        "gaps": [text for note, text in (*lost, *told) if note.code in SAID_FIRST],
        "conditions": _conditions(facts), "channels": _channels(facts), **compared,
    }  # fmt: skip


def _of_tables(facts: Facts, what: str) -> list[tuple[Note, str]]:
    """Notes of the tables and their texts; of several tables, or of no curve, with its name."""
    several = len(facts.problem.tables) > 1
    return [(note, f"{one.title}: {note}" if several or not one.table.drawable else str(note))
            for one in facts.problem.parts for note in getattr(one.table, what)]  # fmt: skip


def _conditions(facts: Facts) -> list[dict[str, Any]]:
    """Each reading with its settings and the predictions of the models."""
    problem, models, rows = facts.problem, facts.at_readings, []
    for table, part, _, _, errors in problem.parts:
        settings, counts = table.named_settings, np.bincount(table.condition)
        for i, row in enumerate(range(part.start, part.stop)):
            rows.append({
                **facts.places[row],
                "settings": {name: values[i] for name, (values, _) in settings.items()},
                "unit": table.unit_of(i), "reading": float(problem.y[row]),
                "sd": float(problem.sd[row]) if errors.known else None,
                "readings": int(counts[i]),
                **{name: float(of[row]) for name, of in models.items()},
            })  # fmt: skip
    return rows


def _channels(facts: Facts) -> dict[str, dict[str, Any]]:
    """Each table: its readings, its errors, and how far both models miss it."""
    problem, channels = facts.problem, {}
    chi2 = {name: problem.chi2_of_tables(model.fit.residual[None, :])[:, 0].tolist()
            for name, model in facts.candidates.items()}  # fmt: skip
    for k, (table, part, name, title, errors) in enumerate(problem.parts):
        count = len(table.mean)
        channels[name] = {
            "title": title, "readings": len(table.y),
            "unit": table.unit if table.drawable else None,
            "conditions": count, "errors": dict(errors.sizes), "dof": errors.dof,
            "median_sd": float(np.median(problem.sd[part])) if errors.known else None,
            "digits": amounts.digits_for(problem.y[part].tolist()),
            "chi2_per_condition": {model: one[k] / count for model, one in chi2.items()},
            "notes": [str(note) for note in table.notes],
        }  # fmt: skip
    return channels
