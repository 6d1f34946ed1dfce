"""Results that several files of tests look at."""

import fcntl
import json
import os
import signal

# Threads of the linear algebra wait for each other by spinning: beside other workers a QR
# decomposition of 449 x 110 numbers takes a hundred times the processor time that it takes alone.
# Before numpy is imported, and for the processes that tests start.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from hypothesis import HealthCheck, Phase, settings

from command_line import stickslip_process
from made_measurement import write
from stickslip import Drive, Record, Scenario, Waveform, simulate

# Shells start what runs in the background with interrupts ignored, and so would be all commands
# that the tests interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)

# The same examples each time, or with `--hypothesis-profile nightly` more, by --hypothesis-seed. A
# failing one is reported as it was drawn: shrinking it would take minutes.
COMMON = settings(
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
    phases=(Phase.explicit, Phase.generate),
)
settings.register_profile("tests", COMMON, derandomize=True, max_examples=25)
settings.register_profile("nightly", COMMON, max_examples=1000)
settings.load_profile("tests")


def pytest_addoption(parser):
    parser.addoption("--part", metavar="K/N", help="every Nth test alone, from the Kth on")


@pytest.hookimpl(trylast=True)  # of the tests that the markers leave
def pytest_collection_modifyitems(config, items):
    part = config.getoption("--part")
    if part is not None:
        number, parts = map(int, part.split("/"))
        left = items[number - 1 :: parts]
        config.hook.pytest_deselected(items=[each for each in items if each not in left])
        items[:] = left


@pytest.fixture
def scenario(tmp_path, request):
    """The file of a scenario with the text that the test's module has as `TEXT`."""
    path = tmp_path / "scenario.toml"
    path.write_text(request.module.TEXT)
    return path


@pytest.fixture(scope="session")
def tilted(tmp_path_factory, worker_id):
    """The folder of a diagnosis of a surface that tilts by 0.04 rad, and what ``--json`` said.

    The workers of a session share one: the first to ask makes it, and the others wait.
    """
    base = tmp_path_factory.getbasetemp()
    folder = (base if worker_id == "master" else base.parent) / "tilted"
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "said.json").exists():
            path = write(folder, {"effects.surface_tilt.angle": 0.04})
            # Jobs are stated, so that a test can compare with another number on any machine.
            options = ("--out", folder / "found", "--json", "--threads", 2)
            done = stickslip_process("diagnose", path, *options)
            assert done.returncode == 0, done.stderr
            (folder / "said.json").write_text(done.stdout)
    return folder, json.loads((folder / "said.json").read_text())


@pytest.fixture(scope="session")
def walk_ipp():
    """The paper's robot in twelve pulses in the plane, recorded at 2 kHz."""
    return simulate(Scenario(drive=Drive(base=0.5e-3, pulses=12), record=Record(rate=2000.0)))


@pytest.fixture(scope="session")
def walk_opp():
    """A walk by pulses of the holding coil, which hops."""
    drive = Drive(mode="OPP", base=0.0, hold=2.5e-3, pulses=12)
    return simulate(Scenario(drive=drive, record=Record(rate=2000.0)))


@pytest.fixture(scope="session")
def steered():
    """A walk along a heading of 1.5 rad, in the whole plane."""
    drive = Drive(base=0.5e-3, pulses=5, heading=1.5)
    return simulate(Scenario(drive=drive, record=Record(rate=2000.0)))


@pytest.fixture(scope="session")
def tilted_walk(walk_ipp):
    """A walk down a slope of 0.02 rad."""
    return simulate(walk_ipp.scenario.replace({"effects.surface_tilt.angle": 0.02}))


@pytest.fixture(scope="session")
def program():
    """A program of voltages that turns the robot."""
    waveform = Waveform.hold(0.02, {"xp": 20.0, "yp": 9.0})
    return simulate(
        Scenario(drive=Drive(mode="program", program=waveform), record=Record(rate=2000.0))
    )
