"""Whether the tests see a change of the Python package.

Draws lines by a seed, each with the same weight, and one change of each: a comparison turned round,
a sign, a number, a condition, a call left out. Each is made in a copy of the package; the tests
near its module run with the copy until one fails. A change that none sees SURVIVES: a test is
missing, or the change makes no difference. Results are appended to a file of JSON lines, in which
a change that is there already is not tried again.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from mutations.near import near_tests

HERE = Path(__file__).resolve().parents[2]
NEAR = 12  # files of tests that are run for a change
APART = ("diagnosis", "measurement")
"""Packages that are drawn only where they are named."""

_WORDS = {
    ast.Lt: ("<", ">="),
    ast.LtE: ("<=", ">"),
    ast.Gt: (">", "<="),
    ast.GtE: (">=", "<"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}
_UNFELT = "frozen", "slots", "strict", "kw_only"  # of dataclasses and zip
_LEAVES = ast.Return, ast.Raise, ast.Continue, ast.Break


class Mutation(NamedTuple):
    """Bytes from `start` to `stop` of `file`, in the package, become `text`."""

    file: str
    line: int
    start: int
    stop: int
    text: str


def mutations(file: str, source: bytes) -> Iterator[Mutation]:
    """All that can be made in a file."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def begin(node: ast.AST) -> int:
        return starts[node.lineno - 1] + node.col_offset

    def end(node: ast.AST) -> int:
        return starts[node.end_lineno - 1] + node.end_col_offset

    def between(left: ast.AST, right: ast.AST, operator: ast.AST) -> tuple[int, int, str] | None:
        old, new = _WORDS.get(type(operator), ("", ""))
        at = source.find(old.encode(), end(left), begin(right)) if old else -1
        return None if at < 0 else (at, at + len(old), new)

    for node in _runtime(ast.parse(source)):
        found = None
        match node:
            case ast.Compare(left, [operator, *_], [right, *_]):
                found = between(left, right, operator)
            case ast.BinOp(left, operator, right):
                found = between(left, right, operator)
            case ast.BoolOp(operator, [left, right, *_]):
                found = between(left, right, operator)
            case ast.UnaryOp(ast.USub() | ast.Not(), operand):
                found = (begin(node), begin(operand), "")
            case ast.Constant(bool()):
                found = (begin(node), end(node), str(not node.value))
            case ast.Constant(float()) if node.value:
                found = (begin(node), end(node), repr(1.5 * node.value))
            case ast.Constant(int()):
                found = (begin(node), end(node), repr(node.value + 1))
            case ast.If(test, [*_, last], []) if isinstance(last, _LEAVES):
                found = (begin(test), end(test), "False")
            case ast.If(test) | ast.IfExp(test):
                inner = source[begin(test) : end(test)].decode()
                found = (begin(test), end(test), f"not ({inner})")
            case ast.Expr(ast.Call()):
                found = (begin(node), end(node), "None")
        if found is not None:
            yield Mutation(file, source[: found[0]].count(b"\n") + 1, *found)


def _runtime(tree: ast.AST) -> Iterator[ast.AST]:
    """The nodes that run: no annotations, nothing for type checkers, no parts of f-strings."""
    for field, value in ast.iter_fields(tree):
        if field in ("annotation", "returns"):
            continue
        for node in value if isinstance(value, list) else [value]:
            if not isinstance(node, ast.AST) or isinstance(node, ast.JoinedStr):
                continue
            if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
                continue
            if isinstance(node, ast.keyword) and node.arg in _UNFELT:
                continue
            yield node
            yield from _runtime(node)


def _compiles(source: bytes, each: Mutation) -> bool:
    try:
        compile(source[: each.start] + each.text.encode() + source[each.stop :], "changed", "exec")
    except SyntaxError:
        return False
    return True


def drawn(package: Path, names: list[str], seed: int, count: int) -> list[Mutation]:
    """Changes of as many lines; packages as named, without names all but those apart."""
    lines: dict[tuple[str, int], list[Mutation]] = {}
    sources = {}
    for path in sorted(package.rglob("*.py")):
        file = path.relative_to(package).as_posix()
        name = file.partition("/")[0].removesuffix(".py")
        if name in names if names else name not in APART:
            sources[file] = path.read_bytes()
            for each in mutations(file, sources[file]):
                lines.setdefault((file, each.line), []).append(each)
    choice = random.Random(seed)
    result = []
    for line in choice.sample(sorted(lines), len(lines)):
        if len(result) == count:
            break
        fit = [each for each in lines[line] if _compiles(sources[each.file], each)]
        result += [choice.choice(fit)] if fit else []
    return result


