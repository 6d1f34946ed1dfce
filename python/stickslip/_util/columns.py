"""The one door for tables: their columns are read once, as a recipe says, into SI.

A file, a data frame, a Dataset and a mapping of arrays become the same `SourceTable`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from stickslip._util.arrays import (
    Array,
    Mask,
    are_times,
    columns_of,
    converted,
    numbers,
    to_si,
    without_unit,
)
from stickslip._util.cells import (
    LARGEST,
    LIMIT,
    MOST_COLUMNS,
    STAMP,
    CsvTable,
    number,
)
from stickslip._util.files import read_bytes
from stickslip._util.messages import refuse, shown
from stickslip._util.note import Note
from stickslip._util.recipes import VALID, Match, Recipe
from stickslip._util.text import counted, plain, shortened
from stickslip._util.units import split_unit
from stickslip._util.workbook import sheet_text
from stickslip.errors import ScenarioError, prefixed

Line = int | str
"""Number of a line in a file, or the index label of a row in memory."""

_MOST_ROWS = 2_000_000
MOST_BYTES, MOST_EXACT = 1 << 26, 1 << 29
"""Limits of a table. Chosen: far beyond what a laboratory has, and small enough for memory. A
program of voltages may be longer: a minute at 30 kHz is two million rows of six numbers."""

MANY_GAPS = 0.05
"""Part of a column; if more are gaps, that is said first. Chosen: few readings change little."""
SAID_FIRST = "many-gaps", "rows-left-out"
"""Codes of notes with which a summary begins."""

_SAID = {"1": True, "1.0": True, "true": True, "yes": True,
         "0": False, "0.0": False, "false": False, "no": False}  # fmt: skip
"""How columns of `VALID` say it."""

_TIMES = ["t"], ["time"], ["timestamp"]  # first words of an index that is a column
_NO_ROW = "is empty: there is no row of data below a line of column names"

_BLOCK = 1 << 12  # rows; chosen: few enough for the room of their cells

_NAMED = 5
"""Lines, or columns, that a note names, with "..." for more. Chosen: one line."""


@dataclass(frozen=True, eq=False)
class Column:
    """A column: numbers in SI, or words.

    Attributes
    ----------
    what : Match
    values : ndarray, shape (n,)
        Numbers, NaN in gaps; empty of words.
    texts : sequence of str, shape (n,)
        Words; empty of numbers.
    odd : dict
        By row the cells that are no numbers.
    """

    what: Match
    values: Array
    texts: Sequence[str] = ()
    odd: Mapping[int, str] = field(default_factory=dict)

    @cached_property
    def numbers(self) -> Array:
        """Its numbers, whatever it is; NaN of words."""
        if self.what.si is not None:
            return self.values
        return np.array([number(text.replace(",", ".")) for text in self.texts], dtype=float)

    def cell(self, row: int) -> str:
        """A cell as messages show it."""
        if self.what.si is None:
            return self.texts[row]
        sound = not math.isnan(self.values[row])
        return f"{self.values[row] * self.what.per:.15g}" if sound else self.odd.get(row, "")

    def kept(self, rows: Sequence[int]) -> Column:
        """The column of some rows."""
        if self.what.si is None:
            return replace(self, texts=[self.texts[k] for k in rows])
        return replace(self, values=self.values[rows], odd=_kept(self.odd, rows))


def _kept(by_row: Mapping[int, str], rows: Sequence[int]) -> dict[int, str]:
    return {i: by_row[k] for i, k in enumerate(rows) if k in by_row} if by_row else {}


@dataclass(frozen=True, eq=False)
class SourceTable:
    """A table that was read.

    Attributes
    ----------
    path : Path
    name : str
        What notes call it.
    columns : dict of Column
        By the name of the recipe or, of others, the heading; in the order of the source.
    lines : sequence of Line
        Of the rows.
    ragged : dict
        What is wrong with rows of too many or too few cells, which are gaps here.
    notes : tuple of Note
    word : str
        What a line is called.
    """

    path: Path
    name: str
    columns: Mapping[str, Column]
    lines: Sequence[Line]
    ragged: Mapping[int, str] = field(default_factory=dict)
    notes: tuple[Note, ...] = ()
    word: str = "line"

    def __len__(self) -> int:
        return len(self.lines)

    @property
    def known(self) -> dict[str, Column]:
        """The columns that its recipe has."""
        return {name: column for name, column in self.columns.items() if column.what.known}

    @property
    def validity(self) -> list[Column]:
        """The columns that say which rows are valid."""
        return [column for name, column in self.columns.items()
                if plain(name) in VALID and not column.what.known]  # fmt: skip

    @property
    def others(self) -> list[str]:
        """Headings of the columns that are information only."""
        return [column.what.heading for name, column in self.columns.items()
                if plain(name) not in VALID and not column.what.known]  # fmt: skip

    def at(self, rows: Sequence[int]) -> str:
        """``velocity.csv line 3``, or the first of several lines."""
        word = self.word if len(rows) == 1 else f"{self.word}s"
        named = ", ".join(str(self.lines[k]) for k in rows[:_NAMED])
        return f"{self.name} {word} {named}{', ...' if len(rows) > _NAMED else ''}"

    def conversions(self) -> list[Note]:
        """A note on the columns that were converted to SI, if there are any."""
        made = {what.name: f"from {what.unit} to {what.si}"
                for each in self.columns.values() if (what := each.what).per != 1.0}  # fmt: skip
        return converted(f"{self.name}: ", made)

    def many_gaps(self) -> list[Note]:
        """A note on each column of which more than a twentieth are gaps: to be said first."""
        notes = []
        for column in self.known.values():
            gaps = [k for k, cell in column.odd.items()
                    if number(cell) is not None and k not in self.ragged]  # fmt: skip
            if len(gaps) > MANY_GAPS * len(self):
                text = f"{self.at(gaps)}: {len(gaps)} of {len(self)} cells of column "
                text += f"{column.what.heading} are gaps, the first {shown(column.cell(gaps[0]))}."
                notes.append(Note("many-gaps", text, len(gaps)))
        return notes

    def not_used(self) -> list[Note]:
        """A note on the columns that are information only, if there are any."""
        others = self.others
        if not others:
            return []
        more = len(others) - _NAMED
        named = others[:_NAMED] + ([f"{more} more"] if more > 0 else [])
        listed = " and ".join([", ".join(named[:-1]), named[-1]] if len(named) > 1 else named)
        text = f"{self.name}: columns that are information only: {listed}."
        return [Note("columns-not-used", text, len(others))]

    def kept(self, rows: Sequence[int], note: Note | None = None) -> SourceTable:
        """The table of some rows, with a note."""
        return replace(
            self,
            columns={name: column.kept(rows) for name, column in self.columns.items()},
            lines=[self.lines[k] for k in rows],
            ragged=_kept(self.ragged, rows),
            notes=(*self.notes, *([note] if note else [])),
        )

    def not_valid(self, column: Column) -> Mask:
        """Which rows a column calls not valid."""
        said = []
        for k, line in enumerate(self.lines):
            word = "1" if k in self.ragged else column.texts[k].casefold()
            if word not in _SAID:
                raise ScenarioError(
                    f"{self.path}: {self.word} {line}, column {column.what.heading} = "
                    f"{shown(column.texts[k])}: allowed are {', '.join(_SAID)}"
                )
            said.append(not _SAID[word])
        return np.array(said, dtype=bool)

    def valid(self) -> SourceTable:
        """The table without the rows that a column ``valid`` or ``ok`` calls not valid."""
        table = self
        for column in self.validity:
            lost = table.not_valid(table.columns[column.what.name])
            if lost.any():
                count = int(lost.sum())
                what = f"left out by column {column.what.heading}."
                note = Note("not-valid", f"{self.name}: {counted(count, 'row')} {what}", count)
                if lost.all():
                    raise NothingSound(self.path, note)
                table = table.kept(np.flatnonzero(~lost).tolist(), note)
        return table


class NothingSound(ScenarioError):
    """A table without a sound row."""

    def __init__(self, path: Path, why: Note) -> None:
        self.note = Note("no-sound-row", f"{path}: no row is sound. {why}")
        super().__init__(self.note)


class Source:
    """A file, which is opened once, or a table in memory: a frame, a Dataset or arrays by name."""

    def __init__(self, given: Any, most: int = MOST_BYTES) -> None:
        self.given = given
        self.is_file = isinstance(given, str | PathLike)
        self.path = Path(given if self.is_file else type(given).__name__)
        with prefixed(self.path):
            self.data = sheet_text(read_bytes(given, most, "table")) if self.is_file else b""

    def csv(self, names: Collection[str]) -> CsvTable:
        """The file from its header on, which has one of some names."""
        return CsvTable(self.data, names)

    @cached_property
    def arrays(self) -> dict[str, Any]:
        """Columns of a table in memory by heading, with the units that these carry."""
        given = self.given
        index = getattr(given, "index", None)
        is_time = getattr(getattr(index, "dtype", None), "kind", "") in ("m", "M")
        if is_time or plain(str(getattr(index, "name", ""))).split()[:1] in _TIMES:
            given = given.rename_axis(getattr(index, "name", None) or "t").reset_index()
        if hasattr(given, "data_vars"):  # of xarray
            there = {**given.coords, **given.data_vars}
            found: dict[Any, Any] | None = {k: v for k, v in there.items() if v.ndim == 1}
        else:
            found = columns_of(self.path.name, given)
        if found is None:
            refuse("table", given, "a DataFrame, or columns by name")
        made = dict(_with_unit(str(name), values) for name, values in (found or {}).items())
        if not made or not len(next(iter(made.values()))):
            raise ScenarioError(_NO_ROW)
        return made

    def headings(self, names: Collection[str]) -> list[str]:
        """The headings; one of some names makes a comment above the numbers a header."""
        with prefixed(self.path):
            return _checked_header(self.csv(names)) if self.is_file else list(self.arrays)

    def read(self, recipe: Recipe) -> SourceTable:
        """The table as a recipe says; a ScenarioError begins with the path."""
        with prefixed(self.path):
            table = _of_file(self, recipe) if self.is_file else _of_arrays(self, recipe)
            if not recipe.lenient:
                _check_cells(table, recipe)
        return replace(table, notes=(*table.notes, *table.conversions()))


def read_table(given: Any, recipe: Recipe) -> SourceTable:
    """The table in a file or in memory, as a recipe says.

    Raises
    ------
    ScenarioError
        If the file cannot be read or is empty, or a column is missing, there twice or in a unit
        that is not known, or like a known one; with an exact recipe also if a column or cell is not
        as it has to be.
    """
    return Source(given, MOST_EXACT if recipe.exact else MOST_BYTES).read(recipe)


def index_labels(table: Any) -> list[Line]:
    """Names of the rows of a table in memory, for messages: whole numbers stay numbers."""
    index = getattr(table, "index", None)
    if index is None or callable(index):
        return []
    return [int(line) if isinstance(line, int | np.integer) else str(line) for line in index]


def _checked_header(file: CsvTable) -> list[str]:
    """Headings; a column without one is called by its place, or index, as programs write theirs."""
    header = file.header
    if not header:
        raise ScenarioError(_NO_ROW)
    if len(header) > MOST_COLUMNS:
        raise ScenarioError(f"{len(header)} columns; allowed are {MOST_COLUMNS}")
    if all(number(name.replace(",", ".")) is not None for name in header):
        raise ScenarioError("its first line is numbers: write a line of column names above it")
    named = [heading or f"column {k + 1}" for k, heading in enumerate(header)]
    if not header[0] and "index" not in header:
        named[0] = "index"
    return named


def _of_file(source: Source, recipe: Recipe) -> SourceTable:
    file = source.csv(recipe.names)
    word = "row" if recipe.exact else "line"
    headings = _checked_header(file)
    with prefixed(f"{word} {file.line}"):
        matches = recipe.matched(headings)
        recipe.check([matches[0], *(what for what, name in zip(matches[1:], file.header[1:],
                                                               strict=True) if name)])  # fmt: skip
    parts = list(map(_Part, matches))
    lines: list[int] = []
    ragged: dict[int, int] = {}
    rows = file.rows()
    while block := list(itertools.islice(rows, _BLOCK)):
        at, cells, counts = zip(*block, strict=True)
        for k, (part, texts) in enumerate(zip(parts, zip(*cells, strict=True), strict=True)):
            pointed = texts if part.what.si is None else file.pointed(k, at, texts)
            part.take(pointed, first=len(lines))
        ragged |= {len(lines) + k: count for k, count in enumerate(counts) if count}
        lines += at
        if len(lines) > _MOST_ROWS and not recipe.exact:
            raise ScenarioError(f"has more rows than are allowed, {_MOST_ROWS}")
    width = len(parts)
    if not lines:
        raise ScenarioError(_NO_ROW)
    if file.separator == "," and len(ragged) == len(lines) and min(ragged.values()) > width:
        raise ScenarioError(
            f"line {lines[0]} has {ragged[0]} cells, and the header {width} names, and so on; if "
            "these are decimal commas, separate the columns by semicolons or write decimal points; "
            "else every column needs a name"
        )
    file.check_thousands()
    here: list[_Part] = []
    for part, name in zip(parts, file.header, strict=True):
        beyond = [k for k, text in enumerate(part.texts) if text and not name]
        if recipe.exact and here and not name:  # a cell beyond the names is one too many
            ragged |= dict.fromkeys(beyond, width)
        elif name or beyond:
            here.append(part)
    columns = {part.what.name: part.column() for part in here}
    text = {
        "preamble": (file.above, "{} above the column names skipped.", "line"),
        "comments": (file.comments, "{} below the header skipped as a comment.", "line"),
        "empty-columns": (width - len(here) + file.beyond, "{} without a name left out.",
                          "empty column"),
    }  # fmt: skip
    name = source.path.name
    notes = [Note(code, f"{name}: {words.format(counted(count, thing))}", count)
             for code, (count, words, thing) in text.items() if count]  # fmt: skip
    wanted = len(recipe.entries) if recipe.exact else width
    wrong = {k: f"{count} cells, and the header has {wanted}" for k, count in ragged.items()}
    last = len(lines) - 1
    for column in columns.values() if last and not recipe.exact else ():
        cell = column.odd.get(last, "")
        if not _is_known(cell, column.what):
            wrong[last] = f"the cell {shown(cell)}, as of a file that was cut off"
    return SourceTable(source.path, name, columns, lines, wrong, tuple(notes), word)


class _Part:
    """A column as far as it was read."""

    def __init__(self, what: Match) -> None:
        self.what = what
        self.texts: list[str] = []
        self.values: list[Array] = [np.empty(0)]
        self.odd: dict[int, str] = {}

    def take(self, cells: Sequence[Any], values: Array | None = None, first: int = 0) -> None:
        """Cells from a row on, and their numbers if these are known, NaN in gaps."""
        if self.what.si is None:
            self.texts += map(_cell, cells)
            return
        if values is None:
            values = np.array(list(map(number, map(_cell, cells))), dtype=float)
        values = np.where(np.abs(values) < LARGEST, values, math.nan)
        self.odd |= {first + k: _cell(cells[k])
                     for k in np.flatnonzero(np.isnan(values)).tolist()}  # fmt: skip
        self.values.append(values)

    def take_array(self, values: Any) -> None:
        """Read an array: texts one by one, as those of a file, or numbers."""
        cells = list(values)
        if self.what.si is None or any(isinstance(cell, str) for cell in cells):
            self.take(cells)
            return
        if are_times(values):  # they are in s, whatever the heading says
            self.what = self.what._replace(unit="s", per=1.0)
        self.take(cells, numbers(f"column {self.what.heading}", values, gaps=True, finite=False))

    def column(self) -> Column:
        """The whole of it, in SI."""
        values = to_si(np.concatenate(self.values), self.what.per)
        return Column(self.what, values, self.texts, self.odd)


def _check_cells(table: SourceTable, recipe: Recipe) -> None:
    """Refuse cells that show a mistake of a whole column; with an exact recipe each odd one."""
    if recipe.exact and table.ragged:
        row, wrong = min(table.ragged.items())
        raise ScenarioError(
            f"row {table.lines[row]} has {wrong}: allowed is the same; look for a quote or a "
            "decimal comma"
        )
    for name, column in table.columns.items():
        of = "" if column.what.si in ("-", None) else f" of {column.what.si}"
        gap = "" if recipe.exact else ", or for a gap an empty cell, nan or ERR"
        date = ", or a date such as 2026-05-01 12:00:00.25" if column.what.clock else ""
        for k, cell in column.odd.items():
            if recipe.exact or not (k in table.ragged or _is_known(cell, column.what)):
                refuse(
                    f"{table.word} {table.lines[k]}, column {name}", cell,
                    f"a finite number{of} with a decimal point, without separators "
                    f"of thousands and without a unit{date}{gap}",
                )  # fmt: skip


def _is_known(cell: str, what: Match) -> bool:
    """Whether a cell that is no number is a gap, or in a column of times a clock."""
    return number(cell) is not None or (what.clock and STAMP.fullmatch(cell) is not None)


def limits(column: Column) -> list[int]:
    """Rows whose cell is a limit, such as ``<25.0``: no reading, though no gap either."""
    return [k for k, cell in column.odd.items() if LIMIT.fullmatch(cell)]


def _with_unit(name: str, values: Any) -> tuple[str, Any]:
    """A heading with the unit that values carry, and their numbers."""
    plain, carried = without_unit(values)
    shape = np.shape(plain)
    if sum(size != 1 for size in shape) > 1 or not shape:
        refuse(f"column {name}", values, "one value for each row")
    plain = np.ravel(plain) if len(shape) > 1 else plain  # MATLAB has no vectors
    heading, stated = f"{name} ({carried})", split_unit(name)[1]
    if carried in (None, "", "1", "dimensionless") or carried == stated:
        return name, plain
    if stated is not None or split_unit(heading) != (name, carried):
        allowed = "one unit" if stated else "a unit such as m/s"
        raise ScenarioError(f"column {name} is in {carried}: allowed is {allowed}")
    return heading, plain


def _of_arrays(source: Source, recipe: Recipe) -> SourceTable:
    arrays = source.arrays
    matches = recipe.matched(list(arrays))
    recipe.check(matches)
    count, columns = len(next(iter(arrays.values()))), dict[str, Column]()
    for values, what in zip(arrays.values(), matches, strict=True):
        if len(values) != count:
            raise ScenarioError(f"column {what.heading}: {len(values)} values; allowed are {count}")
        part = _Part(what)
        part.take_array(values)
        columns[what.name] = part.column()
    lines = index_labels(source.given) or list(range(count))
    return SourceTable(source.path, source.path.name, columns, lines, word="row")


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value.strip()
    if isinstance(value, float | np.floating):
        return "" if math.isnan(value) else repr(float(value))
    return "" if value is None or str(value) in ("<NA>", "NaT", "--") else str(value).strip()


def sound_numbers(
    given: Any, recipe: Recipe, several: Callable[[SourceTable], None] | None = None
) -> tuple[dict[str, Array], list[Note]]:
    """Columns of numbers by name, shape (n,), of the sound rows, and what was left out.

    A row is sound if all its required cells are numbers; a gap in another column is NaN. `several`
    may refuse the table. A NothingSound says that no row is sound.
    """
    table = read_table(given, recipe).valid()
    if several is not None:
        several(table)
    there = {name: column.values for name, column in table.known.items()}
    required = [name for name, entry in recipe.entries.items() if entry.required]
    sound = np.all([np.isfinite(there[name]) for name in required], axis=0)
    left_out = [*table.many_gaps(), *table.notes, *table.not_used()]
    if not sound.all():
        wrong = np.flatnonzero(~sound).tolist()
        name = next(name for name in required if not np.isfinite(there[name][wrong[0]]))
        cell = f"{name} = {shown(table.columns[name].cell(wrong[0]))}"
        text = (
            f"{table.at(wrong)}: {len(wrong)} of {len(table)} rows have a cell that is no number, "
            f"too few cells or too many, the first {table.ragged.get(wrong[0], cell)}."
        )
        left_out.append(Note("bad-cells", text, len(wrong)))
    if not sound.any():
        raise NothingSound(table.path, left_out[-1])
    for name, values in there.items():
        gaps = 0 if name in required else int(np.sum(~np.isfinite(values[sound])))
        if 0 < gaps <= MANY_GAPS * len(table):
            text = f"{table.name}: the column {name} has {counted(gaps, 'cell')} without a number."
            left_out.append(Note("gaps", text, gaps))
    return {name: values[sound] for name, values in there.items()}, left_out


def describe_table(table: SourceTable, means: Mapping[str, str]) -> list[str]:
    """Describe a table in lines: its rows, and each column with its unit, gaps and range.

    `means` says what known columns are, by name.
    """
    first, last = table.lines[0], table.lines[-1]
    lines = [f"{table.name}: {counted(len(table), 'row')}, from {table.word} {first} to {last}"]
    for k, wrong in [*table.ragged.items()][:1]:
        count = counted(len(table.ragged), "row")
        lines.append(f"{count} cannot be read, the first {table.word} {table.lines[k]}: {wrong}")
    rows: list[tuple[str, ...]] = [("column", "is", "unit", "gaps", "first", "range")]
    rows += [_row(column, means) for column in table.columns.values()]
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    return lines + ["  " + "  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]


def _row(column: Column, means: Mapping[str, str]) -> tuple[str, ...]:
    what, values = column.what, column.numbers * column.what.per
    is_used = means.get(what.name, what.name) if what.known else "not used"
    cells = [*map(number, column.odd.values() if what.known else column.texts)]
    wrong = 0 if what.clock or not what.known else cells.count(None)
    gaps = sum(each is not None and math.isnan(each) for each in cells)
    known = values[np.isfinite(values)]
    unit = what.unit or split_unit(what.heading)[1] or ("" if len(known) else "date" * what.clock)
    texts = (
        what.heading,
        "valid rows" if plain(what.name) in VALID else is_used,
        unit,
        f"{gaps}, {wrong} no number" if wrong else str(gaps),
        ", ".join(column.cell(k) for k in range(min(3, len(values)))),
        f"{known.min():.5g} to {known.max():.5g}" if len(known) else "",
    )
    return tuple(shortened(text) for text in texts)
