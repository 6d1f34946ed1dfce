"""Recordings whose process is killed: at any time, or within the writing of a block.

``python tests/killed_recordings.py N SEED`` kills N and says what each left.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

from command_line import python_process
from recorded_runs import DENSE
from stickslip import open_run, simulate
from stickslip.simulation.record_file import BLOCK, PART

RECORDED = DENSE.replace({"drive.pulses": 2000, "record.fields": "x, theta, current, contact"})

# The default action of an alarm ends a process at once, wherever it is, as SIGKILL does.
CODE = """
import signal, sys, time
from stickslip import load, simulate
from stickslip.simulation.record_file import RecordFile

scenario, out, block, wait = load(sys.argv[1]), sys.argv[2], int(sys.argv[3]), float(sys.argv[4])
signal.signal(signal.SIGALRM, signal.SIG_DFL)
write, took = RecordFile.write, []

def watched(file, recording):
    if len(took) == block > 0:  # at a part of the time that the one before took
        signal.setitimer(signal.ITIMER_REAL, wait * took[-1])
    start = time.perf_counter()
    write(file, recording)
    took.append(time.perf_counter() - start)
    if len(took) > block > 0:
        signal.setitimer(signal.ITIMER_REAL, 1e-6)

RecordFile.write = watched
if block == 0:
    signal.setitimer(signal.ITIMER_REAL, wait)
simulate(scenario, out=out)
"""


def killed(folder, random, inside):
    """Kill a recording, and return the number of blocks that are left; None for no file."""
    scenario, out = folder / "scenario.toml", folder / "run.nc"
    RECORDED.to_toml(scenario)
    block = int(random.integers(1, 5)) if inside else 0
    wait = random.uniform(0.0, 1.0) if inside else random.uniform(0.01, 2.0)
    done = python_process("-c", CODE, scenario, out, block, wait)
    assert done.returncode == -14, done
    assert not out.exists()
    part = folder / f"run.nc{PART}"
    if not part.exists():
        return None
    left = open_run(part)
    assert (left.status, left.complete, left.scenario) == ("interrupted", False, RECORDED)
    assert left.samples % BLOCK == 0
    assert (left.notes[0].code == "record-cut") == (left.samples >= 0)
    whole = simulate(RECORDED.replace({"drive.pulses": 12 + left.samples // 5000}))
    for name in ("t", "x", "theta", "current", "contact"):
        assert getattr(left, name).tobytes() == getattr(whole, name)[: left.samples].tobytes()
    if inside:
        assert block <= left.samples // BLOCK <= block + 1
    left.save(folder / "kept.nc")
    assert open_run(folder / "kept.nc").x.tobytes() == left.x.tobytes()
    return left.samples // BLOCK


if __name__ == "__main__":
    count, seed = map(int, sys.argv[1:])
    for k in range(count):
        with tempfile.TemporaryDirectory() as name:
            random = np.random.default_rng([seed, k])
            inside = k % 3 == 0
            print(k, "in a write" if inside else "at any time", killed(Path(name), random, inside))
