"""What the paper leaves open and what it varies, and a simulation of every setting.

Of its two drives neither the sudden side of the sawtooth (edge) nor its bottom (base), the field of
the holding coil (hold) or the sign of the clamp coil's field (clamp) is stated; see sections V-A
and V-B and Figs. 4 and 6.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from xarray import DataArray, Dataset

from stickslip import Run, Scenario, simulate_batch, sweep
from stickslip._util.arrays import Array, Mask
from stickslip.simulation.notes import resting_force

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
    ("drive.peak", "drive.base", "drive.hold"),
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
    "field": Scan(
        "drive.peak",
        "greatest pulsing field",
        tuple(np.arange(1.5e-3, 6.6e-3, 0.5e-3).round(6).tolist()),
        frequency=30.0,
    ),
}
"""Varied settings of each statement and figure."""


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


Walks = Mapping[str, Dataset]
"""Walks at the settings of each mode: a dimension with the mode's name, and one for each scan.

- `mode`, `edge`, `clamp`, `base`, `hold`: the setting, T;
- `over_frequency`, `over_friction`, ...: mean velocity over the values of each scan of `SCANS`,
  m/s; the median of small changes;
- `velocity_30_hz`, `velocity_100_hz`: the same at two frequencies, m/s;
- `works`: whether the robot walks as the paper's does, forwards at 30 Hz and 100 Hz, with its pitch
  between flat and upright;
- `still_tilt`, `still_velocity`: with base and hold alone, before the first pulse, rad, and the
  greatest mean speed in constant fields, m/s;
- those of `strokes`; NaN for a setting that does not work.
"""

STROKE_FREQUENCY = 30.0
"""Frequency of the runs that are looked at stroke by stroke, as in Figs. 4 to 7, Hz."""

WORKING_FREQUENCIES = [STROKE_FREQUENCY, 100.0]
"""Those of the paper's figures, at which a setting has to walk, Hz."""

_MIN_VELOCITY = 2e-5  # m/s; chosen: a hundredth of what the paper measured
_TILT_TOLERANCE = 0.02  # rad; chosen: a degree, by which a body that lies flat may rock back


def survey(settings: Sequence[Setting], count: int, threads: int | None = None) -> Walks:
    """Simulate every setting, with `count` small changes for each point."""
    factors = small_changes(count)
    rows = [
        scan.changes(setting, value, factor)
        for scan in SCANS.values()
        for setting in settings
        for value in scan.values
        for factor in factors
    ]
    steady = [changes for setting in settings for changes in _constant_fields(setting)]
    data = sweep(BASE, rows + steady, threads=threads)
    table = pd.DataFrame(settings, columns=Setting._fields).to_xarray().rename(index="setting")
    begin = 0
    for name, scan in SCANS.items():
        shape = len(settings), len(scan.values), count
        block = data.isel(point=slice(begin, begin + math.prod(shape)))
        begin += math.prod(shape)
        table.coords[name] = list(scan.values)
        dims, velocity = ("setting", name, "change"), block.mean_velocity.values.reshape(shape)
        table[f"over_{name}"] = DataArray(velocity, dims=dims).median("change")
        if name == "frequency":
            for at in WORKING_FREQUENCIES:
                velocity_at = table.over_frequency.sel(frequency=at, drop=True)
                table[f"velocity_{at:.0f}_hz"] = velocity_at
            table["works"] = "setting", _works(table, block, shape)
    still = data.isel(point=slice(begin, None))
    tilt, speed = (np.abs(still[name].values) for name in ("theta_max", "mean_velocity"))
    table["still_tilt"] = "setting", tilt[::2]
    table["still_velocity"] = "setting", speed.reshape(-1, 2).max(axis=1)
    working = np.flatnonzero(table.works).tolist()
    runs = simulate_batch([stroke_scenario(settings[k]) for k in working], threads)
    by_stroke = pd.DataFrame([strokes(run) for run in runs], index=working)
    for name, column in by_stroke.reindex(range(len(settings))).items():
        table[str(name)] = "setting", column
    return {mode: table.isel(setting=table["mode"] == mode).rename(setting=mode) for mode in MODES}


