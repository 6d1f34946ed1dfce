"""Cells of CSV files of voltages and fields: their columns and numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence

from stickslip._util.csv_rows import refuse_other_separators
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import nearest, refuse, shown


def column_order(line: int, header: list[str], columns: Sequence[str]) -> dict[str, int]:
    """Where in a header each of the columns stands; a ScenarioError if they are not all there."""
    expected = "allowed are " + ", ".join(columns)
    refuse_other_separators(header)
    for name in columns:
        if name not in header:
            near = nearest(name, [each for each in header if each not in columns])
            meant = "" if near is None else f", and {shown(near)} may be meant as it"
            raise ScenarioError(f"row {line}: the column {name} is missing{meant}; {expected}")
    for index, name in enumerate(header):
        where = f"row {line}, column"
        if name not in columns:
            raise ScenarioError(f"{where} {shown(name)}: there is no such column; {expected}")
        if name in header[:index]:
            raise ScenarioError(f"{where} {name}: is there twice; {expected}")
    return {name: header.index(name) for name in columns}


def finite_number(text: str, where: str, unit: str) -> float:
    """The number of a cell; a ScenarioError that says `where` if it is none or not finite."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        refuse(where, text, f"a finite number of {unit}")
    return value
