"""What the extended model gains on conditions that its fit never saw."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import chi2 as chi2_law

from stickslip.diagnosis.fitting import Fit, Start, fit_rivals
from stickslip.diagnosis.model import Problem

Array = NDArray[np.float64]

SHARE = 0.27
"""Share of the conditions that is held out."""

_RESAMPLES = 2000


@dataclass(frozen=True)
class Gain:
    """Error on held-out conditions before (recalibrated) and after (extended).

    Attributes
    ----------
    held_out : ndarray of int
        Conditions that were held out.
    chi2_before, chi2_after : float
        Per held-out condition.
    mae_before, mae_after : float
        Mean absolute error in the observable's unit.
    interval : tuple of float
        95 % interval of the fall of chi-square per condition, by a paired bootstrap.
    helps : bool
        Whether the error falls when it is weighed by the predictions' own covariance too, which
        counts for what no other condition can tell, such as a film's own camera.
    p_value : float
        Of the extended model's error under that covariance.
    same_choice : bool
        Whether the other conditions alone rank the same rival first.
    predicted_before, predicted_after : ndarray
        At the held-out conditions.
    """

    held_out: NDArray[np.int64]
    chi2_before: float
    chi2_after: float
    mae_before: float
    mae_after: float
    interval: tuple[float, float]
    helps: bool
    p_value: float
    same_choice: bool
    predicted_before: Array
    predicted_after: Array


def split(count: int, seed: int, group: ArrayLike | None = None) -> NDArray[np.int64]:
    """Conditions to hold out: both ends of the table and a spread of interior points.

    Parameters
    ----------
    count : int
        Number of conditions.
    seed : int
    group : array_like of int, shape (count,), optional
        Conditions that are held out together; of two to seven groups the last is held out.
    """
    groups = np.arange(count) if group is None else np.asarray(group, dtype=np.int64)
    number = int(groups.max()) + 1 if count else 0
    if number < 8:
        few = group is not None and number > 1
        return np.flatnonzero(groups == number - 1) if few else np.zeros(0, dtype=np.int64)
    wanted = max(3, round(SHARE * number))
    random = np.random.default_rng([seed, 23])
    edges = np.linspace(1, number - 1, wanted - 1).astype(int)
    inner = [
        int(random.integers(low, max(high, low + 1))) for low, high in itertools.pairwise(edges)
    ]
    return np.flatnonzero(np.isin(groups, [0, number - 1, *inner]))


def restricted(problem: Problem, keep: NDArray[np.int64], covariance: Array) -> Problem:
    """The problem with some of its conditions only."""
    lower = np.linalg.cholesky(covariance[np.ix_(keep, keep)])

    def predict(conditions: Any, parameters: Array) -> Array:
        return np.asarray(problem.predict(conditions, parameters))[:, keep]

    return replace(
        problem,
        predict=predict,
        observed=problem.observed[keep],
        whiten=np.linalg.inv(lower),
    )


def measure_gain(
    problem: Problem,
    covariance: Array,
    held_out: NDArray[np.int64],
    null: Fit,
    chosen: Fit,
    rivals: list[Fit],
    seed: int,
) -> Gain | None:
    """Refit without the held-out conditions, then predict them.

    Parameters
    ----------
    problem : Problem
        With all conditions.
    covariance : ndarray, shape (m, m)
        Of the observed means.
    held_out : ndarray of int
        From `split`.
    null, chosen : Fit
        Of all conditions; only where their fits began is taken from them.
    rivals : list of Fit
        Others that could have been chosen.
    seed : int
    """
    if not len(held_out):
        return None
    keep = np.setdiff1d(np.arange(len(problem.observed)), held_out)
    inside = restricted(problem, keep, covariance)
    others = [fit for fit in rivals if fit is not chosen]
    fits = [null, chosen, *others]
    begins = [[Start.of(fit, keep)] for fit in fits]
    refits = fit_rivals(inside, [fit.rival for fit in fits], begins, 6, exact=False)
    predicted = problem.predicted(np.stack([refits[0].x, refits[1].x]))[:, held_out]
    error = problem.observed[held_out] - predicted
    sd = np.sqrt(np.diag(covariance))[held_out]
    before, after = (error / sd) ** 2
    random = np.random.default_rng([seed, 29])
    draws = random.integers(0, len(held_out), (_RESAMPLES, len(held_out)))
    fall = np.mean((before - after)[draws], axis=1)
    best = max(refits[1:], key=lambda fit: fit.log_evidence)
    weighed = [
        _weighed(row, covariance, held_out, full, refit)
        for row, full, refit in zip(error, (null, chosen), refits, strict=False)
    ]
    return Gain(
        held_out,
        float(np.mean(before)),
        float(np.mean(after)),
        float(np.mean(np.abs(error[0]))),
        float(np.mean(np.abs(error[1]))),
        (float(np.quantile(fall, 0.025)), float(np.quantile(fall, 0.975))),
        weighed[1] < weighed[0],
        float(chi2_law.sf(weighed[1], len(held_out))),
        best is refits[1],
        predicted[0],
        predicted[1],
    )


def _weighed(
    error: Array, covariance: Array, held_out: NDArray[np.int64], full: Fit, refit: Fit
) -> float:
    """Chi-square of held-out errors by the data's covariance and the prediction's."""
    slope = full.slope[held_out]
    total = covariance[np.ix_(held_out, held_out)] + slope @ refit.covariance @ slope.T
    return float(error @ np.linalg.solve(total, error))
