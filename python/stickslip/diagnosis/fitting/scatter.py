"""Errors that neither repeats nor a smooth curve tell: what the fit of all causes leaves."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from stickslip._util.arrays import Array, root_mean_square
from stickslip._util.note import Note
from stickslip._util.units import with_unit
from stickslip.diagnosis.data.errors import FEWEST, Errors, freedom, of_one_meter
from stickslip.diagnosis.data.series import SMOOTH
from stickslip.diagnosis.fitting.descent import End, end_at, precision_of, refine, run_batched
from stickslip.diagnosis.fitting.forms import Exact
from stickslip.diagnosis.fitting.options import SEARCH
from stickslip.diagnosis.fitting.problem import LOST, Problem
from stickslip.diagnosis.fitting.responses import Response, responses
from stickslip.diagnosis.fitting.starts import recalibrated, seen_in, separated

# Rounds of fit and scatter and steps of each; ends beside the recalibrated model about which single
# causes are tried, steps of a look from each of them, looks that are followed, and looks of each
# cause. A cause that leads to the minimum may look worst where it begins. Chosen.
_ROUNDS, _STEPS, _VIEWS, _LOOK, _FOLLOWED, _OF_CAUSE = 4, 15, 2, 4, 4, 4

_SMALLEST = 1e-9  # least error, in the scatter of the readings: below it is rounding

_LESS, _CLEARLY = 0.8, 1.05
"""Part of the scatter about a smooth curve below which that of a fit shows that the readings follow
no smooth curve, and a factor of it above which the beginning of a long record tells that they do.
Chosen: sixty readings tell the first from chance."""


def with_scatter(problem: Problem, seed: int) -> Problem:
    """The problem where each table has errors, if enough readings tell them.

    A cause that is not listed counts as noise. Readings that follow an input of many jumps scatter
    about each smooth curve; if the fit leaves less than that, it tells their error too.
    """
    unknown = [k for k, errors in enumerate(problem.errors) if errors.dof == 0.0]
    curves = [k for k, e in enumerate(problem.errors) if SMOOTH in {n.code for n in e.notes}]
    if not unknown and not curves:
        return problem
    null, ends = recalibrated(problem, seed)
    problem = _scattered(problem, unknown, null.residual, len(null.free))
    short = problem.short
    form, h = Exact(short), np.zeros(0)
    views = [seen_in(short, null).end]
    views += run_batched(short, [end_at(short, (), end.x) for end in ends[:_VIEWS]])
    effects = list[Response]()
    for view in views:
        every = responses(short, view, (), problem.causes, form, h)
        for cause in problem.causes:
            effects += [effect for effect in every if effect.cause is cause][:_OF_CAUSE]
    # With its own cause alone, as all together have many slopes.
    looks = [refine(short, form, h, [effect.cause], effect.x, steps=_LOOK, slopes=effect.slopes)
             for effect in separated(effects, lambda effect: effect.x, SEARCH.apart)]  # fmt: skip
    ends = sorted(run_batched(short, looks), key=lambda end: end.cost)
    starts = [*(end.x for end in ends[: _FOLLOWED - 1]), null.x]
    # A long record's beginning tells whether it follows a curve; a step on all, what is left.
    begin, is_long, last = None, short is not problem, _STEPS if short is problem else 1
    # A walk ends that will not fall to the scatter that decides.
    enough = math.inf if unknown else form.cost(_CLEARLY * _LESS * short.sd[None], h)[0]
    for steps in (_LOOK, _STEPS) if is_long else ():
        walks = [refine(short, form, h, problem.causes, x, steps=steps, cost_bound=enough)
                 for x in starts]  # fmt: skip
        best = min(run_batched(short, walks), key=lambda end: end.cost)
        starts = [best.x]
    if is_long:
        curves = _rougher(short, curves, best, _parameters(short, form, best), _CLEARLY)
    while unknown or curves:
        for _ in range(_ROUNDS if unknown else 1):
            form = Exact(problem)
            walks = [refine(problem, form, h, problem.causes, x, steps=last, begin=begin)
                     for x in starts]  # fmt: skip
            best = min(run_batched(problem, walks), key=lambda end: end.cost)
            # Marks of lost rows are in errors that change.
            begin = best if is_long and not (best.residual == LOST * problem.sd).any() else None
            starts, spent = [best.x], _parameters(problem, form, best)
            problem = _scattered(problem, unknown, best.residual, spent)
        rougher = _rougher(problem, [k for k in curves if k not in unknown], best, spent)
        if not rougher:
            break
        unknown = [*unknown, *rougher]
        problem = _scattered(problem, unknown, best.residual, spent)
    return problem


def _rougher(
    problem: Problem, curves: Sequence[int], end: End, spent: float, room: float = 1.0
) -> list[int]:
    """Tables that follow no smooth curve: of its scatter the fit of all causes leaves a part."""
    return [k for k in curves if _size(problem, k, end.residual, spent)
            < room * _LESS * problem.errors[k].sizes["s0"]]  # fmt: skip


def _parameters(problem: Problem, form: Exact, end: End) -> float:
    """How many readings a fit of all causes takes up; a prior that decides takes none."""
    whitened = form.prepared(end.slopes)
    gram = whitened.T @ whitened
    return float(np.trace(np.linalg.solve(gram + precision_of(problem, problem.causes), gram)))


def _size(problem: Problem, k: int, residual: Array, spent: float) -> float:
    """Standard deviation of a reading of a table by a residual in which a fit has spent some."""
    table, free = problem.tables[k], max(1.0 - spent / len(problem.y), 1e-9)
    size = root_mean_square(_readings(problem, k, residual)) / math.sqrt(free)
    return max(size, _SMALLEST * float(np.std(table.y)))


def _readings(problem: Problem, k: int, residual: Array) -> Array:
    """A residual of a table's conditions, in the error of a reading, in their order."""
    table, left = problem.tables[k], residual[problem.rows[k]]
    left = left * np.sqrt(np.bincount(table.condition))
    if table.run is None or table.order is None:
        return left
    return left[np.lexsort((table.order, table.run))]


def _scattered(problem: Problem, unknown: Sequence[int], residual: Array, spent: float) -> Problem:
    """The problem with errors from a residual, in which a fit has spent so many readings.

    Records of one unit share an error, unless they differ by more than their degrees of freedom
    allow: weights of their own would fit the easiest one best.
    """
    tables, share = list(problem.tables), 1.0 - spent / len(problem.y)
    # Too few readings, and those that never change, tell no error.
    told = [k for k in unknown
            if share * len(tables[k].mean) >= FEWEST and np.ptp(tables[k].y)]  # fmt: skip
    sizes = np.array([_size(problem, k, residual, spent) for k in told])
    free = share * np.array([len(tables[k].mean) for k in told])
    dof = share * np.array([freedom(_readings(problem, k, residual)) for k in told])
    shared = of_one_meter([tables[k].unit for k in told], sizes, free, dof)
    for k, size, count in zip(told, *shared, strict=True):
        table = tables[k]
        text = (
            f"A reading scatters by {with_unit(size, table.unit)} about the fit of all causes "
            f"({count:.0f} degrees of freedom): a cause that is none of them counts as noise."
        )
        repeats, note = np.bincount(table.condition), Note("noise-fit", text, size)
        tables[k] = table.having(errors=Errors.alike(size, repeats, count, note, of_fit=True))
    return problem.with_tables(tables) if told else problem
