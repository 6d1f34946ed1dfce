"""The code blocks of the documentation's pages, and running them. docs/pictures.py uses it too.

What a block is called says what is done with it:

python   run; the blocks of a page share one namespace and one folder, and can import examples
console  lines with "$ stickslip" are run; the lines below each are what it prints
text     right after a python block: what that prints; "..." stands for anything
toml     written to the file that its first line names (# name.toml), else to scenario.toml
csv      the same (# name.csv); the line of the name is left out
sh       its stickslip commands are run, all but those of `NOT_RUN`, which must be ones that the
         command line takes; other commands are not run
cpp      not run
"""

from __future__ import annotations

import contextlib
import doctest
import io
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import click

from stickslip.cli.commands import stickslip

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
EXAMPLES = ROOT / "examples"

_FENCE = re.compile(r"^( *)(`{3,})(.*)$")
_FILE_NAME = re.compile(r"# ([\w.-]+\.(?:toml|csv))$")
_SHOWN = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
NUMBER = re.compile(r"\d+(?:\.(\d+))?(?:e([+-]\d+))?")
_ANY_NUMBER = r"\d+(?:\.\d+)?(?:e[+-]\d+)?"
ANY_FIT = 0.05
# s; a whole diagnosis takes some 40 on two processors, and a loaded machine has less to give.
_LIMIT = 300
# How commands of `sh` begin that are not run: what is slow, or lacks what it needs.
NOT_RUN = (
    "stickslip sweep scenario.toml --vary drive.frequency=5:200:400",  # needs a cluster
    "stickslip optimise",  # a search of minutes
    "stickslip diagnose",  # 40 s; the pages on the diagnosis run one each
    "stickslip predict found/extended.toml",  # needs the folder of a diagnosis
    "stickslip predict other-drive.toml",
)
# What writes the files that a page reads and that no block of it writes.
_GIVEN = {
    "diagnose.md": lambda folder: shutil.copy(EXAMPLES / "joint.csv", folder),
    "what-changed.md": lambda folder: [
        shutil.copy(EXAMPLES / name, folder) for name in ("joint.csv", "joint_oiled.csv")
    ],
    "own-model.md": lambda folder: shutil.copy(EXAMPLES / "heater.csv", folder),
    "README.md": lambda folder: shutil.copytree(EXAMPLES, folder / "examples"),
}


@dataclass(frozen=True)
class Block:
    """One fenced block: its page, the line it begins on, its language and its text."""

    page: Path
    line: int
    language: str
    text: str

    def __str__(self) -> str:
        return f"{self.page.name}:{self.line}"


def pages(folder: Path) -> list[Path]:
    """All pages of a folder, but what is built."""
    return sorted(path for path in folder.rglob("*.md") if "_build" not in path.parts)


PAGES = [*pages(DOCS), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]


def by_name(page: Path) -> str:
    """A page from the root of the repository on."""
    return str(page.relative_to(ROOT))


def blocks(page: Path) -> list[Block]:
    """The code blocks of a page; a directive, ```{name}, is none."""
    found = []
    lines = iter(enumerate(page.read_text(encoding="utf-8").splitlines(), start=1))
    for number, line in lines:
        fence = _FENCE.match(line)
        if not fence:
            continue
        indent, ticks, language = fence.groups()
        text = []
        for _, inner in lines:
            if inner.strip() == ticks:
                break
            text.append(inner.removeprefix(indent))
        if language and not language.startswith("{"):
            found.append(Block(page, number, language, "\n".join(text) + "\n"))
    return found


def prose(page: Path) -> str:
    """A page without its code blocks; directives stay."""
    text = page.read_text(encoding="utf-8")
    block = re.compile(r"^( *)(`{3,})(\{)?.*?^\1\2 *$", re.MULTILINE | re.DOTALL)
    return block.sub(lambda found: found[0] if found[3] else "", text)


def prints(expected: str, got: str) -> bool:
    """Whether `got` is what a page says; "..." stands for anything, spaces for any number.

    In a text with errors of a fit (±) numbers may differ by 5 % and one of the last digit: the
    steps of a fit differ in the last bits from machine to machine, and so does its end.
    """
    if doctest.OutputChecker().check_output(expected, got, _SHOWN):
        return True
    if "±" not in expected:
        return False
    texts = NUMBER.split(expected)[:: NUMBER.groups + 1]
    pattern = f"({_ANY_NUMBER})".join(map(_any_space, texts))
    found = re.fullmatch(pattern, got.strip(), re.DOTALL)
    stated = NUMBER.finditer(expected)
    return found is not None and all(
        is_near(one, NUMBER.fullmatch(other), ANY_FIT)
        for one, other in zip(stated, found.groups(), strict=True)
    )


