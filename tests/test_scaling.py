"""Long runs and large sweeps: work in proportion, and bounded memory."""

import gc
import json
import weakref
from pathlib import Path

import pytest

from command_line import python_process
from stickslip import (
    Contact,
    Drive,
    Scenario,
    diagnose,
    diagnose_change,
    diagnose_model,
    models,
    read_measurement,
    simulate,
    sweep,
)
from stickslip.diagnosis.fitting.problem import Problem

PULSES = 200

# Slow enough on a sticky surface to stay between the coils for 100 s.
DRIVE = {"mode": "OPP", "frequency": 200.0, "base": 0.5e-3, "hold": 1.5e-3, "ramp": 0.0}
ADHESION = 1e-6  # N

PEAK = """
import json, resource, sys
import numpy as np
from stickslip import Contact, Drive, Scenario, simulate, sweep

def kilobytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
"""
RUN = """
contact, peaks = Contact(adhesion=float(sys.argv[1])), []
for pulses in map(int, sys.argv[3:]):
    drive = Drive(pulses=pulses, **json.loads(sys.argv[2]))
    run = simulate(Scenario(drive=drive, contact=contact))
    assert run.ok and run.summary()["simulated_time"] > 0.999 * pulses / drive.frequency
    peaks.append(kilobytes())
print(json.dumps(peaks))
"""
# A millisecond without field: nothing but overhead.
SWEEP = """
base = Scenario(drive=Drive(frequency=1000.0, pulses=1, ramp=0.0, hold=0.0, peak=0.0))
vary = {"drive.frequency": np.linspace(1000.0, 2000.0, 500), "contact.adhesion":
        np.linspace(0.0, 1e-6, 200)}
sweep(base, {"drive.frequency": [1000.0, 2000.0]}, out="warm.nc")
before = kilobytes()
data = sweep(base, vary, out="tiny.nc")
print(json.dumps({"points": data["status"].size, "failed": data.attrs["failed_points"],
                  "megabytes": (kilobytes() - before) / 1024}))
"""


def in_process(code, *arguments, **options):
    """Output of a program in a process of its own, whose memory is that of its work."""
    done = python_process("-c", PEAK + code, *arguments, **options)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def work(pulses):
    """Evaluations of the right-hand side in one run."""
    scenario = Scenario(drive=Drive(pulses=pulses, **DRIVE), contact=Contact(adhesion=ADHESION))
    run = simulate(scenario)
    assert run.ok
    return run.summary()["steps"]["evaluations"]


def test_a_hundred_times_longer_is_a_hundred_times_the_work():
    # What an evaluation costs is measured by `bench against`.
    assert work(100 * PULSES) <= 105 * work(PULSES)


def test_a_hundred_times_longer_needs_no_more_memory():
    # Two runs of one length differ by some pages; a result of 8 bytes a pulse would be 160 kB.
    _, short, long = in_process(RUN, ADHESION, json.dumps(DRIVE), PULSES, PULSES, 100 * PULSES)
    assert long <= short + 128


@pytest.mark.nightly
def test_a_hundred_thousand_points(tmp_path):
    found = in_process(SWEEP, cwd=tmp_path)
    assert (found["points"], found["failed"]) == (100_000, 0)
    assert found["megabytes"] < 150  # 14 MB of results, some of them twice while written
    assert (tmp_path / "tiny.nc").stat().st_size < 14e6


EXAMPLES = Path(__file__).parents[1] / "examples"
JOINT = models.joint(inertia=(0.012, 0.0005), viscous=(0.02, 0.01))


def log(name="joint.csv"):
    return models.read_log(EXAMPLES / name, JOINT)


RESULTS = {
    "run": lambda: simulate(Scenario(drive=Drive(pulses=5))),
    "sweep": lambda: sweep(Scenario(drive=Drive(pulses=5)), {"drive.frequency": [50.0, 100.0]}),
    "diagnosis of a log": lambda: diagnose_model(JOINT, log()),
    "diagnosis of a change": lambda: diagnose_change(JOINT, log(), log("joint_oiled.csv")),
    "diagnosis of a walker": lambda: diagnose(
        read_measurement(EXAMPLES / "measurement.toml"), threads=1
    ),
}


@pytest.mark.parametrize("name", RESULTS)
@pytest.mark.daily("run", "sweep", "diagnosis of a log")
def test_a_result_is_freed_with_its_last_reference(name):
    """Its arrays do not wait for the collector of cycles, which few large objects do not call."""

    def problems():
        return sum(isinstance(each, Problem) for each in gc.get_objects())

    gc.collect()
    before = problems()
    gc.disable()
    try:
        result = RESULTS[name]()
        assert problems() > before or "diagnosis" not in name
        seen = weakref.ref(result)
        del result
        assert (seen(), problems()) == (None, before)
    finally:
        gc.enable()
