"""Forms of a law of one argument, of a dozen kinds, and a formula with its numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array


@dataclass(frozen=True)
class Form:
    """A family of laws f(u; a, b, c): `a` is a factor, `b` and `c` are places where there are some.

    Attributes
    ----------
    text : str
        With `u` for the argument.
    shape : callable
        ``shape(u, *places)``, with numbers or arrays for the places; f is `a` times it.
    places : int
        How many of `b` and `c` there are: 0, 1 or 2.
    power : float
        Of the argument, where the form is one.
    angle : bool
        Whether the argument is an angle in rad.
    even : bool
        Whether it is another form only where the argument has both signs. Angles, over which a
        law is periodic, have a sine in its place.
    """

    text: str
    shape: Callable[..., Array]
    places: int = 0
    power: float = 0.0
    angle: bool = False
    even: bool = False


FORMS = (
    Form("a", lambda u: np.ones_like(u)),
    Form("a u", lambda u: u, power=1.0),
    Form("a |u|", np.abs, power=1.0, even=True),
    Form("a u^2", lambda u: u**2, power=2.0),
    Form("a sqrt(|u|)", lambda u: np.sqrt(np.abs(u)), power=0.5),
    Form("a |sin(u)|", lambda u: np.abs(np.sin(u)), angle=True),
    Form("a sin(u)^2", lambda u: np.sin(u) ** 2, angle=True),
    Form("a cos(u)^2", lambda u: np.cos(u) ** 2, angle=True),
    Form("a u / (b + |u|)", lambda u, b: u / (b + np.abs(u)), 1),
    Form("a exp(-|u| / b)", lambda u, b: np.exp(-np.abs(u) / b), 1),
    Form("a exp(-(u / b)^2)", lambda u, b: np.exp(-((u / b) ** 2)), 1),
    Form("a (1 - exp(-|u| / b))", lambda u, b: 1.0 - np.exp(-np.abs(u) / b), 1),
    Form("a (1 - exp(-(u / b)^2))", lambda u, b: 1.0 - np.exp(-((u / b) ** 2)), 1),
    Form("a (u / b) exp(1 - |u| / b)", lambda u, b: u / b * np.exp(1.0 - np.abs(u) / b), 1),
    Form("a ln(1 + |u| / b)", lambda u, b: np.log1p(np.abs(u) / b), 1),
    Form("a exp(-((|u| - b) / c)^2)", lambda u, b, c: np.exp(-(((np.abs(u) - b) / c) ** 2)), 2),
)


@dataclass(frozen=True)
class Formula:
    """A formula in the place of a curve.

    Attributes
    ----------
    text : str
        With `u` for the argument less its `origin`, `a`, `b` and `c`.
    a : float
    places : tuple of float
        `b` and `c` as far as the formula has them, in the argument's unit.
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
    places: tuple[float, ...]
    origin: float
    without: float
    lead: float
    p_value: float

    def at(self, argument: Array) -> Array:
        """Its values at arguments in their unit."""
        form = next(each for each in FORMS if each.text == self.text)
        return np.asarray(self.a * form.shape(argument - self.origin, *self.places))

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
        named = zip("bc", self.places, strict=False)
        places = "".join(f", {name} = {each:.3g} {unit}" for name, each in named)
        right = f"{self.without:.3g}{in_own} (1 + {self.text})" if relative else self.text
        return f"{law} = {right} with a = {self.a:.3g}{of_a}{places}"
