"""Fits of causes whose minima are narrow, from a dense scan of the parameter that makes them so.

How the steps of a controller fall into the pulses changes with every part in a thousand of its
period, and with it the motion, so that no search from afar gets to the right period. The responses
of a dense scan are added to what other models leave; what constants can make up for, by linear
estimate, is taken off; and the best places are simulated more closely.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.careful_fit import CAREFUL
from stickslip.diagnosis.fit.fit_result import Candidate, Fit, Start, make_candidate
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.model.problem import Array, Cause, Problem

# The numbers below are chosen, not derived. Lengths are in coordinates, of which 1 is a standard
# deviation of the prior.
#
# Distance of neighbouring places, in the parameter's fineness: with a larger one minima lie between
# them, with a smaller one the scan takes longer.
_SPACING = 0.15
# Farthest place: 99 % of the amplitudes are not larger.
_FARTHEST = 2.5
# Offsets, in spacings, at which a promising place is simulated: then none is farther from one than
# half of what a minimum is wide.
_OFFSETS = np.array([-0.4, -0.2, 0.0, 0.2, 0.4])
# Promising places of each model, and models that are followed: linear estimates put the true one
# among the first in most cases, not always first. Each is five simulations.
_PLACES, _MODELS = 12, 8
# Starts of each candidate: the best of the places may be by chance.
_STARTS = 6
# Chi-square behind the best at which a candidate is given up: room for a jump that is not yet
# passed.
_HOPELESS = 30.0
# Longest step of a constant by linear estimate.
_LARGEST_STEP = 2.0
# Least and largest multiple of a response that is taken: beyond, it is not in proportion any more.
_MULTIPLES = (0.1, 5.0)


@dataclass(frozen=True, repr=False, eq=False)
class NarrowScan(OneLine):
    """Responses of a cause to its parameter at many values.

    Attributes
    ----------
    cause : Cause
    column : int
        Coordinate of the parameter.
    spacing : float
        Of its places.
    amplitudes : tuple of int
        Coordinates of how strong the cause is besides, 1 or -1 at the places.
    place : ndarray, shape (places, size)
        All coordinates, of which the constants are those of the recalibrated model.
    gap : ndarray, shape (places, m)
        Change of the prediction by the cause, in the observable's unit.
    """

    cause: Cause
    column: int
    spacing: float
    amplitudes: tuple[int, ...]
    place: Array
    gap: Array


def scan_narrow(problem: Problem, null: Fit) -> list[NarrowScan]:
    """Scans about the recalibrated model of all causes with a fine parameter that it has not."""
    low, high = problem.limits()
    result = []
    for cause in problem.causes:
        columns = list(zip(problem.columns([cause]), cause.parameters, strict=True))
        for column, parameter in columns:
            if parameter.fineness == 1.0:
                continue
            others = [at for at, each in columns if at != column and not each.shape]
            spacing = _SPACING * parameter.fineness
            ends = max(low[column], -_FARTHEST), min(high[column], _FARTHEST)
            values = np.arange(*ends, spacing)
            values = values[parameter.value(values) != parameter.absent]
            signs = list(itertools.product((1.0, -1.0), repeat=len(others)))
            x = np.tile(null.x, (len(signs) * len(values) + 1, 1))
            x[1:, column] = np.tile(values, len(signs))
            x[1:, others] = np.repeat(signs, len(values), axis=0)
            x = np.clip(x, low, high)
            predicted = problem.predicted(x)
            gap = predicted[1:] - predicted[0]
            result.append(NarrowScan(cause, column, spacing, tuple(others), x[1:], gap))
    return result


def fit_narrow(
    problem: Problem, scans: Sequence[NarrowScan], bases: Sequence[Fit], random_restarts: int = 0
) -> list[Fit]:
    """The cause of each scan added to the models that it promises most for.

    Parameters
    ----------
    problem : Problem
    scans : sequence of NarrowScan
    bases : sequence of Fit
        Of the recalibrated model, or of single causes.
    random_restarts : int
        See `fit_candidates`.
    """
    candidates: list[Candidate] = []
    begins: list[list[Start]] = []
    for scan in scans:
        others = [fit for fit in bases if scan.cause not in fit.candidate.causes]
        promised = sorted(
            ((*_promised(problem, scan, fit), fit) for fit in others), key=lambda each: each[0]
        )
        for _, points, fit in promised[:_MODELS]:
            candidate = make_candidate(
                problem, sorted([*fit.candidate.causes, scan.cause], key=lambda each: each.name)
            )
            candidates.append(candidate)
            begins.append(_looked_at_closely(problem, scan, fit, candidate, points))
    return fit_candidates(
        problem, candidates, begins, CAREFUL, _HOPELESS, random_restarts=random_restarts
    )


def _promised(problem: Problem, scan: NarrowScan, fit: Fit) -> tuple[float, Array]:
    """What the best place would leave of chi-square, and coordinates of the best places."""
    gap = np.where(np.isfinite(scan.gap), scan.gap, 0.0) @ problem.whiten.T
    gap = np.pad(gap, ((0, 0), (0, len(fit.residual) - gap.shape[1])))
    multiple = np.ones((len(gap), 1))
    if scan.amplitudes:
        basis = np.linalg.qr(fit.jacobian)[0]
        own = gap - (gap @ basis) @ basis.T
        power = np.maximum(np.sum(own**2, axis=1), np.finfo(float).tiny)
        multiple[:, 0] = np.clip(own @ fit.residual / power, *_MULTIPLES)
    left, step = _absorbed(fit, fit.residual - multiple * gap)
    best = np.argsort(left, kind="stable")[:_PLACES]
    x = np.tile(fit.x, (len(best), 1))
    x[:, fit.candidate.free] += step[best]
    x[:, scan.column] = scan.place[best, scan.column]
    strong = list(scan.amplitudes)
    # As `CauseParameter.value`, whose coordinate is 1 at the scale.
    x[:, strong] = np.arcsinh(multiple[best] * np.sinh(scan.place[best][:, strong]))
    return float(left[best[0]]), np.clip(x, *problem.limits())


def _absorbed(fit: Fit, rest: Array) -> tuple[Array, Array]:
    """Chi-square that is left of residuals once the fit's free coordinates have moved, and how."""
    basis, factor = np.linalg.qr(fit.jacobian)
    along = rest @ basis
    step = np.linalg.solve(factor, along.T).T
    left = np.sum(rest**2, axis=1) - np.sum(along**2, axis=1)
    return left, np.clip(step, -_LARGEST_STEP, _LARGEST_STEP)


def _looked_at_closely(
    problem: Problem, scan: NarrowScan, fit: Fit, candidate: Candidate, points: Array
) -> list[Start]:
    """The best starts of those about the points, with what the constants may still make up for."""
    x = np.repeat(points, len(_OFFSETS), axis=0)
    x[:, scan.column] += np.tile(scan.spacing * _OFFSETS, len(points))
    x = np.clip(x, *problem.limits())
    free = fit.candidate.free
    rest = np.hstack([problem.residuals(x), -x[:, free] / fit.candidate.width])
    left, step = _absorbed(fit, rest)
    left += x[:, scan.column] ** 2
    best = np.argsort(left, kind="stable")[:_STARTS]
    x[:, free] += step
    return [Start(each) for each in np.clip(x[best], *problem.limits())]
