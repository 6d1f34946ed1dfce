"""CSV tables as they come from a laboratory: columns in any order, some cells unreadable."""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.atomic_files import read_bytes
from stickslip._util.csv_rows import csv_rows, refuse_other_separators
from stickslip._util.number_text import is_number
from stickslip.errors import ScenarioError, prefixed
from stickslip.facts import Code, Fact
from stickslip.facts.sentences import LINES
from stickslip.scenario.keys import nearest, refuse, shown, suggestion

if TYPE_CHECKING:
    from pandas import DataFrame, Series

Line = int | str
"""Number of a line in a file, or the index label of a row in memory."""

Rows = tuple[list[str], Sequence[tuple[Line, list[str]]]]
"""Header of a table, and its rows of text cells, each with its line."""

_LARGEST = 1e60
"""Beyond every quantity of a laboratory, in any unit; its fourth power is still a number."""

_MOST_ROWS, _MOST_COLUMNS, _MOST_BYTES = 2_000_000, 1000, 1 << 26
"""Limits of a table. Chosen: far beyond what a laboratory has, and small enough for memory."""


class NothingSound(ScenarioError):
    """A table without a sound row; `why` is what is wrong with the first rows."""

    def __init__(self, path: Path, why: Fact) -> None:
        self.fact = Fact(Code.NO_SOUND_ROW, {"table": str(path), "why": why})
        super().__init__(self.fact)


def read_rows(path: Path) -> Rows:
    """Header, and rows of text cells with the number of their line in the file.

    Empty lines and lines that begin with # are skipped. A ScenarioError says that the file cannot
    be read, is empty, has a column twice or other separators than commas.
    """
    with prefixed(path):
        return _rows(read_bytes(path, _MOST_BYTES, "table"))


def _rows(data: bytes) -> Rows:
    rows = list(itertools.islice(csv_rows(data), _MOST_ROWS + 1))
    if len(rows) > _MOST_ROWS:
        raise ScenarioError(f"has more rows than are allowed, {_MOST_ROWS}")
    if len(rows) < 2:
        raise ScenarioError("has no row of data below a line of column names")
    header = rows[0][1]
    refuse_other_separators(header)
    if len(header) > _MOST_COLUMNS:
        raise ScenarioError(f"{len(header)} columns; allowed are {_MOST_COLUMNS}")
    _refuse_twice(header)
    return header, rows[1:]


def _refuse_twice(header: Sequence[str]) -> None:
    twice = sorted({name for name in header if header.count(name) > 1})
    if twice:
        raise ScenarioError(f"column {shown(twice[0])} is there twice")


def rows_of_frame(table: DataFrame) -> Rows:
    """Header, and rows of text cells with their index label; as `read_rows` has them of a file.

    Numbers are written so that reading them again gives the same ones; a cell without a value is
    empty. Dates and durations are in s, dates from the first one of their column.
    """
    import pandas as pd

    if not isinstance(table, pd.DataFrame):
        refuse("table", table, "a DataFrame")
    header = [str(name) for name in table.columns]
    with prefixed("DataFrame"):
        _refuse_twice(header)
        if table.empty:
            raise ScenarioError("has no row of data")
    cells = [_in_seconds(table.iloc[:, k]) for k in range(len(header))]
    columns = [[_cell(value) for value in column] for column in cells]
    rows = zip(index_labels(table), zip(*columns, strict=True), strict=True)
    return header, [(label, list(row)) for label, row in rows]


def index_labels(table: DataFrame) -> list[Line]:
    """What the rows of a table in memory are called in messages: whole numbers stay numbers."""
    return [int(each) if isinstance(each, int | np.integer) else str(each) for each in table.index]


def _in_seconds(column: Series[Any]) -> Series[Any]:
    """A column of dates or durations as numbers, s; any other as it is."""
    if column.dtype.kind == "M":
        column = column - column.min()
    return column.dt.total_seconds() if column.dtype.kind == "m" else column


def _cell(value: Any) -> str:
    if isinstance(value, float | np.floating):
        return "" if math.isnan(value) else repr(float(value))
    return "" if value is None or str(value) in ("<NA>", "NaT") else str(value).strip()


def in_lines(
    code: Code, table: str, lines: Sequence[Line], *, word: str = "line", **fields: Any
) -> Fact:
    """A fact about some lines of a table, which names the first of them.

    `word` is the word for a line in the sentence; it is a field only if it is another than "line".
    """
    where = {"table": table, "lines": list(lines[:LINES]), "count": len(lines)}
    return Fact(code, {**where, **fields, **({} if word == "line" else {"word": word})})


def check_columns(
    path: Path, header: Sequence[str], required: Iterable[str], known: Sequence[str] | None = None
) -> None:
    """Refuse a table without a column that it needs, or with one that is not `known`, if given."""
    for name in required:
        if name not in header:
            near = nearest(name, header)
            meant = "" if near is None else f", and {shown(near)} may be meant as it"
            there = textwrap.shorten(", ".join(header), 300, placeholder=" ...")
            raise ScenarioError(f'{path}: column "{name}" is missing; there are {there}{meant}')
    for name in header:
        if known is not None and name not in known:
            hint = suggestion(name, known)
            raise ScenarioError(f"{path}: column {shown(name)} is not known; {hint}")


def stated_number(key: str, value: object, highest: float = math.inf) -> float:
    """A number of a measurement file above 0 and below `highest`."""
    if not is_number(value) or not 0.0 < value < highest:
        below = "" if math.isinf(highest) else f" and below {highest:g}"
        refuse(key, value, f"a number above 0{below}")
    return float(value)


def number(cell: str) -> float:
    """A cell's number; NaN where it is none."""
    try:
        value = float(cell)
    except ValueError:
        return math.nan
    return value if abs(value) < _LARGEST else math.nan


def read_numbers(
    path: Path, required: Sequence[str], optional: Sequence[str] = ()
) -> tuple[dict[str, Array], list[Fact]]:
    """Columns of numbers by name, shape (n,), of the sound rows, and what was left out.

    A row is sound if all its required cells are numbers; a gap in an optional column is NaN. A
    NothingSound says that no row is sound.
    """
    header, rows = read_rows(path)
    check_columns(path, header, required, [*required, *optional])
    table = np.array(
        [
            [number(row[k]) if len(row) == len(header) else math.nan for k in range(len(header))]
            for _, row in rows
        ]
    )
    needed = [k for k, name in enumerate(header) if name in required]
    sound = np.all(np.isfinite(table[:, needed]), axis=1)
    left_out = []
    if not sound.all():
        lines = [rows[k][0] for k in np.flatnonzero(~sound).tolist()]
        left_out.append(in_lines(Code.BAD_CELLS, path.name, lines, rows=len(table)))
    if not sound.any():
        raise NothingSound(path, left_out[0])
    for name in optional:
        gaps = int(np.sum(~np.isfinite(table[sound, header.index(name)]))) if name in header else 0
        if gaps:
            left_out.append(Fact(Code.GAPS, {"table": path.name, "count": gaps, "column": name}))
    return {name: table[sound, k] for k, name in enumerate(header)}, left_out
