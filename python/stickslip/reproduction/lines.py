"""Lines through curves of velocity, and where these cross a level.

A curve's values are the last axis of `y`, which can have any others before it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stickslip.reproduction.points import Array


class Line(NamedTuple):
    """Least-squares lines, one for each curve; arrays have no axis for a curve's values."""

    slope: Array
    explained: Array  # part of the variance that the line explains, R^2
    worst: Array  # greatest departure from the line, relative to it


def ratio(above: Array, below: Array) -> Array:
    """A quotient of which some denominators can be zero."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(above / below)


def proportional(x: Array, y: Array) -> Line:
    """Fit y = slope x to each curve of `y`, shape (..., len(x))."""
    slope = (y * x).sum(axis=-1) / (x**2).sum()
    return _line(y, slope[..., np.newaxis] * x, slope)


def straight(x: Array, y: Array) -> Line:
    """Fit y = slope x + constant to each curve of `y`, shape (..., len(x))."""
    centred = x - x.mean()
    slope = (y * centred).sum(axis=-1) / (centred**2).sum()
    return _line(y, y.mean(axis=-1, keepdims=True) + slope[..., np.newaxis] * centred, slope)


def _line(y: Array, line: Array, slope: Array) -> Line:
    spread = ((y - y.mean(axis=-1, keepdims=True)) ** 2).sum(axis=-1)
    explained = 1.0 - ratio(((y - line) ** 2).sum(axis=-1), spread)
    return Line(slope, explained, np.abs(ratio(y, line) - 1.0).max(axis=-1))


def bend(x: Array, y: Array) -> Array:
    """Slope of the upper half over that of the lower, for each curve of `y`; below 1: roll-off."""
    middle = len(x) // 2
    upper = straight(x[middle:], y[..., middle:]).slope
    return ratio(upper, straight(x[: middle + 1], y[..., : middle + 1]).slope)


def crossing(y: Array, x: Array, level: float) -> float:
    """Where one falling curve first meets a level, between points in log x; NaN if never."""
    below = np.flatnonzero(y < level)
    if len(below) == 0 or below[0] == 0:
        return math.nan
    k = int(below[0])
    part = ratio(y[k - 1] - level, y[k - 1] - y[k])
    return float(x[k - 1] * (x[k] / x[k - 1]) ** part)