def _any_space(text: str) -> str:
    """The pattern of a text in which "..." and spaces stand for others."""
    parts = [r"\s+".join(map(re.escape, re.split(r"\s+", each))) for each in text.split("...")]
    return ".*?".join(parts)


def is_near(one: re.Match[str], other: re.Match[str] | None, tolerance: float) -> bool:
    """Whether two numbers agree within a relative tolerance and one of the last digit."""
    return other is not None and math.isclose(
        float(one[0]),
        float(other[0]),
        rel_tol=tolerance,
        abs_tol=1.01 * 10.0 ** (int(one[2] or 0) - len(one[1] or "")),
    )


def _check(block: Block, expected: str, got: str) -> None:
    assert prints(expected, got), f"{block} says\n{expected}\nbut what is printed is\n{got}"


@contextlib.contextmanager
def play(page: Path) -> Iterator[Path]:
    """Run all blocks of a page in order, in a folder that lasts as long as the context.

    Raises AssertionError if a block prints something else than the page says, and what a block
    raises.
    """
    before = os.getcwd()
    if str(EXAMPLES) not in sys.path:
        sys.path.append(str(EXAMPLES))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        os.chdir(folder)
        try:
            if page.name in _GIVEN:
                _GIVEN[page.name](folder)
            _run(blocks(page))
            yield folder
        finally:
            os.chdir(before)


def _run(sequence: list[Block]) -> None:
    """Run blocks in the working directory."""
    namespace = {"__name__": "__page__"}
    printed: str | None = None  # by the python block just before
    for block in sequence:
        last, printed = printed, None
        if block.language == "python":
            # Empty lines before it, so that a traceback names the line of the page.
            code = compile("\n" * block.line + block.text, str(block.page), "exec")
            with contextlib.redirect_stdout(io.StringIO()) as output:
                exec(code, namespace)
            printed = output.getvalue()
        elif block.language == "text":
            assert last is not None, f"{block} stands after no python block"
            _check(block, block.text, last)
        elif block.language in ("toml", "csv"):
            first, _, rest = block.text.partition("\n")
            name = _FILE_NAME.match(first)
            assert name or block.language == "toml", f"{block}: the first line names the file"
            file = Path(name[1] if name else "scenario.toml")
            file.write_text(rest if block.language == "csv" else block.text, encoding="utf-8")
        elif block.language == "console":
            _console(block)
        elif block.language == "sh":
            _shell(block)
        else:
            assert block.language == "cpp", f"{block}: {block.language}: what is this?"


def _stickslip(words: list[str]) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=_LIMIT, check=False)


def _console(block: Block) -> None:
    for part in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
        command = re.match(r"(?:.*\\\n)*.*\n", part)
        assert command is not None
        expected = part[command.end() :]
        words = shlex.split(command.group().replace("\\\n", " "))
        assert words[0] == "stickslip", f"{block}: a console block runs stickslip only"
        result = _stickslip(words)
        refused = expected.startswith("stickslip: ")
        assert result.returncode == (2 if refused else 0), f"{block}: {words}: {result.stderr}"
        if expected:
            # A slow machine shows a progress bar on standard error.
            _check(block, expected, result.stderr if refused else result.stdout)


def _shell(block: Block) -> None:
    for line in block.text.replace("\\\n", " ").splitlines():
        words = shlex.split(line.removeprefix("/usr/bin/time -v "), comments=True)
        if words[:1] != ["stickslip"]:
            continue
        if " ".join(words).startswith(NOT_RUN):
            context = click.Context(stickslip, info_name="stickslip")
            command = stickslip.get_command(context, words[1])
            assert command is not None, f"{block}: {words[1]}: there is no such command"
            command.make_context(words[1], words[2:], parent=context)  # refuses wrong options
            continue
        result = _stickslip(words)
        assert result.returncode == 0, f"{block}: {line}: {result.stderr}"
