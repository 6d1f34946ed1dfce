"""Where fits begin: scans of the constants, and first looks at single causes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from stickslip._util.arrays import Array
from stickslip.diagnosis.fitting.descent import (
    Batched,
    End,
    costs_of,
    descend,
    end_at,
    finished,
    precision_of,
    refine,
    run_batched,
)
from stickslip.diagnosis.fitting.forms import Form, Softened, forms
from stickslip.diagnosis.fitting.models import Fit, minimise
from stickslip.diagnosis.fitting.options import DESCENT, SEARCH
from stickslip.diagnosis.fitting.problem import FINE, Problem
from stickslip.diagnosis.fitting.responses import Response, responses
from stickslip.diagnosis.terms.cause import Cause

_Item = TypeVar("_Item")


def recalibrated(problem: Problem, seed: int) -> tuple[Fit, list[End]]:
    """The model without a cause from starts all over the priors, and the ends at larger errors."""
    if seed in problem.nulls:
        best, ends = problem.nulls[seed]
        return best, [*ends]
    whole, problem = problem, problem.short
    exact = forms(problem, ["exact"])["exact"]
    count = SEARCH.scan if len(problem.constants) > 1 else SEARCH.scan // 4
    starts = list(separated(_scan(problem, count, seed), lambda x: x, SEARCH.apart))
    fits, ends = _descended(problem, exact, starts, SEARCH.followed)
    best = fits[0]
    if whole is not problem:
        exact = forms(whole, ["exact"])["exact"]
        best = finished(whole, minimise(whole, exact, (), best.x))
    whole.nulls[seed] = best, tuple(ends)
    return best, ends


def _descended(
    problem: Problem, exact: Form, starts: Sequence[Array], together: int
) -> tuple[list[Fit], list[End]]:
    """Fits from some starts by all stages, the best first, and the softest's end in each valley.

    So many starts, `together`, are followed at a time, and a later one only where a hill parts it
    from all ends: a valley's further ends differ by its roughness alone.
    """
    first, *later = (Softened(problem, *stage) for stage in DESCENT.stages)
    (most, *fewer, last), h, ends = SEARCH.descents, np.zeros(0), list[End]()
    for some in np.split(starts[:most], range(together, most, together)):
        parted = [x for x in some if _is_parted(problem, first, x, ends)]
        ends += run_batched(problem, [descend(problem, first, h, (), x) for x in parted])
    ends, softest = _distinct(ends), list[End]()
    for end in ends:
        if _is_parted(problem, first, end.x, softest):
            softest.append(end)
    for soft, most in zip(later, fewer, strict=True):
        every = [descend(problem, soft, h, (), end.x, begin=end) for end in ends[:most]]
        ends = _distinct(run_batched(problem, every))
    fits = [minimise(problem, exact, (), end.x) for end in ends[:last]]
    return sorted(run_batched(problem, fits), key=lambda fit: fit.cost), softest


def _distinct(ends: Sequence[End]) -> list[End]:
    return list(separated(sorted(ends, key=lambda end: end.cost), lambda end: end.x, SEARCH.same))


def _is_parted(problem: Problem, form: Form, x: Array, ends: Sequence[End]) -> bool:
    """Whether the way from a point to each of some ends leads over a hill (Ursem, 1999)."""
    free, precision = problem.free(()), precision_of(problem, ())
    for end in ends:
        way = x + np.linspace(0.0, 1.0, SEARCH.between + 2)[:, None] * (end.x - x)
        residual = problem.residuals(way, True)
        costs = costs_of(form, np.zeros(0), way[:, free], precision, residual)
        if np.max(costs[1:-1]) < max(costs[0], costs[-1]) + SEARCH.better:
            return False
    return True


def _scan(problem: Problem, count: int, seed: int) -> Array:
    """Points drawn from the priors of the constants, shape (count, size), the best first."""
    p, x = len(problem.constants), np.zeros((count, problem.size))
    if p:
        sobol = qmc.Sobol(p, scramble=True, seed=seed).random(count)
        x[1:, :p] = ndtri(np.clip(sobol, 1e-3, 1.0 - 1e-3))[1:]
    soft = Softened(problem, *DESCENT.stages[0])
    cost = soft.cost(problem.residuals(x, True), np.zeros(0)) + np.sum(x[:, :p] ** 2, axis=1)
    return np.asarray(x[np.argsort(cost, kind="stable")])


def seen_in(problem: Problem, fit: Fit) -> Fit:
    """A fit as another problem of the same coordinates has it; its evidence stays."""
    if len(fit.residual) == len(problem.y):
        return fit
    end = finished(problem, end_at(problem, fit.causes, fit.x))
    chi2 = float(np.sum(problem.chi2_of_tables(end.residual[None, :])))
    return replace(fit, residual=end.residual, slopes=end.slopes, chi2=chi2)


def separated(
    items: Iterable[_Item], place: Callable[[_Item], Array], distance: float
) -> Iterator[_Item]:
    """Those that are not closer than a distance to an earlier one."""
    kept: list[Array] = []
    for item in items:
        at = place(item)
        if not kept or np.all(np.linalg.norm(np.array(kept) - at, axis=1) > distance):
            kept.append(at)
            yield item


Look = tuple[Cause, Array, Array | None, Sequence[Softened], int]
"""A cause, where a look at it begins, slopes there, and the stages of so many steps each."""


def first_looks(
    problem: Problem, null: Fit, ends: Sequence[End], causes: Sequence[Cause]
) -> list[Look]:
    """Where responses about several ends promise most, the best first, and where a relaxed constant
    is near the data.

    The stated constants are one of these: a fit without the cause may have bent them to what it
    does. A cause with a fine shape has many minima: it is followed from each, and farther.
    """
    soft, robust = softened(problem, null), Softened(problem, *DESCENT.stages[-1])
    # A view has to show where it is with the stated model, not a cheaper one.
    softest = Softened(problem, *DESCENT.stages[0])
    valleys = [end.x for end in ends if _is_parted(problem, softest, null.x, [end])]
    places = [null.x, np.zeros(problem.size), *valleys]
    apart = [*separated(places, lambda x: x, SEARCH.apart)][1 : SEARCH.views + 1]
    views = [null.end, *run_batched(problem, [end_at(problem, (), x) for x in apart])]
    fine = [cause for cause in causes if np.any(problem.fineness[problem.columns([cause])] <= FINE)]
    effort, every = problem.effort, list[list[Response]]()
    for one in views:
        sizes = effort.amplitudes if one is views[0] else effort.elsewhere
        # About the null the test has asked for whole predictions, but not of laws.
        cheap = one is not views[0] or any(cause.curve for cause in causes)
        every.append(responses(problem, one, (), causes, soft, np.zeros(0), sizes, cheap))
    # Of each view, as gains about one end do not compare with those about another.
    bundles = list[tuple[Cause, list[list[Response]]]]()
    for cause in causes:
        groups = [[response for response in some if response.cause is cause] for some in every]
        bundles += [(cause, [group]) for group in groups] if cause in fine else [(cause, groups)]
    hopes: list[tuple[float, Look]] = []
    for promising in run_batched(problem, [_promising(problem, soft, *each) for each in bundles]):
        for cost, response in promising:
            steps = SEARCH.longer_look if response.cause in fine else SEARCH.look
            look = response.cause, response.x, response.slopes, (soft, robust), steps
            hopes.append((cost, look))
    looks = [look for _, look in sorted(hopes, key=lambda hope: hope[0])]
    relaxed = [cause for cause in causes if cause.is_constant]
    stages = (*(Softened(problem, *stage) for stage in DESCENT.stages[:2]), robust)
    along = run_batched(problem, [_along(problem, cause, null) for cause in relaxed])
    for cause, starts in zip(relaxed, along, strict=True):
        looks += [(cause, x, None, stages, 2 * SEARCH.look) for x in starts]
    return looks


def _promising(
    problem: Problem, soft: Softened, cause: Cause, views: Sequence[Sequence[Response]]
) -> Batched[list[tuple[float, Response]]]:
    """The best start of a cause and the best one about another view, with their costs.

    The start that is best by its cost may be where no descent leads back, see `first_looks`.
    """
    in_turn = [(number, each) for row in itertools.zip_longest(*views)
               for number, each in enumerate(row) if each is not None]  # fmt: skip
    # Where the cause does nothing is nothing to begin with.
    columns = problem.columns([cause])
    in_turn = [one for one in in_turn if np.any(np.abs(one[1].x[columns]) > SEARCH.same)] or in_turn
    # Places of a scan are close together.
    far = np.maximum(FINE / problem.fineness, 1.0)
    near = list(separated(in_turn, lambda one: one[1].x * far, SEARCH.apart))[: SEARCH.looked_at]
    x = np.array([response.x for _, response in near])
    residual = yield x, True
    free, precision = problem.free([cause]), precision_of(problem, [cause])
    cost = costs_of(soft, np.zeros(0), x[:, free], precision, residual)
    first, *others = np.argsort(cost).tolist()
    elsewhere = [k for k in others if near[k][0] != near[first][0]] or others
    return [(float(cost[k]), near[k][1]) for k in (first, *elsewhere[:1])]


def _along(problem: Problem, cause: Cause, null: Fit) -> Batched[list[Array]]:
    """Points along a relaxed constant over its widened prior where the data are nearest.

    Predictions may jump, so that no descent leads to a constant that is far off. One about the
    recalibrated constants and two about the stated ones, as in `first_looks`. As these may
    have been bent, the priors of the others do not rank.
    """
    k = problem.at(cause)
    low, high = problem.limits[:, k]
    values = np.linspace(-SEARCH.widened, SEARCH.widened, SEARCH.places)
    values = values[(values >= low) & (values <= high)]
    soft, starts = Softened(problem, *DESCENT.stages[0]), list[Array]()
    for base, count in ((null.x, 1), (np.zeros(problem.size), 2)):
        x = np.tile(base, (len(values), 1))
        x[:, k] = values
        residual = yield x, True
        order = np.argsort(soft.cost(residual, np.zeros(0)), kind="stable")
        starts += [x[j] for j in order[:count]]
    return list(separated(starts, lambda x: x, SEARCH.apart))


def looked(
    problem: Problem, cause: Cause, x: Array, slopes: Array | None, stages: Sequence[Softened],
    steps: int, rival: End | None = None,
) -> Batched[tuple[End, Cause]]:  # fmt: skip
    """A first look at a cause by itself, which ends early where it is far behind a rival."""
    for form in stages:
        cost_bound = math.inf
        if rival is not None:
            left = rival.residual[None, :]
            cost_bound = float(form.cost(left, np.zeros(0))[0]) + SEARCH.margin / form.factor**2
        end = yield from refine(
            problem, form, np.zeros(0), (cause,), x, steps=steps, slopes=slopes,
            cost_bound=cost_bound, cheap=True,
        )  # fmt: skip
        x, slopes = end.x, end.slopes
    return end, cause


def softened(problem: Problem, base: Fit) -> Softened:
    """Errors as large as a fit misses the data."""
    inflation = math.sqrt(max(base.chi2 / len(problem.y), 1.0))
    return Softened(problem, min(inflation, DESCENT.stages[0][0]))
