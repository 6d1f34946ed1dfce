"""Results that several files of tests look at."""

import json
import signal

import pytest

from command_line import stickslip_process
from made_measurement import write

# Shells start what runs in the background with interrupts ignored, and so would be all commands
# that the tests interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def tilted(tmp_path_factory):
    """The folder of a diagnosis of a surface that tilts by 0.04 rad, and what ``--json`` said."""
    folder = tmp_path_factory.mktemp("tilted")
    path = write(folder, {"effects.surface_tilt.angle": 0.04})
    # Jobs are stated, so that a test can compare with another number on any machine.
    done = stickslip_process("diagnose", path, "--out", folder / "found", "--json", "--jobs", 2)
    assert done.returncode == 0, done.stderr
    return folder, json.loads(done.stdout)
