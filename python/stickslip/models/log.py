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
from stickslip._util.note import Note
from stickslip._util.tables import CsvTable
from stickslip._util.text import counted, number, plain
from stickslip._util.units import is_of, per_si, same_unit, split_unit, zero_of
from stickslip.diagnosis.data.read_table import (
    LARGEST,
    MOST_BYTES,
    STAMP,
    Line,
    Rows,
    not_used,
    not_valid,
    read_rows,
    seconds,
    validity,
)
from stickslip.diagnosis.data.series import LATEST, Series
from stickslip.diagnosis.data.table import READINGS
from stickslip.errors import ScenarioError, prefixed

_TIME, _ERROR = "t", "sd"
_ALSO = {
    _TIME: ("time", "timestamp", "unix", "unix time", "date", "datetime", "clock"),
    _ERROR: ("error",),
}  # what columns are called, too
_JUMP = 20.0
"""Steps of a clock that has jumped. Chosen: a link loses a few readings, and a break loses many."""
_DATE = 1e8
"""Seconds since 1970 from which on a time is a date. Chosen: no experiment runs for three years."""
_TURN = 2.0 * math.pi
"""Largest angle without a unit, rad. Chosen: beyond a turn it may be in degrees as well."""
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
        if not any(math.isnan(number(name.replace(",", "."))) for name in header if name):
            raise ScenarioError("its first line is numbers: write a line of column names above it")
        return header


