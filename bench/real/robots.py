"""Measured micro-robots: rollers and a tumbler."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

import numpy as np

import stickslip
from stickslip import Cause, Diagnosis, Parameter, Prior, Table, diagnose_model, instruments

from .score import Truth, with_absent

EXAMPLES = Path(__file__).parents[2] / "examples"
TUMBLER_CASE = EXAMPLES / "cases" / "tumbler" / "measurement.toml"

TUMBLER = Truth(("misalignment",), ("angle_offset", "surface_tilt", "ambient_field"), certain=False)
"""A moment along the body cannot rest near 55 degrees."""
WALK = Truth(("friction_anisotropy",), values={"effects.friction_anisotropy.fraction": (0.15, 0.0)})
"""That of the README, of simulated velocities."""
ROLLERS = Truth(("step_out",), ("coil_lag", "offset"), certain=False)
"""Every run peaks at 48 to 66 Hz as a rotor that steps out."""

_BIN = 6.0
"""Hz. Chosen: three readings, which are 2 Hz apart, make one median."""
_STEP_OUT = Cause("step_out", Parameter("step_out.period", unit="s", low=0.0, high=0.1, size=0.02))
_COIL_LAG = Cause("coil_lag", Parameter("coil_lag.time", unit="s", low=0.0, high=0.05, size=1e-3))


def diagnose_files(path: Path, parameter: str, without: Collection[str] = ()) -> Diagnosis:
    """The diagnosis of a measurement's file with the simulator and its library of causes.

    An extension that is part of the scenario is no cause: one that is left out is there, with a
    billionth of its parameter.
    """
    measured = stickslip.read_measurement(path)
    none = {f"effects.{each}.{parameter}": 1e-9 for each in without}
    return stickslip.diagnose(
        replace(measured, scenario=measured.scenario.replace(none)), threads=1
    )


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


def diagnose_rollers(path: Path, without: Collection[str] = ()) -> Diagnosis:
    """The medians of each run in bins of `_BIN`; whole runs are held out."""
    import pandas as pd

    table = pd.read_csv(path)
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
