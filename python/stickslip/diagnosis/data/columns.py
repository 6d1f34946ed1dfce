"""Columns of a log: what their headings say, and how they are understood, for people."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from stickslip._util.cells import number
from stickslip._util.columns import Column, SourceTable
from stickslip._util.recipes import VALID
from stickslip._util.text import counted, plain, shortened
from stickslip._util.units import ended, is_of, is_unit, split_unit


class Heading(NamedTuple):
    """A heading, its name, and its unit if it states one."""

    text: str
    name: str
    unit: str | None

    @staticmethod
    def of(text: str) -> Heading:
        """A heading by its text; ``_time`` or ``%time`` is a time, and ``rpm`` alone is a unit."""
        name, unit = split_unit(text)
        bare = unit is None and len(name) > 2 and is_unit(name)
        return Heading(text, name.strip("_%"), name if bare else unit)

    @property
    def words(self) -> set[str]:
        """The words of its name."""
        return {*plain(self.name).split()}

    @property
    def bare(self) -> str:
        """Its name without a unit behind an underscore or a blank."""
        return next((name for name, _ in ended(self.name)), self.name)

    @property
    def is_open(self) -> bool:
        """Whether it may be of any quantity, as it states no known unit."""
        return not ended(self.text) if self.unit is None else not is_unit(self.unit)

    def find_unit(self, units: Sequence[str]) -> Heading | None:
        """Return itself with the unit behind its name, if that is of some units."""
        made = (Heading(self.text, *parts) for parts in ended(self.text))
        return next((each for each in made if each.fits(units)), None)

    def si(self, units: Sequence[str]) -> str:
        """The one of the units that its own is of; the first of them, if of none."""
        return next((each for each in units if self.unit and is_of(self.unit, each)), units[0])

    def written(self, units: Sequence[str]) -> str:
        """The unit to write in it as one of some quantities: its own, or of counts an example."""
        counts = {"count", "counts", "tick", "ticks"} & {*self.words, self.unit}
        return "rev/4096" if counts and "rad" in units else self.unit or units[0]

    def fits(self, units: Sequence[str]) -> bool:
        """Whether it states one of the units, or one of the same quantity."""
        return any(self.unit and is_of(self.unit, each) for each in units if each != "-")


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
