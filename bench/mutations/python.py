"""Drawn changes of the Python package: also a call left out."""

from __future__ import annotations

import ast
import compileall
import importlib.util
import py_compile
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from mutations import trial
from mutations.trial import ROOT, Mutation

FILES = ("python/stickslip/**/*.py",)
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


def mutations(file: str, source: bytes) -> Iterator[Mutation]:
    """All mutations of a file."""
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


def can_be_read(source: bytes) -> bool:
    try:
        compile(source, "changed", "exec")
    except SyntaxError:
        return False
    return True


class Copy(trial.Copy):
    """The package beside the compiled modules that are installed."""

    def __init__(self) -> None:
        self._temporary = tempfile.TemporaryDirectory(prefix="mutations")
        self.folder = Path(self._temporary.name)
        self.package = self.folder / "python"
        ignore = shutil.ignore_patterns("__pycache__", "*.so")
        shutil.copytree(ROOT / "python", self.package, ignore=ignore)
        # By the sources' contents, which change more often than their times tell.
        mode = py_compile.PycInvalidationMode.CHECKED_HASH
        compileall.compile_dir(self.package, quiet=2, invalidation_mode=mode)
        for folder in importlib.util.find_spec("stickslip").submodule_search_locations:
            for module in Path(folder).glob("_*.so"):
                shutil.copy(module, self.package / "stickslip")
