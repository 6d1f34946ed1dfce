"""Prior distributions of single parameters."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.arrays import Array
from stickslip._util.messages import shown
from stickslip._util.text import is_number
from stickslip.errors import ScenarioError

_EDGE = 5.0
"""Standard deviations at which a range ends. Chosen: 6e-7 of it lie beyond."""

NUMBERS: dict[Literal["normal", "log-normal", "log-uniform"], tuple[str, str]] = {
    "normal": ("mean", "sd"),
    "log-normal": ("median", "factor"),
    "log-uniform": ("low", "high"),
}


@dataclass(frozen=True, repr=False)
class Prior:
    """A prior distribution of one parameter.

    Attributes
    ----------
    kind : {"normal", "log-normal", "log-uniform"}
    first, second : float
        Mean and standard deviation; median and factor (one standard deviation is this factor); low
        and high end. In the parameter's unit, except the factor; both have to be given.

    Raises
    ------
    ScenarioError
        If there is no such kind, or a number makes no distribution.
    """

    kind: Literal["normal", "log-normal", "log-uniform"]
    first: float = math.nan
    second: float = math.nan

    def __post_init__(self) -> None:
        if not isinstance(self.kind, str) or self.kind not in NUMBERS:
            allowed = f'{", ".join(NUMBERS)}, as in Prior("normal", 0.145, 0.01)'
            raise ScenarioError(f"kind of a prior = {shown(self.kind)}: allowed is {allowed}")
        one, two = NUMBERS[self.kind]
        for name, value in ((one, self.first), (two, self.second)):
            if not is_number(value) or not math.isfinite(value):
                raise ScenarioError(f"{name} = {shown(value)}: allowed is a number")
        text = f"{one} = {self.first}, {two} = {self.second}"
        if self.kind == "normal" and self.second <= 0.0:
            raise ScenarioError(f"sd = {self.second}: allowed is a number above 0")
        if self.kind == "log-normal" and not (self.first > 0.0 and self.second > 1.0):
            raise ScenarioError(f"{text}: allowed is median > 0 and factor > 1")
        if self.kind == "log-uniform" and not 0.0 < self.first < self.second:
            raise ScenarioError(f"{text}: allowed is 0 < low < high")

    def __repr__(self) -> str:
        return f"{self.kind}({self.first:g}, {self.second:g})"

    @property
    def table(self) -> dict[str, float]:
        """Its numbers by name, as a file has them."""
        return dict(zip(NUMBERS[self.kind], (self.first, self.second), strict=True))

    @property
    def has_middle(self) -> bool:
        """Whether it has a most likely value, and not a range only."""
        return self.kind != "log-uniform"

    def value(self, z: ArrayLike) -> Array:
        """Parameter at the coordinate `z`, which is standard normal under this prior."""
        z = np.asarray(z, dtype=float)
        if self.kind == "normal":
            return np.asarray(self.first + self.second * z)
        if self.kind == "log-normal":
            return np.asarray(self.first * np.exp(math.log(self.second) * z))
        share = _shares(np.clip(z, -_EDGE, _EDGE))
        return np.asarray(self.first * np.exp(math.log(self.second / self.first) * share))

    def coordinate(self, value: float) -> float:
        """Inverse of `value`."""
        if self.kind == "normal":
            return (value - self.first) / self.second
        if self.kind == "log-normal":
            return math.log(value / self.first) / math.log(self.second)
        share = math.log(value / self.first) / math.log(self.second / self.first)
        if not 0.0 < share < 1.0:
            return math.copysign(_EDGE, share - 0.5)
        return min(max(NormalDist().inv_cdf(share), -_EDGE), _EDGE)


def _shares(z: Array) -> Array:
    """Standard normal distribution function; like SciPy's ndtr, exact to rounding at both ends."""
    erfc = np.frompyfunc(math.erfc, 1, 1)
    return np.asarray(0.5 * np.asarray(erfc(-z * math.sqrt(0.5)), dtype=float))
