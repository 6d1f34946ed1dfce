"""``stickslip diagnose`` on data that the simulator made, from file to report."""

import json
import math

import pytest

from command_line import stickslip
from made_measurement import few_causes, write
from report_page import without_pictures
from stickslip import load, predict, simulate

FEW = ("surface_tilt", "field_gain")
TILT = {"effects.surface_tilt.angle": 0.04}


@pytest.fixture(scope="module", autouse=True)
def _few_causes():
    with pytest.MonkeyPatch.context() as patch:
        few_causes(patch, FEW)
        yield


def diagnosed(folder, changes=None, change=None, more="", *options):
    """The finished command on a measurement, the JSON of ``--json``, and the report."""
    path = write(folder, changes or {}, change=change)
    path.write_text(path.read_text() + more)
    done = stickslip("diagnose", path, "--out", folder / "found", "--json", "--seed", 3, *options)
    assert done.returncode == 0, done.stderr
    report = json.loads((folder / "found" / "report.json").read_text())
    return done, json.loads(done.stdout), report


@pytest.fixture(scope="module")
def tilted(tmp_path_factory):
    """The folder of a diagnosis of a surface that tilts by 0.04 rad, what was said, the report."""
    folder = tmp_path_factory.mktemp("tilted")
    return folder, *diagnosed(folder, TILT, None, "", "--threads", 2)[1:]


def test_the_tilt_is_found(tilted):
    folder, said, report = tilted
    assert said["verdict"] in ("named", "ambiguous")
    assert "surface_tilt" in said["cause"]
    assert said["p_value"] < 1e-3
    angle = said["parameters"]["surface_tilt.angle"]
    assert angle["unit"] == "rad"
    assert angle["low"] < angle["value"] < angle["high"]
    assert abs(angle["value"] - 0.04) < max(4 * angle["sd"], 0.008)
    gain, chance = said["gain"], said["probabilities"]
    assert gain["mae_after"]["velocity"] < gain["mae_before"]["velocity"] < 1e-3
    assert {*FEW, "none", "contact.kinetic_friction"} <= set(chance)
    assert min(chance.values()) >= 0.0
    assert chance["surface_tilt"] == max(chance.values()) <= 1.0
    assert {key: each for key, each in report.items() if key != "origin"} == said
    assert len(report["conditions"]) == 8
    page = without_pictures(folder / "found" / "report.html")
    assert "surface_tilt" in page
    assert "http" not in page


def test_the_extended_model_is_an_ordinary_scenario(tilted):
    folder, said, _ = tilted
    extended = folder / "found" / "extended.toml"
    scenario = load(extended)
    assert scenario.effects
    for name, parameters in scenario.effects.items():
        for parameter, value in parameters.items():
            said_value = said["parameters"][f"{name}.{parameter}"]["value"]
            assert value == pytest.approx(said_value, rel=1e-9)
    assert stickslip("run", extended, "--json").returncode == 0


def test_predictions_take_what_a_diagnosis_leaves(tilted):
    folder, said, _ = tilted
    extended = load(folder / "found" / "extended.toml")
    keys = extended.uncertain.keys
    causes = [f"effects.{name}.{each}" for name, own in extended.effects.items() for each in own]
    assert {"contact.kinetic_friction", "drag.linear", *causes} <= set(keys)
    for cause in causes:
        place = keys.index(cause)
        sd = math.sqrt(extended.uncertain.matrix[place][place])
        # The error that is printed, of the profile, is no smaller than that of the curvature.
        assert 0.0 < sd <= said["parameters"][cause.removeprefix("effects.")]["sd"] * (1.0 + 1e-9)
    options = ("--uncertain", "found/extended.toml", "--vary", "drive.frequency=25,90")
    done = stickslip("predict", "nominal.toml", *options, "--draws", 20, "--json", cwd=folder)
    assert done.returncode == 0
    given = predict(extended, {"drive.frequency": [25.0, 90.0]}, draws=20)
    for row, velocities in zip(
        json.loads(done.stdout)["results"], given["mean_velocity"].values, strict=True
    ):
        # The file of the diagnosis has all of the nominal scenario's values besides.
        assert row["mean_velocity"] == velocities.tolist()
        assert row["mean_velocity"][0] < row["mean_velocity"][2]


