"""What a law may be where the data say little: as large, and as smooth, as it is elsewhere."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
from scipy.special import logsumexp

from stickslip._util.arrays import Array
from stickslip.diagnosis.fit.fit_result import Fit, Fitted, physical_covariance

# Sizes of a law, in what would not surprise, and the standard deviation of the logarithm of the
# size by its prior; lengths over which a law is alike, in its range, of which 0 leaves the knots
# independent. Chosen as rough orders: a length of the whole range would make most laws too stiff.
_SIZES, _WIDTH, _LENGTHS = np.geomspace(1.0, 10.0, 7), 1.0, (0.0, 0.25, 0.5)


def with_learned_prior(
    fit: Fit, own: Sequence[Fitted], knots: Sequence[Fitted], size: float
) -> tuple[Array, Array]:
    """Mean and covariance of a curve whose size and smoothness the data tell too.

    A fit takes each knot by itself, and as no larger than what would not surprise. Where most are
    found to be larger, so may the others be, of which the data say little; and a curve that is
    smooth where it is known goes on smoothly. So the knots' priors in the fit are exchanged for
    normal ones of several sizes and lengths (squared exponential, as in `between_knots`), in the
    linear model about the fit, and the results are averaged, each weighted by how likely its prior
    makes the data.

    Parameters
    ----------
    fit : Fit
    own, knots : sequence of Fitted
        The constant of the law, if there is one, and the knots, evenly over the range.
    size : float
        What would not surprise of a knot, in its unit.

    Returns
    -------
    shift : ndarray, shape (own + knots,)
        Mean less the values of the fit, in their units.
    covariance : ndarray, shape (own + knots, own + knots)
    """
    every = [*own, *knots]
    of_knots = slice(len(own), None)
    u = fit.x[[each.column for each in knots]]
    slope = np.array([each.slope(fit) for each in knots])
    values = np.array([float(each.value(np.array(x))) for each, x in zip(knots, u, strict=True)])
    precision = np.linalg.inv(physical_covariance(fit, every))
    # The prior of the fit is normal in the coordinates.
    precision[of_knots, of_knots] -= np.diag(1.0 / slope**2)
    weights, shifts, covariances = [], [], []
    for weight, prior in _priors(len(knots), size):
        with_prior, pull = precision.copy(), np.zeros(len(every))
        with_prior[of_knots, of_knots] += prior
        pull[of_knots] = u / slope - prior @ values
        covariance = np.linalg.inv(with_prior)
        shift = covariance @ pull
        determinants = np.linalg.slogdet(prior)[1] - np.linalg.slogdet(with_prior)[1]
        squares = pull @ shift - values @ prior @ values
        weights.append(weight + 0.5 * (squares + determinants))
        shifts.append(shift)
        covariances.append(covariance)
    share = np.exp(np.array(weights) - np.max(weights))
    share /= share.sum()
    mean = share @ np.array(shifts)
    apart = np.array(shifts) - mean
    spread = np.tensordot(share, covariances, 1) + (apart.T * share) @ apart
    return mean, np.asarray(spread)


def log_prior(knots: Array, size: float) -> Array:
    """Logarithm of the prior's density at the knots of some laws, but for a constant.

    Parameters
    ----------
    knots : ndarray, shape (laws, knots)
    size : float
        What would not surprise of a knot, in its unit.

    Returns
    -------
    ndarray, shape (laws,)
    """
    parts = [
        weight + 0.5 * np.linalg.slogdet(prior)[1] - 0.5 * np.sum((knots @ prior) * knots, axis=1)
        for weight, prior in _priors(knots.shape[1], size)
    ]
    return np.asarray(logsumexp(parts, axis=0))


def _priors(knots: int, size: float) -> Iterator[tuple[float, Array]]:
    """Log-weight and inverse covariance of each of the normal priors."""
    place = np.linspace(0.0, 1.0, knots)
    for factor, length in itertools.product(_SIZES, _LENGTHS):
        alike = np.eye(knots)
        if length:
            alike = np.exp(-0.5 * ((place[:, None] - place) / length) ** 2)
        weight = -0.5 * (np.log(factor) / _WIDTH) ** 2
        yield weight, np.linalg.inv((factor * size) ** 2 * alike)
