"""A change is made in a copy of the sources, and tests run with the copy until one fails."""

from __future__ import annotations

import importlib
import multiprocessing
import os
import re
import resource
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCRATCH = ROOT / "build" / "mutations"
_NEAR = 40  # tests that run for a change
_FIRST = 10  # of them on their own, as collecting the others takes seconds
_GOLDEN = "tests/test_golden.py::test_a_problem_is_answered_as_before"
_FAILED = r"^(?:FAILED|ERROR) ([^\s[]+(?:\[.*?\])?)(?: - |$)|while loading (conftest)"
_PATIENCE = 60  # CPU seconds, more than a test takes
PAIRS = ("<", ">="), (">", "<="), ("==", "!="), ("+", "-"), ("*", "/")


def turned(*pairs: tuple[str, str]) -> dict[bytes, str]:
    """What becomes of an operator: the other one of its pair."""
    return {old.encode(): new for pair in pairs for old, new in (pair, pair[::-1])}


class Mutation(NamedTuple):
    """Bytes from `start` to `stop` of `file`, below the project's folder, become `text`."""

    file: str
    line: int
    start: int
    stop: int
    text: str


class Trial:
    """Verdicts of the tests on one change after the other.

    The copy of the sources has them in `folder`, the package below `package`. It builds that with a
    changed file, or has a verdict, and says which tests in Python are near.
    """

    def __init__(self, copy: Any, limit: float) -> None:
        self.copy, self.limit = copy, limit
        for name in "hypothesis", "scipy.optimize", "scipy.stats":
            importlib.import_module(name)  # once for all forks, as it takes seconds
        self.sound = {"hangs", "conftest"}  # and tests that pass without a change
        self.broken: set[str] = set()  # and those that do not

    def judged(self, mutation: Mutation) -> tuple[str, str]:
        """seen, survives or unbuilt, and the test that sees it."""
        # Not the frozen runs, which see each bit and state nothing.
        near = self.copy.near(mutation.file, mutation.line)
        near = [each for each in near if "test_frozen_runs" not in each][:_NEAR]
        path = self.copy.folder / mutation.file
        original = path.read_bytes()
        try:
            start, stop, text = mutation[2:]
            path.write_bytes(original[:start] + text.encode() + original[stop:])
            if verdict := self.copy.build(path, self.limit):
                return verdict
            for part in near[:_FIRST], [_GOLDEN], near[_FIRST:]:
                while part and (test := self._pytest(part, self.copy.package)):
                    if test in self.sound or not self._pytest([test], None):
                        self.sound.add(test)
                        return "seen", test
                    self.broken.add(test)
            return "survives", "" if near else "no test runs or names it"
        finally:
            path.write_bytes(original)

    def pytest_runtest_teardown(self, item: pytest.Item) -> None:
        """As a plugin: no further test begins after the CPU seconds of the limit."""
        if time.process_time() > self.limit:
            item.session.shouldstop = "the budget is spent"

    def _pytest(self, tests: Sequence[str], package: Path | None) -> str:
        """The first test that fails or hangs; without a package, with the installed one."""
        command = ["-q", "-x", "--no-header", "-p", "no:cacheprovider", f"--rootdir={ROOT}"]
        for each in self.broken:  # a file alone is known to pytest where it cannot be collected
            command += [f"--deselect={each}", f"--ignore={ROOT / each}"]
        paths = [str(package)] if package else []

        def call() -> int:
            sys.path[:0] = paths
            paths.append(os.environ["PYTHONPATH"])
            os.environ["PYTHONPATH"] = os.pathsep.join(paths)  # for processes that tests start
            os.chdir(ROOT)
            return pytest.main([*command, *tests], plugins=[self])

        status, said = limited(call, self.limit)
        if status < 0:
            return "hangs"
        failed = re.search(_FAILED, said, re.MULTILINE)
        if failed is None and status not in (0, 2, 5):  # 2: the budget is spent
            sys.exit(f"pytest ended with {status}\n{said}")
        return failed[failed.lastindex] if failed else ""


def limited(call: Callable[[], int], limit: float) -> tuple[int, str]:
    """Call in a fork, stopped well after its CPU seconds; what `call` returns and prints."""
    hard = int(limit) + _PATIENCE

    def child() -> None:
        os.setsid()
        resource.setrlimit(resource.RLIMIT_CPU, (hard, hard + 5))
        os.dup2(said.fileno(), 1)
        os.dup2(said.fileno(), 2)
        sys.exit(call())

    with tempfile.TemporaryFile() as said:
        process = multiprocessing.get_context("fork").Process(target=child)
        process.start()
        try:
            process.join(20 * hard)
        finally:
            if process.is_alive():
                os.killpg(process.pid, signal.SIGKILL)
                process.join()
        said.seek(0)
        return process.exitcode, said.read().decode(errors="replace")
