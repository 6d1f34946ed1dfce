"""Steps of searches: Gauss-Newton inside a trust radius, all searches in one batch of predictions.

The residuals are whitened, with a prior row for every free coordinate; see `derivatives` for the
slopes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip.diagnosis.fit.derivatives import Search, broyden_update
from stickslip.diagnosis.fit.fit_result import Candidate
from stickslip.diagnosis.model.problem import Array, Problem

# The numbers below are chosen, not derived. Lengths are in coordinates, of which 1 is a standard
# deviation of the prior; falls are of chi-square.
#
# Largest trust radius: a longer step would leave the prior, where a linear model says nothing.
_FAR = 4.0
# A step that lowers chi-square by less is quiet: far below what a test or a lead counts; with a
# smaller one searches go on in the model's own scatter.
_SETTLED = 0.02
# Share of the promised fall that a step has to reach for the trust radius to grow: with a smaller
# one the radius grows where the linear model fails, with a larger one it hardly ever does.
_GOOD = 0.3
# Factors of the trust radius: after a step that lowers nothing, though its derivatives were taken
# there; of the step's own length after one that lowers less than promised; and after a good step.
# Smaller ones waste steps on short ones, larger ones on steps that fail again.
_AFTER_FAILURE, _AFTER_POOR, _AFTER_GOOD = 0.2, 0.5, 2.0
# Least trust radius after a poor step: the narrowest difference of a derivative, below which the
# model is no smoother.
_LEAST_RADIUS = 1e-3
# Least curvature of the linear model in any direction: only what divides by it has to be finite.
_FLAT = 1e-12
# Steps by updated derivatives that disappoint until the derivatives are taken anew. After the first
# the update has learned from it, for one simulation of all conditions instead of one a parameter;
# with more, searches creep.
_MOST_DOUBTS = 2
# Bisections of the damping: they leave 1e-12 of its first interval.
_BISECTIONS = 40


def residual_of(problem: Problem, candidate: Candidate, x: Array, predicted: Array) -> Array:
    """Whitened residuals of the data, then the prior's rows."""
    data = problem.whitened(predicted[None, :])[0]
    return np.concatenate([data, -x[candidate.free] / candidate.width])


def cost(problem: Problem, residual: Array) -> float:
    """Misfit of the data and squares of the prior's rows."""
    m = len(problem.observed)
    return float(problem.misfit(residual[:m]) + residual[m:] @ residual[m:])


def spread_factor(jacobian: Array) -> Array:
    """A factor L of the covariance, L L' = 1 / J'J, however close J'J is to singular."""
    return np.asarray(np.linalg.inv(np.linalg.qr(jacobian)[1]))


def move(problem: Problem, search: Search, points: Array, predicted: Array) -> float:
    """Go to the best of some points if it is better; the fall of chi-square, or less than 0."""
    residuals = [
        residual_of(problem, search.candidate, x, row)
        for x, row in zip(points, predicted, strict=True)
    ]
    costs = [cost(problem, each) for each in residuals]
    best = int(np.argmin(costs))
    fall = search.chi2 - costs[best]
    if fall > 0.0:
        search.x, search.predicted, search.residual = points[best], predicted[best], residuals[best]
        search.chi2, search.fresh = costs[best], False
    return fall


def advance(problem: Problem, searches: Sequence[Search]) -> None:
    """One step of each search inside its trust radius."""
    m, sd = len(problem.observed), problem.sd
    low, high = problem.limits()
    points, hoped = [], []
    for search in searches:
        root = np.ones(len(search.residual))
        root[:m] = np.sqrt(problem.weights(search.residual[:m]))
        jacobian = search.jacobian(problem) * root[:, None]
        normal = jacobian.T @ jacobian
        slope = jacobian.T @ (search.residual * root)
        point = search.x.copy()
        point[search.candidate.free] += _within(normal, slope, search.radius)
        points.append(np.clip(point, low, high))
        taken = (points[-1] - search.x)[search.candidate.free]
        hoped.append(float(2.0 * slope @ taken - taken @ normal @ taken))
    predicted = problem.predicted(np.stack(points))
    for search, point, row, promised in zip(searches, points, predicted, hoped, strict=True):
        exact, length = search.fresh, float(np.linalg.norm(point - search.x))
        slope_now = broyden_update(search, point, row, sd)
        fall = move(problem, search, point[None, :], row[None, :])
        search.slope = slope_now
        if fall <= 0.0:
            search.radius = max(_AFTER_FAILURE * min(length, search.radius), _LEAST_RADIUS)
            search.doubts += not exact
        elif fall <= _GOOD * promised:
            search.radius = max(_AFTER_POOR * length, _LEAST_RADIUS)
            search.doubts += not exact
        else:
            search.radius = min(_AFTER_GOOD * search.radius, _FAR)
        if search.doubts >= _MOST_DOUBTS:
            search.forget_slope()
        small = fall < _SETTLED and (exact or promised < _SETTLED)
        search.quiet = search.quiet + 1 if small else 0


def _within(normal: Array, slope: Array, radius: float) -> Array:
    """Step of least predicted chi-square that is no longer than the radius."""
    values, vectors = np.linalg.eigh(normal)
    along = vectors.T @ slope
    values = np.maximum(values, _FLAT)

    def length(damping: float) -> float:
        return float(np.linalg.norm(along / (values + damping)))

    damping = 0.0
    if length(0.0) > radius:
        low, high = 0.0, float(np.linalg.norm(along)) / radius
        for _ in range(_BISECTIONS):
            damping = 0.5 * (low + high)
            low, high = (damping, high) if length(damping) > radius else (low, damping)
    return np.asarray(vectors @ (along / (values + damping)))
