"""The logs and cases of `examples`: made as they say, and with the answers that are stored."""

import csv
import runpy
import shutil
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from documentation_blocks import EXAMPLES, prints
from stickslip import models

CASES = EXAMPLES / "cases"


def joint():
    """Hidden: dry friction."""
    t = 0.04 * np.arange(100)
    torque = np.round(0.08 * np.sin(2.5 * t) + 0.06 * np.sin(6.9 * t + 1.0), 4)
    true = models.joint(inertia=0.0118, viscous=0.025, coulomb=0.03)
    noise = 0.03 * np.random.default_rng(0).standard_normal(len(t))
    speed = true.simulate(t, {"torque": torque}) + noise
    rows = ("{:.2f},{:.4f},{:.3f}".format(*row) for row in zip(t, torque, speed, strict=True))
    return ["t (s),torque (N m),speed (rad/s)", *rows]


def heater():
    """Hidden: from 934 s of the evening on, the heater gives 30 W less than it is asked for."""
    lines = ["record,t,power,temperature"]
    for name, count, start, less in (("morning", 120, 35.0, 0.0), ("evening", 140, 2.0, 30.0)):
        random = np.random.default_rng(count)
        t = 10.0 * np.arange(count)
        power = np.repeat(random.uniform(0.0, 250.0, count // 20), 20).round(1)
        x = [start]
        for given in (power - less * (t > 934.0))[:-1]:
            x.append(x[-1] + 10.0 * (given - 2.1 * x[-1]) / 2150.0)
        read = np.array(x) + 0.1 * random.standard_normal(count)
        rows = zip(t, power, read, strict=True)
        lines += ["{},{:.0f},{:.1f},{:.2f}".format(name, *row) for row in rows]
    return lines


@pytest.mark.parametrize("log", [joint, heater], ids=lambda each: each.__name__)
def test_a_log_is_the_one_that_is_described(log):
    with (EXAMPLES / f"{log.__name__}.csv").open() as file:
        stored = list(csv.reader(file))
    made = [line.split(",") for line in log()]
    assert stored[0] == made[0]
    for one, other in zip(stored[1:], made[1:], strict=True):
        for cell, same in zip(one, other, strict=True):
            # The last digit, where another machine rounds the other way.
            assert cell == same or abs(float(cell) - float(same)) < 1.1e-2


@pytest.mark.parametrize("case", sorted(CASES.iterdir()), ids=lambda each: each.name)
@pytest.mark.daily("axis", "cart", "heater", "rollers", "square", "tumbler")
def test_a_case_prints_what_is_stored(case, tmp_path):
    if case.name.startswith("mujoco"):
        pytest.importorskip("mujoco")
    shutil.copytree(case, tmp_path, dirs_exist_ok=True)
    command = [sys.executable, "case.py"]
    got = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    expected = (case / "expected.txt").read_text(encoding="utf-8")
    assert prints(expected, got), got


@pytest.mark.parametrize("case", sorted(each.parent.name for each in CASES.glob("*/make.py")))
def test_a_made_case_is_made_as_it_says(case, tmp_path):
    shutil.copy(CASES / case / "make.py", tmp_path)
    runpy.run_path(str(tmp_path / "make.py"))
    made, kept = (pd.read_csv(folder / "log.csv") for folder in (tmp_path, CASES / case))
    assert list(made) == list(kept)
    np.testing.assert_allclose(made, kept, atol=2e-5)


@pytest.mark.nightly
def test_a_compiled_loop_is_a_model():
    pytest.importorskip("numba")
    command = [sys.executable, str(EXAMPLES / "compiled_joint.py")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == "named 0.030 N m\n"
