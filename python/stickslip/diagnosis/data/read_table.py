"""CSV tables as they come from a laboratory: columns in any order, some cells unreadable."""

from __future__ import annotations

import itertools
import math
import re
import textwrap
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stickslip._util.arrays import Array, Mask, numbers
from stickslip._util.files import read_bytes
from stickslip._util.messages import misspelt, nearest, refuse, shown
from stickslip._util.note import Note
from stickslip._util.tables import DECIMAL_COMMAS, CsvTable, Units, without_units
from stickslip._util.text import counted, is_number, number, plain
from stickslip._util.units import is_unit, split_unit, to_si
from stickslip.diagnosis.data.outliers import ONE_TRACK, marks_of_none
from stickslip.errors import ScenarioError, prefixed

if TYPE_CHECKING:
    from pandas import DataFrame, Series

Line = int | str
"""Number of a line in a file, or the index label of a row in memory."""


LARGEST = 1e60
"""Beyond every quantity of a laboratory, in any unit; its fourth power is still a number."""

_MOST_ROWS, _MOST_COLUMNS, MOST_BYTES = 2_000_000, 1000, 1 << 26
"""Limits of a table. Chosen: far beyond what a laboratory has, and small enough for memory."""

_GROUPED = re.compile(r"[+-]?\d{1,3}([.,' \u00a0\u2019]\d{3})+([.,]\d+)?")
_WITH_UNIT = re.compile(r"[+-]?\d+(?:[.,]\d+)?\s*([^\d\s.,].*)")

STAMP = re.compile(
    r"(?P<date>\d{4}-\d\d-\d\d[T ])?(?P<clock>\d\d:\d\d(:\d\d([.,]\d+)?)?)"
    r"(Z|(?P<zone>[+-]\d\d:?\d\d))?"
)
"""A date or a clock as ISO 8601 writes it."""

_VALID = "valid", "ok"
_SAID = {"1": True, "1.0": True, "true": True, "yes": True,
         "0": False, "0.0": False, "false": False, "no": False}  # fmt: skip
"""Columns that say which rows are valid, and how they say it."""

_NAMED = 5
"""Rows that a note names; of more only the number is given. Chosen: one line."""


class Rows(NamedTuple):
    """A table of text cells.

    `rows` has each row with its line. Notes call the table `name`, and a line `word`; `header_line`
    is 0 of a table in memory.
    """

    path: Path
    name: str
    header: list[str]
    rows: Sequence[tuple[Line, list[str]]]
    left_out: tuple[Note, ...] = ()
    header_line: int = 0
    word: str = "line"

    def at(self, lines: Sequence[Line]) -> str:
        """``velocity.csv line 3``, or the first of several lines."""
        word = self.word if len(lines) == 1 else f"{self.word}s"
        more = ", ..." if len(lines) > _NAMED else ""
        return f"{self.name} {word} {', '.join(map(str, lines[:_NAMED]))}{more}"


class NothingSound(ScenarioError):
    """A table without a sound row."""

    def __init__(self, path: Path, why: Note) -> None:
        self.note = Note("no-sound-row", f"{path}: no row is sound. {why}")
        super().__init__(self.note)


def read_rows(path: Path, units: Units) -> Rows:
    """The rows of a file.

    Numbers of columns in `units` are in SI units. A ScenarioError says that the file cannot be read
    or is empty, or that a column is there twice or in a unit that is not known.
    """
    with prefixed(path):
        return _rows(path, CsvTable(read_bytes(path, MOST_BYTES, "table"), units), units)


