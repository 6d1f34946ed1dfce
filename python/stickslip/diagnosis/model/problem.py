"""What is fitted: a forward model with its parameters and causes, the data and their errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.one_line import OneLine
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import refuse
from stickslip.scenario.priors import Prior

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Predict = Callable[[Any, Array], Array]
"""``predict(conditions, parameters)``: from shape (vectors, parameters) to (vectors, m)."""

PRIOR_INFLATION = 10.0
"""By how much a constant's prior is widened when the constant itself is the suspect. Chosen: an
error of several stated standard deviations then does not surprise."""

LOST = 1e3
"""Whitened residual of a condition that the model cannot compute. Chosen: far beyond any residual
of a usable model, and its square still leaves ten digits to the other conditions."""

# Standard deviation of a shape's logarithm. Chosen: exp(0.7) is a factor of two.
_SHAPE_WIDTH = 0.7
# Largest coordinates of a shape and of a constant that is known in range only. Chosen: 99.7 % of a
# normal law, and a range to within 0.05 % of its ends.
_SHAPE_LIMIT, _RANGE_LIMIT = 3.0, 3.5


@dataclass(frozen=True)
class Uncertain:
    """A parameter of the model that is known by its prior.

    Attributes
    ----------
    name : str
    prior : Prior
    unit : str
    suspect : bool
        Whether it may be named itself, as other than stated.

    Raises
    ------
    ScenarioError
        If the name is no text, or the prior no `Prior`.
    """

    name: str
    prior: Prior
    unit: str = "-"
    suspect: bool = True

    def __post_init__(self) -> None:
        if not isinstance(self.name, str):
            refuse("name", self.name, "a text")
        if not isinstance(self.prior, Prior):
            refuse(
                f"parameter {self.name}: prior", self.prior, 'a Prior, as Prior("normal", 1, 0.1)'
            )


@dataclass(frozen=True)
class CauseParameter:
    """One parameter of a cause.

    Attributes
    ----------
    name, unit : str
    low, high : float
        Physical range, in the unit.
    scale : float
        Size that would not surprise, in the unit: that at a coordinate of 1, where the coordinate's
        prior is standard normal. Beyond it, sizes grow exponentially with the coordinate.
    absent : float
        Value at which the cause does nothing.
    shape : bool
        A parameter such as a period, which says how the cause looks and not how strong it is; it is
        `absent` times exp of a normal coordinate of standard deviation 0.7.
    negligible : float
        Distance from `absent` below which the cause does nothing, in the unit; for one that is
        costly to simulate when it is tiny.
    downward : bool
        The cause grows as the parameter falls from `high`, at which it begins to act; at `absent`
        (a limit that is not there) it does nothing.
    fineness : float
        Share of the coordinate's unit over which predictions change as they do over the whole unit
        of other parameters. Below 1, minima are narrow, and their places are found by a scan.

    Raises
    ------
    ScenarioError
        If the range is empty or without `absent`, the scale is not above 0, or the fineness is out
        of its range.
    """

    name: str
    unit: str
    low: float
    high: float
    scale: float
    absent: float = 0.0
    shape: bool = False
    downward: bool = False
    negligible: float = 0.0
    fineness: float = 1.0

    def __post_init__(self) -> None:
        for field in ("low", "high", "scale", "absent", "negligible", "fineness"):
            value = getattr(self, field)
            if not isinstance(value, Real) or isinstance(value, bool):
                refuse(f"parameter {self.name}: {field}", value, "a number")
        low, high, absent, scale = self.low, self.high, self.absent, self.scale
        checks = (
            (low < high, f"low = {low}, high = {high}: allowed is low < high"),
            (
                self.downward or low <= absent <= high,
                f"absent = {absent}: allowed is {low} to {high}",
            ),
            (self.shape or 0.0 < scale < np.inf, f"scale = {scale}: allowed is a number above 0"),
            (
                1e-4 <= self.fineness <= 1.0,
                f"fineness = {self.fineness}: allowed is 0.0001 to 1",
            ),
        )
        for sound, said in checks:
            if not sound:
                raise ScenarioError(f"parameter {self.name}: {said}")

    def value(self, u: Array) -> Array:
        """Physical value at the coordinate `u`, whose prior is standard normal."""
        if self.shape:
            return np.clip(self.absent * np.exp(_SHAPE_WIDTH * u), self.low, self.high)
        if self.downward:
            return np.where(u <= 0.0, self.absent, np.maximum(self.high - self.scale * u, self.low))
        # Linear near zero and exponential far out, where a size would surprise in any case.
        size = self.scale * np.sinh(u) / np.sinh(1.0)
        value = np.clip(self.absent + size, self.low, self.high)
        return np.where(np.abs(value - self.absent) < self.negligible, self.absent, value)

    @property
    def prior_in_words(self) -> str:
        """Its prior as a short text for tables."""
        if self.shape:
            return f"log-normal({self.absent:g}, {np.exp(_SHAPE_WIDTH):.3g})"
        if self.downward:
            return f"scale {self.scale:g} below {self.high:g}"
        return f"scale {self.scale:g} about {self.absent:g}"

    def continuous(self, u: Array) -> Array:
        """The value without its jump to `absent` where a `downward` parameter begins to act."""
        if self.downward:
            return np.maximum(self.high - self.scale * np.maximum(u, 0.0), self.low)
        return self.value(u)

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest coordinate."""
        if self.shape:
            return -_SHAPE_LIMIT, _SHAPE_LIMIT
        if self.downward:
            return 0.0, (self.high - self.low) / self.scale
        low, high = (self.low - self.absent) / self.scale, (self.high - self.absent) / self.scale
        return float(np.arcsinh(low * np.sinh(1.0))), float(np.arcsinh(high * np.sinh(1.0)))


