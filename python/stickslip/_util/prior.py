"""Prior distributions of single parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.arrays import Array
from stickslip._util.messages import known_arguments, shown
from stickslip._util.text import is_number
from stickslip.errors import ScenarioError

_EDGE = 5.0  # standard deviations at which a range ends; chosen: 6e-7 of it lie beyond

NUMBERS: dict[Literal["normal", "log-normal", "uniform", "log-uniform"], tuple[str, str]] = {
    "normal": ("mean", "sd"),
    "log-normal": ("median", "factor"),
    "uniform": ("min", "max"),
    "log-uniform": ("low", "high"),
}


@known_arguments
@dataclass(frozen=True, repr=False)
class Prior:
    """A prior distribution of one parameter.

    Attributes
    ----------
    kind : {"normal", "log-normal", "uniform", "log-uniform"}
    first, second : float
        Mean and standard deviation; median and factor (one standard deviation is this factor); the
        two ends of a uniform or log-uniform range. In the parameter's unit, except the factor; both
        have to be given.

    Raises
    ------
    ScenarioError
        If there is no such kind, or a number makes no distribution.
    """

    kind: Literal["normal", "log-normal", "uniform", "log-uniform"]
    first: float = math.nan
    second: float = math.nan

    def __post_init__(self) -> None:
        if not isinstance(self.kind, str) or self.kind not in NUMBERS:
            allowed = f'{", ".join(NUMBERS)}, as in Prior("normal", 0.145, 0.01)'
            raise ScenarioError(f"kind of a prior = {shown(self.kind)}: allowed is {allowed}")
        for name, value in self.table.items():
            if not is_number(value) or not math.isfinite(value):
                raise ScenarioError(f"{name} = {shown(value)}: allowed is a number")
        fits, allowed = {
            "normal": (self.second > 0.0, "sd above 0"),
            "log-normal": (self.first > 0.0 and self.second > 1.0, "median > 0 and factor > 1"),
            "uniform": (self.first < self.second, "min < max"),
            "log-uniform": (0.0 < self.first < self.second, "0 < low < high; for a uniform prior "
                            'give { min, max }, or Prior("uniform", min, max)'),
        }[self.kind]  # fmt: skip
        if not fits or not math.isfinite(self._width):
            text = ", ".join(f"{name} = {value}" for name, value in self.table.items())
            raise ScenarioError(f"{text}: allowed is {'a finite width' if fits else allowed}")

    def __repr__(self) -> str:
        return f"{self.kind}({self.first:g}, {self.second:g})"

    @staticmethod
    def of_table(table: Mapping[str, float]) -> Prior | None:
        """The prior of such numbers by name; None where no kind has these."""
        kind = next((kind for kind, names in NUMBERS.items() if {*names} == {*table}), None)
        return None if kind is None else Prior(kind, *(table[name] for name in NUMBERS[kind]))

    @property
    def table(self) -> dict[str, float]:
        """Its numbers by name, as a file has them."""
        return dict(zip(NUMBERS[self.kind], (self.first, self.second), strict=True))

    @property
    def has_middle(self) -> bool:
        """Whether it has a most likely value, and not a range only."""
        return not self.kind.endswith("uniform")

    @property
    def is_logarithmic(self) -> bool:
        """Whether the logarithm of the value has this distribution."""
        return self.kind.startswith("log")

    def value(self, z: ArrayLike) -> Array:
        """Parameter at the coordinate `z`, which is standard normal under this prior."""
        z = np.asarray(z, dtype=float)
        move = self._width * (z if self.has_middle else _shares(np.clip(z, -_EDGE, _EDGE)))
        return np.asarray(self.first * np.exp(move) if self.is_logarithmic else self.first + move)

    def coordinate(self, value: float) -> float:
        """Inverse of `value`; of one without a logarithm the least coordinate there is."""
        if self.is_logarithmic and value <= 0.0:
            return -math.inf if self.has_middle else -_EDGE
        move = math.log(value / self.first) if self.is_logarithmic else value - self.first
        share = move / self._width
        if self.has_middle or not 0.0 < share < 1.0:
            return share if self.has_middle else math.copysign(_EDGE, share - 0.5)
        return min(max(NormalDist().inv_cdf(share), -_EDGE), _EDGE)

    @property
    def _width(self) -> float:
        """One standard deviation, or the whole range, of the value or of its logarithm."""
        if self.is_logarithmic:
            return math.log(self.second if self.has_middle else self.second / self.first)
        return self.second if self.has_middle else self.second - self.first


def _shares(z: Array) -> Array:
    """Standard normal distribution function; like SciPy's ndtr, exact to rounding at both ends."""
    return np.asarray(0.5 * np.vectorize(math.erfc, [float])(-z * math.sqrt(0.5)))
