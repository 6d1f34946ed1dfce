"""The one door for tables: recipes say what a table has, and its columns are read once, into SI.

A file, a data frame, a Dataset and a mapping of arrays become the same `SourceTable`.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stickslip._util.arrays import Array, Mask, columns_of, numbers, states_unit, without_unit
from stickslip._util.cells import DECIMAL_COMMAS, Block, CsvTable
from stickslip._util.files import read_bytes, replacing
from stickslip._util.messages import misspelt, nearest, refuse, shown
from stickslip._util.note import Note
from stickslip._util.text import comma_hint, counted, number, plain
from stickslip._util.units import is_unit, per_si, split_unit
from stickslip.errors import ScenarioError, prefixed

if TYPE_CHECKING:
    import pandas as pd

Line = int | str
"""Number of a line in a file, or the index label of a row in memory."""

LARGEST = 1e60
"""Beyond every quantity of a laboratory, in any unit; its fourth power is still a number."""

_MOST_ROWS, _MOST_COLUMNS = 2_000_000, 1000
MOST_BYTES, MOST_EXACT = 1 << 26, 1 << 29
"""Limits of a table. Chosen: far beyond what a laboratory has, and small enough for memory. A
program of voltages may be longer: a minute at 30 kHz is two million rows of six numbers."""

_GROUPED = re.compile(r"[+-]?\d{1,3}([.,' \u00a0\u2019]\d{3})+([.,]\d+)?")
_WITH_UNIT = re.compile(r"[+-]?\d+(?:[.,]\d+)?\s*([^\d\s.,].*)")
_LIMIT = re.compile(r"[<>≤≥]=?\s*[+-]?[\d.,]+(?:[eE][+-]?\d+)?")

_VALID = "valid", "ok"
_SAID = {"1": True, "1.0": True, "true": True, "yes": True,
         "0": False, "0.0": False, "false": False, "no": False}  # fmt: skip
"""Columns that say which rows are valid, and how they say it."""

_NAMED = 5
"""Rows that a note names; of more only the number is given. Chosen: one line."""


class Plausible(NamedTuple):
    """Sizes that numbers of a column may have, in SI; what is beyond is in another unit."""

    unit: str
    low: float = 0.0
    high: float = math.inf

    def first_beyond(self, values: Array) -> int | None:
        """The first row that is beyond, if there is one; a gap is not."""
        size = np.abs(values)
        beyond = np.flatnonzero((size < self.low) | (size > self.high))
        return int(beyond[0]) if len(beyond) else None


class Entry(NamedTuple):
    """What a recipe says of a column: its SI unit, None of words, and its other names."""

    unit: str | None
    also: tuple[str, ...] = ()
    required: bool = False
    plausible: Plausible | None = None


class Match(NamedTuple):
    """What a column of a source is: its name, its SI unit, None of words, and its stated unit."""

    name: str
    si: str | None = None
    unit: str | None = None
    per: float = 1.0
    known: bool = True


@dataclass(frozen=True)
class Recipe:
    """The columns of a kind of table.

    Attributes
    ----------
    entries : dict
        What each column is, by name. Headings may state other units, as ``x (mm)``.
    exact : bool
        Whether these columns and no others have to be there, and each cell has to be a number. A
        gap is NaN otherwise, and other columns are information.
    gaps : callable, optional
        Which numbers of a column stand for no value.
    information : collection of str
        Names of others that are not taken for slips of known ones.
    """

    entries: Mapping[str, Entry]
    exact: bool = False
    gaps: Callable[[Array], Mask] | None = None
    information: Collection[str] = ()

    @staticmethod
    def of(units: Mapping[str, str | None], required: Collection[str] = (), **more: Any) -> Recipe:
        """Of columns by name and SI unit."""
        entries = {name: Entry(unit, (), name in required) for name, unit in units.items()}
        return Recipe(entries, **more)

    @property
    def names(self) -> list[str]:
        """All names that a column may have."""
        also = (other for entry in self.entries.values() for other in entry.also)
        return [*self.entries, *also]

    def matched(self, headings: Sequence[str]) -> list[Match]:
        """What the columns are; a ScenarioError names a unit that is not one of its column."""
        names = {other: name for name, entry in self.entries.items()
                 for other in (name, *entry.also)}  # fmt: skip
        made = []
        for heading in headings:
            name, unit = split_unit(heading)
            if name not in names:
                made.append(Match(heading, known=False))
                continue
            si = self.entries[names[name]].unit
            per = 1.0 if unit is None else per_heading(heading, unit, "-" if si is None else si)
            made.append(Match(names[name], si, unit, per))
        refuse_twice([match.name for match in made])
        return made

    def check(self, table: SourceTable) -> list[str]:
        """The columns that are information.

        A ScenarioError names a required column that is missing, or one that may be meant as a known
        one that is not there.
        """
        for name, entry in self.entries.items():
            if entry.required and name not in table.columns:
                headings = [column.heading for column in table.columns.values()]
                near = nearest(name, [split_unit(heading)[0] for heading in headings])
                meant = "" if near is None else f", and {shown(near)} may be meant as it"
                there = textwrap.shorten(", ".join(headings), 300, placeholder=" ...")
                raise ScenarioError(
                    f'{table.path}: column "{name}" is missing; there are {there}{meant}'
                )
        others = [name for name, column in table.columns.items()
                  if name not in self.entries and plain(name) not in _VALID]  # fmt: skip
        for name in others:
            bare = split_unit(name)[0]
            near = None if bare in self.information else misspelt(bare, self.entries)
            if near and (near not in table.columns or near.casefold() == bare.casefold()):
                raise ScenarioError(
                    f'{table.path}: column {shown(name)} is not known; did you mean "{near}"? '
                    "Give a column of information a name that is less like it"
                )
        return others


def per_heading(heading: str, unit: str, si: str) -> float:
    """How many of a heading's unit are one SI unit; a ScenarioError lists what is allowed."""
    try:
        return per_si(unit, si)
    except ValueError as error:
        raise ScenarioError(f"column {shown(heading)}: the unit is not known; {error}") from None


