"""How large causes could be, in a person's words, where nothing was found."""

from __future__ import annotations

from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.report.cause_words import meanings_of, plain_name
from stickslip.diagnosis.report.parameters import short
from stickslip.facts.causes import CAUSES, SizeWords

_LISTED = 4
"""Limits that the first screen names. Chosen: the sharpest ones; a table has all."""


def limits_in_words(found: Findings) -> list[str]:
    """The sharpest upper limits, each with the name of its cause and in a person's unit.

    The sharpest are the smallest beside the size that would not surprise.
    """
    entries = [
        (found.bounds[parameter.name] / parameter.scale, cause.name, parameter)
        for cause in found.problem.causes
        for parameter in cause.parameters
        if parameter.name in found.bounds and not parameter.downward and not parameter.shape
    ]
    said = []
    for _, name, parameter in sorted(entries, key=lambda each: each[0])[:_LISTED]:
        known = CAUSES.get(name) if parameter.name.startswith("effects.") else None
        unit = "" if parameter.unit == "-" else parameter.unit
        words = SizeWords(unit) if known is None else known.sizes[parameter.name.split(".")[-1]]
        size = found.bounds[parameter.name] * (1.0 if known is None else words.factor)
        title = plain_name(name, meanings_of(found))
        of = f" ({short(parameter.name)})" if known is not None and len(known.sizes) > 1 else ""
        said.append(f"{title}{of} {size:.2g} {words.unit}".rstrip())
    return said