@pytest.mark.nightly
def test_conditions_without_motion_are_not_a_finding(tmp_path):
    # A pulse of 0.1 mT above the base moves the model by less than a micrometre a second, which
    # would be many errors if readings of zero were taken for the noise.
    def with_still(lines):
        still = [("+x", 60), ("+x", 90), ("-x", 60), ("-x", 90)]
        more = [f"{way},{f},{trial},0.0,0.6e-3" for way, f in still for trial in range(3)]
        return [f"{lines[0]},peak", *(f"{row},2.5e-3" for row in lines[1:]), *more]

    _, said, _ = diagnosed(tmp_path, change=with_still)
    little = {"drive.peak": 0.6e-3, "drive.frequency": 90.0}
    creep = simulate(load(tmp_path / "nominal.toml").replace(little)).mean_velocity
    assert 0.0 < abs(creep) < 1e-6
    assert (said["verdict"], said["left_out"]) == ("none", [])


def unread(lines):
    """Two trials of one condition are marked as gaps."""
    rows = (each.rsplit(",", 1)[0] for each in lines[1:3])
    return [lines[0], *(f"{rest},ERR" for rest in rows), *lines[3:]]


def drifting(lines):
    # Each reading is 2 % of the first faster than the one before.
    rows = []
    for number, row in enumerate(lines[1:]):
        rest, value = row.rsplit(",", 1)
        place = int(rest.split(",")[2]) * 8 + number // 3
        rows.append(f"{rest},{float(value) * (1 + 0.02 * place)!r},{place}")
    return [lines[0] + ",order", *rows]


@pytest.mark.parametrize(
    ("change", "said"),
    [(lambda lines: [lines[0], *lines[1::3]], "The error of a reading is not known"),
     (drifting, "The velocities drift with the order")], ids=["no repeats", "drift"],
)  # fmt: skip
@pytest.mark.daily("no repeats")
def test_data_that_allow_no_diagnosis_are_told_with_the_reason(tmp_path, change, said):
    path, out = write(tmp_path, {}, change=change), tmp_path / "found"
    done = stickslip("diagnose", path, "--out", out)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Verdict: data-problem" in done.stdout
    report = json.loads((out / "report.json").read_text())
    (reason,) = report["reasons"]
    assert said in reason
    assert reason in done.stdout
    assert report["headline"].endswith(reason)
    assert report["cause"] is None
    # Nothing was learnt.
    assert not load(out / "extended.toml").effects
    assert (out / "report.html").is_file()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda lines: [lines[0], *(each.replace("+x", "+X") for each in lines[:0:-1])], None),
        (unread, 'velocity.csv lines 2, 3: velocity "ERR"'),
    ],
    ids=["out of order, capitals", "not read"],
)
@pytest.mark.daily("not read")
def test_tables_with_invalid_rows_give_the_right_verdict(tmp_path, change, said):
    done, told, report = diagnosed(tmp_path, change=change)
    assert (told["verdict"], told["cause"], told["seed"]) == ("none", None, 3)
    assert 0.0 < told["bounds"]["surface_tilt.angle"]["value"] < 0.1
    # What reading leaves out is said before the minutes of a diagnosis.
    lines = [line for line in done.stderr.splitlines() if line.startswith("stickslip: velocity")]
    assert lines == [f"stickslip: {each}" for each in (*report["gaps"], *report["left_out"])]
    assert len(lines) == (0 if said is None else 2)
    assert said is None or said in lines[-1]


@pytest.mark.nightly
def test_single_trials_are_judged_by_the_stated_error(tmp_path):
    _, said, _ = diagnosed(
        tmp_path, None, lambda lines: [lines[0], *lines[1::3]], "velocity_sd = 0.02\n"
    )
    assert said["verdict"] == "none"
