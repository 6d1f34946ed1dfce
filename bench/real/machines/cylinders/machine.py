"""Seven pneumatic cylinders of one design, filled once and left alone: the cylinder alone differs.

Of aluminium, resin and finely printed ones the pressure falls by a few hundredths of a bar, as the
air cools. Those printed in layers of 0.15 and 0.20 mm are empty within a minute, and the pressure
does not fall as an exponential does: they leak as through an orifice (Eva Zillen,
3D-printed-pneumatic-actuator, 6e0bcb4, CC0 1.0; t in s, pressure above that of the room in bar).
"""

from __future__ import annotations

from collections.abc import Collection
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from real.sets import Measured, Truth

from stickslip import (
    Cause,
    Diagnosis,
    Parameter,
    Prior,
    Series,
    diagnose_change,
    instruments,
)

Values = dict[str, np.ndarray]

BAR, ROOM = 1e5, 1.013e5  # Pa
EVERY = 10  # reading that is taken: one second; the fastest leak takes twenty
CRITICAL = 0.5  # ratio of pressures of an orifice in air below which its flow is that of sound
CONSTANTS = (
    Parameter("filled", Prior("normal", 7.5 * BAR, 0.5 * BAR), "Pa", cause=False,
              each_record=True),
    Parameter("cooling", Prior("normal", 0.04 * BAR, 0.03 * BAR), "Pa"),
    Parameter("cooling_time", Prior("log-uniform", 5.0, 200.0), "s", cause=False),
)  # fmt: skip
CAUSES = (
    Cause("leak", Parameter("leak.rate", unit="1/s", low=0.0, high=1.0, size=1e-2),
          "a leak through a porous wall, in proportion to the pressure"),
    Cause("orifice", Parameter("orifice.rate", unit="1/s", low=0.0, high=1.0, size=1e-2),
          "a leak through a hole"),
    Cause("creep", Parameter("creep.share", low=0.0, high=0.3, size=1e-2),
          "walls that yield more and more slowly"),
    Cause("sensor_drift", Parameter("sensor_drift.rate", unit="Pa/s", low=-1e4, high=1e4, size=1e2),
          "readings that drift evenly"),
    instruments.scale(0.02, name="sensor_scale"),
    instruments.offset("Pa", 0.05 * BAR, name="sensor_zero"),
)  # fmt: skip
ABSENT = {each.name: np.zeros((1, 1)) for cause in CAUSES for each in cause.parameters}


def pressure(log: Series, p: Values) -> np.ndarray:
    """Pressure above that of the room, Pa, by Runge-Kutta steps of the time between readings.

    Through a hole air flows as ISO 6358 says: in proportion to the pressure within while it is
    above twice that of the room, then by a quarter of an ellipse.
    """
    p = ABSENT | p
    start, cooling, time, leak, hole = np.broadcast_arrays(
        *(p[name][:, 0] for name in ("filled", "cooling", "cooling_time")),
        p["leak.rate"][:, 0], p["orifice.rate"][:, 0],
    )  # fmt: skip

    def fall(t: float, above: np.ndarray) -> np.ndarray:
        above = np.maximum(above, 0.0)
        part = np.maximum(ROOM / (ROOM + above) - CRITICAL, 0.0) / (1.0 - CRITICAL)
        flow = (ROOM + above) * np.sqrt(1.0 - part**2)
        return -leak * above - hole * flow - cooling / time * np.exp(-t / time)

    level, found = start, np.empty((len(start), len(log.t)))
    for k, (t, step) in enumerate(zip(log.t, np.diff(log.t, append=log.t[-1]), strict=True)):
        found[:, k] = level
        one = fall(t, level)
        two = fall(t + step / 2.0, level + step / 2.0 * one)
        three = fall(t + step / 2.0, level + step / 2.0 * two)
        four = fall(t + step, level + step * three)
        level = np.maximum(level + step / 6.0 * (one + 2.0 * (two + three) + four), 0.0)
    slow = 1.0 - p["creep.share"] * np.log1p(log.t / 10.0)
    return found * slow + p["sensor_drift.rate"] * log.t


def _log(name: str) -> Series:
    rows = pd.read_csv(Path(__file__).with_name("pressure.csv.gz"), dtype={"cylinder": str})
    rows = rows[rows["cylinder"] == name].iloc[::EVERY]
    t, bar = rows["t (s)"].to_numpy(), rows["pressure (bar)"].to_numpy()
    return Series(t, bar * BAR, name=name, unit="Pa")


def _compared(before: str, after: str, without: Collection[str] = ()) -> Diagnosis:
    listed = [each for each in CAUSES if f"{each.name}[after]" not in without]
    return diagnose_change(pressure, _log(before), _log(after), CONSTANTS, listed)


SETS = [
    Measured(f"cylinders, {before} to {after} mm",
             Truth(("orifice[after]",), ("leak[after]",)), partial(_compared, before, after))
    for before, after in (("aluminium", "0.15"), ("resin", "0.20"), ("0.06", "0.15"),
                          ("prusa", "0.20"))
]  # fmt: skip
