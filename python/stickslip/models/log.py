"""Logs in CSV files: which of their columns a model takes, and what is wrong with their rows."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import product
from os import PathLike
from types import SimpleNamespace
from typing import Any, NamedTuple, NoReturn

import numpy as np

from stickslip._util.arrays import Array, to_si
from stickslip._util.clocks import JUMP, times
from stickslip._util.columns import Column, Source, SourceTable, describe_table, limits
from stickslip._util.messages import refuse, shown
from stickslip._util.note import Note
from stickslip._util.recipes import Entry, Match, Recipe, per_heading, refuse_twice
from stickslip._util.text import counted, plain
from stickslip._util.units import SI, Units, same_unit, split_unit, zero_of
from stickslip.diagnosis.data.columns import Heading
from stickslip.diagnosis.data.readings import unwrap
from stickslip.diagnosis.data.series import Series
from stickslip.errors import ScenarioError

_TIME, _ERROR = "t", "sd"
_ALSO = {_TIME: ("time", "timestamp", "unix", "unix time", "datetime", "clock", "date")}
"""Further names of columns."""

_CUT = "cut the log into two files there"
_REMEDY = re.compile(r'call one (?:"[^"]+"(?: or )?)+|--set [\w=,]+(?: \([^)]+\))?|--units "[^"]+"')

_ASKED = {"set", "setpoint", "sp", "target", "ref", "reference", "demand", "desired", "goal", "cmd",
          "command", "commanded", "soll"}  # fmt: skip
_READ = {"actual", "act", "measured", "meas", "feedback", "fb", "read", "ist", "sensor"}
"""Words in the names of columns that were asked for, and of those that were read."""


class Columns(NamedTuple):
    """Columns of a log that a model takes.

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
    constants : collection of str
        Inputs that a model may state as constants, and does not.
    drives : tuple of str
        Inputs of which one has to be there; the first may be known by its unit alone.
    also : dict
        What else columns are called.
    needs : dict
        Of what drives a model of which more is stated: units, and what to state.
    """

    reads: str
    unit: str
    inputs: Mapping[str, tuple[str, ...]]
    needed: bool = False
    constants: Collection[str] = ()
    drives: tuple[str, ...] = ()
    also: Mapping[str, tuple[str, ...]] = {}
    needs: Mapping[str, tuple[str, str]] = {}

    @property
    def units(self) -> dict[str, tuple[str, ...]]:
        """Units of all columns by name."""
        return {_TIME: ("s",), self.reads: (self.unit,), **self.inputs, _ERROR: (self.unit,)}

    def __str__(self) -> str:
        return ", ".join(f"{name} ({' or '.join(units).replace('-', 'no unit')})"
                         for name, units in self.units.items() if name != _ERROR)  # fmt: skip


@dataclass(frozen=True)
class LogRecipe(Recipe):
    """The recipe of a log of a model: its columns are known by their names, or by their units.

    A column is known in whatever case; ``speed_rpm`` states its unit, too. One that states its unit
    comes before a bare counter. `wanted` is what the model takes, `also_reads` are quantities that
    it could read and their units, and `units` are those that the caller states, see `read_log`.
    `wrong` says by column why it is refused.
    """

    wanted: Columns = field(kw_only=True)
    also_reads: Mapping[str, str] = field(default_factory=dict)
    units: Units = None
    wrong: dict[str, ScenarioError] = field(default_factory=dict)

    @staticmethod
    def of_model(model: Any, units: Units) -> LogRecipe:
        """The recipe of a model's logs."""
        wanted = getattr(model, "columns", None)
        if not isinstance(wanted, Columns):
            raise ScenarioError(f"model = {shown(model)}: allowed is a model of stickslip.models")
        kind = getattr(model, "kind", None)
        reads = {name: kind.states[k][1] for name, (_, k) in kind.reads.items()
                 if name != wanted.reads} if kind else {}  # fmt: skip
        entries = {name: Entry(each[0], (*_ALSO.get(name, ()), *wanted.also.get(name, ())),
                               clock=name == _TIME)
                   for name, each in wanted.units.items()}  # fmt: skip
        return LogRecipe(entries, wanted=wanted, also_reads=reads, units=units)

    def matched(self, headings: Sequence[str]) -> list[Match]:
        """The meaning of each column; one that is missing, or may be two, is `wrong`."""
        there = [Heading.of(text) for text in headings]
        with self.keep_reason("units"):
            refuse_twice([name if (name := split_unit(text)[0]) in self.entries else text
                          for text in headings])  # fmt: skip
            self._take_units(there)
        found = self.found(there)
        # Another column may have the name of one that stated its unit behind it.
        made = [Match(text, f"{text} (beside)" if text in found else text, known=False)
                for text in headings]  # fmt: skip
        for name, (k, heading) in found.items():
            si = heading.si(self.wanted.units[name])
            in_si = heading.unit is None and self.units == SI and name != _ERROR
            unit = si if in_si else heading.unit
            with self.keep_reason(name):
                per = 1.0 if unit is None else per_heading(heading.text, unit, si)
                made[k] = Match(heading.text, name, si, unit, per, clock=name == _TIME)
        return made

    @contextmanager
    def keep_reason(self, column: str) -> Iterator[None]:
        """Keep why a column is refused."""
        try:
            yield
        except ScenarioError as error:
            self.wrong.setdefault(column, error)

    def _take_units(self, there: list[Heading]) -> None:
        """Give headings the units that the caller states; a ScenarioError names a wrong one."""
        if self.units in (None, SI):
            return
        if not isinstance(self.units, Mapping):
            refuse("units", self.units, f'"{SI}", or units by column, such as {{"speed": "rpm"}}')
        for name, unit in self.units.items():
            of = [k for k, each in enumerate(there) if name in (each.text, each.name)]
            if len(of) != 1:
                have = ", ".join(shown(each.name) for each in there)
                raise ScenarioError(f"units: there is no column {shown(name)}; there are {have}")
            own = there[of[0]].unit
            if not isinstance(unit, str) or own not in (None, unit):
                refuse(f"units: {name}", unit, own or "the text of a unit, such as rad/s")
            there[of[0]] = there[of[0]]._replace(unit=unit)

    def check_units(self, table: SourceTable) -> None:
        """Refuse columns that state no unit, with the line that states it; dates do."""
        units = {each.what.heading: self.wanted.units[name][0]
                 for name, each in table.known.items() if each.what.unit is None
                 and "-" not in self.wanted.units[name] and name != _ERROR
                 and not (name == _TIME and np.isnan(each.values).all())}  # fmt: skip
        if units:
            several, heads = ("s", "") if len(units) > 1 else ("", "s")
            names, written = ", ".join(map(shown, units)), ", ".join(
                f'"{name} ({unit})"' for name, unit in units.items())  # fmt: skip
            option = ",".join(f"{name}={unit}" for name, unit in units.items())
            raise ScenarioError(
                f"{table.path}: column{several} {names} state{heads} no unit: write {written}, or "
                f'the right units, or add --units "{option}" (in Python units={units}); if all are '
                f"SI, --units {SI}"
            )

    def check(self, columns: Sequence[Match]) -> None:
        """Refuse what `matched` found wrong; no name is a slip here."""
        for error in () if self.lenient else self.wrong.values():
            raise error

    def found(self, there: Sequence[Heading]) -> dict[str, tuple[int, Heading]]:
        """Headings, and their places, by the column that they are."""
        found: dict[str, tuple[int, Heading]] = {}
        for column, units in self.wanted.units.items():
            names = (plain(column), *self.entries[column].also)
            named = [(k, each) for k, each in enumerate(there) if plain(each.name) in names]
            named += [(k, way) for k, each in enumerate(there)
                      if (way := each.find_unit(units)) and plain(way.name) in names]  # fmt: skip
            if named:
                rank = [(each.unit is None, names.index(plain(each.name))) for _, each in named]
                best = rank.index(min(rank))
                also = {named[k][0] for k, one in enumerate(rank) if one == rank[best]}
                found[column] = named[best]
                with self.keep_reason(column):
                    if len(also) > 1:
                        both = " and ".join(shown(there[k].text) for k in sorted(also)[:2])
                        raise ScenarioError(f"columns {both} may both be {column}: allowed is one")
                    self._check_meaning(column, found[column][1], there)
                    if column in self.wanted.drives and not found[column][1].fits(units):
                        self._check_needs([found[column][1]])
        inputs = self.wanted.inputs
        first, by_unit = next(iter(inputs), None), (_TIME, self.wanted.reads, *inputs)[:3]
        required = {*by_unit[:2], *self.wanted.constants, *self.wanted.drives[:1],
                    *(inputs if self.wanted.needed else ())}  # fmt: skip
        for column in (_TIME, self.wanted.reads, *inputs):
            if column in found or (column == first and found.keys() & {*self.wanted.drives}):
                continue
            taken = {k for k, _ in found.values()}
            units = self.wanted.units[column]
            ways = [each if each.unit else each.find_unit(units) or each for each in there]
            fit = [(k, each) for k, each in enumerate(ways) if column in by_unit
                   and k not in taken and each.fits(units)
                   and (column == first or not each.words & _ASKED)]  # fmt: skip
            if len(fit) == 1:
                found[column] = fit[0]
            elif fit or column in required:
                with self.keep_reason(column):
                    self._missing(column, there, taken)
        return found

    def _check_needs(self, there: Sequence[Heading]) -> None:
        """Refuse a column of what drives the model only if more is stated of it."""
        for each, (name, (units, remedy)) in product(there, self.wanted.needs.items()):
            is_called = each.unit is None and plain(each.bare).split()[-1:] == [name]
            if is_called or each.fits(units.split(" or ")):
                raise ScenarioError(f"column {shown(each.text)} is a {name}: {remedy}")

    def _check_meaning(self, column: str, found: Heading, there: Sequence[Heading]) -> None:
        """Refuse a name beside one of the same that was read: it may be what was asked for."""
        if column not in (self.wanted.reads, *self.wanted.inputs):
            return
        units = self.wanted.units[column]
        for each in (heading.find_unit(units) or heading for heading in there):
            rest = each.words - {*plain(column).split()}
            fits = each.unit is None or each.fits(units)
            if each.text != found.text and rest and rest <= _READ and each.words != rest and fits:
                call = self._call(column, (found, each))
                raise ScenarioError(
                    f"columns {shown(found.text)} and {shown(each.text)} may both be the {column}: "
                    f'call the one to be used {call}, and the other what it is, such as "{column} '
                    'setpoint"'
                )

    def _missing(self, name: str, there: Sequence[Heading], taken: Collection[int]) -> NoReturn:
        if name in self.wanted.drives:
            self._check_needs(there)
        units, have = self.wanted.units[name], ", ".join(shown(each.text) for each in there)
        free = [each for k, each in enumerate(there) if k not in taken]
        called, more = self._call(name, free), ""
        if other := self._other_reading(free) if name == self.wanted.reads else None:
            called, more = "", f'; with reads="{other}" (--set reads={other}) the model reads that'
        if name in self.wanted.inputs and not self.wanted.needed:
            more = "; where nothing acted, write a column of zeros"
        if name in self.wanted.constants:
            unit = "K if the readings are, else degC" if units[0] == "K" else units[0]
            more = f"; or state its value, as by --set {name}=VALUE ({unit})"
        raise ScenarioError(
            f'column "{name}" is missing; there are {have}{": call one " * bool(called)}{called}; '
            f"allowed are {self.wanted}, or the same in other units{more}"
        )

    def _call(self, column: str, there: Iterable[Heading]) -> str:
        """Return what to call one of some headings for a column, in the unit that it states."""
        units = self.wanted.units[column]
        ways = [each if each.unit else each.find_unit(units) or each for each in there]
        # One that states another quantity is not to be called so.
        fit = [way for way in ways if way.fits(units)] or [way for way in ways if way.is_open]
        return " or ".join(dict.fromkeys(f'"{column} ({way.written(units)})"' for way in fit))

    def _other_reading(self, there: Sequence[Heading]) -> str | None:
        """What the model could read of some columns: by a name, or else by another unit."""
        pairs = [*product(self.also_reads.items(), there)]
        named = (name for (name, unit), each in pairs if not each.words & _ASKED and (
                 {*plain(name).split()} <= each.words or
                 ("position" in each.words and unit == "rad" != self.wanted.unit)))  # fmt: skip
        of_unit = (name for (name, unit), each in pairs if unit != self.wanted.unit
                   and each.fits([unit]) and not each.words & _ASKED)  # fmt: skip
        return next(named, next(of_unit, None))

    def notes(self, table: SourceTable) -> list[Note]:
        """On columns that were told by their unit, or are missing, or are not used."""
        notes = table.many_gaps()
        for name, column in table.known.items():
            heading = Heading.of(column.what.heading)
            named = {plain(name), *self.entries[name].also}
            if named.isdisjoint({plain(heading.name), plain(heading.bare)}):
                notes.append(Note("column-by-unit", f"{shown(heading.text)} is taken for {name}."))
        others = [Heading.of(text) for text in table.others]
        first = next(iter(self.wanted.inputs), "")
        if first and not table.known.keys() & {first, *self.wanted.drives}:
            notes.append(Note("no-input", f"There is no column {first}: it is taken as 0."))
            units = self.wanted.inputs[first]
            fit = [each for each in others if each.unit is None or each.fits(units)]
            if fit:
                heads = " or ".join(shown(each.text) for each in fit)
                text = f"If {heads} is the {first}, call it {self._call(first, fit)}."
                notes.append(Note("other-name", text))
        for each in others:
            if plain(each.name) == "error":
                text = f"Column {shown(each.text)} is not used, as it may be a set point less a "
                text += f'reading: call the standard deviation of a reading "{_ERROR}".'
                notes.append(Note("error-not-used", text))
        return [*notes, *table.notes, *table.not_used()]


