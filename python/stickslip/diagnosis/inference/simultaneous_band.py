"""How wide a band has to be to hold all of a curve, and not only each of its points."""

from __future__ import annotations

import numpy as np

from stickslip._util.arrays import Array

# Draws of the curve. Chosen: they tell the reach to about 0.02.
_DRAWS = 4000


def reach_of_band(covariance: Array, probability: float) -> float:
    """Standard deviations within which a normal curve lies at all of its points at once.

    The quantile of its largest deviation (Montiel Olea and Plagborg-Moller, Journal of Applied
    Econometrics 34, 2019, 1-17), by random draws that are the same in each call.

    Parameters
    ----------
    covariance : ndarray, shape (points, points)
    probability : float
        Of the curve being inside.
    """
    sd = np.sqrt(np.diag(covariance))
    scale = np.where(sd > 0.0, sd, 1.0)
    # Neighbouring points are so much alike that rounding leaves no Cholesky factor.
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    draws = np.random.default_rng(31).standard_normal((_DRAWS, len(sd))) @ root.T
    return float(np.quantile(np.max(np.abs(draws), axis=1), probability))
