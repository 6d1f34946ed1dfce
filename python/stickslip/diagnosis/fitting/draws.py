"""Weighted draws from the posterior of a fitted model: its evidence, sizes and predictions."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.special import logsumexp, ndtri, softmax
from scipy.stats import chi2 as chi2_law
from scipy.stats import multivariate_t, qmc

from stickslip._util.arrays import Array
from stickslip.diagnosis.fitting.forms import Form
from stickslip.diagnosis.fitting.models import Fit, laplace
from stickslip.diagnosis.fitting.problem import Problem

COUNT, FEWEST = 256, 30
"""Draws of a model, a power of two for Sobol's sequence, and the effective number below which they
are drawn again about their mean. Chosen: the evidence is then known to a fifth."""

_DOF, _WIDER = 5.0, 1.15  # of the multivariate t that is drawn from; chosen: it has to be wider


class Draws(NamedTuple):
    """Coordinates, (draws, size), weights, of sum 1, and residuals, (draws, n), about a fit.

    `correction` is what Laplace's rule misses of the log-evidence, and `effective` their number.
    """

    x: Array
    weight: Array
    residual: Array
    correction: float
    effective: float


def drawn(problem: Problem, form: Form, fit: Fit, seed: int) -> Draws | None:
    """Draws about a fit, again from their own mean if few of them count.

    None where a coordinate is pushed against the end of its range, or nothing is free: there
    Laplace's rule stands.
    """
    if not len(fit.free) or np.any(np.diag(fit.covariance) <= 0.0):
        return None
    draws = _drawn(problem, form, fit, fit.x[fit.free], fit.covariance, seed)
    if draws is not None and draws.effective < FEWEST:
        free = draws.x[:, fit.free]
        middle = draws.weight @ free
        spread = (free - middle).T @ (draws.weight[:, None] * (free - middle))
        # Few draws say little of some directions: there it stays as wide as it was.
        again = _drawn(problem, form, fit, middle, spread + 0.5 * fit.covariance, seed + 1)
        if again is not None and again.effective > draws.effective:
            draws = again
    return draws


def _drawn(
    problem: Problem, form: Form, fit: Fit, middle: Array, covariance: Array, seed: int
) -> Draws | None:
    free, k = fit.free, len(fit.free)
    lower = _WIDER * np.linalg.cholesky(covariance)
    share = np.clip(qmc.Sobol(k + 1, seed=seed).random(COUNT), 1e-9, 1.0 - 1e-9)
    z = ndtri(share[:, :k]) / np.sqrt(chi2_law.ppf(share[:, k], _DOF) / _DOF)[:, None]
    points = middle + z @ lower.T
    low, high = problem.limits[:, free]
    inside = np.all((points >= low) & (points <= high), axis=1)
    if not inside.any():
        return None
    x = np.tile(fit.x, (int(inside.sum()), 1))
    x[:, free] = points[inside]
    residual = problem.residuals(x)
    sides = sum(problem.parameters[int(column)].one_sided for column in free)
    prior = -0.5 * np.einsum("vi,ij,vj->v", points[inside], fit.precision, points[inside])
    prior += 0.5 * np.linalg.slogdet(fit.precision / (2.0 * math.pi))[1] + sides * math.log(2.0)
    proposal = multivariate_t(np.zeros(k), np.eye(k), _DOF).logpdf(z[inside])
    proposal -= np.sum(np.log(np.diag(lower)))
    weights = form.density(residual, fit.h) + prior - proposal
    weight = softmax(weights)
    correction = float(logsumexp(weights)) - math.log(COUNT) - laplace(problem, form, fit)
    return Draws(x, weight, residual, correction, 1.0 / float(np.sum(weight**2)))
