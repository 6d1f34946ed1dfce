"""How large causes could be, in a person's words, where nothing was found."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.diagnosis.inference.evidence import unseen_causes
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.upper_bounds import BOUND
from stickslip.diagnosis.model.problem import Cause, CauseParameter
from stickslip.diagnosis.report.cause_words import meanings_of, plain_name, words_of
from stickslip.diagnosis.report.parameters import short
from stickslip.facts import Code, Fact
from stickslip.facts.causes import SizeWords

_LISTED = 4
"""Limits that the first screen names. Chosen: the sharpest ones; a table has all."""

_AT_END = 0.999
"""Share of the range that was searched from which on a limit is its end, and thus none."""


@dataclass(frozen=True)
class _Limit:
    """An upper limit: its size beside the one that would not surprise, and how it is told."""

    relative: float
    name: str
    size: str


def limits_in_words(found: Findings) -> tuple[Fact, ...]:
    """The sharpest upper limits, the widest one, and of how many causes there is none.

    Each has the name of its cause and a person's unit. The sharpest are the smallest beside the
    size that would not surprise.
    """
    limits, unlimited = [], set(unseen_causes(found))
    for cause in found.problem.causes:
        for parameter in cause.parameters:
            if parameter.name not in found.bounds or parameter.downward or parameter.shape:
                continue
            bound = found.bounds[parameter.name]
            if cause.name in unlimited or bound >= _AT_END * _range(parameter):
                unlimited.add(cause.name)
            else:
                limits.append(_limit(found, cause, parameter))
    limits.sort(key=lambda each: each.relative)
    said = []
    if limits:
        sharpest = [f"{each.name} below {each.size}" for each in limits[:_LISTED]]
        said.append(Fact(Code.SIZE_LIMITS, {"percent": 100.0 * BOUND, "limits": sharpest}))
    if len(limits) > _LISTED:
        widest = {"name": limits[-1].name, "size": limits[-1].size}
        said.append(Fact(Code.SIZE_HIDDEN, widest))
    if unlimited:
        counts = {"count": len(unlimited), "causes": len(found.problem.causes)}
        said.append(Fact(Code.SIZE_UNLIMITED, counts))
    return tuple(said)


def _range(parameter: CauseParameter) -> float:
    """The longer way from the absent value to an end of the range that is searched."""
    return max(abs(end - parameter.absent) for end in (parameter.low, parameter.high))


def _limit(found: Findings, cause: Cause, parameter: CauseParameter) -> _Limit:
    known = words_of(cause)
    unit = "" if parameter.unit == "-" else parameter.unit
    words = SizeWords(unit) if known is None else known.sizes[parameter.name.split(".")[-1]]
    bound = found.bounds[parameter.name]
    size = bound * (1.0 if known is None else words.factor)
    of = f" ({short(parameter.name)})" if known is not None and len(known.sizes) > 1 else ""
    return _Limit(
        bound / parameter.scale,
        plain_name(cause.name, meanings_of(found)) + of,
        f"{size:.2g} {words.unit}".rstrip(),
    )
