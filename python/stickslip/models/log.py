"""Logs in CSV files: which of their columns a model takes, and what is wrong with their rows."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import NamedTuple, NoReturn

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.files import read_bytes
from stickslip._util.messages import shown
from stickslip._util.tables import CsvTable
from stickslip._util.text import number
from stickslip._util.units import is_of, same_unit, split_unit, zero_of
from stickslip.diagnosis.data.series import Series
from stickslip.errors import ScenarioError, prefixed
from stickslip.measurement.read_table import LARGEST, MOST_BYTES, Rows, not_used, read_rows
from stickslip.simulation.note import Note

_TIME, _ERROR = "t", "sd"
_ALSO = {
    _TIME: ("time", "timestamp", "date", "datetime", "clock"),
    _ERROR: ("error",),
}  # what columns are called, too
_JUMP = 20.0
"""Steps of a clock that has jumped. Chosen: a link loses a few readings, and a break loses many."""
_ISO = re.compile(r"(\d{4}-\d\d-\d\d[T ])?\d\d:\d\d(:\d\d([.,]\d+)?)?Z?")
_DAY = 86400.0  # s, after which a clock without a date begins anew
_CUT = "cut the log into two files there"


class Columns(NamedTuple):
    """What a model takes of a log.

    Attributes
    ----------
    reads : str
        What is read.
    unit : str
        Its SI unit.
    inputs : dict
        SI units by name: one, or those of the quantities that it may be.
    needed : bool
        Whether all inputs have to be there. They are 0 otherwise.
    assumed : frozenset
        Inputs beside the first that are 0 where there is no column, as nothing else is stated.
    """

    reads: str
    unit: str
    inputs: Mapping[str, tuple[str, ...]]
    needed: bool = False
    assumed: frozenset[str] = frozenset()

    @property
    def units(self) -> dict[str, tuple[str, ...]]:
        """Units of all columns by name."""
        return {_TIME: ("s",), self.reads: (self.unit,), **self.inputs, _ERROR: (self.unit,)}

    def __str__(self) -> str:
        words = {
            name: " or ".join(units).replace("-", "no unit") for name, units in self.units.items()
        }
        return ", ".join(f"{name} ({unit})" for name, unit in words.items() if name != _ERROR)


def headings(path: str | PathLike[str], columns: Collection[str]) -> list[str]:
    """The headings of a CSV file; one of `columns` makes a comment above the numbers a header."""
    with prefixed(path):
        header = CsvTable(read_bytes(path, MOST_BYTES, "table"), columns).header
        if not header:
            raise ScenarioError("is empty: allowed are rows below a line of column names")
        return header


def read_log(path: str | PathLike[str], model: object) -> Series:
    """A log for a model: columns of time, of what is read, and of inputs.

    A column is known by its name, in whatever case, and else by its unit, where it is the only one
    of it: the time, what is read, and the first input. ``speed (rpm)`` is converted. A column
    ``sd`` has the error of each reading. Temperatures get the zero of the readings. Times may be
    dates or clocks, ``2026-05-01 12:00:00.25``. Rows without a reading are left out.

    Parameters
    ----------
    path : path
        CSV, with a line of headings.
    model : Model or Own
        Of `stickslip.models`.

    Returns
    -------
    Series
        Its notes tell what was taken for what, and what was not used.

    Raises
    ------
    ScenarioError
        If a column or unit is not known, the time or an input is missing in a row, or the clock
        runs backwards or jumps by more than 20 of its steps. It names line and column.
    """
    path = Path(path)
    wanted = getattr(model, "columns", None)
    if not isinstance(wanted, Columns):
        raise ScenarioError(f"model = {shown(model)}: allowed is a model of stickslip.models")
    there = headings(path, wanted.units)
    with prefixed(path):
        headings_of, notes = _found(there, wanted)
    names = {name: split_unit(heading)[0] for name, heading in headings_of.items()}
    units = {names[name]: _si(heading, wanted.units[name]) for name, heading in headings_of.items()}
    table = read_rows(path, units)
    used = {name: table.header.index(name_there) for name, name_there in names.items()}
    others = [heading for k, heading in enumerate(table.header) if k not in used.values()]
    notes += [*table.left_out, *not_used(path.name, others)]
    values = _values(table, used, wanted, notes)
    # An input may have no unit, and a temperature without one has the zero of the readings.
    bare = [
        name
        for name in (wanted.reads, *wanted.inputs)
        if name in values
        and split_unit(headings_of[name])[1] is None
        and (name == wanted.reads or {"-", "K"}.isdisjoint(wanted.units[name]))
    ]
    if bare:
        units_of = " and ".join(f"{name} in {wanted.units[name][0]}" for name in bare)
        notes.append(Note("no-unit", f"Headings without a unit are read in SI units: {units_of}."))
    unit = split_unit(headings_of[wanted.reads])[1]
    shows = unit if unit and same_unit(unit, wanted.unit) else wanted.unit
    inputs = {name: values[name] for name in wanted.inputs if name in values}
    for name in inputs.keys() & {name for name, of in wanted.inputs.items() if "K" in of}:
        # A temperature beside readings with another zero; without a unit it has theirs.
        own = split_unit(headings_of[name])[1]
        if own and unit and zero_of(own) != zero_of(unit):
            inputs[name] = inputs[name] + (zero_of(own) - zero_of(unit))
            notes.append(Note("other-zero", f"{name} is converted from {own} to {unit}."))
    log = Series(
        values[_TIME], values[wanted.reads], inputs, values.get(_ERROR), path.stem, unit=shows
    )
    return log.noted(notes)


def _found(there: Sequence[str], wanted: Columns) -> tuple[dict[str, str], list[Note]]:
    """Headings of the columns that are there, by what they are, and notes on those that were told
    by their unit or are missing."""
    headings_of: dict[str, str] = {}
    notes = []
    for name in wanted.units:
        for heading in there:
            plain = split_unit(heading)[0].casefold().replace("_", " ")
            if plain in (name.casefold().replace("_", " "), *_ALSO.get(name, ())):
                headings_of.setdefault(name, heading)
    first = next(iter(wanted.inputs), None)
    for name in (_TIME, wanted.reads, *wanted.inputs)[:3]:
        if name in headings_of:
            continue
        units = wanted.units[name]
        fit = [head for head in there if head not in headings_of.values() and _fits(head, units)]
        if len(fit) == 1:
            headings_of[name] = fit[0]
            notes.append(Note("column-by-unit", f"{shown(fit[0])} is taken for {name}."))
        elif fit or name != first:
            _missing(name, there, wanted)
    for name in wanted.inputs:
        if name not in headings_of and wanted.needed:
            _missing(name, there, wanted)
    for name in wanted.inputs:
        if name not in headings_of and name in (first, *wanted.assumed):
            notes.append(Note("no-input", f"There is no column {name}: it is taken as 0."))
    return headings_of, notes


def _missing(name: str, there: Sequence[str], wanted: Columns) -> NoReturn:
    unit = wanted.units[name][0]
    have = ", ".join(map(shown, there))
    raise ScenarioError(
        f'column "{name}" is missing; there are {have}: call one "{name} ({unit})"; '
        f"allowed are {wanted}, or the same in other units"
    )


def _fits(heading: str, units: Sequence[str]) -> bool:
    """Whether a heading states one of the units, or one of the same quantity."""
    stated = split_unit(heading)[1]
    return any(stated and is_of(stated, unit) for unit in units if unit != "-")


def _si(heading: str, units: Sequence[str]) -> str:
    """The one of the units that a heading's is of; the first of them, if of none."""
    stated = split_unit(heading)[1]
    return next((unit for unit in units if stated is not None and is_of(stated, unit)), units[0])