class Copy:
    """A copy of the package, in which one change at a time is tried."""

    def __init__(self, root: Path, core: Path | None, folder: Path, limit: float) -> None:
        self.root, self.limit, self.python = root, limit, folder / "python"
        ignore = shutil.ignore_patterns("__pycache__")
        shutil.copytree(root / "python", self.python, ignore=ignore)
        if core is not None:
            shutil.copy(core, self.python / "stickslip")
        self.broken: set[str] = set()  # tests that fail without a change too

    def judged(self, mutation: Mutation) -> tuple[str, str]:
        """seen, survives or unfinished, and the test that sees it."""
        path = self.python / "stickslip" / mutation.file
        original = path.read_bytes()
        changed = original[: mutation.start] + mutation.text.encode() + original[mutation.stop :]
        files = near_tests(self.root, f"python/stickslip/{mutation.file}", mutation.line)[:NEAR]
        while True:
            try:
                path.write_bytes(changed)
                ended, test = self._pytest(list(map(str, files)))
            finally:
                path.write_bytes(original)
            if not test:
                return ("survives" if ended else "unfinished"), ""
            again = self._pytest([test])
            if again == (True, ""):
                return "seen", test
            if test in self.broken:
                return "unfinished", f"fails in any case: {test}"
            self.broken.add(test)

    def _pytest(self, what: list[str]) -> tuple[bool, str]:
        """Whether it came to an end, and the first test that failed."""
        options = ["-q", "-x", "--no-header", "-p", "no:cacheprovider", "--rootdir", self.root]
        # The file's name alone is known to pytest where a whole file cannot be collected.
        options += [f"--deselect={each}" for each in self.broken if "::" in each]
        options += [f"--ignore={self.root / each}" for each in self.broken if "::" not in each]
        paths = [self.python, self.root / "tests", self.root / "bench", self.root]
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(map(str, paths)),
            "PYTHONDONTWRITEBYTECODE": "1",
            "OPENBLAS_NUM_THREADS": "1",
        }
        process = subprocess.Popen(
            [sys.executable, "-m", "pytest", *map(str, options), *what],
            cwd=self.root,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
            preexec_fn=lambda: resource.setrlimit(
                resource.RLIMIT_CPU, (int(self.limit), int(self.limit) + 5)
            ),
        )
        try:
            said, _ = process.communicate(timeout=4 * self.limit)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            said, _ = process.communicate()
        words = [line.split() for line in said.splitlines()]
        failed = [line[1] for line in words if line[:1] in (["FAILED"], ["ERROR"]) and line[1:]]
        return process.returncode >= 0, failed[0] if failed else ""


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser("bench mutations python", description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=30, help="lines to draw")
    parser.add_argument("--package", action="append", help="of stickslip, or a module of the top")
    parser.add_argument("--part", default="1/1", metavar="K/N", help="every Nth from the Kth on")
    parser.add_argument("--limit", type=float, default=90.0, help="CPU seconds of the tests of one")
    parser.add_argument("--root", type=Path, default=HERE, help="folder of the project")
    parser.add_argument("--core", type=Path, help="the built _core module, if not in the sources")
    parser.add_argument("--out", type=Path, help="JSON lines, to which results are appended")
    parser.add_argument("--list", action="store_true", help="print the changes, try none")
    options = parser.parse_args(arguments)
    root = options.root.resolve()
    package = root / "python" / "stickslip"
    chosen = drawn(package, options.package or [], options.seed, options.count)
    part, parts = map(int, options.part.split("/"))
    known = {}
    if options.out is not None and options.out.exists():
        rows = map(json.loads, options.out.read_text().splitlines())
        known = {(row["file"], row["line"], row["change"]): row for row in rows}
    verdicts = []
    with tempfile.TemporaryDirectory(prefix="mutations") as folder:
        copy = None if options.list else Copy(root, options.core, Path(folder), options.limit)
        for mutation in chosen[part - 1 :: parts]:
            old = (package / mutation.file).read_bytes()[mutation.start : mutation.stop].decode()
            change = f"{' '.join(old.split())} -> {mutation.text or 'nothing'}"
            row = known.get((mutation.file, mutation.line, change))
            if copy is None:
                row = {
                    "verdict": "",
                    "test": " ".join(
                        p.stem
                        for p in near_tests(
                            root, f"python/stickslip/{mutation.file}", mutation.line
                        )[:NEAR]
                    ),
                }
            elif row is None:
                started = time.monotonic()
                verdict, test = copy.judged(mutation)
                row = {
                    "seed": options.seed,
                    "file": mutation.file,
                    "line": mutation.line,
                    "change": change,
                    "verdict": verdict,
                    "test": test,
                    "seconds": round(time.monotonic() - started),
                }
                if options.out is not None:
                    with options.out.open("a") as out:
                        print(json.dumps(row), file=out)
            verdicts.append(row["verdict"])
            place = f"{mutation.file}:{mutation.line}"
            print(f"{place:34} {change:44} {row['verdict']:10} {row['test']}", flush=True)
    if not options.list:
        counts = {each: verdicts.count(each) for each in ("seen", "survives", "unfinished")}
        print(", ".join(f"{count} {each}" for each, count in counts.items()))
    return int("survives" in verdicts)
