"""What a sweep costs beyond its simulations: loose bounds; `bench/sweep.py` measures."""

import json
import statistics
import subprocess
import sys
import time

import numpy as np

from stickslip import Drive, Scenario, simulate, sweep

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=20))
FREQUENCIES = np.linspace(5.0, 200.0, 40)
MODES = ["IPP", "OPP"]

# A millisecond without field: nothing but overhead. In a process of its own, whose memory and time
# are those of the sweep.
TINY = """
import json, resource, sys, time
import numpy as np
from stickslip import Drive, Scenario, sweep

def megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

base = Scenario(drive=Drive(frequency=1000.0, pulses=1, ramp=0.0, hold=0.0, peak=0.0))
vary = {"drive.frequency": np.linspace(1000.0, 2000.0, 500), "contact.adhesion":
        np.linspace(0.0, 1e-6, 200)}
sweep(base, {"drive.frequency": [1000.0, 2000.0]}, out="warm.nc")
before, start = megabytes(), time.process_time()
data = sweep(base, vary, out="tiny.nc")
print(json.dumps({"points": data["status"].size, "failed": data.attrs["failed_points"],
                  "seconds": time.process_time() - start, "megabytes": megabytes() - before}))
"""


def test_a_hundred_thousand_points(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", TINY], capture_output=True, text=True, cwd=tmp_path, timeout=120
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert (found["points"], found["failed"]) == (100_000, 0)
    assert found["seconds"] / found["points"] < 20e-6  # 2 to 4 us on the machine it was written on
    assert found["megabytes"] < 150  # 14 MB of results, some of them twice while written
    assert (tmp_path / "tiny.nc").stat().st_size < 14e6


def test_a_sweep_costs_no_more_than_its_runs():
    def one_by_one():
        for frequency in FREQUENCIES:
            for mode in MODES:
                simulate(BASE.replace({"drive.frequency": float(frequency), "drive.mode": mode}))

    def together():
        sweep(BASE, {"drive.frequency": FREQUENCIES, "drive.mode": MODES}, threads=1)

    def cpu_seconds(work):
        start = time.process_time()
        work()
        return time.process_time() - start

    together()
    ratios = [cpu_seconds(together) / cpu_seconds(one_by_one) for _ in range(7)]
    assert statistics.median(ratios) < 1.1
