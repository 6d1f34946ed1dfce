"""Types of arrays, checks of numbers, equal settings, and the number of workers."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._util.messages import check_whole, refuse

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]


def numbers_of(name: str, values: object, allowed: str) -> Array:
    """The finite numbers that the values are, in whatever shape; else refuse them."""
    try:
        given = np.asarray(values)
    except ValueError:  # rows of several lengths
        refuse(name, values, allowed)
    if given.dtype.kind not in "iuf" or not np.isfinite(given).all():
        refuse(name, values, allowed)
    return given.astype(float)


def root_mean_square(values: ArrayLike) -> float:
    """Root mean square of all numbers of an array, in their unit."""
    return float(np.sqrt(np.mean(np.square(values))))


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
