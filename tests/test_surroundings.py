"""The package where it is not at home: frozen, without docstrings, in other locales and systems."""

import compileall
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import stickslip
from command_line import python_process
from stickslip.cli.commands import COMMANDS

SCENARIO = "é λ.toml"
LONG = "x" * 250 + "é"  # with .nc the 255 bytes that a name can have
STYLE = "axes.facecolor: black\nsavefig.facecolor: black\ntext.usetex: True\nlines.linewidth: 9\n"

# What the commands say of themselves, and a run and a sweep with files.
CODE = """
import sys
import stickslip
from stickslip.cli.commands import COMMANDS, run

print(len(dir(stickslip)), flush=True)
scenario, long = sys.argv[1:]
for arguments in (
    *([name, "--help"] for name in COMMANDS),
    ["run", scenario, "--json", "--out", f"{long}.nc", "--plot", f"{long[1:]}.png"],
    ["run", scenario, "--out", f"{long[1:]}.csv"],
    ["sweep", scenario, "--vary", "drive.frequency=20,30", "--out", f"y{long[1:]}.nc"],
    ["sweep", scenario, "--vary", "drive.frequency=20,30", "--out", f"y{long[1:]}.nc", "--resume"],
):
    print(ascii(run(arguments)), flush=True)
"""


def frozen(folder):
    """Bytecode without docstrings alone, and no file for type checkers."""
    shutil.copytree(Path(stickslip.__file__).parent, folder / "stickslip")
    compileall.compile_dir(folder / "stickslip", quiet=1, legacy=True, optimize=2)
    for path in (folder / "stickslip").rglob("*.py*"):
        if path.suffix in (".py", ".pyi"):
            path.unlink()
    return {"PYTHONPATH": str(folder), "PYTHONOPTIMIZE": "2"}


def another_user(folder):
    """Surroundings with a style of plots and ASCII file names, in which other bytes are escapes."""
    (folder / "matplotlibrc").write_text(STYLE)
    locale = {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
    return {"MATPLOTLIBRC": str(folder), **locale}


def done_in(folder, where):
    """Output and files of the commands in some surroundings."""
    around, inside = folder / "around", folder / "inside"
    for each in (around, inside):
        each.mkdir()
    (inside / SCENARIO).write_text("stickslip = 1\n[drive]\npulses = 4\nbase = 0.5e-3\n")
    command = [sys.executable, "-c", CODE, SCENARIO, LONG]
    how = {"env": {**os.environ, **where(around)}, "cwd": inside, "capture_output": True}
    done = subprocess.run(command, check=True, **how)
    files = {each.name: each.read_bytes() for each in inside.iterdir()}
    return done.stdout, files


@pytest.fixture(scope="module")
def at_home(tmp_path_factory):
    printed, files = done_in(tmp_path_factory.mktemp("home"), lambda folder: {})
    assert printed.count(b"Usage: ") == len(COMMANDS)
    assert sorted(len(os.fsencode(name)) for name in files) == [10, 255, 255, 255, 255]
    return printed, files


@pytest.mark.nightly
@pytest.mark.parametrize("where", [another_user, frozen])
def test_all_is_as_at_home(tmp_path, at_home, where):
    printed, files = done_in(tmp_path, where)
    assert printed.decode("utf-8", "replace") == at_home[0].decode()
    assert files == at_home[1]


def test_the_names_are_known_within_an_archive(tmp_path):
    with zipfile.ZipFile(tmp_path / "packages.zip", "w") as archive:
        for path in Path(stickslip.__file__).parent.glob("*.py"):
            archive.write(path, f"stickslip/{path.name}")
    code = "import stickslip; print(stickslip.__file__, stickslip.__all__)"
    done = python_process("-c", code, path=[tmp_path / "packages.zip"])
    assert done.stdout.startswith(str(tmp_path))
    assert done.stdout.endswith(f"{stickslip.__all__}\n")


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


@pytest.mark.nightly
def test_modules_runs_and_sweeps_need_nothing_that_other_systems_lack(tmp_path):
    code = HIDDEN + IMPORTS + WORK
    result = python_process("-c", code, cwd=tmp_path, variables={"MPLBACKEND": "agg"})
    assert result.returncode == 0, result.stderr
    written = {each.name for each in tmp_path.iterdir()}
    assert written == {"run.nc", "sweep.nc", "s.toml", "again.csv", "run.png"}
