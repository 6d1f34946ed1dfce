"""A run as a CSV file, with a second file beside it that has what no column says."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stickslip._util.checksum import sha256_of
from stickslip._util.files import replacing
from stickslip._util.text import json_text
from stickslip.scenario.keys import COIL_NAMES
from stickslip.simulation.columns import COLUMNS, WORDS
from stickslip.simulation.run import Run
from stickslip.simulation.run_attributes import attributes

if TYPE_CHECKING:
    from stickslip.simulation.record_blocks import Block


def beside(path: str | PathLike[str]) -> Path:
    """The file with scenario and summary of a CSV file, whose readers take no comments."""
    path = Path(path)
    return path.with_name(f"{path.name}.json")


def headings(name: str) -> list[str]:
    """Headings of the columns of a quantity."""
    if name in WORDS:
        return [name]
    unit = COLUMNS[name].unit
    if name == "current":
        return [f"current {coil} ({unit})" for coil in COIL_NAMES]
    return [f"{name} ({unit})"]


class _CsvFile:
    """A `RecordFile` that is CSV."""

    def __init__(self, file: io.FileIO, side: Path) -> None:
        self._file = file
        self._side = side
        self._samples = 0

    def write(self, block: Block) -> None:
        titles = [title for name in block for title in headings(name)]
        rows = list(zip(*_columns(block), strict=True))
        lines = rows if self._samples else [titles, *rows]
        text = "".join(f"{','.join(line)}\n" for line in lines).encode()
        end = self._file.tell()
        try:
            while text:
                text = text[self._file.write(text) :]
        except OSError:
            self._file.truncate(end)
            raise
        self._samples += len(rows)

    def finish(self, run: Run) -> None:
        self._file.seek(0)
        about = {
            "stickslip_run": 1,
            "samples": self._samples,
            "sha256": sha256_of(self._file),
            **attributes(run),
        }
        self._side.write_text(json_text(about) + "\n", encoding="utf-8")


def _columns(block: Block) -> Iterator[list[str]]:
    """The cells of each column; a number is the shortest text that gives it back."""
    for name, values in block.items():
        if name in WORDS:
            yield [WORDS[name][code] for code in values]
            continue
        for column in values.T if values.ndim == 2 else [values]:
            yield np.where(np.isnan(column), "", column.astype(str)).tolist()


@contextlib.contextmanager
def csv_file(path: str | PathLike[str]) -> Iterator[_CsvFile]:
    """See `record_file`."""
    with (
        replacing(beside(path)) as side,
        replacing(path) as temporary,  # within: an error of either names this file
        open(temporary, "x+b", buffering=0) as file,
    ):
        yield _CsvFile(file, side)
