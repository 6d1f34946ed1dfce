"""The fit of the model without any cause, and how far the model itself can be trusted there.

Chi-square has many minima: a search that begins near the wrong one ends hundreds of units too
high, and its misfit would be taken for a hidden cause. So there are many starts, errors are taken
as too large at first, and before a misfit counts, the scan is widened.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import Fit, Start, make_candidate
from stickslip.diagnosis.fit.goodness import lack_of_fit_p
from stickslip.diagnosis.fit.multistart import (
    AGREE,
    LARGEST_INFLATION,
    STAGES,
    fit_candidates,
    refit,
)
from stickslip.diagnosis.fit.start_points import sobol_scan, well_separated
from stickslip.diagnosis.model.problem import Array, Problem

# The numbers below are chosen, not derived. Distances are in coordinates, of which 1 is a standard
# deviation of the prior.
#
# Points of a scan, powers of two for Sobol's sequence: of a model with more than one constant, and
# of others. With fewer the deepest minimum may have no start; each is a simulation of all
# conditions.
_SCAN, _SMALL_SCAN = 128, 32
# Starts from the first scan: it suffices for data that the model explains; else a wider one
# follows.
_STARTS = 6
# Least distance of starts: closer ones end in one minimum.
_APART = 0.7
# Starts from the wider scan, over the strata of all constants that are known in range only, and the
# fewest strata of one: low, middle and high.
_STRATA, _FEWEST_STRATA = 12, 3
# Most searches of each stage of `STAGES`: with the largest errors all starts, unless more than six
# constants are known in range only, and then the best ends; with fewer, a minimum that is the
# deepest with the stated errors may be lost.
_MOST = (18, 4, 3, 2)
# Steps of each search: as many as of a careful fit of a cause.
_STEPS = 10
# p-value of the lack of fit below which the search is widened: a right model has a smaller one in
# one case of five, and then pays for a second scan; with a smaller limit a wrong minimum that
# passes the tests is kept.
_WIDER_SEARCH_P = 0.2
# Chi-square per observable up to which a stage's fit passes for one that explains: a fit that is
# worse is far from the data, and responses of causes are looked at from a better one too.
_EXPLAINS = 3.0
# Distance below which ends are one minimum: with a smaller one the same is handed on several times,
# with a larger one neighbouring minima are taken for one.
_SAME = 0.05
# The most minima that are handed on: each is a place where all causes are tried.
_MOST_MINIMA = 12
# Widest changes of the constants that show the model's roughness: wider ones show its curvature.
_ROUGH_STEP = 0.02
# Share of the posterior's standard deviation for the same: well within what the data leave open.
_ROUGH_SHARE = 0.3
# Fewest draws, and draws for each constant: the scatter is then known to a sixth, and the plane
# through them leaves degrees of freedom.
_ROUGH_DRAWS, _ROUGH_DRAWS_EACH = 24, 3


@dataclass(frozen=True, repr=False)
class Recalibration(OneLine):
    """Result of the search.

    Attributes
    ----------
    null : Fit
        The recalibrated model.
    centre : Fit, optional
        The fit with errors large enough that it was adequate; only if the model does not fit at the
        end.
    local_minima : tuple of Fit
        Other ends, better ones first.
    scanned : ndarray, shape (points, size)
        Coordinates that were looked at before, all over the priors.
    """

    null: Fit
    centre: Fit | None
    local_minima: tuple[Fit, ...]
    scanned: Array


def recalibrate(problem: Problem, seed: int) -> Recalibration:
    """Fit the uncertain parameters within their priors.

    Parameters
    ----------
    problem : Problem
    seed : int
        Seed of the scans.

    Returns
    -------
    Recalibration
    """
    softest, candidate = problem.with_inflated_errors(LARGEST_INFLATION), make_candidate(problem)
    count = _SCAN if problem.base_count > 1 else _SMALL_SCAN
    scanned = sobol_scan(softest, candidate, count, seed)
    stages = _descend(problem, _well_separated(scanned, _STARTS))
    m = len(problem.observed)
    if problem.base_count and lack_of_fit_p(stages[-1][0].chi2, m, problem.dof) < _WIDER_SEARCH_P:
        wider = sobol_scan(softest, candidate, _SCAN, seed + 1)
        more = _descend(problem, _strata(problem, wider))
        scanned = np.vstack([scanned, wider])
        stages = [
            sorted([*first, *second], key=lambda fit: fit.chi2)
            for first, second in zip(stages, more, strict=True)
        ]
    ends = tuple(fit.chi2 for fit in stages[-1])
    converged = len(ends) > 1 and ends[1] - ends[0] < AGREE
    null = replace(stages[-1][0], starts=ends, converged=converged)
    distinct = tuple(_distinct(fit for stage in reversed(stages) for fit in stage)[1:_MOST_MINIMA])
    local_minima = with_stated_errors(problem, distinct)
    if null.chi2 < _EXPLAINS * m:
        return Recalibration(null, None, local_minima, scanned)
    firsts = [stage[0] for stage in reversed(stages)]
    centre = next((fit for fit in firsts if fit.chi2 < _EXPLAINS * m), firsts[-1])
    centre = with_stated_errors(problem, [centre])[0]
    return Recalibration(null, centre, local_minima, scanned)


def with_stated_errors(problem: Problem, fits: Sequence[Fit]) -> tuple[Fit, ...]:
    """Fits with inflated errors as fits of this problem, without moving them, best first."""
    return tuple(sorted(refit(problem, fits, 0), key=lambda fit: fit.chi2))


def _descend(problem: Problem, points: Sequence[Array]) -> list[list[Fit]]:
    """Ends of the searches at every size of the errors, best first."""
    candidate = make_candidate(problem)
    begins = [Start(point) for point in points]
    stages = []
    for stage, most in zip(STAGES, _MOST, strict=True):
        alone = [[start] for start in begins[:most]]
        fits = fit_candidates(
            problem.with_inflated_errors(*stage), [candidate] * len(alone), alone, _STEPS
        )
        # By the loss of the stage, to which a condition on the wrong side of its jump adds little.
        fits.sort(key=lambda fit: fit.starts[0])
        begins = [Start.of(fit) for fit in _distinct(fits)]
        stages.append(fits)
    return stages


def _distinct(fits: Iterable[Fit]) -> list[Fit]:
    """Without those that ended where an earlier one did."""
    return well_separated(fits, lambda fit: fit.x, _SAME)


def _well_separated(points: Array, count: int) -> list[Array]:
    """The best points that are not close to a better one."""
    return well_separated(points, lambda point: point, _APART, count)


def _strata(problem: Problem, points: Array) -> list[Array]:
    """The best point of each stratum of the parameters that are known only in range."""
    wide = [k for k, each in enumerate(problem.uncertain) if not each.prior.has_middle]
    if not wide:
        return _well_separated(points, _STRATA)
    chosen: list[Array] = []
    share = max(_STRATA // len(wide), _FEWEST_STRATA)
    for k in wide:
        edges = np.quantile(points[:, k], np.linspace(0.0, 1.0, share + 1)[1:-1])
        place = np.searchsorted(edges, points[:, k])
        chosen += [points[np.flatnonzero(place == each)[0]] for each in np.unique(place)]
    return chosen


def model_roughness(problem: Problem, fit: Fit, seed: int) -> Array:
    """Scatter of the prediction about a plane under tiny changes of the uncertain parameters.

    The changes are a small part of what the data leaves open. Where the motion is so sensitive that
    the prediction jumps all the same, it is no better than this, whatever the simulator's
    tolerance. In the observable's unit, shape (m,).
    """
    p = problem.base_count
    random = np.random.default_rng([seed, 5])
    count = max(_ROUGH_DRAWS, _ROUGH_DRAWS_EACH * p)
    spread = np.sqrt(np.diag(fit.covariance))[:p]
    step = np.minimum(_ROUGH_SHARE * spread, _ROUGH_STEP)
    move = random.standard_normal((count, p))
    x = np.tile(fit.x, (count, 1))
    x[:, :p] += move * step
    predicted = problem.predicted(x)
    predicted = np.where(np.isfinite(predicted), predicted, np.nan)
    level = np.nanmean(np.where(np.isfinite(predicted).any(axis=0), predicted, 0.0), axis=0)
    filled = np.where(np.isfinite(predicted), predicted, level)
    design = np.hstack([np.ones((count, 1)), move])
    left = filled - design @ np.linalg.lstsq(design, filled, rcond=None)[0]
    return np.asarray(np.sqrt(np.sum(left**2, axis=0) / max(count - p - 1, 1)))