def explain_log(source: Source, model: Any, units: Units) -> tuple[list[str], list[str]]:
    """Describe how the columns of a log are understood, and what a model needs besides.

    The first reason of a refusal is left out where no option or heading helps.
    """
    bare = SimpleNamespace(columns=Columns("", "-", {}))
    recipe = replace(LogRecipe.of_model(model or bare, units), lenient=True)
    wanted, table = recipe.wanted, source.read(recipe)
    with recipe.keep_reason("unit"):
        recipe.check_units(table)
    means = {name: f"input: {name}" for name in wanted.inputs}
    means |= {_TIME: "time", _ERROR: "error of a reading", wanted.reads: f"reading: {wanted.reads}"}
    wrong = [str(error) for error in recipe.wrong.values()] if model else []
    needed = [", or ".join(_REMEDY.findall(text)) or text for text in wrong]
    return describe_table(table, means), [text for text in needed if text not in wrong[:1]]


def read_in(source: Source, quantities: Sequence[str]) -> str | None:
    """The first of some quantities that is a column of a log."""
    heads = [Heading.of(text) for text in source.headings(quantities)]
    return next((name for name in quantities for each in heads
                 if plain(name) in (plain(each.name), plain(each.bare))), None)  # fmt: skip


def read_log(path: str | PathLike[str] | Any, model: object, units: Units = None) -> Series:
    """A log for a model: columns of time, of what is read, and of inputs.

    A column is known by its name, in whatever case, and else by its unit, where it is the only one
    of it: the time, what is read, and the first input. Its unit is stated by the heading, as
    ``speed (rpm)`` or ``speed_rpm``, by an array that carries one, or by `units`; pure numbers need
    none. A column ``sd`` has the error of each reading, without a unit in that of the readings.
    Temperatures get the zero of the readings. Times may be dates or clocks, such as
    ``2026-05-01 12:00:00.25``. Angles and counters that begin anew are counted on. Rows without a
    reading are left out, and those whose column ``valid`` or ``ok`` has 0.

    Parameters
    ----------
    path : path, DataFrame, Dataset or mapping
        CSV, with a line of headings; or columns by heading, also with units of their own.
    model : Model or Own
        Of `stickslip.models`.
    units : dict or "si", optional
        Units of columns whose headings state none, such as ``{"speed": "deg/s"}``; ``"si"`` where
        all of these are in SI units.

    Returns
    -------
    Series
        Its notes tell what was taken for what, and what was not used.

    Raises
    ------
    ScenarioError
        If a column is not known or may be one of several, or its unit is not known or not stated;
        if a row has no time or lacks an input; or if the clock runs backwards, or jumps by more
        than 20 of its steps.
    """
    source = path if isinstance(path, Source) else Source(path)
    recipe = LogRecipe.of_model(model, units)
    wanted, table = recipe.wanted, source.read(recipe)
    notes = recipe.notes(table)
    t, told = times(table.columns[_TIME], table.path, table.lines)
    recipe.check_units(table)
    table, t = _whole_rows(table, t, wanted, notes)
    values = _readings(table, wanted, notes)
    notes += told
    _check_clock(table, t, values[wanted.reads])
    inputs, shows = _with_one_zero(values, table.known, wanted, notes)
    name = source.path.stem if source.is_file else "log"
    log = Series(t, values[wanted.reads], inputs, values.get(_ERROR), name, unit=shows)
    return log.noted(notes)


