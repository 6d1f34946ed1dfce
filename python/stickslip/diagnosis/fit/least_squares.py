"""Fits of many candidate models in step, so that all predictions go through one batch call.

Gauss-Newton steps inside a trust radius, on whitened residuals with a prior row for every free
coordinate. Derivatives are differences about as wide as what the data leaves open, so that they see
over the small steps of a piecewise smooth model: wide and one-sided on the way, central at the end,
and Broyden's updates, which cost nothing, in between. A jump of one condition is no slope.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.fit.fit_result import Candidate, Fit, Start
from stickslip.diagnosis.model.problem import Problem

Array = NDArray[np.float64]

AGREE = 1.0
"""Starts agree whose chi-squares differ by less."""

SMALLER_INFLATION, LARGEST_INFLATION = 3.0, 10.0
"""Factors by which errors are taken as too large, so that no walk is lost in a narrow valley."""

STAGES = ((LARGEST_INFLATION, np.inf), (SMALLER_INFLATION, np.inf), (1.0, 1.5), (1.0, np.inf))
"""Errors' factor and outliers' bound of a search from afar.

In the last but one, a condition whose motion is still of another kind, and whose velocity jumps
when it changes, does not hold the others back.
"""

_WIDE, _NARROW = 0.03, 1e-3
_SECANT, _STRIDE = 1e-3, 0.3
_RESTART_POINTS = 16
_NEAR, _FAR = 1.0, 4.0
_BEHIND = 40.0
_SETTLED = 0.02
_GOOD = 0.3
_JUMP = 1.0


@dataclass
class _Walk:
    """One start of one candidate."""

    candidate: Candidate
    x: Array
    predicted: Array = field(default_factory=lambda: np.zeros(0))
    residual: Array = field(default_factory=lambda: np.zeros(0))
    chi2: float = np.inf
    slope: Array | None = None
    fresh: bool = False
    radius: float = _NEAR
    quiet: int = 0

    def jacobian(self, problem: Problem) -> Array:
        assert self.slope is not None
        return np.vstack([problem.whiten @ self.slope, np.diag(1.0 / self.candidate.width)])


def fit_candidates(
    problem: Problem,
    candidates: Sequence[Candidate],
    starts: Sequence[Sequence[Start]],
    iterations: int = 10,
    hopeless: float = np.inf,
    random_restarts: int = 0,
    exact: bool = True,
) -> list[Fit]:
    """Fit candidates from their starts, all in step.

    Parameters
    ----------
    problem : Problem
        Its loss decides what is least; the fits have their plain chi-square too.
    candidates : sequence of Candidate
    starts : sequence of sequence of Start
        For each candidate at least one.
    iterations : int
        Most steps of a start.
    hopeless : float
        Candidates farther than this behind the best after two steps are not refined.
    random_restarts : int
        Rounds of random points about every end, which get over steps that stop a slope.
    exact : bool
        Whether the derivatives at the end are taken anew; otherwise they are those of the last
        steps.

    Returns
    -------
    list of Fit
        The best start of each candidate.
    """
    low, high = problem.limits()
    groups = [
        [
            _Walk(candidate, np.clip(start.x, low, high), slope=start.slope)
            for start in points
        ]
        for candidate, points in zip(candidates, starts, strict=True)
    ]  # fmt: skip
    walks = [walk for group in groups for walk in group]
    if not walks:
        return []
    data = problem.predicted(np.stack([walk.x for walk in walks]))
    for walk, row in zip(walks, data, strict=True):
        walk.predicted, walk.residual = row, _residual(problem, walk.candidate, walk.x, row)
        walk.chi2 = _cost(problem, walk.residual)
    active = walks
    for count in range(iterations):
        _derive(problem, [walk for walk in active if walk.slope is None], low, high)
        _advance(problem, active, low, high)
        active = [walk for walk in active if walk.quiet < 2]
        if count >= 1:
            best = min(walk.chi2 for walk in walks) + hopeless
            active = [walk for walk in active if walk.chi2 < best]
        if count >= 3:
            leads = {id(walk): min(each.chi2 for each in group)
                     for group in groups for walk in group}  # fmt: skip
            active = [walk for walk in active if walk.chi2 < leads[id(walk)] + _BEHIND]
        if not active:
            break
    if random_restarts:
        _derive(problem, [walk for walk in walks if walk.slope is None], low, high)
    for number in range(random_restarts):
        _scatter(problem, walks, low, high, number)
    winners = [min(group, key=lambda walk: walk.chi2) for group in groups]
    _derive(problem, [walk for walk in winners if walk.slope is None], low, high)
    if exact:
        limit = min(walk.chi2 for walk in walks) + hopeless
        _derive(problem, [each for each in winners if each.chi2 < limit], low, high, central=True)
    return [_fit(problem, winner, group) for winner, group in zip(winners, groups, strict=True)]


def _residual(problem: Problem, candidate: Candidate, x: Array, predicted: Array) -> Array:
    data = problem.whitened(predicted[None, :])[0]
    return np.concatenate([data, -x[candidate.free] / candidate.width])


def _cost(problem: Problem, residual: Array) -> float:
    """Misfit of the data and squares of the prior's rows."""
    m = len(problem.observed)
    return float(problem.misfit(residual[:m]) + residual[m:] @ residual[m:])