@dataclass(frozen=True)
class Cause:
    """A named extension of a model, or a constant that may be other than stated.

    Attributes
    ----------
    name, meaning : str
    parameters : tuple of CauseParameter
        Empty for a constant whose prior is relaxed.
    relaxes_prior : str, optional
        Name of the uncertain parameter whose prior is widened.

    Raises
    ------
    ScenarioError
        If `parameters` is not a tuple of them.
    """

    name: str
    parameters: tuple[CauseParameter, ...] = ()
    meaning: str = ""
    relaxes_prior: str | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.parameters, tuple) or not all(
            isinstance(each, CauseParameter) for each in self.parameters
        ):
            said = "parameters: allowed is a tuple of CauseParameter; of one it needs a comma"
            raise ScenarioError(f"cause {self.name}: {said}")


@dataclass(frozen=True, repr=False, eq=False)
class Problem(OneLine):
    """Data of the fitted conditions, and the model that is to explain them.

    Attributes
    ----------
    predict : callable
        Columns of its parameters: the uncertain ones, then those of all causes, in their order.
    conditions : Any
        Handed to `predict` as it is.
    observed : ndarray, shape (m,)
        Mean of each condition's trials.
    whiten : ndarray, shape (m, m)
        Takes errors of `observed` to independent ones of variance one.
    dof : float
        Degrees of freedom of the noise estimate; infinity where the noise was stated.
    uncertain : tuple of Uncertain
    causes : tuple of Cause
    outlier : float
        Whitened residual beyond which a misfit counts less and less (Cauchy's loss); infinity for
        least squares.
    low_fidelity : callable, optional
        A cheaper `predict`, whose errors are small where those of the data are taken as too large.
    """

    predict: Predict
    conditions: Any
    observed: Array
    whiten: Array
    dof: float
    uncertain: tuple[Uncertain, ...]
    causes: tuple[Cause, ...] = ()
    outlier: float = np.inf
    low_fidelity: Predict | None = None

    @cached_property
    def parameters(self) -> tuple[CauseParameter, ...]:
        """Parameters of all causes."""
        return tuple(each for cause in self.causes for each in cause.parameters)

    @property
    def base_count(self) -> int:
        """Number of uncertain parameters."""
        return len(self.uncertain)

    @property
    def size(self) -> int:
        """Number of all coordinates."""
        return len(self.uncertain) + len(self.parameters)

    @property
    def names(self) -> list[str]:
        """Names of all coordinates: the uncertain parameters, then those of all causes."""
        return [*(each.name for each in self.uncertain), *(each.name for each in self.parameters)]

    def columns(self, causes: Sequence[Cause]) -> list[int]:
        """Coordinates of the parameters of some causes."""
        chosen = {cause.name for cause in causes}
        result, at = [], self.base_count
        for cause in self.causes:
            if cause.name in chosen:
                result += list(range(at, at + len(cause.parameters)))
            at += len(cause.parameters)
        return result

    @cached_property
    def fineness(self) -> Array:
        """Share of each coordinate's unit over which predictions change, shape (size,)."""
        return np.array([1.0] * self.base_count + [each.fineness for each in self.parameters])

    def limits(self) -> tuple[Array, Array]:
        """Lowest and highest value of every coordinate."""
        ends = [np.inf if each.prior.has_middle else _RANGE_LIMIT for each in self.uncertain]
        pairs = [*((-end, end) for end in ends), *(each.limits for each in self.parameters)]
        low, high = np.array(pairs, dtype=float).reshape(-1, 2).T.copy()
        return low, high

    def physical(self, x: Array) -> Array:
        """Parameters in their units from coordinates, shape (vectors, size)."""
        constants = [each.prior for each in self.uncertain]
        laws: list[Prior | CauseParameter] = [*constants, *self.parameters]
        columns = [law.value(x[:, k]) for k, law in enumerate(laws)]
        return np.stack(columns, axis=1) if columns else np.zeros((len(x), 0))

    def predicted(self, x: Array) -> Array:
        """Observables at coordinates, shape (vectors, m)."""
        return np.asarray(self.predict(self.conditions, self.physical(x)), dtype=float)

    def with_inflated_errors(self, factor: float, outlier: float = np.inf) -> Problem:
        """The same with errors larger by a factor, so that the priors weigh more.

        With a factor above 1 the low-fidelity model predicts, if there is one.
        """
        predict = (self.low_fidelity if factor > 1.0 else None) or self.predict
        return replace(self, whiten=self.whiten / factor, outlier=outlier, predict=predict)

    def misfit(self, whitened: Array) -> Array:
        """Sum of squares over the last axis of whitened residuals, or Cauchy's loss of them."""
        if np.isinf(self.outlier):
            return np.asarray(np.sum(whitened**2, axis=-1))
        share = (whitened / self.outlier) ** 2
        return np.asarray(self.outlier**2 * np.sum(np.log1p(share), axis=-1))

    def weights(self, whitened: Array) -> Array:
        """Weights of the squares that give the derivative of `misfit`."""
        return np.asarray(1.0 / (1.0 + (whitened / self.outlier) ** 2))

    @cached_property
    def sd(self) -> Array:
        """Standard deviation of `observed`, shape (m,)."""
        return np.asarray(np.linalg.norm(np.linalg.inv(self.whiten), axis=1))

    def whitened(self, predicted: Array) -> Array:
        """Whitened data minus a prediction, shape (vectors, m); without the prior's rows."""
        gap = self.observed - predicted
        whitened = np.where(np.isfinite(gap), gap, 0.0) @ self.whiten.T
        return np.where(np.isfinite(gap), whitened, LOST)

    def residuals(self, x: Array) -> Array:
        """Whitened residuals at coordinates, shape (vectors, m)."""
        return self.whitened(self.predicted(x))


@dataclass(frozen=True, repr=False, eq=False)
class AuxiliaryData(OneLine):
    """Observables beside the trials, of another kind, whose errors are known.

    Attributes
    ----------
    observed : ndarray, shape (k,)
    covariance : ndarray, shape (k, k)
    group : ndarray of int, shape (k,)
        Observables that belong together, numbered from 0.
    """

    observed: Array
    covariance: Array
    group: Indices
