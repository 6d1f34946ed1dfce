"""The command ``stickslip optimise``: its files, its JSON, interrupts, refusals."""

import json

import pytest

from command_line import stickslip
from stickslip import load, simulate

TEXT = """stickslip = 1
[drive]
base = 0.5e-3
pulses = 6
ramp = 0.02
[uncertain]
"contact.adhesion" = { mean = 0.22e-6, sd = 0.03e-6 }
"""
FEW = ("--draws", 3, "--fresh", 5, "--evaluations")
WAVE = ("--maximise", "mean_velocity", "--limit", "voltage_max=26", "--knots", 4)


@pytest.mark.nightly
def test_the_files_are_a_scenario_its_voltages_and_a_picture(scenario, tmp_path):
    out = tmp_path / "found"
    done = stickslip("optimise", scenario, *WAVE, *FEW, 300, "--free", "drive.frequency=60:90",
                     "--allow-flight", "--out", out)  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(each.name for each in out.iterdir()) == ["best.csv", "best.png", "best.toml"]
    assert (out / "best.png").read_bytes().startswith(b"\x89PNG")
    best = load(out / "best.toml")
    assert best.uncertain == load(scenario).uncertain
    run = simulate(best)
    assert run.ok
    assert run.summary()["voltage_max"] <= 26.0
    for said in (
        *("  drive.frequency = ", "  xp = ", "  clamp = "),
        f"{100 * run.summary()['airborne_fraction']:.3g} %",
        *map(str, run.notes),
    ):
        assert said in done.stdout


def test_keys_give_a_scenario_without_a_program(scenario, tmp_path):
    done = stickslip(
        "optimise", scenario, "--minimise", "power_mean", "--free", "drive.hold=0.5e-3:2e-3",
        "--free", "drive.edge=rise,fall", "--set", "drive.frequency=60",
        *FEW, 600, "--json", "--out", tmp_path / "found",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    best = load(tmp_path / "found" / "best.toml")
    assert best.drive.frequency == 60.0
    assert best.drive.hold == found["values"]["drive.hold"] == pytest.approx(0.5e-3, rel=0.1)
    assert not (tmp_path / "found" / "best.csv").exists()
    assert found["maximise"] is False
    draws = {name: row["draws"] for name, row in found["table"].items()}
    assert draws == {"search": 3, "start": 5, "best": 5}
    assert {*found} == {
        *("figure", "unit", "maximise", "score", "limits", "default_limits", "at_least", "table"),
        *("active", "beyond_limits", "values", "airborne_fraction", "notes", "runs", "seed"),
    }


def test_json_alone_writes_nothing(scenario, tmp_path):
    done = stickslip("optimise", scenario, *WAVE, *FEW, 20, "--json", cwd=tmp_path)
    assert json.loads(done.stdout)["table"]["best"]["draws"] == 5
    assert [each.name for each in tmp_path.iterdir()] == ["scenario.toml"]
