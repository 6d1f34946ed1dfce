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

# All of these are chosen, by trial on the simulator; lengths are in coordinates, of which 1 is a
# standard deviation of the prior.
# Widest and narrowest difference.
_WIDE, _NARROW = 0.03, 1e-3
# Shortest step that Broyden's update learns from, and the shortest of which it believes jumps.
_SECANT, _STRIDE = 1e-3, 0.3
# Change of one condition, in its errors, that is a jump and no slope.
_JUMP = 1.0
# First trust radius of a walk.
_NEAR = 1.0


@dataclass
class Walk:
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

    def jacobian(self, problem: Problem) -> Array:
        assert self.slope is not None
        return np.vstack([problem.whiten @ self.slope, np.diag(1.0 / self.candidate.width)])


def derive(problem: Problem, walks: Sequence[Walk], central: bool = False) -> None:
    """Derivatives of all walks by differences, to one side or to both.

    Where a one-sided difference shows a jump of some condition, or cannot be computed, the other
    side is looked at too; at the end of a range, the stretch beyond the first.
    """
    low, high = problem.limits()
    places = []
    for walk in walks:
        free = zip(walk.candidate.free, _widths(problem, walk), strict=True)
        for column, (k, width) in enumerate(free):
            places.append((walk, column, *_sides(walk.x[k], width, low[k], high[k])))
    sd = problem.sd
    near = _slopes(problem, [(walk, column, first) for walk, column, first, _ in places])
    smooth = [
        np.all(np.abs(slope * (first - walk.x[walk.candidate.free[column]])) <= _JUMP * sd)
        for slope, (walk, column, first, _) in zip(near, places, strict=True)
    ]
    again = [k for k, fine in enumerate(smooth) if central or not fine]
    far = _slopes(problem, [(places[k][0], places[k][1], places[k][3]) for k in again])
    for k, other in zip(again, far, strict=True):
        walk, column, first, second = places[k]
        one, two = np.array([first, second]) - walk.x[walk.candidate.free[column]]
        if one * two > 0.0:
            # Of the stretch from the first value to the second.
            other = (two * other - one * near[k]) / (two - one)
        jumped = np.abs(near[k] - other) * max(abs(one), abs(two)) > _JUMP * sd
        milder = np.where(np.abs(near[k]) < np.abs(other), near[k], other)
        both = np.where(jumped, milder, 0.5 * (near[k] + other))
        near[k] = np.where(np.isfinite(near[k]), np.where(np.isfinite(other), both, near[k]), other)
    for walk in walks:
        walk.slope, walk.fresh = np.zeros((len(sd), len(walk.candidate.free))), True
    for (walk, column, *_), slope in zip(places, near, strict=True):
        assert walk.slope is not None
        walk.slope[:, column] = np.where(np.isfinite(slope), slope, 0.0)


def _widths(problem: Problem, walk: Walk) -> Array:
    """Widths of the differences of each free coordinate."""
    if walk.slope is None:
        return np.full(len(walk.candidate.free), _WIDE)
    spread = 1.0 / np.sqrt(np.sum(walk.jacobian(problem) ** 2, axis=0))
    return np.asarray(np.clip(spread, _NARROW, _WIDE))


def _sides(place: float, width: float, low: float, high: float) -> tuple[float, float]:
    """A value on either side, the upper one first; at the end of a range two on the other side."""
    if place + 0.5 * width > high:
        return place - width, place - 2.0 * width
    if place - 0.5 * width < low:
        return place + width, place + 2.0 * width
    return min(place + width, high), max(place - width, low)


def _slopes(problem: Problem, places: Sequence[tuple[Walk, int, float]]) -> list[Array]:
    """Differences of the prediction to a value of one column each, by one batch."""
    if not places:
        return []
    points = np.stack([walk.x for walk, *_ in places])
    columns = [walk.candidate.free[column] for walk, column, _ in places]
    steps = np.array([value for *_, value in places]) - points[range(len(places)), columns]
    points[range(len(places)), columns] += steps
    level = np.stack([walk.predicted for walk, *_ in places])
    return list((problem.predicted(points) - level) / steps[:, None])


def broyden_update(walk: Walk, point: Array, row: Array, sd: Array) -> Array:
    """Derivatives that agree with what the step from here has shown."""
    assert walk.slope is not None
    step = (point - walk.x)[walk.candidate.free]
    length = float(np.linalg.norm(step))
    gap = row - walk.predicted - walk.slope @ step
    # A short step says more of the jumps of the model than of its slope.
    if length <= _SECANT or not np.all(np.isfinite(gap)):
        return walk.slope
    gap = np.clip(gap, -_JUMP * sd, _JUMP * sd) if length < _STRIDE else gap
    return np.asarray(walk.slope + np.outer(gap, step) / length**2)
