"""Pairs of causes: a screen of all, fits of the most promising, and what they tell of singles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stickslip.diagnosis.fit.careful_fit import CAREFUL, refine, search_until_converged
from stickslip.diagnosis.fit.fit_result import Fit, Start, make_candidate, ranked
from stickslip.diagnosis.fit.multistart import (
    AGREE,
    LARGEST_INFLATION,
    SMALLER_INFLATION,
    fit_candidates,
)
from stickslip.diagnosis.fit.sensitivity import UNSEEN, projected_responses, screen
from stickslip.diagnosis.fit.single_cause import quick_fits, without_cause
from stickslip.diagnosis.fit.view import View
from stickslip.diagnosis.model.problem import Array, Problem

# The numbers below are chosen, not derived.
#
# Pairs that are fitted, of those that the screen ranks: the linear screen puts a true pair behind
# its twins, so fewer miss it; each costs the stages of a quick fit. Beside each leading single
# cause it is half as many.
_PAIRS = 16
_PAIRS_BESIDE = _PAIRS // 2
# Pairs of causes that the screen of one view keeps, each at its best amplitudes: twice what is
# fitted, as the views are ranked together after it.
_SCREENED = 2 * _PAIRS
# Pairs that are promised at distant points of the constants, and starts of each: of so many the
# best are known by a simulation each.
_DISTANT, _DISTANT_STARTS = 48, 3
# Pairs that are refitted with care: more than of single causes, as many pairs are nearly
# equivalent.
_SURVIVORS = 10
# Leading single causes beside which second ones are looked at: where two causes act, a wrong one
# may lead, and with fewer both members may be absent.
_CENTRES = 3
# Pull, in standard deviations of the prior, from which on a constant is released: an honest prior
# gives a larger one in one case of seven, and with a larger limit a constant that makes up for a
# cause stays where it is.
_PULLED = 1.5
# Least multiple of a response with which a start has the cause: with none the search would begin
# where the cause has no slope.
_LEAST_MULTIPLE = 0.2
# Least determinant of two responses, in whitened units: below it they are one and the same.
_SINGULAR = 1e-12

Pairs = dict[tuple[str, str], tuple[float, Start]]
"""For two names in the order of the alphabet: chi-square that is left, and where to begin."""


def fit_pairs(
    problem: Problem,
    views: Sequence[View],
    singles: Sequence[Fit],
    scanned: Array,
    local_minima: Sequence[Fit] = (),
    random_restarts: int = 0,
) -> tuple[Fit, ...]:
    """Screen all pairs with finite amplitudes, and fit the most promising.

    Three screens: the sum of two responses of the recalibrated model, for every pair and pair of
    amplitudes; the same at points all over the constants' priors, `scanned`, because two strong
    causes draw the recalibrated constants far away; and, about the leading single fits, responses
    simulated again, because causes change each other's effect.
    """
    found: Pairs = {}
    for base in (*(view.fit for view in views), *local_minima):
        for view in views:
            for key, (left, start) in _added(view.moved_to(base, SMALLER_INFLATION)).items():
                if key not in found or left < found[key][0]:
                    found[key] = (left, start)
    added = sorted(found, key=lambda key: found[key][0])[:_PAIRS]
    fits = _tried(problem, [(key, found[key][1]) for key in added], 0)
    fits += _tried(problem, _distant(problem, views, scanned), 0)
    for single in singles[:_CENTRES]:
        fits += _fits_beside(problem, single)
    fits.sort(key=lambda fit: fit.chi2)
    best: dict[str, Fit] = {}
    others: dict[str, list[Start]] = {}
    for fit in fits:
        if best.setdefault(fit.name, fit) is not fit:
            others.setdefault(fit.name, []).append(Start.of(fit))
    return refine(problem, list(best.values()), others, random_restarts, _SURVIVORS)


def second_causes(problem: Problem, single: Fit, random_restarts: int = 0) -> tuple[Fit, ...]:
    """A second look: pairs of an accepted single cause with each other cause that promises most.

    With care only those that are more likely than the single cause by themselves.
    """
    best: dict[str, Fit] = {}
    for fit in sorted(_fits_beside(problem, single), key=lambda fit: fit.chi2):
        best.setdefault(fit.name, fit)
    fits = ranked(list(best.values()))
    leading = [fit for fit in fits if fit.log_evidence > single.log_evidence]
    if not leading:
        return fits
    careful = {fit.name: fit for fit in refine(problem, leading, {}, random_restarts)}
    return ranked([careful.get(fit.name, fit) for fit in fits])


def _fits_beside(problem: Problem, single: Fit) -> list[Fit]:
    """Quick fits of pairs of a single cause with a second one, from the fit of the single one."""
    beside = sorted(_beside(problem, single).items(), key=lambda item: item[1][0])
    near = [(key, start) for key, (_, start) in beside[:_PAIRS_BESIDE]]
    # Near enough to begin with smaller errors than far from any fit.
    fits = _tried(problem, near, 2)
    return [*fits, *_tried(problem, beside_a_released_constant(problem, single), 1)]


def _tried(
    problem: Problem, plan: Sequence[tuple[tuple[str, str], Start]], first: int
) -> list[Fit]:
    by_name = {cause.name: cause for cause in problem.causes}
    candidates = [make_candidate(problem, [by_name[a], by_name[b]]) for (a, b), _ in plan]
    return quick_fits(problem, candidates, [[start] for _, start in plan], first)


def singles_beside(
    problem: Problem, singles: Sequence[Fit], pairs: Sequence[Fit]
) -> tuple[Fit, ...]:
    """Single causes fitted again from where the leading pairs have ended, without the other one."""
    alone = [
        without_cause(problem, fit, cause)
        for fit in pairs[:_CENTRES]
        for cause in fit.candidate.causes
    ]
    begins = [[Start.of(fit), Start(fit.x)] for fit in alone]
    found = {fit.name: fit for fit in singles}
    for fit in fit_candidates(problem, [fit.candidate for fit in alone], begins, CAREFUL):
        if fit.name in found and fit.chi2 < found[fit.name].chi2 - AGREE:
            # Its starts began at one point, so that they agree says nothing.
            found[fit.name] = replace(fit, converged=False, starts=fit.starts[:1])
    return ranked(search_until_converged(problem, list(found.values())))


def beside_a_released_constant(
    problem: Problem, single: Fit
) -> list[tuple[tuple[str, str], Start]]:
    """Starts with a second cause in the place of the constant that is pulled most from its prior.

    While the constant makes up for the cause, the cause improves nothing beside it. Each start
    comes with the names of its pair in the order of the alphabet; none, if no constant is pulled.
    """
    known = np.array([each.prior.has_middle for each in problem.uncertain])
    p = problem.base_count
    pulls = np.abs(single.x[:p] / single.candidate.width[:p]) * known
    if np.max(pulls, initial=0.0) < _PULLED:
        return []
    x, constant = single.x.copy(), int(np.argmax(pulls))
    x[constant] = 0.0
    (base,) = fit_candidates(problem, [single.candidate], [[Start(x)]], 0, exact=False)
    view = View.of(problem, base)
    left = _left_without(view.moved_to(base, SMALLER_INFLATION), constant)
    result = []
    for index in sorted(left, key=lambda index: left[index])[:_PAIRS_BESIDE]:
        names = sorted([single.name, problem.causes[index].name])
        for start in view.starts_at(index):
            result.append(((names[0], names[1]), start))
    return result


def _left_without(view: View, constant: int) -> dict[int, float]:
    """Chi-square that each cause would leave at best, by linear estimate, where a constant stays.

    Causes are by their index; those that the fit has, relaxed constants and those that are not seen
    are left out.
    """
    fit, sensitivities = view.fit, view.sensitivities
    others = fit.jacobian[:, fit.candidate.free != constant]
    projected, basis, _ = projected_responses(sensitivities.raw, others)
    residual = fit.residual - basis @ (basis.T @ fit.residual)
    left = screen(replace(sensitivities, projected=projected), residual).left
    result: dict[int, float] = {}
    for row in np.flatnonzero((sensitivities.at >= 0) & (sensitivities.size > UNSEEN)).tolist():
        index = int(sensitivities.cause[row])
        result[index] = min(result.get(index, np.inf), float(left[row]))
    return result


def _added(view: View) -> Pairs:
    """What the sum of two causes' responses would leave, each at its best multiple."""
    problem, null, sensitivities = view.problem, view.fit, view.sensitivities
    rows = np.flatnonzero(sensitivities.size > UNSEEN)
    projected, cause = sensitivities.projected[rows], sensitivities.cause[rows]
    gram = projected @ projected.T
    along = projected @ null.residual
    power = np.diag(gram) + sensitivities.prior_cost[rows]
    # Two multiples by least squares; those below zero or far above one are not trusted.
    determinant = np.maximum(power[:, None] * power[None, :] - gram**2, _SINGULAR)
    first = (along[:, None] * power[None, :] - gram * along[None, :]) / determinant
    most = sensitivities.largest_multiple[rows]
    first = np.clip(first, 0.0, most[:, None])
    second = np.clip((along[None, :] - gram * first) / power[None, :], 0.0, most[None, :])
    fall = (
        2.0 * (first * along[:, None] + second * along[None, :])
        - first**2 * power[:, None]
        - second**2 * power[None, :]
        - 2.0 * first * second * gram
    )
    moved = null.jacobian @ np.linalg.lstsq(null.jacobian, null.residual, rcond=None)[0]
    left = null.chi2 - moved @ moved - fall
    left[cause[:, None] >= cause[None, :]] = np.inf
    result: Pairs = {}
    seen: set[tuple[int, int]] = set()
    for flat in np.argsort(left, axis=None, kind="stable"):
        i, j = (int(each) for each in np.unravel_index(flat, left.shape))
        if not np.isfinite(left[i, j]) or len(seen) >= _SCREENED:
            break
        if (cause[i], cause[j]) in seen:
            continue
        seen.add((cause[i], cause[j]))
        multiples = {int(rows[i]): float(first[i, j]), int(rows[j]): float(second[i, j])}
        names = sorted(problem.causes[each].name for each in (cause[i], cause[j]))
        start = _joined(view, multiples)
        result[names[0], names[1]] = (float(left[i, j]), start)
    return result


