"""Many simulations that differ in the keys which the study varies, and their summaries.

A point is a row of numbers, one for each of `KEYS`; a scan is one quantity that the paper varies.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.reproduction.settings import PEAK, Setting
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.simulate import fraction_of
from stickslip.sweeping.points import encoded

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

Array = NDArray[np.float64]

KEYS = (
    *("drive.mode", "drive.edge", "drive.clamp", "drive.base", "drive.hold", "drive.peak"),
    *("drive.frequency", "drive.pulses", "drive.edge_time", "drive.ramp"),
    *("contact.static_friction", "contact.kinetic_friction", "contact.adhesion"),
    *("drag.linear", "drag.rotational", "robot.mass"),
)
"""Keys of a scenario that the study varies, in the order of a point's numbers."""

COLUMN = {key: place for place, key in enumerate(KEYS)}
"""Where the number of a key stands in a point."""

RTOL = 1e-6
"""Enough for mean velocities: an order below what shows in a figure."""

KINETIC_SHARE = 0.7
"""Kinetic over static friction in Fig. 8, section VI-A."""

PAINLEVE_FRICTION = 4.0 / 3.0
"""Kinetic friction beyond which a sliding uniform rectangle can have no consistent contact force,
derived in docs/theory/contact.md."""

PULSES = 20
"""Pulses of a simulation; the first three are not measured. Chosen: the mean is over seventeen."""
PULSES_WHEN_SLOW, FEWER_PULSES_BELOW = 12, 40.0
"""Below this frequency (Hz) the motion repeats itself from pulse to pulse, and fewer pulses are
enough; both chosen, because such pulses are long."""

SPREAD = 0.02
"""Half width of the small changes of frequency, friction and field; a choice of this study."""

_CHANGED_TOGETHER = (
    ("drive.frequency",),
    ("contact.static_friction", "contact.kinetic_friction"),
    ("drive.peak", "drive.base", "drive.hold"),
)


def point(keys: Mapping[str, Any]) -> Array:
    """The numbers of one point, shape (len(KEYS),): the paper's values except for `keys`."""
    scenario = Scenario().replace(dict(keys))
    return np.concatenate([encoded(key, [scenario.get(key)]) for key in KEYS])


def evaluate(
    batches: Sequence[Array], threads: int, progress: Progress | None = None
) -> list[dict[str, Any]]:
    """Simulate several arrays of points, shapes (..., len(KEYS)), in one call of the core.

    For each array it returns the columns of the summary by name, shape (...), with NaN where a
    simulation failed.
    """
    flat = np.concatenate([batch.reshape(-1, len(KEYS)) for batch in batches])
    base = Scenario().replace({"solver.rtol": RTOL})
    pulses, frequency = flat[:, COLUMN["drive.pulses"]], flat[:, COLUMN["drive.frequency"]]
    ramp = flat[:, COLUMN["drive.ramp"]]
    report = fraction_of(float((ramp + pulses / frequency).sum()), progress)
    columns, _ = _core.sweep(base.to_core(), list(KEYS), flat, threads, report)
    failed = columns["status"] != 0
    for values in columns.values():
        if values.dtype == np.float64:
            values[failed] = np.nan
    ends = np.cumsum([batch.size // len(KEYS) for batch in batches])[:-1]
    parts = {name: np.split(values, ends) for name, values in columns.items()}
    return [
        {name: part[k].reshape(batch.shape[:-1]) for name, part in parts.items()}
        for k, batch in enumerate(batches)
    ]


def variations(count: int) -> Array:
    """Evenly spread points in the cube from -1 to 1, shape (count, 3); the first is its centre.

    Roberts' additive recurrence with the plastic number of three dimensions: no random draw, so
    the study gives the same numbers each time.
    """
    ratio = 1.2207440846057596  # the real root of x^4 = x + 1
    steps = np.array([1.0 / ratio, 1.0 / ratio**2, 1.0 / ratio**3])
    return np.asarray(2.0 * np.mod(0.5 + np.arange(count)[:, np.newaxis] * steps, 1.0) - 1.0)


def varied(points: Array, count: int) -> Array:
    """Copies of points with small changes; shape (..., len(KEYS)) becomes (..., count, len(KEYS)).

    Frequency, both friction coefficients together, and all fields together are each changed by up
    to `SPREAD` of themselves. The first copy is unchanged.
    """
    changes = 1.0 + SPREAD * variations(count)
    result = np.repeat(points[..., np.newaxis, :], count, axis=-2)
    for which, keys in enumerate(_CHANGED_TOGETHER):
        for key in keys:
            result[..., COLUMN[key]] *= changes[:, which]
    return result


@dataclass(frozen=True)
class Scan:
    """One quantity that is varied, all else as in the paper."""

    key: str  # of the scenario; for friction the static one, with the kinetic one in ratio
    words: str  # what varies, in a table
    axis: str  # what varies, at an axis
    values: tuple[float, ...]  # SI
    frequency: float = 100.0  # pulses a second, Hz, where that is not what is varied
    proportional: bool = False  # whether base and hold grow in proportion to `drive.peak`

    def points(self, settings: Sequence[Setting], values: Sequence[float] | Array) -> Array:
        """Points of the study, shape (len(settings), len(values), len(KEYS))."""
        x = np.array(values)
        drive = {"drive.peak": PEAK, "drive.frequency": self.frequency}
        rows = np.array([point({**setting.keys(), **drive}) for setting in settings])
        result = np.repeat(rows[:, np.newaxis], len(x), axis=1)
        result[..., COLUMN[self.key]] = x
        if self.key == "contact.static_friction":
            result[..., COLUMN["contact.kinetic_friction"]] = KINETIC_SHARE * x
        if self.proportional:
            for key in ("drive.base", "drive.hold"):
                result[..., COLUMN[key]] *= x
                result[..., COLUMN[key]] /= PEAK
        slow = result[..., COLUMN["drive.frequency"]] < FEWER_PULSES_BELOW
        result[..., COLUMN["drive.pulses"]] = np.where(slow, PULSES_WHEN_SLOW, PULSES)
        return result


_FIELDS = tuple(np.arange(1.5e-3, 6.6e-3, 0.5e-3).round(6).tolist())
_FIELD_AXIS = "greatest pulsing field"

# The ranges of the paper's axes, with values closer where its statements need them.
SCANS = {
    "frequency": Scan(
        "drive.frequency",
        "frequency",
        "pulsing frequency",
        (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0, 80.0, 100.0, 120.0, 150.0),
    ),
    "friction": Scan(
        "contact.static_friction",
        "friction",
        "static friction coefficient",
        (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4),
    ),
    "adhesion": Scan(
        "contact.adhesion",
        "adhesion",
        "adhesion",
        (0.0, 0.05e-6, 0.1e-6, 0.15e-6, 0.22e-6, 0.3e-6, 0.4e-6, 0.5e-6, 0.6e-6, 0.8e-6),
    ),
    "linear": Scan(
        "drag.linear",
        "linear drag",
        "linear drag coefficient",
        (1e-8, 1e-7, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 1e-2),
    ),
    "rotational": Scan(
        "drag.rotational",
        "rotational drag",
        "rotational drag coefficient",
        (1e-18, 1e-17, 3e-17, 9e-17, 3e-16, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13),
    ),
    "field": Scan("drive.peak", "peak alone", _FIELD_AXIS, _FIELDS, 30.0),
    "fields": Scan(
        "drive.peak", "all fields in proportion", _FIELD_AXIS, _FIELDS, 30.0, proportional=True
    ),
}
"""By name. "field" varies the sawtooth's top alone, "fields" all three fields together."""
