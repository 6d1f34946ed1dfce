"""`python -m bench`: its list, the options of each program, and the counts that one prints."""

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

BENCH = Path(__file__).resolve().parents[1] / "bench"
PROGRAMS = runpy.run_path(str(BENCH / "__main__.py"))["PROGRAMS"]


def bench(*words):
    command = [sys.executable, "-m", "bench", *words]
    return subprocess.run(command, cwd=BENCH.parent, capture_output=True, text=True, check=False)


def test_the_list_has_each_program():
    assert [each.split()[0] for each in bench("list").stdout.splitlines()[2:]] == list(PROGRAMS)
    assert bench("lost").returncode == 2


@pytest.mark.parametrize("name", PROGRAMS)
@pytest.mark.daily("lines", "score", "against")
def test_a_program_has_help(name):
    done = bench(name, "--help")
    assert (done.returncode, done.stderr) == (0, "")
    assert f"bench {name}" in done.stdout or "usage: " in done.stdout
