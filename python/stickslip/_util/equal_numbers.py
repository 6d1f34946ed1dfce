"""When two numbers are the same setting: 1/0.04 and 25 differ in the last bit alone."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable

RELATIVE = 1e-6
"""Part of a number within which another one is the same setting. Chosen: finer than any apparatus
is set, and wider than the rounding of a table in seven digits."""

ABSOLUTE = 1e-12
"""The same of a number near 0, in its SI unit: what sums that should be 0 leave."""


def are_equal(
    one: float, other: float, relative: float = RELATIVE, absolute: float = ABSOLUTE
) -> bool:
    """Whether two numbers are the same setting."""
    return math.isclose(one, other, rel_tol=relative, abs_tol=absolute)


def representatives(
    values: Iterable[float], kept: Collection[float] = (), absolute: float = ABSOLUTE
) -> dict[float, float]:
    """What stands for each value: the same number for all that are the same setting.

    Values are grouped from the smallest up: a group takes in what is equal to its first value. One
    of `kept` stands for a group that has one, else the value that is written shortest.
    """
    groups: list[list[float]] = []
    for value in sorted({*values, *kept}):
        if groups and are_equal(groups[-1][0], value, absolute=absolute):
            groups[-1].append(value)
        else:
            groups.append([value])
    found: dict[float, float] = {}
    for group in groups:
        best = min(group, key=lambda value: (value not in kept, len(repr(value)), value))
        found |= dict.fromkeys(group, best)
    return found
