"""What each cause does to the data that recalibration cannot undo.

A cause's response is taken at several finite amplitudes, because a piecewise smooth model has
causes without a slope at zero. What the uncertain parameters can absorb, within their priors, is
projected out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import Fit, Start
from stickslip.diagnosis.model.problem import PRIOR_INFLATION, Problem

Array = NDArray[np.float64]

AMPLITUDES = (0.15, 0.6, 2.0)
"""Of the response, in units of the parameter's scale."""

_FAR = 6.0

UNSEEN = 1e-3
"""Signal to noise after absorption below which a response counts as none."""


@dataclass(frozen=True, repr=False)
class Sensitivities(OneLine):
    """Absorbed responses of all causes, a row each.

    Attributes
    ----------
    cause : ndarray of int, shape (rows,)
        Index of the cause.
    point : ndarray, shape (rows, size)
        Coordinates at which the cause has this response and the rest is recalibrated.
    at : ndarray of int, shape (rows,)
        Column of the parameter that has the amplitude; -1 for a freed constant.
    amplitude : ndarray, shape (rows,)
        Its coordinate; 1 for a freed constant.
    gap : ndarray, shape (rows, m)
        Response in the observable's unit.
    raw, projected : ndarray, shape (rows, m + p)
        Whitened response with prior rows, before and after recalibration.
    basis : ndarray, shape (m + p, p)
        Orthonormal; what recalibration can do.

    About a fit with causes of its own, p counts their parameters too: what they can undo is
    projected.
    """

    cause: NDArray[np.int64]
    point: Array
    at: NDArray[np.int64]
    amplitude: Array
    gap: Array
    raw: Array
    projected: Array
    basis: Array

    @property
    def size(self) -> Array:
        """Signal to noise of each row after absorption."""
        return np.asarray(np.linalg.norm(self.projected, axis=1))

    def directions(self) -> Array:
        """Unit vectors of the rows that can be seen."""
        seen = self.size > UNSEEN
        return np.asarray(self.projected[seen] / self.size[seen, None])


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
    basis = np.linalg.qr(base.jacobian)[0]
    free, m = base.candidate.free, len(problem.observed)
    owner, at, amplitude, points = _plan(problem, base)
    names = [each.name for each in problem.uncertain]
    relaxed = [
        (index, names.index(cause.relaxes_prior), sign)
        for index, cause in enumerate(problem.causes)
        if cause.relaxes_prior is not None and cause not in base.candidate.causes
        for sign in (1.0, -1.0)
    ]
    gap = np.zeros((len(points) + len(relaxed), m))
    if len(points):
        predicted = problem.predicted(np.vstack([base.x, points]))
        response = predicted[1:] - predicted[0]
        gap[: len(points)] = np.where(np.isfinite(response), response, 0.0)
    raw = np.hstack([gap @ problem.whiten.T, np.zeros((len(gap), len(free)))])
    for row, (_, column, sign) in enumerate(relaxed, start=len(points)):
        raw[row, m + column] = -sign
    projected = raw - (raw @ basis) @ basis.T
    # The point of each row: the baseline moves to undo what it can of the response.
    move = np.linalg.lstsq(base.jacobian, raw.T, rcond=None)[0].T
    full = np.vstack([points, np.tile(base.x, (len(relaxed), 1))])
    full[:, free] -= np.clip(move, -_FAR, _FAR)
    return Sensitivities(
        np.array(owner + [index for index, _, _ in relaxed], dtype=np.int64),
        full,
        np.array(at + [-1] * len(relaxed), dtype=np.int64),
        np.array(amplitude + [1.0] * len(relaxed)),
        gap,
        raw,
        projected,
        basis,
    )


def _plan(problem: Problem, base: Fit) -> tuple[list[int], list[int], list[float], Array]:
    """Cause, column, amplitude and coordinates of every response that is to be simulated."""
    p = problem.base_count
    low, high = problem.limits()
    owner, where, size, points = [], [], [], [np.zeros((0, problem.size))]
    for index, cause in enumerate(problem.causes):
        if cause.relaxes_prior is not None or cause in base.candidate.causes:
            continue
        columns = problem.columns([cause])
        shapes = [at for at in columns if problem.parameters[at - p].shape]
        for at in (at for at in columns if at not in shapes):
            reached = {
                float(np.clip(sign * amplitude, low[at], high[at]))
                for amplitude in AMPLITUDES
                for sign in (1.0, -1.0)
            }
            for u in sorted(reached - {0.0}, key=lambda u: (abs(u), -u)):
                for bend in (-1.5, 0.0, 1.5) if shapes else (0.0,):
                    point = base.x.copy()
                    point[at], point[shapes] = u, bend
                    owner.append(index)
                    where.append(at)
                    size.append(u)
                    points.append(point[None, :])
    return owner, where, size, np.vstack(points)


