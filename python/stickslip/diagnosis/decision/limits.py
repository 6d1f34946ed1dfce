"""How large a cause could be where nothing was found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.stats import t as t_law

from stickslip._util.numbers import Array
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.fitting.responses import Response
from stickslip.diagnosis.terms.parameter import Parameter

BOUND = 0.95
"""Confidence of an upper limit."""

# A response is trusted up to this multiple of its size and down to its inverse; one with a smaller
# signal than the other, in errors, says nothing. Chosen.
_TRUSTED, _UNSEEN = 3.0, 1e-3


class Limit(NamedTuple):
    """An upper limit, in the unit of its amplitude, and whether these data show it.

    Else it is the end of the range that was searched.
    """

    value: float
    seen: bool


def upper_limits(problem: Problem, null: Fit, found: Sequence[Response]) -> dict[str, Limit]:
    """95 % upper limit of the magnitude of every amplitude by name.

    That of one that acts as it falls, such as a limit of an amplifier, is the lowest value that it
    could have. Of the responses of a sign and a shape the one counts whose size is nearest to its
    limit, as if it grew with the amplitude; of signs and shapes the one that is seen least. An
    amplitude that these data cannot see is bounded by its range.

    Parameters
    ----------
    problem : Problem
    null : Fit
        The recalibrated model.
    found : sequence of Response
        Of the causes about it.
    """
    reach_sd = float(t_law.ppf(0.5 + 0.5 * BOUND, min(problem.freedom, 1e6)))
    lower = np.linalg.cholesky(null.precision)
    basis = np.linalg.qr(np.vstack([problem.whitened(null.slopes), lower.T]))[0]
    residual = np.concatenate([
        problem.whitened(null.residual[:, None])[:, 0], -lower.T @ null.x[null.free]
    ])  # fmt: skip
    # By amplitude, sign and shape: how far the limit is from the response's size, and the limit.
    nearest: dict[tuple[int, float, tuple[float, ...]], tuple[float, float]] = {}
    for each in found:
        if each.cause.curve is not None:
            continue
        columns = problem.columns([each.cause]).tolist()
        free = problem.free([each.cause]).tolist()
        amplitudes = [k for k in columns if problem.parameters[k].is_amplitude]
        shape = tuple(each.x[[k for k in columns if k not in amplitudes]].tolist())
        for k, gap in zip(amplitudes, each.gaps, strict=True):
            slope = float(gap @ each.slopes[:, free.index(k)])
            # The amplitude at which a response was taken makes its gap of its slope.
            u = float(gap @ gap) / slope if slope else 0.0
            row = np.concatenate([problem.whitened(gap[:, None])[:, 0], np.zeros(len(lower))])
            row -= basis @ (basis.T @ row)
            multiple = _multiple(row, residual, reach_sd)
            key = k, math.copysign(1.0, u), shape
            reach = math.inf
            if multiple < _TRUSTED:
                size = _distance(problem.parameters[k], u)
                reach = size * max(multiple, 1.0 / _TRUSTED)
            old = nearest.get(key, (math.inf, math.inf))
            nearest[key] = min(old, (abs(math.log(multiple)), reach))
    limits: dict[str, Limit] = {}
    for (k, sign, _), (_, reach) in nearest.items():
        name, end = problem.parameters[k].name, problem.limits[int(sign > 0.0), k]
        end = _distance(problem.parameters[k], end)
        own = Limit(min(reach, end), reach < end)
        limits[name] = max(limits.get(name, own), own)
    falling = {each.name: each.high for each in problem.parameters if each.falls}
    return {name: Limit(falling[name] - each.value, each.seen) if name in falling else each
            for name, each in limits.items()}  # fmt: skip


def _distance(parameter: Parameter, u: float) -> float:
    """Distance of an amplitude at a coordinate from where it does nothing, in its unit."""
    start = parameter.high if parameter.falls else parameter.absent
    return abs(float(parameter.smooth_value(np.array([u]))[0]) - start)


def _multiple(projected: Array, residual: Array, sds: float) -> float:
    """How often a response may be in the residual at most, by so many standard deviations.

    Infinity where it is not seen.
    """
    size = float(np.linalg.norm(projected))
    if size < _UNSEEN:
        return math.inf
    return max(float(projected @ residual) / size**2, 0.0) + sds / size
