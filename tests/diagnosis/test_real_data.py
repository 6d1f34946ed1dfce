"""A real measurement with a model of its own: a roller in fluid."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from documentation_blocks import blocks
from roller_table import table
from stickslip import Cause, Parameter, Prior, Table, diagnose_model, instruments

ROOT = Path(__file__).parents[2]
ROLLER_DATA = ROOT / "tests" / "data" / "roller_velocity.csv"
PAGE = ROOT / "docs" / "howto" / "roller.md"


def roller(table, p):
    """Speed k f until step-out, beyond which the mean rate falls; a coil's lag lowers that limit.

    The mean rate of an over-driven rotor is f - sqrt(f^2 - f_s^2) (Adler's equation).
    """
    f = table["frequency"]
    weaker = np.sqrt(1.0 + (2.0 * np.pi * f * p["coil_lag.time"]) ** 2)
    limit = 1.0 / np.maximum(p["step_out.period"], 1e-6) / weaker
    return p["k"] * (f - np.sqrt(np.maximum(f**2 - limit**2, 0.0)))


def rolled():
    """Medians of three neighbouring frequencies of each run, with the scatter between the runs."""
    data = pd.read_csv(ROLLER_DATA)
    data = data[data["frequency"] < 120]
    data["bin"] = data["frequency"] // 6
    full = data.groupby(["run", "bin"]).filter(lambda rows: len(rows) == 3)
    cells = full.groupby(["run", "bin"], as_index=False).median()
    away = cells["velocity"] - cells.groupby("bin")["velocity"].transform("mean")
    scatter = np.sqrt(np.sum(away**2) / (len(cells) - cells["bin"].nunique()))
    run = cells["run"].astype(int).astype(str).to_numpy()
    settings = {"frequency": cells["frequency"].to_numpy(), "run": run}
    return Table(settings, cells["velocity"], sd=float(scatter), run=run, unit="m/s")


@pytest.mark.nightly
def test_the_roller_steps_out():
    data = rolled()
    causes = [
        Cause("step_out", Parameter("step_out.period", unit="s", low=0.0, high=0.1, size=0.02)),
        Cause("coil_lag", Parameter("coil_lag.time", unit="s", low=0.0, high=0.05, size=5e-3)),
        instruments.offset("m/s", 2e-6),
        instruments.clipping("m/s", 1.1 * float(data.y.max()), 3e-5),
    ]
    k = Parameter("k", Prior("log-uniform", 5e-7, 1e-5), "m")
    result = diagnose_model(roller, data, [k], causes)
    # An instrument alone explains no fall of the speed, and a lag does nothing before step-out.
    assert result.findings.test.p_value < 1e-3
    kind, named = result.verdict.kind, result.verdict.causes
    assert kind in ("named", "dominant", "ambiguous", "pair", "unexplained")
    assert kind not in ("named", "dominant") or named == ("step_out",)
    assert kind != "pair" or "step_out" in named
    steps = result.candidate("step_out")
    assert 35.0 < 1.0 / steps.params.loc["step_out.period", "value"] < 80.0
    left, before = (
        float(np.sqrt(np.mean((made["reading"] - made["predicted"]) ** 2)))
        for made in (steps.prediction, result.candidate("none").prediction)
    )
    assert left < 0.7 * before


def test_the_page_on_the_roller_has_the_data():
    (shown,) = (each.text for each in blocks(PAGE) if each.text.startswith("# roller.csv"))
    assert shown == "# roller.csv\n" + table(ROLLER_DATA)
