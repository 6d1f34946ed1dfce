"""Forms of a law of one argument, of a dozen kinds, and a formula with its numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array


@dataclass(frozen=True)
class Form:
    """A family of laws f(u; a, b): `a` is a factor, `b` a place in spans where there is one.

    Attributes
    ----------
    text : str
        With `u` for the argument.
    shape : callable
        ``shape(v, b)`` of the argument over the span, with a number or an array for b; f is `a`
        times it.
    place : bool
        Whether there is a `b`.
    power : float
        Of the argument, where the form is one.
    angle : bool
        Whether the argument is an angle in rad, whatever the span.
    """

    text: str
    shape: Callable[[Array, Array | float], Array]
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
    Form("a exp(-(u / b)^2)", lambda v, b: np.exp(-((v / b) ** 2)), True),
    Form("a (1 - exp(-|u| / b))", lambda v, b: 1.0 - np.exp(-np.abs(v) / b), True),
    Form("a (1 - exp(-(u / b)^2))", lambda v, b: 1.0 - np.exp(-((v / b) ** 2)), True),
    Form("a (u / b) exp(1 - |u| / b)", lambda v, b: v / b * np.exp(1.0 - np.abs(v) / b), True),
    Form("a ln(1 + |u| / b)", lambda v, b: np.log1p(np.abs(v) / b), True),
)


@dataclass(frozen=True)
class Formula:
    """A formula in the place of a curve.

    Attributes
    ----------
    text : str
        With `u` for the argument in its unit, `a` and `b`.
    a, b : float
        `b`, in the argument's unit, is NaN where the formula has none.
    without : float
        The law without f, in the fit of the formula; see `Curve`.
    lead : float
        Log-evidence above the curve.
    p_value : float
        Of the lack of fit.
    """

    text: str
    a: float
    b: float
    without: float
    lead: float
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
