"""The bits of a batch do not depend on how many runs step together."""

import os
import subprocess
import sys

import pytest

# Two modes and slow to fast drives: runs that stick, slip, fly and land at times of their own.
SWEEP = """
import hashlib
import numpy as np
from stickslip import Drive, Scenario, simulate, sweep

base = Scenario(drive=Drive(base=0.5e-3, pulses=5))
frequencies, modes = np.linspace(20.0, 200.0, 7), ["IPP", "OPP"]
data = sweep(base, {"drive.frequency": frequencies, "drive.mode": modes}, threads=1)
for name in sorted(data.data_vars):
    print(name, hashlib.sha256(np.ascontiguousarray(data[name].values).tobytes()).hexdigest())
change = {"drive.frequency": float(frequencies[3]), "drive.mode": "OPP"}
print(simulate(base.replace(change)).mean_velocity == data["mean_velocity"].values[3, 1])
"""


def swept(width):
    environment = {**os.environ, "STICKSLIP_LANES": width}
    if not width:
        del environment["STICKSLIP_LANES"]
    return subprocess.run(
        [sys.executable, "-c", SWEEP], capture_output=True, text=True, env=environment, timeout=120
    )


@pytest.fixture(scope="module")
def unlimited():
    done = swept("")
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("True\n")
    return done.stdout


@pytest.mark.parametrize("width", ["1", "4", "8"])
def test_a_sweep_has_the_same_bits_at_any_width(width, unlimited):
    done = swept(width)
    assert done.returncode == 0, done.stderr
    assert done.stdout == unlimited


@pytest.mark.parametrize("width", ["2", "04"])
def test_a_width_that_does_not_exist_is_named(width):
    done = swept(width)
    assert done.returncode == 1
    assert f"STICKSLIP_LANES = {width}: allowed is 1, 4 or 8" in done.stderr
