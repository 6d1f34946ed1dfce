"""Which tests are near a line of the sources, by the words that both have."""

from __future__ import annotations

import ast
import functools
import math
import re
from collections import Counter
from pathlib import Path

_WORD = re.compile(r"[A-Za-z_][\w.]{3,}")
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_AROUND = 15  # lines on both sides, whose words count more
_WEIGHT = 4.0  # of them, beside words of the rest of the file
_FEW = 30  # words, of which a test may consist by chance


def _words(text: str) -> set[str]:
    return set(_WORD.findall(text))


@functools.cache
def words_of_tests(root: Path) -> dict[str, set[str]]:
    """Words of each file of tests in Python, of the helpers beside it that it imports, and of each
    of its tests.

    Keys are as pytest names them, below the project's folder.
    """
    tests = root / "tests"
    texts = {path: path.read_text(encoding="utf-8") for path in tests.rglob("*.py")}
    helpers: dict[str, set[str]] = {}  # by module, or by package as a whole
    for path, text in texts.items():
        if not path.name.startswith("test_"):
            name = path.relative_to(tests).parts[0].removesuffix(".py")
            helpers[name] = helpers.get(name, set()) | _words(text)
    result = {}
    for path, text in texts.items():
        if path.name.startswith("test_"):
            file, own = path.relative_to(root).as_posix(), _words(text)
            result[file] = own.union({path.stem}, *(helpers[each] for each in own & helpers.keys()))
            lines = text.splitlines()
            for node in ast.parse(text).body:
                if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                    start = min(each.lineno for each in [node, *node.decorator_list])
                    result[f"{file}::{node.name}"] = _words(
                        "\n".join(lines[start - 1 : node.end_lineno])
                    )
    return result


def _code(path: Path) -> str:
    """Text of a file; in C++ without the comments, which are of English words."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        return text
    return _COMMENT.sub(lambda comment: "\n" * comment[0].count("\n"), text)


@functools.cache
def _rarity(root: Path) -> dict[str, float]:
    """Weight of each word that tests and sources have: a word of few files says more of a place."""
    tests = [words for name, words in words_of_tests(root).items() if "::" not in name]
    sources = [_words(_code(path)) for path in (root / "python" / "stickslip").rglob("*.py")]
    sources += [_words(_code(path)) for path in (root / "cpp" / "stickslip").rglob("*.?pp")]
    in_tests, in_sources = (
        Counter(word for words in files for word in words) for files in (tests, sources)
    )
    return {
        word: math.log(len(tests) / count) * math.log(len(sources) / max(in_sources[word], 1))
        for word, count in in_tests.items()
    }


def near_tests(root: Path, file: str, line: int) -> list[str]:
    """All tests by their names, the nearest first.

    A word counts more near the line, and so does the module's name; those of a test count beside
    those of its file.
    """
    text = _code(root / file)
    part = text.splitlines()[max(0, line - 1 - _AROUND) : line + _AROUND]
    module = file.removeprefix("python/").rpartition(".")[0].removesuffix("/__init__")
    names = {module.replace("/", "."), f"test_{module.rpartition('/')[2]}"}
    close = _words("\n".join(part)) | names
    words = _words(text) | names
    rarity = _rarity(root)
    tests = words_of_tests(root)

    def nearness(own: set[str]) -> float:
        common = sum(rarity[word] * (_WEIGHT if word in close else 1.0) for word in own & words)
        return common / math.sqrt(len(own) + _FEW)

    near = {name: nearness(own) for name, own in tests.items()}
    return sorted(
        (name for name in near if "::" in name),
        key=lambda name: near[name] + near[name.partition("::")[0]],
        reverse=True,
    )
