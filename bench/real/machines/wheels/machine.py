"""Both wheels of a small robot after a step of the target to 200 rpm: the loop's delay differs.

The loop adds a whole number to the command at each of its passes, in proportion to the error, so
that small errors add nothing; its stated delay of 1, 2, 5 or 10 ms is what was changed
(opatiny/micromouse, fb04095, CERN-OHL-P-2.0; ms since the start of the board, command of +-255). A
pass takes 1 ms more than the delay. The command is not given to the model: with it, nothing
differs. A longer pass acts as a smaller gain does.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from real.sets import Measured, Truth

from stickslip import Cause, Diagnosis, Parameter, Prior, Series, diagnose_change, instruments

Values = dict[str, np.ndarray]

RPM, MS = 1.0 / 60.0, 1e-3
STEP, END = 2e-3, 0.8  # s; two swings of the speed
TARGET = 200.0 * RPM
CONSTANTS = (
    Parameter("gain", Prior("normal", 1.2, 0.12), "s"),  # command a pass over the error
    Parameter("period", Prior("normal", 2e-3, 2e-4), "s"),
    Parameter("dead", Prior("normal", 0.6, 0.3), "1/s", low=0.0),  # errors that add nothing
    Parameter("motor", Prior("log-uniform", 0.02, 0.5), "1/s", cause=False),  # speed per command
    Parameter("settling", Prior("log-uniform", 5e-3, 0.5), "s", cause=False),
    Parameter("dry", Prior("normal", 60.0, 20.0)),  # command that friction takes
    Parameter("stiction", Prior("normal", 20.0, 20.0), low=0.0),  # and more to begin
)
CAUSES = (
    Cause("drag", Parameter("drag.rate", unit="s", low=0.0, high=20.0, size=0.2),
          "friction that grows with the square of the speed"),
    instruments.scale(0.05, name="encoder_scale"),
    instruments.lag(5e-3, name="encoder_lag"),
)  # fmt: skip
ABSENT = {each.name: np.zeros((1, 1)) for cause in CAUSES for each in cause.parameters}


def speed(log: Series, p: Values) -> np.ndarray:
    """Speed of a wheel, 1/s: a motor of first order with dry friction under an integrating loop."""
    p = ABSENT | p
    names = ("gain", "period", "dead", "motor", "settling", "dry", "stiction", "drag.rate")
    gain, period, dead, motor, settling, dry, stiction, drag = np.broadcast_arrays(
        *(p[name][:, 0] for name in names)
    )
    t = np.arange(0.0, log.t[-1] + 2.0 * STEP, STEP)
    v, command = np.zeros(len(gain)), np.zeros(len(gain))
    found = np.empty((len(t), len(gain)))
    for k in range(len(t)):
        found[k] = v
        holds = (v <= 0.0) & (command <= dry + stiction)
        rate = (motor * (command - dry) - v - drag * v**2) / settling
        v = np.where(holds, 0.0, np.maximum(v + STEP * rate, 0.0))
        error = TARGET - v
        passes = gain * np.sign(error) * np.maximum(np.abs(error) - dead, 0.0)
        command = np.clip(command + STEP / period * passes, 0.0, 255.0)
    place = np.minimum(log.t / STEP, len(t) - 2)
    low = place.astype(int)
    part = (place - low)[:, None]
    return ((1.0 - part) * found[low] + part * found[low + 1]).T


def _log(delay: int, wheel: str) -> Series:
    rows = pd.read_csv(Path(__file__).with_name("speed.csv"))
    rows = rows[rows["stated delay (ms)"] == delay]
    t = (rows["time (ms)"].to_numpy() - rows["time (ms)"].iloc[0]) * MS
    rpm = rows[f"{wheel} speed (rpm)"].to_numpy()
    return Series(t[t <= END], rpm[t <= END] * RPM, name=f"{wheel}, {delay} ms", unit="1/s")


def _compared(before: int, after: int, wheel: str, without: Collection[str] = ()) -> Diagnosis:
    listed = [each for each in CAUSES if f"{each.name}[after]" not in without]
    constants = [replace(each, cause=each.cause and f"{each.name}[after]" not in without)
                 for each in CONSTANTS]  # fmt: skip
    return diagnose_change(speed, _log(before, wheel), _log(after, wheel), constants, listed)


SETS = [
    Measured(f"loop, {before} to {after} ms, {wheel} wheel",
             Truth(("period[after]", "gain[after]")), partial(_compared, before, after, wheel))
    for before, after in ((1, 5), (1, 10)) for wheel in ("left", "right")
]  # fmt: skip
