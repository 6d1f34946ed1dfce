"""Levenberg-Marquardt descents of predictions that are only piecewise smooth."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from stickslip._util.arrays import Array, Indices
from stickslip._util.text import OneLine
from stickslip.diagnosis.fitting.forms import Form
from stickslip.diagnosis.fitting.options import DESCENT
from stickslip.diagnosis.fitting.problem import LOST, Problem
from stickslip.diagnosis.terms.cause import Cause

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
Batched = Generator[tuple[Array, bool], Array, _Result]
"""A search that yields points, shape (vectors, size), and whether the cheaper model will do, and is
sent their residuals."""


@dataclass(frozen=True, repr=False, eq=False)
class End(OneLine):
    """Where a descent is: coordinates, residual (n,), and slopes of the predictions, (n, free).

    `exact` slopes were taken by differences at `x`, others updated by the steps to it.
    """

    x: Array
    residual: Array
    slopes: Array
    cost: float
    exact: bool = True


def precision_of(problem: Problem, causes: Sequence[Cause]) -> Array:
    """Inverse covariance of the prior in a descent: of a law, that of the middle of its grid."""
    every = problem.precisions(causes)
    return every[len(every) // 2]


def costs_of(form: Form, h: Array, free: Array, precision: Array, residual: Array) -> Array:
    """Misfit of residuals, (vectors, n), and prior of the free coordinates, (vectors, k)."""
    return np.asarray(form.cost(residual, h) + np.einsum("vi,ij,vj->v", free, precision, free))


def batches(items: Sequence[_Item], sizes: Sequence[int], most: int) -> Iterator[list[_Item]]:
    """Items in their order, together of about a size, or one that is larger."""
    number = (np.cumsum(sizes) - 1) // most
    for _, some in itertools.groupby(zip(number, items, strict=True), key=lambda one: one[0]):
        yield [item for _, item in some]


def run_batched(problem: Problem, searches: Sequence[Batched[_Result]]) -> list[_Result]:
    """Results of several searches: what they ask for at a time is one batch of predictions."""
    results: dict[int, _Result] = {}
    asked: dict[int, tuple[Array, bool]] = {}

    def go_on(k: int, answer: Array | None) -> None:
        try:
            asked[k] = searches[k].send(answer)  # type: ignore[arg-type]
        except StopIteration as end:
            results[k] = end.value
            asked.pop(k, None)

    for k in range(len(searches)):
        go_on(k, None)
    while asked:
        for cheap in (True, False):
            mine = [(k, x) for k, (x, asked_cheap) in asked.items() if asked_cheap == cheap]
            for some in batches(mine, [len(x) for _, x in mine], problem.at_once):
                residuals = problem.residuals(np.vstack([x for _, x in some]), cheap)
                ends = np.cumsum([len(x) for _, x in some])
                for (k, _), part in zip(some, np.split(residuals, ends[:-1]), strict=True):
                    go_on(k, part)
    return [results[k] for k in range(len(searches))]


def finished(problem: Problem, search: Batched[_Result]) -> _Result:
    """The result of one search."""
    return run_batched(problem, [search])[0]


def descend(
    problem: Problem, form: Form, h: Array, causes: Sequence[Cause], x: Array, *,
    precision: Array | None = None, steps: int = 10, begin: End | None = None,
    slopes: Array | None = None, cost_bound: float = np.inf, cheap: bool | None = None,
) -> Batched[End]:  # fmt: skip
    """The minimum of misfit and prior near `x`.

    Without `cheap`, softened forms use the model of low fidelity, and others do not. `begin` is an
    end at `x` of the same model, whose residual and slopes are taken over; `slopes` are some that
    were found near by, zeros where none were taken. A descent ends where its last steps, each half
    as good as the last one or as the next one promises, would not bring it below `cost_bound`.
    """
    free = problem.free(causes)
    cheap = form.factor > 1.0 if cheap is None else cheap
    precision = precision_of(problem, causes) if precision is None else precision
    low, high = problem.limits[:, free]
    given, x = x, np.zeros(problem.size)
    x[free] = np.clip(given[free], low, high)
    if begin is None:
        residual = (yield x[None, :], cheap)[0].copy()  # a view would keep those of all searches
        exact = slopes is None
        if slopes is None:
            slopes = yield from derivatives(problem, x, free, residual, cheap)
        elif not slopes.any(axis=0).all():
            # Of a shape, or a constant that acts beside the cause alone: without a slope it stays
            # where it begins, and the model is given up for that.
            missing, slopes = ~slopes.any(axis=0), slopes.copy()
            slopes[:, missing] = yield from derivatives(problem, x, free[missing], residual, cheap)
    else:
        residual, slopes, exact = begin.residual, begin.slopes, begin.exact
    now = float(costs_of(form, h, x[None, free], precision, residual[None, :])[0])
    linear = [p.prior is not None and p.prior.kind == "normal" for p in problem.parameters]
    longest = np.where(linear, DESCENT.linear_step, DESCENT.step)[free]
    factor, softer, fall, count = 1.0, 1.0, 0.0, 0.0
    rough = problem.effort.rough
    usual = max(form.n, float(form.cost(problem.sd[None], h)[0])) if rough and not cheap else 0.0

    def is_lost() -> bool:
        if now <= cost_bound:
            return False
        promised = float(downhill @ step_within(curvature, downhill, *room))
        return now - 0.5 * (steps - count) * max(fall, promised) > cost_bound

    while count < steps:
        settled = max(DESCENT.settled, rough * (now - usual - form.price(residual[None])[0]))
        # What is prepared is not kept while other searches run.
        gram = form.weighted(form.prepared(np.column_stack([slopes, residual])), residual, h)
        curvature = gram[:-1, :-1] + precision
        downhill = gram[:-1, -1] - precision @ x[free]
        room = np.maximum(low - x[free], -longest), np.minimum(high - x[free], longest)
        if count and is_lost():
            if exact or problem.effort.early:
                break
            # Those that were updated may see no way where there is one.
            slopes, exact = (yield from derivatives(problem, x, free, residual, cheap)), True
            continue
        fall, there, made = -np.inf, x, residual
        for dampings in (DESCENT.dampings[:1], DESCENT.dampings[1:]):
            tries = np.tile(x, (len(dampings), 1))
            for row, damping in zip(tries, factor * softer * np.array(dampings), strict=True):
                step = step_within(curvature, downhill, *room, damping)
                row[free] = np.clip(x[free] + step, low, high)
            residuals = yield tries, cheap
            costs = costs_of(form, h, tries[:, free], precision, residuals)
            best = int(np.argmin(np.where(np.isfinite(costs), costs, np.inf)))
            if now - float(costs[best]) > fall:
                fall, there, made = now - float(costs[best]), tries[best], residuals[best]
            move = (there - x)[free]
            hoped = float(2.0 * downhill @ move - move @ curvature @ move)
            if fall > DESCENT.good * hoped:
                if len(dampings) > 1:
                    softer = max(0.1 * softer, 1e-5) if best == 0 else min(10.0 * softer, 1.0)
                break
        else:
            softer = 1.0
        crawls = count >= DESCENT.crawl and fall > max(DESCENT.crawl_fall, DESCENT.crawl_part * now)
        count += DESCENT.crawl_counts if crawls else 1.0
        if fall > 0.0:
            slopes = _updated(slopes, residual - made, move, problem.sd)
            x, residual, now = there, made.copy(), now - fall
            was_exact, exact, factor = exact, False, 1.0
            if fall < settled and (was_exact or hoped < settled):
                break
            if fall > DESCENT.good * hoped:
                continue
        elif exact:
            if factor > 1.0 or hoped < settled:
                break
            factor = 100.0
            continue
        if problem.effort.early and is_lost():
            break  # before slopes are taken for no use
        spread = np.sqrt(np.maximum(np.diag(np.linalg.pinv(curvature)), 0.0))
        slopes = yield from derivatives(problem, x, free, residual, cheap, spread)
        exact = True
    return End(x, residual, slopes, now, exact)


def refine(
    problem: Problem, form: Form, h: Array, causes: Sequence[Cause], x: Array, *,
    cost_bound: float = np.inf, cheap: bool | None = None, precision: Array | None = None,
    **options: Any,
) -> Batched[End]:  # fmt: skip
    """`descend`, and again from any move along a cause's fine coordinates that lowers the cost.

    An event's edge changes one reading alone, so its slope leads nowhere.
    """
    options |= {"precision": precision, "cheap": cheap, "cost_bound": cost_bound}
    end = yield from descend(problem, form, h, causes, x, **options)
    moves = [one for cause in causes for one in _moves(problem, cause)]
    cheap = form.factor > 1.0 if cheap is None else cheap
    precision = precision_of(problem, causes) if precision is None else precision
    free = problem.free(causes)
    for _ in range(DESCENT.walks if moves and end.cost < cost_bound else 0):
        tries = np.clip(end.x + moves, *problem.limits)
        costs = list[float]()
        for some in np.split(tries, range(problem.at_once, len(tries), problem.at_once)):
            residual = yield some, cheap
            costs += costs_of(form, h, some[:, free], precision, residual).tolist()
        best = int(np.argmin(np.where(np.isfinite(costs), costs, np.inf)))
        if not costs[best] < end.cost - DESCENT.settled:
            break
        options |= {"begin": None, "slopes": end.slopes, "cost_bound": np.inf}
        end = yield from descend(problem, form, h, causes, tries[best], **options)
    return end


def _moves(problem: Problem, cause: Cause) -> list[Array]:
    """Moves of the fine coordinates of a cause, alone and two together, as vectors (size,)."""
    fine = [k for k in problem.columns([cause]).tolist() if problem.oscillatory[k]]
    steps = np.concatenate([[0.0], DESCENT.moves, np.negative(DESCENT.moves)])
    together, moves = min(len(fine), 2), []
    for some in itertools.combinations(fine, together) if fine else ():
        for sizes in itertools.product(steps, repeat=together):
            move = np.zeros(problem.size)
            move[list(some)] = sizes * problem.fineness[list(some)]
            moves.append(move)
    return moves


def _updated(slopes: Array, change: Array, move: Array, sd: Array) -> Array:
    """Slopes that agree with the change of the predictions over a step (Broyden, 1965)."""
    length = float(np.linalg.norm(move))
    # A short step says more of the jumps of the model than of its slope.
    if length <= DESCENT.narrow:
        return slopes
    gap = change - slopes @ move
    if length < DESCENT.stride:
        gap = np.clip(gap, -DESCENT.jump * sd, DESCENT.jump * sd)
    return np.asarray(slopes + np.outer(gap, move) / length**2, slopes.dtype)


def step_within(
    curvature: Array, downhill: Array, low: Array, high: Array, damping: float = 0.0
) -> Array:
    """The step to the minimum of a damped quadratic within these ends; zero where it has none.

    What would leave them stays there, and the rest moves for that: a constant and a law that trade
    off against each other must not move one without the other.
    """
    curvature = curvature + damping * np.diag(np.diag(curvature))
    step, free = np.zeros(len(downhill)), np.ones(len(downhill), dtype=bool)
    with contextlib.suppress(np.linalg.LinAlgError):
        while free.any():
            along = downhill[free] - curvature[np.ix_(free, ~free)] @ step[~free]
            step[free] = np.linalg.solve(curvature[np.ix_(free, free)], along)
            outside = (step < low) | (step > high)
            if not outside.any():
                return step
            step = np.clip(step, low, high)
            free &= ~outside
        return step
    return np.zeros(len(downhill))


def derivatives(
    problem: Problem, x: Array, free: Indices, residual: Array, cheap: bool = False,
    spread: Array | None = None, central: bool = False,
) -> Batched[Array]:  # fmt: skip
    """Slopes of the predictions by differences, shape (n, free).

    Differences are about as wide as what the data leaves open, `spread`. Where one shows a jump of
    some row, or with `central`, the other side is looked at too: where both sides differ by a
    jump, the milder one is the slope. A coordinate that turns the predictions has widths of its
    own, see `_fine_slope`: they bend within the spread.
    """
    fineness = problem.fineness[free]
    oscillatory = problem.oscillatory[free]
    if oscillatory.any():
        usual = np.flatnonzero(~oscillatory)
        slopes = np.empty((len(residual), len(free)), problem.kept)
        rest = None if spread is None else spread[usual]
        slopes[:, usual] = yield from derivatives(
            problem, x, free[usual], residual, cheap, rest, central
        )
        for k in np.flatnonzero(oscillatory).tolist():
            slopes[:, k] = yield from _fine_slope(problem, x, int(free[k]), residual, cheap)
        return slopes
    width = DESCENT.wide * fineness
    if spread is not None:
        width = np.clip(spread, DESCENT.narrow * fineness, width)
    low, high = problem.limits[:, free]
    first = np.where(x[free] + 0.5 * width > high, -width, np.minimum(width, high - x[free]))
    second = np.where(x[free] - 0.5 * width < low, 2.0 * width, -np.minimum(width, x[free] - low))
    second = np.where(first < 0.0, 2.0 * first, second)
    near = yield from _differences(problem, x, free, residual, first, cheap)
    jumps = np.any(np.abs(near * first) > DESCENT.jump * problem.sd[:, None], axis=0)
    again = np.flatnonzero(jumps | central)
    if not len(again):
        return near
    far = yield from _differences(problem, x, free[again], residual, second[again], cheap)
    one, two = first[again], second[again]
    # With both steps to one side, the slope of the stretch beyond the first.
    beyond = (two * far - one * near[:, again]) / np.where(one == two, 1.0, two - one)
    far = np.where(one * two > 0.0, beyond, far)
    reach = np.maximum(np.abs(one), np.abs(two))
    jumped = np.abs(near[:, again] - far) * reach > DESCENT.jump * problem.sd[:, None]
    milder = np.where(np.abs(near[:, again]) < np.abs(far), near[:, again], far)
    near[:, again] = np.where(jumped, milder, 0.5 * (near[:, again] + far))
    return near


def _fine_slope(problem: Problem, x: Array, k: int, residual: Array, cheap: bool) -> Batched[Array]:
    """Slope by a fine coordinate, the mean of both sides.

    Of each side by the widest move that changes the predictions by one error at most.
    """
    widths = problem.fineness[k] * np.array(DESCENT.widths)
    moves = np.stack([widths, -widths])
    points = np.tile(x, (2, len(widths), 1))
    points[..., k] = np.clip(x[k] + moves, *problem.limits[:, k])
    moves = points[..., k] - x[k]
    made = yield points.reshape(-1, problem.size), cheap
    lost = (made == LOST * problem.sd) | (residual == LOST * problem.sd)
    change = np.where(lost, 0.0, residual - made).reshape(2, len(widths), -1)
    size = np.linalg.norm(change / problem.sd, axis=2)
    sides = []
    for way in range(2):
        known = np.flatnonzero(moves[way] != 0.0)
        calm = known[size[way, known] <= DESCENT.jump]
        if len(known):
            at = calm[0] if len(calm) else known[-1]
            sides.append(change[way, at] / moves[way, at])
    return np.asarray(np.mean(sides, axis=0))


def end_at(problem: Problem, causes: Sequence[Cause], x: Array) -> Batched[End]:
    """Where a model is at given coordinates, with slopes there; what it does not have is zero."""
    free, given, x = problem.free(causes), x, np.zeros(problem.size)
    x[free] = given[free]
    residual = (yield x[None, :], False)[0].copy()
    slopes = yield from derivatives(problem, x, free, residual)
    return End(x, residual, slopes, np.nan)


def _differences(
    problem: Problem, x: Array, free: Indices, residual: Array, steps: Array, cheap: bool
) -> Batched[Array]:
    """Slopes over one step of each coordinate, by one batch; 0 where a row is not computed."""
    if not len(free):
        return np.zeros((len(residual), 0))
    points = np.tile(x, (len(free), 1))
    points[np.arange(len(free)), free] += steps
    moved = yield points, cheap
    lost = (moved == LOST * problem.sd) | (residual == LOST * problem.sd)
    slopes = np.where(lost, 0.0, (residual - moved) / steps[:, None]).T
    return np.asarray(slopes, problem.kept)
