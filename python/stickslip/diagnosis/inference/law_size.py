"""How large a law may be where the data say little of it: as large as it is elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fit.fit_result import Fit, Fitted, physical_covariance

# Sizes of a law, in what would not surprise, and the standard deviation of the logarithm of the
# size by its prior. Chosen as rough orders.
_SIZES, _WIDTH = np.geomspace(1.0, 10.0, 7), 1.0


def with_learned_size(
    fit: Fit, own: Sequence[Fitted], knots: Sequence[Fitted], size: float
) -> tuple[Array, Array]:
    """Mean and covariance of a curve whose size the data tell too, about the fit of the curve.

    A fit takes each knot as no larger than what would not surprise. Where most are found to be
    larger, so may the others be, of which the data say little. So the knots' priors in the fit are
    exchanged for normal ones of several sizes, in the linear model about the fit, and the results
    are averaged, each weighted by how likely its size makes the data.

    Parameters
    ----------
    fit : Fit
    own, knots : sequence of Fitted
        The constant of the law, if there is one, and the knots.
    size : float
        What would not surprise of a knot, in its unit.

    Returns
    -------
    shift : ndarray, shape (own + knots,)
        Mean less the values of the fit, in their units.
    covariance : ndarray, shape (own + knots, own + knots)
    """
    every = [*own, *knots]
    at = np.arange(len(own), len(every))
    u = fit.x[[each.column for each in knots]]
    slope = np.array([each.slope(fit) for each in knots])
    values = np.array([float(each.value(np.array(x))) for each, x in zip(knots, u, strict=True)])
    precision = np.linalg.inv(physical_covariance(fit, every))
    weights, shifts, covariances = [], [], []
    for factor in _SIZES:
        sd = factor * size
        # The prior of the fit is normal in the coordinates.
        other, pull = precision.copy(), np.zeros(len(every))
        other[at, at] += 1.0 / sd**2 - 1.0 / slope**2
        pull[at] = u / slope - values / sd**2
        covariance = np.linalg.inv(other)
        shift = covariance @ pull
        log_prior = -0.5 * (np.log(factor) / _WIDTH) ** 2
        log_prior -= len(knots) * np.log(sd) + 0.5 * values @ values / sd**2
        weights.append(log_prior + 0.5 * (pull @ shift - np.linalg.slogdet(other)[1]))
        shifts.append(shift)
        covariances.append(covariance)
    weight = np.exp(np.array(weights) - np.max(weights))
    weight /= weight.sum()
    mean = weight @ np.array(shifts)
    apart = np.array(shifts) - mean
    spread = np.tensordot(weight, covariances, 1) + (apart.T * weight) @ apart
    return mean, np.asarray(spread)
