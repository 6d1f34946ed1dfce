"""The command ``stickslip optimise``: its files, its page, interrupts, refusals."""

import html
import json
import re

import pytest

import stickslip.design.optimise as module
from command_line import stickslip
from stickslip import load, simulate
from stickslip.design.optimum_page import shown
from stickslip.design.sawtooth import POINTS

TEXT = """stickslip = 1
[drive]
base = 0.5e-3
pulses = 6
ramp = 0.02
[uncertain]
"contact.adhesion" = { mean = 0.22e-6, sd = 0.03e-6 }
"""
HOPS = (
    "--set", "drive.mode=OPP", "--set", "drive.frequency=400", "--set", "robot.length=0.4e-3",
    "--set", "robot.width=0.25e-3", "--set", "robot.height=0.15e-3",
)  # fmt: skip
FEW = ("--evaluations", 60, "--draws", 3, "--fresh", 5)
WAVE = ("--maximise", "mean_velocity", "--limit", "voltage_max=26", "--knots", 4)


def test_the_files_are_a_scenario_its_voltages_and_a_page(scenario, tmp_path):
    out = tmp_path / "found"
    done = stickslip("optimise", scenario, *WAVE, *FEW, "--out", out)
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(each.name for each in out.iterdir()) == ["best.csv", "best.toml", "report.html"]
    best = load(out / "best.toml")
    assert best.uncertain == load(scenario).uncertain
    run = simulate(best)
    assert run.ok
    assert run.summary()["voltage_max"] <= 26.0
    page = (out / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 3
    assert "http" not in page.replace("http-equiv", "")
    speeds = []
    for name in ("start", "sawtooth", "best"):
        printed = re.search(rf"  {name} +(\S+) on 5 fresh draw", done.stdout)
        speeds.append(float(printed[1]))
        cells = rf"<td>{name}</td><td[^>]*>{shown(speeds[-1], 'm/s')}</td>"
        assert re.search(cells, page), name
    assert f"{speeds[2] / speeds[1]:.2f} times" in page
    voltage = shown(run.summary()["voltage_max"], "V")
    assert f">{voltage}</td>" in page
    assert f"grid of up to {POINTS}" in page


def test_keys_give_a_scenario_without_a_program(scenario, tmp_path):
    done = stickslip(
        "optimise", scenario, "--minimise", "power_mean", "--free", "drive.hold=0.5e-3:2e-3",
        "--free", "drive.edge=rise,fall", "--set", "drive.frequency=60", *FEW,
        "--evaluations", 300, "--json", "--out", tmp_path / "found",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    best = load(tmp_path / "found" / "best.toml")
    assert best.drive.frequency == 60.0
    assert best.drive.hold == found["values"]["drive.hold"] == pytest.approx(0.5e-3, rel=0.05)
    assert not (tmp_path / "found" / "best.csv").exists()
    assert found["maximise"] is False
    assert [each["name"] for each in found["landscape"]] == ["drive.hold"]
    assert found["landscape"][0]["at_end"] == "low"


def test_json_alone_writes_nothing(scenario, tmp_path):
    done = stickslip("optimise", scenario, *WAVE, *FEW, "--json", cwd=tmp_path)
    assert set(json.loads(done.stdout)["fresh"]) >= {"start", "best", "sawtooth"}
    assert [each.name for each in tmp_path.iterdir()] == ["scenario.toml"]


def test_ctrl_c_writes_the_best_so_far(scenario, tmp_path, monkeypatch):
    judge_all, calls = module.judge_all, []

    def interrupted(*arguments):
        calls.append(arguments)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return judge_all(*arguments)

    monkeypatch.setattr(module, "judge_all", interrupted)
    out = tmp_path / "found"
    done = stickslip("optimise", scenario, *WAVE, *FEW, "--out", out)
    assert done.returncode == 130
    assert done.stderr.strip() == f"stickslip: interrupted, the best so far is in {out}"
    assert simulate(load(out / "best.toml")).ok
    assert "was interrupted" in (out / "report.html").read_text()


def test_ctrl_c_before_anything_was_found_writes_nothing(scenario, tmp_path, monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(module, "judge_all", interrupted)
    done = stickslip("optimise", scenario, *WAVE, *FEW, "--out", tmp_path / "found")
    assert done.returncode == 130
    assert "nothing written" in done.stderr
    assert not (tmp_path / "found").exists()


@pytest.mark.nightly
def test_limits_of_walking_are_default_until_flight_is_allowed(scenario):
    words = ("optimise", scenario, *WAVE, *FEW, "--json", "--limit", "tilt_max=1.2")
    walk, fly = (json.loads(stickslip(*words, *flag).stdout) for flag in ((), ("--allow-flight",)))
    assert walk["limits"] == {"voltage_max": 26.0, "tilt_max": 1.2, "airborne_fraction": 0.2}
    assert walk["default_limits"] == ["airborne_fraction"]
    assert walk["search"]["limited"]["airborne_fraction"] <= 0.2
    assert fly["limits"] == {"voltage_max": 26.0, "tilt_max": 1.2}
    assert fly["default_limits"] == []
    for found in (walk, fly):
        assert 0.0 <= found["airborne_fraction"] <= 1.0
        assert all({"code", "text", "value"} == set(note) for note in found["notes"])


def test_the_drive_is_printed_with_its_notes_and_its_share_of_flight(scenario, tmp_path):
    out = tmp_path / "found"
    done = stickslip("optimise", scenario, *WAVE, *FEW, "--free", "drive.frequency=60:90",
                     "--allow-flight", "--out", out)  # fmt: skip
    run = simulate(load(out / "best.toml"))
    lines = done.stdout.partition("the best drive:\n")[2].splitlines()
    assert re.fullmatch(r"  drive\.frequency = \S+ Hz", lines[0])
    for line, coil in zip(lines[1:3], ("xp", "clamp"), strict=True):
        assert re.fullmatch(rf"  {coil} =( \S+){{4}} V", line)
    assert lines[3] == f"  in flight {100 * run.summary()['airborne_fraction']:.3g} % of the time"
    assert run.notes
    page = (out / "report.html").read_text()
    for note, line in zip(run.notes, lines[4:], strict=False):
        assert line == f"  {note}"
        assert html.escape(str(note), quote=False) in page.replace("&#34;", '"')


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (("--free", "drive.frequency"), "key=low:high"),
        (("--free", "drive.frequency=5:10:300"), "key=low:high"),
        (("--free", "drive.frequency=50,100"), "key=low:high"),
        (("--free", "drive.frequency=5:300", "--free", "drive.frequency=5:30"), "there twice"),
        (("--free", "drive.frequency=5Hz:300Hz"), "without its unit"),
        (("--free", "drive.frequency=low:high"), "drive.frequency"),
        (("--limit", "voltage_max"), "figure=value"),
        (("--limit", "voltage_max=26V"), "without its unit"),
        (("--limit", "voltage_max=26", "--limit", "voltage_max=20"), "there twice"),
        (("--limit", "voltage_max=-1", "--free", "drive.hold=1e-3:2e-3"), "the nearest has"),
        (("--limit", "airborne_fraction=0", "--free", "drive.hold=1e-3:2e-3"), "of 0"),
        ((*HOPS, "--free", "drive.peak=2.4e-3:2.5e-3"), "--allow-flight"),
        (("--knots", "8"), "voltage_max"),
        (("--knots", "8", "--limit", "voltage_max=26", "--coils", "xp,up"), "up"),
        (("--free", "drive.hold=1e-3:2e-3", "--uncertain", "none.toml"), "none.toml"),
        (("--free", "drive.hold=1e-3:2e-3", "--set", "contact.adhesion=1e-7"), "has no influence"),
        ((), "nothing is free"),
    ],
)
def test_what_is_not_allowed_is_refused_in_one_line(scenario, tmp_path, options, word):
    done = stickslip(
        "optimise", scenario, "--maximise", "mean_velocity", *options, "--evaluations", 20,
        "--out", tmp_path / "found", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert word in done.stderr
    assert not (tmp_path / "found").exists()


@pytest.mark.parametrize("uncertain", [False, True])
def test_a_file_that_is_read_is_not_overwritten(scenario, tmp_path, uncertain):
    path = tmp_path / "best.toml"
    path.write_text(TEXT)
    files = (scenario, "--uncertain", path) if uncertain else (path,)
    done = stickslip("optimise", *files, *WAVE, *FEW, "--out", tmp_path)
    assert done.returncode == 2
    assert "which it would overwrite" in done.stderr
    assert path.read_text() == TEXT
