"""Forms of a law of one argument, of a dozen kinds, and a formula with its numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array


@dataclass(frozen=True)
class Form:
    """A family of laws f(u; a, b): `a` is a factor, and `b` a place where there is one.

    Attributes
    ----------
    text : str
        With `u` for the argument.
    shape : callable
        ``shape(u, b)``, with a number or an array for b; f is `a` times it.
    place : bool
        Whether there is a `b`.
    power : float
        Of the argument, where the form is one.
    angle : bool
        Whether the argument is an angle in rad.
    """

    text: str
    shape: Callable[[Array, Array | float], Array]
    place: bool = False
    power: float = 0.0
    angle: bool = False


FORMS = (
    Form("a", lambda u, b: np.ones_like(u)),
    Form("a u", lambda u, b: u, power=1.0),
    Form("a u^2", lambda u, b: u**2, power=2.0),
    Form("a sqrt(|u|)", lambda u, b: np.sqrt(np.abs(u)), power=0.5),
    Form("a sin(u)^2", lambda u, b: np.sin(u) ** 2, angle=True),
    Form("a cos(u)^2", lambda u, b: np.cos(u) ** 2, angle=True),
    Form("a u / (b + |u|)", lambda u, b: u / (b + np.abs(u)), True),
    Form("a exp(-|u| / b)", lambda u, b: np.exp(-np.abs(u) / b), True),
    Form("a exp(-(u / b)^2)", lambda u, b: np.exp(-((u / b) ** 2)), True),
    Form("a (1 - exp(-|u| / b))", lambda u, b: 1.0 - np.exp(-np.abs(u) / b), True),
    Form("a (1 - exp(-(u / b)^2))", lambda u, b: 1.0 - np.exp(-((u / b) ** 2)), True),
    Form("a (u / b) exp(1 - |u| / b)", lambda u, b: u / b * np.exp(1.0 - np.abs(u) / b), True),
    Form("a ln(1 + |u| / b)", lambda u, b: np.log1p(np.abs(u) / b), True),
)


@dataclass(frozen=True)
class Formula:
    """A formula in the place of a curve.

    Attributes
    ----------
    text : str
        With `u` for the argument less its `origin`, `a` and `b`.
    a, b : float
        `b`, in the argument's unit, is NaN where the formula has none.
    origin : float
        Argument from which `u` is counted, in its unit.
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
    origin: float
    without: float
    lead: float
    p_value: float

    def at(self, argument: Array) -> Array:
        """Its values at arguments in their unit."""
        form = next(each for each in FORMS if each.text == self.text)
        return np.asarray(self.a * form.shape(argument - self.origin, self.b))

    def in_numbers(self, law: str, unit: str, own: str, relative: bool) -> str:
        """The law by the formula, with its numbers.

        Parameters
        ----------
        law : str
            Its name.
        unit, own : str
            Of the argument, and of the law.
        relative : bool
            Whether the law is what it is without f times 1 + f; else that and f added.
        """
        power = next(each.power for each in FORMS if each.text == self.text)
        to = "" if power == 1.0 else f"^{power:g}"
        of_argument = f"({unit})" if to and "/" in unit else unit
        per = f" per {of_argument}{to}" if power else ""
        in_own = "" if own == "-" else f" {own}"
        of_a = per if relative else in_own + per
        place = "" if np.isnan(self.b) else f", b = {self.b:.3g} {unit}"
        right = f"{self.without:.3g}{in_own} (1 + {self.text})" if relative else self.text
        return f"{law} = {right} with a = {self.a:.3g}{of_a}{place}"
