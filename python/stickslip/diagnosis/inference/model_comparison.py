"""The recalibrated model against all its rivals, each under errors that hold where it stands.

A rival may lead to a better recalibration, which is then tested in its turn, so that no cause is
blamed for a search that ended in the wrong valley.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.inference.detection import Detection, detect
from stickslip.diagnosis.fit.fit_result import Fit, Start
from stickslip.diagnosis.fit.least_squares import fit_rivals
from stickslip.diagnosis.model.problem import Problem
from stickslip.diagnosis.data.noise import whitener
from stickslip.diagnosis.fit.cause_pairs import fit_pairs, singles_beside
from stickslip.diagnosis.fit.baseline import Recalibration, at_full_weight, model_roughness
from stickslip.diagnosis.fit.single_cause import (
    COMFORTABLE,
    Ranking,
    adequacy,
    fit_singles,
    look_again,
    nested,
    refine,
    settle_null,
)
from stickslip.diagnosis.fit.sensitivity import Signatures, find_signatures

Array = NDArray[np.float64]
Progress = Callable[[float, str], object]
"""Told the fraction that is done, 0 to 1, and what comes next."""

_CLOUDS, _SMOOTH = 3, 1.0
_LEADERS = 2


@dataclass(frozen=True)
class Base:
    """The recalibrated model, with errors that hold where it stands, and what is left of it.

    Attributes
    ----------
    problem : Problem
        With these errors.
    covariance : ndarray, shape (m, m)
        Of the data and of the model's own scatter.
    roughness : ndarray, shape (m,)
        Standard deviation of that scatter, in the observable's unit.
    null : Fit
    signatures : Signatures
    detection : Detection
    """

    problem: Problem
    covariance: Array
    roughness: Array
    null: Fit
    signatures: Signatures
    detection: Detection

    @property
    def clouds(self) -> int:
        """Rounds of random points that its fits need."""
        return _clouds(self.roughness, self.covariance)


def _clouds(roughness: Array, covariance: Array) -> int:
    share = float(np.sum(roughness**2 / np.diag(covariance)))
    return _CLOUDS if share > _SMOOTH else 0


def examine(problem: Problem, bare: Array, null: Fit, seed: int) -> Base:
    """Add the model's own scatter at a fit to the data's `bare` errors, fit again, and test.

    Parameters
    ----------
    problem : Problem
    bare : ndarray, shape (m, m)
        Covariance of the data alone.
    null : Fit
        The recalibrated model.
    seed : int

    Returns
    -------
    Base
    """
    roughness = model_roughness(problem, null, seed)
    covariance = bare + np.diag(roughness**2)
    problem = replace(problem, whiten=whitener(covariance))
    clouds = _clouds(roughness, covariance)
    again = fit_rivals(problem, [null.rival], [[Start.of(null)]], 6, clouds=clouds)[0]
    null = replace(again, certified=null.certified, starts=null.starts)
    signatures = find_signatures(problem, null)
    detection = detect(problem, null, signatures, seed)
    return Base(problem, covariance, roughness, null, signatures, detection)


def compare(
    base: Base, bare: Array, found: Recalibration, seed: int, say: Progress
) -> tuple[Base, Ranking]:
    """Fit all rivals.

    Parameters
    ----------
    base : Base
        From `examine`.
    bare : ndarray, shape (m, m)
        Covariance of the data alone.
    found : Recalibration
        What `recalibrate` gave.
    seed : int
    say : callable
        ``say(fraction, stage)`` is told the fraction that is done and what comes next.

    Returns
    -------
    base : Base
        Another one if the rivals have led to a better recalibration.
    ranking : Ranking
    """
    problem, null, clouds = base.problem, base.null, base.clouds
    basins = at_full_weight(problem, found.basins)
    views = [(null, base.signatures)]
    if found.centre is not None:
        # Far from all priors the recalibrated model is no place to look at causes from.
        centre = at_full_weight(problem, [found.centre])[0]
        views.append((centre, find_signatures(problem, centre)))
    singles = fit_singles(problem, views, basins, clouds)
    singles = look_again(problem, singles, singles[:_LEADERS], clouds)
    base, singles = _settled(base, bare, singles, seed)
    # A near twin whose searches did not agree may be found from where the leader is now.
    if any(not fit.certified for fit in singles[1:_LEADERS]):
        singles = look_again(base.problem, singles, singles[:1], base.clouds)
    if not base.detection.found:
        return base, Ranking(base.null, singles, ())
    if singles and base.clouds:
        # The best rival may sit where the model jumps more than at the null; its scatter counts
        # for all alike.
        more = model_roughness(base.problem, singles[0], seed)
        if np.any(more > 1.2 * base.roughness):
            base, singles = _rougher(base, bare, np.maximum(base.roughness, more), singles)
            singles = refine(base.problem, singles, {}, base.clouds)
    ranking = Ranking(base.null, singles, ())
    # The best single of two effects is often neither, so adequacy decides and not the rank.
    sufficient = any(adequacy(base.problem, fit) >= COMFORTABLE for fit in singles[:3])
    if singles and not sufficient:
        say(0.6, "fitting pairs of causes")
        if base.problem is not problem:
            others = at_full_weight(base.problem, [fit for fit, _ in views[1:]])
            views[1:] = [(fit, find_signatures(base.problem, fit)) for fit in others]
            basins = at_full_weight(base.problem, basins)
        views[0] = (base.null, base.signatures)
        pairs = fit_pairs(base.problem, views, singles, basins, base.clouds)
        pairs = look_again(base.problem, pairs, pairs[:1], base.clouds)
        singles = singles_beside(base.problem, singles, pairs)
        base, fits = _settled(base, bare, [*singles, *pairs], seed)
        singles = tuple(fit for fit in fits if len(fit.rival.causes) == 1)
        pairs = tuple(fit for fit in fits if len(fit.rival.causes) == 2)
        ranking = Ranking(base.null, singles, pairs)
    return base, ranking


def _settled(
    base: Base, bare: Array, fits: Sequence[Fit], seed: int
) -> tuple[Base, tuple[Fit, ...]]:
    """The null from its rivals' constants, examined anew if it is better, and they from its own."""
    singles = [fit for fit in fits if len(fit.rival.causes) == 1]
    null = settle_null(base.problem, base.null, singles)
    ordered = tuple(sorted(fits, key=lambda fit: -fit.log_evidence))
    if null is base.null:
        return base, nested(base.problem, null, ordered)
    base = examine(base.problem, bare, null, seed)
    return base, nested(base.problem, base.null, reweighed(base.problem, ordered))


def _rougher(
    base: Base, bare: Array, roughness: Array, fits: Sequence[Fit]
) -> tuple[Base, tuple[Fit, ...]]:
    """The same with a larger scatter of the model; the test that it has passed stands."""
    covariance = bare + np.diag(roughness**2)
    problem = replace(base.problem, whiten=whitener(covariance))
    (null,) = reweighed(problem, [base.null])
    signatures = find_signatures(problem, null)
    rough = Base(problem, covariance, roughness, null, signatures, base.detection)
    return rough, reweighed(problem, fits)


def reweighed(problem: Problem, fits: Sequence[Fit]) -> tuple[Fit, ...]:
    """Fits under other errors, best first; what their starts have shown still holds."""
    begins = [[Start.of(fit)] for fit in fits]
    fitted = fit_rivals(problem, [fit.rival for fit in fits], begins, 1, exact=False)
    kept = [
        replace(new, certified=old.certified, starts=old.starts)
        for new, old in zip(fitted, fits, strict=True)
    ]
    return tuple(sorted(kept, key=lambda fit: -fit.log_evidence))
