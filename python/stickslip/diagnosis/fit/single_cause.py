"""Fits of all single causes: quick ones of every cause, careful ones of those that lead."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from stickslip.diagnosis.fit.careful_fit import CAREFUL, SURVIVORS, WITHIN, refine
from stickslip.diagnosis.fit.fit_result import Candidate, Fit, Start, make_candidate, ranked
from stickslip.diagnosis.fit.multistart import (
    AGREE,
    LARGEST_INFLATION,
    STAGES,
    fit_candidates,
)
from stickslip.diagnosis.fit.start_points import sobol_scan, well_separated
from stickslip.diagnosis.fit.view import View
from stickslip.diagnosis.model.problem import Array, Cause, Problem

# The numbers below are chosen, not derived. Distances are in coordinates, of which 1 is a standard
# deviation of the prior; leads are of chi-square or of log-evidence.
#
# Steps of a quick fit in each stage: with fewer, slow causes are judged before they have moved;
# with more, every candidate costs more than the stages after it decide.
_QUICK = 5
# Chi-square behind the best at which a candidate is given up in each stage of `STAGES`. In the
# first, errors are ten times too large and say nothing of the rank; in the second, a difference of
# 8 is one of 72 with the stated errors; the last two have room for a jump that is not yet passed.
# With smaller ones good candidates are lost, with larger ones time.
_HOPELESS = (np.inf, 8.0, 40.0, 30.0)
# Starts of a cause from each view and minimum: one for either sign.
_STARTS = 2
# Starts of a cause that are kept of all: fewer miss a minimum, more cost a simulation each.
_BEGINS = 6
# Least distance of such starts: closer ones end together; with a larger one distinct starts are
# lost.
_CLOSE = 0.1
# Distance below which searches of one candidate go on as one: twice the above, as ends spread; with
# a larger one neighbouring minima are taken for one.
_MET = 0.2
# Starts of the null from the leaders' constants: the best three of them; each costs a careful fit.
_NULL_STARTS = 3
# Second starts of a careful fit, after the best one: so many of the starts that were tried.
_OTHER_STARTS = 2
# Points of a scan for a relaxed constant, a power of two for Sobol's sequence: with fewer a narrow
# minimum far out is missed.
_SCAN = 128
# Starts from the scan of a relaxed constant; one of a cause, which has starts from its responses
# too.
_RELAXED_STARTS = 3
# Starts of a cause from a scan of its own: the best one ends in the deepest minimum in half of the
# cases.
_WIDE_STARTS = 4
# Distant points of a cause that are simulated, of those that its responses promise: with fewer the
# best of them is missed, as responses do not add up far away.
_DISTANT = 8
# Least distance of these starts: a standard deviation of the prior, or they end together.
_APART = 1.0


def fit_singles(
    problem: Problem,
    views: Sequence[View],
    scanned: Array,
    local_minima: Sequence[Fit] = (),
    random_restarts: int = 0,
) -> tuple[Fit, ...]:
    """Fit every cause quickly from its responses, and those that survive with care.

    The rows of the views, the recalibrated model's first, are the starts, about their own fits and
    other `local_minima` of the model without a cause, and at points that recalibration has
    `scanned`, shape (points, size). `random_restarts` are those of `fit_candidates`, for the
    careful fits.
    """
    found: dict[int, list[tuple[float, Start]]] = {k: [] for k in range(len(problem.causes))}
    for base in (*(view.fit for view in views), *local_minima):
        for view in views:
            moved = view.moved_to(base, LARGEST_INFLATION)
            for index, points in found.items():
                points += moved.starts(index, _STARTS)
    begins = {index: _promising(points) for index, points in found.items()}
    seen = [index for index in begins if begins[index]]
    candidates = [make_candidate(problem, [problem.causes[index]]) for index in seen]
    ordered = starts_by_misfit(problem, candidates, [begins[index] for index in seen])
    # A search near the null may end with a little of the cause; one more begins with a lot of it.
    large = _large_amplitude_starts(views[-1])
    distant = distant_starts(problem, views, candidates, scanned)
    plan = [
        (candidate, start)
        for index, candidate, points, far in zip(seen, candidates, ordered, distant, strict=True)
        for start in (points[0], *large.get(index, ()), *far)
    ]
    quick = quick_fits(problem, [each for each, _ in plan], [[start] for _, start in plan])
    best: list[Fit] = []
    others: dict[str, list[Start]] = {}
    for candidate, tried in zip(candidates, ordered, strict=True):
        nearest, *rest = [fit for fit in quick if fit.candidate.causes == candidate.causes]
        best.append(nearest)
        others[nearest.name] = [*(Start.of(fit) for fit in rest), *tried[1 : 1 + _OTHER_STARTS]]
    return refine(problem, best, others, random_restarts)


def _large_amplitude_starts(view: View) -> dict[int, tuple[Start, ...]]:
    """For each cause an amplitude of one standard deviation, of the sign that promises more."""
    left = view.moved_to(view.fit, LARGEST_INFLATION).screened.left
    found, base = view.sensitivities, view.problem.base_count
    far = np.flatnonzero((found.at >= 0) & (np.abs(found.amplitude) > 1.0))
    result: dict[int, tuple[Start, ...]] = {}
    for row in far[np.argsort(left[far], kind="stable")].tolist():
        if int(found.cause[row]) not in result:
            x = view.fit.x.copy()
            x[base:] = found.point[row, base:]
            x[found.at[row]] = np.sign(found.amplitude[row])
            result[int(found.cause[row])] = (view.start_with(row, x, 1.0),)
    return result


def quick_fits(
    problem: Problem,
    candidates: Sequence[Candidate],
    begins: Sequence[Sequence[Start]],
    first: int = 0,
    most: int | None = None,
) -> list[Fit]:
    """A few steps at every stage of a global search, from the `first` one on.

    Searches of one candidate that have met go on as one, so there may be fewer ends than starts.
    What is far behind the best of all is given up. With `most`, nothing is: after each stage each
    candidate keeps its `most` best ends.
    """
    fits: list[Fit] = []
    for stage, far in list(zip(STAGES, _HOPELESS, strict=True))[first:]:
        limit = far if most is None else np.inf
        fits = fit_candidates(
            problem.with_inflated_errors(*stage), candidates, begins, _QUICK, limit, exact=False
        )
        fits = _parted(fits, most)
        candidates, begins = [fit.candidate for fit in fits], [[Start.of(fit)] for fit in fits]
    return fits


def _parted(fits: Sequence[Fit], most: int | None) -> list[Fit]:
    """Without those that ended close to a better one of the same candidate, `most` of each."""
    by_name: dict[str, list[Fit]] = {}
    for fit in sorted(fits, key=lambda fit: fit.starts[0]):
        by_name.setdefault(fit.name, []).append(fit)
    return [
        fit
        for ends in by_name.values()
        for fit in well_separated(ends, lambda fit: fit.x, _MET, most)
    ]


def _promising(points: list[tuple[float, Start]]) -> list[Start]:
    """The best starts that do not lie close together."""
    ordered = [start for _, start in sorted(points, key=lambda each: each[0])]
    return well_separated(ordered, lambda start: start.x, _CLOSE, _BEGINS)


def distant_starts(
    problem: Problem, views: Sequence[View], candidates: Sequence[Candidate], scanned: Array
) -> list[list[Start]]:
    """Where each single cause could be that is not seen from the recalibrated model.

    Its constants may have moved far to make up for the cause, which acts only once they are back.

    Parameters
    ----------
    problem : Problem
    views : sequence of View
        Whose responses of the causes are added.
    candidates : sequence of Candidate
        Of one cause each.
    scanned : ndarray, shape (points, size)
        Coordinates of the model without a cause whose predictions are kept.
    """
    softer = problem.with_inflated_errors(LARGEST_INFLATION)
    without = softer.predicted(scanned)
    result = []
    for candidate in candidates:
        (cause,) = candidate.causes
        if cause.relaxes_prior is not None:
            drawn = sobol_scan(softer, candidate, _SCAN, 1)
            result.append([Start(x) for x in _apart(drawn, _RELAXED_STARTS)])
            continue
        promised = _promised(softer, views, problem.causes.index(cause), scanned, without)
        begins = [[Start(x) for x in _apart(promised, _DISTANT)]]
        (ordered,) = starts_by_misfit(problem, [candidate], begins)
        result.append(ordered[:1])
    return result


def _promised(
    softer: Problem, views: Sequence[View], cause: int, scanned: Array, without: Array
) -> Iterator[Array]:
    """Scanned points with the cause at each of its amplitudes, the least misfit first.

    By the sum of two responses: that of the constants and that of the cause.
    """
    base = softer.base_count
    rows = [(view.sensitivities, view.sensitivities.seen_rows(cause)) for view in views]
    gap = np.concatenate([found.gap[seen] for found, seen in rows])
    own = np.concatenate([found.point[seen, base:] for found, seen in rows])
    misfit = softer.misfit(softer.whitened(without[:, None, :] + gap))
    misfit += np.sum(scanned[:, :base] ** 2, axis=1)[:, None] + np.sum(own**2, axis=1)
    for flat in np.argsort(misfit, axis=None, kind="stable"):
        point, row = np.unravel_index(flat, misfit.shape)
        x = scanned[point].copy()
        x[base:] = own[row]
        yield x


def _apart(points: Iterable[Array], most: int) -> list[Array]:
    return well_separated(points, lambda point: point, _APART, most)


def refit_null(problem: Problem, null: Fit, singles: Sequence[Fit]) -> Fit:
    """The null again from the constants of the leading candidates.

    A candidate that found a lower minimum of the constants must not win for that alone.
    """
    p = problem.base_count
    begins = [Start.of(null)]
    for fit in singles[:SURVIVORS]:
        x = null.x.copy()
        x[:p] = fit.x[:p]
        begins.append(Start(x, fit.slope[:, :p]))
    ordered = starts_by_misfit(problem, [null.candidate], [begins])
    (again,) = fit_candidates(problem, [null.candidate], [ordered[0][:_NULL_STARTS]], CAREFUL)
    return again if again.chi2 < null.chi2 - AGREE else null


def refit_worse_than_null(problem: Problem, null: Fit, fits: Sequence[Fit]) -> tuple[Fit, ...]:
    """Fits with those that are worse than the null, which each contains, begun again from it.

    Not where the null is hopeless itself.
    """
    best = max((fit.log_evidence for fit in fits), default=null.log_evidence)
    if null.log_evidence < best - WITHIN:
        return tuple(fits)
    worse = [fit for fit in fits if fit.chi2 > null.chi2]
    begins = [[Start(null.x)] for _ in worse]
    again = fit_candidates(problem, [fit.candidate for fit in worse], begins, CAREFUL)
    better = {new.name: new for new, old in zip(again, worse, strict=True) if new.chi2 < old.chi2}
    kept = [better.get(fit.name, fit) for fit in fits]
    return ranked(kept)


def search_near_leaders(
    problem: Problem, fits: Sequence[Fit], leaders: Sequence[Fit], random_restarts: int = 0
) -> tuple[Fit, ...]:
    """Other causes in the place of one of a leader's, at its constants.

    Their responses are simulated anew there: a nearly equivalent cause does as well
    with constants near the leader's, which may be far from the recalibrated ones.
    """
    candidates: dict[str, Candidate] = {}
    begins: dict[str, list[Start]] = {}
    for leader in leaders:
        for candidate, points in _exchanged(problem, leader):
            candidates[candidate.name] = candidate
            begins.setdefault(candidate.name, []).extend(points)
    every = list(candidates.values())
    ordered = starts_by_misfit(problem, every, list(begins.values()))
    found = quick_fits(problem, every, [points[:1] for points in ordered], 2)
    return _with_better(problem, fits, found, random_restarts)


def search_all_over(
    problem: Problem, fits: Sequence[Fit], random_restarts: int = 0
) -> tuple[Fit, ...]:
    """Every cause from a scan of its own, all over the priors, where none explains the data.

    A strong cause draws the recalibrated constants so far away that no response there tells of it.
    """
    softer = problem.with_inflated_errors(LARGEST_INFLATION)
    plan = [
        (candidate, Start(x))
        for cause in problem.causes
        if cause.relaxes_prior is None
        for candidate in [make_candidate(problem, [cause])]
        for x in _apart(sobol_scan(softer, candidate, _SCAN, 1), _WIDE_STARTS)
    ]
    found = quick_fits(problem, [each for each, _ in plan], [[start] for _, start in plan])
    return _with_better(problem, fits, found, random_restarts)


def _with_better(
    problem: Problem, fits: Sequence[Fit], found: Sequence[Fit], random_restarts: int
) -> tuple[Fit, ...]:
    """Fits with quick ones that are better, of which those that are near the best get care."""
    known = {fit.name: fit for fit in fits}
    better: dict[str, Fit] = {}
    for fit in sorted(found, key=lambda fit: fit.chi2):
        if fit.name not in known or fit.chi2 < known[fit.name].chi2 - AGREE:
            better.setdefault(fit.name, fit)
    best = max((fit.log_evidence for fit in (*better.values(), *fits)), default=0.0)
    near = [fit for fit in better.values() if fit.log_evidence > best - WITHIN]
    known |= better
    known |= {fit.name: fit for fit in refine(problem, near, {}, random_restarts)}
    return ranked(list(known.values()))


def _exchanged(problem: Problem, leader: Fit) -> Iterator[tuple[Candidate, list[Start]]]:
    """Candidates with another cause in the place of one of a leader's, and where they begin."""
    for dropped in leader.candidate.causes:
        view = View.of(problem, without_cause(problem, leader, dropped))
        for index, cause in enumerate(problem.causes):
            points = view.starts_at(index)
            if points and cause not in leader.candidate.causes:
                both = sorted([*view.fit.candidate.causes, cause], key=lambda each: each.name)
                yield make_candidate(problem, both), points


