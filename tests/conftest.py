"""Results that several files of tests look at."""

import os
import signal
import tempfile

# Threads of the linear algebra wait for each other by spinning: beside other workers a QR
# decomposition of 449 x 110 numbers takes a hundred times the processor time that it takes alone.
# Before numpy is imported, and for the processes that tests start.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# A kernel of the reference is compiled by one worker for all. Each session has a folder of its own,
# since numba does not see a change of what a stored kernel calls.
if "NUMBA_CACHE_DIR" not in os.environ:
    kernels = tempfile.TemporaryDirectory()
    os.environ["NUMBA_CACHE_DIR"] = kernels.name

import pytest
from hypothesis import HealthCheck, Phase, settings

from stickslip import Drive, Record, Scenario, Waveform, _core, simulate

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


@pytest.hookimpl(wrapper=True)
def pytest_collection_modifyitems(config, items):
    for item in items:
        mark = item.get_closest_marker("daily")
        if mark and not {item.callspec.id, *item.callspec.id.split("-")} & {*mark.args}:
            item.add_marker("nightly")
    yield
    part = config.getoption("--part")  # of the tests that the markers leave
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


@pytest.fixture(scope="module")
def frozen_effect():
    """The effect of a user that some of the frozen scenarios have."""
    from frozen.scenarios import OWN_NAME, register_own_effect  # imports numba

    register_own_effect()
    yield
    _core.unregister_effect(OWN_NAME)


@pytest.fixture(scope="session")
def walk_ipp():
    """The paper's robot in twelve pulses in the plane, recorded at 2 kHz."""
    return simulate(Scenario(drive=Drive(base=0.5e-3, pulses=12), record=Record(rate=2000.0)))


@pytest.fixture(scope="session")
def steered():
    """A walk along a heading of 1.5 rad, in the whole plane."""
    drive = Drive(base=0.5e-3, pulses=5, heading=1.5)
    return simulate(Scenario(drive=drive, record=Record(rate=2000.0)))


@pytest.fixture(scope="session")
def program():
    """A program of voltages that turns the robot."""
    waveform = Waveform.hold(0.02, {"xp": 20.0, "yp": 9.0})
    return simulate(
        Scenario(drive=Drive(mode="program", program=waveform), record=Record(rate=2000.0))
    )