def _scatter(
    problem: Problem, walks: Sequence[_Walk], low: Array, high: Array, number: int
) -> None:
    """Move each walk to the best of some points about it, wide and narrow in turn."""
    random = np.random.default_rng([number, 3])
    rows = []
    for walk in walks:
        free = walk.candidate.free
        scale = (1.0, 0.4, 0.15)[number % 3]
        lower = spread_factor(walk.jacobian(problem))
        draws = random.standard_normal((_RESTART_POINTS, len(free)))
        width = np.clip(np.sqrt(np.sum(lower**2, axis=1)), 0.03, 0.5)
        step = np.where(
            np.arange(_RESTART_POINTS)[:, None] % 2 == 0, draws @ lower.T, draws * width
        )
        points = np.tile(walk.x, (_RESTART_POINTS, 1))
        points[:, free] += scale * step
        rows.append(np.clip(points, low, high))
    data = problem.predicted(np.vstack(rows)).reshape(len(walks), _RESTART_POINTS, -1)
    for walk, points, predicted in zip(walks, rows, data, strict=True):
        _move(problem, walk, points, predicted)


def spread_factor(jacobian: Array) -> Array:
    """A factor L of the covariance, L L' = 1 / J'J, however close J'J is to singular."""
    return np.asarray(np.linalg.inv(np.linalg.qr(jacobian)[1]))


def _move(problem: Problem, walk: _Walk, points: Array, predicted: Array) -> float:
    """Go to the best of some points if it is better; the fall of chi-square, or less than 0."""
    residuals = [
        _residual(problem, walk.candidate, x, row) for x, row in zip(points, predicted, strict=True)
    ]
    costs = [_cost(problem, each) for each in residuals]
    best = int(np.argmin(costs))
    fall = walk.chi2 - costs[best]
    if fall > 0.0:
        walk.x, walk.predicted, walk.residual = points[best], predicted[best], residuals[best]
        walk.chi2, walk.fresh = costs[best], False
    return fall


def _derive(
    problem: Problem, walks: Sequence[_Walk], low: Array, high: Array, central: bool = False
) -> None:
    """Derivatives of all walks by differences, to one side or to both.

    Where a one-sided difference shows a jump of some condition, or cannot be computed, the other
    side is looked at too; at the end of a range, the stretch beyond the first.
    """
    places = [
        (walk, column, *_sides(walk.x[k], width, low[k], high[k]))
        for walk in walks
        for column, (k, width) in enumerate(zip(walk.candidate.free, _widths(problem, walk),
                                                strict=True))
    ]  # fmt: skip
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


