"""The recalibrated model against all its candidates, each under errors that hold where it stands.

A candidate may lead to a better recalibration, which is then tested in its turn, so that no cause
is blamed for a search that ended in the wrong minimum.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.data.trial_noise import whitener
from stickslip.diagnosis.fit.baseline import Recalibration, model_roughness, with_stated_errors
from stickslip.diagnosis.fit.careful_fit import refine, search_until_converged
from stickslip.diagnosis.fit.cause_pairs import fit_pairs, second_causes, singles_beside
from stickslip.diagnosis.fit.fit_result import PAIR_PRICE, Fit, Ranking, ranked
from stickslip.diagnosis.fit.goodness import ADEQUATE, COMFORTABLE, adequacy
from stickslip.diagnosis.fit.multistart import AGREE, refit_keeping_starts
from stickslip.diagnosis.fit.narrow_minima import NarrowScan, fit_narrow, scan_narrow
from stickslip.diagnosis.fit.sensitivity import Sensitivities, find_sensitivities
from stickslip.diagnosis.fit.single_cause import (
    fit_singles,
    refit_null,
    refit_worse_than_null,
    search_all_over,
    search_near_leaders,
)
from stickslip.diagnosis.fit.view import View
from stickslip.diagnosis.inference.detection import Detection, detect
from stickslip.diagnosis.model.problem import Array, Problem

Progress = Callable[[float, str], object]
"""Told the fraction that is done, 0 to 1, and what comes next."""

# Rounds of random points that fits need where the model is rough, and the sum of its variances, in
# those of all errors, from which it is. Chosen: it then changes chi-square by about one.
_RANDOM_RESTARTS, _SMOOTH = 3, 1.0
# Leaders whose causes are exchanged for others, and how often that begins again where another one
# has come to lead. Chosen: a third one was not seen to lead.
_LEADERS, _AGAIN = 2, 3
# The leader's roughness counts where it is larger than the null's by this factor. Chosen.
_ROUGHER = 1.2


@dataclass(frozen=True, repr=False, eq=False)
class AssessedBaseline(OneLine):
    """The recalibrated model, with errors that hold where it stands, and what is left of it.

    Attributes
    ----------
    problem : Problem
        With these errors.
    covariance : ndarray, shape (m, m)
        Covariance of the data and of the model's own scatter.
    roughness : ndarray, shape (m,)
        Standard deviation of that scatter, in the observable's unit.
    null : Fit
    sensitivities : Sensitivities
    detection : Detection
    """

    problem: Problem
    covariance: Array
    roughness: Array
    null: Fit
    sensitivities: Sensitivities
    detection: Detection

    @property
    def random_restarts(self) -> int:
        """Rounds of random points that its fits need."""
        return _random_restarts(self.roughness, self.covariance)

    @property
    def view(self) -> View:
        """The recalibrated model with the responses of all causes."""
        return View(self.problem, self.null, self.sensitivities)


def _random_restarts(roughness: Array, covariance: Array) -> int:
    share = float(np.sum(roughness**2 / np.diag(covariance)))
    return _RANDOM_RESTARTS if share > _SMOOTH else 0


def assess_baseline(
    problem: Problem, data_covariance: Array, null: Fit, seed: int, least: Array | float = 0.0
) -> AssessedBaseline:
    """Add the model's own scatter at a fit to the errors of the data, fit again, and test.

    Parameters
    ----------
    problem : Problem
    data_covariance : ndarray, shape (m, m)
        Covariance of the data alone.
    null : Fit
        The recalibrated model.
    seed : int
    least : ndarray, shape (m,), or float
        Scatter that an earlier pass has counted, in the observable's unit.

    Returns
    -------
    AssessedBaseline
    """
    roughness = np.maximum(least, model_roughness(problem, null, seed))
    covariance = data_covariance + np.diag(roughness**2)
    problem = replace(problem, whiten=whitener(covariance))
    restarts = _random_restarts(roughness, covariance)
    (null,) = refit_keeping_starts(problem, [null], random_restarts=restarts)
    sensitivities = find_sensitivities(problem, null)
    detection = detect(problem, null, sensitivities, seed)
    return AssessedBaseline(problem, covariance, roughness, null, sensitivities, detection)


def compare_candidates(
    base: AssessedBaseline, data_covariance: Array, found: Recalibration, seed: int, say: Progress
) -> tuple[AssessedBaseline, Ranking]:
    """Fit all candidates.

    Parameters
    ----------
    base : AssessedBaseline
        From `assess_baseline`.
    data_covariance : ndarray, shape (m, m)
        Covariance of the data alone.
    found : Recalibration
        What `recalibrate` gave.
    seed : int
    say : callable
        ``say(fraction, stage)`` is told the fraction that is done and what comes next.

    Returns
    -------
    base : AssessedBaseline
        Another one if the candidates have led to a better recalibration.
    ranking : Ranking
    """
    problem, restarts = base.problem, base.random_restarts
    local_minima = with_stated_errors(problem, found.local_minima)
    # Far from all priors the recalibrated model is no point to look at causes from.
    centres = with_stated_errors(problem, [] if found.centre is None else [found.centre])
    views = [base.view, *(View.of(problem, fit) for fit in centres)]
    singles = fit_singles(problem, views, found.scanned, local_minima, restarts)
    base, singles = explore(base, data_covariance, singles, singles[:_LEADERS], seed)
    # A nearly equivalent cause whose starts did not agree may be found from the leader's new end.
    if any(not fit.converged for fit in singles[1:_LEADERS]):
        base, singles = explore(base, data_covariance, singles, singles[:1], seed)
    if not base.detection.found:
        return base, Ranking(base.null, singles, ())
    if singles and base.random_restarts:
        # The best candidate may stand where the model jumps more than at the null; its scatter
        # counts for all alike.
        more = model_roughness(base.problem, singles[0], seed)
        if np.any(more > _ROUGHER * base.roughness):
            larger = np.maximum(base.roughness, more)
            base, singles = _rougher(base, data_covariance, larger, singles)
            singles = refine(base.problem, singles, {}, base.random_restarts)
            base, singles = settled(base, data_covariance, singles, seed)
    # The best single of two effects is often neither, so adequacy decides and not the rank.
    if not singles:
        return base, Ranking(base.null, (), ())
    scans = []
    if _best_adequacy(base.problem, singles) < ADEQUATE:
        leader = singles[0]
        singles = search_all_over(base.problem, singles, base.random_restarts)
        if singles[0] is not leader:
            base, singles = explore(base, data_covariance, singles, singles[:_LEADERS], seed)
    if _best_adequacy(base.problem, singles) < ADEQUATE:
        scans = scan_narrow(base.problem, base.null)
        singles = _with_narrow(base, scans, singles, [base.null])
        if any(singles[0].name == scan.cause.name for scan in scans):
            base, singles = explore(base, data_covariance, singles, singles[:1], seed)
    if _best_adequacy(base.problem, singles) >= COMFORTABLE:
        say(0.6, "looking for a second cause")
        pairs = second_causes(base.problem, singles[0], base.random_restarts)
        least = singles[0].log_evidence + PAIR_PRICE
        # A pair that leads has to be held against all pairs.
        if all(pair.log_evidence <= least for pair in pairs):
            return base, Ranking(base.null, singles, pairs)
    say(0.6, "fitting pairs of causes")
    if base.problem is not problem:
        centres = with_stated_errors(base.problem, centres)
        views = [base.view, *(View.of(base.problem, fit) for fit in centres)]
        local_minima = with_stated_errors(base.problem, local_minima)
    pairs = fit_pairs(
        base.problem, views, singles, found.scanned, local_minima, base.random_restarts
    )
    pairs = _with_narrow(base, scans, pairs, singles)
    base, fits = explore(base, data_covariance, [*singles, *pairs], pairs[:1], seed)
    ranking = Ranking.of(base.null, fits)
    singles = singles_beside(base.problem, ranking.singles, ranking.pairs)
    base, fits = settled(base, data_covariance, [*singles, *ranking.pairs], seed)
    return base, Ranking.of(base.null, fits)


def _best_adequacy(problem: Problem, singles: Sequence[Fit]) -> float:
    """The best p-value of the leading single causes."""
    return max(adequacy(problem, fit) for fit in singles[:3])


def _with_narrow(
    base: AssessedBaseline, scans: Sequence[NarrowScan], fits: Sequence[Fit], models: Sequence[Fit]
) -> tuple[Fit, ...]:
    """Fits, and where they are better those of causes with narrow minima, beside some models."""
    known = {fit.name: fit for fit in fits}
    for fit in fit_narrow(base.problem, scans, models, base.random_restarts):
        if fit.name not in known or fit.chi2 < known[fit.name].chi2:
            # Its starts may be of one minimum, so that they agree says nothing.
            known[fit.name] = replace(fit, converged=False, starts=fit.starts[:1])
    ordered = ranked(list(known.values()))
    if ordered == ranked(fits):
        return ordered
    return ranked(search_until_converged(base.problem, ordered, base.random_restarts))


def explore(
    base: AssessedBaseline,
    data_covariance: Array,
    fits: Sequence[Fit],
    leaders: Sequence[Fit],
    seed: int,
) -> tuple[AssessedBaseline, tuple[Fit, ...]]:
    """Other causes in the place of the leaders', and the null from the constants of the best.

    Until the one that leads, of those with as many causes as the leaders, is the one beside which
    others were sought: of one that has come to lead meanwhile, the twins were sought near the
    others only.
    """
    found = tuple(fits)
    for _ in range(1 + _AGAIN):
        if not leaders:
            break
        last = leaders[0]
        found = search_near_leaders(base.problem, found, leaders, base.random_restarts)
        base, found = settled(base, data_covariance, found, seed)
        count = len(last.candidate.causes)
        leaders = [fit for fit in found if len(fit.candidate.causes) == count][:1]
        if leaders[0].name == last.name and leaders[0].chi2 > last.chi2 - AGREE:
            break
    return base, found


def settled(
    base: AssessedBaseline, data_covariance: Array, fits: Sequence[Fit], seed: int
) -> tuple[AssessedBaseline, tuple[Fit, ...]]:
    """The null from the candidates' constants, assessed again if better, and they from its.

    All that follows from the null, its test among it, then holds for the one null that is kept. The
    model's scatter never shrinks: where it was seen, a candidate may stand that jumps by as much.
    """
    ordered = ranked(fits)
    null = refit_null(base.problem, base.null, ordered)
    if null is base.null:
        return base, refit_worse_than_null(base.problem, null, ordered)
    base = assess_baseline(base.problem, data_covariance, null, seed, base.roughness)
    return base, refit_worse_than_null(base.problem, base.null, reweighed(base.problem, ordered))


def _rougher(
    base: AssessedBaseline, data_covariance: Array, roughness: Array, fits: Sequence[Fit]
) -> tuple[AssessedBaseline, tuple[Fit, ...]]:
    """The same with a larger scatter of the model; the test that it has passed stands."""
    covariance = data_covariance + np.diag(roughness**2)
    problem = replace(base.problem, whiten=whitener(covariance))
    (null,) = reweighed(problem, [base.null])
    sensitivities = find_sensitivities(problem, null)
    rough = AssessedBaseline(problem, covariance, roughness, null, sensitivities, base.detection)
    return rough, reweighed(problem, fits)


def reweighed(problem: Problem, fits: Sequence[Fit]) -> tuple[Fit, ...]:
    """Fits under other errors, best first; what their starts have shown still holds."""
    return ranked(refit_keeping_starts(problem, fits, 1))
