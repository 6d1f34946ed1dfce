"""Search for the law of another shape, where no cause explains the data.

First the place is found, by fits of a free curve at each that is listed; then its shape, with a
band; then a formula, where one fits as well.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from stickslip._util.arrays import Array, Indices
from stickslip.diagnosis.fit.careful_fit import refine
from stickslip.diagnosis.fit.fit_result import (
    Fit,
    Start,
    free_parameters,
    make_candidate,
    ranked,
)
from stickslip.diagnosis.fit.goodness import adequacy
from stickslip.diagnosis.fit.multistart import AGREE, LARGEST_INFLATION, fit_candidates
from stickslip.diagnosis.fit.single_cause import quick_fits, refit_null, refit_worse_than_null
from stickslip.diagnosis.fit.start_points import sobol_scan, well_separated
from stickslip.diagnosis.inference import cross_validation
from stickslip.diagnosis.inference.between_knots import covariance_between_knots
from stickslip.diagnosis.inference.cross_validation import measure_gain
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.formula_search import find_formulas
from stickslip.diagnosis.inference.law_posterior import linear_draws, posterior_draws
from stickslip.diagnosis.inference.open_set import BAND, Curve, FreeShape, OpenSet
from stickslip.diagnosis.inference.simultaneous_band import simultaneous_band
from stickslip.diagnosis.inference.verdict import contradictions, reasons_against, smooth_rest
from stickslip.diagnosis.model.free_terms import Term
from stickslip.diagnosis.model.prediction_cache import PredictionCache
from stickslip.diagnosis.model.problem import Cause, Predict, Problem
from stickslip.diagnosis.options import Options
from stickslip.facts import Fact

# Points at which a curve is drawn.
_POINTS = 61
# Runs that drawing points may take for each term, and the logarithms to the base 2 of the fewest
# and the most points; how many of them a term begins at. Chosen: 256 points of 30 conditions led to
# the best fit of both hidden laws that were tried; a start costs the stages of a quick fit.
_RUNS, _LOG_DRAWS, _STARTS = 8000.0, (5.0, 8.0), 6
# Ends of a term that go on after each stage of its search. Chosen: with fewer, one that is slow to
# pass a jump is lost.
_ENDS = 3
# Terms that begin a second time, at other points. Chosen: the one that is shown, and its rival.
_LEADERS = 2
# Distance of two starts, in coordinates. Chosen: those that do not meet at once.
_APART = 1.0


def search_terms(
    found: Findings,
    options: Options,
    predict: Predict,
    low_fidelity: Predict | None,
    terms: Sequence[Term],
) -> OpenSet | None:
    """Free curves at the recalibrated model of a diagnosis.

    Parameters
    ----------
    found : Findings
    options : Options
        Of the diagnosis.
    predict, low_fidelity : callable
        The model without its causes: columns of its parameters are the uncertain ones and then the
        knots of all terms.
    terms : sequence of Term
    """
    m = len(found.problem.observed)
    problem = replace(
        found.problem,
        predict=PredictionCache(predict, m),
        causes=tuple(each.cause for each in terms),
        low_fidelity=None if low_fidelity is None else PredictionCache(low_fidelity, m),
    )
    held_out = cross_validation.split(
        len(found.noise.mean), options.seed, options.group, options.singleton_condition
    )
    inverse = np.linalg.inv(problem.whiten)

    def against(
        problem: Problem, null: Fit, shape: FreeShape, others: Sequence[Fit]
    ) -> tuple[Fact, ...]:
        return (
            *reasons_against(problem, null, _with_own_constant(shape), found.tables, None, others),
            *smooth_rest(null, shape.fit, found.smooth_bound),
            *contradictions(shape.fit, found.tables),
        )

    constants = found.null.x[: problem.base_count]
    covariance = inverse @ inverse.T
    return explore_terms(problem, covariance, constants, terms, held_out, options.seed, against)


def explore_terms(
    problem: Problem,
    covariance: Array,
    constants: Array,
    terms: Sequence[Term],
    held_out: Indices,
    seed: int,
    against: Callable[[Problem, Fit, FreeShape, Sequence[Fit]], tuple[Fact, ...]],
) -> OpenSet | None:
    """Fit a free curve at each place, and rank them.

    Parameters
    ----------
    problem : Problem
        Whose causes are those of the terms.
    covariance : ndarray, shape (m, m)
        Of the observed means.
    constants : ndarray, shape (constants,)
        Coordinates of the recalibrated model.
    terms : sequence of Term
    held_out : ndarray of int
        Conditions that the gain is measured on.
    seed : int
        Of the bootstrap of the gain.
    against : callable
        ``against(problem, null, shape, others)`` is what speaks against a law, beside the
        recalibrated model and all other fits, of which that model is one.

    Returns
    -------
    OpenSet, optional
        None where there is no term.
    """
    if not problem.causes:
        return None
    by_name = {each.effect: each for each in terms}
    x = np.concatenate([constants, np.zeros(problem.size - problem.base_count)])
    (null,) = fit_candidates(problem, [make_candidate(problem)], [[Start(x)]], 6)
    fits = _fits(problem, problem.causes, [null.x], 1)
    # The curve that is shown is to be the best one: the leaders begin again elsewhere.
    led = [by_name[fit.name].cause for fit in fits[:_LEADERS]]
    again = {fit.name: fit for fit in _fits(problem, led, [], 2)}
    fits = ranked([_of_both(fit, again.get(fit.name)) for fit in fits])
    # A lower minimum of the constants alone is not a law's.
    null = refit_null(problem, null, fits)
    # With errors that are taken as too large, five knots may be led astray.
    fits = refit_worse_than_null(problem, null, fits)
    shapes = tuple(
        FreeShape(
            by_name[fit.name],
            fit,
            fit.log_evidence - null.log_evidence,
            adequacy(problem, fit),
        )
        for fit in ranked(fits)
    )
    first = shapes[0]
    gain = measure_gain(
        problem, covariance, held_out, null, first.fit, [each.fit for each in shapes[1:3]], seed
    )
    curve = _curve(problem, first.term, first.fit, linear_draws)
    others = [null, *(each.fit for each in shapes[1:])]
    found = OpenSet(problem, shapes, against(problem, null, first, others), gain, curve, ())
    if not found.accepted:
        return found
    curve = _curve(problem, first.term, first.fit, partial(posterior_draws, problem))
    return replace(found, curve=curve, formulas=find_formulas(problem, first.term, first.fit))


def _with_own_constant(shape: FreeShape) -> Fit:
    """The fit of a law as one in which the law's own constant is suspected too.

    Its pull then says nothing against the law: of the two the data often tell their product alone,
    and that product is what is claimed.
    """
    candidate = shape.fit.candidate
    own = tuple(replace(each, relaxes_prior=shape.term.constant) for each in candidate.causes)
    return replace(shape.fit, candidate=replace(candidate, causes=own))


def _of_both(one: Fit, other: Fit | None) -> Fit:
    """The better of two fits of one term, which agree where one has found the other's end."""
    if other is None:
        return one
    ends = tuple(sorted((*one.starts, *other.starts)))
    best = min(one, other, key=lambda fit: fit.chi2)
    return replace(best, starts=ends, converged=ends[1] - ends[0] < AGREE)


