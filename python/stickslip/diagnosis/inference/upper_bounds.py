"""How large a cause could be, and how small it may be to be seen, where nothing was found."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.fit.sensitivity import UNSEEN, Sensitivities
from stickslip.diagnosis.model.problem import Problem

Array = NDArray[np.float64]

BOUND, _BOUND_SDS = 0.95, 1.96
"""Confidence of an upper limit, and standard deviations on both sides that hold so much."""

POWER, _POWER_SDS = 0.8, 0.84
"""Chance that an effect of the smallest size is seen, and the standard deviations for it."""


def upper_bounds(
    problem: Problem, sensitivities: Sensitivities, residual: Array
) -> dict[str, float]:
    """95 % upper limit of the magnitude of every parameter of a cause, in its own unit.

    Of one that acts as it falls, the lowest value that it could have. From the responses that were
    simulated, each as if it grew with the amplitude, up to three times and down to a third of its
    own. A parameter that these data cannot see is bounded by its physical range.

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
        for at, parameter in columns:
            if parameter.shape:
                continue
            limit = 0.0
            low, high = parameter.limits
            for sign in (1.0, -1.0):
                rows = [
                    row
                    for row in np.flatnonzero(sensitivities.cause == index)
                    if sensitivities.point[row, at] * sign > 0.0
                ]
                far = high if sign > 0 else -low
                if not rows:
                    continue
                # Whatever the shape, so the limit is that of the shape that is seen least.
                nearest: dict[tuple[float, ...], float] = {}
                for row in rows:
                    bend = tuple(sensitivities.point[row, shapes])
                    reach = _reach(sensitivities, residual, int(row), far)
                    nearest[bend] = min(nearest.get(bend, far), reach)
                limit = max(limit, *nearest.values())
            sign = 1.0 if high >= -low else -1.0
            u = np.array([[sign * limit]])
            value = float(parameter.value(u)[0, 0])
            bounds[parameter.name] = value if parameter.downward else abs(value - parameter.absent)
    return bounds


def _reach(sensitivities: Sensitivities, residual: Array, row: int, far: float) -> float:
    size = float(sensitivities.size[row])
    if size < UNSEEN:
        return far
    estimate = float(sensitivities.projected[row] @ residual) / size**2
    limit = max(estimate, 0.0) + _BOUND_SDS / size
    # A response at one amplitude says little of amplitudes far from it, larger or smaller.
    return abs(float(sensitivities.amplitude[row])) * max(limit, 1.0 / 3.0) if limit < 3.0 else far


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
        Of the score.
    """
    wanted = threshold + _POWER_SDS
    found: dict[str, float] = {}
    nearest: dict[str, float] = {}
    for row in np.flatnonzero(sensitivities.at >= 0):
        parameter = problem.parameters[sensitivities.at[row] - problem.base_count]
        found.setdefault(parameter.name, np.inf)
        ratio = wanted / max(float(sensitivities.size[row]), UNSEEN)
        # A response says little of amplitudes far beyond its own.
        if ratio > 3.0 or abs(np.log(ratio)) >= nearest.get(parameter.name, np.inf):
            continue
        nearest[parameter.name] = abs(float(np.log(ratio)))
        own = float(parameter.value(np.array([sensitivities.amplitude[row]]))[0])
        start = parameter.high if parameter.downward else parameter.absent
        size = abs(own - start) * ratio
        found[parameter.name] = start - size if parameter.downward else size
    return found