def _values(
    table: Rows, used: Mapping[str, int], wanted: Columns, notes: list[Note]
) -> dict[str, Array]:
    """Columns by name, NaN where a reading is missing; the last row may be cut off."""
    width, rows = len(table.header), list(table.rows)
    strict = [name for name in used if name not in (wanted.reads, _ERROR)]
    read = {name: _seconds if name == _TIME else _number for name in used}

    def wrong(cells: list[str]) -> str | None:
        """A column without a number, or "" of a row of another length."""
        if len(cells) != width:
            return ""
        bad = (name for name in strict if math.isnan(read[name](cells[used[name]])))
        return next(bad, None)

    if len(rows) > 1 and wrong(rows[-1][1]) is not None:
        notes.append(Note("cut-off", f"{table.at([rows.pop()[0]])}, the last, is cut off."))
    for line, cells in rows:
        name = wrong(cells)
        at = f"{table.path}: line {line}"
        if name == "":
            raise ScenarioError(
                f"{at} has {len(cells)} cells, and the header {width} names: write all of them, or "
                f"{_CUT}"
            )
        if name is not None:
            cell = shown(cells[used[name]])
            raise ScenarioError(
                f"{at}, column {name} = {cell}: allowed is a finite number: write it, or {_CUT}"
            )
    columns = {
        name: np.array([read[name](cells[k]) for _, cells in rows]) for name, k in used.items()
    }
    if all(_ISO.fullmatch(at := cells[used[_TIME]]) and "-" not in at for _, cells in rows):
        back = np.diff(columns[_TIME], prepend=columns[_TIME][:1]) < -0.5 * _DAY
        columns[_TIME] += _DAY * np.cumsum(back)
    _check_clock(table, [line for line, _ in rows], columns[_TIME])
    return columns


def _number(cell: str) -> float:
    return number(cell, LARGEST)


def _seconds(cell: str) -> float:
    """A time, s, as a number or as ISO 8601 writes a date or a clock; NaN if it is none."""
    if not _ISO.fullmatch(cell):
        return _number(cell)
    stamp = cell.replace(",", ".").removesuffix("Z")
    try:
        since = np.datetime64(stamp if "-" in cell else f"1970-01-01T{stamp}", "us")
    except ValueError:
        return math.nan
    return float((since - np.datetime64(0, "us")) / np.timedelta64(1, "s"))


def _check_clock(table: Rows, lines: Sequence[object], t: Array) -> None:
    steps = np.diff(t)
    usual = float(np.median(steps)) if len(steps) else 0.0
    for k in np.flatnonzero(~(steps > 0.0) | (steps > _JUMP * abs(usual)))[:1].tolist():
        at = f"{table.path}: line {lines[k + 1]}, column t = {t[k + 1]:.12g} s"
        if not steps[k] > 0.0:
            remedy = "write more digits" if steps[k] == 0.0 else "sort the rows"
            raise ScenarioError(f"{at}: allowed is a time after {t[k]:.12g} s: {remedy}, or {_CUT}")
        raise ScenarioError(
            f"{at}: the clock jumps by {steps[k]:.6g} s, and allowed are {_JUMP:g} of its steps of "
            f"{usual:.3g} s: {_CUT}"
        )
