"""Pairs of causes: a screen of all, fits of the most promising, and what they tell of singles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.fit.fit_result import Fit, Start, make_rival
from stickslip.diagnosis.fit.least_squares import SOFT, fit_rivals
from stickslip.diagnosis.model.problem import Problem
from stickslip.diagnosis.fit.single_cause import (
    CAREFUL,
    Views,
    certify,
    quick_fits,
    refine,
    without,
)
from stickslip.diagnosis.fit.sensitivity import (
    UNSEEN,
    Signatures,
    farthest,
    find_signatures,
    in_place,
    price,
    screen,
    seen_from,
    settle,
    starts,
)

Array = NDArray[np.float64]

_PAIRS = 16
_CENTRES = 3
_PULLED = 1.5
_SURVIVORS = 10


def fit_pairs(
    problem: Problem,
    views: Views,
    singles: Sequence[Fit],
    basins: Sequence[Fit] = (),
    clouds: int = 0,
) -> tuple[Fit, ...]:
    """Screen all pairs with finite amplitudes, and fit the most promising.

    Two screens: the sum of two responses of the recalibrated model, for every pair and pair of
    amplitudes; and, about the leading single fits, responses simulated anew, as causes bend each
    other's effect.
    """
    found: Pairs = {}
    for base in (*(fit for fit, _ in views), *basins):
        for _, signatures in views:
            softer, seen_there = seen_from(problem, signatures, base, SOFT)
            for key, (left, start) in _added(problem, softer, seen_there).items():
                if key not in found or left < found[key][0]:
                    found[key] = (left, start)
    added = sorted(found, key=lambda key: found[key][0])[:_PAIRS]
    near = [
        (key, start)
        for beside in (_beside(problem, single) for single in singles[:_CENTRES])
        for key, (_, start) in sorted(beside.items(), key=lambda item: item[1][0])[: _PAIRS // 2]
    ]
    by_name = {cause.name: cause for cause in problem.causes}

    def walk(plan: Sequence[tuple[tuple[str, str], Start]], first: int) -> list[Fit]:
        rivals = [make_rival(problem, [by_name[a], by_name[b]]) for (a, b), _ in plan]
        return quick_fits(problem, rivals, [[start] for _, start in plan], first)

    # Those that begin at a fit of one of them are near enough to begin with smaller errors.
    fits = [*walk([(key, found[key][1]) for key in added], 0), *walk(near, 2)]
    for single in singles[:_CENTRES]:
        fits += walk(beside_a_released_constant(problem, single), 1)
    fits.sort(key=lambda fit: fit.chi2)
    best: dict[str, Fit] = {}
    others: dict[str, list[Start]] = {}
    for fit in fits:
        if best.setdefault(fit.name, fit) is not fit:
            others.setdefault(fit.name, []).append(Start.of(fit))
    return refine(problem, list(best.values()), others, clouds, _SURVIVORS)


def singles_beside(
    problem: Problem, singles: Sequence[Fit], pairs: Sequence[Fit]
) -> tuple[Fit, ...]:
    """Single causes again from where the leading pairs have led them, without their companion."""
    place = {fit.name: k for k, fit in enumerate(singles)}
    rivals, begins = [], []
    for fit in pairs[:_CENTRES]:
        for cause in fit.rival.causes:
            alone = without(problem, fit, cause)
            rivals.append(alone.rival)
            begins.append([Start.of(alone), Start(alone.x)])
    result = list(singles)
    for fit in fit_rivals(problem, rivals, begins, CAREFUL):
        at = place.get(fit.name)
        if at is not None and fit.chi2 < result[at].chi2 - 1.0:
            # Its starts began at one point, so that they agree says nothing.
            result[at] = replace(fit, certified=False)
    certify(problem, result, 0)
    return tuple(sorted(result, key=lambda fit: -fit.log_evidence))


def beside_a_released_constant(
    problem: Problem, single: Fit
) -> list[tuple[tuple[str, str], Start]]:
    """Starts with a second cause in the place of the constant that is pulled most from its prior.

    While the constant makes up for the cause, the cause does nothing good beside it.

    Parameters
    ----------
    problem : Problem
    single : Fit
        Of one cause.

    Returns
    -------
    list of tuple
        Names of a pair, in the order of the alphabet, and where to begin with it; empty if no
        constant is pulled.
    """
    known = np.array([each.prior.has_middle for each in problem.uncertain])
    p = problem.base_count
    pulls = np.abs(single.x[:p] / single.rival.width[:p]) * known
    if np.max(pulls, initial=0.0) < _PULLED:
        return []
    x = single.x.copy()
    x[np.argmax(pulls)] = 0.0
    base = fit_rivals(problem, [single.rival], [[Start(x)]], 0, exact=False)[0]
    signatures = find_signatures(problem, base)
    result = []
    for index, cause in enumerate(problem.causes):
        if cause.frees is not None or cause in single.rival.causes:
            continue
        names = sorted([single.name, cause.name])
        for start in in_place(problem, base, signatures, index):
            result.append(((names[0], names[1]), start))
    return result


Pairs = dict[tuple[str, str], tuple[float, Start]]
"""For two names in the order of the alphabet: chi-square that is left, and where to begin."""


def _added(problem: Problem, null: Fit, signatures: Signatures) -> Pairs:
    """What the sum of two causes' responses would leave, each at its best multiple."""
    rows = np.flatnonzero(signatures.size > UNSEEN)
    absorbed, cause = signatures.absorbed[rows], signatures.cause[rows]
    gram = absorbed @ absorbed.T
    along = absorbed @ null.residual
    power = np.diag(gram) + price(signatures)[rows]
    # Two multiples by least squares; those below zero or far above one are not trusted.
    determinant = np.maximum(power[:, None] * power[None, :] - gram**2, 1e-12)
    first = (along[:, None] * power[None, :] - gram * along[None, :]) / determinant
    most = farthest(signatures)[rows]
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
    number = len(problem.causes)
    code = cause[:, None] * number + cause[None, :]
    order = np.argsort(left, axis=None, kind="stable")
    seen: set[int] = set()
    for flat in order:
        i, j = np.unravel_index(flat, left.shape)
        if not np.isfinite(left[i, j]) or len(seen) >= 2 * _PAIRS:
            break
        if int(code[i, j]) in seen:
            continue
        seen.add(int(code[i, j]))
        key, start = _joined(
            problem,
            null,
            signatures,
            (int(rows[i]), int(rows[j])),
            (float(first[i, j]), float(second[i, j])),
        )
        result[key] = (float(left[i, j]), start)
    return result


