"""Formulas fitted to the data in the place of a curve of free shape."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fit.fit_result import (
    Fit,
    Start,
    free_parameters,
    make_candidate,
    physical_covariance,
)
from stickslip.diagnosis.fit.goodness import adequacy
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.fit.single_cause import CAREFUL, refine
from stickslip.diagnosis.fit.start_points import well_separated
from stickslip.diagnosis.inference.formulas import FORMS, Form, Formula
from stickslip.diagnosis.inference.verdict import MARGIN
from stickslip.diagnosis.model.free_terms import Term
from stickslip.diagnosis.model.problem import Cause, CauseParameter, Predict, Problem

# Least p-value of the lack of fit of a formula, and how much less likely than the curve it may be
# in log-evidence. Chosen: one right formula in twenty is refused by the first; five knots cannot
# have its shape to the last, which costs it some units.
_LEAST_P, _BEHIND = 0.05, 7.0
# Points at which a formula is taken as a curve.
_POINTS = 61
# Largest factor, in what would not surprise, and the place in spans. Chosen: beyond their ends a
# form is another one of them.
_LARGEST = 10.0
_PLACE = CauseParameter("b", "-", 0.02, 20.0, 1.0, absent=0.5, shape=True)
# Coordinates of a place that are looked at by linear estimate, and how many of them a fit begins
# at, so far from each other. Chosen: three standard deviations of its prior.
_SCANNED, _BEGINS, _APART = np.linspace(-3.0, 3.0, 31), 3, 0.5
# Largest step of a constant to a start, as that is a linear matter; and half the width of the
# difference of a place, in coordinates. Chosen.
_FAR, _ASIDE = 2.0, 0.05
# A point counts at most so many times more than the middle one. Chosen: the curve is then not bent
# for one place alone.
_MOST = 10.0


@dataclass(frozen=True)
class _Shapes:
    """The forms as curves of a term: its knots that come nearest to each where the data are.

    `points`, shape (points,), are values of the argument; `project`, shape (knots, points), gives
    the knots.
    """

    term: Term
    forms: tuple[Form, ...]
    points: Array
    project: Array

    @staticmethod
    def of(problem: Problem, term: Term, fit: Fit) -> _Shapes:
        """Those near the curve of a fit; what the data tell of it more exactly weighs more."""
        forms = tuple(form for form in FORMS if term.unit == "rad" or not form.angle)
        points = np.linspace(term.low, term.high, _POINTS)
        design = term.design(points)
        knots = [each for each in free_parameters(problem, fit) if each.name in term.knots]
        variance = np.sum((design @ physical_covariance(fit, knots)) * design, axis=1)
        known = variance > 0.0
        weight = np.where(known, 1.0 / np.sqrt(np.where(known, variance, 1.0)), 0.0)
        weight = np.minimum(weight, _MOST * np.median(weight[known]))
        return _Shapes(term, forms, points, np.linalg.pinv(design * weight[:, None]) * weight)

    def values(self, form: Form, place: Array | float) -> Array:
        """A form with a factor of 1 at the points; places in spans, of any shape beside theirs."""
        return form.shape(self.points / form.scale(self.term.span), place)

    def knots(self, parameters: Array) -> Array:
        """Knots from factors and places of all forms, of which those with factor 0 are absent."""
        law = np.zeros((len(parameters), len(self.points)))
        at = 0
        for form in self.forms:
            factor = parameters[:, at]
            place = parameters[:, at + 1] if form.place else np.ones(len(parameters))
            there = np.flatnonzero(factor)
            law[there] += factor[there, None] * self.values(form, place[there, None])
            at += 1 + form.place
        ends = self.term.cause.parameters[0]
        return np.clip(law @ self.project.T, ends.low, ends.high)

    def causes(self) -> tuple[Cause, ...]:
        """Each form as a candidate: its factor, and its place where it has one."""
        size = self.term.cause.parameters[0].scale
        end = _LARGEST * size
        result = []
        for form in self.forms:
            own = [CauseParameter(f"{form.text}: a", "-", -end, end, size)]
            if form.place:
                own.append(replace(_PLACE, name=f"{form.text}: b"))
            result.append(Cause(form.text, tuple(own)))
        return tuple(result)


def find_formulas(problem: Problem, term: Term, fit: Fit) -> tuple[Formula, ...]:
    """Formulas that explain the data as well as the curve, the most likely one first.

    The first is at most a little less likely than the curve; the others are nearly as likely as it.
    The constants are fitted again beside each.

    Parameters
    ----------
    problem : Problem
        Whose causes are those of terms.
    term : Term
    fit : Fit
        Of this term.
    """
    shapes = _Shapes.of(problem, term, fit)
    causes, low = shapes.causes(), problem.low_fidelity
    formed = replace(
        problem,
        predict=_with_formulas(problem, shapes, problem.predict),
        causes=causes,
        low_fidelity=None if low is None else _with_formulas(problem, shapes, low),
    )
    candidates = [make_candidate(formed, [cause]) for cause in causes]
    linear = _Linear.about(problem, term, fit)
    begins = [_begins(formed, shapes, linear, form) for form in shapes.forms]
    quick = fit_candidates(formed, candidates, begins, CAREFUL, exact=False)
    found = []
    for each in refine(formed, quick, {}, 1):
        lead, p_value = each.log_evidence - fit.log_evidence, adequacy(formed, each)
        if p_value >= _LEAST_P and lead > -_BEHIND:
            form = next(form for form in shapes.forms if form.text == each.name)
            values = formed.physical(each.x[None, :])[0]
            own = values[formed.columns(each.candidate.causes)]
            scale = form.scale(term.span)
            found.append(
                Formula(
                    text=form.text,
                    a=float(own[0]) / scale**form.power,
                    b=float(own[1]) * scale if form.place else np.nan,
                    without=term.without(dict(zip(formed.names, values.tolist(), strict=True))),
                    lead=lead,
                    p_value=p_value,
                )
            )
    return tuple(each for each in found if each.lead > found[0].lead - MARGIN)


def _with_formulas(problem: Problem, shapes: _Shapes, predict: Predict) -> Predict:
    """The model of the terms, which takes the constants and the parameters of all forms."""
    base, columns = problem.base_count, problem.columns([shapes.term.cause])
    absent = problem.physical(np.zeros((1, problem.size)))[0]

    def of_formulas(conditions: Any, parameters: Array) -> Array:
        values = np.tile(absent, (len(parameters), 1))
        values[:, :base] = parameters[:, :base]
        values[:, columns] = shapes.knots(parameters[:, base:])
        return predict(conditions, values)

    return of_formulas


@dataclass(frozen=True)
class _Linear:
    """The data as a linear function of the constants and the knots, about the fit of a curve.

    `constants`, shape (constants,), are its coordinates there, and `slope`, shape (m, constants),
    the derivatives of the prediction; `by_knots`, shape (m, knots), those by the knots. `design`,
    shape (m + constants, constants), and `residual`, of the model without the curve, are whitened
    and have the constants' priors below the data.
    """

    whiten: Array
    constants: Array
    slope: Array
    by_knots: Array
    design: Array
    residual: Array

    @staticmethod
    def about(problem: Problem, term: Term, fit: Fit) -> _Linear:
        base, m = problem.base_count, len(problem.observed)
        knots = [each for each in free_parameters(problem, fit) if each.name in term.knots]
        by_knots = fit.slope[:, [each.position for each in knots]]
        by_knots = by_knots / [each.slope(fit) for each in knots]
        now = problem.physical(fit.x[None, :])[0][[each.column for each in knots]]
        residual = fit.residual[: m + base].copy()
        residual[:m] += problem.whiten @ (by_knots @ now)
        design = fit.jacobian[: m + base, :base]
        return _Linear(
            problem.whiten, fit.x[:base], fit.slope[:, :base], by_knots, design, residual
        )

    def beside(self, response: Array, size: float) -> tuple[float, float, Array]:
        """Chi-square at best, factor, and step of the constants, beside a response of factor 1.

        `size` is of the factor, whose prior keeps it finite where the data say nothing.
        """
        base = len(self.constants)
        column = np.concatenate([self.whiten @ response, np.zeros(base), [1.0 / size]])
        rows = np.vstack([self.design, np.zeros(base)])
        target = np.append(self.residual, 0.0)
        step = np.linalg.lstsq(np.column_stack([rows, column]), target, rcond=None)[0]
        left = target - rows @ step[:base] - column * step[base]
        return float(left @ left), float(step[base]), step[:base]


def _begins(formed: Problem, shapes: _Shapes, linear: _Linear, form: Form) -> list[Start]:
    """Where a form begins: with the best places, and factor and constants, by linear estimate."""
    cause = formed.causes[shapes.forms.index(form)]
    base, size = formed.base_count, cause.parameters[0].scale

    def response(u: float) -> Array:
        place = float(_PLACE.value(np.array(u))) if form.place else 1.0
        return linear.by_knots @ (shapes.project @ shapes.values(form, place))

    def left(u: float) -> float:
        return linear.beside(response(u), size)[0] + u**2

    places = sorted(_SCANNED.tolist() if form.place else [0.0], key=left)
    starts = []
    for u in well_separated(places, np.atleast_1d, _APART, _BEGINS):
        _, factor, step = linear.beside(response(u), size)
        coordinate = float(np.arcsinh(np.clip(factor / size, -_LARGEST, _LARGEST) * np.sinh(1.0)))
        x = np.zeros(formed.size)
        x[:base] = linear.constants + np.clip(step, -_FAR, _FAR)
        x[formed.columns([cause])] = [coordinate, u][: 1 + form.place]
        # By the coordinates of the factor and of the place.
        per_factor = response(u) * size * np.cosh(coordinate) / np.sinh(1.0)
        per_place = factor * (response(u + _ASIDE) - response(u - _ASIDE)) / (2.0 * _ASIDE)
        own = [per_factor, per_place][: 1 + form.place]
        starts.append(Start(x, np.column_stack([linear.slope, *own])))
    return starts
