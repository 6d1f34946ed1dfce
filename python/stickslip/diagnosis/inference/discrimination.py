"""How well candidates could be told apart where nothing was measured, for any forward model."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import Fit, ranked
from stickslip.diagnosis.fit.prediction import predict_with_variance
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.inference.runner_up import rivals
from stickslip.diagnosis.inference.verdict import MARGIN
from stickslip.diagnosis.model.problem import Array, Indices, Predict

TRIALS = 3
"""Trials of a new condition. Chosen."""

# How many of the leading candidates are compared. Chosen.
_CANDIDATES = 3


@dataclass(frozen=True, repr=False, eq=False)
class Separation(OneLine):
    """How well the leading candidates could be told apart at proposed conditions.

    Attributes
    ----------
    candidates : list of Fit
    predicted, sd : ndarray, shape (candidates, proposals)
        What each candidate predicts, and its own uncertainty, in the observable's unit.
    chi2 : ndarray, shape (proposals,)
        Expected between the two candidates that the proposal tells apart best.
    pair : ndarray of int, shape (proposals, 2)
        These two.
    """

    candidates: list[Fit]
    predicted: Array
    sd: Array
    chi2: Array
    pair: Indices


def separate(
    found: Findings, predict: Predict, proposals: Any, trials: int = TRIALS
) -> Separation | None:
    """Compare what the candidates predict at conditions that were not measured.

    What is named, or the one candidate of an ambiguous verdict, is to be told from the runner-up
    and what is close to that, an ambiguous set's members from one another. Each candidate is taken
    as fitted, with its own uncertainty at the new condition; where nothing was found, there is
    nothing to separate.

    Parameters
    ----------
    found : Findings
    predict : callable
        As that of the diagnosis, of the proposals alone; NaN where a candidate cannot compute one.
    proposals : Any
        Handed to `predict` as it is.
    trials : int
        Trials of the new condition, with the noise of the others.
    """
    candidates = _candidates(found)
    if len(candidates) < 2:
        return None
    predictions = [
        predict_with_variance(found.problem, fit, predict, proposals) for fit in candidates
    ]
    level, variance = (np.array(rows) for rows in zip(*predictions, strict=True))
    # A condition that one of the candidates cannot compute is no proposal.
    sound = np.all(np.isfinite(level) & np.isfinite(variance), axis=0)
    level, variance = np.where(sound, level, 0.0), np.where(sound, variance, 0.0)
    noise = _trial_variance(found, np.mean(level, axis=0)) / trials
    noise += float(np.median(found.roughness[: len(found.noise.mean)])) ** 2
    chi2 = np.zeros(level.shape[1])
    pair = np.zeros((level.shape[1], 2), dtype=np.int64)
    for a, b in itertools.combinations(range(len(candidates)), 2):
        # A single candidate is compared with each other one, and these not among themselves.
        if a > 0 and len(set_members(found)) == 1:
            continue
        gap = (level[a] - level[b]) ** 2 / (noise + variance[a] + variance[b])
        pair[gap > chi2] = (a, b)
        chi2 = np.maximum(chi2, gap)
    return Separation(candidates, level, np.sqrt(variance), chi2, pair)


def _trial_variance(found: Findings, level: Array) -> Array:
    """Variance of one trial at a level; the usual one where errors were stated for each mean."""
    noise = found.noise
    if noise.floor == 0.0 and noise.relative == 0.0:
        return np.full(level.shape, float(np.median(noise.sd)) ** 2)
    return np.asarray(noise.floor**2 + (noise.relative * level) ** 2)


def _candidates(found: Findings) -> list[Fit]:
    """What is to be told apart, best first; none where nothing was found."""
    if not found.detection.found:
        return []
    fits = list(ranked([*found.ranking.singles, *found.ranking.pairs], priced=True))
    chosen, members = found.verdict.fit, set_members(found)
    if chosen is None:
        return fits[:_CANDIDATES]
    if len(members) > 1:
        # Only those that the verdict cannot choose between.
        return members[:_CANDIDATES]
    others = rivals(chosen, fits)
    # Only the runner-up and those beside it: farther ones are told apart already, however much
    # more they would differ elsewhere.
    first = max((fit.priced_evidence for fit in others), default=0.0)
    fits = [chosen, *(fit for fit in others if first - fit.priced_evidence < MARGIN)]
    return fits[:_CANDIDATES]