@dataclass(frozen=True, eq=False)
class Column:
    """A column: numbers in SI, or words.

    Attributes
    ----------
    heading : str
        As it stands in the source.
    what : Match
    values : ndarray, shape (n,)
        Numbers, NaN in gaps; empty of words.
    texts : sequence of str, shape (n,)
        Words; empty of numbers.
    odd : dict
        By row the cells that are no numbers.
    """

    heading: str
    what: Match
    values: Array
    texts: Sequence[str] = ()
    odd: Mapping[int, str] = field(default_factory=dict)

    @cached_property
    def numbers(self) -> Array:
        """Its numbers, whatever it is; NaN of words."""
        if self.what.si is not None:
            return self.values
        return np.array([number(text, LARGEST) for text in self.texts])

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
        odd = self.odd and {i: self.odd[k] for i, k in enumerate(rows) if k in self.odd}
        return replace(self, values=self.values[rows], odd=odd)


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
        Of rows with too many or too few cells how many; their cells are gaps.
    notes : tuple of Note
    word : str
        What a line is called.
    """

    path: Path
    name: str
    columns: Mapping[str, Column]
    lines: Sequence[Line]
    ragged: Mapping[int, int] = field(default_factory=dict)
    notes: tuple[Note, ...] = ()
    word: str = "line"

    def __len__(self) -> int:
        return len(self.lines)

    def at(self, rows: Sequence[int]) -> str:
        """``velocity.csv line 3``, or the first of several lines."""
        word = self.word if len(rows) == 1 else f"{self.word}s"
        named = ", ".join(str(self.lines[k]) for k in rows[:_NAMED])
        return f"{self.name} {word} {named}{', ...' if len(rows) > _NAMED else ''}"

    def kept(self, rows: Sequence[int], note: Note | None = None) -> SourceTable:
        """The table of some rows, with a note."""
        return replace(
            self,
            columns={name: column.kept(rows) for name, column in self.columns.items()},
            lines=[self.lines[k] for k in rows],
            ragged=self.ragged and {i: self.ragged[k] for i, k in enumerate(rows)
                                    if k in self.ragged},
            notes=(*self.notes, *([note] if note else [])),
        )  # fmt: skip

    def validity(self) -> list[Column]:
        """The columns that say which rows are valid."""
        return [column for name, column in self.columns.items()
                if plain(name) in _VALID and not column.what.known]  # fmt: skip

    def not_valid(self, column: Column) -> Mask:
        """Which rows a column calls not valid."""
        said = []
        for k, line in enumerate(self.lines):
            word = "1" if k in self.ragged else column.texts[k].casefold()
            if word not in _SAID:
                raise ScenarioError(
                    f"{self.path}: {self.word} {line}, column {column.heading} = "
                    f"{shown(column.texts[k])}: allowed are {', '.join(_SAID)}"
                )
            said.append(not _SAID[word])
        return np.array(said, dtype=bool)

    def valid(self) -> SourceTable:
        """The table without the rows that a column ``valid`` or ``ok`` calls not valid."""
        table = self
        for column in self.validity():
            lost = table.not_valid(table.columns[column.what.name])
            if lost.any():
                count = int(lost.sum())
                text = f"{self.name}: {counted(count, 'row')} left out by column {column.heading}."
                note = Note("not-valid", text, count)
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
        self.name = self.path.name
        self.carried: list[str] = []
        with prefixed(self.path):
            self.data = read_bytes(given, most, "table") if self.is_file else b""

    def csv(self, names: Collection[str]) -> CsvTable:
        """The file from its header on, which has one of some names."""
        return CsvTable(self.data, names)

    @cached_property
    def arrays(self) -> dict[str, Any]:
        """Columns of a table in memory by heading, with the units that these carry."""
        given = self.given
        if hasattr(given, "data_vars"):  # of xarray
            there = {**given.coords, **given.data_vars}
            found: dict[Any, Any] | None = {k: v for k, v in there.items() if v.ndim == 1}
        else:
            found = columns_of(self.name, given)
        if found is None:
            refuse("table", given, "a DataFrame, or columns by name")
        made = dict(self._with_unit(str(name), values) for name, values in (found or {}).items())
        if not made or not len(next(iter(made.values()))):
            raise ScenarioError("has no row of data")
        return made

    def _with_unit(self, name: str, values: Any) -> tuple[str, Any]:
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
        self.carried.append(heading)
        return heading, plain

    def headings(self, names: Collection[str]) -> list[str]:
        """The headings; one of some names makes a comment above the numbers a header."""
        with prefixed(self.path):
            if not self.is_file:
                return list(self.arrays)
            header = self.csv(names).header
            _check_header(header)
            return header

    def read(self, recipe: Recipe) -> SourceTable:
        """The table as a recipe says; a ScenarioError begins with the path."""
        with prefixed(self.path):
            return _read_file(self, recipe) if self.is_file else _read_arrays(self, recipe)


def read_table(given: Any, recipe: Recipe) -> SourceTable:
    """The table in a file or in memory, as a recipe says.

    Raises
    ------
    ScenarioError
        If the file cannot be read or is empty, or a column is there twice or in a unit that is not
        known; with an exact recipe also if a column or cell is not as it has to be.
    """
    source = given if isinstance(given, Source) else Source(
        given, MOST_EXACT if recipe.exact else MOST_BYTES)  # fmt: skip
    return source.read(recipe)


def index_labels(table: Any) -> list[Line]:
    """What the rows of a table in memory are called in messages: whole numbers stay numbers."""
    index = getattr(table, "index", None)
    if index is None or callable(index):
        return []
    return [int(line) if isinstance(line, int | np.integer) else str(line) for line in index]


def _check_header(header: Sequence[str]) -> None:
    if not header:
        raise ScenarioError("is empty: allowed are rows below a line of column names")
    if not any(math.isnan(number(name.replace(",", "."))) for name in header if name):
        raise ScenarioError("its first line is numbers: write a line of column names above it")


def _read_file(source: Source, recipe: Recipe) -> SourceTable:
    file = source.csv(recipe.names)
    if recipe.exact:
        if not file.line:
            raise ScenarioError(f"is empty: the first row has to be {','.join(recipe.entries)}")
        matches = _exactly(file, recipe)
    headings = _named(file.header)
    if len(headings) > _MOST_COLUMNS:
        raise ScenarioError(f"{len(headings)} columns; allowed are {_MOST_COLUMNS}")
    if not recipe.exact:
        if not headings:
            raise ScenarioError("has no row of data below a line of column names")
        _check_header(file.header)
        matches = recipe.matched(headings)
    parts = [_Part(heading, match) for heading, match in zip(headings, matches, strict=True)]
    lines: list[int] = []
    ragged: dict[int, int] = {}
    for block in file.blocks():
        if recipe.exact:
            _check_row(file, block, len(recipe.entries))
        for k, part in enumerate(parts):
            part.take(file, block, k, recipe.exact)
        ragged |= {len(lines) + k: count for k, count in block.ragged.items()}
        lines += block.lines
        if len(lines) > _MOST_ROWS and not recipe.exact:
            raise ScenarioError(f"has more rows than are allowed, {_MOST_ROWS}")
    if not recipe.exact:
        _check_size(file, lines, ragged)
    file.check_thousands()
    here = [part for part, name in zip(parts, file.header, strict=True)
            if name or any(part.texts)]  # fmt: skip
    lost = len(parts) - len(here) + file.beyond
    columns = {part.match.name: part.column(lines, recipe) for part in here}
    text = {
        "preamble": (file.above, "{} above the column names skipped.", "line"),
        "comments": (file.comments, "{} below the header skipped as a comment.", "line"),
        "empty-columns": (lost, "{} without a name left out.", "empty column"),
    }
    notes = [Note(code, f"{source.name}: {words.format(counted(count, thing))}", count)
             for code, (count, words, thing) in text.items() if count]  # fmt: skip
    return SourceTable(source.path, source.name, columns, lines, ragged, tuple(notes))


def _named(header: Sequence[str]) -> list[str]:
    """Headings; a column without one is called by its place, or index, as programs write theirs."""
    named = [heading or f"column {k + 1}" for k, heading in enumerate(header)]
    if named and not header[0] and "index" not in header:
        named[0] = "index"
    return named


def _check_size(file: CsvTable, lines: Sequence[int], ragged: Mapping[int, int]) -> None:
    width = len(file.header)
    if not lines:
        raise ScenarioError("has no row of data below a line of column names")
    if file.separator == "," and len(ragged) == len(lines) and min(ragged.values()) > width:
        few = f"line {lines[0]} has {ragged[0]} cells, and the header {width} names"
        raise ScenarioError(f"{few}, and so on; {DECIMAL_COMMAS}")


class _Part:
    """A column as far as it was read."""

    def __init__(self, heading: str, match: Match) -> None:
        self.heading, self.match = heading, match
        self.texts: list[str] = []
        self.values: list[Array] = []
        self.odd: dict[int, str] = {}
        self.count = 0

    def take(self, file: CsvTable, block: Block, k: int, exact: bool) -> None:
        """Read a block of it."""
        if self.match.si is None:
            self.texts += map(str.strip, block.columns[k])
            return
        cells = file.pointed(block, k)
        try:
            if not block.plain:
                raise ValueError  # Python reads 1_000 as a number
            values = np.array(list(map(float, cells)))
        except ValueError:
            values = np.array([number(cell.strip(), LARGEST) for cell in cells])
        values[np.abs(values) >= LARGEST] = math.nan
        for i in np.flatnonzero(np.isnan(values)).tolist():
            cell = self.odd[self.count + i] = cells[i].strip()
            line = block.lines[i]
            if exact:
                allowed = f"a finite number of {self.match.si}{comma_hint(cell)}"
                refuse(f"row {line}, column {self.match.name}", cell, allowed)
            if _is_no_gap(cell):
                raise ScenarioError(
                    f"line {line}, column {self.match.name} = {shown(cell)}: allowed is the number "
                    "alone, without separators of thousands and without a unit"
                )
        self.values.append(values)
        self.count += len(values)

    def column(self, lines: Sequence[int], recipe: Recipe) -> Column:
        """The whole of it."""
        values = np.concatenate(self.values) if self.values else np.empty(0)
        return _made(self.heading, self.match, values, self.texts, self.odd, recipe)


def _made(
    heading: str, match: Match, values: Array, texts: Sequence[str], odd: dict[int, str],
    recipe: Recipe,
) -> Column:  # fmt: skip
    """A column of numbers as they stand, in SI and without what stands for no value."""
    if match.si is not None and recipe.gaps is not None:
        gone = recipe.gaps(values)
        odd |= {k: f"{values[k]:.15g} (stands for no value)"
                for k in np.flatnonzero(gone).tolist()}  # fmt: skip
        values = np.where(gone, math.nan, values)
    if match.per != 1.0:
        # By an exact power of ten where there is one, so rounded once.
        values = values / match.per if match.per >= 1.0 else values * (1.0 / match.per)
    return Column(heading, match, values, texts, odd)


def _is_no_gap(cell: str) -> bool:
    """Whether a cell has separators of thousands or a unit: a mistake of the whole column."""
    with_unit = _WITH_UNIT.fullmatch(cell)
    return bool(_GROUPED.fullmatch(cell)) or (
        with_unit is not None and (is_unit(with_unit[1]) or with_unit[1] in ("k", "M", "%"))
    )


def limits(column: Column) -> list[int]:
    """Rows whose cell is a limit, such as ``<25.0``: no reading, though no gap either."""
    return [k for k, cell in column.odd.items() if _LIMIT.fullmatch(cell)]


def _exactly(file: CsvTable, recipe: Recipe) -> list[Match]:
    """What the columns are, which have to be those of the recipe."""
    header = list(file.header)
    while header and not header[-1]:
        header.pop()
    matches = []
    for heading in header:
        name, unit = split_unit(heading)
        entry = recipe.entries.get(name)
        known = entry is not None
        si = "-" if entry is None or entry.unit is None else entry.unit
        per = per_heading(heading, unit, si) if known and unit is not None else 1.0
        matches.append(Match(name if known else heading, entry and entry.unit, unit, per))
    names, expected = [match.name for match in matches], "allowed are " + ", ".join(recipe.entries)
    for name in recipe.entries:
        if name not in names:
            others = [split_unit(word)[0] for word in names if word not in recipe.entries]
            near = nearest(name, others)
            meant = "" if near is None else f", and {shown(near)} may be meant as it"
            raise ScenarioError(f"row {file.line}: the column {name} is missing{meant}; {expected}")
    for k, name in enumerate(names):
        at = f"row {file.line}, column"
        if not name:
            raise ScenarioError(
                f"row {file.line}: column {k + 1} has no name, as an index has none: allowed are "
                "named columns; leave it out (index=False in pandas)"
            )
        if name not in recipe.entries:
            raise ScenarioError(f"{at} {shown(name)}: there is no such column; {expected}")
        if name in names[:k]:
            raise ScenarioError(f"{at} {name}: is there twice; {expected}")
    empty = len(file.header) - len(matches)
    return [*matches, *(Match(f"column {len(matches) + k + 1}") for k in range(empty))]


def _check_row(file: CsvTable, block: Block, count: int) -> None:
    """Refuse the first row that has another number of cells than an exact recipe has columns."""
    width = len(block.columns)
    wrong = dict(block.ragged)
    for k in range(count, width):
        more = (i for i, cell in enumerate(block.columns[k]) if cell.strip())
        wrong |= dict.fromkeys(more, width)
    if wrong:
        row = min(wrong)
        commas = " or a decimal comma" if file.separator == "," else ""
        raise ScenarioError(
            f"row {block.lines[row]} has {wrong[row]} cells: allowed are {count}; look for a quote"
            f"{commas}"
        )


def _read_arrays(source: Source, recipe: Recipe) -> SourceTable:
    arrays = source.arrays
    matches = recipe.matched(list(arrays))
    count = len(next(iter(arrays.values())))
    lines = index_labels(source.given) or list(range(count))
    columns = {}
    for (heading, values), match in zip(arrays.items(), matches, strict=True):
        if len(values) != count:
            raise ScenarioError(f"column {heading}: {len(values)} values; allowed are {count}")
        made, texts, odd, cells = np.empty(0), list[str](), dict[int, str](), list(values)
        if match.si is None:
            texts = [_cell(value) for value in cells]
        elif any(isinstance(cell, str) for cell in cells):
            # Texts are checked one by one, as those of a file.
            cells = [_cell(value) for value in cells]
            made = np.array([number(cell, LARGEST) for cell in cells])
            odd = {k: cells[k] for k in np.flatnonzero(np.isnan(made)).tolist()}
            for k, cell in odd.items():
                if _is_no_gap(cell):
                    raise ScenarioError(
                        f"line {lines[k]}, column {match.name} = {shown(cell)}: allowed is the "
                        "number alone, without separators of thousands and without a unit"
                    )
        else:
            made = numbers(f"column {heading}", values, gaps=True, finite=False)
            wild = np.flatnonzero(~(np.abs(made) < LARGEST)).tolist()
            odd = {k: "" if math.isnan(made[k]) else f"{made[k]}" for k in wild}
            made = np.where(np.abs(made) < LARGEST, made, math.nan)
            if states_unit(values):  # dates and durations are in s, whatever the heading says
                match = match._replace(unit="s", per=1.0)
        columns[match.name] = _made(heading, match, made, texts, odd, recipe)
    found = [f"{column.what.name} from {column.what.unit} to {column.what.si}"
             for column in columns.values()
             if column.heading in source.carried and column.what.per != 1.0]  # fmt: skip
    text = f"{source.name}: converted as their units say: {', '.join(found)}."
    notes = (Note("converted", text, len(found)),) if found else ()
    return SourceTable(source.path, source.name, columns, lines, {}, notes, "row")


def _cell(value: Any) -> str:
    if isinstance(value, float | np.floating):
        return "" if math.isnan(value) else repr(float(value))
    return "" if value is None or str(value) in ("<NA>", "NaT") else str(value).strip()


def refuse_twice(names: Sequence[str]) -> None:
    """Refuse columns of which two have one name."""
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ScenarioError(f"column {shown(twice[0])} is there twice")


def not_used(name: str, columns: Sequence[str]) -> list[Note]:
    """A note about the columns of a table that are information only, if there are any."""
    if not columns:
        return []
    first, more = list(columns[:_NAMED]), len(columns) - _NAMED
    first += [f"{more} more"] if more > 0 else []
    listed = " and ".join([", ".join(first[:-1]), first[-1]] if len(first) > 1 else first)
    text = f"{name}: columns that are information only: {listed}."
    return [Note("columns-not-used", text, len(columns))]


def sound_numbers(
    given: Any, recipe: Recipe, several: Callable[[SourceTable], None] | None = None
) -> tuple[dict[str, Array], list[Note]]:
    """Columns of numbers by name, shape (n,), of the sound rows, and what was left out.

    A row is sound if all its required cells are numbers; a gap in another column is NaN. What is
    not plausible is refused, and `several` may refuse the table. A NothingSound says that no row is
    sound.
    """
    table = read_table(given, recipe)
    table = table.valid()
    others = recipe.check(table)
    if several is not None:
        several(table)
    there = {name: column.values for name, column in table.columns.items()
             if name in recipe.entries}  # fmt: skip
    required = [name for name, entry in recipe.entries.items() if entry.required]
    sound = np.all([np.isfinite(there[name]) for name in required], axis=0)
    for name, entry in recipe.entries.items():
        beyond = None
        if entry.plausible is not None and name in there:
            beyond = entry.plausible.first_beyond(np.where(sound, there[name], math.nan))
        if beyond is not None and entry.plausible is not None:
            unit, highest = entry.plausible.unit, entry.plausible.high
            raise ScenarioError(
                f"{table.path}: {table.word} {table.lines[beyond]}, column {name} = "
                f"{there[name][beyond]:g} {unit}: allowed is at most {highest:g} {unit}; divide "
                f"numbers in m{unit} by 1e3, and leave the cell of a saturated reading empty"
            )
    left_out = [*table.notes, *not_used(table.name, others)]
    if not sound.all():
        wrong = np.flatnonzero(~sound).tolist()
        first = wrong[0]
        name = next(name for name in required if not np.isfinite(there[name][first]))
        cell = f"the first {name} = {shown(table.columns[name].cell(first))}"
        if first in table.ragged:
            cell = f"the first {table.ragged[first]} cells"
        text = (
            f"{table.at(wrong)}: {len(wrong)} of {len(table)} rows have a cell that is no number, "
            f"too few cells or too many, {cell}."
        )
        left_out.append(Note("bad-cells", text, len(wrong)))
    if not sound.any():
        raise NothingSound(table.path, left_out[-1])
    for name, values in there.items():
        gaps = 0 if name in required else int(np.sum(~np.isfinite(values[sound])))
        if gaps:
            text = f"{table.name}: the column {name} has {counted(gaps, 'cell')} without a number."
            left_out.append(Note("gaps", text, gaps))
    return {name: values[sound] for name, values in there.items()}, left_out


def write_frame(frame: pd.DataFrame, path: str | PathLike[str]) -> None:
    """Write a table as CSV, whole or not at all; headings name the units of ``attrs["units"]``."""
    units = frame.attrs.get("units", {})
    named = {name: f"{name} ({unit})" for name, unit in units.items() if unit not in ("", "-", "1")}
    with replacing(path) as temporary:
        frame.rename(columns=named).to_csv(temporary, index=False)
