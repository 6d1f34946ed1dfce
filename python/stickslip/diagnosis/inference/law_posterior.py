"""What data say of a law whose effect was computed for a curve of a few knots."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array

# Lengths over which a law may change: the least in distances of two knots, as what bends faster is
# missed, and the largest in ranges of the argument, where it is nearly straight; and its sizes, in
# what would not surprise. Chosen as rough orders.
_SHORTEST, _LONGEST = 0.6, 2.0
_SIZES = np.geomspace(0.1, 10.0, 13)
# A point counts at most so many times more than the middle one: else a curve meets the law where
# the data are best, and nowhere else. Chosen.
_MOST = 10.0


def nearest_knots(design: Array, covariance: Array) -> Array:
    """What makes knots of a law: those of the curve that is nearest where the data are.

    Parameters
    ----------
    design : ndarray, shape (points, knots)
        What each knot adds to the curve.
    covariance : ndarray, shape (knots, knots)
        Of the knots: a point whose value they tell more exactly weighs more.

    Returns
    -------
    ndarray, shape (knots, points)
    """
    variance = np.sum((design @ covariance) * design, axis=1)
    known = variance > 0.0
    weight = np.where(known, 1.0 / np.sqrt(np.where(known, variance, 1.0)), 0.0)
    weight = np.minimum(weight, _MOST * np.median(weight[known]))
    return np.asarray(np.linalg.pinv(design * weight[:, None]) * weight)


@dataclass(frozen=True)
class LawPosterior:
    """A law as a normal distribution of its values.

    Attributes
    ----------
    mean : ndarray, shape (points,)
    covariance : ndarray, shape (points, points)
    missed : float
        Mean square of what the curve of the knots cannot follow.
    """

    mean: Array
    covariance: Array
    missed: float


def law_posterior(
    argument: Array, design: Array, project: Array, precision: Array, pull: Array, size: float
) -> LawPosterior:
    """A law from what data say of the knots of its nearest curve.

    The law is taken as a Gaussian process with the squared exponential covariance (Rasmussen and
    Williams, Gaussian Processes for Machine Learning, 2006, section 2.2 and, for averages over
    lengths and sizes by their evidence, 5.2). So it goes on beyond the data as large and as bent as
    it is among them, and may leave its curve between the knots.

    Parameters
    ----------
    argument : ndarray, shape (points,)
        Over the range of the curve.
    design : ndarray, shape (points, knots)
        What each knot adds to the curve there; zero throughout where the law is zero for sure.
    project : ndarray, shape (knots, points)
        What makes knots of a law, see `nearest_knots`.
    precision : ndarray, shape (knots, knots)
        Inverse covariance of the knots by the data alone; it may be singular.
    pull : ndarray, shape (knots,)
        `precision` times the knots that the data want.
    size : float
        Of the law, what would not surprise.
    """
    distance = np.abs(argument[:, None] - argument) / np.ptp(argument)
    sure = np.flatnonzero(~design.any(axis=1))[:1]
    log_evidences, means, seconds, missed = [], [], [], []
    left = np.eye(len(argument)) - design @ project
    left = np.eye(len(argument)) - design @ project
    lengths = np.geomspace(_SHORTEST / (len(pull) - 1), _LONGEST, 14)
    for length, factor in itertools.product(lengths, size * _SIZES):
        law = factor**2 * np.exp(-0.5 * (distance / length) ** 2)
        if len(sure):
            law -= law[:, sure] @ law[sure] / law[sure, sure]
        along = law @ project.T
        of_knots = project @ along
        # So written, the precision needs no inverse.
        gain = np.linalg.inv(np.eye(len(pull)) + precision @ of_knots)
        means.append(along @ (gain @ pull))
        known = along @ gain @ precision @ along.T
        seconds.append(law - known + np.outer(means[-1], means[-1]))
        missed.append(float(np.mean(np.sum((left @ law) * left, axis=1))))
        explained = pull @ of_knots @ gain @ pull
        log_evidences.append(0.5 * (explained + np.linalg.slogdet(gain)[1]))
    weights = np.exp(np.array(log_evidences) - np.max(log_evidences))
    weights /= weights.sum()
    mean = weights @ np.array(means)
    covariance = np.tensordot(weights, np.array(seconds), 1) - np.outer(mean, mean)
    return LawPosterior(np.asarray(mean), np.asarray(covariance), float(weights @ missed))
