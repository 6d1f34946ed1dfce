"""Fits of all single causes and, where none is adequate, of pairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.detection import lack_of_fit_p
from stickslip.diagnosis.fitting import Fit, fit_rivals, make_rival
from stickslip.diagnosis.model import Cause, Problem
from stickslip.diagnosis.signatures import AMPLITUDES, Signatures, best_row

Array = NDArray[np.float64]

ADEQUATE = 0.01
"""A model is adequate whose lack of fit has at least this p-value."""

COMFORTABLE = 0.3
"""With a single cause of at least this p-value, no pair is looked for."""

_QUICK, _CAREFUL = 3, 8
_SURVIVORS = 6
_WITHIN = 14.0
_HOPELESS = 60.0
_CLOUDS = 3
_LEADING = 2


@dataclass(frozen=True)
class Ranking:
    """Rivals, best first.

    Attributes
    ----------
    null : Fit
    singles, pairs : tuple of Fit
        By log-evidence, falling.
    """

    null: Fit
    singles: tuple[Fit, ...]
    pairs: tuple[Fit, ...]


def adequacy(problem: Problem, fit: Fit) -> float:
    """p-value of the lack of fit of a rival."""
    extra = len(fit.rival.free) - problem.base_count
    return lack_of_fit_p(fit.chi2, len(problem.observed) - extra, problem.dof)


def fit_singles(problem: Problem, null: Fit, signatures: Signatures) -> tuple[Fit, ...]:
    """Fit every cause quickly.

    Parameters
    ----------
    problem : Problem
    null : Fit
    signatures : Signatures
        Their rows are the starts.
    """
    causes, starts = [], []
    for index, cause in enumerate(problem.causes):
        row = best_row(signatures, null.residual, index)
        if row is None:
            continue
        causes.append(cause)
        starts.append([signatures.point[row]])
    rivals = [make_rival(problem, [cause]) for cause in causes]
    quick = fit_rivals(problem, rivals, starts, _QUICK, _HOPELESS)
    return tuple(sorted(quick, key=lambda fit: -fit.log_evidence))


def refine(problem: Problem, quick: Sequence[Fit], scanned: Array) -> tuple[Fit, ...]:
    """Refit the survivors with care and from several starts; the rest keep their quick fits."""
    order = sorted(range(len(quick)), key=lambda k: -quick[k].log_evidence)
    if not order:
        return ()
    best = quick[order[0]].log_evidence
    chosen = [k for k in order[:_SURVIVORS] if quick[k].log_evidence > best - _WITHIN]
    starts = []
    for k in chosen:
        other = _other_starts(problem, quick[k], scanned)
        starts.append([quick[k].x, *other])
    careful = fit_rivals(
        problem, [quick[k].rival for k in chosen], starts, _CAREFUL, clouds=_CLOUDS
    )
    result = list(quick)
    for k, fit in zip(chosen, careful, strict=True):
        result[k] = fit
    _agree(problem, result)
    return tuple(sorted(result, key=lambda fit: -fit.log_evidence))


def _agree(problem: Problem, fits: list[Fit]) -> None:
    """Two more starts, a posterior's width away, for leading rivals whose starts do not agree."""
    order = sorted(range(len(fits)), key=lambda k: -fits[k].log_evidence)[:_LEADING]
    doubtful = [k for k in order if not fits[k].certified]
    low, high = problem.limits()
    random = np.random.default_rng(7)
    starts = []
    for k in doubtful:
        free = fits[k].rival.free
        spread = np.clip(np.sqrt(np.diag(fits[k].covariance)), 0.05, 0.5)
        points = [fits[k].x]
        for _ in range(2):
            point = fits[k].x.copy()
            point[free] += spread * random.standard_normal(len(free))
            points.append(np.clip(point, low, high))
        starts.append(points)
    rivals = [fits[k].rival for k in doubtful]
    for k, fit in zip(
        doubtful, fit_rivals(problem, rivals, starts, _CAREFUL, clouds=2 * _CLOUDS), strict=True
    ):
        fits[k] = fit


