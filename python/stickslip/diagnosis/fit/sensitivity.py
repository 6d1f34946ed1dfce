"""What each cause does to the data that recalibration cannot undo.

A cause's response is taken at several finite amplitudes, because a piecewise smooth model has
causes without a slope at zero. What the uncertain parameters can make up for, within their priors,
is projected out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.model.problem import PRIOR_INFLATION, Array, Indices, Problem

AMPLITUDES = (0.15, 0.6, 2.0)
"""Amplitudes at which responses are taken, in units of the parameter's scale. Chosen: a factor of
about four apart."""

UNSEEN = 1e-3
"""Signal to noise after projection below which a response counts as none. Chosen: no test could
show it."""

# Coordinates of a shape at which responses are taken. Chosen: 1.5 standard deviations of its prior.
_SHAPES = (-1.5, 0.0, 1.5)
# Largest move of a constant that makes up for a response, in standard deviations of its prior.
# Chosen: a bound for what is only a linear estimate.
_FAR = 6.0
# Multiple of a response up to which it is trusted: of a relaxed constant, and of an amplitude.
# Chosen: a response says little of amplitudes far beyond its own.
_CONSTANT_MULTIPLE, _LARGEST_MULTIPLE = 8.0, 1.8


@dataclass(frozen=True, repr=False, eq=False)
class Sensitivities(OneLine):
    """Projected responses of all causes, a row each.

    Attributes
    ----------
    cause : ndarray of int, shape (rows,)
        Index of the cause.
    point : ndarray, shape (rows, size)
        Coordinates at which the cause has this response and the rest is recalibrated.
    at : ndarray of int, shape (rows,)
        Column of the parameter that has the amplitude; -1 for a relaxed constant.
    amplitude : ndarray, shape (rows,)
        Its coordinate; 1 for a relaxed constant.
    gap : ndarray, shape (rows, m)
        Response in the observable's unit.
    raw, projected : ndarray, shape (rows, m + p)
        Whitened response with prior rows, before and after recalibration.
    basis : ndarray, shape (m + p, p)
        Orthonormal; what recalibration can do.

    About a fit with causes of its own, p counts their parameters too: what they can undo is
    projected.
    """

    cause: Indices
    point: Array
    at: Indices
    amplitude: Array
    gap: Array
    raw: Array
    projected: Array
    basis: Array

    @cached_property
    def size(self) -> Array:
        """Signal to noise of each row after projection."""
        return np.asarray(np.linalg.norm(self.projected, axis=1))

    @property
    def prior_cost(self) -> Array:
        """Chi-square of the amplitude's prior at each row, shape (rows,).

        A relaxed constant is a shift of the prior's mean, of which each row is one standard
        deviation.
        """
        relaxed = 1.0 / (PRIOR_INFLATION**2 - 1.0)
        return np.where(self.at < 0, relaxed, self.amplitude**2)

    @property
    def largest_multiple(self) -> Array:
        """Multiple of each row up to which its response is trusted, shape (rows,)."""
        return np.where(self.at < 0, _CONSTANT_MULTIPLE, _LARGEST_MULTIPLE)

    def directions(self) -> Array:
        """Unit vectors of the rows that can be seen."""
        seen = self.size > UNSEEN
        return np.asarray(self.projected[seen] / self.size[seen, None])

    def seen_rows(self, cause: int) -> Indices:
        """Rows of a cause that can be seen."""
        return np.flatnonzero((self.cause == cause) & (self.size > UNSEEN))


def find_sensitivities(problem: Problem, base: Fit) -> Sensitivities:
    """Responses of all causes at the recalibrated model, or of all others about a fit of some.

    Parameters
    ----------
    problem : Problem
    base : Fit
        The recalibrated model, or a fit with some causes.

    Returns
    -------
    Sensitivities
    """
    free, m = base.candidate.free, len(problem.observed)
    plan = list(_amplitudes(problem, base))
    points = np.tile(base.x, (len(plan), 1))
    for row, (_, at, amplitude, shapes, shape) in enumerate(plan):
        points[row, at], points[row, shapes] = amplitude, shape
    names = [each.name for each in problem.uncertain]
    relaxed = [
        (index, names.index(cause.relaxes_prior), sign)
        for index, cause in enumerate(problem.causes)
        if cause.relaxes_prior is not None and cause not in base.candidate.causes
        for sign in (1.0, -1.0)
    ]
    gap = np.zeros((len(plan) + len(relaxed), m))
    if plan:
        predicted = problem.predicted(np.vstack([base.x, points]))
        response = predicted[1:] - predicted[0]
        gap[: len(plan)] = np.where(np.isfinite(response), response, 0.0)
    raw = np.hstack([gap @ problem.whiten.T, np.zeros((len(gap), len(free)))])
    for row, (_, column, sign) in enumerate(relaxed, start=len(plan)):
        raw[row, m + column] = -sign
    projected, basis, move = projected_responses(raw, base.jacobian)
    # The point of each row: the baseline moves to undo what it can of the response.
    full = np.vstack([points, np.tile(base.x, (len(relaxed), 1))])
    full[:, free] -= move
    return Sensitivities(
        np.array([row[0] for row in (*plan, *relaxed)], dtype=np.int64),
        full,
        np.array([at for _, at, *_ in plan] + [-1] * len(relaxed), dtype=np.int64),
        np.array([size for _, _, size, *_ in plan] + [1.0] * len(relaxed)),
        gap,
        raw,
        projected,
        basis,
    )


def _amplitudes(problem: Problem, base: Fit) -> Iterator[tuple[int, int, float, list[int], float]]:
    """Responses to simulate: cause, its column and amplitude, its shapes' columns and value."""
    low, high = problem.limits()
    for index, cause in enumerate(problem.causes):
        if cause.relaxes_prior is not None or cause in base.candidate.causes:
            continue
        columns = problem.columns([cause])
        shapes = [at for at in columns if problem.parameters[at - problem.base_count].shape]
        for at in (at for at in columns if at not in shapes):
            reached = {
                float(np.clip(sign * amplitude, low[at], high[at]))
                for amplitude in AMPLITUDES
                for sign in (1.0, -1.0)
            }
            for u in sorted(reached - {0.0}, key=lambda u: (abs(u), -u)):
                for shape in _SHAPES if shapes else (0.0,):
                    yield index, at, u, shapes, shape


