"""``stickslip diagnose`` on data that the simulator made, from file to report."""

import json
import os
import re
import signal
import subprocess

import numpy as np
import pytest

from command_line import COMMAND, stickslip
from made_measurement import write
from report_page import without_pictures
from stickslip import Scenario
from stickslip.cli.commands import stickslip as commands
from stickslip.diagnosis.library import library
from stickslip.diagnosis.simulator import Simulator
from stickslip.extensions import effects

KEYS = {
    "verdict", "cause", "parameters", "probabilities", "p_value", "bounds", "gain",
    "next_experiments", "left_out", "seed", "version",
}  # fmt: skip


def test_the_tilt_is_found(tilted):
    _, said = tilted
    assert set(said) == KEYS
    assert said["verdict"] in ("named", "ambiguous")
    assert "surface_tilt" in said["cause"]
    assert said["p_value"] < 1e-3
    angle = said["parameters"]["surface_tilt.angle"]
    assert angle["unit"] == "rad"
    assert abs(angle["value"] - 0.04) < max(4 * angle["sd"], 0.008)


def test_the_gain_is_in_si_units(tilted):
    gain = tilted[1]["gain"]
    assert set(gain) == {
        "n", "heldout_chi2_before", "heldout_chi2_after", "mae_before", "mae_after", "interval",
    }  # fmt: skip
    assert gain["heldout_chi2_after"] < gain["heldout_chi2_before"]
    assert gain["mae_after"] < gain["mae_before"] < 1e-3


def test_probabilities_are_over_all_causes(tilted):
    chance = tilted[1]["probabilities"]
    assert {each.name for each in effects()} <= set(chance)
    assert {"none", "unknown", "contact.kinetic_friction"} <= set(chance)
    assert sum(chance.values()) == pytest.approx(1.0)


def test_the_next_experiment_is_a_drive_that_simulates(tilted):
    folder, said = tilted
    assert said["next_experiments"]
    for each in said["next_experiments"]:
        keys = {f"drive.{name}": value for name, value in each["drive"].items()}
        Scenario.from_toml(folder / "nominal.toml").replace(keys)
        assert len(each["predictions"]) >= 2


def test_the_extended_model_is_an_ordinary_scenario(tilted):
    folder, said = tilted
    extended = folder / "found" / "extended.toml"
    scenario = Scenario.from_toml(extended)
    assert scenario.effects
    for name, parameters in scenario.effects.items():
        for parameter, value in parameters.items():
            said_value = said["parameters"][f"{name}.{parameter}"]["value"]
            assert value == pytest.approx(said_value, rel=1e-9)
    assert stickslip("run", extended, "--json").returncode == 0


def test_the_report_needs_no_other_file(tilted):
    folder, said = tilted
    page = without_pictures(folder / "found" / "report.html")
    assert "surface_tilt" in page
    assert "data:image/png;" in page
    assert "http" not in page
    full = json.loads((folder / "found" / "report.json").read_text())
    assert set(full) >= KEYS
    assert full["verdict"] == said["verdict"]
    assert len(full["conditions"]) == 8


def test_predictions_do_not_depend_on_threads():
    drive = [{"drive.frequency": f, "drive.pulses": 5} for f in (30.0, 60.0)]
    values = np.array([[0.14], [0.15], [0.16]])
    one, three = (
        Simulator(Scenario(), ["contact.kinetic_friction"], threads)(drive, values)
        for threads in (1, 3)
    )
    assert np.array_equal(one, three)


def test_nothing_is_found_where_nothing_is(tmp_path):
    done = stickslip("diagnose", write(tmp_path, {}), "--json", "--seed", 3)
    said = json.loads(done.stdout)
    assert said["seed"] == 3
    assert said["verdict"] == "none"
    assert said["cause"] is None
    assert 0.0 < said["bounds"]["surface_tilt.angle"] < 0.1


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("velocity.csv", "absent.csv", "absent.csv"),
        ("sd = 0.01", "sd = -1", "above 0"),
        ('scenario = "nominal.toml"', "", "scenario"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_two(tmp_path, old, new, said):
    path = write(tmp_path, {})
    path.write_text(path.read_text().replace(old, new))
    done = stickslip("diagnose", path, "--out", tmp_path / "found")
    assert done.returncode == 2
    assert done.stdout == ""
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "found").exists()


