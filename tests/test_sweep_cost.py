"""What a sweep needs beyond its simulations; `bench/promises.py` asserts its time."""

import json
import subprocess
import sys

# A millisecond without field: nothing but overhead. In a process of its own, whose memory is
# that of the sweep.
TINY = """
import json, resource, sys
import numpy as np
from stickslip import Drive, Scenario, sweep

def megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

base = Scenario(drive=Drive(frequency=1000.0, pulses=1, ramp=0.0, hold=0.0, peak=0.0))
vary = {"drive.frequency": np.linspace(1000.0, 2000.0, 500), "contact.adhesion":
        np.linspace(0.0, 1e-6, 200)}
sweep(base, {"drive.frequency": [1000.0, 2000.0]}, out="warm.nc")
before = megabytes()
data = sweep(base, vary, out="tiny.nc")
print(json.dumps({"points": data["status"].size, "failed": data.attrs["failed_points"],
                  "megabytes": megabytes() - before}))
"""


def test_a_hundred_thousand_points(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", TINY], capture_output=True, text=True, cwd=tmp_path, timeout=120
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert (found["points"], found["failed"]) == (100_000, 0)
    assert found["megabytes"] < 150  # 14 MB of results, some of them twice while written
    assert (tmp_path / "tiny.nc").stat().st_size < 14e6