def _fits(
    problem: Problem, causes: Sequence[Cause], points: Sequence[Array], seed: int
) -> tuple[Fit, ...]:
    """The best fit of each term, from some points and from others drawn all over the priors.

    The constants of the null make up for the law as far as they can, so that it is a poor place to
    begin at.
    """
    softer = problem.with_inflated_errors(LARGEST_INFLATION)
    most = _RUNS / len(problem.observed)
    draws = 2 ** int(np.clip(np.log2(most), *_LOG_DRAWS))
    plan = []
    for cause in causes:
        candidate = make_candidate(problem, [cause])
        drawn = sobol_scan(softer, candidate, draws, seed, of_curves=True)
        apart = well_separated(drawn, lambda point: point, _APART, _STARTS)
        plan += [(candidate, Start(x)) for x in (*points, *apart)]
    # Five knots are slow to find: a term that is far behind after a few steps may lead.
    planned, begin = [each for each, _ in plan], [[start] for _, start in plan]
    quick = quick_fits(problem, planned, begin, first=1, most=_ENDS)
    best: dict[str, Fit] = {}
    others: dict[str, list[Start]] = {}
    for fit in sorted(quick, key=lambda fit: fit.chi2):
        if best.setdefault(fit.name, fit) is not fit:
            others.setdefault(fit.name, []).append(Start.of(fit))
    return refine(problem, list(best.values()), others, 1, within=np.inf)


def _curve(problem: Problem, term: Term, fit: Fit, draws_of: Callable[..., Array]) -> Curve:
    """The curve of a fit with its band, out of draws of its constant and its knots."""
    values = problem.physical(fit.x[None, :])[0]
    free = free_parameters(problem, fit)
    knots = [each for each in free if each.name in term.knots]
    own = [each for each in free if each.name == term.constant]
    argument = np.linspace(term.low, term.high, _POINTS)
    design = term.design(argument)
    without = term.without(dict(zip(problem.names, values.tolist(), strict=True)))
    factor = without if term.relative else 1.0
    law = without + factor * (design @ values[[each.column for each in knots]])
    size = term.cause.parameters[0].scale
    draws = draws_of(fit, own, knots, size)
    drawn, knot = draws[:, : len(own)], draws[:, len(own) :]
    constant = drawn if own else np.full((len(draws), 1), without)
    between = covariance_between_knots(
        argument, design, np.mean(knot, axis=0), np.cov(knot.T), size
    )
    # Of what the curve cannot follow the constants take a share, the same at all points.
    missed = between + np.mean(np.diag(between))
    random = np.random.default_rng(37)
    bends = random.multivariate_normal(np.zeros(_POINTS), missed, len(draws), "ignore")
    laws = constant + (constant if term.relative else 1.0) * (knot @ design.T + bends)
    middle, sd, reach = simultaneous_band(laws, BAND)
    half = reach * sd
    # A band about the mean of a skew posterior may leave out its mode, which the fit is.
    ends = np.minimum(law, middle - half), np.maximum(law, middle + half)
    least = 0.0 if term.cut else -np.inf
    law, low, high = (np.maximum(each, least) for each in (law, *ends))
    before = abs(factor) * size * reach
    return Curve(argument, law, low, high, half, without, before, term.law_unit)
