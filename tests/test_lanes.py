"""How many runs step together at most is read from the environment."""

import os
import subprocess
import sys

import pytest

BATCH = "import stickslip as s; s.simulate_batch([s.Scenario()])"


@pytest.mark.parametrize("width", ["2", "04"])
def test_a_width_that_does_not_exist_is_named(width):
    environment = {**os.environ, "STICKSLIP_LANES": width}
    done = subprocess.run(
        [sys.executable, "-c", BATCH], capture_output=True, text=True, env=environment, timeout=120
    )
    assert done.returncode == 1
    assert f"STICKSLIP_LANES = {width}: allowed is 1, 4 or 8" in done.stderr
