"""All settings, each through the scans of the paper."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray

from stickslip.reproduction.settings import BASE, MODES, PEAK, SCANS, Setting, small_changes
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.notes import resting_force
from stickslip.simulation.run import Run
from stickslip.simulation.simulate import simulate_batch
from stickslip.sweeping.run_sweep import sweep

if TYPE_CHECKING:
    from stickslip._util.arrays import Mask
    from stickslip.simulation.simulate import Progress

Walks = Mapping[str, xarray.Dataset]
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


def survey(
    settings: Sequence[Setting],
    count: int,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Walks:
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
    data = sweep(BASE, rows + steady, threads=threads, progress=progress)
    table = pd.DataFrame(settings, columns=Setting._fields).to_xarray().rename(index="setting")
    begin = 0
    for name, scan in SCANS.items():
        shape = len(settings), len(scan.values), count
        block = data.isel(point=slice(begin, begin + math.prod(shape)))
        begin += math.prod(shape)
        table.coords[name] = list(scan.values)
        velocity = xarray.DataArray(
            block.mean_velocity.values.reshape(shape), dims=("setting", name, "change")
        )
        table[f"over_{name}"] = velocity.median("change")
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
    by_stroke = pd.DataFrame([strokes(run) for run in runs], index=working, columns=STROKES)
    for name, column in by_stroke.reindex(range(len(settings))).items():
        table[str(name)] = "setting", column
    return {mode: table.isel(setting=table["mode"] == mode).rename(setting=mode) for mode in MODES}


def _works(table: xarray.Dataset, block: xarray.Dataset, shape: tuple[int, ...]) -> Mask:
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


STROKES = (
    *("mean_tilt", "slip_up", "slip_down"),
    *("normal_force_up", "normal_force_down", "slip_share_up"),
)


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
    step = interval(run)
    numbers, path = {"mean_tilt": float(np.abs(run.theta[seen]).mean())}, {}
    for name, stroke in (("up", rising > 0.0), ("down", rising < 0.0)):
        numbers[f"slip_{name}"] = float(slip[stroke].sum() * step)
        path[name] = float(np.abs(slip[stroke]).sum() * step)
        slips = force[stroke & (slip != 0.0)]
        mean = float(slips.mean() / resting_force(run.scenario)) if len(slips) else np.nan
        numbers[f"normal_force_{name}"] = mean
    total = path["up"] + path["down"]
    numbers["slip_share_up"] = path["up"] / total if total > 0.0 else np.nan
    return numbers


def interval(run: Run) -> float:
    """Time between two samples, s."""
    return float((run.t[-1] - run.t[0]) / (len(run.t) - 1))
