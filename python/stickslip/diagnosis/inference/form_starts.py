"""Where fits of a form begin: by linear estimate about the fit of a free curve."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fit.fit_result import Fit, Start, free_parameters
from stickslip.diagnosis.fit.start_points import well_separated
from stickslip.diagnosis.inference.form_curves import LARGEST, PLACE, FormCurves
from stickslip.diagnosis.inference.formulas import Form
from stickslip.diagnosis.model.free_terms import Term
from stickslip.diagnosis.model.problem import Problem

# Coordinates of a place that are looked at, of two places every other one, and how many of them a
# fit begins at, so far from each other. Chosen: three standard deviations of its prior.
_SCANNED, _BEGINS, _APART = np.linspace(-3.0, 3.0, 31), 3, 0.5
# Largest step of a constant to a start, as that is a linear matter; and half the width of the
# difference of a place, in coordinates. Chosen.
_FAR, _ASIDE = 2.0, 0.05


@dataclass(frozen=True)
class LinearModel:
    """The data as a linear function of the constants and the knots, about the fit of a curve.

    Attributes
    ----------
    whiten : ndarray, shape (m, m)
    constants : ndarray, shape (constants,)
        Their coordinates there.
    slope : ndarray, shape (m, constants)
        Derivatives of the prediction by them.
    by_knots : ndarray, shape (m, knots)
        The same by the values at the knots.
    design : ndarray, shape (m + constants, constants)
        `slope`, whitened, with the rows of the constants' priors.
    residual : ndarray, shape (m + constants,)
        What is left without the curve, whitened.
    """

    whiten: Array
    constants: Array
    slope: Array
    by_knots: Array
    design: Array
    residual: Array

    @staticmethod
    def about(problem: Problem, term: Term, fit: Fit) -> LinearModel:
        """The derivatives that the fit has ended with."""
        base, m = problem.base_count, len(problem.observed)
        knots = [each for each in free_parameters(problem, fit) if each.name in term.knots]
        by_knots = fit.slope[:, [each.position for each in knots]]
        by_knots = by_knots / [each.slope(fit) for each in knots]
        now = problem.physical(fit.x[None, :])[0][[each.column for each in knots]]
        residual = fit.residual[: m + base].copy()
        residual[:m] += problem.whiten @ (by_knots @ now)
        return LinearModel(
            problem.whiten,
            fit.x[:base],
            fit.slope[:, :base],
            by_knots,
            fit.jacobian[: m + base, :base],
            residual,
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


def form_starts(
    formed: Problem, curves: FormCurves, linear: LinearModel, form: Form
) -> list[Start]:
    """The best places of a form, each with the factor and the constants that go with it.

    Parameters
    ----------
    formed : Problem
        Whose causes are the forms.
    curves : FormCurves
    linear : LinearModel
    form : Form
    """
    cause = formed.causes[curves.forms.index(form)]
    base, size = formed.base_count, cause.parameters[0].scale

    def response(u: Array) -> Array:
        places = PLACE.value(u).tolist()
        return linear.by_knots @ (curves.project @ curves.values(form, *places))

    def left(u: Array) -> float:
        return linear.beside(response(u), size)[0] + float(u @ u)

    scanned = _SCANNED[:: form.places or 1]
    places = [np.array(each) for each in product(scanned, repeat=form.places)]
    starts = []
    for u in well_separated(sorted(places, key=left), np.asarray, _APART, _BEGINS):
        _, factor, step = linear.beside(response(u), size)
        factor = float(np.clip(factor, -LARGEST * size, LARGEST * size))
        coordinate = float(np.arcsinh(factor / size * np.sinh(1.0)))
        x = np.zeros(formed.size)
        x[:base] = linear.constants + np.clip(step, -_FAR, _FAR)
        x[formed.columns([cause])] = [coordinate, *u]
        # By the coordinates of the factor and of the places.
        own = [response(u) * size * np.cosh(coordinate) / np.sinh(1.0)]
        for aside in _ASIDE * np.eye(form.places):
            own.append(factor * (response(u + aside) - response(u - aside)) / (2.0 * _ASIDE))
        starts.append(Start(x, np.column_stack([linear.slope, *own])))
    return starts
