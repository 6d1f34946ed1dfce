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

# The numbers below are chosen, not derived. Lengths are in coordinates, of which 1 is a standard
# deviation of the prior; falls are of chi-square.
#
# Random points about the end of a search in one restart: half along the posterior and half along
# the axes; fewer rarely pass a jump, and each is a simulation of all conditions.
_RESTART_POINTS = 16
# Widths of the restarts in turn, in standard deviations of the posterior: a whole one finds another
# side of a jump, the smaller ones the lowest point on this side.
_RESTART_WIDTHS = (1.0, 0.4, 0.15)
# Least and largest width of the points along the axes: below the least they see nothing but the
# model's own scatter, and beyond the largest the constants leave the minimum.
_AXIS_WIDTHS = 0.03, 0.5
# A search ends after so many quiet steps in a row: one may be quiet by an updated derivative,
# which that step corrects.
_QUIET_STEPS = 2
# Steps after which a search that is far behind the best of all, or of its own candidate, is given
# up: with fewer, the first steps, which correct the constants, decide.
_STEPS_TO_JUDGE, _STEPS_TO_JUDGE_STARTS = 2, 4
# How far behind the best start of its candidate it then is: with less, a start that has yet to
# pass a jump of several errors is lost.
_BEHIND = 40.0
# Most steps of a fit that begins where one of nearly the same problem has ended: it has little to
# go.
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
        active = [search for search in active if search.quiet < _QUIET_STEPS]
        if count + 1 >= _STEPS_TO_JUDGE:
            best = min(search.chi2 for search in searches) + hopeless
            active = [search for search in active if search.chi2 < best]
        if count + 1 >= _STEPS_TO_JUDGE_STARTS:
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
        scale = _RESTART_WIDTHS[number % len(_RESTART_WIDTHS)]
        lower = spread_factor(search.jacobian(problem))
        draws = random.standard_normal((_RESTART_POINTS, len(free)))
        width = np.clip(np.sqrt(np.sum(lower**2, axis=1)), *_AXIS_WIDTHS)
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
