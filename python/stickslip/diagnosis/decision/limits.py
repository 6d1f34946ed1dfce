"""How large a cause could be where nothing was found."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.fitting.responses import Response

BOUND, _SDS = 0.95, 1.96
"""Confidence of an upper limit, and standard deviations on both sides that hold so much."""

# A response is trusted up to this multiple of its amplitude, and down to its inverse; one whose
# signal is below so many errors says nothing. Chosen.
_TRUSTED, _UNSEEN = 3.0, 1e-3


def upper_limits(problem: Problem, null: Fit, found: Sequence[Response]) -> dict[str, float]:
    """95 % upper limit of the magnitude of every amplitude, in its own unit, by name.

    That of one that acts as it falls, such as a limit of an amplifier, is the lowest value that it
    could have. Each response is taken as if it grew with the amplitude, up to three times and down
    to a third of its own. Whatever the shape and the sign, so that the limit is that of those that
    are seen least. An amplitude that these data cannot see is bounded by its range.

    Parameters
    ----------
    problem : Problem
    null : Fit
        The recalibrated model.
    found : sequence of Response
        Of the causes about it.
    """
    lower = np.linalg.cholesky(null.precision)
    basis = np.linalg.qr(np.vstack([problem.whitened(null.slopes), lower.T]))[0]
    residual = np.concatenate([
        problem.whitened(null.residual[:, None])[:, 0], -lower.T @ null.x[null.free]
    ])  # fmt: skip
    # By amplitude and sign, the least of each shape.
    reaches: dict[tuple[int, float], dict[tuple[float, ...], float]] = {}
    for each in found:
        if each.cause.curve is not None:
            continue
        columns = problem.columns([each.cause]).tolist()
        free = problem.free([each.cause]).tolist()
        amplitudes = [k for k in columns if problem.parameters[k].is_amplitude]
        shape = tuple(each.x[[k for k in columns if k not in amplitudes]].tolist())
        for k, gap in zip(amplitudes, each.gaps, strict=True):
            slope = each.slopes[:, free.index(k)]
            # A response was taken at the amplitude that makes its gap of its slope.
            amplitude = float(gap @ gap) / float(gap @ slope) if np.any(gap) else 0.0
            for sign, far in zip((-1.0, 1.0), np.abs(problem.limits[:, k]).tolist(), strict=True):
                if amplitude * sign < 0.0 or far == 0.0:
                    continue
                own = reaches.setdefault((k, sign), {})
                row = np.concatenate([problem.whitened(gap[:, None])[:, 0], np.zeros(len(lower))])
                reach = _reach(row - basis @ (basis.T @ row), residual, abs(amplitude), far)
                own[shape] = min(own.get(shape, far), reach)
    return _in_units(problem, reaches)


def _reach(projected: Array, residual: Array, amplitude: float, far: float) -> float:
    """Largest amplitude that the residual allows by one response, `far` where it cannot tell."""
    size = float(np.linalg.norm(projected))
    if size < _UNSEEN:
        return far
    limit = max(float(projected @ residual) / size**2, 0.0) + _SDS / size
    return far if limit >= _TRUSTED else min(amplitude * max(limit, 1.0 / _TRUSTED), far)


def _in_units(
    problem: Problem, reaches: dict[tuple[int, float], dict[tuple[float, ...], float]]
) -> dict[str, float]:
    found: dict[str, float] = {}
    for k in sorted({k for k, _ in reaches}):
        parameter = problem.parameters[k]
        ends: Iterable[float] = (sign * max(reaches.get((k, sign), {0: 0.0}).values())
                                 for sign in (-1.0, 1.0))  # fmt: skip
        values = parameter.smooth_value(np.array(list(ends)))
        found[parameter.name] = (
            float(np.min(values)) if parameter.falls
            else float(np.max(np.abs(values - parameter.absent)))
        )  # fmt: skip
    return found
