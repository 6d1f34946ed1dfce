"""How large a cause could be, and how small it may be to be seen, where nothing was found."""

from __future__ import annotations

import numpy as np

from stickslip.diagnosis.fit.sensitivity import UNSEEN, Sensitivities
from stickslip.diagnosis.model.problem import Array, Problem

BOUND, _BOUND_SDS = 0.95, 1.96
"""Confidence of an upper limit, and standard deviations on both sides that hold so much."""

POWER, _POWER_SDS = 0.8, 0.84
"""Probability that an effect of the smallest size is seen, and standard deviations for it."""

# A response is trusted up to this multiple of its amplitude, and down to its inverse. Chosen.
_TRUSTED = 3.0


def upper_bounds(
    problem: Problem, sensitivities: Sensitivities, residual: Array
) -> dict[str, float]:
    """95 % upper limit of the magnitude of every parameter of a cause, in its own unit.

    The bound of a parameter that acts as it falls is the lowest value that it could have. Bounds
    are from the responses that were simulated, each as if it grew with the amplitude, up to three
    times and down to a third of its own. A parameter that these data cannot see is bounded by its
    physical range.

    Parameters
    ----------
    problem : Problem
    sensitivities : Sensitivities
        About the recalibrated model.
    residual : ndarray, shape (m + p,)
        Whitened misfit of that one, the rows of its p constants last.
    """
    bounds = {}
    for index, cause in enumerate(problem.causes):
        columns = list(zip(problem.columns([cause]), cause.parameters, strict=True))
        shapes = [at for at, parameter in columns if parameter.shape]
        responses = np.flatnonzero(sensitivities.cause == index)
        for at, parameter in columns:
            if parameter.shape:
                continue
            limit = 0.0
            low, high = parameter.limits
            for sign, far in ((1.0, high), (-1.0, -low)):
                # Whatever the shape, so the limit is that of the shape that is seen least.
                nearest: dict[tuple[float, ...], float] = {}
                for row in responses[sensitivities.point[responses, at] * sign > 0.0].tolist():
                    shape = tuple(sensitivities.point[row, shapes])
                    reach = _reach(sensitivities, residual, row, far)
                    nearest[shape] = min(nearest.get(shape, far), reach)
                limit = max(limit, *nearest.values(), 0.0)
            sign = 1.0 if high >= -low else -1.0
            value = float(parameter.value(np.array([sign * limit]))[0])
            bounds[parameter.name] = value if parameter.downward else abs(value - parameter.absent)
    return bounds


def _reach(sensitivities: Sensitivities, residual: Array, row: int, far: float) -> float:
    """Largest amplitude that the residual allows by one response, `far` where it cannot tell."""
    size = float(sensitivities.size[row])
    if size < UNSEEN:
        return far
    estimate = float(sensitivities.projected[row] @ residual) / size**2
    limit = max(estimate, 0.0) + _BOUND_SDS / size
    if limit >= _TRUSTED:
        return far
    return abs(float(sensitivities.amplitude[row])) * max(limit, 1.0 / _TRUSTED)


def smallest_effects(
    problem: Problem, sensitivities: Sensitivities, threshold: float
) -> dict[str, float]:
    """Smallest size of every parameter of a cause that these data would show in four cases of five.

    In the parameter's unit, from its absent value; infinity where no response reached so far.

    Parameters
    ----------
    problem : Problem
    sensitivities : Sensitivities
    threshold : float
        Limit of the score test.
    """
    wanted = threshold + _POWER_SDS
    found: dict[str, float] = {}
    nearest: dict[str, float] = {}
    for row in np.flatnonzero(sensitivities.at >= 0):
        parameter = problem.parameters[sensitivities.at[row] - problem.base_count]
        found.setdefault(parameter.name, np.inf)
        ratio = wanted / max(float(sensitivities.size[row]), UNSEEN)
        if ratio > _TRUSTED or abs(np.log(ratio)) >= nearest.get(parameter.name, np.inf):
            continue
        nearest[parameter.name] = abs(float(np.log(ratio)))
        own = float(parameter.value(np.array([sensitivities.amplitude[row]]))[0])
        start = parameter.high if parameter.downward else parameter.absent
        size = abs(own - start) * ratio
        found[parameter.name] = start - size if parameter.downward else size
    return found
