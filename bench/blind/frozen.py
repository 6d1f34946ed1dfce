"""What the diagnosis said of 200 data sets before it was written anew: ``python -m blind.frozen``.

`sets.jsonl.xz` has the files and the truth of each data set, `rows.jsonl` what that engine found:
every candidate with its chi-square, log-evidence and parameters in their units. Verdicts of hard
sets differ between two runs of one engine, so fits and evidences are compared, too.
"""

from __future__ import annotations

import json
import lzma
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent / "frozen"
SETS, ROWS = FOLDER / "sets.jsonl.xz", FOLDER / "rows.jsonl"


def sets(path: Path = SETS) -> Iterator[dict[str, Any]]:
    """Data sets, each with `kind`, `seed`, `answer` and the text of its `files` by name."""
    with lzma.open(path, "rt") as file:
        for line in file:
            yield json.loads(line)


def unpacked(one: dict[str, Any], folder: Path) -> Path:
    """The files of a data set in a folder; the path of its measurement."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in one["files"].items():
        (folder / name).write_text(text)
    return folder / "measurement.toml"


def rows() -> dict[tuple[str, int], dict[str, Any]]:
    """What was found, by kind and seed."""
    found = (json.loads(line) for line in ROWS.read_text().splitlines())
    return {(each["kind"], each["seed"]): each for each in found}
