"""The one dictionary of a report: every number of the page, of report.json and of ``--json``."""

from __future__ import annotations

from collections.abc import Mapping
from html import unescape
from typing import Any, TypedDict, get_args, get_origin, get_type_hints

from stickslip._util.html import VERSION, page_text
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.report.sections import (
    data,
    evidence,
    law,
    misfit,
    next_step,
    size,
    untold,
    verdict,
)  # fmt: skip
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.words import Vocabulary, Words

ALWAYS, FITTED = (verdict, next_step, data), (size, evidence, law, misfit, untold)
"""Sections of any diagnosis, and those of fitted models."""


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
    """Of the random draws."""
    version: str
    """Of this package."""
    sides: dict[str, dict[str, float]]
    """Of a comparison alone: the parameters of the model `before` and `after`, by name."""
    paired: bool
    """Of a comparison alone: whether differences of readings at equal settings were fitted."""


def numbers_of(facts: Facts, title: str | None = None) -> dict[str, Any]:
    """All numbers, by the keys of the reference, in SI units unless a text says its unit.

    Where no model was fitted, those of fitted models are empty.
    """
    numbers: dict[str, Any] = {}
    for section in ALWAYS:
        numbers |= section.numbers(facts)
    for section in FITTED:
        numbers |= section.numbers(facts) if facts.fitted else _nothing(section.Numbers)
    numbers |= _whole(facts, title)
    numbers["headline"] = summary_text(numbers, facts.problem.words).split("\n", 1)[0]
    return numbers


def _nothing(numbers: type) -> dict[str, Any]:
    """Empty lists and tables, and null where a number may be."""
    hints = get_type_hints(numbers).items()
    return {key: None if type(None) in get_args(of) else get_origin(of)() for key, of in hints}


def _whole(facts: Facts, title: str | None) -> Numbers:
    source = facts.measurement
    whole: Numbers = {
        "name": title or ("Diagnosis" if source is None else source.name),
        "offered": len(facts.findings.models.offered), "of_measurement": source is not None,
        "seed": facts.findings.seed, "version": VERSION,
    }  # fmt: skip
    sides = facts.rivals.sides(facts.best.params["value"].to_dict() if facts.fitted else {})
    if sides:
        whole["sides"] = sides
        whole["paired"] = any(table.less is not None for table in facts.problem.tables)
    return whole


def summary_text(numbers: Mapping[str, Any], vocabulary: Vocabulary) -> str:
    """The verdict and what it rests on, as the command and `Diagnosis.summary` print it."""
    words = Words(vocabulary)
    page = page_text("diagnosis/report/summary.txt.j2", r=numbers, a=amounts, w=words)
    return "\n".join(line.rstrip() for line in unescape(page).strip().split("\n"))
