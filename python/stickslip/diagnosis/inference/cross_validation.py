"""What the extended model gains on conditions that its fit never saw."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import chi2 as chi2_law

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.data.noise import whitener
from stickslip.diagnosis.fit.fit_result import Fit, Start, ranked
from stickslip.diagnosis.fit.least_squares import fit_candidates
from stickslip.diagnosis.model.problem import LOST, Problem

Array = NDArray[np.float64]

SHARE = 0.27
"""Share of the conditions that is held out."""

INTERVAL, _ENDS = 0.95, (0.025, 0.975)
"""Coverage of the interval of the gain, and the quantiles at its ends."""

_RESAMPLES = 2000
_FOLDS = 5


@dataclass(frozen=True, repr=False)
class Gain(OneLine):
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
    p_value : float
        Of the extended model's error, weighed by the prediction's own covariance too, and beyond
        what an error that set-ups share lets expect.
    choice : str
        Name of the candidate that the other conditions alone rank first.
    predicted_before, predicted_after : ndarray
        At the held-out conditions.
    """

    held_out: NDArray[np.int64]
    chi2_before: float
    chi2_after: float
    mae_before: float
    mae_after: float
    interval: tuple[float, float]
    p_value: float
    choice: str
    predicted_before: Array
    predicted_after: Array


def split(
    count: int, seed: int, group: ArrayLike | None = None, singleton_condition: int | None = None
) -> NDArray[np.int64]:
    """Conditions to hold out: both ends of the table, a spread of interior points, and an unusual
    one.

    Parameters
    ----------
    count : int
        Number of conditions.
    seed : int
    group : array_like of int, shape (count,), optional
        Conditions that are held out together; of two to seven groups the last is held out.
    singleton_condition : int, optional
        A condition that is like no other.
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
    also = [] if singleton_condition is None else [int(groups[singleton_condition])]
    return np.flatnonzero(np.isin(groups, [0, number - 1, *inner, *also]))


def folds(count: int, group: ArrayLike | None = None) -> list[NDArray[np.int64]]:
    """Neighbouring conditions, or groups of them, in parts that are left out in turn.

    None, if there are fewer than eight conditions that are not in groups.
    """
    groups = np.arange(count) if group is None else np.asarray(group, dtype=np.int64)
    number = int(groups.max()) + 1 if count else 0
    if number < (8 if group is None else 2):
        return []
    parts = np.array_split(np.arange(number), min(_FOLDS, number))
    return [np.flatnonzero(np.isin(groups, part)) for part in parts]


def predictive_gain(
    problem: Problem, covariance: Array, null: Fit, chosen: Fit, parts: list[NDArray[np.int64]]
) -> float:
    """Log predictive density of all conditions, each fitted without its part, above the null's.

    The prediction's own covariance counts too, for what no other condition can tell, such as a
    film's own camera.
    """
    total = 0.0
    for part in parts:
        keep = np.setdiff1d(np.arange(len(problem.observed)), part)
        inside = restricted(problem, keep, covariance)
        both = (null, chosen)
        begins = [[Start.of(fit, keep)] for fit in both]
        refits = fit_candidates(inside, [fit.candidate for fit in both], begins, 6, exact=False)
        error = problem.observed - problem.predicted(np.stack([fit.x for fit in refits]))
        scores = []
        for row, full, refit in zip(error, both, refits, strict=True):
            own, spread = _beyond(row, covariance, part, keep, full.slope, refit)
            chi2 = float(own @ np.linalg.solve(spread, own))
            scores.append(-0.5 * chi2 - 0.5 * float(np.linalg.slogdet(spread)[1]))
        total += scores[1] - scores[0]
    return total


def restricted(problem: Problem, keep: NDArray[np.int64], covariance: Array) -> Problem:
    """The problem with some of its conditions only."""

    def predict(conditions: Any, parameters: Array) -> Array:
        return np.asarray(problem.predict(conditions, parameters))[:, keep]

    return replace(
        problem,
        predict=predict,
        low_fidelity=None,
        observed=problem.observed[keep],
        whiten=whitener(covariance[np.ix_(keep, keep)]),
    )


def measure_gain(
    problem: Problem,
    covariance: Array,
    held_out: NDArray[np.int64],
    null: Fit,
    chosen: Fit,
    candidates: list[Fit],
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
    candidates : list of Fit
        Others that could have been chosen.
    seed : int
        Of the bootstrap.

    Returns
    -------
    Gain, optional
        None, if nothing is held out.
    """
    if not len(held_out):
        return None
    keep = np.setdiff1d(np.arange(len(problem.observed)), held_out)
    inside = restricted(problem, keep, covariance)
    others = [fit for fit in candidates if fit is not chosen]
    fits = [null, chosen, *others]
    begins = [[Start.of(fit, keep)] for fit in fits]
    refits = fit_candidates(inside, [fit.candidate for fit in fits], begins, 6, exact=False)
    everywhere = problem.predicted(np.stack([refits[0].x, refits[1].x]))
    predicted = everywhere[:, held_out]
    error = problem.observed[held_out] - predicted
    sd = np.sqrt(np.diag(covariance))[held_out]
    before, after = (error / sd) ** 2
    random = np.random.default_rng([seed, 29])
    draws = random.integers(0, len(held_out), (_RESAMPLES, len(held_out)))
    fall = np.mean((before - after)[draws], axis=1)
    best = ranked(refits[1:], priced=True)[0]
    missed = problem.observed - everywhere[1]
    own, spread = _beyond(missed, covariance, held_out, keep, chosen.slope, refits[1])
    weighed = float(own @ np.linalg.solve(spread, own))
    return Gain(
        held_out,
        float(np.mean(before)),
        float(np.mean(after)),
        float(np.mean(np.abs(error[0]))),
        float(np.mean(np.abs(error[1]))),
        (float(np.quantile(fall, _ENDS[0])), float(np.quantile(fall, _ENDS[1]))),
        float(chi2_law.sf(weighed, len(held_out))),
        best.name,
        predicted[0],
        predicted[1],
    )


def _beyond(
    error: Array,
    covariance: Array,
    held_out: NDArray[np.int64],
    keep: NDArray[np.int64],
    slope: Array,
    refit: Fit,
) -> tuple[Array, Array]:
    """Held-out errors beyond those that the kept conditions let expect, and their covariance.

    The kept conditions tell of an error that set-ups share; what is left is the data's own and that
    of the prediction.
    """
    across = covariance[np.ix_(held_out, keep)]
    expected = np.linalg.solve(covariance[np.ix_(keep, keep)], across.T).T
    moved = slope[held_out] - expected @ slope[keep]
    own = covariance[np.ix_(held_out, held_out)] - expected @ across.T
    spread = own + moved @ refit.covariance @ moved.T
    # What cannot be predicted is missed by far, and says nothing of the others.
    missed = np.where(np.isfinite(error), error, LOST * np.sqrt(np.diag(covariance)))[held_out]
    return missed - expected @ np.where(np.isfinite(error), error, 0.0)[keep], np.asarray(spread)
