"""Cells of CSV files of voltages and fields: their columns, units and numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from stickslip._util.csv_rows import DECIMAL_COMMAS, CsvTable
from stickslip._util.text import comma_hint, number
from stickslip._util.units import per_si, split_unit, to_si
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import nearest, refuse, shown

Units = Mapping[str, str | None]
"""Of the columns that a table may have, the SI unit of their numbers; None of words."""


def without_units(header: Sequence[str], units: Units) -> tuple[list[str], list[float]]:
    """Names of the columns, and how many of the unit of each are one SI unit.

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


def read_cells(data: bytes, units: Units) -> Iterator[tuple[int, list[str], list[float]]]:
    """Of each row its line, its words and its SI numbers, in the order of `units`.

    A ScenarioError, which does not name the file, says which columns are missing or not known, and
    names the line of a row with other cells than numbers or with too few or too many.
    """
    table = CsvTable(data, units)
    if not any(table.header):
        raise ScenarioError("is empty: the first row has to be " + ",".join(units))
    names, per = without_units(table.header, units)
    order = _column_order(table.line, names, units)
    unnamed = [k for k, name in enumerate(names) if not name]
    words = [order[name] for name, unit in units.items() if unit is None]
    columns = [(order[name], name, unit) for name, unit in units.items() if unit is not None]
    plain, converted = table.separator == ",", any(each != 1.0 for each in per)
    for line, row in table.rows():
        if len(row) != len(names):
            hint = f"; {DECIMAL_COMMAS}" if len(row) > len(names) and table.separator == "," else ""
            raise ScenarioError(f"row {line} has {len(row)} cells: allowed are {len(names)}{hint}")
        for k in unnamed:
            if row[k]:
                raise ScenarioError(
                    f"row {line}: {shown(row[k])} stands in column {k + 1}, which has no name; "
                    "allowed are " + ", ".join(units)
                )
        values = []
        for k, name, unit in columns:
            value = number(row[k] if plain else table.with_point(line, row[k]))
            if math.isnan(value):
                what = f"a finite number of {unit}{comma_hint(row[k])}"
                refuse(f"row {line}, column {name}", row[k], what)
            values.append(value)
        if converted:
            values = [to_si(v, per[k]) for v, (k, _, _) in zip(values, columns, strict=True)]
        yield line, [row[k] for k in words], values


def _column_order(line: int, header: list[str], units: Units) -> dict[str, int]:
    """Where in a header each of the columns stands; a ScenarioError if they are not all there."""
    expected = "allowed are " + ", ".join(units)
    for name in units:
        if name not in header:
            near = nearest(name, [split_unit(each)[0] for each in header if each not in units])
            meant = "" if near is None else f", and {shown(near)} may be meant as it"
            raise ScenarioError(f"row {line}: the column {name} is missing{meant}; {expected}")
    for index, name in enumerate(header):
        where = f"row {line}, column"
        if name and name not in units:
            raise ScenarioError(f"{where} {shown(name)}: there is no such column; {expected}")
        if name and name in header[:index]:
            raise ScenarioError(f"{where} {name}: is there twice; {expected}")
    return {name: header.index(name) for name in units}