def projected_responses(raw: Array, jacobian: Array) -> tuple[Array, Array, Array]:
    """Responses after recalibration, the basis of what that can do, and the moves that do it."""
    basis = np.linalg.qr(jacobian)[0]
    projected = raw - (raw @ basis) @ basis.T
    move = np.linalg.lstsq(jacobian, raw.T, rcond=None)[0].T
    return projected, basis, np.clip(move, -_FAR, _FAR)


@dataclass(frozen=True, repr=False, eq=False)
class Screened(OneLine):
    """Each row at the multiple of its response that fits a residual best; all of shape (rows,).

    `scale` is that multiple, at least 0; `left` the chi-square with it, the prior's share of the
    amplitude included; `log_evidence` is above no cause.
    """

    scale: Array
    left: Array
    log_evidence: Array


def screen(sensitivities: Sensitivities, residual: Array) -> Screened:
    """Linear estimate of what every row would explain of a residual of recalibration."""
    power, cost = sensitivities.size**2, sensitivities.prior_cost
    along = sensitivities.projected @ residual
    scale = np.clip(along / (power + cost), 0.0, sensitivities.largest_multiple)
    fall = 2.0 * scale * along - scale**2 * (power + cost)
    return Screened(scale, residual @ residual - fall, 0.5 * fall - 0.5 * np.log1p(power / cost))


def linear_evidence(
    problem: Problem, sensitivities: Sensitivities, residual: Array
) -> dict[str, float]:
    """Log-evidence of every cause that can be seen, above no cause, by linear screening."""
    above = screen(sensitivities, residual).log_evidence
    result: dict[str, float] = {}
    for row in np.flatnonzero(sensitivities.size > UNSEEN):
        name = problem.causes[sensitivities.cause[row]].name
        result[name] = max(result.get(name, -np.inf), float(above[row]))
    return result
