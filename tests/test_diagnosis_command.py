"""``stickslip diagnose`` on data that the simulator made, from file to report."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from command_line import ended_at_the_bar, stickslip
from made_measurement import write
from report_page import without_pictures
from stickslip import Scenario, simulate
from stickslip._util.atomic_files import NotWritten
from stickslip.cli import diagnose_command
from stickslip.cli.commands import stickslip as commands
from stickslip.facts import Code
from stickslip.scenario.named_effects import effects, is_lawful

KEYS = {
    "verdict", "cause", "parameters", "probabilities", "p_value", "bounds", "gain",
    "next_experiments", "left_out", "open_set", "seed", "version",
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
    assert {each.name for each in effects() if is_lawful(each.name)} <= set(chance)
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
    assert "a tilted surface" in page
    assert "http" not in page
    full = json.loads((folder / "found" / "report.json").read_text())
    assert set(full) >= KEYS
    assert full["verdict"] == said["verdict"]
    assert len(full["conditions"]) == 8


def test_the_table_of_words_names_keys_that_the_file_has(tilted):
    def keys(value):
        if isinstance(value, dict):
            return set(value) | {name for each in value.values() for name in keys(each)}
        return {name for each in value for name in keys(each)} if isinstance(value, list) else set()

    full = json.loads((tilted[0] / "found" / "report.json").read_text())
    page = Path(__file__).parents[1] / "docs" / "reference" / "measurement.md"
    text = page.read_text(encoding="utf-8")
    section = text.split("### Words of the page and keys of the file")[1].split("\n#")[0]
    rows = [line.split("|")[2] for line in section.splitlines() if line.startswith("| ")][2:]
    # That of a law of another shape is null here, and has keys of its own.
    named = [re.findall(r"`([\w.]+)`", row) for row in rows if "`open_set`" not in row]
    assert len(named) >= 15
    known = keys(full) | {"hooks"}
    for name in (part for each in named for names in each for part in names.split(".")):
        assert name in known, name


def test_nothing_is_found_where_nothing_is(tmp_path):
    done = stickslip("diagnose", write(tmp_path, {}), "--json", "--seed", 3)
    said = json.loads(done.stdout)
    assert said["seed"] == 3
    assert said["verdict"] == "none"
    assert said["cause"] is None
    assert 0.0 < said["bounds"]["surface_tilt.angle"] < 0.1


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
    monkeypatch.setattr("stickslip.diagnosis.api.diagnose", lambda *_, **__: found)
    monkeypatch.setattr(diagnose_command, "_tell", lambda *given: told.append(given))
    path = write(tmp_path, {})
    with pytest.raises(NotWritten):
        diagnose_command.command.callback(
            path, tmp_path / "found", as_json=False, seed=0, free_shapes=False, threads=1
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
    first, second = (folder / name / "report.json" for name in ("found", "again"))
    assert second.read_text() == first.read_text()


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
    ("factor", "code", "unit_factor"),
    [
        (1e-3, Code.VELOCITIES_SIZE, 1e-3),
        (400.0, Code.VELOCITIES_SIZE, 1e3),
        (2e-5, Code.VELOCITIES_SIZE, None),
        (60.0, Code.VELOCITIES_SIZE, 1e2),
        (-1.0, Code.OPPOSITE_SIGN, None),
    ],
)
def test_a_column_in_a_wrong_unit_or_with_a_wrong_sign_is_reported(
    tmp_path, factor, code, unit_factor
):
    done = stickslip("diagnose", _scaled(tmp_path, factor), "--json", "--out", tmp_path / "found")
    said = json.loads(done.stdout)
    assert said["verdict"] == "data-problem"
    assert said["cause"] is None
    report = json.loads((tmp_path / "found" / "report.json").read_text())
    (fact,) = report["facts"]["reasons"]
    assert (fact["code"], fact["fields"].get("unit_factor")) == (code, unit_factor)
    assert report["headline"].endswith(report["reasons"][0])


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
    # Each of three rounds over all conditions is a fifth faster than the one before.
    rows = []
    for number, row in enumerate(lines[1:]):
        rest, value = row.rsplit(",", 1)
        place = int(rest.split(",")[2]) * 8 + number // 3
        rows.append(f"{rest},{float(value) * (1 + 0.01 * place)!r},{place}")
    return [lines[0] + ",order", *rows]


@pytest.mark.parametrize(
    ("change", "verdict", "code"),
    [
        (lambda lines: [lines[0], *reversed(lines[1:])], "none", None),
        (lambda lines: [*lines[:4], lines[4].rsplit(",", 1)[0] + ",nan", *lines[5:]], "none",
         Code.NOT_A_NUMBER),
        (_absurd, "none", Code.OUTLIER),
        (lambda lines: [lines[0], *lines[1::3]], "data-problem", Code.NO_NOISE),
        (lambda lines: lines[:4], "data-problem", Code.TOO_FEW_CONDITIONS),
        (_all_zero, "data-problem", Code.ALL_ZERO),
        (_drifting, "data-problem", Code.DRIFT),
        (_first_condition(1e3), "none", Code.TOO_FAST),
        (_first_condition(200.0), "data-problem", Code.VELOCITY_SIZE),
        (lambda lines: [line.replace("+x", "+X") for line in lines], "none", None),
    ],
    ids=["out of order", "nan", "outlier", "no repeats", "one condition", "all zero", "drift",
         "in mm/s", "far too fast", "capitals"],
)  # fmt: skip
def test_tables_with_invalid_rows_give_the_right_verdict(tmp_path, change, verdict, code):
    path = _dirty(tmp_path, change)
    done = stickslip("diagnose", path, "--out", tmp_path / "found", "--seed", 3)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split(":")[0] == verdict, done.stdout
    assert "Traceback" not in done.stderr
    # What reading leaves out is said before the minutes of a diagnosis.
    report = json.loads((tmp_path / "found" / "report.json").read_text())
    left_out = verdict != "data-problem" and code is not None
    assert ("stickslip: left out: velocity.csv" in done.stderr) == left_out
    facts = report["facts"]["reasons"] if verdict == "data-problem" else report["facts"]["left_out"]
    assert [each["code"] for each in facts] == ([] if code is None else [code])
    # The command prints what report.json has.
    for line in (*report["reasons"], *report["notes"], *report["left_out"]):
        assert verdict == "data-problem" or line in done.stdout
    assert (tmp_path / "found" / "report.html").is_file()


def test_single_trials_are_judged_by_the_stated_error(tmp_path):
    path = _dirty(tmp_path, lambda lines: [lines[0], *lines[1::3]])
    path.write_text(path.read_text() + "velocity_sd = 0.02\n")
    said = json.loads(stickslip("diagnose", path, "--json").stdout)
    assert said["verdict"] == "none"
