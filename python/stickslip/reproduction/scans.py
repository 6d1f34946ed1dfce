"""The quantities that the paper varies, Figs. 8 to 15, and the points that the study takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.reproduction.points import KEYS, Array, column, point, set_key
from stickslip.reproduction.settings import PEAK, Setting

KINETIC_SHARE = 0.7
"""Kinetic over static friction in Fig. 8, section VI-A."""

PAINLEVE_FRICTION = 4.0 / 3.0
"""Kinetic friction beyond which a sliding uniform rectangle can have no consistent contact force,
derived in docs/theory/contact.md."""

PULSES = 20
"""Of a simulation; the first three are not measured."""
PULSES_WHEN_SLOW, FEWER_PULSES_BELOW = 12, 40.0
"""Below this frequency the motion repeats itself from pulse to pulse, and fewer pulses do, Hz."""


@dataclass(frozen=True)
class Scan:
    """One quantity that is varied, all else as in the paper."""

    key: str  # of the scenario; for friction the static one, with the kinetic one in ratio
    values: tuple[float, ...]  # SI
    frequency: float = 100.0  # pulses a second, Hz, where that is not what is varied
    proportional: bool = False  # whether base and hold grow in proportion to `drive.peak`

    def points(self, settings: Sequence[Setting], values: Sequence[float] | None = None) -> Array:
        """Points of the study, shape (len(settings), len(values), len(KEYS))."""
        x = np.array(self.values if values is None else values)
        result = np.empty((len(settings), len(x), len(KEYS)))
        for row, setting in zip(result, settings, strict=True):
            row[:] = point(
                {**setting.keys(), "drive.peak": PEAK, "drive.frequency": self.frequency}
            )
            set_key(row, self.key, x)
            if self.key == "contact.static_friction":
                set_key(row, "contact.kinetic_friction", KINETIC_SHARE * x)
            if self.proportional:
                set_key(row, "drive.base", setting.base * x / PEAK)
                set_key(row, "drive.hold", setting.hold * x / PEAK)
        slow = result[..., column("drive.frequency")] < FEWER_PULSES_BELOW
        set_key(result, "drive.pulses", np.where(slow, PULSES_WHEN_SLOW, PULSES))
        return result


_FIELDS = tuple(np.arange(1.5e-3, 6.6e-3, 0.5e-3).round(6).tolist())

# The ranges of the paper's axes, with values closer where its statements need them.
SCANS = {
    "frequency": Scan(
        "drive.frequency",
        (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0, 80.0, 100.0, 120.0, 150.0),
    ),
    "friction": Scan(
        "contact.static_friction",
        (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4),
    ),
    "adhesion": Scan(
        "contact.adhesion",
        (0.0, 0.05e-6, 0.1e-6, 0.15e-6, 0.22e-6, 0.3e-6, 0.4e-6, 0.5e-6, 0.6e-6, 0.8e-6),
    ),
    "linear": Scan("drag.linear", (1e-8, 1e-7, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 1e-2)),
    "rotational": Scan(
        "drag.rotational",
        (1e-18, 1e-17, 3e-17, 9e-17, 3e-16, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13),
    ),
    "field": Scan("drive.peak", _FIELDS, 30.0),
    "fields": Scan("drive.peak", _FIELDS, 30.0, proportional=True),
}
"""By name. "field" varies the sawtooth's top alone, "fields" all three fields together."""