def test_an_interrupt_is_one_line_and_leaves_nothing(tmp_path):
    path = write(tmp_path, {"effects.surface_tilt.angle": 0.04})
    out = tmp_path / "found"
    process = subprocess.Popen(
        [*COMMAND, "diagnose", str(path), "--out", str(out), "--jobs", "1"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    seen = b""
    while b"%" not in seen:
        seen += os.read(process.stderr.fileno(), 64)
        assert process.poll() is None, "the diagnosis ended before its bar appeared"
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=20)
    assert (process.returncode, output) == (130, b"")
    assert re.search(rb"stickslip: interrupted at the stage '[a-z ]+', nothing written\n$", errors)
    assert not out.exists()


def test_the_command_is_listed_with_an_example():
    assert "diagnose" in commands.list_commands(None)
    assert "Example:" in stickslip("diagnose", "--help").stdout


def test_every_extension_is_a_cause_that_starts_absent():
    causes = library(Scenario(), {}, 20.0)
    assert [each.name for each in causes] == [each.name for each in effects()]
    parameters = [each for cause in causes for each in cause.parameters]
    names = [each.name for each in parameters]
    absent = np.array([[float(each.value(np.zeros(1))[0]) for each in parameters]])
    drive = [{"drive.frequency": 50.0, "drive.pulses": 5, "drive.base": 0.5e-3}]
    plain = Simulator(Scenario(), [])(drive, np.zeros((1, 0)))
    assert Simulator(Scenario(), names)(drive, absent) == plain


def test_the_answer_does_not_depend_on_the_number_of_jobs(tilted):
    folder, said = tilted
    done = stickslip("diagnose", folder / "m.toml", "--json", "--jobs", 1)
    assert json.loads(done.stdout) == said


def _scaled(folder, factor):
    path = write(folder, {})
    table = folder / "velocity.csv"
    header, *rows = table.read_text().splitlines()
    cells = [row.rsplit(",", 1) for row in rows]
    table.write_text(
        "\n".join([header, *(f"{rest},{float(value) * factor!r}" for rest, value in cells)]) + "\n"
    )
    return path


@pytest.mark.parametrize(
    ("factor", "words"), [(1e-3, "wrong by 1000"), (300.0, "times what"), (-1.0, "opposite sign")]
)
def test_a_column_in_a_wrong_unit_or_of_a_wrong_sign_is_said_to_be(tmp_path, factor, words):
    done = stickslip("diagnose", _scaled(tmp_path, factor), "--json", "--out", tmp_path / "found")
    said = json.loads(done.stdout)
    assert said["verdict"] == "data-problem"
    assert said["cause"] is None
    assert words in json.loads((tmp_path / "found" / "report.json").read_text())["headline"]


def _dirty(folder, change):
    path = write(folder, {})
    table = folder / "velocity.csv"
    header, *rows = table.read_text().splitlines()
    table.write_text("\n".join(change([header, *rows])) + "\n")
    return path


def _all_zero(lines):
    return [lines[0], *(row.rsplit(",", 1)[0] + ",0.0" for row in lines[1:])]


def _absurd(lines):
    rest, value = lines[5].rsplit(",", 1)
    return [*lines[:5], f"{rest},{40 * float(value)!r}", *lines[6:]]


def _drifting(lines):
    # Each of three rounds over all conditions is a fifth faster than the one before.
    rows = []
    for number, row in enumerate(lines[1:]):
        rest, value = row.rsplit(",", 1)
        place = int(rest.split(",")[2]) * 8 + number // 3
        rows.append(f"{rest},{float(value) * (1 + 0.01 * place)!r},{place}")
    return [lines[0] + ",order", *rows]


@pytest.mark.parametrize(
    ("change", "verdicts", "words"),
    [
        (lambda lines: [lines[0], *reversed(lines[1:])], ("none",), ""),
        (lambda lines: [*lines[:4], lines[4].rsplit(",", 1)[0] + ",nan", *lines[5:]], ("none",),
         "is no number"),
        (_absurd, ("none",), "others of its condition"),
        (lambda lines: [lines[0], *lines[1::3]], ("data-problem",), "repeats"),
        (lambda lines: lines[:4], ("data-problem",), "too few"),
        (_all_zero, ("data-problem",), "zero"),
        (_drifting, ("data-problem",), "drift"),
    ],
    ids=["out of order", "nan", "outlier", "no repeats", "one condition", "all zero", "drift"],
)  # fmt: skip
def test_dirty_tables_end_in_a_sound_verdict(tmp_path, change, verdicts, words):
    path = _dirty(tmp_path, change)
    done = stickslip("diagnose", path, "--out", tmp_path / "found", "--seed", 3)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split(":")[0] in verdicts, done.stdout
    assert words in done.stdout
    assert "Traceback" not in done.stderr
    assert (tmp_path / "found" / "report.html").is_file()


def test_single_trials_are_judged_by_the_stated_error(tmp_path):
    path = _dirty(tmp_path, lambda lines: [lines[0], *lines[1::3]])
    path.write_text(path.read_text() + "velocity_sd = 0.02\n")
    said = json.loads(stickslip("diagnose", path, "--json").stdout)
    assert said["verdict"] == "none"
