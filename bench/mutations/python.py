"""Changes of the Python package, also a call left out; the tests that run a line are nearest."""

from __future__ import annotations

import ast
import compileall
import importlib.util
import itertools
import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from py_compile import PycInvalidationMode

from mutations.record import Record
from mutations.trial import PAIRS, ROOT, turned

FILES = ("python/stickslip/**/*.py",)
_TURNED = turned(*PAIRS, ("and", "or"), ("is", "is not"), ("in", "not in"))
_OPERATOR = re.compile(rb"\b(is not|not in|is|in|and|or)\b|(?<![*/<>])([<>=!]=|[-+*/<>](?![*/<>]))")


def mutations(source: bytes) -> Iterator[tuple[int, int, str]]:
    """All changes of a file: from where to where which text is put."""
    starts = [0, *itertools.accumulate(map(len, source.splitlines(keepends=True)))]

    def span(node: ast.AST) -> tuple[int, int]:
        start, stop = starts[node.lineno - 1], starts[node.end_lineno - 1]
        return start + node.col_offset, stop + node.end_col_offset

    for node in _runtime(ast.parse(source)):
        match node:
            case ast.Compare(a, _, [b, *_]) | ast.BinOp(a, _, b) | ast.BoolOp(_, [a, b, *_]):
                # The last, as comments stand before it.
                *_, operator = None, *_OPERATOR.finditer(source, span(a)[1], span(b)[0])
                if operator is not None:
                    yield *operator.span(), _TURNED[operator[0]]
            case ast.UnaryOp(ast.USub() | ast.Not(), operand):
                yield span(node)[0], span(operand)[0], ""
            case ast.Constant(bool()):
                yield *span(node), str(not node.value)
            case ast.Constant(float()) if node.value:
                yield *span(node), repr(1.5 * node.value)
            case ast.Constant(int()):
                yield *span(node), repr(node.value + 1)
            case ast.If(test, [*_, ast.Return() | ast.Raise() | ast.Continue() | ast.Break()], []):
                yield *span(test), "False"
            case ast.If(test) | ast.IfExp(test):
                inner = source[slice(*span(test))].decode()
                yield *span(test), f"not ({inner})"
            case ast.Expr(ast.Call()):
                yield *span(node), "None"


def _runtime(tree: ast.AST) -> Iterator[ast.AST]:
    """The nodes that run: no annotations, nothing for type checkers, no parts of f-strings."""
    for field, value in ast.iter_fields(tree):
        if field in ("annotation", "returns"):
            continue
        for node in value if isinstance(value, list) else [value]:
            match node:
                case ast.JoinedStr() | ast.keyword("frozen" | "slots" | "strict" | "kw_only"):
                    continue  # the words of dataclasses and zip are not felt
                case ast.If(test) if "TYPE_CHECKING" in ast.unparse(test):
                    continue
                case ast.AST():
                    yield node
                    yield from _runtime(node)


class Copy:
    """The package beside the compiled modules that are installed."""

    def __init__(self, tests: list[str]) -> None:
        self._temporary = tempfile.TemporaryDirectory(prefix="mutations")
        self.folder = Path(self._temporary.name)
        self.package = self.folder / "python"
        ignore = shutil.ignore_patterns("__pycache__", "*.so")
        shutil.copytree(ROOT / "python", self.package, ignore=ignore)
        for folder in importlib.util.find_spec("stickslip").submodule_search_locations:
            for module in Path(folder).glob("_*.so"):
                shutil.copy(module, self.package / "stickslip")
        self.near = Record(self.package, tests).near

    def build(self, path: Path, limit: float) -> tuple[str, str] | None:
        # Known by its contents, which change more often than the time of the file tells.
        mode = PycInvalidationMode.CHECKED_HASH
        done = compileall.compile_file(path, quiet=2, force=True, invalidation_mode=mode)
        return None if done else ("unbuilt", "")