def _rows(path: Path, table: CsvTable, units: Units) -> Rows:
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
    if not table.header[0] and "index" not in header:
        header[0] = "index"  # as tables in memory are often written with theirs
    if empty:
        keep = [k for k in range(width) if k not in empty]
        header = [header[k] for k in keep]
        rows = [(n, [row[k] for k in keep] if len(row) == width else row) for n, row in rows]
    left_out = []
    if table.above:
        text = f"{path.name}: {counted(table.above, 'line')} above the column names skipped."
        left_out.append(Note("preamble", text, table.above))
    if table.comments:
        lines = counted(table.comments, "line")
        text = f"{path.name}: {lines} below the header skipped as a comment."
        left_out.append(Note("comments", text, table.comments))
    lost = len(empty) + table.beyond
    if lost:
        text = f"{path.name}: {counted(lost, 'empty column')} without a name left out."
        left_out.append(Note("empty-columns", text, lost))
    point = table.with_point if table.separator != "," else None
    header = _in_si(header, rows, units, point)
    table.check_thousands()
    return Rows(path, path.name, header, rows, tuple(left_out), table.line)


def _in_si(
    header: Sequence[str],
    rows: Sequence[tuple[Line, list[str]]],
    units: Units,
    with_point: Callable[[Any, int, str], str] | None = None,
) -> list[str]:
    """Names of the columns without their units; the numbers in `rows` are replaced by SI ones."""
    names, per = without_units(header, units)
    refuse_twice(names)
    for k, name in enumerate(names):
        if units.get(name) is None:
            continue
        whole = [(line, row) for line, row in rows if len(row) == len(names)]
        for line, row in whole:
            row[k] = row[k] if with_point is None else with_point(line, k, row[k])
            value = number(row[k])
            if math.isnan(value) and _is_no_gap(row[k]):
                raise ScenarioError(
                    f"line {line}, column {name} = {shown(row[k])}: allowed is the number alone, "
                    "without separators of thousands and without a unit"
                )
        values = np.array([number(row[k]) for _, row in whole])
        for (_, row), value, is_mark in zip(whole, values, marks_of_none(values), strict=True):
            if is_mark:
                row[k] = f"{row[k]} (stands for no value)"
            elif per[k] != 1.0 and not math.isnan(value):
                row[k] = repr(to_si(float(value), per[k]))
    return names


def refuse_twice(names: Sequence[str]) -> None:
    """Refuse columns of which two have one name."""
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ScenarioError(f"column {shown(twice[0])} is there twice")


def _refuse_several(table: Rows, numbering: Collection[str], times: Array) -> None:
    """Refuse a column that numbers tracked bodies, two of which are there at the same times."""
    for k, name in enumerate(table.header):
        if plain(name).removesuffix("id").strip() not in numbering:
            continue
        seen: dict[str, list[float]] = {}
        for (_, row), t in zip(table.rows, times.tolist(), strict=True):
            if not math.isnan(t) and row[k]:
                seen.setdefault(row[k], []).append(t)
        spans = sorted((min(of), max(of), value) for value, of in seen.items())
        for (_, end, one), (begin, _, other) in itertools.pairwise(spans):
            if begin < end:
                raise ScenarioError(
                    f"{table.path}: column {name} has {shown(one)} and {shown(other)} at the same "
                    f"times: allowed is {ONE_TRACK}"
                )


def _is_no_gap(cell: str) -> bool:
    """Whether a cell has separators of thousands or a unit: a mistake of the whole column."""
    with_unit = _WITH_UNIT.fullmatch(cell)
    return bool(_GROUPED.fullmatch(cell)) or (
        with_unit is not None and (is_unit(with_unit[1]) or with_unit[1] in ("k", "M", "%"))
    )


def rows_of_frame(table: DataFrame, units: Units) -> Rows:
    """The rows of a table in memory, which have their index labels; else as of `read_rows`.

    Numbers are written so that reading them again gives the same ones; a cell without a value is
    empty. Dates and durations of columns in `units` are in s, dates from their first one.
    """
    import pandas as pd

    if not isinstance(table, pd.DataFrame):
        refuse("table", table, "a DataFrame")
    name = "DataFrame"
    with prefixed(name):
        if table.empty:
            raise ScenarioError("has no row of data")
        header = [str(column) for column in table.columns]
        cells = [table.iloc[:, k] for k in range(len(header))]
        columns = [
            [_cell(value) for value in _plain(heading, column, units)]
            for heading, column in zip(header, cells, strict=True)
        ]
        pairs = zip(index_labels(table), zip(*columns, strict=True), strict=True)
        rows = [(label, list(row)) for label, row in pairs]
        return Rows(Path(name), name, _in_si(header, rows, units), rows, word="row")


