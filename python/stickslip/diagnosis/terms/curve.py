"""Curves through knots: a law of a free shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from stickslip._util.numbers import Array
from stickslip._util.text import OneLine
from stickslip.scenario.keys import Value

SIZES, LENGTHS = (0.5, 1.0, 2.0, 4.0), (0.35, 0.8)
"""Sizes, in a knot's usual size, and lengths, in the curve's range, of the process that is the
curve's prior. Chosen: from half the usual to a law that is searched up to ten usual sizes; a bend
in the middle, and about one bend."""

_NUGGET = 1e-4
"""Variance of a knot by itself, in that of the process: a covariance that can be inverted."""


@dataclass(frozen=True, repr=False, eq=False)
class Curve(OneLine):
    """A law f of one argument by its values at knots, in which it is linear.

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
    fixed : dict
        Values that the extended model has besides the knots, by name.
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
    fixed: dict[str, Value]

    @property
    def name(self) -> str:
        """``friction over slip speed``."""
        return f"{self.law} over {self.argument}"

    @property
    def origin(self) -> float:
        """From where formulas count the argument, in its unit.

        Zero, or the lower end where zero is farther from it than the range is wide.
        """
        return self.low if self.low > self.high - self.low else 0.0

    def without(self, values: Mapping[str, float]) -> float:
        """The law without f, where the model's parameters have these values by name."""
        return self.stated if self.constant is None else values.get(self.constant, self.stated)

    def precisions(self) -> list[Array]:
        """Inverse prior covariances of the knots' coordinates, one for each size and length."""
        nugget = _NUGGET * np.eye(len(self.places))
        inverse = [np.linalg.inv(self._alike(self.places, each) + nugget) for each in LENGTHS]
        return [np.asarray(each / size**2) for size in SIZES for each in inverse]

    def between_knots(self, argument: Array, knots: Array) -> Array:
        """Covariance of a smooth law about the curve that fits it best, shape (points, points).

        The knots' own covariance does not have it: a law may bend between them. It is what the
        curve's least squares leave of a process, averaged over the sizes and lengths by how likely
        each makes the knots (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006,
        section 4.2).

        Parameters
        ----------
        argument : ndarray, shape (points,)
            Evenly over the range.
        knots : ndarray, shape (knots,)
            Their coordinates. The covariance is in squares of the knots' usual size.
        """
        logs = [np.linalg.slogdet(each)[1] - knots @ each @ knots for each in self.precisions()]
        share = np.exp(0.5 * (np.array(logs) - max(logs))).reshape(len(SIZES), len(LENGTHS))
        share *= np.square(SIZES)[:, None] / np.sum(share)
        design = self.design(argument)
        left = np.eye(len(argument)) - design @ np.linalg.pinv(design)
        law = [self._alike(argument, each) for each in LENGTHS]
        return np.asarray(left @ np.tensordot(np.sum(share, axis=0), law, 1) @ left.T)

    def _alike(self, argument: Array, length: float) -> Array:
        apart = np.subtract.outer(argument, argument) / (self.high - self.low)
        return np.asarray(np.exp(-0.5 * (apart / length) ** 2))
