"""Modules that other systems lack are not needed: here they are hidden from the package."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import stickslip

# Modules and names of os and signal that Windows, macOS or WebAssembly are without.
HIDDEN = """
import os
import signal
import sys

import pytest

for name in ("fcntl", "grp", "pwd", "resource", "termios", "_posixshmem"):
    sys.modules[name] = None
for name in ("fork", "forkpty", "getuid", "geteuid", "mkfifo", "posix_fadvise", "posix_fallocate",
             "sched_getaffinity", "sched_setaffinity", "statvfs", "sysconf"):
    delattr(os, name)
for name in ("SIGALRM", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGUSR1", "pthread_sigmask", "setitimer"):
    delattr(signal, name)
"""

IMPORTS = """
import importlib
import pkgutil
import stickslip

for module in pkgutil.walk_packages(stickslip.__path__, "stickslip."):
    if not module.name.endswith("__main__"):
        importlib.import_module(module.name)
"""

WORK = """
from stickslip import Drive, Record, Scenario, open_run, simulate, sweep

scenario = Scenario(drive=Drive(base=0.5e-3, pulses=4), record=Record(rate=2e3))
run = simulate(scenario, out="run.nc")
assert run.ok and open_run("run.nc").mean_velocity == run.mean_velocity
data = sweep(scenario, {"drive.frequency": [50.0, 100.0]}, out="sweep.nc")
assert float(data["mean_velocity"][1]) == run.mean_velocity
with open("s.toml", "w", encoding="utf-8") as file:
    file.write(scenario.to_toml())
from stickslip.__main__ import main

main(["run", "s.toml", "--out", "again.csv", "--plot", "run.png"])
"""


def python(code, folder):
    source = str(Path(stickslip.__file__).parents[1])
    path = os.pathsep.join([source, *filter(None, [os.environ.get("PYTHONPATH")])])
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path, "MPLBACKEND": "agg"},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.mark.nightly
def test_modules_runs_and_sweeps_need_nothing_that_other_systems_lack(tmp_path):
    result = python(HIDDEN + IMPORTS + WORK, tmp_path)
    assert result.returncode == 0, result.stderr
    written = {each.name for each in tmp_path.iterdir()}
    assert written == {"run.nc", "sweep.nc", "s.toml", "again.csv", "run.png"}