def transferred_to(
    problem: Problem, sensitivities: Sensitivities, fit: Fit, factor: float
) -> tuple[Fit, Sensitivities]:
    """The same responses about another fit, with errors larger by a factor.

    The responses are not simulated anew, but what the constants can absorb of them, and what is
    left to be explained, are those of the other fit.

    Returns
    -------
    fit : Fit
        With residual and Jacobian of the larger errors.
    sensitivities : Sensitivities
    """
    m, free = len(problem.observed), fit.candidate.free
    weight = np.concatenate([np.full(m, 1.0 / factor), np.ones(len(free))])
    residual, jacobian = fit.residual * weight, fit.jacobian * weight[:, None]
    softer = replace(fit, residual=residual, jacobian=jacobian, chi2=float(residual @ residual))
    raw = sensitivities.raw * weight
    basis = np.linalg.qr(jacobian)[0]
    projected = raw - (raw @ basis) @ basis.T
    move = np.linalg.lstsq(jacobian, raw.T, rcond=None)[0].T
    point = sensitivities.point.copy()
    point[:, free] = fit.x[free] - np.clip(move, -_FAR, _FAR)
    return softer, replace(sensitivities, point=point, raw=raw, projected=projected, basis=basis)


@dataclass(frozen=True, repr=False)
class Screened(OneLine):
    """Each row at the multiple of its response that fits a residual best.

    Attributes
    ----------
    scale : ndarray, shape (rows,)
        At least 0, and not much above 1, as a response says little of amplitudes far beyond it.
    left : ndarray, shape (rows,)
        Chi-square with it, with the prior's share of the amplitude.
    log_evidence : ndarray, shape (rows,)
        Above no cause.
    """

    scale: Array
    left: Array
    log_evidence: Array


def screen(sensitivities: Sensitivities, residual: Array) -> Screened:
    """Linear estimate of what every row would explain of a residual of recalibration."""
    power, cost = sensitivities.size**2, prior_cost(sensitivities)
    along = sensitivities.projected @ residual
    scale = np.clip(along / (power + cost), 0.0, largest_multiple(sensitivities))
    fall = 2.0 * scale * along - scale**2 * (power + cost)
    return Screened(scale, residual @ residual - fall, 0.5 * fall - 0.5 * np.log1p(power / cost))


def largest_multiple(sensitivities: Sensitivities) -> Array:
    """Multiple of each row up to which its response is trusted, shape (rows,)."""
    return np.where(sensitivities.at < 0, 8.0, 1.8)


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


def prior_cost(sensitivities: Sensitivities) -> Array:
    """Chi-square of the amplitude's prior at each row, shape (rows,).

    A freed constant is a shift of the prior's mean, of which each row is one standard deviation.
    """
    return np.where(
        sensitivities.at < 0, 1.0 / (PRIOR_INFLATION**2 - 1.0), sensitivities.amplitude**2
    )


def starts(
    problem: Problem,
    base: Fit,
    sensitivities: Sensitivities,
    screened: Screened,
    cause: int,
    count: int,
) -> list[tuple[float, Start]]:
    """Where fits of a cause should begin: its most promising amplitudes, of both signs first.

    Each with what is left of chi-square there by linear estimate. Causes that the base has are
    there too.
    """
    rows = np.flatnonzero((sensitivities.cause == cause) & (sensitivities.size > UNSEEN))
    rows = rows[np.argsort(screened.left[rows], kind="stable")]
    chosen: list[int] = []
    signs: set[tuple[int, float]] = set()
    for row in rows:
        kind = (int(sensitivities.at[row]), float(np.sign(sensitivities.amplitude[row])))
        if kind not in signs:
            signs.add(kind)
            chosen.append(int(row))
    chosen += [int(row) for row in rows if row not in chosen]
    # What the constants would gain by themselves is common to all rows.
    basis = sensitivities.basis
    own = float(np.sum((basis.T @ base.residual) ** 2))
    return [
        (float(screened.left[row]) - own, _start(problem, base, sensitivities, screened, row))
        for row in chosen[:count]
    ]


def linear_step(base: Fit) -> Array:
    """How the free coordinates want to move from a fit; zero at the best one, shape (free,)."""
    return np.clip(np.linalg.lstsq(base.jacobian, base.residual, rcond=None)[0], -2.0, 2.0)


def _start(
    problem: Problem, base: Fit, sensitivities: Sensitivities, screened: Screened, row: int
) -> Start:
    scale = max(float(screened.scale[row]), 0.3)
    x = sensitivities.point[row].copy()
    free = base.candidate.free
    x[free] = base.x[free] + scale * (x[free] - base.x[free]) + linear_step(base)
    return with_cause(problem, base, sensitivities, row, x, scale)


def starts_at(problem: Problem, base: Fit, sensitivities: Sensitivities, cause: int) -> list[Start]:
    """Starts at which a cause is added to a fit and nothing else moves, of either sign."""
    if problem.causes[cause].relaxes_prior is not None:
        return [Start(base.x, base.slope)]
    result: list[Start] = []
    raw = sensitivities.raw
    for sign in (1.0, -1.0):
        mine = (sensitivities.cause == cause) & (sensitivities.size > UNSEEN)
        rows = np.flatnonzero(mine & (np.sign(sensitivities.amplitude) == sign))
        if not len(rows):
            continue
        power = np.sum(raw[rows] ** 2, axis=1) + sensitivities.amplitude[rows] ** 2
        along = raw[rows] @ base.residual
        scale = np.clip(along / power, 0.5, 1.5)
        k = int(np.argmax(2.0 * scale * along - scale**2 * power))
        x = base.x.copy()
        x[problem.base_count :] = sensitivities.point[rows[k], problem.base_count :]
        # Causes of the base's own stay where they are too.
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
