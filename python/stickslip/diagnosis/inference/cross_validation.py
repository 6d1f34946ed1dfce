"""What the extended model gains on conditions that its fit never saw."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import chi2 as chi2_law

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.data.trial_noise import whitener
from stickslip.diagnosis.fit.fit_result import Fit, ranked
from stickslip.diagnosis.fit.multistart import refit
from stickslip.diagnosis.model.problem import LOST, Array, Indices, Problem

SHARE = 0.27
"""Share of the conditions that is held out. Chosen: eight of thirty."""

INTERVAL, _ENDS = 0.95, (0.025, 0.975)
"""Coverage of the interval of the gain, and the quantiles at its ends."""

# Draws of the bootstrap. Chosen: they tell a normal law's quantiles at the ends to 0.06 of its sd.
_RESAMPLES = 2000
# Parts that are left out in turn, and fewest conditions, or groups, for either kind of holding out.
# Chosen.
_FOLDS, _FEWEST = 5, 8


@dataclass(frozen=True, repr=False, eq=False)
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
        p-value of the extended model's error, weighed by the prediction's own covariance too, and
        beyond what an error that set-ups share lets expect.
    choice : str
        Name of the candidate that the other conditions alone rank first.
    lead : float
        Its log-evidence from them above that of the chosen candidate.
    predicted_before, predicted_after : ndarray
        At the held-out conditions.
    """

    held_out: Indices
    chi2_before: float
    chi2_after: float
    mae_before: float
    mae_after: float
    interval: tuple[float, float]
    p_value: float
    choice: str
    lead: float
    predicted_before: Array
    predicted_after: Array

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {
            "n": len(self.held_out),
            "heldout_chi2_before": self.chi2_before,
            "heldout_chi2_after": self.chi2_after,
            "mae_before": self.mae_before,
            "mae_after": self.mae_after,
            "interval": list(self.interval),
        }


def split(
    count: int, seed: int, group: ArrayLike | None = None, singleton_condition: int | None = None
) -> Indices:
    """Conditions to hold out: both ends of the table, a spread of interior ones, and a singleton.

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
    groups, number = _groups(count, group)
    if number < _FEWEST:
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


def folds(count: int, group: ArrayLike | None = None) -> list[Indices]:
    """Neighbouring conditions, or groups of them, in parts that are left out in turn.

    None, if there are fewer than eight conditions that are not in groups.
    """
    groups, number = _groups(count, group)
    if number < (_FEWEST if group is None else 2):
        return []
    parts = np.array_split(np.arange(number), min(_FOLDS, number))
    return [np.flatnonzero(np.isin(groups, part)) for part in parts]


def _groups(count: int, group: ArrayLike | None) -> tuple[Indices, int]:
    """Group of each condition, its own where none are given, and how many groups there are."""
    groups = np.arange(count) if group is None else np.asarray(group, dtype=np.int64)
    return groups, int(groups.max()) + 1 if count else 0


def predictive_gain(
    problem: Problem, covariance: Array, null: Fit, chosen: Fit, parts: list[Indices]
) -> float:
    """Log predictive density of all conditions, each fitted without its part, above the null's.

    The prediction's own covariance counts too, for what no other condition can tell, such as a
    film's own camera.
    """
    total = 0.0
    for part in parts:
        keep, refits = _without(problem, covariance, part, (null, chosen))
        error = problem.observed - problem.predicted(np.stack([fit.x for fit in refits]))
        scores = []
        for row, full, inside in zip(error, (null, chosen), refits, strict=True):
            own, spread = _beyond(row, covariance, part, keep, full.slope, inside)
            chi2 = float(own @ np.linalg.solve(spread, own))
            scores.append(-0.5 * chi2 - 0.5 * float(np.linalg.slogdet(spread)[1]))
        total += scores[1] - scores[0]
    return total


def _without(
    problem: Problem, covariance: Array, held_out: Indices, fits: Sequence[Fit]
) -> tuple[Indices, list[Fit]]:
    """The conditions that are not held out, and the fits again of these alone."""
    keep = np.setdiff1d(np.arange(len(problem.observed)), held_out)
    return keep, refit(restricted(problem, keep, covariance), fits, rows=keep)


def restricted(problem: Problem, keep: Indices, covariance: Array) -> Problem:
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
    held_out: Indices,
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
        Covariance of the observed means.
    held_out : ndarray of int
        From `split`.
    null, chosen : Fit
        Fits of all conditions; only where their fits began is taken from them.
    candidates : list of Fit
        Others that could have been chosen, with as many causes.
    seed : int
        Seed of the bootstrap.

    Returns
    -------
    Gain, optional
        None, if nothing is held out.
    """
    if not len(held_out):
        return None
    others = [fit for fit in candidates if fit is not chosen]
    keep, refits = _without(problem, covariance, held_out, [null, chosen, *others])
    everywhere = problem.predicted(np.stack([refits[0].x, refits[1].x]))
    predicted = everywhere[:, held_out]
    error = problem.observed[held_out] - predicted
    sd = np.sqrt(np.diag(covariance))[held_out]
    before, after = (error / sd) ** 2
    random = np.random.default_rng([seed, 29])
    draws = random.integers(0, len(held_out), (_RESAMPLES, len(held_out)))
    fall = np.mean((before - after)[draws], axis=1)
    missed = problem.observed - everywhere[1]
    first = ranked(refits[1:])[0]
    own, spread = _beyond(missed, covariance, held_out, keep, chosen.slope, refits[1])
    weighed = float(own @ np.linalg.solve(spread, own))
    low, high = (float(np.quantile(fall, end)) for end in _ENDS)
    return Gain(
        held_out=held_out,
        chi2_before=float(np.mean(before)),
        chi2_after=float(np.mean(after)),
        mae_before=float(np.mean(np.abs(error[0]))),
        mae_after=float(np.mean(np.abs(error[1]))),
        interval=(low, high),
        p_value=float(chi2_law.sf(weighed, len(held_out))),
        choice=first.name,
        lead=first.log_evidence - refits[1].log_evidence,
        predicted_before=predicted[0],
        predicted_after=predicted[1],
    )


def _beyond(
    error: Array,
    covariance: Array,
    held_out: Indices,
    keep: Indices,
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