def _distant(
    problem: Problem, views: Sequence[View], scanned: Array
) -> list[tuple[tuple[str, str], Start]]:
    """Starts of the pairs that promise most at points all over the constants' priors.

    What each point leaves is simulated, the responses of the causes are those of the views, and of
    the starts that are promised the simulated ones with the least misfit are kept.
    """
    softer = problem.with_inflated_errors(LARGEST_INFLATION)
    without = problem.whitened(softer.predicted(scanned))
    free = views[0].fit.candidate.free
    promised: dict[tuple[str, str], list[tuple[float, Start]]] = {}
    for point, data in zip(scanned, without, strict=True):
        residual = np.concatenate([data, -point[free]])
        for view in views:
            base = replace(view.fit, x=point, residual=residual, chi2=float(residual @ residual))
            for key, each in _added(view.moved_to(base, SMALLER_INFLATION)).items():
                promised.setdefault(key, []).append(each)
    for starts in promised.values():
        starts.sort(key=lambda each: each[0])
    keys = sorted(promised, key=lambda key: promised[key][0][0])[:_DISTANT]
    plan = [(key, start) for key in keys for _, start in promised[key][:_DISTANT_STARTS]]
    if not plan:
        return []
    x = np.clip(np.stack([start.x for _, start in plan]), *problem.limits())
    misfit = np.sum(softer.residuals(x) ** 2, axis=1) + np.sum(x**2, axis=1)
    best: dict[tuple[str, str], Start] = {}
    for row in np.argsort(misfit, kind="stable").tolist():
        key, start = plan[row]
        best.setdefault(key, start)
    return list(best.items())[:_PAIRS]


