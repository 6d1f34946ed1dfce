"""Speeds of rolling micro-robots, diagnosed with a model of one's own: `docs/howto/roller.md`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stickslip import (
    Cause,
    CauseParameter,
    Diagnosis,
    Prior,
    Uncertain,
    diagnose_model,
    instruments,
)

_BIN = 6.0
"""Hz. Chosen: three readings, which are 2 Hz apart, make one median."""


def roller(f: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """Speeds, m/s, at frequencies of the field (Hz). Columns: k (m), 1 / f_s (s) and lag (s).

    Beyond the step-out frequency f_s the mean rate is f - sqrt(f^2 - f_s^2) (Adler's equation); the
    lag of a coil weakens the field and lowers that limit.
    """
    k, period, lag = (column[:, None] for column in parameters.T)
    limit = 1.0 / np.maximum(period, 1e-6) / np.sqrt(1.0 + (2 * np.pi * f * lag) ** 2)
    return k * (f - np.sqrt(np.maximum(f**2 - limit**2, 0.0)))


def diagnose_rollers(path: Path) -> Diagnosis:
    """The medians of each run in bins of `_BIN`; whole runs are held out."""
    import pandas as pd

    table = pd.read_csv(path)
    table["bin"] = table["frequency"] // _BIN
    full = table.groupby(["bin", "run"]).filter(lambda rows: len(rows) == 3)
    cells = full.groupby(["bin", "run"], as_index=False).median()
    velocity = cells["velocity"].to_numpy()
    middle = cells.groupby("bin")["velocity"].transform("mean").to_numpy()
    # No condition was repeated within a run: how far runs differ serves as the error of a speed.
    free = len(velocity) - cells["bin"].nunique()
    scatter = float(np.sqrt(np.sum((velocity - middle) ** 2) / free))
    k = Uncertain("k", Prior("log-uniform", 5e-7, 1e-5), "m")
    period = CauseParameter("step_out.period", "s", 0.0, 0.1, 0.02)
    lag = CauseParameter("coil_lag.time", "s", 0.0, 0.05, 1e-3)
    meters = (
        instruments.offset("m/s", 2e-6),
        instruments.clipping("m/s", 1.1 * float(velocity.max()), 3e-5),
    )
    return diagnose_model(
        instruments.with_instruments(roller, meters),
        cells["frequency"].to_numpy(),
        velocity,
        [k],
        [Cause("step_out", (period,)), Cause("coil_lag", (lag,)), *meters],
        sd=np.full(len(velocity), scatter),
        group=cells["run"].to_numpy(int),
    )
