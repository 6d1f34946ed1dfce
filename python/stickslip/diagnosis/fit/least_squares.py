"""Fits of many candidate models in step, so that all predictions go through one batch call.

Gauss-Newton steps inside a trust radius, on whitened residuals with a prior row for every free
coordinate; see `derivatives` for the slopes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stickslip.diagnosis.fit.derivatives import Search, broyden_update, derive
from stickslip.diagnosis.fit.fit_result import Candidate, Fit, Start
from stickslip.diagnosis.model.problem import Array, Indices, Problem

AGREE = 1.0
"""Starts agree whose chi-squares differ by less: one standard deviation of one parameter."""

SMALLER_INFLATION, LARGEST_INFLATION = 3.0, 10.0
"""Factors by which errors are taken as too large, so that no search is lost in a narrow minimum.
Chosen: half decades."""

STAGES = ((LARGEST_INFLATION, np.inf), (SMALLER_INFLATION, np.inf), (1.0, 1.5), (1.0, np.inf))
"""Errors' factor and outliers' bound of a global search.

In the last but one, a condition whose motion is still of another kind, and whose velocity jumps
when it changes, does not hold the others back. The bound of 1.5 is chosen: a residual of two errors
already counts for less than half of its square.
"""

# All of these are chosen; lengths are in coordinates, of which 1 is a
# standard deviation of the prior, and falls are of chi-square.
# Random points about the end of a search in one restart.
_RESTART_POINTS = 16
# Largest trust radius.
_FAR = 4.0
# A start that is so far behind the best of its candidate after four steps is given up.
_BEHIND = 40.0
# A step that lowers chi-square by less is quiet; two of them in a row end a search.
_SETTLED = 0.02
# Share of the promised fall that a step has to reach for the trust radius to grow.
_GOOD = 0.3
# Most steps of a fit that begins where one of nearly the same problem has ended.
_AGAIN = 6


def fit_candidates(
    problem: Problem,
    candidates: Sequence[Candidate],
    starts: Sequence[Sequence[Start]],
    iterations: int = 10,
    hopeless: float = np.inf,
    random_restarts: int = 0,
    exact: bool = True,
) -> list[Fit]:
    """The best fit of each candidate from its starts, at least one each, all in step.

    The problem's loss decides what is least; the fits have their plain chi-square too. A start
    takes at most `iterations` steps, and candidates that are farther than `hopeless` behind the
    best after two steps are not refined. `random_restarts` are rounds of random points about every
    end, which get over jumps that stop a derivative. With `exact`, the derivatives at the end are
    taken anew; otherwise they are those of the last steps.
    """
    groups = _searches(problem, candidates, starts)
    searches = [search for group in groups for search in group]
    if not searches:
        return []
    active = searches
    for count in range(iterations):
        derive(problem, [search for search in active if search.slope is None])
        _advance(problem, active)
        active = [search for search in active if search.quiet < 2]
        if count >= 1:
            best = min(search.chi2 for search in searches) + hopeless
            active = [search for search in active if search.chi2 < best]
        if count >= 3:
            leads = {
                id(search): min(each.chi2 for each in group) for group in groups for search in group
            }
            active = [search for search in active if search.chi2 < leads[id(search)] + _BEHIND]
        if not active:
            break
    if random_restarts:
        derive(problem, [search for search in searches if search.slope is None])
    for number in range(random_restarts):
        _scatter(problem, searches, number)
    winners = [min(group, key=lambda search: search.chi2) for group in groups]
    derive(problem, [search for search in winners if search.slope is None])
    if exact:
        limit = min(search.chi2 for search in searches) + hopeless
        derive(problem, [search for search in winners if search.chi2 < limit], central=True)
    return [_fit(problem, winner, group) for winner, group in zip(winners, groups, strict=True)]


def refit(
    problem: Problem,
    fits: Sequence[Fit],
    iterations: int = _AGAIN,
    random_restarts: int = 0,
    exact: bool = False,
    rows: Indices | slice = slice(None),
) -> list[Fit]:
    """Fits again of another problem, each from where it ended; see `fit_candidates`.

    `rows` are the conditions of `fits` that the problem has.
    """
    begins = [[Start.of(fit, rows)] for fit in fits]
    candidates = [fit.candidate for fit in fits]
    return fit_candidates(
        problem, candidates, begins, iterations, random_restarts=random_restarts, exact=exact
    )


def refit_keeping_starts(
    problem: Problem, fits: Sequence[Fit], iterations: int = _AGAIN, random_restarts: int = 0
) -> list[Fit]:
    """As `refit`, under slightly other errors, so that what the starts have shown still holds.

    Only with several steps are the derivatives at the end taken anew.
    """
    again = refit(problem, fits, iterations, random_restarts, exact=iterations > 1)
    return [
        replace(new, converged=old.converged, starts=old.starts)
        for new, old in zip(again, fits, strict=True)
    ]


def _searches(
    problem: Problem, candidates: Sequence[Candidate], starts: Sequence[Sequence[Start]]
) -> list[list[Search]]:
    """A search at each start, by one batch of predictions."""
    groups: list[list[Search]] = [[] for _ in candidates]
    plan = [(k, start) for k, points in enumerate(starts) for start in points]
    if not plan:
        return groups
    x = [np.clip(start.x, *problem.limits()) for _, start in plan]
    data = problem.predicted(np.stack(x))
    for (k, start), at, row in zip(plan, x, data, strict=True):
        residual = _residual(problem, candidates[k], at, row)
        chi2 = _cost(problem, residual)
        groups[k].append(Search(candidates[k], at, row, residual, chi2, start.slope))
    return groups


def _residual(problem: Problem, candidate: Candidate, x: Array, predicted: Array) -> Array:
    """Whitened residuals of the data, then the prior's rows."""
    data = problem.whitened(predicted[None, :])[0]
    return np.concatenate([data, -x[candidate.free] / candidate.width])