def index_labels(table: DataFrame) -> list[Line]:
    """What the rows of a table in memory are called in messages: whole numbers stay numbers."""
    return [int(line) if isinstance(line, int | np.integer) else str(line) for line in table.index]


def _plain(heading: str, column: Series[Any], units: Units) -> Iterable[Any]:
    """A column with numbers as floats, dates and durations among them; texts as they are."""
    unit = units.get(split_unit(heading)[0])
    if unit is None or any(isinstance(cell, str) for cell in column):
        return list(column)  # cells of texts are checked one by one, as those of a file
    values: list[float] = numbers(
        f"column {heading}", column, unit=unit, gaps=True, finite=False
    ).tolist()
    return values


def _cell(value: Any) -> str:
    if isinstance(value, float | np.floating):
        return "" if math.isnan(value) else repr(float(value))
    return "" if value is None or str(value) in ("<NA>", "NaT") else str(value).strip()


def seconds(cell: str) -> float:
    """A time, s, as a number or as ISO 8601 writes a date or a clock; NaN if it is none."""
    stamp = STAMP.fullmatch(cell)
    if not stamp:
        return number(cell, LARGEST)
    try:
        date = f"{stamp['date'] or '1970-01-01T'}{stamp['clock'].replace(',', '.')}"
        since = np.datetime64(date, "us") - np.datetime64(0, "us")
    except ValueError:
        return math.nan
    zone = stamp["zone"] or "+0000"
    ahead = 3600.0 * float(zone[:3]) + 60.0 * float(zone[0] + zone[-2:])
    return float(since / np.timedelta64(1, "s")) - ahead


def validity(header: Sequence[str]) -> list[int]:
    """Places of the columns that say which rows are valid."""
    return [k for k, name in enumerate(header) if plain(name) in _VALID]


def not_valid(table: Rows, rows: Sequence[tuple[Line, list[str]]], column: int) -> Mask:
    """Which of these rows of a table a column calls not valid."""
    said = []
    for line, cells in rows:
        word = cells[column].casefold() if len(cells) == len(table.header) else "1"
        if word not in _SAID:
            raise ScenarioError(
                f"{table.path}: {table.word} {line}, column {table.header[column]} = "
                f"{shown(cells[column])}: allowed are {', '.join(_SAID)}"
            )
        said.append(not _SAID[word])
    return np.array(said, dtype=bool)


def valid_rows(table: Rows) -> Rows:
    """The table without the rows that a column ``valid`` or ``ok`` calls not valid."""
    for column in validity(table.header):
        lost = not_valid(table, table.rows, column)
        if lost.any():
            count = int(lost.sum())
            text = f"{table.name}: {counted(count, 'row')} left out by column "
            note = Note("not-valid", f"{text}{table.header[column]}.", count)
            kept = [row for row, off in zip(table.rows, lost.tolist(), strict=True) if not off]
            if not kept:
                raise NothingSound(table.path, note)
            table = table._replace(rows=kept, left_out=(*table.left_out, note))
    return table


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
            near = nearest(name, [split_unit(heading)[0] for heading in header])
            meant = "" if near is None else f", and {shown(near)} may be meant as it"
            there = textwrap.shorten(", ".join(header), 300, placeholder=" ...")
            raise ScenarioError(f'{path}: column "{name}" is missing; there are {there}{meant}')
    told, taken = validity(header), header if known is None else known
    others = [name for k, name in enumerate(header) if name not in taken and k not in told]
    for name in others:
        bare = split_unit(name)[0]
        near = None if bare in information else misspelt(bare, known or ())
        if near and (near not in header or near.casefold() == bare.casefold()):
            raise ScenarioError(
                f'{path}: column {shown(name)} is not known; did you mean "{near}"? '
                "Give a column of information a name that is less like it"
            )
    return others


