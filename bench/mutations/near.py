"""Which tests are near a line of the sources, by the words that both have."""

from __future__ import annotations

import functools
import math
import re
from collections import Counter
from pathlib import Path

_WORD = re.compile(r"[A-Za-z_][\w.]{3,}")
_C_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_AROUND = 15  # lines on both sides, whose words count more
_WEIGHT = 4.0  # of them, beside words of the rest of the file


def _words(text: str) -> set[str]:
    return set(_WORD.findall(text))


@functools.cache
def words_of_tests(root: Path) -> dict[Path, set[str]]:
    """Words of each file of tests in Python, and of the helpers beside it that it imports."""
    tests = root / "tests"
    words = {path: _words(path.read_text(encoding="utf-8")) for path in tests.rglob("*.py")}
    helpers: dict[str, set[str]] = {}  # by module, or by package as a whole
    for path in words:
        if not path.name.startswith("test_"):
            name = path.relative_to(tests).parts[0].removesuffix(".py")
            helpers[name] = helpers.get(name, set()) | words[path]
    return {
        path: own.union(*(helpers[each] for each in own & helpers.keys()))
        for path, own in words.items()
        if path.name.startswith("test_")
    }


def near_tests(root: Path, file: str, line: int) -> list[Path]:
    """All files of tests, the nearest first.

    A word counts the more, the fewer tests have it, and more still if it is near the line, or is
    the module's name.
    """
    text = (root / file).read_text(encoding="utf-8")
    if not file.endswith(".py"):
        text = _C_COMMENT.sub(lambda comment: "\n" * comment[0].count("\n"), text)
    module = file.removeprefix("python/").rpartition(".")[0].removesuffix("/__init__")
    part = "\n".join(text.splitlines()[max(0, line - 1 - _AROUND) : line + _AROUND])
    close = _words(part) | {module.replace("/", "."), f"test_{module.rpartition('/')[2]}"}
    words = _words(text) | close
    tests = words_of_tests(root)
    holders = Counter(word for each in tests.values() for word in each)

    def nearness(path: Path) -> float:
        own = tests[path]
        common = [
            (_WEIGHT if word in close else 1.0) * math.log(len(tests) / (holders[word] or 1)) ** 2
            for word in (own | {path.stem}) & words
        ]
        return sum(common) / math.sqrt(len(own))

    return sorted(tests, key=nearness, reverse=True)
