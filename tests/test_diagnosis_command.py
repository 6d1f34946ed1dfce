"""``stickslip diagnose`` on data that the simulator made, from file to report."""

import json
import re
from types import SimpleNamespace

import pytest

from command_line import ended_at_the_bar, stickslip
from made_measurement import write
from report_page import without_pictures
from stickslip import Scenario, simulate
from stickslip._util.atomic_files import NotWritten
from stickslip.cli import diagnose_command
from stickslip.cli.commands import stickslip as commands
from stickslip.diagnosis import measured
from stickslip.diagnosis.terms.library import library

KEYS = {
    "verdict", "cause", "parameters", "probabilities", "p_value", "share", "gain", "bounds",
    "next_experiments", "left_out", "notes", "seed", "version",
}  # fmt: skip
FEW = ("surface_tilt", "friction_anisotropy", "field_gain")


@pytest.fixture(scope="module", autouse=True)
def _few_causes():
    """Diagnoses in this process try some of the effects and no law, which is quicker."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            measured, "library", lambda *known: tuple(c for c in library(*known) if c.name in FEW)
        )
        patch.setattr(measured, "_laws", lambda *_: ())
        yield


@pytest.fixture(scope="module")
def tilted(tmp_path_factory):
    """The folder of a diagnosis of a surface that tilts by 0.04 rad, and what ``--json`` said."""
    folder = tmp_path_factory.mktemp("tilted")
    path = write(folder, {"effects.surface_tilt.angle": 0.04})
    done = stickslip("diagnose", path, "--out", folder / "found", "--json", "--threads", 2)
    assert done.returncode == 0, done.stderr
    return folder, json.loads(done.stdout)


def test_the_tilt_is_found(tilted):
    _, said = tilted
    assert set(said) >= KEYS
    assert said["verdict"] in ("named", "ambiguous")
    assert "surface_tilt" in said["cause"]
    assert said["p_value"] < 1e-3
    angle = said["parameters"]["surface_tilt.angle"]
    assert angle["unit"] == "rad"
    assert angle["low"] < angle["value"] < angle["high"]
    assert abs(angle["value"] - 0.04) < max(4 * angle["sd"], 0.008)


def test_the_gain_is_in_si_units(tilted):
    gain = tilted[1]["gain"]
    assert gain["mae_after"]["velocity"] < gain["mae_before"]["velocity"] < 1e-3


def test_probabilities_are_over_all_causes(tilted):
    chance = tilted[1]["probabilities"]
    assert {*FEW, "none", "contact.kinetic_friction"} <= set(chance)
    assert all(0.0 <= each <= 1.0 for each in chance.values())
    assert chance["surface_tilt"] == max(chance.values())


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
    assert "a tilted surface" in page
    assert "http" not in page
    full = json.loads((folder / "found" / "report.json").read_text())
    assert {key: each for key, each in full.items() if key != "origin"} == said
    assert len(full["conditions"]) == 8


def test_nothing_is_found_where_nothing_is(tmp_path):
    done = stickslip("diagnose", write(tmp_path, {}), "--json", "--seed", 3)
    said = json.loads(done.stdout)
    assert said["seed"] == 3
    assert said["verdict"] == "none"
    assert said["cause"] is None
    assert 0.0 < said["bounds"]["surface_tilt.angle"]["value"] < 0.1


def test_conditions_without_motion_are_not_a_finding(tmp_path):
    # A pulse of 0.1 mT above the base moves the model by less than a micrometre a second, which
    # would be many errors if readings of zero were taken for the noise.
    path = write(tmp_path, {})
    little = {"drive.peak": 0.6e-3, "drive.frequency": 90.0}
    creep = simulate(Scenario.from_toml(tmp_path / "nominal.toml").replace(little)).mean_velocity
    assert 0.0 < abs(creep) < 1e-6
    head, *rows = (tmp_path / "velocity.csv").read_text().split()
    lines = [f"{head},peak", *(f"{row},2.5e-3" for row in rows)]
    for way, f in (("+x", 60), ("+x", 90), ("-x", 60), ("-x", 90)):
        lines += [f"{way},{f},{trial},0.0,0.6e-3" for trial in range(3)]
    (tmp_path / "velocity.csv").write_text("\n".join(lines) + "\n")
    said = json.loads(stickslip("diagnose", path, "--json").stdout)
    assert (said["verdict"], said["left_out"]) == ("none", [])


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


@pytest.mark.nightly
def test_an_interrupt_is_one_line_and_leaves_nothing(tmp_path):
    path = write(tmp_path, {"effects.surface_tilt.angle": 0.04})
    out = tmp_path / "found"
    done, _ = ended_at_the_bar("diagnose", path, "--out", out, "--threads", 1)
    assert (done.returncode, done.stdout) == (130, b"")
    told = rb"stickslip: interrupted at the stage '[a-z ]+', nothing written\n$"
    assert re.search(told, done.stderr)
    assert not out.exists()


def test_a_disk_that_is_full_does_not_lose_the_verdict(tmp_path, monkeypatch):
    def full(*_):
        raise NotWritten("cannot write report.html: No space left on device")

    told = []
    found = SimpleNamespace(propose_experiments=list, save_report=full)
    monkeypatch.setattr("stickslip.diagnosis.entry.diagnose", lambda *_, **__: found)
    monkeypatch.setattr(diagnose_command, "_tell", lambda *given: told.append(given))
    path = write(tmp_path, {})
    with pytest.raises(NotWritten):
        diagnose_command.command.callback(
            path, tmp_path / "found", as_json=False, seed=0, threads=1
        )
    assert told == [(found, False, None)]


def test_the_command_is_listed_with_an_example():
    assert "diagnose" in commands.list_commands(None)
    assert "Example:" in stickslip("diagnose", "--help").stdout


@pytest.mark.nightly
def test_the_answer_does_not_depend_on_the_number_of_threads(tilted):
    folder, said = tilted
    done = stickslip(
        "diagnose", folder / "m.toml", "--out", folder / "again", "--json", "--threads", 3
    )
    assert json.loads(done.stdout) == said
    first, second = (
        json.loads((folder / name / "report.json").read_text()) for name in ("found", "again")
    )
    # The origin of a report has its date and command.
    assert {**second, "origin": None} == {**first, "origin": None}


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
    ("factor", "said"),
    [
        (1e-3, "a column may be in a unit that is wrong by 1000"),
        (400.0, "a column may be in a unit that is wrong by 1000"),
        (2e-5, "about 2e-05 times what the stated model gives"),
        (60.0, "a column may be in a unit that is wrong by 100"),
        (-1.0, "have the opposite sign of the stated model's"),
    ],
)
def test_a_column_in_a_wrong_unit_or_with_a_wrong_sign_is_reported(tmp_path, factor, said):
    done = stickslip("diagnose", _scaled(tmp_path, factor), "--json", "--out", tmp_path / "found")
    told = json.loads(done.stdout)
    assert (told["verdict"], told["cause"]) == ("data-problem", None)
    report = json.loads((tmp_path / "found" / "report.json").read_text())
    (reason,) = report["reasons"]
    assert report["headline"].endswith(reason)
    if factor == 2e-5:
        # About a third of the constants' uncertainty is in it, so a factor is told to one digit.
        assert "times what the stated model gives" in reason
        assert "unit" not in reason.split(";")[-1]
    else:
        assert said in reason


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


def _first_condition(factor):
    def change(lines):
        cells = [line.rsplit(",", 1) for line in lines[1:4]]
        wrong = [f"{rest},{factor * float(value)!r}" for rest, value in cells]
        return [lines[0], *wrong, *lines[4:]]

    return change


def _drifting(lines):
    # Each reading is 2 % of the first faster than the one before.
    rows = []
    for number, row in enumerate(lines[1:]):
        rest, value = row.rsplit(",", 1)
        place = int(rest.split(",")[2]) * 8 + number // 3
        rows.append(f"{rest},{float(value) * (1 + 0.02 * place)!r},{place}")
    return [lines[0] + ",order", *rows]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda lines: [lines[0], *lines[1::3]], "The error of a reading is not known"),
        (lambda lines: lines[:4], "1 condition cannot tell causes apart"),
        (_all_zero, "Every reading is zero"),
        (_drifting, "The velocities drift with the order"),
        (_first_condition(200.0), "The velocity at direction +x, frequency 25 Hz is about"),
    ],
    ids=["no repeats", "one condition", "all zero", "drift", "far too fast"],
)
def test_data_that_allow_no_diagnosis_are_told_with_the_reason(tmp_path, change, said):
    path = _dirty(tmp_path, change)
    done = stickslip("diagnose", path, "--out", tmp_path / "found")
    assert done.returncode == 0, done.stderr
    assert "Verdict: data-problem" in done.stdout
    assert done.stderr == ""
    report = json.loads((tmp_path / "found" / "report.json").read_text())
    (reason,) = report["reasons"]
    assert said in reason
    assert reason in done.stdout
    assert (tmp_path / "found" / "report.html").is_file()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda lines: [lines[0], *reversed(lines[1:])], None),
        (lambda lines: [*lines[:4], lines[4].rsplit(",", 1)[0] + ",nan", *lines[5:]],
         'velocity.csv line 5: velocity "nan" is not a number.'),
        (_absurd, "is far from the others of its condition"),
        (_first_condition(1e3), "velocity.csv lines 2, 3, 4: the velocity is above 1 m/s"),
        (lambda lines: [line.replace("+x", "+X") for line in lines], None),
    ],
    ids=["out of order", "nan", "outlier", "in mm/s", "capitals"],
)  # fmt: skip
def test_tables_with_invalid_rows_give_the_right_verdict(tmp_path, change, said):
    path = _dirty(tmp_path, change)
    done = stickslip("diagnose", path, "--out", tmp_path / "found", "--seed", 3)
    assert done.returncode == 0, done.stderr
    assert "Verdict: none" in done.stdout
    # What reading leaves out is said before the minutes of a diagnosis.
    report = json.loads((tmp_path / "found" / "report.json").read_text())
    lines = [line for line in done.stderr.splitlines() if "left out" in line]
    assert lines == [f"stickslip: left out: {each}" for each in report["left_out"]]
    assert len(lines) == (said is not None)
    if said is not None:
        assert said in lines[0]
        assert report["left_out"][0] in done.stdout


def test_single_trials_are_judged_by_the_stated_error(tmp_path):
    path = _dirty(tmp_path, lambda lines: [lines[0], *lines[1::3]])
    path.write_text(path.read_text() + "velocity_sd = 0.02\n")
    said = json.loads(stickslip("diagnose", path, "--json").stdout)
    assert said["verdict"] == "none"
