"""The command `stickslip predict`: output, files, interrupts, bad input."""

import json
import math

import pandas as pd
import pytest

from command_line import stickslip
from stickslip import Prior, load, predict

UNCERTAIN = """[uncertain]
"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }
"contact.adhesion" = { median = 0.22e-6, factor = 1.2 }
"""
PRIORS = {
    "contact.kinetic_friction": Prior("normal", 0.145, 0.01),
    "contact.adhesion": Prior("log-normal", 0.22e-6, 1.2),
}


@pytest.fixture
def files(tmp_path):
    (tmp_path / "s.toml").write_text("stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 4\n")
    (tmp_path / "u.toml").write_text(UNCERTAIN)
    return tmp_path


VARY = ("--vary", "drive.frequency=30,60", "--vary", "drive.mode=OPP,IPP")
COMMON = ("s.toml", "--uncertain", "u.toml", "--draws", 24)


def test_the_command_gives_what_python_gives(files):
    vary = {"drive.frequency": [30.0, 60.0], "drive.mode": ["OPP", "IPP"]}
    found = predict(load(files / "s.toml"), vary, 24, uncertain=PRIORS)
    options = ("--json", "--out", "b.csv", "--plot", "b.png")
    done = stickslip("predict", *COMMON, *VARY, *options, cwd=files)
    assert (done.returncode, done.stderr) == (0, "")
    said = json.loads(done.stdout, parse_constant=pytest.fail)
    assert (said["points"], said["draws"], said["failed"], said["seed"]) == (4, 24, 0, 0)
    assert said["quantiles"] == [0.1, 0.5, 0.9]
    velocities = [each["mean_velocity"] for each in said["results"]]
    assert velocities == found["mean_velocity"].values.reshape(4, 3).tolist()
    assert [each["drive.mode"] for each in said["results"]] == ["OPP", "IPP"] * 2
    assert len(pd.read_csv(files / "b.csv")) == 4
    assert (files / "b.png").stat().st_size > 5000

    table = stickslip("predict", *COMMON, *VARY, cwd=files).stdout
    assert ["60", "IPP", f"{velocities[3][0]:.6g}"] in [
        line.split()[:3] for line in table.splitlines()
    ]
    # The share of 0.1 of 24 draws is known to within sqrt(0.09 / 24).
    assert f"{100 * (0.1 + math.sqrt(0.09 / 24)):.3g} %" in table


def test_figures_choose_the_columns(files):
    options = ("--figures", "field_max,mean_velocity,velocity_along", "--out", "b.csv")
    done = stickslip("predict", *COMMON, *options, cwd=files)
    assert done.returncode == 0
    assert done.stderr == "stickslip: note: velocity_along is one of the whole plane, left out\n"
    names = {name.split()[0].rpartition("_")[0] for name in pd.read_csv(files / "b.csv")}
    chosen = {"field_max", "mean_velocity"}
    assert names == {"", *chosen, *(f"{name}_error" for name in chosen)}
    assert done.stdout.split()[:7:3] == ["field_max_q10", "mean_velocity_q10", "failed"]
    found = json.loads(stickslip("predict", *COMMON, *options[:2], "--json", cwd=files).stdout)
    assert {*found["results"][0]} == names - {""} | {"failed"}


def test_the_command_says_what_failed(files):
    done = stickslip("predict", *COMMON, "--vary", "contact.static_friction=0.145,0.01", cwd=files)
    assert done.returncode == 1
    assert "precision" in done.stdout
    assert "draws failed and are in no quantile; the first: contact.kinetic_friction" in done.stderr


def test_quantiles_of_no_draw_have_no_precision(files):
    done = stickslip("predict", *COMMON, "--vary", "contact.static_friction=0.01", cwd=files)
    assert done.returncode == 1
    assert "24 of all failed" in done.stdout
    assert "precision" not in done.stdout


def test_the_command_says_what_was_drawn_again(files):
    options = ("--set", "contact.static_friction=0.145", "--json")
    done = stickslip("predict", *COMMON, *options, cwd=files)
    again = json.loads(done.stdout)["redrawn"]
    assert again > 0
    assert f"{again} more draws made no scenario" in done.stderr


def test_a_value_of_a_covariance_can_be_set_where_the_other_file_has_none(files):
    about = '[uncertain.covariance]\nkeys = ["drag.linear"]\nmatrix = [[1e-12]]\n'
    (files / "c.toml").write_text(about)
    (files / "extended.toml").write_text("stickslip = 1\n[drive]\n[drag]\nlinear = 3e-5\n" + about)
    said = {}
    for value in ("1e-5", "9e-5"):
        options = ("--set", f"drag.linear={value}", "--draws", 5)
        own = stickslip("predict", "s.toml", *options, "--uncertain", "c.toml", cwd=files)
        assert own.returncode == 0, own.stderr
        said[value] = own.stdout
        done = stickslip("predict", "s.toml", *options, "--uncertain", "extended.toml", cwd=files)
        assert done.returncode == 2
        assert "--set drag.linear: has no influence" in done.stderr
    assert said["1e-5"] != said["9e-5"]