def _readings(table: SourceTable, wanted: Columns, notes: list[Note]) -> dict[str, Array]:
    """Numbers by column, NaN where a reading is not valid; what begins anew is counted on."""
    columns = table.known
    values = {name: column.values for name, column in columns.items()}
    read = columns[wanted.reads]
    if _ERROR in columns and columns[_ERROR].what.unit is None:
        # An error without a unit is in that of its readings.
        values[_ERROR] = to_si(values[_ERROR], read.what.per)
    for column in table.validity:
        lost = np.isfinite(values[wanted.reads]) & table.not_valid(column)
        values[wanted.reads] = np.where(lost, math.nan, values[wanted.reads])
        if lost.any():
            text = f"{counted(int(lost.sum()), 'reading')} left out by column "
            notes.append(Note("not-valid", f"{text}{column.what.heading}.", int(lost.sum())))
    beyond = limits(read)
    if beyond:
        text = f"{table.at(beyond)}: {shown(read.cell(beyond[0]))} is a limit and no reading."
        notes.append(Note("limits", text, len(beyond)))
    for name in values.keys() & wanted.inputs.keys():
        at = f"{columns[name].what.heading}: "
        values[name], told = unwrap(at, values[name], columns[name].what.si or "", False)
        notes += told
    return values


def _with_one_zero(
    values: dict[str, Array], known: Mapping[str, Column], wanted: Columns, notes: list[Note]
) -> tuple[dict[str, Array], str]:
    """Inputs by name, with temperatures from the zero of the readings, and the readings' unit.

    Readings in degF become ones in degC.
    """
    read = known[wanted.reads].what
    shows = read.unit if read.unit and same_unit(read.unit, wanted.unit) else wanted.unit
    if zero_of(read.unit) and not same_unit(str(read.unit), "K"):
        shows, values[wanted.reads] = "degC", values[wanted.reads] + (
            zero_of(read.unit) - zero_of("degC"))  # fmt: skip
    inputs = {name: values[name] for name in wanted.inputs if name in values}
    for name in inputs:
        own = known[name].what.unit
        if "K" in wanted.units[name] and zero_of(own) != zero_of(shows):
            inputs[name] = inputs[name] + (zero_of(own) - zero_of(shows))
            notes.append(Note("other-zero", f"{name} is converted from {own} to {shows}."))
    return inputs, shows


