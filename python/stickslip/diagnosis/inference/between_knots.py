"""How far a smooth law may lie from the curve of a few knots that fits it best."""

from __future__ import annotations

import itertools

import numpy as np

from stickslip._util.arrays import Array

# Lengths over which a law may change: the least in distances of two knots, as what bends faster is
# missed, and the largest in ranges of the argument, where it is nearly straight; and its sizes, in
# what would not surprise. Chosen as rough orders.
_SHORTEST, _LONGEST = 0.6, 2.0
_SIZES = np.geomspace(0.1, 10.0, 13)


def covariance_between_knots(
    argument: Array, design: Array, knots: Array, covariance: Array, size: float
) -> Array:
    """Covariance of a law about its best curve, by how much the knots of the curve themselves bend.

    The law is taken as a Gaussian process with the squared exponential covariance (Rasmussen and
    Williams, Gaussian Processes for Machine Learning, 2006, section 4.2), of which the curve is the
    projection by least squares over all of the range: too narrow where there are no data and the
    law bends fast. What is left of it is averaged over lengths and sizes of the process, each
    weighted by how likely it makes the knots that were found.

    Parameters
    ----------
    argument : ndarray, shape (points,)
        Evenly over the range of the curve.
    design : ndarray, shape (points, knots)
        What each knot adds to the curve there; zero throughout where the law is zero for sure.
    knots : ndarray, shape (knots,)
        The curve.
    covariance : ndarray, shape (knots, knots)
        Of `knots`.
    size : float
        Of the law, what would not surprise, in the unit of `knots`.

    Returns
    -------
    ndarray, shape (points, points)
        In the square of the unit of `knots`.
    """
    distance = np.abs(argument[:, None] - argument) / np.ptp(argument)
    project = np.linalg.pinv(design)
    left = np.eye(len(argument)) - design @ project
    sure = np.flatnonzero(~design.any(axis=1))[:1]
    log_likelihoods, leavings = [], []
    lengths = np.geomspace(_SHORTEST / (len(knots) - 1), _LONGEST, 14)
    for length, factor in itertools.product(lengths, size * _SIZES):
        law = factor**2 * np.exp(-0.5 * (distance / length) ** 2)
        if len(sure):
            law -= law[:, sure] @ law[sure] / law[sure, sure]
        of_knots = project @ law @ project.T + covariance
        misfit = knots @ np.linalg.solve(of_knots, knots)
        log_likelihoods.append(-0.5 * (misfit + np.linalg.slogdet(of_knots)[1]))
        leavings.append(left @ law @ left.T)
    weights = np.exp(np.array(log_likelihoods) - np.max(log_likelihoods))
    return np.asarray(np.tensordot(weights / weights.sum(), leavings, 1))