def _cost(problem: Problem, residual: Array) -> float:
    """Misfit of the data and squares of the prior's rows."""
    m = len(problem.observed)
    return float(problem.misfit(residual[:m]) + residual[m:] @ residual[m:])


def _scatter(problem: Problem, searches: Sequence[Search], number: int) -> None:
    """Move each search to the best of some points about it, wide and narrow in turn."""
    low, high = problem.limits()
    random = np.random.default_rng([number, 3])
    rows = []
    for search in searches:
        free = search.candidate.free
        scale = (1.0, 0.4, 0.15)[number % 3]
        lower = spread_factor(search.jacobian(problem))
        draws = random.standard_normal((_RESTART_POINTS, len(free)))
        width = np.clip(np.sqrt(np.sum(lower**2, axis=1)), 0.03, 0.5)
        step = np.where(
            np.arange(_RESTART_POINTS)[:, None] % 2 == 0, draws @ lower.T, draws * width
        )
        points = np.tile(search.x, (_RESTART_POINTS, 1))
        points[:, free] += scale * step
        rows.append(np.clip(points, low, high))
    data = problem.predicted(np.vstack(rows)).reshape(len(searches), _RESTART_POINTS, -1)
    for search, points, predicted in zip(searches, rows, data, strict=True):
        _move(problem, search, points, predicted)


def spread_factor(jacobian: Array) -> Array:
    """A factor L of the covariance, L L' = 1 / J'J, however close J'J is to singular."""
    return np.asarray(np.linalg.inv(np.linalg.qr(jacobian)[1]))


def _move(problem: Problem, search: Search, points: Array, predicted: Array) -> float:
    """Go to the best of some points if it is better; the fall of chi-square, or less than 0."""
    residuals = [
        _residual(problem, search.candidate, x, row)
        for x, row in zip(points, predicted, strict=True)
    ]
    costs = [_cost(problem, each) for each in residuals]
    best = int(np.argmin(costs))
    fall = search.chi2 - costs[best]
    if fall > 0.0:
        search.x, search.predicted, search.residual = points[best], predicted[best], residuals[best]
        search.chi2, search.fresh = costs[best], False
    return fall


def _advance(problem: Problem, searches: Sequence[Search]) -> None:
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
        fall = _move(problem, search, point[None, :], row[None, :])
        search.slope = slope_now
        if fall <= 0.0:
            # Derivatives of wrong updates are taken anew before the radius is made smaller.
            search.radius *= 0.2 if exact else 1.0
            search.slope = search.slope if exact else None
        elif fall <= _GOOD * promised:
            search.radius = max(0.5 * length, 1e-3)
            search.slope = search.slope if exact else None
        else:
            search.radius = min(2.0 * search.radius, _FAR)
        small = fall < _SETTLED and (exact or promised < _SETTLED)
        search.quiet = search.quiet + 1 if small else 0


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


def _fit(problem: Problem, best: Search, searches: Sequence[Search]) -> Fit:
    """The fit of a candidate whose searches have ended, with Laplace's log-evidence."""
    ends = sorted(search.chi2 for search in searches)
    assert best.slope is not None
    jacobian = best.jacobian(problem)
    scaled = jacobian * best.candidate.width
    determinant = np.linalg.slogdet(scaled.T @ scaled)[1]
    chi2 = best.residual @ best.residual
    return Fit(
        candidate=best.candidate,
        x=best.x,
        chi2=float(chi2),
        data_chi2=float(np.sum(best.residual[: len(problem.observed)] ** 2)),
        residual=best.residual,
        jacobian=jacobian,
        slope=best.slope,
        log_evidence=float(-0.5 * chi2 - 0.5 * determinant),
        converged=len(ends) > 1 and ends[1] - ends[0] < AGREE,
        starts=tuple(ends),
    )
