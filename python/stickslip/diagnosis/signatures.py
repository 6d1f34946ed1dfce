"""What each cause does to the data that recalibration cannot undo.

A cause's response is taken at several finite amplitudes, because a piecewise smooth model has
causes without a slope at zero. What the uncertain parameters can absorb, within their priors, is
projected out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.fitting import Fit
from stickslip.diagnosis.model import Problem

Array = NDArray[np.float64]

AMPLITUDES = (0.1, 0.4, 1.0, 2.5)
"""Of the response, in units of the parameter's scale."""

SAME = 0.9
"""Causes whose absorbed signatures have a larger cosine are one isolability class."""

_UNSEEN = 1e-3


@dataclass(frozen=True)
class Signatures:
    """Absorbed responses of all causes, a row each.

    Attributes
    ----------
    cause : ndarray of int, shape (rows,)
        Index of the cause.
    point : ndarray, shape (rows, size)
        Coordinates at which the cause has this response and the rest is recalibrated.
    amplitude : ndarray, shape (rows,)
        Coordinate of the cause's first parameter.
    raw, absorbed : ndarray, shape (rows, m + p)
        Whitened response with prior rows, before and after recalibration.
    basis : ndarray, shape (m + p, p)
        Orthonormal; what recalibration can do.
    """

    cause: NDArray[np.int64]
    point: Array
    amplitude: Array
    raw: Array
    absorbed: Array
    basis: Array

    @property
    def size(self) -> Array:
        """Signal to noise of each row after absorption."""
        return np.asarray(np.linalg.norm(self.absorbed, axis=1))

    def directions(self) -> Array:
        """Unit vectors of the rows that can be seen."""
        seen = self.size > _UNSEEN
        return np.asarray(self.absorbed[seen] / self.size[seen, None])


def find_signatures(problem: Problem, null: Fit) -> Signatures:
    """Responses of all causes at the recalibrated model."""
    basis = np.linalg.qr(null.jacobian)[0]
    p, m = problem.base_count, len(problem.observed)
    low, high = problem.limits()
    owner, points = [], []
    for index, cause in enumerate(problem.causes):
        if cause.frees is not None:
            continue
        columns = problem.columns([cause])
        strengths = [k for k, at in enumerate(columns) if not problem.parameters[at - p].shape]
        shapes = [at for k, at in enumerate(columns) if k not in strengths]
        for k in strengths:
            for amplitude in [sign * size for size in AMPLITUDES for sign in (1.0, -1.0)]:
                u = float(np.clip(amplitude, low[columns[k]], high[columns[k]]))
                if u == 0.0:
                    continue
                for bend in (-1.5, 0.0, 1.5) if shapes else (0.0,):
                    point = null.x.copy()
                    point[columns[k]] = u
                    point[shapes] = bend
                    owner.append(index)
                    points.append((point, u))
    stack = np.array([point for point, _ in points]).reshape(len(points), problem.size)
    response = np.zeros((len(points), m + p))
    if len(points):
        predicted = problem.predicted(np.vstack([null.x, stack]))
        gap = predicted[1:] - predicted[0]
        response[:, :m] = np.where(np.isfinite(gap), gap, 0.0) @ problem.whiten.T
    names = [each.name for each in problem.uncertain]
    extra_owner, extra = [], []
    for index, cause in enumerate(problem.causes):
        if cause.frees is None:
            continue
        for sign in (1.0, -1.0):
            row = np.zeros(m + p)
            row[m + names.index(cause.frees)] = -sign
            extra_owner.append(index)
            extra.append(row)
    raw = np.vstack([response, np.array(extra).reshape(len(extra), m + p)])
    shift = raw @ basis
    absorbed = raw - shift @ basis.T
    # The point of each row: the baseline moves to undo what it can of the response.
    move = np.linalg.lstsq(null.jacobian, raw.T, rcond=None)[0].T
    full = np.vstack([stack, np.tile(null.x, (len(extra), 1))])
    full[:, :p] = np.clip(full[:, :p] - move, -6.0, 6.0)
    amplitudes = np.array([u for _, u in points] + [1.0] * len(extra))
    return Signatures(
        np.array(owner + extra_owner, dtype=np.int64), full, amplitudes, raw, absorbed, basis
    )


def isolability(problem: Problem, signatures: Signatures, residual: Array) -> Array:
    """Cosine between the absorbed signatures of all pairs of causes, shape (causes, causes).

    Each cause is taken at the amplitude that fits best; 0 for one that cannot be seen.
    """
    chosen = np.zeros((len(problem.causes), signatures.raw.shape[1]))
    for index in range(len(problem.causes)):
        row = best_row(signatures, residual, index)
        if row is not None:
            chosen[index] = signatures.absorbed[row] / signatures.size[row]
    return np.asarray(np.abs(chosen @ chosen.T))


def best_row(signatures: Signatures, residual: Array, cause: int) -> int | None:
    """Row of a cause that takes most from the residual, None if none can be seen."""
    rows = np.flatnonzero((signatures.cause == cause) & (signatures.size > _UNSEEN))
    if not len(rows):
        return None
    left = np.sum((residual - signatures.absorbed[rows]) ** 2, axis=1)
    return int(rows[np.argmin(left)])


def classes(problem: Problem, cosines: Array) -> list[tuple[str, ...]]:
    """Groups of causes that this data can hardly tell apart, those of two and more."""
    unseen = set(range(len(cosines)))
    groups = []
    while unseen:
        group, frontier = set(), {unseen.pop()}
        while frontier:
            each = frontier.pop()
            group.add(each)
            near = {k for k in unseen if cosines[each, k] > SAME}
            unseen -= near
            frontier |= near
        if len(group) > 1:
            groups.append(tuple(problem.causes[k].name for k in sorted(group)))
    return sorted(groups)


def upper_bounds(problem: Problem, signatures: Signatures, residual: Array) -> dict[str, float]:
    """95 % upper limit of the magnitude of every parameter of a cause, in its own unit.

    From the smallest response that can be seen, as if the response grew with the amplitude. A
    parameter that this data cannot see is bounded by its physical range.
    """
    bounds = {}
    for index, cause in enumerate(problem.causes):
        for at, parameter in zip(problem.columns([cause]), cause.parameters, strict=True):
            if parameter.shape:
                continue
            limit = 0.0
            low, high = parameter.limits
            for sign in (1.0, -1.0):
                rows = [
                    row
                    for row in np.flatnonzero(signatures.cause == index)
                    if signatures.point[row, at] * sign > 0.0
                ]
                far = high if sign > 0 else -low
                if not rows:
                    continue
                reach = [_reach(signatures, residual, int(row), far) for row in rows]
                limit = max(limit, min(far, min(reach)))
            sign = 1.0 if high >= -low else -1.0
            u = np.array([[sign * limit]])
            value = float(parameter.value(u)[0, 0])
            bounds[parameter.name] = value if parameter.downward else abs(value - parameter.absent)
    return bounds


def _reach(signatures: Signatures, residual: Array, row: int, far: float) -> float:
    size = float(signatures.size[row])
    if size < _UNSEEN:
        return far
    estimate = float(signatures.absorbed[row] @ residual) / size**2
    limit = max(estimate, 0.0) + 1.96 / size
    # A response at one amplitude says little of amplitudes far beyond it.
    return abs(float(signatures.amplitude[row])) * limit if limit < 3.0 else far