def without_cause(problem: Problem, fit: Fit, dropped: Cause) -> Fit:
    """The model of a fit with one of its causes taken away and nothing else moved."""
    others = [each for each in fit.candidate.causes if each is not dropped]
    candidate = make_candidate(problem, others)
    x = fit.x.copy()
    x[problem.columns([dropped])] = 0.0
    kept = [list(fit.candidate.free).index(k) for k in candidate.free]
    return fit_candidates(problem, [candidate], [[Start(x, fit.slope[:, kept])]], 0, exact=False)[0]


def starts_by_misfit(
    problem: Problem, candidates: Sequence[Candidate], begins: Sequence[Sequence[Start]]
) -> list[list[Start]]:
    """Starts of each candidate by their chi-square with large errors."""
    flat = [(k, start) for k, points in enumerate(begins) for start in points]
    if not flat:
        return [[] for _ in begins]
    x = np.clip(np.stack([start.x for _, start in flat]), *problem.limits())
    # With the stated errors, few starts would lie inside a narrow minimum.
    chi2 = np.sum(problem.with_inflated_errors(LARGEST_INFLATION).residuals(x) ** 2, axis=1)
    for row, (k, _) in enumerate(flat):
        chi2[row] += np.sum((x[row, candidates[k].free] / candidates[k].width) ** 2)
    result: list[list[Start]] = [[] for _ in begins]
    for row in np.argsort(chi2, kind="stable"):
        result[flat[row][0]].append(flat[row][1])
    return result
