"""Laws of one argument: curves through knots, and the forms that compete with them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.text import OneLine

SIZES, LENGTHS = (0.5, 1.0, 2.0, 4.0), (0.35, 0.8)
"""Sizes, in a knot's usual size, and lengths, in the curve's range, of the process that is the
curve's prior. Chosen: from half the usual to a law that is searched up to ten usual sizes; a bend
in the middle, and about one bend."""

_NUGGET = 1e-4
"""Variance of a knot by itself, in that of the process: a covariance that can be inverted."""


class Shape(NamedTuple):
    """A form of a law: its values over u = argument / scale, in words, and its largest scale.

    That is in ranges of the argument. A form without one has the range itself, as its amplitude
    says all.
    """

    at: Callable[[Array], Array]
    text: str
    farthest: float = 2.0


CURVE, NEAREST = "curve", 1.0 / 64.0
"""The form through knots, and the least scale of the others in ranges of the argument. Chosen: most
contacts are far younger than the oldest; and what lies beyond the largest is another form."""

SHAPES = {
    "line": Shape(lambda u: u, "u", 0.0),
    "square": Shape(np.square, "u^2", 0.0),
    "gaussian": Shape(lambda u: np.exp(-(u**2)), "exp(-u^2)"),
    "exponential": Shape(lambda u: np.exp(-np.abs(u)), "exp(-|u|)"),
    "logarithm": Shape(lambda u: np.log1p(np.abs(u)), "ln(1 + |u|)"),
    "saturation": Shape(lambda u: u**2 / (1.0 + u**2), "u^2 / (1 + u^2)"),
    "wave": Shape(np.sin, "sin(u)", 0.5),
}


class Statement(Protocol):
    """How a model that has words of its own states a law.

    Attributes
    ----------
    section : str
        What the names of the law's parameters begin with.
    fixed : dict
        Values that the model has besides these parameters, by name.
    forms : sequence of str
        Those of `SHAPES` that the law may have.
    """

    @property
    def section(self) -> str: ...
    @property
    def fixed(self) -> Mapping[str, float | str]: ...
    @property
    def forms(self) -> Sequence[str]: ...

    def in_form(self, form: str, scale: float | None) -> Statement:
        """The statement of another form, with a scale that is no parameter."""
        ...

    def lines(self, numbers: Mapping[str, float]) -> list[str]:
        """The law as the model states it, with the values of the parameters by name."""
        ...


@dataclass(frozen=True, repr=False, eq=False)
class Curve(OneLine):
    """A law f of one argument by its values at knots, in which it is linear, or by a form.

    The knots' prior is a squared-exponential process, averaged over a grid of its size and length.
    Their coordinates are linear, so that the process is one in f and not in a bent scale of it.

    Attributes
    ----------
    law, argument : str
        What f changes and what it depends on: ``friction``, ``slip speed``.
    unit, law_unit : str
        Of the argument, and of the law as it is drawn.
    low, high : float
        Range of the argument.
    places : ndarray, shape (knots,)
        Argument at each knot.
    design : callable
        ``design(argument)``: what each knot adds to f, shape ``(*argument.shape, knots)``.
    constant : str, optional
        Name of the constant that the law is times 1 + f, if it is one.
    stated : float
        The law without f, where the model does not fit `constant`.
    relative : bool
        Whether the law is `stated` times 1 + f; else it is their sum.
    statement : Statement, optional
        How a model with words of its own states the law.
    form : str
        ``curve``, or one of `SHAPES`: then the parameters are its amplitude and, unless that is the
        range, its scale.
    """

    law: str
    argument: str
    unit: str
    law_unit: str
    low: float
    high: float
    places: Array
    design: Callable[[Array], Array]
    constant: str | None
    stated: float
    relative: bool
    statement: Statement | None = None
    form: str = CURVE

    @property
    def name(self) -> str:
        """``friction over slip speed``."""
        return f"{self.law} over {self.argument}"

    @property
    def origin(self) -> float:
        """From where forms count the argument, in its unit.

        Zero, or the lower end where zero is farther from it than the range is wide.
        """
        return self.low if self.low > self.high - self.low else 0.0

    @property
    def reach(self) -> float:
        """How far the range goes from the origin, in the argument's unit."""
        return max(abs(self.low - self.origin), abs(self.high - self.origin))

    def at(self, argument: Array, values: Array) -> Array:
        """f, shape (vectors, ...), for values of its parameters, (vectors, parameters).

        The argument has the shape (1, ...) or (vectors, ...).
        """
        if self.form == CURVE:
            return np.asarray(np.einsum("v...k,vk->v...", self.design(argument), values))
        wide = (len(values), *(1,) * (argument.ndim - 1))
        amplitude = values[:, 0].reshape(wide)
        scale = values[:, 1].reshape(wide) if values.shape[1] > 1 else self.reach
        return np.asarray(amplitude * SHAPES[self.form].at((argument - self.origin) / scale))

    def precisions(self) -> list[Array]:
        """Inverse prior covariances of the knots' coordinates, one for each size and length."""
        apart = np.subtract.outer(self.places, self.places) / (self.high - self.low)
        nugget = _NUGGET * np.eye(len(self.places))
        alike = [np.exp(-0.5 * (apart / length) ** 2) + nugget for length in LENGTHS]
        inverse = [np.linalg.inv(matrix) for matrix in alike]
        return [np.asarray(matrix / size**2) for size in SIZES for matrix in inverse]
