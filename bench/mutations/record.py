"""Which tests run a line of the package, by coverage.py (``pip install --group coverage``)."""

from __future__ import annotations

import ast
import functools
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

from mutations.trial import ROOT, SCRATCH

_SOURCES = ROOT / "python"


class Record:
    """Lines that each daily test runs in its process; those of child processes are not seen.

    It is made, in minutes, where none is newer than the sources and the tests.
    """

    def __init__(self, package: Path, tests: list[str]) -> None:
        from coverage import CoverageData

        path = SCRATCH / "+".join(tests).replace("/", ".")
        files = *_SOURCES.rglob("*.py"), *(ROOT / "tests").rglob("*.py")
        latest = max(each.stat().st_mtime for each in files)
        if not path.exists() or path.stat().st_mtime < latest:
            self._make(path, package, tests)
        self._data = CoverageData(str(path))
        self._data.read()
        self._names = {each.rpartition("/python/")[2]: each for each in self._data.measured_files()}

    def _make(self, path: Path, package: Path, tests: list[str]) -> None:
        """Run the tests with a copy of the package."""
        print(f"recording the lines of each test in {path.relative_to(ROOT)}", file=sys.stderr)
        made = package.parent / "lines"
        command = [sys.executable, "-m", "pytest", "-q", "-n2", "-pno:cacheprovider", *tests]
        command += ["--cov=stickslip", "--cov-context=test", "--cov-report="]
        os.environ["COVERAGE_CORE"] = "ctrace"  # the only one that knows contexts
        environment = {**os.environ, "COVERAGE_FILE": str(made), "PYTHONPATH": str(package)}
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
        if done.returncode not in (0, 1) or not made.exists():
            sys.exit(f"no record: {done.stdout}{done.stderr}")
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(made, path)

    @functools.cache  # noqa: B019  there is one record
    def _tests(self, path: Path) -> dict[int, set[str]]:
        """Tests by line of a source."""
        name = self._names.get(path.relative_to(_SOURCES).as_posix(), "")
        lines = self._data.contexts_by_lineno(name).items()
        return {line: {each.rpartition("|")[0] for each in tests if each} for line, tests in lines}

    def near(self, file: str, line: int) -> list[str]:
        """Tests that run a line, those first that run few lines of the file.

        One case of each function comes before its other cases. The rest of their files comes last:
        a fixture or a stored result may have run the line for these.
        """
        by_line = self._tests(ROOT / file)
        starts, later = _statements(ROOT / file)
        start = starts.get(line, line)
        if line in later:
            found = by_line.get(line) or by_line.get(start, set())
        else:
            text = (ROOT / file).read_text(encoding="utf-8").splitlines()[start - 1]
            name = re.match(r"\s*(?:def |class )?(\w+)(?= *[:=(,.])|", text)[1]
            found = self._users(name) or set().union(*by_line.values())
        size = Counter(test for tests in by_line.values() for test in tests)
        ranked = sorted(found, key=lambda test: (not size[test], size[test], test))
        firsts: dict[str, str] = {}
        for test in ranked:
            firsts.setdefault(test.partition("[")[0], test)
        files = {test.partition("::")[0] for test in found}
        known = {each.rpartition("|")[0] for each in self._data.measured_contexts()}
        rest = sorted(test for test in known if test.partition("::")[0] in files)
        return list(dict.fromkeys([*firsts.values(), *ranked, *rest]))

    def _users(self, name: str | None) -> set[str]:
        """Tests that run lines of functions with a name that is bound at import."""
        return set().union(*(
            self._tests(path).get(line, ())
            for path in (_SOURCES.rglob("*.py") if name else ())
            for line, text in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
            if re.search(rf"\b{name}\b", text) and line in _statements(path)[1]
        ))  # fmt: skip


@functools.cache
def _statements(path: Path) -> tuple[dict[int, int], set[int]]:
    """Start of the innermost statement of each line; lines that run later than the import."""
    starts, later = {}, set()
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.stmt):
            starts |= dict.fromkeys(range(node.lineno, node.end_lineno + 1), node.lineno)
        if isinstance(node, ast.FunctionDef):
            later.update(range(node.body[0].lineno, node.end_lineno + 1))
    return starts, later
