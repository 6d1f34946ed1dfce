"""A number of a model that is not known exactly, and the coordinate in which it is fitted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.messages import known_arguments, refuse, shown
from stickslip._util.prior import Prior
from stickslip._util.text import is_number
from stickslip.errors import ScenarioError

_FARTHEST = 3.5
"""Largest coordinate of a range or a shape, whose ends it has nearly reached there. Chosen: a
range to within 0.05 % of its ends."""

LARGEST_ERROR = 30.0
"""Largest error of an instrument, or height of an event, that is searched, in usual sizes. Chosen:
far out."""

_LARGEST_FACTOR = 1e3
"""By which a constant that is stated to a factor may be off, either way. Chosen: a wrong unit."""


@known_arguments
@dataclass(frozen=True)
class Parameter:
    """A parameter by its prior, or an amplitude by its usual size.

    Its coordinate u is standard normal under the prior. An amplitude is
    ``absent + size sinh(u) / sinh(1)``: linear near zero and exponential far out, where a size
    would surprise in any case. If its range begins at `absent`, its prior is half-normal.

    Attributes
    ----------
    name : str
    prior : Prior, optional
        Of a constant, or of the shape of an effect, such as a period.
    unit : str
    low, high : float
        Physical range, in the unit; of an amplitude both have to be finite.
    size : float, optional
        Of an amplitude, in place of a prior: the change that would not surprise, in the unit.
    absent : float
        Value of an amplitude at which it does nothing.
    falls : bool
        The effect of an amplitude begins as it falls below `high`, such as a limit: at the
        coordinate u it is ``high - size u``, and `absent` (no limit) at 0.
    cause : bool
        Whether a constant may be the cause itself, as other than stated. One that may not stays
        within 3.5 standard deviations of its prior.
    each_record : bool
        Whether a constant, or a shape, has a value of its own in each `Series`, such as a start
        state. It is no cause.
    negligible : float
        Distance from `absent` below which an amplitude does nothing, in the unit.
    fineness : float
        Share of the coordinate's unit over which predictions change; below 1, minima are narrow.
        Models of one's own are measured too, and the smaller share counts.

    Raises
    ------
    ScenarioError
        If a value is not allowed.
    """

    name: str
    prior: Prior | None = None
    unit: str = "-"
    low: float = -math.inf
    high: float = math.inf
    size: float | None = None
    absent: float = 0.0
    falls: bool = False
    cause: bool = True
    each_record: bool = False
    negligible: float = 0.0
    fineness: float = 1.0

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name:
            refuse("name of a parameter", self.name, "a text")
        at = f"parameter {self.name}: "
        if self.prior is not None and not isinstance(self.prior, Prior):
            refuse(f"{at}prior", self.prior, 'a Prior, as Prior("normal", 1, 0.1)')
        if (self.prior is None) == (self.size is None):
            raise ScenarioError(f"{at}allowed is one of prior and size")
        for field in ("low", "high", "absent", "negligible", "fineness", "size"):
            value = getattr(self, field)
            if not is_number(value) and not (field == "size" and value is None):
                refuse(at + field, value, "a number")
        if not self.low < self.high:
            text = f"low = {shown(self.low)}, high = {shown(self.high)}"
            raise ScenarioError(f"{at}{text}: allowed is low < high")
        if self.negligible < 0.0:
            refuse(at + "negligible", self.negligible, "a number from 0")
        if not 1e-4 <= self.fineness <= 1.0:
            refuse(at + "fineness", self.fineness, "0.0001 to 1")
        if self.size is None:
            return
        if not 0.0 < self.size < math.inf:
            refuse(at + "size", self.size, "a number above 0")
        if not math.isfinite(self.low) or not math.isfinite(self.high):
            raise ScenarioError(f"{at}allowed are a finite low and high for an amplitude")
        if not self.falls and not self.low <= self.absent <= self.high:
            refuse(at + "absent", self.absent, f"{self.low} to {self.high}")

    @property
    def is_amplitude(self) -> bool:
        """Whether it says how strong an effect is."""
        return self.size is not None

    @property
    def is_stated(self) -> bool:
        """Whether it is a constant whose prior has a middle."""
        return self.prior is not None and self.prior.has_middle

    @property
    def may_be_off(self) -> bool:
        """Whether it may be a cause as other than stated."""
        return self.is_stated and self.cause

    def value(self, u: Array) -> Array:
        """Physical value at coordinates."""
        if self.prior is not None:
            return np.clip(self.prior.value(u), self.low, self.high)
        assert self.size is not None
        if self.falls:
            return np.where(u <= 0.0, self.absent, self._limit(u))
        value = np.clip(self.absent + self.size * np.sinh(u) / math.sinh(1.0), self.low, self.high)
        return np.where(np.abs(value - self.absent) < self.negligible, self.absent, value)

    def smooth_value(self, u: Array) -> Array:
        """The value without its jump to `absent`."""
        return self._limit(np.maximum(u, 0.0)) if self.falls else self.value(u)

    def _limit(self, u: Array) -> Array:
        assert self.size is not None
        return np.maximum(self.high - self.size * u, self.low)

    @cached_property
    def middle(self) -> float:
        """Value at the coordinate 0: of an amplitude the absent one."""
        return float(self.value(np.zeros(1))[0])

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest coordinate."""
        if self.size is not None:
            if self.falls:
                return 0.0, (self.high - self.low) / self.size
            return self.coordinate(self.low), self.coordinate(self.high)
        assert self.prior is not None
        # A shape, which is no cause, stays near its middle; a stated constant may be far off.
        end = math.inf
        if not self.prior.has_middle or not self.cause:
            end = _FARTHEST
        elif self.prior.kind == "log-normal":
            end = math.log(_LARGEST_FACTOR) / math.log(self.prior.second)
        low, high = (self.coordinate(x) if math.isfinite(x) else x for x in (self.low, self.high))
        return max(-end, low), min(end, high)

    def coordinate(self, value: float) -> float:
        """Coordinate of a value; of an amplitude, of one that does not fall."""
        if self.size is not None:
            return math.asinh((value - self.absent) * math.sinh(1.0) / self.size)
        assert self.prior is not None
        return self.prior.coordinate(value)

    @property
    def one_sided(self) -> bool:
        """Whether its prior is half-normal."""
        return self.is_amplitude and 0.0 in self.limits

    @property
    def prior_in_words(self) -> str:
        """Its prior as a short text for tables."""
        if self.prior is not None:
            return repr(self.prior)
        if self.falls:
            return f"size {self.size:g} below {self.high:g}"
        return f"size {self.size:g} about {self.absent:g}"


def either_way(name: str, unit: str, size: float, largest: float | None = None) -> Parameter:
    """An amplitude of either sign."""
    end = LARGEST_ERROR * size if largest is None else largest
    return Parameter(name, unit=unit, low=-end, high=end, size=size)
