"""Forms of a law as curves of a few knots, and as candidates for fits."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fit.fit_result import Fit, free_parameters, physical_covariance
from stickslip.diagnosis.inference.formulas import FORMS, Form
from stickslip.diagnosis.model.free_terms import Term
from stickslip.diagnosis.model.problem import Cause, CauseParameter, Problem

LARGEST = 10.0
"""Largest factor of a form, in changes that would not surprise. Chosen: as far as knots go."""

PLACE = CauseParameter("b", "-", 1e-3, 1e3, 1.0, absent=0.5, shape=True)
"""A place of a form, in spans of the argument, from a sixteenth to four by the ends of its
coordinate. Chosen: beyond them a form is another one."""

# Points at which a form is taken as a curve.
_POINTS = 61
# A point counts at most so many times more than the middle one: else the curve meets the form where
# the data are best, and nowhere else. Chosen.
_MOST = 10.0


@dataclass(frozen=True)
class FormCurves:
    """The forms as curves of a term: their knots that come nearest to them where the data are.

    Arguments are counted from an origin and in spans, angles in rad.

    Attributes
    ----------
    term : Term
    forms : tuple of Form
    points : ndarray, shape (points,)
        Values of the argument less the origin, in its unit.
    project : ndarray, shape (knots, points)
        What makes knots of values at the points.
    """

    term: Term
    forms: tuple[Form, ...]
    points: Array
    project: Array

    @staticmethod
    def near(problem: Problem, term: Term, fit: Fit) -> FormCurves:
        """Those near the curve of a fit; what the data tell of it more exactly weighs more."""
        angle, both_signs = term.unit == "rad", term.low < term.origin < term.high
        forms = [form for form in FORMS if angle or not form.angle]
        forms = [form for form in forms if (both_signs and not angle) or not form.even]
        points = np.linspace(term.low, term.high, _POINTS)
        design = term.design(points)
        knots = [each for each in free_parameters(problem, fit) if each.name in term.knots]
        variance = np.sum((design @ physical_covariance(fit, knots)) * design, axis=1)
        known = variance > 0.0
        weight = np.where(known, 1.0 / np.sqrt(np.where(known, variance, 1.0)), 0.0)
        weight = np.minimum(weight, _MOST * np.median(weight[known]))
        project = np.linalg.pinv(design * weight[:, None]) * weight
        return FormCurves(term, tuple(forms), points - term.origin, project)

    def scale(self, form: Form) -> float:
        """What the argument is divided by, in its unit."""
        return 1.0 if form.angle else float(np.max(np.abs(self.points)))

    def values(self, form: Form, *places: Array | float) -> Array:
        """A form with a factor of 1 at the points; places in spans, of any shape beside theirs."""
        return form.shape(self.points / self.scale(form), *places)

    def knots(self, parameters: Array) -> Array:
        """Knots from factors and places of all forms, of which those with factor 0 are absent."""
        law = np.zeros((len(parameters), len(self.points)))
        at = 0
        for form in self.forms:
            there = np.flatnonzero(parameters[:, at])
            factor, *places = parameters[there, at : at + 1 + form.places].T[:, :, None]
            law[there] += factor * self.values(form, *places)
            at += 1 + form.places
        ends = self.term.cause.parameters[0]
        return np.clip(law @ self.project.T, ends.low, ends.high)

    def cause(self, form: Form) -> Cause:
        """A form as a candidate: its factor, and the places that it has."""
        size = self.term.cause.parameters[0].scale
        if form.angle:
            # Over a small tilt a sine changes little.
            size /= float(np.ptp(self.values(form)))
        end = LARGEST * size
        factor = CauseParameter(f"{form.text}: a", "-", -end, end, size)
        places = [replace(PLACE, name=f"{form.text}: {name}") for name in "bc"[: form.places]]
        return Cause(form.text, (factor, *places))
