"""Forms of a law, such as a line or a saturation, as rivals of its curve through knots."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.special import logsumexp

from stickslip._util.arrays import Array
from stickslip.diagnosis.fitting.descent import Batched, run_batched
from stickslip.diagnosis.fitting.forms import PRIOR
from stickslip.diagnosis.fitting.models import Fit, minimise, sharpened
from stickslip.diagnosis.fitting.options import SEARCH
from stickslip.diagnosis.fitting.problem import RELAXED
from stickslip.diagnosis.fitting.search import Models
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.curve import SHAPES
from stickslip.diagnosis.terms.laws import forms

_SCANNED = 15  # scales that are looked at, evenly in their logarithm: the fit begins at the best
_COST_BOUND = 100.0  # growth of the cost over that of the curve after which no form comes back
_OUTER = 2.0  # coordinate of a scale beyond which it is at the end of its range, and no form's own
_BETWEEN = 0.5  # part of its values at the knots by which a form may leave their curve
_FINE = 101  # places where that is looked at
_FLOOR = 1e-3  # least standard deviation of a knot, in its usual size, where a form begins
_LEAST = 0.1  # part of a stated constant that is left where a form begins


def with_forms(models: Models) -> Models:
    """The same where the laws of the leader were fitted in their other forms too.

    A law has the mean evidence of its forms, of which none is preferred beforehand, and the fit of
    the most probable one. Curves that are behind stand for their forms.
    """
    if not models.reaches:
        return models
    leader = models.leaders(1)[0]
    for law in leader.causes:
        if law.curve is not None:
            models = _compared(models, leader.names, law)
    return models


def _compared(models: Models, names: frozenset[str], law: Cause) -> Models:
    """The same with the best form of the law in the models of these causes."""
    others = forms(law)
    if models.problem.wider is None or not others:
        return models
    wider = models.problem.wider(models.problem, list(others.values()))
    models = models.widened(wider, models.offered)
    least = models.log_posterior(models.leaders(1)[0]) - SEARCH.near
    fits: dict[str, dict[str, Fit]] = {}
    for name in models.forms:
        old = models.get(names, name)
        # A form may explain what no curve through knots does.
        if old is not None and (name == "exact" or models.log_posterior(old) >= least):
            tries = [_fitted(models, old, law, other) for other in others.values()]
            refits = zip(others, run_batched(models.problem, tries), strict=True)
            near = {form: fit for form, fit in refits if fit}
            fits[name] = {"curve": old, **near}
    chance = _chances(fits)
    for name, by_form in fits.items():
        mean = logsumexp([fit.log_evidence for fit in by_form.values()]) - math.log(1 + len(others))
        best = next(by_form[form] for form in chance if form in by_form)
        models.best[names, name] = replace(best, log_evidence=float(mean))
    models.of_forms[names] = chance
    return models


def _chances(fits: Mapping[str, Mapping[str, Fit]]) -> dict[str, float]:
    """Probability of each form over all discrepancies, the most probable first."""
    weights: dict[str, list[float]] = {}
    for name, by_form in fits.items():
        for form, fit in by_form.items():
            weights.setdefault(form, []).append(math.log(PRIOR[name]) + fit.log_evidence)
    sums = {form: float(logsumexp(each)) for form, each in weights.items()}
    total = float(logsumexp(list(sums.values())))
    chances = ((form, math.exp(each - total)) for form, each in sums.items())
    return dict(sorted(chances, key=lambda item: -item[1]))


def _fitted(models: Models, old: Fit, law: Cause, other: Cause) -> Batched[Fit | None]:
    """A fit of a model with another form of its law; None where it is none, or comes not near."""
    problem, form = models.problem, models.forms[old.form]
    causes = [cause for cause in old.causes if cause is not law] + [other]
    try:
        fit = yield from minimise(
            problem, form, causes, _begun(models, old, law, other), h=old.h,
            cost_bound=old.cost + _COST_BOUND,
        )  # fmt: skip
        # With the amplitude at its end, or the scale near one, it is another form.
        amplitude, *scale = fit.x[problem.columns([other])].tolist()
        low, high = other.parameters[0].limits
        inside = low + 1e-3 < amplitude < high - 1e-3 and all(abs(u) <= _OUTER for u in scale)
        if fit.cost > old.cost + _COST_BOUND or not inside:
            return None
        return (yield from sharpened(problem, form, fit))
    except np.linalg.LinAlgError:
        return None


def _begun(models: Models, old: Fit, law: Cause, other: Cause) -> Array:
    """Coordinates where a form is nearest to the fitted law at its knots, by their errors.

    Of a law that is a factor of a constant c, c (1 + f), data often tell no more than the product:
    c is fitted with the amplitude.
    """
    problem, curve, at = models.problem, other.curve, models.problem.columns([law])
    assert curve is not None
    x, f = old.x.copy(), problem.physical(old.x[None, :])[0, at]
    target, slopes = f, float(law.parameters[0].value(np.ones(1))[0]) * np.eye(len(at))
    level, stated = np.zeros((len(at), 0)), list[float]()
    if curve.constant is not None:
        k = problem.names.index(curve.constant)
        low, c, high = problem.constants[k].value(x[k] + np.array([-0.5, 0.0, 0.5])).tolist()
        target, slopes = c * (1.0 + f), np.column_stack([c * slopes, (high - low) * (1.0 + f)])
        at_null = problem.constants[k].value(np.array([0.0]))
        level, stated = np.ones((len(at), 1)), [float(at_null[0]), RELAXED[0] * (high - low)]
        at = np.append(at, k)
    places = np.searchsorted(old.free, at)
    covariance = old.covariance[np.ix_(places, places)] + _FLOOR**2 * np.eye(len(at))
    whiten = np.linalg.inv(np.linalg.cholesky(slopes @ covariance @ slopes.T))
    amplitude, *scales = other.parameters
    grid = np.linspace(_OUTER, -_OUTER, _SCANNED) if scales else np.zeros(1)
    fine = np.linspace(curve.places[0], curve.places[-1], _FINE)
    least, parts, z = math.inf, np.zeros(2), 0.0
    for value in grid.tolist():
        scale = float(scales[0].value(np.array([value]))[0]) if scales else curve.reach
        column, between = (
            SHAPES[curve.form].at((u - curve.origin) / scale) for u in (curve.places, fine)
        )
        away = np.max(np.abs(curve.design(fine) @ column - between))
        if least < math.inf and away > _BETWEEN * np.max(np.abs(column)):
            continue  # the knots do not see how it bends
        rows, wanted = whiten @ np.column_stack([column, level]), whiten @ target
        if stated:
            rows = np.vstack([rows, [0.0, 1.0 / stated[1]]])
            wanted = np.append(wanted, stated[0] / stated[1])
        solution = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        left = float(np.sum((wanted - rows @ solution) ** 2))
        if left < least:
            least, parts, z = left, solution, value
    x[problem.columns([law])] = 0.0
    a = float(parts[0])
    if stated:
        base = max(float(parts[1]), _LEAST * stated[0])
        x[k], a = problem.constants[k].coordinate(base), a / base
    inside = float(np.clip(a, 0.99 * amplitude.low, 0.99 * amplitude.high))
    x[problem.columns([other])] = [amplitude.coordinate(inside), *(z for _ in scales)]
    return np.asarray(np.clip(x, *problem.limits))
