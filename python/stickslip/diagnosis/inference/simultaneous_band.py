"""A band that holds all of a curve, and not only each of its points."""

from __future__ import annotations

import numpy as np

from stickslip._util.arrays import Array


def simultaneous_band(draws: Array, probability: float) -> tuple[Array, Array, float]:
    """Mean of a curve, its standard deviation, and how many of these hold all points at once.

    The number is the quantile of the largest deviation of a draw (Montiel Olea and Plagborg-Moller,
    Journal of Applied Econometrics 34, 2019, 1-17).

    Parameters
    ----------
    draws : ndarray, shape (draws, points)
    probability : float
        Of the curve being inside.

    Returns
    -------
    mean, sd : ndarray, shape (points,)
    reach : float
    """
    mean, sd = np.mean(draws, axis=0), np.std(draws, axis=0)
    scale = np.where(sd > 0.0, sd, 1.0)
    reach = np.quantile(np.max(np.abs(draws - mean) / scale, axis=1), probability)
    return mean, sd, float(reach)
