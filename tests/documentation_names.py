"""What a page of the documentation names of this repository, and what of that is not there."""

from __future__ import annotations

import ast
import functools
import importlib
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

# Where a path on a page may begin; the rooms are named without the folder that they stand in.
_BEGINNINGS = (
    ROOT,
    ROOT / "python" / "stickslip",
    ROOT / "python" / "stickslip" / "diagnosis",
    ROOT / "cpp",
    ROOT / "cpp" / "stickslip",
    ROOT / "cpp" / "bindings",
    ROOT / "tests",
    ROOT / "bench",
)
_TOP = ("bench", "cmake", "cpp", "docs", "python", "tests")
_BUILT = ("bench/results", "docs/_build", "build/")

_FENCE = re.compile(r"^( *)(`{3,})(?!\{).*?^\1\2 *$", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
_PLACE = re.compile(r"([\w./-]+\.(?:py|cpp|hpp|cmake|toml|md)): ([\w:., ]+)$")
_FILE = re.compile(r"[\w./-]*\w\.(?:py|pyi|cpp|hpp|cmake|toml|csv|json|jsonl|md|html|yml)$")
_FOLDER = re.compile(r"[\w.-]+(?:/[\w.-]+)*/$")
_DOTTED = re.compile(r"(?<![\w/.-])stickslip(?:\.[A-Za-z_]\w*)+")
_LINK = re.compile(r"\]\(([^)#\s:]+)(?:#[^)]*)?\)")
_PATH = re.compile(rf"(?<![\w/.-])(?:{'|'.join(_TOP)})/[\w/.-]*\w\.(?:py|cpp|hpp|md|jsonl|cmake)\b")


@functools.cache
def _sources() -> dict[str, list[Path]]:
    """Files of the sources by name, and folders by their name with a slash."""
    found: dict[str, list[Path]] = {}
    for top in _TOP:
        for path in (ROOT / top).rglob("*"):
            built = str(path.relative_to(ROOT)).startswith(_BUILT)
            if not built and "__pycache__" not in path.parts:
                found.setdefault(path.name + "/" * path.is_dir(), []).append(path)
    return found


def _paths(name: str) -> list[Path]:
    """Where a file or folder of this name is; one without a folder may be anywhere."""
    whole = [start / name for start in _BEGINNINGS if (start / name).exists()]
    return whole if "/" in name.rstrip("/") else whole + _sources().get(name, [])


@functools.cache
def _defined(path: Path) -> set[str]:
    """Names that a file of Python defines, at any depth; of other files all words."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return set(re.findall(r"\w+", text))
    names = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            names.add(node.attr)
    return names


def _is_there(dotted: str) -> bool:
    """Whether a name of the package can be imported, or is an attribute of what can."""
    words = dotted.split(".")
    for cut in range(len(words), 0, -1):
        try:
            found = importlib.import_module(".".join(words[:cut]))
        except ModuleNotFoundError:
            continue
        for word in words[cut:]:
            fields = getattr(found, "__dataclass_fields__", {})
            if not hasattr(found, word) and word not in fields:
                return False
            found = getattr(found, word, None)
        return True
    return False


def _place(file: str, names: str) -> list[str]:
    paths = _paths(file)
    if not paths:
        return [f"there is no {file}"]
    wanted = re.findall(r"\w+", names)
    if any(set(wanted) <= _defined(path) for path in paths):
        return []
    return [f"there is no {names} in {file}"]


def _file(name: str, page: str) -> list[str]:
    ours = name.endswith((".py", ".cpp", ".hpp", ".md", ".cmake")) or name.split("/")[0] in _TOP
    # A file that a reader makes is in a code block of the page, or is what the command writes.
    if not ours or name.startswith(_BUILT) or name in page or _paths(name):
        return []
    return [f"there is no {name}"]


def _folder(name: str, page: str) -> list[str]:
    ignored = (ROOT / ".gitignore").read_text().split()
    made = re.search(rf"(?<!\w){re.escape(name.rstrip('/'))}(?!\w)", page)
    if name.startswith(_BUILT) or f"/{name}" in ignored or made or _paths(name):
        return []
    return [f"there is no folder {name}"]


def missing(text: str, folder: Path = ROOT) -> list[str]:
    """What a page in `folder` names and is not there, a line each.

    Looked at are `file: name`, files, folders and dotted names of the package in code of a line,
    dotted names elsewhere in the text and in directives, and links to files.
    """
    blocks = "\n".join(match.group() for match in _FENCE.finditer(text))
    prose = _FENCE.sub("", text)
    found = []
    for code in _CODE.findall(prose):
        if place := _PLACE.match(code):
            found += _place(*place.groups())
        elif _FILE.match(code):
            found += _file(code, blocks)
        elif _FOLDER.match(code):
            found += _folder(code, blocks)
    found += [f"there is no {name}" for name in _DOTTED.findall(prose) if not _is_there(name)]
    found += [f"no link to {to}" for to in _LINK.findall(prose) if not (folder / to).exists()]
    return found


def named_paths(text: str) -> set[str]:
    """Paths from the root of the repository that a source names, in comments or elsewhere."""
    return {path for path in _PATH.findall(text) if not path.startswith(_BUILT)}
