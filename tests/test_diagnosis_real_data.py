"""Real measurements, each with a model of its own: a roller in fluid and a tumbling robot."""

import csv
import json
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from command_line import stickslip
from documentation_blocks import blocks
from roller_table import table
from stickslip.diagnosis import Cause, CauseParameter, Prior, Uncertain, diagnose_model

ROLLER_DATA = Path(__file__).parent / "data" / "roller_velocity.csv"
HOWTO = Path(__file__).parents[1] / "docs" / "howto"
ROLLER, TUMBLER = HOWTO / "roller.md", HOWTO / "tumbler.md"


def _story(name, page=TUMBLER):
    """A file of a page of the documentation."""
    (text,) = (each.text for each in blocks(page) if each.text.startswith(f"# {name}"))
    return text


def _columns(text):
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def roller(frequency, parameters):
    """Speed k f until step-out, beyond which the mean rate falls; a coil's lag lowers that limit.

    Columns: k (m), 1/step-out frequency (s), lag time (s). The mean rate of an over-driven rotor is
    f - sqrt(f^2 - f_s^2) (Adler's equation).
    """
    k, inverse, lag = (column[:, None] for column in parameters.T)
    with np.errstate(divide="ignore"):
        limit = 1.0 / inverse / np.sqrt(1.0 + (2 * np.pi * frequency * lag) ** 2)
        over = np.where(np.isinf(limit), 0.0, np.maximum(frequency**2 - limit**2, 0.0))
    return k * (frequency - np.sqrt(over))


def test_the_roller_steps_out():
    data = _columns(ROLLER_DATA.read_text())
    # Conditions are bins of 6 Hz; the runs are set-ups, each with its own speed.
    bins = (data["frequency"] // 6).astype(int)
    kept = data["frequency"] < 120
    number = {old: new for new, old in enumerate(np.unique(bins[kept]))}
    index = np.array([number[each] for each in bins[kept]])
    count = np.bincount(index)
    middle = np.bincount(index, data["frequency"][kept]) / count
    found = diagnose_model(
        roller,
        middle,
        data["velocity"][kept],
        [Uncertain("k", Prior("log-uniform", 5e-7, 1e-5), "m")],
        [
            Cause("step_out", (CauseParameter("step_out.period", "s", 0.0, 0.1, 0.02),)),
            Cause("coil_lag", (CauseParameter("coil_lag.time", "s", 0.0, 0.05, 5e-3),)),
        ],
        condition=index,
        block=data["run"][kept].astype(int),
    ).findings
    assert found.detection.p_value < 1e-3
    step_out = next(fit for fit in found.ranking.singles if fit.name == "step_out")
    assert found.ranking.singles[0] is step_out
    frequency = 1.0 / found.problem.physical(step_out.x[None, :])[0, 1]
    assert 35.0 < frequency < 80.0
    null = np.sqrt(np.mean((found.problem.observed - _level(found, found.null)) ** 2))
    after = np.sqrt(np.mean((found.problem.observed - _level(found, step_out)) ** 2))
    assert after < 0.5 * null


def _level(found, fit):
    return found.problem.predicted(fit.x[None, :])[0]


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


def tumbler(fields, parameters):
    """Angles (nose-up negative) for columns magnetization (A/m) and misalignment (rad)."""
    return np.array([[-_tilt(bz, *row) for bz in fields] for row in parameters])


def test_the_tumbler_is_misaligned():
    data = _columns(_story("tumbler.csv"))
    # No repeats: reading an angle to 0.03 rad is assumed.
    found = diagnose_model(
        tumbler,
        data["Bz"],
        data["theta"],
        [Uncertain("magnetization", Prior("log-normal", 1.5e4, 1.5), "A/m")],
        [Cause("misalignment", (CauseParameter("misalignment.angle", "rad", -1.5, 1.5, 0.2),))],
        sd=np.full(len(data["Bz"]), 0.03),
    ).findings
    assert found.ranking.singles[0].name == "misalignment"
    error = found.problem.observed - _level(found, found.ranking.singles[0])
    before = found.problem.observed - _level(found, found.null)
    degrees = np.degrees(np.sqrt(np.mean(error**2)))
    assert degrees < 3.0 < np.degrees(np.sqrt(np.mean(before**2)))
    assert found.gain.mae_after < found.gain.mae_before


def test_the_command_finds_that_the_tumbler_is_misaligned(tmp_path):
    for name in ("tumbler.csv", "nominal.toml", "measurement.toml"):
        (tmp_path / name).write_text(_story(name).removeprefix("# tumbler.csv\n"))
    done = stickslip(
        "diagnose", tmp_path / "measurement.toml", "--out", tmp_path / "found", "--json"
    )
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["p_value"] < 1e-6
    causes = said["cause"] if isinstance(said["cause"], list) else [said["cause"]]
    assert "misalignment" in causes
    # What cannot be told from static angles of one table has at most a place beside it.
    assert set(causes) <= {"misalignment", "angle_offset", "surface_tilt", "ambient_field"}
    report = json.loads((tmp_path / "found" / "report.json").read_text())
    (table,) = report["channels"].values()
    # The pilot's balance: 36.6 degrees without a misalignment, about 2 with one.
    assert 30.0 < np.degrees(table["rms_recalibrated"]) < 45.0
    assert np.degrees(table["rms_extended"]) < 2.5
    gain = said["gain"]
    assert gain["n"] == 5
    assert np.degrees(gain["mae_after"]) < 3.0 < 20.0 < np.degrees(gain["mae_before"])
    assert gain["interval"][0] > 0.0
    assert report["gain_unit"] == "rad"
    page = (tmp_path / "found" / "report.html").read_text()
    assert "mean absolute error (degrees)" in page
    assert "No angle was read without field" in page