def _other_starts(problem: Problem, fit: Fit, scanned: Array) -> list[Array]:
    """Two starts far from the quick fit: the best of a scan of amplitudes, and one nearby."""
    low, high = problem.limits()
    extra = [k for k in fit.rival.free if k >= problem.base_count]
    grid = []
    for base in scanned:
        amplitudes = [0.0] if not extra else [s * a for a in AMPLITUDES for s in (1.0, -1.0)]
        for amplitude in amplitudes:
            point = base.copy()
            point[extra] = 0.0
            for k in extra:
                shape = problem.parameters[k - problem.base_count].shape
                point[k] = 0.0 if shape else np.clip(amplitude, low[k], high[k])
            grid.append(point)
    points = np.array(grid)
    chi2 = np.sum(problem.residuals(points) ** 2, axis=1)
    chi2 += np.sum((points[:, fit.rival.free] / fit.rival.width) ** 2, axis=1)
    nearby = fit.x.copy()
    free = fit.rival.free
    spread = np.sqrt(np.diag(fit.covariance))
    signs = np.where(np.arange(len(free)) % 2 == 0, 1.0, -1.0)
    nearby[free] = np.clip(nearby[free] + signs * np.minimum(spread, 0.5), low[free], high[free])
    return [points[int(np.argmin(chi2))], nearby]


def fit_pairs(problem: Problem, singles: Sequence[Fit], scanned: Array) -> tuple[Fit, ...]:
    """Screen all pairs with finite amplitudes, and fit the most promising.

    A pair is screened about the fit of each of its members: what is left of the residual once the
    other has its best amplitude and everything is recalibrated.
    """
    m = len(problem.observed)
    screened: dict[tuple[str, str], tuple[float, Array]] = {}
    bends = [fit for fit in singles if fit.rival.causes]
    plan: list[tuple[Fit, Cause, Array]] = []
    for fit in bends:
        first = fit.rival.causes[0]
        for cause in problem.causes:
            if cause.name == first.name:
                continue
            for point in _amplitude_points(problem, fit.x, cause):
                plan.append((fit, cause, point))
    if not plan:
        return ()
    predicted = problem.predicted(np.stack([point for _, _, point in plan]))
    at_fit = {fit.name: problem.predicted(fit.x[None, :])[0] for fit in bends}
    projectors = {fit.name: np.linalg.qr(fit.jacobian)[0] for fit in bends}
    for (fit, cause, point), row in zip(plan, predicted, strict=True):
        gap = row - at_fit[fit.name]
        raw = np.zeros(len(fit.residual))
        raw[:m] = problem.whiten @ np.where(np.isfinite(gap), gap, 0.0)
        basis = projectors[fit.name]
        absorbed = raw - basis @ (basis.T @ raw)
        left = float(np.sum((fit.residual - absorbed) ** 2))
        names = sorted([fit.rival.causes[0].name, cause.name])
        key = (names[0], names[1])
        if key not in screened or left < screened[key][0]:
            start = point.copy()
            start[fit.rival.free] -= np.linalg.lstsq(fit.jacobian, raw, rcond=None)[0]
            screened[key] = (left, start)
    order = sorted(screened, key=lambda key: screened[key][0])[: 3 * _SURVIVORS]
    by_name = {cause.name: cause for cause in problem.causes}
    rivals = [make_rival(problem, [by_name[a], by_name[b]]) for a, b in order]
    quick = fit_rivals(problem, rivals, [[screened[key][1]] for key in order], _QUICK, _HOPELESS)
    return refine(problem, quick, scanned[:2])


def _amplitude_points(problem: Problem, x: Array, cause: Cause) -> list[Array]:
    low, high = problem.limits()
    points = []
    columns = problem.columns([cause])
    if cause.frees is not None:
        index = [each.name for each in problem.uncertain].index(cause.frees)
        for amplitude in (-3.0, 3.0):
            point = x.copy()
            point[index] += amplitude
            points.append(point)
    for at in columns:
        if problem.parameters[at - problem.base_count].shape:
            continue
        for amplitude in (-1.5, -0.5, 0.5, 1.5):
            u = float(np.clip(amplitude, low[at], high[at]))
            if u != 0.0:
                point = x.copy()
                point[at] = u
                points.append(point)
    return points
