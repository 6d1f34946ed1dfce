"""The one dictionary of a report: every number of the page, of report.json and of ``--json``."""

from __future__ import annotations

from collections.abc import Mapping
from html import unescape
from typing import Any, get_args, get_origin, get_type_hints

from stickslip._util.html import page_text
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.report.sections import data, evidence, misfit, size, todo, untold, verdict
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.words import Vocabulary, Words

ALWAYS, FITTED = (verdict, todo, data), (size, evidence, misfit, untold)
"""Sections of any diagnosis, and those of fitted models."""


def numbers_of(facts: Facts, title: str | None = None) -> dict[str, Any]:
    """All numbers, by the keys of the reference, in SI units unless a text says its unit.

    Where no model was fitted, those of fitted models are empty.
    """
    numbers: dict[str, Any] = {}
    for section in ALWAYS:
        numbers |= section.numbers(facts)
    for section in FITTED:
        numbers |= section.numbers(facts) if facts.fitted else _nothing(section.Numbers)
    numbers["name"] = title or numbers["name"]
    numbers["headline"] = summary_text(numbers, facts.problem.words).split("\n", 1)[0]
    return numbers


def _nothing(numbers: type) -> dict[str, Any]:
    """Empty lists and tables, and null where a number may be."""
    hints = get_type_hints(numbers).items()
    return {key: None if type(None) in get_args(of) else get_origin(of)() for key, of in hints}


def summary_text(numbers: Mapping[str, Any], vocabulary: Vocabulary) -> str:
    """The verdict and what it rests on, as the command and `Diagnosis.summary` print it."""
    words = Words(vocabulary)
    page = page_text("diagnosis/report/summary.txt.j2", r=numbers, a=amounts, w=words)
    return "\n".join(line.rstrip() for line in unescape(page).strip().split("\n"))
