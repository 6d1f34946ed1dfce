"""Rollers of some micrometres in a rotating field: speed over its frequency, in eight runs.

Every run peaks at 48 to 66 Hz, as a rotor does that steps out; that can be said from the same data
alone, so a claim is at best not contradicted (tracking workbooks of
`MaxSokolich/AutoSpeedVsFrequencyRecorder`, 06e4580; frequency in Hz, velocity in m/s).
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np
import pandas as pd
from real.sets import Measured, Truth, with_absent

from stickslip import Cause, Diagnosis, Parameter, Prior, Table, diagnose_model, instruments

LOG = Path(__file__).parents[4] / "tests" / "data" / "roller_velocity.csv"

_BIN = 6.0
"""Hz. Chosen: three readings, which are 2 Hz apart, make one median."""
_STEP_OUT = Cause("step_out", Parameter("step_out.period", unit="s", low=0.0, high=0.1, size=0.02))
_COIL_LAG = Cause("coil_lag", Parameter("coil_lag.time", unit="s", low=0.0, high=0.05, size=1e-3))


def roller(table: Table, p: dict[str, np.ndarray]) -> np.ndarray:
    """Speeds, m/s: k (m) times the mean rate of a rotor in a field of frequency f (Hz).

    Beyond the step-out frequency f_s the mean rate is f - sqrt(f^2 - f_s^2) (Adler's equation); the
    lag of a coil weakens the field and lowers that limit.
    """
    p = with_absent(p, (_STEP_OUT, _COIL_LAG))
    f = table["frequency"]
    weaker = np.sqrt(1.0 + (2 * np.pi * f * p["coil_lag.time"]) ** 2)
    limit = 1.0 / np.maximum(p["step_out.period"], 1e-6) / weaker
    return p["k"] * (f - np.sqrt(np.maximum(f**2 - limit**2, 0.0)))


def diagnosed(without: Collection[str] = ()) -> Diagnosis:
    """The medians of each run in bins of `_BIN`; whole runs are held out."""
    table = pd.read_csv(LOG)
    table["bin"] = table["frequency"] // _BIN
    full = table.groupby(["run", "bin"]).filter(lambda rows: len(rows) == 3)
    cells = full.groupby(["run", "bin"], as_index=False).median()
    velocity = cells["velocity"].to_numpy()
    middle = cells.groupby("bin")["velocity"].transform("mean").to_numpy()
    # No condition was repeated within a run: how far runs differ serves as the error of a speed.
    free = len(velocity) - cells["bin"].nunique()
    scatter = float(np.sqrt(np.sum((velocity - middle) ** 2) / free))
    # As a text: no speed changes smoothly from one run to the next.
    runs = cells["run"].astype(int).astype(str).to_numpy()
    data = Table(
        {"frequency": cells["frequency"].to_numpy(), "run": runs},
        velocity, sd=scatter, run=runs, unit="m/s",
    )  # fmt: skip
    k = Parameter("k", Prior("log-uniform", 5e-7, 1e-5), "m")
    meters = (
        instruments.offset("m/s", 2e-6),
        instruments.clipping("m/s", 1.1 * float(velocity.max()), 3e-5),
    )
    listed = [each for each in (_STEP_OUT, _COIL_LAG, *meters) if each.name not in without]
    return diagnose_model(roller, data, [k], listed)


SETS = [
    Measured("rollers",
             Truth(("step_out",), ("coil_lag", "offset")), diagnosed)
]  # fmt: skip
