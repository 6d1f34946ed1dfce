"""What makes the data itself suspect, before any cause is blamed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import t as t_law

from stickslip.diagnosis.noise import NoiseModel, completed

Array = NDArray[np.float64]

_DRIFT = 0.002


def data_problem(
    values: Array,
    index: NDArray[np.int64],
    noise: NoiseModel,
    order: ArrayLike | None,
    block: NDArray[np.int64] | None = None,
    alone: bool = True,
) -> str | None:
    """What makes the data itself suspect, if anything does.

    Few trials, or trials without repeats, are no trouble where they do not stand alone: other data
    can tell causes apart.
    """
    if np.all(values == 0.0):
        return "every reading is zero: nothing moved, so nothing can be told apart"
    if alone and len(noise.mean) < 4:
        few = len(noise.mean)
        said = "1 condition is" if few == 1 else f"{few} conditions are"
        return f"{said} too few to tell causes apart; at least 4 are needed"
    if alone and noise.dof == 0.0:
        return (
            "the noise is not known, so no misfit can be judged: repeat the trials of some "
            "conditions, or state their error (velocity_sd in [[velocity]])"
        )
    if 0.0 < noise.dof < math.inf and len(noise.mean) > 3:
        between = float(np.var(noise.mean))
        if between < 3.0 * float(np.mean(noise.sd**2 / noise.count)):
            return "the conditions differ by no more than their trials do: labels may be mixed up"
    if order is None:
        return None
    place = np.asarray(order, dtype=float)
    usable = np.isfinite(place)
    if usable.sum() < 12:
        return None
    design = np.eye(len(noise.mean))[index[usable]]
    block = completed(block)
    if block is not None and noise.setups.shape[1]:
        # What differs from one set-up to the next is not drift.
        shift = np.eye(int(block.max()) + 1)[block[usable]]
        design = np.hstack([design, shift, shift * np.sign(noise.mean)[index[usable], None]])
    left, singular, _ = np.linalg.svd(design, full_matrices=False)
    basis = left[:, singular > 1e-9 * singular[0]]
    free = len(design) - basis.shape[1] - 1
    centred = place[usable] - basis @ (basis.T @ place[usable])
    if free < 1 or float(centred @ centred) <= 1e-9 * float(place[usable] @ place[usable]):
        return None
    # A drift shifts all velocities alike, or all in proportion, whatever their sign.
    scatter = (values - noise.mean[index]) / noise.sd[index]
    chances = []
    for toward in (1.0, np.sign(noise.mean[index])):
        residual = (scatter * toward)[usable]
        chances.append(_drift(residual - basis @ (basis.T @ residual), centred, free))
    if 2.0 * min(chances) < _DRIFT:
        return "velocities drift with the order in which they were measured"
    return None


def _drift(residual: Array, centred: Array, free: int) -> float:
    """p-value of a slope of the residuals against the time, both without conditions and set-ups."""
    power = float(centred @ centred)
    slope = float(centred @ residual) / power
    left = residual - slope * centred
    score = slope * math.sqrt(power) / math.sqrt(max(float(left @ left) / free, 1e-12))
    return 2.0 * float(t_law.sf(abs(score), free))