def _whole_rows(
    table: SourceTable, t: Array, wanted: Columns, notes: list[Note]
) -> tuple[SourceTable, Array]:
    """Rows that have a time and all inputs, with their times; the last one may be cut off."""
    columns, count = table.columns, len(table)
    strict = {_TIME: t} | {name: columns[name].values for name in wanted.inputs if name in columns}
    gap = ~np.all(np.isfinite([*strict.values()]), axis=0)
    gap[list(table.ragged)] = True
    if count > 1 and gap[-1]:
        why = f"has {table.ragged[count - 1]}" if count - 1 in table.ragged else "lacks a cell"
        text = f"{table.at([count - 1])}, the last, is left out, as it {why}."
        notes.append(Note("cut-off", text))
        table, t, gap = table.kept(range(count - 1)), t[:-1], gap[:-1]
    for k in np.flatnonzero(gap)[:1].tolist():
        at = f"{table.path}: {table.word} {table.lines[k]}"
        if k in table.ragged:
            raise ScenarioError(f"{at} has {table.ragged[k]}: allowed is the same, or {_CUT}")
        name = next(each for each, values in strict.items() if not np.isfinite(values[k]))
        cell = shown(columns[name].cell(k))
        date = " or a date such as 2026-05-01 12:00:00.25" if name == _TIME else ""
        write = "write it" if name == _TIME else "write the one that holds"
        raise ScenarioError(
            f"{at}, column {name} = {cell}: allowed is a finite number{date}: {write}, or {_CUT}"
        )
    return table, t


def _check_clock(table: SourceTable, t: Array, y: Array) -> None:
    steps = np.diff(t)
    usual = float(np.median(steps)) if len(steps) else 0.0
    event = (steps == 0.0) & ~(np.abs(np.diff(y)) > 0.0)  # two rows of one reading
    for k in np.flatnonzero(~event & (~(steps > 0.0) | (steps > JUMP * abs(usual))))[:1].tolist():
        at = f"{table.path}: {table.word} {table.lines[k + 1]}, column t = {t[k + 1]:.12g} s"
        if not steps[k] > 0.0:
            remedy = f"sort the rows, or {_CUT}" if steps[k] else "or one reading; give more digits"
            raise ScenarioError(f"{at}: allowed is a time after {t[k]:.12g} s: {remedy}")
        raise ScenarioError(
            f"{at}: the clock jumps by {steps[k]:.6g} s, and allowed are {JUMP:g} of its steps of "
            f"{usual:.3g} s: {_CUT}"
        )