def _joined(
    problem: Problem,
    null: Fit,
    signatures: Signatures,
    rows: tuple[int, int],
    scales: tuple[float, float],
) -> tuple[tuple[str, str], Start]:
    """Start of a pair from two rows of the signatures."""
    p, m = problem.base_count, len(problem.observed)
    causes = [problem.causes[signatures.cause[row]] for row in rows]
    columns = problem.columns(causes)
    x, slope = null.x.copy(), np.zeros((m, len(columns)))
    x[:p] += settle(null)
    for row, scale in zip(rows, scales, strict=True):
        at = int(signatures.at[row])
        amount = max(float(scale), 0.2)
        x[:p] += amount * (signatures.point[row, :p] - null.x[:p])
        if at < 0:
            continue
        extra = [k for k in range(p, problem.size) if signatures.point[row, k] != 0.0]
        x[extra] = signatures.point[row, extra]
        x[at] = amount * signatures.amplitude[row]
        slope[:, columns.index(at)] = signatures.gap[row] / signatures.amplitude[row]
    names = sorted(cause.name for cause in causes)
    return (names[0], names[1]), Start(x, np.hstack([null.slope, slope]))


def _beside(problem: Problem, single: Fit) -> Pairs:
    """What a second cause would leave beside a single one, its responses simulated anew there."""
    softer, signatures = seen_from(problem, find_signatures(problem, single), single, SOFT)
    screened = screen(signatures, softer.residual)
    result: Pairs = {}
    for index, cause in enumerate(problem.causes):
        if cause in single.rival.causes:
            continue
        names = sorted([single.rival.causes[0].name, cause.name])
        for left, start in starts(problem, softer, signatures, screened, index, 1):
            result[names[0], names[1]] = (left, start)
    return result
