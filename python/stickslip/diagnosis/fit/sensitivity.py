"""What each cause does to the data that recalibration cannot undo.

A cause's response is taken at several finite amplitudes, because a piecewise smooth model has
causes without a slope at zero. What the uncertain parameters can make up for, within their priors,
is projected out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import Fit, Start
from stickslip.diagnosis.model.problem import PRIOR_INFLATION, Array, Indices, Problem

AMPLITUDES = (0.15, 0.6, 2.0)
"""Of the response, in units of the parameter's scale. Chosen: a factor of about four apart."""

UNSEEN = 1e-3
"""Signal to noise after projection below which a response counts as none: rounding, mostly."""

# Coordinates of a shape at which responses are taken. Chosen: 1.5 standard deviations of its prior.
_SHAPES = (-1.5, 0.0, 1.5)
# Largest moves by linear estimate, in standard deviations of the priors: of the constants that make
# up for a response, and of a start toward the minimum. Chosen: a linear estimate is worth no more.
_FAR, _NEAR = 6.0, 2.0
# Multiple of a response up to which it is trusted: of a relaxed constant, nearly linear, and of an
# amplitude. Chosen: the next amplitude of the table is reached.
_CONSTANT_MULTIPLE, _LARGEST_MULTIPLE = 8.0, 1.8


@dataclass(frozen=True, repr=False)
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
    projected, basis, move = _projected(raw, base.jacobian)
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


def _projected(raw: Array, jacobian: Array) -> tuple[Array, Array, Array]:
    """Responses after recalibration, the basis of what that can do, and the moves that do it."""
    basis = np.linalg.qr(jacobian)[0]
    projected = raw - (raw @ basis) @ basis.T
    move = np.linalg.lstsq(jacobian, raw.T, rcond=None)[0].T
    return projected, basis, np.clip(move, -_FAR, _FAR)


def transferred_to(
    problem: Problem, sensitivities: Sensitivities, fit: Fit, factor: float
) -> tuple[Fit, Sensitivities]:
    """The same responses about another fit, and that fit, with errors larger by a factor.

    The responses are not simulated anew, but what the constants can make up for, and what is left
    to be explained, are those of the other fit.
    """
    m, free = len(problem.observed), fit.candidate.free
    weight = np.concatenate([np.full(m, 1.0 / factor), np.ones(len(free))])
    residual, jacobian = fit.residual * weight, fit.jacobian * weight[:, None]
    softer = replace(fit, residual=residual, jacobian=jacobian, chi2=float(residual @ residual))
    raw = sensitivities.raw * weight
    projected, basis, move = _projected(raw, jacobian)
    point = sensitivities.point.copy()
    point[:, free] = fit.x[free] - move
    return softer, replace(sensitivities, point=point, raw=raw, projected=projected, basis=basis)


@dataclass(frozen=True, repr=False)
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


def starts(
    problem: Problem,
    base: Fit,
    sensitivities: Sensitivities,
    screened: Screened,
    cause: int,
    count: int,
) -> list[tuple[float, Start]]:
    """Starts of a cause at its most promising amplitudes, of both signs first.

    Each with what is left of chi-square there by linear estimate. Causes that the base has are
    there too.
    """
    rows = sensitivities.seen_rows(cause)
    rows = rows[np.argsort(screened.left[rows], kind="stable")]
    first: dict[tuple[int, float], int] = {}
    for row in rows.tolist():
        kind = (int(sensitivities.at[row]), float(np.sign(sensitivities.amplitude[row])))
        first.setdefault(kind, row)
    chosen = [*first.values(), *(row for row in rows.tolist() if row not in first.values())]
    # What the constants would gain by themselves is common to all rows.
    own = float(np.sum((sensitivities.basis.T @ base.residual) ** 2))
    free = base.candidate.free
    result = []
    for row in chosen[:count]:
        # Chosen: a start with less of the cause would hardly have it.
        scale = max(float(screened.scale[row]), 0.3)
        x = sensitivities.point[row].copy()
        x[free] = base.x[free] + scale * (x[free] - base.x[free]) + linear_step(base)
        start = with_cause(problem, base, sensitivities, row, x, scale)
        result.append((float(screened.left[row]) - own, start))
    return result


def linear_step(base: Fit) -> Array:
    """Gauss-Newton step of the free coordinates of a fit; zero at the best one, shape (free,)."""
    return np.clip(np.linalg.lstsq(base.jacobian, base.residual, rcond=None)[0], -_NEAR, _NEAR)


def starts_at(problem: Problem, base: Fit, sensitivities: Sensitivities, cause: int) -> list[Start]:
    """Starts at which a cause is added to a fit and nothing else moves, of either sign."""
    if problem.causes[cause].relaxes_prior is not None:
        return [Start(base.x, base.slope)]
    result = []
    raw, seen = sensitivities.raw, sensitivities.seen_rows(cause)
    for sign in (1.0, -1.0):
        rows = seen[np.sign(sensitivities.amplitude[seen]) == sign]
        if not len(rows):
            continue
        power = np.sum(raw[rows] ** 2, axis=1) + sensitivities.amplitude[rows] ** 2
        along = raw[rows] @ base.residual
        scale = np.clip(along / power, 0.5, 1.5)
        k = int(np.argmax(2.0 * scale * along - scale**2 * power))
        x = base.x.copy()
        x[problem.base_count :] = sensitivities.point[rows[k], problem.base_count :]
        # The causes that the base has stay where they are too.
        own = base.candidate.free[base.candidate.free >= problem.base_count]
        x[own] = base.x[own]
        result.append(with_cause(problem, base, sensitivities, int(rows[k]), x, float(scale[k])))
    return result


def with_cause(
    problem: Problem, base: Fit, sensitivities: Sensitivities, row: int, x: Array, scale: float
) -> Start:
    """A start with a multiple of a row's amplitude, and the derivatives that are known of it."""
    at = int(sensitivities.at[row])
    if at < 0:
        return Start(x, base.slope)
    x[at] *= scale
    added = problem.columns([problem.causes[sensitivities.cause[row]]])
    every = sorted([*base.candidate.free, *added])
    slope = np.zeros((len(problem.observed), len(every)))
    slope[:, [every.index(k) for k in base.candidate.free]] = base.slope
    slope[:, every.index(at)] = sensitivities.gap[row] / sensitivities.amplitude[row]
    return Start(x, slope)
