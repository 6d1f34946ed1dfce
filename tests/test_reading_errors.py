"""What may be wrong with the readings of a measurement: suspects beside the simulator's effects."""

import numpy as np
import pandas as pd
import pytest

from films import write_films
from report_page import without_pictures
from stickslip import Measurement, Scenario, simulate_batch
from stickslip.diagnosis import measurement_problem
from stickslip.diagnosis.api import diagnose
from stickslip.diagnosis.model.effect_causes import library
from stickslip.diagnosis.observables.reading_errors import of_fields, of_velocities, read_by
from stickslip.diagnosis.observables.tracking.camera import Camera
from stickslip.diagnosis.observables.tracking.camera_errors import camera_suspects
from stickslip.errors import ScenarioError
from stickslip.measurement import Prior, read_measurement
from test_observables_angle import FIELDS, angles, write
from test_observables_field import probed
from test_observables_field import write as write_fields

VELOCITIES = np.array([1e-3, -2e-3, 3e-3])


def test_a_wild_reading_does_not_hide_a_limit():
    # All of 300 readings are cut off at 1.1, but for one that went wrong.
    readings = np.clip(1.4 * np.sin(np.arange(300.0)), -1.1, 1.1)
    readings[17] = 3.0
    limit = next(each for each in camera_suspects(readings) if each.name == "film_clipping")
    (parameter,) = limit.parameters
    assert parameter.high == pytest.approx(1.2 * 1.1)
    # A whole size below it, where the search begins, is near the limit.
    assert parameter.high - parameter.scale == pytest.approx(1.08 * 1.1)


def few_causes(monkeypatch, *names):
    """A diagnosis that tries only some of the simulator's effects, which is quicker."""
    monkeypatch.setattr(
        measurement_problem,
        "library",
        lambda *known: tuple(each for each in library(*known) if each.name in names),
    )


def test_an_offset_and_a_limit_act_on_velocities_one_after_the_other():
    offset, limit = of_velocities(VELOCITIES)
    names = ["drag.linear", offset.parameters[0].name, limit.parameters[0].name]
    asked = []

    def physics(known, parameters):
        asked.append((list(known), len(parameters)))
        return parameters[:, :1] * VELOCITIES

    values = np.array([[1.0, 0.0, 0.0], [1.0, 5e-4, 0.0], [1.0, 5e-4, 2.2e-3]])
    read = read_by((offset, limit), names, values, physics)
    assert read[0] == pytest.approx(VELOCITIES, rel=1e-15)
    assert read[1] == pytest.approx(VELOCITIES + 5e-4, rel=1e-15)
    assert read[2] == pytest.approx([1.5e-3, -1.5e-3, 2.2e-3], rel=1e-15)
    # Vectors that differ in what is read share the physics.
    assert asked == [(["drag.linear"], 1)]
    # Where nothing is asked of the instruments, nothing is wrong with them.
    assert read_by((offset, limit), names[:1], values[:1, :1], physics)[0] == pytest.approx(
        VELOCITIES
    )


def test_readings_that_are_all_zero_have_no_suspects():
    assert of_velocities(np.zeros(3)) == ()
    assert [each.name for each in of_fields(np.zeros((2, 3)))] == ["probe_turned"]


def test_a_turned_probe_reads_the_field_in_its_own_axes():
    turned, _ = of_fields(np.ones((1, 3)))
    names = [each.name for each in turned.parameters]
    fields = np.array([[[1e-3, 0.0, 0.0], [0.0, 2e-3, 0.0]]]).reshape(1, -1)
    quarter = np.array([[0.0, 0.0, 0.5 * np.pi]])
    read = read_by((turned,), names, quarter, lambda *_: fields).reshape(2, 3)
    # After a quarter turn about z the probe's x axis is the coils' y, and its y axis their -x;
    # rounding of the sines is 1e-16 of the field.
    assert read == pytest.approx(np.array([[0.0, -1e-3, 0.0], [2e-3, 0.0, 0.0]]), abs=1e-18)


def test_a_marker_moves_with_the_tilt_and_a_limit_cuts_angles_off():
    t = np.linspace(0.0, 0.1, 101)
    theta = 0.5 * np.sin(40.0 * t)
    motion = {
        "t": t, "x": 1e-3 * t, "z": np.full(101, 1e-4), "theta": theta, "vx": np.full(101, 1e-3),
        "vz": np.zeros(101), "omega": 20.0 * np.cos(40.0 * t),
    }  # fmt: skip
    camera = Camera(marker_along=2e-5, marker_across=5e-6, facing=-1.0, angle_limit=0.3)
    seen = camera.frames(motion, t, ("x", "z", "theta"))
    # In -x the front lies behind in x; nose-down, which is positive, lowers what is ahead.
    assert seen["x"] == pytest.approx(
        motion["x"] - 2e-5 * np.cos(theta) - 5e-6 * np.sin(theta), abs=1e-15
    )
    assert seen["z"] == pytest.approx(
        motion["z"] - 2e-5 * np.sin(theta) + 5e-6 * np.cos(theta), abs=1e-15
    )
    assert seen["theta"] == pytest.approx(np.clip(theta, -0.3, 0.3), abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_angles_with_a_wrong_scale_are_not_blamed_on_the_robot(tmp_path, seed):
    random = np.random.default_rng(seed)
    fields = np.repeat(FIELDS, 2, axis=0)
    true = angles({}, fields)
    theta = 1.15 * true + np.radians(1.0) * random.standard_normal(len(true))
    found = diagnose(read_measurement(write(tmp_path, zip(*fields.T, theta, strict=True))))
    assert "angle_scale" in found.verdict.causes
    assert found.verdict.fit.candidate.name == "angle_scale"
    row = found.params.loc["angle_scale.error"]
    assert abs(row["value"] - 0.15) < 3.0 * row["sd"] < 0.06
    # The robot does what the scenario says; the readings are no part of it.
    assert "angle_scale" not in found.extended.to_toml()
    found.save_report(tmp_path / "report")
    assert "Angles are read" in without_pictures(tmp_path / "report" / "report.html")


@pytest.mark.parametrize("seed", range(3))
def test_a_turned_probe_is_named_without_repeats(tmp_path, seed):
    rows = probed(seed=seed)
    c, s = np.cos(0.02), np.sin(0.02)
    rows[:, 8:] = rows[:, 8:] @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    found = diagnose(read_measurement(write_fields(tmp_path, rows)))
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("probe_turned",))
    # Along the axes of a probe that is turned by 0.02 rad about y: its x axis points down a little.
    row = found.params.loc["probe_turned.about_y"]
    assert abs(row["value"] - 0.02) < 3.0 * row["sd"] < 0.01


