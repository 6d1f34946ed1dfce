"""CSV tables as they come from a laboratory: columns in any order, some cells unreadable."""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.atomic_files import read_bytes
from stickslip._util.csv_rows import DECIMAL_COMMAS, CsvTable
from stickslip._util.number_text import is_number, number
from stickslip._util.units import split_unit, to_si
from stickslip.errors import ScenarioError, prefixed
from stickslip.facts import Code, Fact
from stickslip.facts.sentences import LINES
from stickslip.scenario.csv_cells import Units, without_units
from stickslip.scenario.keys import misspelt, nearest, refuse, shown

if TYPE_CHECKING:
    from pandas import DataFrame, Series

Line = int | str
"""Number of a line in a file, or the index label of a row in memory."""


class Rows(NamedTuple):
    """Header of a table, its rows of text cells, each with its line, and what was left out of it.

    `line` is that of the header, 0 of a table in memory.
    """

    header: list[str]
    rows: Sequence[tuple[Line, list[str]]]
    left_out: tuple[Fact, ...] = ()
    line: int = 0


LARGEST = 1e60
"""Beyond every quantity of a laboratory, in any unit; its fourth power is still a number."""

_MOST_ROWS, _MOST_COLUMNS, _MOST_BYTES = 2_000_000, 1000, 1 << 26
"""Limits of a table. Chosen: far beyond what a laboratory has, and small enough for memory."""


class NothingSound(ScenarioError):
    """A table without a sound row; `why` is what is wrong with the first rows."""

    def __init__(self, path: Path, why: Fact) -> None:
        self.fact = Fact(Code.NO_SOUND_ROW, {"table": str(path), "why": why})
        super().__init__(self.fact)


def read_rows(path: Path, units: Units) -> Rows:
    """Header, and rows of text cells with the number of their line in the file.

    Numbers of columns in `units` are in SI units. A ScenarioError says that the file cannot be read
    or is empty, or that a column is there twice or in a unit that is not known.
    """
    with prefixed(path):
        return _rows(path.name, CsvTable(read_bytes(path, _MOST_BYTES, "table"), units), units)


def _rows(name: str, table: CsvTable, units: Units) -> Rows:
    rows = list(itertools.islice(table.rows(), _MOST_ROWS + 1))
    width = len(table.header)
    if len(rows) > _MOST_ROWS:
        raise ScenarioError(f"has more rows than are allowed, {_MOST_ROWS}")
    if not rows:
        raise ScenarioError("has no row of data below a line of column names")
    if width > _MOST_COLUMNS:
        raise ScenarioError(f"{width} columns; allowed are {_MOST_COLUMNS}")
    line, row = rows[0]
    if table.separator == "," and all(len(cells) > width for _, cells in rows):
        few = f"line {line} has {len(row)} cells, and the header {width} names"
        raise ScenarioError(f"{few}, and so on; {DECIMAL_COMMAS}")
    # A column without a name is called by its place, or is not there if it has no cell either.
    empty = [
        k
        for k, heading in enumerate(table.header)
        if not heading and not any(row[k] for _, row in rows if len(row) == width)
    ]
    header = [heading or f"column {k + 1}" for k, heading in enumerate(table.header)]
    if empty:
        keep = [k for k in range(width) if k not in empty]
        header = [header[k] for k in keep]
        rows = [(n, [row[k] for k in keep] if len(row) == width else row) for n, row in rows]
    point = table.with_point if table.separator != "," else None
    counts = ((Code.COMMENTS, table.comments), (Code.EMPTY_COLUMNS, len(empty) + table.beyond))
    left_out = tuple(Fact(code, {"table": name, "count": n}) for code, n in counts if n)
    return Rows(_in_si(header, rows, units, point), rows, left_out, table.line)


def _in_si(
    header: Sequence[str],
    rows: Sequence[tuple[Line, list[str]]],
    units: Units,
    with_point: Callable[[Any, str], str] | None = None,
) -> list[str]:
    """Names of the columns without their units; the numbers in `rows` are replaced by SI ones."""
    names, per = without_units(header, units)
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ScenarioError(f"column {shown(twice[0])} is there twice")
    for k, name in enumerate(names):
        if units.get(name) is None or (per[k] == 1.0 and with_point is None):
            continue
        for line, row in rows:
            if len(row) != len(names):
                continue
            row[k] = row[k] if with_point is None else with_point(line, row[k])
            value = number(row[k])
            if per[k] != 1.0 and not math.isnan(value):
                row[k] = repr(to_si(value, per[k]))
    return names


