"""Noise that the user states, in place of one that is estimated from trials."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.diagnosis.data.noise import NoiseModel
from stickslip.errors import ScenarioError

Array = NDArray[np.float64]


def stated_noise(
    values: Array, condition: NDArray[np.int64], sd: ArrayLike
) -> tuple[NoiseModel, Array]:
    """The noise whose mean errors are stated, and the covariance of the means.

    Parameters
    ----------
    values, condition : ndarray, shape (n,)
        Trials in the observable's unit, and the index of each one's condition, 0 to m - 1.
    sd : array_like, shape (), (m,) or (m, m)
        Standard deviation of each mean, or their covariance.

    Raises
    ------
    ScenarioError
        If the shape is another one, or an error is not a finite number above 0.
    """
    count = np.bincount(condition)
    stated = np.asarray(sd, dtype=float)
    if stated.ndim == 2:
        if stated.shape != (len(count), len(count)) or not np.all(np.isfinite(stated)):
            raise ScenarioError("sd: allowed is a covariance of one row a condition")
        covariance = stated
    else:
        if stated.shape not in ((), count.shape):
            raise ScenarioError("sd: allowed is a standard deviation for each condition")
        covariance = np.diag(np.broadcast_to(stated, count.shape) ** 2)
    variance = np.diag(covariance)
    sound = np.all(stated > 0.0) if stated.ndim < 2 else np.all(variance > 0.0)
    if not (sound and np.all(np.isfinite(variance))):
        raise ScenarioError("sd: allowed are finite numbers above 0")
    known = np.sqrt(variance)
    mean = np.bincount(condition, values) / count
    none = np.zeros((len(count), 0))
    noise = NoiseModel(mean, known * np.sqrt(count), count, 0.0, 0.0, 0.0, 0.0, math.inf, none, ())
    return noise, covariance
