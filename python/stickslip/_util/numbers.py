"""Types of arrays, equal settings, and the number of workers."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._util.messages import check_whole

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]


def root_mean_square(values: ArrayLike) -> float:
    """Root mean square of all numbers of an array, in their unit."""
    return float(np.sqrt(np.mean(np.square(values))))


RELATIVE = 1e-6
"""Part of the spread of a column within which two of its numbers are the same setting. Chosen:
finer than any apparatus is set, and wider than the rounding of a table in seven digits."""

_LAST_PLACES = 4
"""Units in the last place of a column's largest number that are the same. Chosen: what a few sums
and products leave."""


def are_equal(one: float, other: float, relative: float, absolute: float = 1e-12) -> bool:
    """Whether two numbers are nearly the same."""
    return math.isclose(one, other, rel_tol=relative, abs_tol=absolute)


def representatives(values: Iterable[float], kept: Collection[float] = ()) -> dict[float, float]:
    """What stands for each value of a column: the same number for all that are the same setting.

    Numbers are the same within 1e-6 of the spread of all, and never of their size, which is an
    offset as often as not. Values are grouped from the smallest up: a group takes in what is equal
    to its first value. One of `kept` stands for a group that has one, else the value that is
    written shortest.
    """
    ordered = sorted({*values, *kept})
    if not ordered:
        return {}
    within = max(
        RELATIVE * (ordered[-1] - ordered[0]),
        _LAST_PLACES * math.ulp(max(abs(ordered[0]), abs(ordered[-1]))),
    )
    groups: list[list[float]] = []
    for value in ordered:
        if groups and value - groups[-1][0] <= within:
            groups[-1].append(value)
        else:
            groups.append([value])
    found: dict[float, float] = {}
    for group in groups:
        best = min(group, key=lambda value: (value not in kept, len(repr(value)), value))
        found |= dict.fromkeys(group, best)
    return found


def worker_count(count: int | None, name: str) -> int:
    """`count` if it is given, else the number of processors that this process may use.

    A ScenarioError with the `name` says that it is not a whole number above zero.
    """
    if count is None:
        if hasattr(os, "sched_getaffinity"):
            return len(os.sched_getaffinity(0))
        return os.cpu_count() or 1
    check_whole(name, count, 1)
    return int(count)
