"""How a report was made: when, from which files, with which programs, by which command."""

from __future__ import annotations

import platform
import shlex
import sys
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

import numpy
import scipy

from stickslip import _core
from stickslip._util.checksum import sha256_of
from stickslip.diagnosis.report.json_keys import OwnData
from stickslip.errors import ScenarioError
from stickslip.measurement.reading import Measurement
from stickslip.scenario.toml_file import named_files, read_document


def origin(source: Measurement | OwnData, seed: int) -> list[tuple[str, str]]:
    """Rows of a table, a name and a value each.

    Checksums are those of the files while the report is written.
    """
    rows = [
        ("date", datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")),
        ("made by", _command()),
        ("seed", str(seed)),
        ("stickslip", _core.__version__),
        (
            "Python",
            f"{platform.python_version()}, numpy {numpy.__version__}, scipy {scipy.__version__}",
        ),
    ]
    if isinstance(source, Measurement):
        rows += [(f"file {path.name}", _checksum(path)) for path in _files(source.path)]
    return rows


def _command() -> str:
    """The command line, where this is the command."""
    program = Path(sys.argv[0]) if sys.argv else Path()
    if program.stem == "stickslip" or program.parent.name == "stickslip":
        return shlex.join(["stickslip", *sys.argv[1:]])
    return "Python: save_report"


def _files(path: Path) -> Iterator[Path]:
    """The measurement file and what it and its scenario name; nothing of a table in memory."""
    if not path.is_file():
        return
    yield path
    try:
        document = read_document(path, "measurement")
    except (ScenarioError, OSError):  # it was changed meanwhile
        return
    scenario = document.get("scenario")
    if isinstance(scenario, str):
        yield path.parent / scenario
        yield from named_files(path.parent / scenario).values()
    tables = []
    for kind in ("velocity", "tracking", "angle", "field"):
        entries = document.get(kind)
        if isinstance(entries, list):  # else it was changed meanwhile
            tables += [each.get("file") for each in entries if isinstance(each, dict)]
    yield from (path.parent / each for each in dict.fromkeys(tables) if isinstance(each, str))


def _checksum(path: Path) -> str:
    """SHA-256 of an ordinary file; a pipe can be read only once."""
    try:
        if not path.is_file():
            return "no ordinary file, so without a checksum"
        with path.open("rb") as file:
            return f"SHA-256 {sha256_of(file)}"
    except OSError:
        return "cannot be read any more"
