"""Drives that would tell the candidates of a diagnosis apart, and tables of them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pandas import DataFrame

from stickslip._util.arrays import Array, are_equal
from stickslip._util.columns import Line, index_labels
from stickslip._util.messages import shown
from stickslip._util.note import Note
from stickslip.diagnosis.decision.experiments import (
    DECISIVE,
    PROPOSED,
    TRIALS,
    Experiment,
    expected_chi2,
)
from stickslip.diagnosis.terms.cause import CauseNote
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import Value, find_key, in_allowed_case
from stickslip.scenario.scenario import Scenario
from stickslip.walker.library import known
from stickslip.walker.read_velocity import NOT_SETTINGS, with_index_columns
from stickslip.walker.reading import Measurement
from stickslip.walker.velocity import settings_of

Drive = Mapping[str, Value]
"""Settings of ``[drive]`` by dotted key."""

CHOICES: dict[str, tuple[Value, ...]] = {
    "drive.mode": ("IPP", "OPP"),
    "drive.direction": ("+x", "-x"),
    "drive.frequency": (0.5, 1.0, 1.5),
    "drive.peak": (0.7, 1.0, 1.2),
    "drive.hold": (0.7, 1.0, 1.3),
    "drive.edge": ("rise", "fall"),
}
"""Settings that proposals vary: words as they are, numbers as multiples of the middle of what was
measured. Chosen."""

_ROUNDING = 0.005  # part of a number by which three digits may change it


def proposals(conditions: Sequence[Drive]) -> list[dict[str, Value]]:
    """Variations of the measured drives, none of which was measured; none without any."""
    if not conditions:
        return []

    def middle(drives: Sequence[Drive], key: str) -> float:
        return float(np.median([float(drive[key]) for drive in drives]))

    by_mode: dict[Value, dict[str, Value]] = {}
    for mode in CHOICES["drive.mode"]:
        # A mode that was not measured has what the others had.
        mine = [drive for drive in conditions if drive["drive.mode"] == mode] or conditions
        by_mode[mode] = {**mine[0], **{k: middle(mine, k) for k in ("drive.base", "drive.hold")}}
    frequency, peak = middle(conditions, "drive.frequency"), middle(conditions, "drive.peak")
    drives: dict[tuple[Value, ...], dict[str, Value]] = {}
    for mode, direction, pace, field, clamp, edge in itertools.product(*CHOICES.values()):
        drive = by_mode[mode]
        drive = {
            **drive,
            "drive.mode": mode,
            "drive.direction": direction,
            "drive.edge": edge,
            "drive.frequency": _rounded(frequency * float(pace)),
            "drive.peak": max(_rounded(peak * float(field)), float(drive["drive.base"])),
            "drive.hold": _rounded(float(drive["drive.hold"]) * float(clamp)),
        }
        if not any(_alike(drive, other) for other in conditions):
            drives[tuple(drive[key] for key in CHOICES)] = drive
    return list(drives.values())


def _rounded(value: float) -> float:
    """A setting to three digits, as a person would state it."""
    return float(f"{value:.3g}")


def _alike(one: Drive, other: Drive) -> bool:
    """Whether two drives are the same but for rounding."""
    return all(
        are_equal(value, float(other[key]), _ROUNDING)
        if isinstance(value, float)
        else value == other[key]
        for key, value in one.items()
    )


def choose(
    drives: Sequence[Drive],
    names: Sequence[str],
    level: Array,
    covariance: Array,
    noise_variance: Array,
    *,
    count: int = PROPOSED,
    pairs: Sequence[tuple[int, int]] | None = None,
) -> list[Experiment]:
    """The drives that tell the candidates apart best together, each of another kind.

    Of a drive and its mirror image one is enough. `drives` are those of `proposals`; `names` are of
    the candidates, as they are said. The arrays are of velocities, m/s, as for `expected_chi2`.
    `count` is the most experiments. Without `pairs` all candidates are told apart from all.
    """
    pairs = list(itertools.combinations(range(len(names)), 2)) if pairs is None else list(pairs)
    if not pairs or not drives:
        return []
    kinds = [[d[f"drive.{key}"] for key in ("mode", "direction", "frequency")] for d in drives]
    together = expected_chi2(level, covariance, noise_variance, pairs)
    reached = np.zeros((len(pairs), 1))
    left = np.ones(len(drives), dtype=bool)
    taken: list[int] = []
    chosen = []
    while len(taken) < count:
        # First those that are not told apart by what is chosen already.
        undecided = reached <= DECISIVE if np.any(reached <= DECISIVE) else reached >= 0.0
        gains = np.where(undecided & left, together - reached, 0.0)
        pair, best = map(int, np.unravel_index(np.argmax(gains), gains.shape))
        if not gains[pair, best] > 0.0:
            break
        first, second = (names[k] for k in pairs[pair])
        predictions = {
            name: {"velocity": float(v), "sd": math.sqrt(float(s))}
            for name, v, s in zip(names, level[:, best], covariance[:, best, best], strict=True)
        }
        settings = {key.removeprefix("drive."): value for key, value in drives[best].items()}
        chi2 = float(gains[pair, best])
        why = _why(first, second, chi2, bool(taken))
        chosen.append(Experiment(settings, drive_in_words(drives[best]), why, chi2, predictions))
        mirrored = np.all(np.isclose(level, -level[:, [best]], rtol=1e-6, atol=0.0), axis=0)
        left &= ~mirrored & [kind != kinds[best] for kind in kinds]
        taken.append(best)
        reached = together[:, [best]]
        together = expected_chi2(level, covariance, noise_variance, pairs, taken)
    return chosen


def drive_in_words(drive: Drive) -> str:
    """A drive by the settings that proposals vary."""
    settings = settings_of([drive])
    words = [settings.text(key.removeprefix("drive."), drive[key]) for key in CHOICES]
    return ", ".join(words).replace("edge ", "sudden edge: ")


def _why(first: str, second: str, chi2: float, is_later: bool) -> Note:
    decides = chi2 > DECISIVE
    little, needed = ("", "would be enough") if decides else (" too little", "would be needed")
    apart, beside = math.sqrt(chi2), ", beside the drives before it" if is_later else ""
    text = (
        f"It separates {{}} from {{}}{little}: with {TRIALS} trials their predictions lie "
        f"{apart:.1f} standard errors apart{beside}; {math.sqrt(DECISIVE):g} {needed}."
    )
    code = "separates" if decides else "separates-too-little"
    return CauseNote(code, text, (first, second), apart)


def advice(names: Mapping[str, str], experiments: Sequence[Experiment]) -> list[Note]:
    """Advice beside the drive, and whether no drive tells the candidates apart.

    `names` are the causes of a set: how each is said, by its name.
    """
    notes = []
    if experiments and not any(experiment.decides for experiment in experiments):
        text = f"No drive that was tried tells the candidates apart with {TRIALS} trials."
        notes.append(Note("none-separates", text))
    rows = known()["causes"]
    shown_by = {name: rows.get(name, {}).get("shown_by") for name in names}
    for look, text in known()["looks"].items():
        seen = [word for name, word in names.items() if shown_by[name] == look]
        if 0 < len(seen) < len(names):
            notes.append(Note(f"look-at-{look}", f"{text}. This shows {' and '.join(seen)} alone."))
    return notes


# ---------------------------------------------------------------- tables of drives
def changed_settings(measurement: Measurement) -> set[str]:
    """Dotted keys in which a measured drive differs from the scenario."""
    return {
        key
        for data in measurement.velocity
        for drive in data.conditions
        for key, value in drive.items()
        if value != measurement.scenario.get(key)
    }


def setting_columns(measurement: Measurement) -> list[str]:
    """Bare names of the settings of a table of drives to measure next.

    Those that proposals vary, and those in which a measured drive differs from the scenario. What
    is proposed after further trials has the same ones.
    """
    changed = changed_settings(measurement).difference(CHOICES)
    return [key.removeprefix("drive.") for key in [*CHOICES, *sorted(changed)]]


def trial_table(
    measurement: Measurement, experiments: Sequence[Experiment], trials: int
) -> DataFrame:
    """A row for each trial of each experiment, with an empty column `velocity`.

    With a block that no earlier trial has, and an empty `order`, where the measured ones have such.
    """
    columns, tables = setting_columns(measurement), measurement.velocity
    beside: dict[str, Any] = {}
    if any(np.any(table.block >= 0) for table in tables):
        # All rounds may stand in one table; the number of conditions grows with each.
        beside["block"] = f"after-{sum(len(table.conditions) for table in tables)}"
    if any(np.any(np.isfinite(table.order)) for table in tables):
        beside["order"] = math.nan
    rows = [
        {**{name: experiment.drive[name] for name in columns}, "trial": trial, **beside}
        for experiment in experiments
        for trial in range(1, trials + 1)
    ]
    table = DataFrame(rows, columns=[*columns, "trial", *beside])
    return table.assign(velocity=math.nan)


def prediction_table(measurement: Measurement, experiments: Sequence[Experiment]) -> DataFrame:
    """Predictions of each experiment, counted from 1, by each candidate: `velocity`, `sd`, m/s."""
    rows, columns = [], setting_columns(measurement)
    for number, experiment in enumerate(experiments, start=1):
        settings = {name: experiment.drive[name] for name in columns}
        for candidate, predicted in experiment.predictions.items():
            rows.append({"experiment": number, **settings, "candidate": candidate, **predicted})
    return DataFrame(rows)


def drive_settings(given: Any, scenario: Scenario) -> list[dict[str, Value]]:
    """Drives that a person writes, by dotted key in SI units.

    `given` is a DataFrame or a list of dicts; every row is a change of `scenario`. Names are dotted
    keys or bare, such as ``frequency``; words are in any case. Columns of measured trials, such as
    ``trial`` and ``velocity``, are passed over. A ScenarioError is raised, with the row (its index
    label, or its number from 0), if a name is no key of ``[drive]`` or a value is not allowed.
    """
    labels: Sequence[Line] = range(len(given)) if isinstance(given, Sequence) else ()
    rows = given
    if isinstance(given, DataFrame):
        table = with_index_columns(given)
        labels, rows = index_labels(table), table.to_dict("records")
    if not isinstance(rows, Sequence) or not all(isinstance(row, Mapping) for row in rows):
        allowed = "allowed is a DataFrame or a list of dicts of settings"
        raise ScenarioError(f"conditions = {shown(given)}: {allowed}")
    if not rows:
        raise ScenarioError("conditions: there is no row; allowed is one or more")
    drives = []
    for label, row in zip(labels, rows, strict=True):
        drive: dict[str, Value] = {}
        with prefixed(f"conditions: row {label}"):
            for name, value in row.items():
                if name not in (*NOT_SETTINGS, "standard_error", "velocity_sd"):
                    key = find_key(f"drive.{str(name).removeprefix('drive.')}", value)
                    # A column of a table has numpy's numbers.
                    value = value.item() if hasattr(value, "item") else value
                    is_word = isinstance(value, str)
                    drive[key.name] = in_allowed_case(key, value.strip()) if is_word else value
            scenario.replace(drive)
        drives.append(drive)
    return drives
