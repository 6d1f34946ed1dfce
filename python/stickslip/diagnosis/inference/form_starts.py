"""Where fits of a form begin: by linear estimate about the fit of a free curve."""

from __future__ import annotations

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fit.fit_result import Start
from stickslip.diagnosis.fit.start_points import well_separated
from stickslip.diagnosis.inference.form_curves import LARGEST, PLACE, FormCurves
from stickslip.diagnosis.inference.formulas import Form
from stickslip.diagnosis.inference.linear_model import LinearModel
from stickslip.diagnosis.model.problem import Problem

# Coordinates of a place that are looked at, and how many of them a fit begins at, so far from each
# other. Chosen: three standard deviations of its prior.
_SCANNED, _BEGINS, _APART = np.linspace(-3.0, 3.0, 31), 3, 0.5
# Largest step of a constant to a start, as that is a linear matter; and half the width of the
# difference of a place, in coordinates. Chosen.
_FAR, _ASIDE = 2.0, 0.05


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

    def response(u: float) -> Array:
        place = float(PLACE.value(np.array(u))) if form.place else 1.0
        return linear.by_knots @ (curves.project @ curves.values(form, place))

    def left(u: float) -> float:
        return linear.beside(response(u), size)[0] + u**2

    places = sorted(_SCANNED.tolist() if form.place else [0.0], key=left)
    starts = []
    for u in well_separated(places, np.atleast_1d, _APART, _BEGINS):
        _, factor, step = linear.beside(response(u), size)
        factor = float(np.clip(factor, -LARGEST * size, LARGEST * size))
        coordinate = float(np.arcsinh(factor / size * np.sinh(1.0)))
        x = np.zeros(formed.size)
        x[:base] = linear.constants + np.clip(step, -_FAR, _FAR)
        x[formed.columns([cause])] = [coordinate, u][: 1 + form.place]
        # By the coordinates of the factor and of the place.
        per_factor = response(u) * size * np.cosh(coordinate) / np.sinh(1.0)
        per_place = factor * (response(u + _ASIDE) - response(u - _ASIDE)) / (2.0 * _ASIDE)
        own = [per_factor, per_place][: 1 + form.place]
        starts.append(Start(x, np.column_stack([linear.slope, *own])))
    return starts
