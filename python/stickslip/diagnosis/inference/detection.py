"""Is there anything beyond the recalibrated model?

Two tests share the error rate: the lack of fit against the scatter of trials (F, any departure),
and the largest score over the library (a departure that looks like a known cause). The second has
its threshold from draws of pure noise through the same projection, and so has the smaller of both
p-values: the tests see the same noise, so that twice the smaller one would be too cautious.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.fit.goodness import lack_of_fit_p
from stickslip.diagnosis.fit.sensitivity import Sensitivities
from stickslip.diagnosis.model.problem import Array, Problem

ALPHA = 0.05
"""Rate of false alarms of both tests together: the usual choice."""

# Draws of pure noise: a p-value of 0.05 is then known to 0.003.
_DRAWS = 4000
# Refits of simulated data, and the p-values between which they are worth their cost. Chosen.
_BOOTSTRAP, _NEAR = 199, (0.01, 0.10)


@dataclass(frozen=True)
class Detection:
    """Result of both tests.

    Attributes
    ----------
    p_value : float
        p-value of both tests together.
    lack_of_fit_p, score_p : float
        p-value of each test.
    lack_of_fit, score : float
        F and the largest score.
    threshold : float
        Limit of the score, at half the error rate.
    bootstrapped : bool
        Whether the p-values are from refits of simulated data.
    found : bool
    """

    p_value: float
    lack_of_fit_p: float
    score_p: float
    lack_of_fit: float
    score: float
    threshold: float
    bootstrapped: bool
    found: bool


def detect(problem: Problem, null: Fit, sensitivities: Sensitivities, seed: int) -> Detection:
    """Test the recalibrated model: is anything left of the data?

    Parameters
    ----------
    problem : Problem
    null : Fit
        The recalibrated model.
    sensitivities : Sensitivities
        About it, of the causes that the score looks for; there may be none.
    seed : int
        Seed of the draws of pure noise.

    Returns
    -------
    Detection
    """
    m, p = len(problem.observed), problem.base_count
    random = np.random.default_rng([seed, 11])
    directions = sensitivities.directions()
    score = float(np.max(directions @ null.residual)) if len(directions) else 0.0
    noise = _noise(random, _DRAWS, m + p, sensitivities.basis, problem.dof)
    largest = np.max(noise @ directions.T, axis=1) if len(directions) else np.zeros(_DRAWS)
    misfit = np.sum(noise**2, axis=1)
    threshold = float(np.quantile(largest, 1.0 - ALPHA / 2))
    fit_p, score_p, both = _together(misfit, largest, null.chi2, score)
    # Beyond what draws can tell, the law of the misfit is known.
    exact = lack_of_fit_p(null.chi2, m, problem.dof)
    both = min(both, 2.0 * min(exact, score_p))
    fit_p = exact
    repeated = _NEAR[0] < both < _NEAR[1]
    if repeated:
        misfit, largest = _bootstrap(problem, null, directions, random)
        fit_p, score_p, both = _together(misfit, largest, null.chi2, score)
    return Detection(both, fit_p, score_p, null.chi2 / m, score, threshold, repeated, both < ALPHA)


def _together(
    misfit: Array, largest: Array, chi2: float, score: float
) -> tuple[float, float, float]:
    """p-values of a misfit and a score among those of pure noise, and of the smaller of them."""
    count = len(misfit)

    def shares(values: Array, observed: float) -> tuple[Array, float]:
        place = np.searchsorted(np.sort(values), [*values, observed], side="left")
        share = (1.0 + count - place) / (count + 1.0)
        return np.asarray(share[:-1]), float(share[-1])

    fits, fit_p = shares(misfit, chi2)
    scores, score_p = shares(largest, score)
    smaller = np.minimum(fits, scores)
    both = (1.0 + np.sum(smaller <= min(fit_p, score_p))) / (count + 1.0)
    return fit_p, score_p, float(both)


def _noise(random: np.random.Generator, count: int, size: int, basis: Array, dof: float) -> Array:
    """Residuals of pure noise after recalibration, shape (count, size)."""
    draws = random.standard_normal((count, size))
    if _estimated(dof):
        draws /= np.sqrt(random.chisquare(dof, (count, 1)) / dof)
    return np.asarray(draws - (draws @ basis) @ basis.T)


def _estimated(dof: float) -> bool:
    """Whether the noise has degrees of freedom, so that a draw has to have a scale of its own."""
    return math.isfinite(dof) and dof > 0


def _bootstrap(
    problem: Problem, null: Fit, directions: Array, random: np.random.Generator
) -> tuple[Array, Array]:
    """Misfit and largest score of data that the null model makes, each refitted with its own steps.

    The truth of each data set is drawn about the fitted point as the prior rows ask, and the refit
    goes by Gauss-Newton steps with the null's Jacobian.
    """
    m, p = len(problem.observed), problem.base_count
    factor = np.ones((_BOOTSTRAP, 1))
    if _estimated(problem.dof):
        factor = np.sqrt(problem.dof / random.chisquare(problem.dof, (_BOOTSTRAP, 1)))
    draws = random.standard_normal((_BOOTSTRAP, m + p))
    centre = problem.residuals(null.x[None, :])[0]
    # Rows: whitened data less that of the model at the fitted point, then the prior's.
    target = draws * factor
    x = np.tile(null.x, (_BOOTSTRAP, 1))
    inverse = np.linalg.pinv(null.jacobian)
    best = np.full(_BOOTSTRAP, np.inf)
    kept = np.zeros((_BOOTSTRAP, m + p))
    for _ in range(4):
        moved = centre - problem.residuals(x)
        residual = target - np.hstack([moved, x[:, :p] - null.x[:p]])
        chi2 = np.sum(residual**2, axis=1)
        better = chi2 < best
        best, kept[better] = np.where(better, chi2, best), residual[better]
        x = x.copy()
        x[:, :p] += np.clip(residual @ inverse.T, -1.0, 1.0)
    scores = np.max(kept @ directions.T, axis=1) if len(directions) else np.zeros(_BOOTSTRAP)
    return best, scores
