"""What makes the data itself suspect, before any cause is blamed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import t as t_law

from stickslip.diagnosis.noise import NoiseModel

Array = NDArray[np.float64]

_DRIFT = 0.002


def data_problem(
    values: Array, index: NDArray[np.int64], noise: NoiseModel, order: ArrayLike | None
) -> str | None:
    """What makes the data itself suspect, if anything does."""
    if np.all(values == 0.0):
        return "every reading is zero: nothing moved, so nothing can be told apart"
    if len(noise.mean) < 4:
        few = len(noise.mean)
        said = "1 condition is" if few == 1 else f"{few} conditions are"
        return f"{said} too few to tell causes apart"
    if noise.dof == 0.0:
        return "too few repeats that differ and no stated error, so no misfit can be judged"
    if noise.dof < math.inf:
        between = float(np.var(noise.mean))
        if between < 3.0 * float(np.mean(noise.sd**2 / noise.count)):
            return "the conditions differ by no more than their trials do: labels may be mixed up"
    if order is None:
        return None
    place = np.asarray(order, dtype=float)
    usable = np.isfinite(place)
    if usable.sum() < 12:
        return None
    residual = ((values - noise.mean[index]) / noise.sd[index])[usable]
    time = place[usable]
    centred = (
        time
        - np.bincount(index[usable], time, minlength=len(noise.mean))[index[usable]]
        / (np.maximum(np.bincount(index[usable], minlength=len(noise.mean)), 1)[index[usable]])
    )
    power = float(centred @ centred)
    if power <= 0.0:
        return None
    # A drift shifts all velocities alike, or all in proportion, whatever their sign.
    toward = np.sign(noise.mean[index])[usable]
    chance = min(_drift(residual, centred, noise), _drift(residual * toward, centred, noise))
    if 2.0 * chance < _DRIFT:
        return "velocities drift with the order in which they were measured"
    return None


def _drift(residual: Array, centred: Array, noise: NoiseModel) -> float:
    """p-value of a slope of the residuals against the time in the midst of each condition."""
    power = float(centred @ centred)
    free = max(len(residual) - len(noise.mean) - 1, 1)
    slope = float(centred @ residual) / power
    left = residual - slope * centred
    score = slope * math.sqrt(power) / math.sqrt(max(float(left @ left) / free, 1e-12))
    return 2.0 * float(t_law.sf(abs(score), free))
