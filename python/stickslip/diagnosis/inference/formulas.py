"""Formulas for a law that was found as a curve of free shape."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2 as chi2_law

from stickslip._util.arrays import Array

LEAST_P = 0.1
"""Least p-value with which a formula fits as well as the curve. Chosen: one right formula in ten is
not proposed."""

# Starts of a parameter that sets a place, in spans: the whole range and parts of it. Chosen.
_PLACES = (0.1, 0.3, 1.0, 3.0)
# Largest factor, and logarithm of the largest and the inverse of the least place in spans. Chosen:
# beyond, a form is another one of them.
_ENDS = np.array([100.0, np.log(100.0)])
# Fewest values of the curve that a formula may leave over: with none, any formula fits.
_LEAST_LEFT = 1


@dataclass(frozen=True)
class Form:
    """A family of laws f(u; a, b): `a` is a factor, `b` a place in spans where there is one.

    Attributes
    ----------
    text : str
        With `u` for the argument.
    shape : callable
        ``shape(v, b)`` of the argument over the span; f is `a` times it.
    place : bool
        Whether there is a `b`.
    power : float
        Of the argument, where the form is one.
    angle : bool
        Whether the argument is an angle in rad, whatever the span.
    """

    text: str
    shape: Callable[[Array, float], Array]
    place: bool = False
    power: float = 0.0
    angle: bool = False

    def scale(self, span: float) -> float:
        """What the argument is divided by."""
        return 1.0 if self.angle else span


FORMS = (
    Form("a", lambda v, b: np.ones_like(v)),
    Form("a u", lambda v, b: v, power=1.0),
    Form("a u^2", lambda v, b: v**2, power=2.0),
    Form("a sqrt(|u|)", lambda v, b: np.sqrt(np.abs(v)), power=0.5),
    Form("a sin(u)^2", lambda v, b: np.sin(v) ** 2, angle=True),
    Form("a cos(u)^2", lambda v, b: np.cos(v) ** 2, angle=True),
    Form("a u / (b + |u|)", lambda v, b: v / (b + np.abs(v)), True),
    Form("a exp(-|u| / b)", lambda v, b: np.exp(-np.abs(v) / b), True),
    Form("a (1 - exp(-|u| / b))", lambda v, b: 1.0 - np.exp(-np.abs(v) / b), True),
    Form("a (1 - exp(-(u / b)^2))", lambda v, b: 1.0 - np.exp(-((v / b) ** 2)), True),
    Form("a (u / b) exp(1 - |u| / b)", lambda v, b: v / b * np.exp(1.0 - np.abs(v) / b), True),
    Form("a ln(1 + |u| / b)", lambda v, b: np.log1p(np.abs(v) / b), True),
)


@dataclass(frozen=True)
class Formula:
    """A formula that fits a curve as well as its knots do.

    Attributes
    ----------
    text : str
        With `u` for the argument in its unit, `a` and `b`.
    a, b : float
        `b`, in the argument's unit, is NaN where the formula has none.
    p_value : float
        Of what the formula misses of the curve, by the curve's covariance.
    """

    text: str
    a: float
    b: float
    p_value: float

    def at(self, argument: Array, span: float) -> Array:
        """Its values; `span` is that of the curve that it was found for."""
        form = next(each for each in FORMS if each.text == self.text)
        scale = form.scale(span)
        place = self.b / scale if form.place else 1.0
        return np.asarray(self.a * scale**form.power * form.shape(argument / scale, place))

    def in_numbers(self, unit: str, own: str = "-") -> str:
        """The formula and its numbers, with `unit` for the argument's and `own` for that of f."""
        place = "" if np.isnan(self.b) else f", b = {self.b:.3g} {unit}"
        power = next(each.power for each in FORMS if each.text == self.text)
        per = "" if own == "-" else f" {own}"
        per += (
            "" if power == 0.0 else f" per {unit}" if power == 1.0 else f" per ({unit})^{power:g}"
        )
        return f"f(u) = {self.text} with a = {self.a:.3g}{per}{place}"


def find_formula(
    argument: Array,
    curve: Array,
    covariance: Array,
    span: float,
    angle: bool,
    size: float = 1.0,
) -> Formula | None:
    """The formula of fewest parameters and least misfit, if one fits as well as the curve.

    Parameters
    ----------
    argument, curve : ndarray, shape (knots,)
        The curve at its knots, in sizes.
    covariance : ndarray, shape (knots, knots)
        Of `curve`.
    span : float
        Of the argument.
    angle : bool
        Whether the argument is an angle, for which alone there are sines.
    size : float
        Unit of the curve: `a` of the formula is times it.
    """
    whiten = np.linalg.inv(np.linalg.cholesky(covariance))
    found: list[tuple[float, Formula]] = []
    for form in FORMS:
        scale = form.scale(span)
        v, count = argument / scale, 2 if form.place else 1
        if len(curve) - count < _LEAST_LEFT or (form.angle and not angle):
            continue

        def missed(parameters: Array, form: Form = form, v: Array = v) -> Array:
            place = float(np.exp(parameters[1])) if form.place else 1.0
            return np.asarray(whiten @ (curve - parameters[0] * form.shape(v, place)))

        starts = itertools.product((-0.3, 0.3), np.log(_PLACES) if form.place else (0.0,))
        ends = [
            least_squares(missed, np.array([a, b])[:count], bounds=(-_ENDS[:count], _ENDS[:count]))
            for a, b in starts
        ]
        best = min(ends, key=lambda end: end.cost)
        chi2 = 2.0 * best.cost
        p_value = float(chi2_law.sf(chi2, len(curve) - count))
        place = float(np.exp(best.x[1])) * scale if form.place else np.nan
        factor = size * float(best.x[0]) / scale**form.power
        formula = Formula(form.text, factor, place, p_value)
        if p_value >= LEAST_P:
            found.append((chi2 + count * np.log(len(curve)), formula))
    return min(found, key=lambda each: each[0])[1] if found else None