def rows_of_frame(table: DataFrame, units: Units) -> Rows:
    """Header, and rows of text cells with their index label; as `read_rows` has them of a file.

    Numbers are written so that reading them again gives the same ones; a cell without a value is
    empty. Dates and durations of columns in `units` are in s, dates from their first one.
    """
    import pandas as pd

    if not isinstance(table, pd.DataFrame):
        refuse("table", table, "a DataFrame")
    with prefixed("DataFrame"):
        if table.empty:
            raise ScenarioError("has no row of data")
        names = [str(name) for name in table.columns]
        cells = [table.iloc[:, k] for k in range(len(names))]
        columns = [
            [_cell(value) for value in (_in_seconds(column) if name in units else column)]
            for name, column in zip(names, cells, strict=True)
        ]
        pairs = zip(index_labels(table), zip(*columns, strict=True), strict=True)
        rows = [(label, list(row)) for label, row in pairs]
        return Rows(_in_si(names, rows, units), rows)


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
    path: Path,
    header: Sequence[str],
    required: Iterable[str],
    known: Sequence[str] | None = None,
    information: Collection[str] = (),
) -> list[str]:
    """The columns that are not `known`, if that is given: information beside the measurement.

    A ScenarioError names a required column that is missing, or one that may be meant as a known one
    that is not there, if its name is none of `information`.
    """
    for name in required:
        if name not in header:
            near = nearest(name, [split_unit(each)[0] for each in header])
            meant = "" if near is None else f", and {shown(near)} may be meant as it"
            there = textwrap.shorten(", ".join(header), 300, placeholder=" ...")
            raise ScenarioError(f'{path}: column "{name}" is missing; there are {there}{meant}')
    others = [name for name in header if known is not None and name not in known]
    for name in others:
        bare = split_unit(name)[0]
        near = None if bare in information else misspelt(bare, known or ())
        if near and (near not in header or near.casefold() == bare.casefold()):
            raise ScenarioError(
                f'{path}: column {shown(name)} is not known; did you mean "{near}"? '
                "Give a column of information a name that is less like it"
            )
    return others


def not_used(path: Path, columns: Sequence[str]) -> list[Fact]:
    """A fact about columns that are information only, if there are any."""
    names = {"table": path.name, "columns": list(columns)}
    return [Fact(Code.COLUMNS_NOT_USED, names)] if columns else []


def stated_number(key: str, value: object, highest: float = math.inf) -> float:
    """A number of a measurement file above 0 and below `highest`."""
    if not is_number(value) or not 0.0 < value < highest:
        below = "" if math.isinf(highest) else f" and below {highest:g}"
        refuse(key, value, f"a number above 0{below}")
    return float(value)


def read_numbers(
    path: Path,
    required: Mapping[str, str],
    optional: Mapping[str, str] | None = None,
    information: Collection[str] = (),
) -> tuple[dict[str, Array], list[Fact]]:
    """Columns of numbers by name, shape (n,), of the sound rows, and what was left out.

    The columns are given with their SI units. A row is sound if all its required cells are numbers;
    a gap in an optional column is NaN. `information` is as in `check_columns`. A NothingSound says
    that no row is sound.
    """
    optional = optional or {}
    units = {**required, **optional}
    header, rows, facts, _ = read_rows(path, units)
    others = check_columns(path, header, required, list(units), information)
    columns = {name: header.index(name) for name in header if name in units}
    table = np.array(
        [
            [
                number(row[k], LARGEST) if len(row) == len(header) else math.nan
                for k in columns.values()
            ]
            for _, row in rows
        ]
    )
    found = dict(zip(columns, table.T, strict=True))
    sound = np.all([np.isfinite(found[name]) for name in required], axis=0)
    left_out = [*facts, *not_used(path, others)]
    if not sound.all():
        lines = [rows[k][0] for k in np.flatnonzero(~sound).tolist()]
        left_out.append(in_lines(Code.BAD_CELLS, path.name, lines, rows=len(table)))
    if not sound.any():
        raise NothingSound(path, left_out[-1])
    for name in optional:
        gaps = int(np.sum(~np.isfinite(found[name][sound]))) if name in found else 0
        if gaps:
            left_out.append(Fact(Code.GAPS, {"table": path.name, "count": gaps, "column": name}))
    return {name: column[sound] for name, column in found.items()}, left_out
