"""The open settings of the paper's two drives, as a grid, and the quantities it varies.

Neither the sudden side of the sawtooth (edge) nor its bottom (base), the field of the holding coil
(hold) or the sign of the clamp coil's field (clamp) is stated; see sections V-A and V-B and
Figs. 4 and 6.
"""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np

from stickslip._util.arrays import Array
from stickslip.scenario.keys import FIELDS
from stickslip.scenario.scenario import Scenario

BASE = Scenario().replace({"solver.rtol": 1e-6})
"""Settings of all simulations of a scan; the tolerance is enough for mean velocities."""

MODES = ("IPP", "OPP")

PEAK = 2.5e-3
"""Top of the sawtooth in all figures but 14 and 15, T."""

KINETIC_SHARE = 0.7
"""Kinetic over static friction in Fig. 8, section VI-A."""

_SPREAD = 0.02
"""Half width of the small changes of frequency, friction and field. Chosen."""

_CHANGED_TOGETHER = (
    ("drive.frequency",),
    ("contact.static_friction", "contact.kinetic_friction"),
    FIELDS,
)

# The first three pulses are not measured. Slow pulses take long, and repeat themselves sooner.
_PULSES, _SLOW_PULSES, _SLOW_BELOW = 20, 12, 40.0  # the last in Hz; all chosen


class Setting(NamedTuple):
    """One way to fill in what the paper leaves open; `base` and `hold` in T."""

    mode: str  # "IPP" or "OPP"
    edge: str  # "rise" or "fall"
    clamp: str  # "down" or "up"
    base: float
    hold: float

    def keys(self) -> dict[str, Any]:
        """The setting by the keys of a scenario."""
        return {f"drive.{name}": value for name, value in self._asdict().items()}

    def __str__(self) -> str:
        return (
            f"sudden {self.edge}, clamp {self.clamp}, base {self.base * 1e3:g} mT, "
            f"hold {self.hold * 1e3:g} mT"
        )


GRID = tuple(
    Setting(*values)
    for values in itertools.product(
        MODES,
        ("rise", "fall"),
        ("down", "up"),
        (0.0, 0.25e-3, 0.5e-3, 1.0e-3),
        (0.5e-3, 1.0e-3, 1.5e-3, 2.0e-3, 2.5e-3, 3.0e-3),
    )
)
"""The settings that are tried. Bases go to two fifths of the peak, holding fields from a fifth of
it to a little more than it."""


class Scan(NamedTuple):
    """One quantity that the paper varies, all else as in the paper."""

    key: str  # for friction the static one, with the kinetic one in ratio
    axis: str  # what varies, at an axis
    values: tuple[float, ...]  # SI
    frequency: float = 100.0  # Hz, where that is not what is varied
    proportional: bool = False  # whether base and hold grow with the peak

    def changes(self, setting: Setting, value: float, factors: Array) -> dict[str, Any]:
        """The keys of one simulation.

        `factors` are those of frequency, of both friction coefficients and of all fields.
        """
        keys = {
            **setting.keys(),
            "drive.peak": PEAK,
            "drive.frequency": self.frequency,
            **{key: BASE.get(key) for key in _CHANGED_TOGETHER[1]},
            self.key: value,
        }
        if self.key == "contact.static_friction":
            keys["contact.kinetic_friction"] = KINETIC_SHARE * value
        if self.proportional:
            for key in ("drive.base", "drive.hold"):
                keys[key] = keys[key] * value / PEAK
        slow = keys["drive.frequency"] < _SLOW_BELOW
        keys["drive.pulses"] = _SLOW_PULSES if slow else _PULSES
        for factor, together in zip(factors, _CHANGED_TOGETHER, strict=True):
            for key in together:
                keys[key] *= factor
        return keys


_FIELDS = tuple(np.arange(1.5e-3, 6.6e-3, 0.5e-3).round(6).tolist())
_FIELD_AXIS = "greatest pulsing field"

# The ranges of the paper's axes, with values closer where its statements need them.
SCANS = {
    "frequency": Scan(
        "drive.frequency",
        "pulsing frequency",
        (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0, 80.0, 100.0, 120.0, 150.0),
    ),
    "friction": Scan(
        "contact.static_friction",
        "static friction coefficient",
        (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4),
    ),
    "adhesion": Scan(
        "contact.adhesion",
        "adhesion",
        (0.0, 0.05e-6, 0.1e-6, 0.15e-6, 0.22e-6, 0.3e-6, 0.4e-6, 0.5e-6, 0.6e-6, 0.8e-6),
    ),
    "linear": Scan(
        "drag.linear",
        "linear drag coefficient",
        (1e-8, 1e-7, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 1e-2),
    ),
    "rotational": Scan(
        "drag.rotational",
        "rotational drag coefficient",
        (1e-18, 1e-17, 3e-17, 9e-17, 3e-16, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13),
    ),
    "field": Scan("drive.peak", _FIELD_AXIS, _FIELDS, 30.0),
}
"""Varied settings of each statement and figure."""

FIELDS_TOGETHER = Scan("drive.peak", _FIELD_AXIS, _FIELDS, 30.0, proportional=True)
"""Peak, base and hold in proportion, where "field" varies the peak alone."""


def small_changes(count: int) -> Array:
    """Factors of frequency, friction and field, shape (count, 3); the first are 1.

    At 100 Hz a frequency 2 % higher changes one velocity in ten by more than 8 %, so a median over
    small changes says more. They are spread evenly by Roberts' additive recurrence with the plastic
    number of three dimensions.
    """
    ratio = 1.2207440846057596  # the real root of x^4 = x + 1
    steps = np.array([1.0 / ratio, 1.0 / ratio**2, 1.0 / ratio**3])
    spread = 2.0 * np.mod(0.5 + np.arange(count)[:, np.newaxis] * steps, 1.0) - 1.0
    return np.asarray(1.0 + _SPREAD * spread)
