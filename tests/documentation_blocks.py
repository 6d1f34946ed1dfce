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

from instrument_files import write_all

ROOT = Path(__file__).parents[1]
LANGUAGES = ("python", "console", "text", "toml", "csv", "sh", "cpp")

_FENCE = re.compile(r"^( *)(`{3,})(.*)$")
_FILE_NAME = re.compile(r"# ([\w.-]+\.(?:toml|csv))$")
_COMMAND = (sys.executable, "-m", "stickslip")
_SHOWN = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
# s; a whole diagnosis takes some 40 on two processors, and a loaded machine has less to give.
_LIMIT = 300
NOT_RUN = {
    "stickslip sweep scenario.toml --vary drive.frequency=5:200:400": "needs a cluster",
    "stickslip run long.toml --out long.nc": "30 s, and a file of 890 MB",
    "stickslip optimise": "a search of minutes",
    "stickslip diagnose": "40 s; the pages on the diagnosis run one each",
    "stickslip predict found/extended.toml": "needs the folder of a diagnosis",
    "stickslip predict other-drive.toml": "needs the folder of a diagnosis",
    "stickslip reproduce": "15 s for one figure, minutes for all",
}
"""How commands of `sh` begin that are not run, and why: what is slow, or lacks what it needs."""

EXAMPLES = Path(__file__).parents[1] / "examples"
TIMED = ["/usr/bin/time", "-v"]


def _write_examples(folder: Path) -> None:
    shutil.copytree(ROOT / "examples", folder / "examples")


# Files that a page reads and that no block of it writes.
_GIVEN = {"instruments.md": write_all, "README.md": _write_examples}


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


def prints(expected: str, got: str) -> bool:
    """Whether `got` is what a page says; "..." stands for anything, spaces for any number."""
    return doctest.OutputChecker().check_output(expected, got, _SHOWN)


def _checked(block: Block, expected: str, got: str) -> None:
    if not prints(expected, got):
        raise AssertionError(f"{block} says\n{expected}\nbut what is printed is\n{got}")


@contextlib.contextmanager
def play(page: Path) -> Iterator[Path]:
    """Run all blocks of a page in order, in a folder that lasts as long as the context.

    Raises
    ------
    AssertionError
        If a block prints something else than the page says.
    Exception
        What a block raised.
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
            _run(blocks(page), folder)
            yield folder
        finally:
            os.chdir(before)


def _run(sequence: list[Block], folder: Path) -> None:
    namespace = {"__name__": "__page__"}
    printed: str | None = None  # by the python block just before
    for block in sequence:
        last, printed = printed, None
        if block.language == "python":
            printed = _python(block, namespace)
        elif block.language == "console":
            _console(block, folder)
        elif block.language == "text":
            if last is None:
                raise AssertionError(f"{block} stands after no python block")
            _checked(block, block.text, last)
        elif block.language in ("toml", "csv"):
            _write(block, folder)
        elif block.language == "sh":
            _shell(block, folder)
        elif block.language != "cpp":
            raise AssertionError(f"{block}: {block.language}: known are {', '.join(LANGUAGES)}")


def _python(block: Block, namespace: dict[str, object]) -> str:
    # Empty lines before it, so that a traceback names the line of the page.
    code = compile("\n" * block.line + block.text, str(block.page), "exec")
    with contextlib.redirect_stdout(io.StringIO()) as output:
        exec(code, namespace)
    return output.getvalue()


def _console(block: Block, folder: Path) -> None:
    for part in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
        command = re.match(r"(?:.*\\\n)*.*\n", part)
        assert command is not None
        expected = part[command.end() :]
        words = shlex.split(command.group().replace("\\\n", " "))
        if words[0] != "stickslip":
            raise AssertionError(f"{block}: {words[0]}: a console block runs stickslip only")
        result = _stickslip(words, folder)
        refused = expected.startswith("stickslip: ")
        if (result.returncode == 2) != refused or result.returncode not in (0, 2):
            raise AssertionError(f"{block}: {words}: {result.returncode}: {result.stderr}")
        if expected:
            # A slow machine shows a progress bar on standard error.
            _checked(block, expected, result.stderr if refused else result.stdout)


def _stickslip(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*_COMMAND, *words[1:]], cwd=folder, capture_output=True, text=True, timeout=_LIMIT
    )


def _write(block: Block, folder: Path) -> None:
    first, _, rest = block.text.partition("\n")
    name = _FILE_NAME.match(first)
    if name is None and block.language == "csv":
        raise AssertionError(f"{block}: the first line of a csv block names its file")
    text = rest if block.language == "csv" else block.text
    (folder / (name.group(1) if name else "scenario.toml")).write_text(text, encoding="utf-8")


def _shell(block: Block, folder: Path) -> None:
    for line in block.text.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if words[: len(TIMED)] == TIMED:
            words = words[len(TIMED) :]
        if words[:1] != ["stickslip"]:
            continue
        if any(" ".join(words).startswith(each) for each in NOT_RUN):
            _parse(block, words)
            continue
        result = _stickslip(words, folder)
        if result.returncode != 0:
            raise AssertionError(f"{block}: {line}: {result.stderr}")


def _parse(block: Block, words: list[str]) -> None:
    """Refuse a command that the command line would not take."""
    import click

    from stickslip.cli.commands import stickslip

    context = click.Context(stickslip, info_name="stickslip")
    command = stickslip.get_command(context, words[1])
    if command is None:
        raise AssertionError(f"{block}: {words[1]}: there is no such command")
    try:
        command.make_context(words[1], words[2:], parent=context)
    except click.ClickException as error:
        raise AssertionError(f"{block}: {words}: {error.format_message()}") from None
