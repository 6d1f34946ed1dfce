"""Real measurements, each with a model of its own: a roller in fluid and a tumbling robot."""

import csv
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq

from command_line import stickslip
from documentation_blocks import blocks
from roller_table import table
from stickslip import Cause, Parameter, Prior, Table, diagnose_model, instruments

ROOT = Path(__file__).parents[2]
ROLLER_DATA = ROOT / "tests" / "data" / "roller_velocity.csv"
ROLLER, TUMBLER = (ROOT / "docs" / "howto" / name for name in ("roller.md", "tumbler.md"))


def _story(name, page=TUMBLER):
    """A file of a page of the documentation."""
    (text,) = (each.text for each in blocks(page) if each.text.startswith(f"# {name}"))
    return text


def _columns(text):
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


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
    assert result.verdict.kind in ("named", "dominant", "ambiguous", "pair", "unexplained")
    if result.verdict.kind in ("named", "dominant"):
        assert result.verdict.causes == ("step_out",)
    if result.verdict.kind == "pair":
        assert "step_out" in result.verdict.causes
    steps = result.candidate("step_out")
    frequency = 1.0 / steps.params.loc["step_out.period", "value"]
    assert 35.0 < frequency < 80.0
    left, before = (
        float(np.sqrt(np.mean((made["reading"] - made["predicted"]) ** 2)))
        for made in (steps.prediction, result.candidate("none").prediction)
    )
    assert left < 0.7 * before


def test_the_page_on_the_roller_has_the_data():
    assert _story("roller.csv", ROLLER) == "# roller.csv\n" + table(ROLLER_DATA)


# The tumbler: two end caps and a bridge, nose-up about its rear edge.
LENGTH, WIDTH, HEIGHT = 800e-6, 400e-6, 100e-6  # m
MASS = WIDTH * HEIGHT * (0.5e-3 * 2750 + 0.3e-3 * 1200)  # kg
CAPS = 0.5e-3 * WIDTH * HEIGHT  # m^3, the magnetic part


def _tilt(bz, magnetization, angle):
    """Static nose-up tilt, rad: magnetic torque against weight about the rear edge."""

    def torque(tilt):
        magnetic = magnetization * CAPS * bz * np.cos(tilt + angle)
        return magnetic - MASS * 9.81 * 0.5 * (LENGTH * np.cos(tilt) - HEIGHT * np.sin(tilt))

    if torque(0.0) <= 0.0:
        return 0.0
    return brentq(torque, 0.0, np.pi / 2 + 0.5) if torque(np.pi / 2 + 0.5) < 0.0 else np.pi / 2


def tumbler(table, p):
    """Angles, nose-up negative."""
    pairs = zip(p["magnetization"][:, 0], p["misalignment.angle"][:, 0], strict=True)
    return np.array([[-_tilt(bz, *pair) for bz in table["Bz"]] for pair in pairs])


@pytest.mark.nightly
def test_the_tumbler_is_misaligned():
    data = _columns(_story("tumbler.csv"))
    # No repeats: reading an angle to 0.03 rad is assumed.
    angles = Table({"Bz": data["Bz"]}, data["theta"], sd=0.03, name="angle", unit="rad")
    magnet = Parameter("magnetization", Prior("log-normal", 1.5e4, 1.5), "A/m")
    turned = Parameter("misalignment.angle", unit="rad", size=0.2, low=-1.5, high=1.5)
    causes = [Cause("misalignment", turned), instruments.scale(name="angle_scale")]
    result = diagnose_model(tumbler, angles, [magnet], causes)
    assert result.findings.test.p_value < 1e-6
    # A wrong scale of the angles alone would leave 5 degrees.
    assert "misalignment" in result.verdict.causes or result.verdict.kind == "unexplained"
    assert result.verdict.causes[:1] != ("angle_scale",)
    left, before = (
        np.degrees(np.sqrt(np.mean((made["reading"] - made["predicted"]) ** 2)))
        for made in (result.candidate(name).prediction for name in ("misalignment", "none"))
    )
    assert left < 3.0 < before
    assert result.candidate("misalignment").gain.certain


@pytest.mark.nightly
def test_the_command_gives_the_tumbler_no_wrong_name(tmp_path):
    for name in ("tumbler.csv", "nominal.toml", "measurement.toml"):
        (tmp_path / name).write_text(_story(name).removeprefix("# tumbler.csv\n"))
    done = stickslip(
        "diagnose", tmp_path / "measurement.toml", "--out", tmp_path / "found", "--json"
    )
    assert done.returncode == 0, done.stderr
    report = json.loads((tmp_path / "found" / "report.json").read_text())
    assert report["verdict"] in ("named", "dominant", "pair", "ambiguous", "unexplained")
    if report["verdict"] != "unexplained":
        assert "misalignment" in report["cause"]
