"""What the engine knows of a forward model: parameters, causes, data, and whitened residuals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.one_line import OneLine
from stickslip.errors import ScenarioError
from stickslip.measurement.priors import Prior

Array = NDArray[np.float64]
Predict = Callable[[Any, Array], Array]
"""``predict(conditions, parameters)``: from shape (vectors, parameters) to (vectors, m)."""

PRIOR_INFLATION = 10.0
"""By how much a constant's prior is widened when it is itself the suspect."""

_SHAPE_WIDTH = 0.7

LOST = 1e3
"""Whitened residual of a condition that the model cannot compute."""


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
    """

    name: str
    prior: Prior
    unit: str = "-"
    suspect: bool = True


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

    Raises
    ------
    ScenarioError
        If the range is empty or without `absent`, or the scale is not above 0.
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

    def __post_init__(self) -> None:
        if not self.low < self.high:
            said = f"low = {self.low}, high = {self.high}: allowed is low < high"
            raise ScenarioError(f"parameter {self.name}: {said}")
        if not self.downward and not self.low <= self.absent <= self.high:
            said = f"absent = {self.absent}: allowed is {self.low} to {self.high}"
            raise ScenarioError(f"parameter {self.name}: {said}")
        if not self.shape and not 0.0 < self.scale < np.inf:
            said = f"scale = {self.scale}: allowed is a number above 0"
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
        """What is thought of its size before any data."""
        if self.shape:
            return f"log-normal({self.absent:g}, {np.exp(_SHAPE_WIDTH):.3g})"
        if self.downward:
            return f"scale {self.scale:g} below {self.high:g}"
        return f"scale {self.scale:g} about {self.absent:g}"

    def continuous(self, u: Array) -> Array:
        """The value without its jump to `absent`, where a falling parameter begins to act."""
        if self.downward:
            return np.maximum(self.high - self.scale * np.maximum(u, 0.0), self.low)
        return self.value(u)

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest coordinate."""
        if self.shape:
            return -3.0, 3.0
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
        Empty for a freed constant.
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
        given = self.parameters
        sound = isinstance(given, tuple)
        if not sound or not all(isinstance(each, CauseParameter) for each in given):
            said = "parameters: allowed is a tuple of CauseParameter; of one it needs a comma"
            raise ScenarioError(f"cause {self.name}: {said}")


@dataclass(frozen=True, repr=False)
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
    parameters: tuple[CauseParameter, ...] = field(init=False)

    def __post_init__(self) -> None:
        found = tuple(each for cause in self.causes for each in cause.parameters)
        object.__setattr__(self, "parameters", found)

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
        """Of all coordinates: the uncertain parameters, then those of all causes."""
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

    def limits(self) -> tuple[Array, Array]:
        """Lowest and highest value of every coordinate."""
        low, high = [-np.inf] * self.base_count, [np.inf] * self.base_count
        for k, each in enumerate(self.uncertain):
            if not each.prior.has_middle:
                low[k], high[k] = -3.5, 3.5
        for parameter in self.parameters:
            low.append(parameter.limits[0])
            high.append(parameter.limits[1])
        return np.array(low), np.array(high)

    def physical(self, x: Array) -> Array:
        """Parameters in their units from coordinates, shape (vectors, size)."""
        columns = [each.prior.value(x[:, k]) for k, each in enumerate(self.uncertain)]
        for k, parameter in enumerate(self.parameters, start=self.base_count):
            columns.append(parameter.value(x[:, k]))
        return np.stack(columns, axis=1) if columns else np.zeros((len(x), 0))

    def predicted(self, x: Array) -> Array:
        """Observables at coordinates, shape (vectors, m)."""
        return np.asarray(self.predict(self.conditions, self.physical(x)), dtype=float)

    def with_inflated_errors(self, factor: float, outlier: float = np.inf) -> Problem:
        """The same with errors larger by a factor, so that the priors weigh more.

        With a factor above 1 it is predicted by the draft, if there is one.
        """
        predict = (
            self.low_fidelity if self.low_fidelity is not None and factor > 1.0 else self.predict
        )
        return replace(self, whiten=self.whiten / factor, outlier=outlier, predict=predict)

    def misfit(self, whitened: Array) -> Array:
        """What the last axis of whitened residuals counts: the sum of squares, or less."""
        if np.isinf(self.outlier):
            return np.asarray(np.sum(whitened**2, axis=-1))
        share = (whitened / self.outlier) ** 2
        return np.asarray(self.outlier**2 * np.sum(np.log1p(share), axis=-1))

    def weights(self, whitened: Array) -> Array:
        """By which squares are weighed to have the slope of `misfit`."""
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


@dataclass(frozen=True, repr=False)
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
    group: NDArray[np.int64]