def _widths(problem: Problem, walk: _Walk) -> Array:
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


def _slopes(problem: Problem, places: Sequence[tuple[_Walk, int, float]]) -> list[Array]:
    """Differences of the prediction to a value of one column each, by one batch."""
    if not places:
        return []
    points = np.stack([walk.x for walk, *_ in places])
    columns = [walk.candidate.free[column] for walk, column, _ in places]
    steps = np.array([value for *_, value in places]) - points[range(len(places)), columns]
    points[range(len(places)), columns] += steps
    level = np.stack([walk.predicted for walk, *_ in places])
    return list((problem.predicted(points) - level) / steps[:, None])


def _advance(problem: Problem, walks: Sequence[_Walk], low: Array, high: Array) -> None:
    """One step of each walk inside its trust radius."""
    m, sd = len(problem.observed), problem.sd
    points, hoped = [], []
    for walk in walks:
        root = np.ones(len(walk.residual))
        root[:m] = np.sqrt(problem.weights(walk.residual[:m]))
        jacobian = walk.jacobian(problem) * root[:, None]
        normal = jacobian.T @ jacobian
        slope = jacobian.T @ (walk.residual * root)
        point = walk.x.copy()
        point[walk.candidate.free] += _within(normal, slope, walk.radius)
        points.append(np.clip(point, low, high))
        taken = (points[-1] - walk.x)[walk.candidate.free]
        hoped.append(float(2.0 * slope @ taken - taken @ normal @ taken))
    predicted = problem.predicted(np.stack(points))
    for walk, point, row, promised in zip(walks, points, predicted, hoped, strict=True):
        exact, length = walk.fresh, float(np.linalg.norm(point - walk.x))
        slope_now = _broyden(walk, point, row, sd)
        fall = _move(problem, walk, point[None, :], row[None, :])
        walk.slope = slope_now
        if fall <= 0.0:
            # Updates that went astray are replaced before the radius is blamed.
            if exact:
                walk.radius *= 0.2
            else:
                walk.slope = None
        elif fall <= _GOOD * promised:
            walk.radius = max(0.5 * length, 1e-3)
            walk.slope = None if not exact else walk.slope
        else:
            walk.radius = min(2.0 * walk.radius, _FAR)
        small = fall < _SETTLED and (exact or promised < _SETTLED)
        walk.quiet = walk.quiet + 1 if small else 0


def _within(normal: Array, slope: Array, radius: float) -> Array:
    """Step of least predicted chi-square that is no longer than the radius."""
    values, vectors = np.linalg.eigh(normal)
    along = vectors.T @ slope
    values = np.maximum(values, 1e-12)

    def length(damping: float) -> float:
        return float(np.linalg.norm(along / (values + damping)))

    damping = 0.0
    if length(0.0) > radius:
        low, high = 0.0, float(np.linalg.norm(along)) / radius
        for _ in range(40):
            damping = 0.5 * (low + high)
            low, high = (damping, high) if length(damping) > radius else (low, damping)
    return np.asarray(vectors @ (along / (values + damping)))


def _broyden(walk: _Walk, point: Array, row: Array, sd: Array) -> Array:
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


def _fit(problem: Problem, best: _Walk, walks: Sequence[_Walk]) -> Fit:
    ends = sorted(walk.chi2 for walk in walks)
    assert best.slope is not None
    jacobian = best.jacobian(problem)
    scaled = jacobian * best.candidate.width
    determinant = np.linalg.slogdet(scaled.T @ scaled)[1]
    m = len(problem.observed)
    return Fit(
        best.candidate,
        best.x,
        float(best.residual @ best.residual),
        float(np.sum(best.residual[:m] ** 2)),
        best.residual,
        jacobian,
        best.slope,
        float(-0.5 * best.residual @ best.residual - 0.5 * determinant),
        len(ends) > 1 and ends[1] - ends[0] < AGREE,
        tuple(ends),
    )
