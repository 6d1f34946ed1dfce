"""Derivatives of predictions that are only piecewise smooth.

Differences are about as wide as what the data leaves open, so that they see over small steps of the
model: wide and one-sided on the way, central at the end, and Broyden's updates, which cost nothing,
in between. A jump of one condition is no slope.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.diagnosis.fit.fit_result import Candidate
from stickslip.diagnosis.model.problem import Array, Problem

# The numbers below are chosen, not derived. Lengths are in coordinates, of which 1 is a standard
# deviation of the prior.
#
# Widest difference: with a narrower one, slopes on the way see small steps of the model; with a
# wider one, its curvature.
_WIDE = 0.03
# Narrowest difference, where the data leave little open: below it the error of the simulation,
# divided by the difference, is no slope.
_NARROW = 1e-3
# Shortest step that Broyden's update learns from: as `_NARROW`.
_SECANT = 1e-3
# Shortest step whose jumps it takes as slopes: over a third of the prior's width a jump is a part
# of the change that counts; over less it would be taken for a steep slope.
_STRIDE = 0.3
# Change of one condition, in its errors, that is a jump and no slope: a smaller limit refuses steep
# slopes that the data know well, a larger one lets jumps through that outweigh the noise.
_JUMP = 1.0
# First trust radius of a search: the prior's width, as nothing is known better before the first
# step.
_NEAR = 1.0
# Share of a difference that has to fit between a value and the end of its range: with less room
# both values are taken on the other side.
_ROOM = 0.5


@dataclass
class Search:
    """One start of one candidate, and where it is now."""

    candidate: Candidate
    x: Array
    predicted: Array
    residual: Array
    chi2: float
    slope: Array | None
    # Whether the slope was taken at `x` itself.
    fresh: bool = False
    radius: float = _NEAR
    # How many of the last steps hardly lowered chi-square.
    quiet: int = 0
    # How many steps by updated derivatives have lowered chi-square less than promised.
    doubts: int = 0

    def forget_slope(self) -> None:
        """Have the derivatives taken anew; a radius that failing ones have shrunk is theirs."""
        self.slope, self.doubts, self.radius = None, 0, max(self.radius, _NEAR)

    def jacobian(self, problem: Problem) -> Array:
        assert self.slope is not None
        return np.vstack([problem.whiten @ self.slope, np.diag(1.0 / self.candidate.width)])


def derive(problem: Problem, searches: Sequence[Search], central: bool = False) -> None:
    """Derivatives of all searches by differences, to one side or to both.

    Where a one-sided difference shows a jump of some condition, or cannot be computed, the other
    side is looked at too; at the end of a range, the stretch beyond the first.
    """
    low, high = problem.limits()
    places = []
    for search in searches:
        free = zip(search.candidate.free, _widths(problem, search), strict=True)
        for column, (k, width) in enumerate(free):
            places.append((search, column, *_sides(search.x[k], width, low[k], high[k])))
    sd = problem.sd
    near = _slopes(problem, [(search, column, first) for search, column, first, _ in places])
    smooth = [
        np.all(np.abs(slope * (first - search.x[search.candidate.free[column]])) <= _JUMP * sd)
        for slope, (search, column, first, _) in zip(near, places, strict=True)
    ]
    again = [k for k, fine in enumerate(smooth) if central or not fine]
    far = _slopes(problem, [(places[k][0], places[k][1], places[k][3]) for k in again])
    for k, other in zip(again, far, strict=True):
        search, column, first, second = places[k]
        one, two = np.array([first, second]) - search.x[search.candidate.free[column]]
        if one * two > 0.0:
            # Of the stretch from the first value to the second.
            other = (two * other - one * near[k]) / (two - one)
        jumped = np.abs(near[k] - other) * max(abs(one), abs(two)) > _JUMP * sd
        milder = np.where(np.abs(near[k]) < np.abs(other), near[k], other)
        both = np.where(jumped, milder, 0.5 * (near[k] + other))
        near[k] = np.where(np.isfinite(near[k]), np.where(np.isfinite(other), both, near[k]), other)
    for search in searches:
        search.slope, search.fresh = np.zeros((len(sd), len(search.candidate.free))), True
    for (search, column, *_), slope in zip(places, near, strict=True):
        assert search.slope is not None
        search.slope[:, column] = np.where(np.isfinite(slope), slope, 0.0)


def _widths(problem: Problem, search: Search) -> Array:
    """Widths of the differences of each free coordinate."""
    fineness = problem.fineness[search.candidate.free]
    if search.slope is None:
        return _WIDE * fineness
    spread = 1.0 / np.sqrt(np.sum(search.jacobian(problem) ** 2, axis=0))
    return np.asarray(np.clip(spread, _NARROW * fineness, _WIDE * fineness))


def _sides(place: float, width: float, low: float, high: float) -> tuple[float, float]:
    """A value on either side, the upper one first; at the end of a range two on the other side."""
    if place + _ROOM * width > high:
        return place - width, place - 2.0 * width
    if place - _ROOM * width < low:
        return place + width, place + 2.0 * width
    return min(place + width, high), max(place - width, low)


def _slopes(problem: Problem, places: Sequence[tuple[Search, int, float]]) -> list[Array]:
    """Differences of the prediction to a value of one column each, by one batch."""
    if not places:
        return []
    points = np.stack([search.x for search, *_ in places])
    columns = [search.candidate.free[column] for search, column, _ in places]
    steps = np.array([value for *_, value in places]) - points[range(len(places)), columns]
    points[range(len(places)), columns] += steps
    level = np.stack([search.predicted for search, *_ in places])
    return list((problem.predicted(points) - level) / steps[:, None])


def broyden_update(search: Search, point: Array, row: Array, sd: Array) -> Array:
    """Derivatives that agree with what the step from here has shown."""
    assert search.slope is not None
    step = (point - search.x)[search.candidate.free]
    length = float(np.linalg.norm(step))
    gap = row - search.predicted - search.slope @ step
    # A short step says more of the jumps of the model than of its slope.
    if length <= _SECANT or not np.all(np.isfinite(gap)):
        return search.slope
    gap = np.clip(gap, -_JUMP * sd, _JUMP * sd) if length < _STRIDE else gap
    return np.asarray(search.slope + np.outer(gap, step) / length**2)