def read_log(path: str | PathLike[str], model: object) -> Series:
    """A log for a model: columns of time, of what is read, and of inputs.

    A column is known by its name, in whatever case, and else by its unit, where it is the only one
    of it: the time, what is read, and the first input. ``speed (rpm)`` is converted. A column
    ``sd`` has the error of each reading. Temperatures get the zero of the readings. Times may be
    dates or clocks, ``2026-05-01 12:00:00.25``, or counts since 1970; these are counted from the
    first reading. Rows without a reading are left out, and those whose column ``valid`` or ``ok``
    has 0.

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
        found, notes = _found(there, wanted)
    units = {each.name: each.si(wanted.units[column]) for column, each in found.items()}
    table = read_rows(path, units)
    used = {column: table.header.index(each.name) for column, each in found.items()}
    valid = [k for k in validity(table.header) if k not in used.values()]
    others = [head for k, head in enumerate(table.header) if k not in (*used.values(), *valid)]
    notes += [*table.left_out, *not_used(path.name, others)]
    rows = _whole_rows(table, used, wanted, notes)
    values = {
        column: found[column].in_si([_READ.get(column, _number)(cells[k]) for _, cells in rows],
                                    wanted.units[column])
        for column, k in used.items()
    }  # fmt: skip
    read = found[wanted.reads]
    if _ERROR in found and found[_ERROR].unit is None and read.unit:
        # An error without a unit is in that of its readings.
        values[_ERROR] = values[_ERROR] / per_si(read.unit, read.si(wanted.units[wanted.reads]))
    for k in valid:
        lost = np.isfinite(values[wanted.reads]) & not_valid(table, rows, k)
        values[wanted.reads][lost] = math.nan
        if lost.any():
            text = f"{counted(int(lost.sum()), 'reading')} left out by column {table.header[k]}."
            notes.append(Note("not-valid", text, int(lost.sum())))
    stamps = [STAMP.fullmatch(cells[used[_TIME]]) for _, cells in rows]
    values[_TIME] = _counted_on(values[_TIME], stamps, found[_TIME].unit, notes)
    told = {_TIME} if stamps[0] or "dates" in {note.code for note in notes} else set()
    _check_clock(table, [line for line, _ in rows], values[_TIME])
    bare = _bare({column: each for column, each in found.items() if column not in told}, wanted)
    if bare:
        units_of = ", ".join(f"{column} in {wanted.units[column][0]}" for column in bare)
        notes.append(Note("no-unit", f"Headings without a unit are read in SI units: {units_of}."))
    shows = read.unit if read.unit and same_unit(read.unit, wanted.unit) else wanted.unit
    inputs = _with_one_zero(values, found, wanted, notes)
    log = Series(
        values[_TIME], values[wanted.reads], inputs, values.get(_ERROR), path.stem, unit=shows
    )
    log.unstated = [READINGS if column == wanted.reads else column
                    for column, each in found.items()
                    if each.unit is None and column not in {*told, _ERROR}]  # fmt: skip
    largest = float(np.max(np.abs(log.y)))
    if wanted.unit == "rad" and wanted.reads in bare and largest > _TURN:
        raise ScenarioError(
            f"{path}: column {read.text} has no unit and reaches {largest:.4g}: beyond a turn "
            f'allowed is "{read.text} (rad)" or "{read.text} (deg)"'
        )
    return log.noted(notes)


class _Heading(NamedTuple):
    """A heading, the name of its column in a table that was read, and its unit if it states one."""

    text: str
    name: str
    unit: str | None

    def si(self, units: Sequence[str]) -> str:
        """The one of the units that its own is of; the first of them, if of none."""
        return next((each for each in units if self.unit and is_of(self.unit, each)), units[0])

    def in_si(self, values: Sequence[float], units: Sequence[str]) -> Array:
        """Values as they were read, in SI: a unit after an underscore is left to be converted."""
        ends = self.unit is not None and self.name == self.text
        return np.array(values) / (per_si(str(self.unit), self.si(units)) if ends else 1.0)

    def fits(self, units: Sequence[str]) -> bool:
        """Whether it states one of the units, or one of the same quantity."""
        return any(self.unit and is_of(self.unit, each) for each in units if each != "-")


def _found(there: Sequence[str], wanted: Columns) -> tuple[dict[str, _Heading], list[Note]]:
    """Headings by the column that they are, and notes on those told by their unit or missing."""
    all_there = [_Heading(text, *split_unit(text)) for text in there]
    found: dict[str, _Heading] = {}
    notes = []
    for column, units in wanted.units.items():
        names = (plain(column), *_ALSO.get(column, ()))
        named = [each for each in all_there if plain(each.name) in names]
        for text in there:
            name, _, unit = text.rpartition("_")
            ended = _Heading(text, text, unit)
            if plain(name) in names and ended.fits(units):
                named.append(ended)
        if named:  # one that states its unit comes before a bare counter
            found[column] = min(named, key=lambda each: each.unit is None)
    first = next(iter(wanted.inputs), None)
    for column in (_TIME, wanted.reads, *wanted.inputs)[:3]:
        if column in found:
            continue
        taken = {each.text for each in found.values()}
        units = wanted.units[column]
        fit = [each for each in all_there if each.text not in taken and each.fits(units)]
        if len(fit) == 1:
            found[column] = fit[0]
            notes.append(Note("column-by-unit", f"{shown(fit[0].text)} is taken for {column}."))
        elif fit or column != first:
            _missing(column, there, wanted)
    for column in wanted.inputs:
        if column not in found and wanted.needed:
            _missing(column, there, wanted)
    for column in wanted.inputs:
        if column not in found and column in (first, *wanted.assumed):
            text = f"There is no column {column}: it is taken as 0."
            taken = {each.text for each in found.values()}
            bare = [each.text for each in all_there if not each.unit and each.text not in taken]
            if bare and column == first:
                these = " or ".join(map(shown, bare))
                unit = wanted.units[column][0]
                text += f' If {these} is the {column}, call it "{column} ({unit})".'
            notes.append(Note("no-input", text))
    return found, notes


def _bare(found: Mapping[str, _Heading], wanted: Columns) -> list[str]:
    """Columns that need a unit, and state none.

    An input may have none, and a temperature without one has the zero of the readings.
    """
    return [
        column
        for column in (_TIME, wanted.reads, *wanted.inputs)
        if column in found
        and found[column].unit is None
        and (column == wanted.reads or {"-", "K"}.isdisjoint(wanted.units[column]))
    ]


def _with_one_zero(
    values: Mapping[str, Array], found: Mapping[str, _Heading], wanted: Columns, notes: list[Note]
) -> dict[str, Array]:
    """Inputs by name; temperatures have the zero of the readings."""
    inputs = {column: values[column] for column in wanted.inputs if column in values}
    unit = found[wanted.reads].unit
    for column in inputs:
        own = found[column].unit
        temperature = "K" in wanted.units[column]
        if temperature and own and unit and zero_of(own) != zero_of(unit):
            inputs[column] = inputs[column] + (zero_of(own) - zero_of(unit))
            notes.append(Note("other-zero", f"{column} is converted from {own} to {unit}."))
    return inputs


def _missing(name: str, there: Sequence[str], wanted: Columns) -> NoReturn:
    unit = wanted.units[name][0]
    have = ", ".join(map(shown, there))
    raise ScenarioError(
        f'column "{name}" is missing; there are {have}: call one "{name} ({unit})"; '
        f"allowed are {wanted}, or the same in other units"
    )


def _whole_rows(
    table: Rows, used: Mapping[str, int], wanted: Columns, notes: list[Note]
) -> list[tuple[Line, list[str]]]:
    """Lines and cells of rows that have a time and all inputs; the last one may be cut off."""
    width, rows = len(table.header), list(table.rows)
    strict = [name for name in used if name not in (wanted.reads, _ERROR)]

    def wrong(cells: list[str]) -> str | None:
        """A column without a number, or "" of a row of another length."""
        if len(cells) != width:
            return ""
        bad = (name for name in strict if math.isnan(_READ.get(name, _number)(cells[used[name]])))
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
            date = " or a date such as 2026-05-01 12:00:00.25" if name == _TIME else ""
            write = "write it" if name == _TIME else "write the one that holds"
            raise ScenarioError(
                f"{at}, column {name} = {cell}: allowed is a finite number{date}: {write}, "
                f"or {_CUT}"
            )
    return list(rows)


def _counted_on(
    t: Array, stamps: Sequence[re.Match[str] | None], unit: str | None, notes: list[Note]
) -> Array:
    """Times, s, of dates and of clocks, which begin anew each day, counted from the first.

    Numbers are dates where they are as large. Without a unit their size tells it: ms, us and ns
    since 1970 are far beyond s.
    """
    of_clock = [stamp is not None and stamp["date"] is None for stamp in stamps]
    if all(of_clock):
        return t + _DAY * np.cumsum(np.diff(t, prepend=t[:1]) < -0.5 * _DAY)
    power = 0
    while unit is None and t[0] / 1e3**power >= LATEST and power < 3:
        power += 1
    if not _DATE <= t[0] / 1e3**power < LATEST:
        return t
    read = "" if stamps[0] else f" {('s', 'ms', 'us', 'ns')[power]} since 1970,"
    date = np.datetime64(round(t[0] / 1e3 ** (power - 1)), "ms")
    notes.append(Note("dates", f"Times are{read} counted from the first, {date}."))
    return np.asarray((t - t[0]) / 1e3**power)


def _number(cell: str) -> float:
    return number(cell, LARGEST)


_READ = {_TIME: seconds}
"""How cells are read that are no plain numbers."""


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