def _joined(view: View, multiples: dict[int, float]) -> Start:
    """Start of a pair from multiples of two rows of the sensitivities."""
    problem, null, sensitivities = view.problem, view.fit, view.sensitivities
    p, m = problem.base_count, len(problem.observed)
    columns = problem.columns([problem.causes[sensitivities.cause[row]] for row in multiples])
    x, slope = null.x.copy(), np.zeros((m, len(columns)))
    x[:p] += view.linear_step
    for row, multiple in multiples.items():
        at = int(sensitivities.at[row])
        amount = max(multiple, _LEAST_MULTIPLE)
        x[:p] += amount * (sensitivities.point[row, :p] - null.x[:p])
        if at < 0:
            continue
        extra = [k for k in range(p, problem.size) if sensitivities.point[row, k] != 0.0]
        x[extra] = sensitivities.point[row, extra]
        x[at] = amount * sensitivities.amplitude[row]
        slope[:, columns.index(at)] = sensitivities.gap[row] / sensitivities.amplitude[row]
    return Start(x, np.hstack([null.slope, slope]))


def _beside(problem: Problem, single: Fit) -> Pairs:
    """What a second cause would leave beside a single one, with responses simulated there."""
    view = View.of(problem, single).moved_to(single, SMALLER_INFLATION)
    result: Pairs = {}
    for index, cause in enumerate(problem.causes):
        if cause not in single.candidate.causes:
            names = sorted([single.candidate.causes[0].name, cause.name])
            for found in view.starts(index, 1):
                result[names[0], names[1]] = found
    return result