def _works(table: Dataset, block: Dataset, shape: tuple[int, ...]) -> Mask:
    slow_and_fast = np.isin(SCANS["frequency"].values, WORKING_FREQUENCIES)
    low, high = (
        block[name].values.reshape(shape)[:, slow_and_fast] for name in ("theta_min", "theta_max")
    )
    least, greatest = low.min(axis=(1, 2)), high.max(axis=(1, 2))
    # The clamp coil pulls theta up with "down", and below zero with "up".
    down = table.clamp.values == "down"
    least, greatest = np.where(down, least, -greatest), np.where(down, greatest, -least)
    slowest = np.minimum(table.velocity_30_hz, table.velocity_100_hz).values
    upright = (least > -_TILT_TOLERANCE) & (greatest < 0.5 * np.pi)
    return np.asarray(upright & (slowest > _MIN_VELOCITY))


def _constant_fields(setting: Setting) -> list[dict[str, Any]]:
    """A second with constant fields: base and hold, then peak and hold."""
    # Velocity is measured from the end of the third pulse on: ten periods of 0.1 s.
    keys = {**setting.keys(), "drive.frequency": 10.0, "drive.pulses": 13}
    return [{**keys, "drive.base": field, "drive.peak": field} for field in (setting.base, PEAK)]


def stroke_scenario(setting: Setting) -> Scenario:
    """The run of a setting that is looked at stroke by stroke."""
    return Scenario().replace(
        {
            **setting.keys(),
            "drive.peak": PEAK,
            "drive.frequency": STROKE_FREQUENCY,
            "drive.pulses": 12,
            "record.rate": 20e3,  # ten samples and more in a period of the fastest free swing
        }
    )


def settings_table(walks: Walks) -> pd.DataFrame:
    """A row for every setting: what it is, and what it does."""
    parts = [walk.drop_dims(SCANS).to_dataframe() for walk in walks.values()]
    table = pd.concat(parts, ignore_index=True)
    table.attrs["units"] = {
        **dict.fromkeys(("base", "hold"), "T"),
        **dict.fromkeys(("velocity_30_hz", "velocity_100_hz", "still_velocity"), "m/s"),
        **dict.fromkeys(("still_tilt", "mean_tilt"), "rad"),
        **dict.fromkeys(("slip_up", "slip_down"), "m"),
    }
    return table


def strokes(run: Run) -> dict[str, float]:
    """Pitch, slip and normal force in the measuring window of a run on a uniform grid.

    The upstroke is where abs(theta) rises, the downstroke where it falls. `mean_tilt` is that of
    abs(theta), rad; `slip_up` and `slip_down` are the way of the contact along +x, m; the normal
    forces are means while it slips, over that at rest; `slip_share_up` is the part of the slip's
    path on the upstroke.
    """
    start, stop = run.scenario.window
    seen = (run.t >= start) & (run.t <= stop)
    rising = np.sign(run.theta[seen]) * run.omega[seen]
    slip, force = np.nan_to_num(run.slip_velocity[seen]), run.normal_force[seen]
    step, at_rest = interval(run), resting_force(run.scenario)
    numbers, forces, path = {"mean_tilt": float(np.abs(run.theta[seen]).mean())}, {}, {}
    for name, stroke in (("up", rising > 0.0), ("down", rising < 0.0)):
        numbers[f"slip_{name}"] = float(slip[stroke].sum() * step)
        path[name] = float(np.abs(slip[stroke]).sum() * step)
        slips = force[stroke & (slip != 0.0)]
        forces[f"normal_force_{name}"] = float(slips.mean() / at_rest) if len(slips) else np.nan
    total = path["up"] + path["down"]
    share = path["up"] / total if total > 0.0 else np.nan
    return {**numbers, **forces, "slip_share_up": share}


def interval(run: Run) -> float:
    """Time between two samples, s."""
    return float((run.t[-1] - run.t[0]) / (len(run.t) - 1))
