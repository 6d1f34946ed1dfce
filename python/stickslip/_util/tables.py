"""Tables of numbers in CSV files."""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stickslip._util.csv_rows import CsvTable, named_cells
from stickslip._util.files import read_bytes, replacing
from stickslip._util.messages import nearest, refuse, shown
from stickslip._util.numbers import Array
from stickslip._util.text import comma_hint, number
from stickslip._util.units import per_si, split_unit, to_si
from stickslip.errors import ScenarioError, prefixed

if TYPE_CHECKING:
    import pandas as pd

Units = Mapping[str, str | None]
"""The SI unit of each column that a table may have; None for words."""

_MOST_BYTES = 1 << 29
"""Chosen: a minute of voltages at 30 kHz, two million rows of six numbers, is shorter."""


class Rows(NamedTuple):
    """What `read_table` read.

    `numbers` has the columns of numbers in the order in which they were asked for, shape (n, m),
    SI; `words` has those of words by name, and `lines` the line of each row in the file.
    """

    numbers: Array
    words: dict[str, list[str]]
    lines: Sequence[int]


def read_table(path: str | PathLike[str], columns: Units) -> Rows:
    """Read a CSV file that has all of some columns, in any order, and no others.

    It is read as a `CsvTable`. Headings may state units, such as ``t (ms)``.

    Raises
    ------
    ScenarioError
        If the file cannot be read, or a column or cell is not as it has to be. The message names
        file, row and column.
    """
    with prefixed(path):
        file = CsvTable(read_bytes(path, _MOST_BYTES, "table"), columns)
        if not file.line:
            raise ScenarioError(f"is empty: the first row has to be {','.join(columns)}")
        return _parsed(file, columns)


def _parsed(file: CsvTable, columns: Units) -> Rows:
    names, per = without_units(named_cells(file.header), columns)
    order = _places(file.line, names, columns)
    numbers = {name: unit for name, unit in columns.items() if unit is not None}
    words: dict[str, list[str]] = {name: [] for name in columns if name not in numbers}
    values, lines = array("d"), array("l")
    for line, cells in file.rows():
        if len(cells) < len(names) or any(cells[len(names) :]):
            commas = " or a decimal comma" if file.separator == "," else ""
            raise ScenarioError(
                f"row {line} has {len(cells)} cells: allowed are {len(names)}; look for a quote"
                f"{commas}"
            )
        lines.append(line)
        for name, found in words.items():
            found.append(cells[order[name]])
        for name, unit in numbers.items():
            cell = cells[order[name]]
            value = number(file.with_point(line, order[name], cell))
            if math.isnan(value):
                what = f"a finite number of {unit}{comma_hint(cell)}"
                refuse(f"row {line}, column {name}", cell, what)
            values.append(to_si(value, per[order[name]]))
    file.check_thousands()
    table = np.frombuffer(values) if values else np.empty(0)
    return Rows(table.reshape(-1, len(numbers)), words, lines)


def without_units(header: Sequence[str], units: Units) -> tuple[list[str], list[float]]:
    """Names of the columns, and how many of each one's unit make one SI unit.

    A column that `units` does not have keeps its whole heading. A ScenarioError names a unit that
    is not one of its column.
    """
    names, per = [], []
    for heading in header:
        name, unit = split_unit(heading)
        si = units.get(name)
        names.append(name if name in units else heading)
        per.append(1.0)
        if name not in units or unit is None:
            continue
        try:
            per[-1] = per_si(unit, "-" if si is None else si)
        except ValueError as error:
            raise ScenarioError(
                f"column {shown(heading)}: the unit is not known; {error}"
            ) from None
    return names, per


def _places(line: int, header: list[str], columns: Units) -> dict[str, int]:
    """Where in a header each of the columns stands; a ScenarioError if they are not all there."""
    expected = "allowed are " + ", ".join(columns)
    for name in columns:
        if name not in header:
            near = nearest(name, [split_unit(each)[0] for each in header if each not in columns])
            meant = "" if near is None else f", and {shown(near)} may be meant as it"
            raise ScenarioError(f"row {line}: the column {name} is missing{meant}; {expected}")
    for index, name in enumerate(header):
        if not name:
            raise ScenarioError(
                f"row {line}: column {index + 1} has no name, as an index has none: allowed are "
                f"named columns; leave it out (index=False in pandas)"
            )
        if name not in columns:
            raise ScenarioError(
                f"row {line}, column {shown(name)}: there is no such column; {expected}"
            )
        if name in header[:index]:
            raise ScenarioError(f"row {line}, column {name}: is there twice; {expected}")
    return {name: header.index(name) for name in columns}


def write_frame(frame: pd.DataFrame, path: str | PathLike[str]) -> None:
    """Write a table as CSV, whole or not at all; headings name the units of ``attrs["units"]``."""
    units = frame.attrs.get("units", {})
    named = {name: f"{name} ({unit})" for name, unit in units.items() if unit not in ("", "-", "1")}
    with replacing(path) as temporary:
        frame.rename(columns=named).to_csv(temporary, index=False)
