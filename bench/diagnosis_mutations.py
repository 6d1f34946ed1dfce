"""Whether the tests of the diagnosis see a change of its engine.

``python bench/diagnosis_mutations.py`` draws changes by a seed, one place of one file each: a
comparison that is turned round, a sign, a number times 1.5, a guard that never holds. Each is made
in a copy of the package, with which the fast tests in tests/diagnosis run until the first fails.
What none sees is printed as SURVIVES: a test is missing, or the change makes no difference.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
SCRATCH = ROOT / "build" / "diagnosis_mutations"
ENGINE = Path("stickslip") / "diagnosis"
TESTS = ROOT / "tests" / "diagnosis"
KINDS = ("comparison", "sign", "number", "guard")

_TURNED = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
_WORDS = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}
_LEAVES = ast.Return, ast.Raise, ast.Continue, ast.Break


class Mutation(NamedTuple):
    """Letters from `start` to `stop` of `file` become `text`."""

    file: Path
    kind: str
    start: int
    stop: int
    text: str


def mutations(file: Path, source: str) -> Iterator[Mutation]:
    """All that can be made in a file."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line.encode()))

    def begin(node: ast.expr) -> int:
        return starts[node.lineno - 1] + node.col_offset

    def end(node: ast.expr) -> int:
        return starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0)

    def between(left: ast.expr, right: ast.expr, old: str, new: str, kind: str) -> Mutation | None:
        at = source.encode().find(old.encode(), end(left), begin(right))
        return None if at < 0 else Mutation(file, kind, at, at + len(old), new)

    for node in ast.walk(ast.parse(source)):
        found = None
        if isinstance(node, ast.Compare) and type(node.ops[0]) in _WORDS:
            word = _WORDS[type(node.ops[0])]
            found = between(node.left, node.comparators[0], word, _TURNED[word], "comparison")
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
            old, new = ("+", "-") if isinstance(node.op, ast.Add) else ("-", "+")
            found = between(node.left, node.right, old, new, "sign")
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            found = Mutation(file, "sign", begin(node), begin(node) + 1, "")
        elif isinstance(node, ast.Constant) and type(node.value) is float and node.value:
            found = Mutation(file, "number", begin(node), end(node), repr(1.5 * node.value))
        elif isinstance(node, ast.If) and not node.orelse and isinstance(node.body[-1], _LEAVES):
            found = Mutation(file, "guard", begin(node.test), end(node.test), "False")
        if found is not None:
            yield found


def drawn(seed: int, count: int) -> list[Mutation]:
    """As many of each kind as of the others, all of other places."""
    package = ROOT / "python"
    every = [
        each
        for path in sorted((package / ENGINE).rglob("*.py"))
        if path.parent.name != "report"
        for each in mutations(path.relative_to(package), path.read_text(encoding="utf-8"))
    ]
    choice = random.Random(seed)
    choice.shuffle(every)
    kinds = {kind: iter([each for each in every if each.kind == kind]) for kind in KINDS}
    return [next(kinds[KINDS[k % len(KINDS)]]) for k in range(count)]


def survives(mutation: Mutation, package: Path, limit: float, near: bool) -> str:
    """The test that sees it; empty if none does."""
    path = package / mutation.file
    original = path.read_bytes()
    module = str(mutation.file.with_suffix("")).replace("/", ".")
    # Tests that name the module see most: they come first.
    files = sorted(TESTS.glob("test_*.py"), key=lambda each: module not in each.read_text())
    if near:
        files = [each for each in files if module in each.read_text()] or files
    options = ["-q", "-x", "--no-header", "-p", "no:cacheprovider"]
    changed = original[: mutation.start] + mutation.text.encode() + original[mutation.stop :]
    try:
        path.write_bytes(changed)
        done = subprocess.run(
            [sys.executable, "-m", "pytest", *options, *map(str, files)],
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": str(package), "PYTHONDONTWRITEBYTECODE": "1"},
            capture_output=True,
            text=True,
            check=False,
            timeout=limit,
        )
    except subprocess.TimeoutExpired:
        return "the time"
    finally:
        path.write_bytes(original)
    failed = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("FAILED ")]
    failed += [line for line in done.stdout.splitlines() if line.startswith("ERROR ")]
    return failed[0].removeprefix("tests/diagnosis/") if failed else ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--limit", type=float, default=900.0, help="seconds of the tests of one")
    parser.add_argument("--near", action="store_true", help="only tests that name the module")
    arguments = parser.parse_args()
    shutil.rmtree(SCRATCH, ignore_errors=True)
    shutil.copytree(
        ROOT / "python", SCRATCH / "python", ignore=shutil.ignore_patterns("__pycache__")
    )
    seen = 0
    chosen = drawn(arguments.seed, arguments.count)
    for mutation in chosen:
        started = time.monotonic()
        source = (SCRATCH / "python" / mutation.file).read_bytes()
        line = source[: mutation.start].count(b"\n") + 1
        old = source[mutation.start : mutation.stop].decode()
        by = survives(mutation, SCRATCH / "python", arguments.limit, arguments.near)
        seen += bool(by)
        place = f"{mutation.file.relative_to(ENGINE)}:{line}"
        what = f"{' '.join(old.split())} -> {mutation.text or 'nothing'}"
        print(f"{place:32} {what:40} {by or 'SURVIVES'} ({time.monotonic() - started:.0f} s)",
              flush=True)  # fmt: skip
    print(f"{seen} of {len(chosen)} seen")
    return 0 if seen == len(chosen) else 1


if __name__ == "__main__":
    sys.exit(main())
