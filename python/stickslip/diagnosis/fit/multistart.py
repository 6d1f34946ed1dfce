"""Fits of many candidate models, each from several starts, so that all predictions go in batches.

Searches make their steps together (`least_squares`), those that are far behind are given up, and
the best of each candidate is its fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stickslip.diagnosis.fit.derivatives import Search, derive
from stickslip.diagnosis.fit.fit_result import Candidate, Fit, Start
from stickslip.diagnosis.fit.least_squares import advance, cost, move, residual_of, spread_factor
from stickslip.diagnosis.model.problem import Indices, Problem

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

# All of these are chosen; falls are of chi-square.
# Random points about the end of a search in one restart.
_RESTART_POINTS = 16
# A start that is so far behind the best of its candidate after four steps is given up.
_BEHIND = 40.0
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
        advance(problem, active)
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
        residual = residual_of(problem, candidates[k], at, row)
        chi2 = cost(problem, residual)
        groups[k].append(Search(candidates[k], at, row, residual, chi2, start.slope))
    return groups


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
        move(problem, search, points, predicted)


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