@pytest.mark.nightly
def test_velocities_with_a_wrong_zero_are_named_beside_a_slope(monkeypatch):
    few_causes(monkeypatch, "surface_tilt", "friction_anisotropy", "field_gain", "edge_time")
    base = Scenario().replace({"drive.base": 5e-4, "drive.pulses": 8})
    paces = (20.0, 30.0, 45.0, 65.0, 90.0, 120.0)
    drives = [
        {"mode": mode, "direction": way, "frequency": pace}
        for mode in ("IPP", "OPP") for way in ("+x", "-x") for pace in paces
    ]  # fmt: skip
    runs = simulate_batch(
        [base.replace({f"drive.{key}": each for key, each in row.items()}) for row in drives]
    )
    random = np.random.default_rng(3)
    rows = {key: [row[key] for row in drives for _ in range(3)] for key in drives[0]}
    rows["trial"] = [1, 2, 3] * len(drives)
    rows["velocity"] = [
        run.mean_velocity * (1.0 + 0.02 * random.standard_normal()) + 1.5e-4
        for run in runs for _ in range(3)
    ]  # fmt: skip
    known = {"contact.kinetic_friction": Prior("normal", 0.15, 0.01)}
    found = diagnose(Measurement.from_dataframe(pd.DataFrame(rows), base, uncertain=known))
    assert found.verdict.fit.candidate.name == "velocity_offset"
    row = found.params.loc["velocity_offset.shift"]
    assert abs(row["value"] - 1.5e-4) < 3.0 * row["sd"]
    # At new drives the readings are off too.
    predicted = found.predict([{"frequency": 50.0}])
    free = found.extended.replace({"drive.frequency": 50.0}).replace({"drive.pulses": 8})
    (run,) = simulate_batch([free])
    shift = float(predicted["extended"].iloc[0]) - run.mean_velocity
    assert shift == pytest.approx(row["value"], abs=0.1 * abs(row["value"]))


@pytest.mark.nightly
def test_a_marker_off_the_centre_of_mass_is_named(tmp_path, monkeypatch):
    few_causes(monkeypatch, "surface_tilt", "angle_offset", "length_scale")
    path = write_films(tmp_path, {}, 400.0, seed=2, marker=3e-5)
    found = diagnose(read_measurement(path))
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("marker_place",))
    row = found.params.loc["marker_place.along"]
    assert abs(row["value"] - 3e-5) < 3.0 * row["sd"] < 1.5e-5


def test_a_limit_is_searched_below_the_widest_of_several_tables(tmp_path):
    fields = np.repeat(FIELDS, 2, axis=0)
    theta = angles({}, fields)
    path = write(tmp_path, zip(*fields.T, theta, strict=True))
    few = np.abs(theta) < 0.5 * np.max(np.abs(theta))
    rows = [
        f"{bx!r},{bz!r},{each!r}" for (bx, bz), each in zip(fields[few], theta[few], strict=True)
    ]
    (tmp_path / "flat.csv").write_text("\n".join(["Bx,Bz,theta", *rows]) + "\n")
    text = path.read_text()
    ends = []
    for more in (("flat.csv", "angle.csv"), ("angle.csv", "flat.csv")):
        tables = "".join(f'\n[[angle]]\nfile = "{file}"\n' for file in more)
        path.write_text(text.partition("[[angle]]")[0] + tables)
        found = diagnose(read_measurement(path)).findings
        causes = {each.name: each for each in found.problem.causes}
        ends.append(causes["angle_clipping"].parameters[0].high)
    assert ends[0] == ends[1] > np.max(np.abs(theta))


def test_a_drive_that_turns_the_robot_is_refused():
    turned = Scenario().replace({"drive.heading": 1.0})
    rows = pd.DataFrame({"frequency": [20.0, 40.0], "velocity": [1e-3, 2e-3]})
    data = Measurement.from_dataframe(rows, turned, uncertain={})
    with pytest.raises(ScenarioError, match=r"drive\.heading = 1 .* walk along x"):
        diagnose(data)
