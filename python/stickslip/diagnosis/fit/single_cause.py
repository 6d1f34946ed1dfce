"""Fits of all single causes, and how well a model explains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.inference.detection import lack_of_fit_p
from stickslip.diagnosis.fit.fit_result import Fit, Rival, Start, make_rival
from stickslip.diagnosis.fit.least_squares import AGREE, SOFTEST, STAGES, fit_rivals, spread_factor
from stickslip.diagnosis.model.problem import Cause, Problem
from stickslip.diagnosis.fit.multistart import apart, scan
from stickslip.diagnosis.fit.sensitivity import (
    Signatures,
    find_signatures,
    in_place,
    screen,
    seen_from,
    starts,
    with_cause,
)

Array = NDArray[np.float64]

ADEQUATE = 0.01
"""A model is adequate whose lack of fit has at least this p-value."""

COMFORTABLE = 0.3
"""With a single cause of at least this p-value, no pair is looked for."""

CAREFUL = 10
"""Steps of a careful fit."""

_QUICK = 5
_STARTS, _BEGINS, _CLOSE, _MET = 2, 6, 0.1, 0.2
_SURVIVORS = 6
_WITHIN = 14.0
_HOPELESS = (np.inf, 8.0, 40.0, 30.0)
_LEADING, _ROUNDS = 2, (2.0, 2.0, 2.0, 1.0, 1.0, 1.0)
_SCAN, _FREED_STARTS = 128, 3


@dataclass(frozen=True)
class Ranking:
    """Rivals, best first.

    Attributes
    ----------
    null : Fit
    singles, pairs : tuple of Fit
        By log-evidence, falling.
    """

    null: Fit
    singles: tuple[Fit, ...]
    pairs: tuple[Fit, ...]

    def replaced(self, old: Fit, new: Fit) -> Ranking:
        """The same with a better fit of one rival."""

        def ordered(fits: tuple[Fit, ...]) -> tuple[Fit, ...]:
            fits = tuple(new if fit is old else fit for fit in fits)
            return tuple(sorted(fits, key=lambda fit: -fit.log_evidence))

        return Ranking(self.null, ordered(self.singles), ordered(self.pairs))


def adequacy(problem: Problem, fit: Fit) -> float:
    """p-value of the lack of fit of a rival.

    How large an effect is says nothing of whether it explains: the prior row of an amplitude is the
    evidence's, not the misfit's.
    """
    base = problem.base_count
    extra = len(fit.rival.free) - base
    # The prior row of a freed constant is nearly void.
    extra += sum(cause.frees is not None for cause in fit.rival.causes)
    constants = fit.x[fit.rival.free[:base]] / fit.rival.width[:base]
    chi2 = fit.data_chi2 + float(constants @ constants)
    return lack_of_fit_p(chi2, len(problem.observed) - extra, problem.dof)


Views = Sequence[tuple[Fit, Signatures]]
"""Points at which the responses of all causes are known, the recalibrated model first."""


def fit_singles(
    problem: Problem, views: Views, basins: Sequence[Fit] = (), clouds: int = 0
) -> tuple[Fit, ...]:
    """Fit every cause quickly from its signatures, and those that survive with care.

    Parameters
    ----------
    problem : Problem
    views : sequence of tuple of Fit and Signatures
        Their rows are the starts.
    basins : sequence of Fit
        Other minima of the model without a cause, to begin from too.
    clouds : int
        As for `fit_rivals`; for the careful fits.
    """
    bases = [*(fit for fit, _ in views), *basins]
    found: dict[int, list[tuple[float, Start]]] = {k: [] for k in range(len(problem.causes))}
    for base in bases:
        for _, signatures in views:
            softer, seen_there = seen_from(problem, signatures, base, SOFTEST)
            screened = screen(seen_there, softer.residual)
            for index, points in found.items():
                points += starts(problem, softer, seen_there, screened, index, _STARTS)
    begins = {index: _promising(points) for index, points in found.items()}
    seen = [index for index in begins if begins[index]]
    rivals = [make_rival(problem, [problem.causes[index]]) for index in seen]
    ordered = best_first(problem, rivals, [begins[index] for index in seen])
    # Near the null a walk may settle for a little of the cause; one comes from its far side.
    bold = _bold(problem, *views[-1])
    pairs = [
        (k, start)
        for k, points in enumerate(ordered)
        for start in (points[0], *bold.get(seen[k], ()), *_far_off(problem, rivals[k]))
    ]
    quick = quick_fits(problem, [rivals[k] for k, _ in pairs], [[start] for _, start in pairs])
    best: list[Fit] = []
    others: dict[str, list[Start]] = {}
    for rival, tried in zip(rivals, ordered, strict=True):
        nearest, *rest = [fit for fit in quick if fit.rival.causes == rival.causes]
        best.append(nearest)
        others[nearest.name] = [*(Start.of(fit) for fit in rest), *tried[1:3]]
    return refine(problem, best, others, clouds)


def _bold(problem: Problem, base: Fit, signatures: Signatures) -> dict[int, list[Start]]:
    """For each cause an amplitude of one standard deviation, of the sign that promises more."""
    softer, seen_there = seen_from(problem, signatures, base, SOFTEST)
    left = screen(seen_there, softer.residual).left
    chosen: dict[int, int] = {}
    far = (signatures.at >= 0) & (np.abs(signatures.amplitude) > 1.0)
    for row in np.flatnonzero(far).tolist():
        index = int(signatures.cause[row])
        if index not in chosen or left[row] < left[chosen[index]]:
            chosen[index] = row
    result = {}
    for index, row in chosen.items():
        x = base.x.copy()
        x[problem.base_count :] = signatures.point[row, problem.base_count :]
        x[signatures.at[row]] = np.sign(signatures.amplitude[row])
        result[index] = [with_cause(problem, base, signatures, row, x, 1.0)]
    return result


def quick_fits(
    problem: Problem,
    rivals: Sequence[Rival],
    begins: Sequence[Sequence[Start]],
    first: int = 0,
) -> list[Fit]:
    """A few steps at every stage of a search from afar, from the `first` one on.

    Walks of one rival that have met go on as one, so there may be fewer ends than starts.
    """
    fits: list[Fit] = []
    for stage, limit in list(zip(STAGES, _HOPELESS, strict=True))[first:]:
        fits = fit_rivals(problem.tempered(*stage), rivals, begins, _QUICK, limit, exact=False)
        fits = _parted(fits)
        rivals, begins = [fit.rival for fit in fits], [[Start.of(fit)] for fit in fits]
    return fits


def _parted(fits: Sequence[Fit]) -> list[Fit]:
    """Without those that ended close to a better one of the same rival."""
    by_name: dict[str, list[Fit]] = {}
    for fit in sorted(fits, key=lambda fit: fit.starts[0]):
        by_name.setdefault(fit.name, []).append(fit)
    return [fit for ends in by_name.values() for fit in apart(ends, lambda fit: fit.x, _MET)]


def _promising(points: list[tuple[float, Start]]) -> list[Start]:
    """The best starts that do not lie close together."""
    ordered = [start for _, start in sorted(points, key=lambda each: each[0])]
    return apart(ordered, lambda start: start.x, _CLOSE)[:_BEGINS]


def _far_off(problem: Problem, rival: Rival) -> list[Start]:
    """Where a rival could be that is not seen from the recalibrated model.

    That one may have gone far to make up for the cause, which shows itself only after its return.
    """
    freed = any(cause.frees is not None for cause in rival.causes)
    count, kept = (_SCAN, _FREED_STARTS) if freed else (_SCAN // 2, 1)
    points = apart(scan(problem.tempered(SOFTEST), rival, count, 1), lambda point: point, 1.0)
    return [Start(point) for point in points[:kept]]


def settle_null(problem: Problem, null: Fit, singles: Sequence[Fit]) -> Fit:
    """The null again from the constants of the leading rivals.

    A rival that found a better valley must not win for that alone.
    """
    p = problem.base_count
    begins = [Start.of(null)]
    for fit in singles[:_SURVIVORS]:
        x = null.x.copy()
        x[:p] = fit.x[:p]
        begins.append(Start(x, fit.slope[:, :p]))
    ordered = best_first(problem, [null.rival], [begins])
    again = fit_rivals(problem, [null.rival], [points[:3] for points in ordered], CAREFUL)[0]
    return again if again.chi2 < null.chi2 - AGREE else null


def nested(problem: Problem, null: Fit, fits: Sequence[Fit]) -> tuple[Fit, ...]:
    """Rivals that are worse than the model without a cause, which each contains, from that one.

    Not where that one is hopeless itself.
    """
    best = max((fit.log_evidence for fit in fits), default=null.log_evidence)
    if null.log_evidence < best - _WITHIN:
        return tuple(fits)
    worse = [fit for fit in fits if fit.chi2 > null.chi2]
    begins = [[Start(null.x)] for _ in worse]
    again = fit_rivals(problem, [fit.rival for fit in worse], begins, CAREFUL)
    better = {new.name: new for new, old in zip(again, worse, strict=True) if new.chi2 < old.chi2}
    kept = [better.get(fit.name, fit) for fit in fits]
    return tuple(sorted(kept, key=lambda fit: -fit.log_evidence))


def look_again(
    problem: Problem, fits: Sequence[Fit], leaders: Sequence[Fit], clouds: int = 0
) -> tuple[Fit, ...]:
    """Other causes in the place of one of a leader's, at its constants.

    What they do is looked at anew there: a near twin does as well with constants that are near to
    the leader's, which may be far from the recalibrated ones.
    """
    known = {fit.name: fit for fit in fits}
    begins: dict[str, list[Start]] = {}
    rivals: dict[str, Rival] = {}
    for leader in leaders:
        for dropped in leader.rival.causes:
            base = without(problem, leader, dropped)
            signatures = find_signatures(problem, base)
            for index, cause in enumerate(problem.causes):
                points = in_place(problem, base, signatures, index)
                if not points or cause in leader.rival.causes:
                    continue
                both = sorted([*base.rival.causes, cause], key=lambda each: each.name)
                rival = make_rival(problem, both)
                name = rival.name
                rivals[name] = rival
                begins.setdefault(name, []).extend(points)
    ordered = best_first(problem, list(rivals.values()), list(begins.values()))
    found = quick_fits(problem, list(rivals.values()), [points[:1] for points in ordered], 2)
    better = [
        fit for fit in found
        if fit.name not in known or fit.chi2 < known[fit.name].chi2 - 1.0
    ]  # fmt: skip
    best = max((fit.log_evidence for fit in (*better, *fits)), default=0.0)
    near = [fit for fit in better if fit.log_evidence > best - _WITHIN]
    known |= {fit.name: fit for fit in better}
    known |= {fit.name: fit for fit in refine(problem, near, {}, clouds)}
    return tuple(sorted(known.values(), key=lambda fit: -fit.log_evidence))


def without(problem: Problem, fit: Fit, dropped: Cause) -> Fit:
    """The model of a fit with one of its causes taken away and nothing else moved."""
    rival = make_rival(problem, [each for each in fit.rival.causes if each is not dropped])
    x = fit.x.copy()
    x[problem.columns([dropped])] = 0.0
    kept = [list(fit.rival.free).index(k) for k in rival.free]
    return fit_rivals(problem, [rival], [[Start(x, fit.slope[:, kept])]], 0, exact=False)[0]


def best_first(
    problem: Problem, rivals: Sequence[Rival], begins: Sequence[Sequence[Start]]
) -> list[list[Start]]:
    """Starts of each rival by their chi-square with large errors."""
    flat = [(k, start) for k, points in enumerate(begins) for start in points]
    if not flat:
        return []
    low, high = problem.limits()
    x = np.clip(np.stack([start.x for _, start in flat]), low, high)
    # Of narrow valleys a start is seldom at the bottom.
    chi2 = np.sum(problem.tempered(SOFTEST).residuals(x) ** 2, axis=1)
    for row, (k, _) in enumerate(flat):
        chi2[row] += np.sum((x[row, rivals[k].free] / rivals[k].width) ** 2)
    result: list[list[Start]] = [[] for _ in begins]
    for row in np.argsort(chi2, kind="stable"):
        result[flat[row][0]].append(flat[row][1])
    return result


def refine(
    problem: Problem,
    quick: Sequence[Fit],
    others: Mapping[str, Sequence[Start]],
    clouds: int = 0,
    survivors: int = _SURVIVORS,
) -> tuple[Fit, ...]:
    """Refit the survivors with care and from further starts; the rest keep their quick fits."""
    order = sorted(range(len(quick)), key=lambda k: -quick[k].log_evidence)
    if not order:
        return ()
    best = quick[order[0]].log_evidence
    chosen = [k for k in order[:survivors] if quick[k].log_evidence > best - _WITHIN]
    begins = [
        [Start.of(quick[k]), *others.get(quick[k].name, ()), _nearby(problem, quick[k])]
        for k in chosen
    ]
    careful = fit_rivals(problem, [quick[k].rival for k in chosen], begins, CAREFUL, clouds=clouds)
    result = list(quick)
    for k, fit in zip(chosen, careful, strict=True):
        result[k] = fit
    certify(problem, result, clouds)
    return tuple(sorted(result, key=lambda fit: -fit.log_evidence))


def _nearby(problem: Problem, fit: Fit) -> Start:
    """A start a posterior's width away, with derivatives to be taken there."""
    low, high = problem.limits()
    free = fit.rival.free
    x = fit.x.copy()
    signs = np.where(np.arange(len(free)) % 2 == 0, 1.0, -1.0)
    step = signs * np.minimum(np.sqrt(np.diag(fit.covariance)), 0.5)
    x[free] = np.clip(x[free] + step, low[free], high[free])
    return Start(x)


def certify(problem: Problem, fits: list[Fit], clouds: int) -> None:
    """More starts for leaders whose starts do not agree, two and then one posterior width away."""
    order = sorted(range(len(fits)), key=lambda k: -fits[k].log_evidence)[:_LEADING]
    low, high = problem.limits()
    random = np.random.default_rng(7)
    for width in _ROUNDS:
        doubtful = [k for k in order if not fits[k].certified]
        begins = []
        for k in doubtful:
            free = fits[k].rival.free
            lower = spread_factor(fits[k].jacobian)
            points = [Start.of(fits[k])]
            for _ in range(2):
                x = fits[k].x.copy()
                x[free] += np.clip(width * lower @ random.standard_normal(len(free)), -1.0, 1.0)
                points.append(Start(np.clip(x, low, high)))
            begins.append(points)
        rivals = [fits[k].rival for k in doubtful]
        again = fit_rivals(problem, rivals, begins, CAREFUL, clouds=max(clouds, 1))
        for k, fit in zip(doubtful, again, strict=True):
            fits[k] = fit
