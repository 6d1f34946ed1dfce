"""Drawn changes of the sources of a language, tried one by one: ``bench mutations python | core``.

Lines are drawn by a seed, each with the same weight, and one change of each: a comparison turned
round, a sign, a number, a condition. Each is made in a copy, and the nearest tests run with the
copy until one fails. A change that none sees SURVIVES: a test is missing, or the change makes no
difference. Results are appended to a file of JSON lines; a change that is there is not tried again.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import random
import re
import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import hypothesis  # noqa: F401  for the forks, as the following
import pytest
import scipy.optimize
import scipy.stats  # noqa: F401

from mutations.near import near_tests

ROOT = Path(__file__).resolve().parents[2]
NEAR = 40  # tests that run for a change
_FIRST = 10  # of them on their own, as collecting the others takes seconds
_HANGS, _NO_IMPORT = "hangs", "cannot be imported"
_PATIENCE = 60  # CPU seconds, more than a test takes


class Mutation(NamedTuple):
    """Bytes from `start` to `stop` of `file`, below the project's folder, become `text`."""

    file: str
    line: int
    start: int
    stop: int
    text: str

    def made_in(self, source: bytes) -> bytes:
        return source[: self.start] + self.text.encode() + source[self.stop :]


class Copy:
    """A copy of the sources, in which one change at a time is tried."""

    folder: Path
    """The project's folder in the copy."""
    package: Path
    """Folder in which Python finds the package of the copy."""

    def build(self) -> bool:
        """Make the package of the sources; whether there is one."""
        return True

    def own_tests(self, limit: float) -> str:
        """The first test in the language itself that fails."""
        return ""


def drawn(language: ModuleType, seed: int, count: int) -> list[Mutation]:
    """Changes of as many lines."""
    sources, lines = {}, {}
    for path in sorted({path for pattern in language.FILES for path in ROOT.glob(pattern)}):
        file = path.relative_to(ROOT).as_posix()
        sources[file] = path.read_bytes()
        for each in language.mutations(file, sources[file]):
            lines.setdefault((file, each.line), []).append(each)
    choice = random.Random(seed)
    result: list[Mutation] = []
    for line in choice.sample(sorted(lines), len(lines)):
        if len(result) == count:
            break
        fit = [each for each in lines[line] if language.can_be_read(each.made_in(sources[line[0]]))]
        result += [choice.choice(fit)] if fit else []
    return result


def tests_of(mutation: Mutation) -> list[str]:
    """The nearest; not the frozen runs, which see each bit and state nothing."""
    near = near_tests(ROOT, mutation.file, mutation.line)
    return [each for each in near if "test_frozen_runs" not in each][:NEAR]


class Trial:
    """Verdicts of the tests on one change after the other."""

    def __init__(self, copy: Copy, limit: float) -> None:
        self.copy, self.limit = copy, limit
        self.sound = {_HANGS, _NO_IMPORT}  # and tests that pass without a change
        self.broken: set[str] = set()  # and those that do not

    def judged(self, mutation: Mutation) -> tuple[str, str]:
        """seen, survives or unbuilt, and the test that sees it."""
        path = self.copy.folder / mutation.file
        original = path.read_bytes()
        try:
            path.write_bytes(mutation.made_in(original))
            if not self.copy.build():
                return "unbuilt", ""
            near = tests_of(mutation)
            for part in near[:_FIRST], near[_FIRST:]:
                while test := self._pytest(part, self.copy.package):
                    if test in self.sound or not self._pytest([test], None):
                        self.sound.add(test)
                        return "seen", test
                    self.broken.add(test)
            test = self.copy.own_tests(self.limit)
            return ("seen" if test else "survives"), test
        finally:
            path.write_bytes(original)

    def _pytest(self, tests: Sequence[str], package: Path | None) -> str:
        """The first test that fails or hangs; without a package, with the installed one."""
        known = [each for each in self.broken if "::" in each]
        command = ["-q", "-x", "--no-header", "-p", "no:cacheprovider", "-p", "mutations.budget"]
        command += [f"--budget={self.limit}", f"--rootdir={ROOT}"]
        command += [f"--deselect={each}" for each in known]
        # The file's name alone is known to pytest where a whole file cannot be collected.
        command += [f"--ignore={ROOT / each}" for each in self.broken.difference(known)]
        paths = [str(path) for path in (package, ROOT / "tests", ROOT / "bench", ROOT) if path]

        def call() -> int:
            os.environ["PYTHONPATH"] = os.pathsep.join(paths)  # for processes that tests start
            sys.path[:0] = paths
            os.chdir(ROOT)
            return pytest.main([*command, *tests])

        status, said = limited(call, self.limit)
        if status == pytest.ExitCode.USAGE_ERROR and "while loading conftest" in said:
            return _NO_IMPORT
        if status < 0:
            return _HANGS
        failed = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - |$)", said, re.MULTILINE)
        if failed is None and status not in (0, 2, 5):  # 2: the budget is spent
            sys.exit(f"pytest ended with {status}\n{said}")
        return failed[1] if failed else ""


def limited(call: Callable[[], int], limit: float) -> tuple[int, str]:
    """Call in a fork, stopped well after its CPU seconds; what `call` returns and prints.

    A fork has already imported what takes pytest seconds.
    """
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


def main(language: ModuleType, words: list[str]) -> int:
    parser = argparse.ArgumentParser(language.__name__, description=language.__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=30, help="lines to draw")
    parser.add_argument("--part", default="1/1", metavar="K/N", help="every Nth from the Kth on")
    parser.add_argument("--limit", type=float, default=60.0, help="CPU seconds of the tests of one")
    parser.add_argument("--out", type=Path, help="JSON lines, to which results are appended")
    options = parser.parse_args(words)
    chosen = drawn(language, options.seed, options.count)
    part, parts = map(int, options.part.split("/"))
    known = {}
    if options.out is not None and options.out.exists():
        rows = map(json.loads, options.out.read_text().splitlines())
        known = {(row["file"], row["line"], row["change"]): row for row in rows}
    trial = None
    verdicts: Counter[str] = Counter()
    for mutation in chosen[part - 1 :: parts]:
        old = (ROOT / mutation.file).read_bytes()[mutation.start : mutation.stop].decode()
        place = (
            mutation.file,
            mutation.line,
            f"{' '.join(old.split())} -> {mutation.text or 'nothing'}",
        )
        row = known.get(place)
        if row is None:
            trial = trial or Trial(language.Copy(), options.limit)
            started = time.monotonic()
            verdict, test = trial.judged(mutation)
            row = {
                **dict(zip(("file", "line", "change"), place, strict=True)),
                "seed": options.seed,
                "verdict": verdict,
                "test": test,
                "seconds": round(time.monotonic() - started),
            }
            if options.out is not None:
                with options.out.open("a") as out:
                    print(json.dumps(row), file=out)
        verdicts[row["verdict"]] += 1
        print(f"{place[0]}:{place[1]}: {place[2]}: {row['verdict']} {row['test']}", flush=True)
    print(", ".join(f"{count} {verdict}" for verdict, count in verdicts.items()))
    return int(verdicts["survives"] > 0)