def not_used(name: str, columns: Sequence[str]) -> list[Note]:
    """A note about the columns of a table that are information only, if there are any."""
    if not columns:
        return []
    first, more = list(columns[:_NAMED]), len(columns) - _NAMED
    first += [f"{more} more"] if more > 0 else []
    listed = " and ".join([", ".join(first[:-1]), first[-1]] if len(first) > 1 else first)
    text = f"{name}: columns that are information only: {listed}."
    return [Note("columns-not-used", text, len(columns))]


def stated_number(key: str, value: object, highest: float = math.inf, unit: str = "") -> float:
    """A number of a measurement file above 0 and below `highest`."""
    if not is_number(value) or not 0.0 < value < highest:
        below = "" if math.isinf(highest) else f" and below {highest:g} {unit}".rstrip()
        refuse(key, value, f"a number above 0{below}")
    return float(value)


def read_numbers(
    path: Path,
    required: Mapping[str, str],
    optional: Mapping[str, str] | None = None,
    information: Collection[str] = (),
    numbering: Collection[str] = (),
    most: Mapping[str, float] | None = None,
) -> tuple[dict[str, Array], list[Note]]:
    """Columns of numbers by name, shape (n,), of the sound rows, and what was left out.

    The columns are given with their SI units. A row is sound if all its required cells are numbers;
    a gap in an optional column is NaN. `information` is as in `check_columns`. A NothingSound says
    that no row is sound. Columns called `numbering`, with or without ``id`` behind it,
    number bodies of which only one may be there at a time ``t``. Larger numbers than `most` allows,
    by unit, are refused.
    """
    optional = optional or {}
    units = {**required, **optional}
    table = valid_rows(read_rows(path, units))
    header, rows = table.header, table.rows
    others = check_columns(path, header, required, list(units), information)
    columns = {name: header.index(name) for name in header if name in units}
    none = [""] * len(header)
    whole = [row if len(row) == len(header) else none for _, row in rows]
    numbers = np.array([[number(row[k], LARGEST) for k in columns.values()] for row in whole])
    by_name = dict(zip(columns, numbers.T, strict=True))
    if numbering:
        _refuse_several(table, numbering, by_name["t"])
    sound = np.all([np.isfinite(by_name[name]) for name in required], axis=0)
    for name, unit in units.items():
        highest = (most or {}).get(unit, math.inf)
        for k in np.flatnonzero(sound & (np.abs(by_name.get(name, 0.0)) > highest))[:1].tolist():
            raise ScenarioError(
                f"{path}: {table.word} {rows[k][0]}, column {name} = {by_name[name][k]:g} {unit}: "
                f"allowed is at most {highest:g} {unit}; divide numbers in m{unit} by 1e3, and "
                "leave the cell of a saturated reading empty"
            )
    left_out = [*table.left_out, *not_used(path.name, others)]
    if not sound.all():
        wrong = np.flatnonzero(~sound).tolist()
        lines, first = [rows[k][0] for k in wrong], wrong[0]
        name = next(name for name in required if not np.isfinite(by_name[name][first]))
        cell = f"the first {name} = {shown(whole[first][columns[name]])}"
        if whole[first] is none:
            cell = f"the first {len(rows[first][1])} cells"
        text = (
            f"{table.at(lines)}: {len(lines)} of {len(rows)} rows have a cell that is no number, "
            f"too few cells or too many, {cell}."
        )
        left_out.append(Note("bad-cells", text, len(lines)))
    if not sound.any():
        raise NothingSound(path, left_out[-1])
    for name in optional:
        gaps = int(np.sum(~np.isfinite(by_name[name][sound]))) if name in by_name else 0
        if gaps:
            cells = counted(gaps, "cell")
            text = f"{path.name}: the column {name} has {cells} without a number."
            left_out.append(Note("gaps", text, gaps))
    return {name: column[sound] for name, column in by_name.items()}, left_out
