"""Readings in time."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.arrays import (
    Array,
    Indices,
    Mask,
    check_indexes,
    conversions,
    locked,
    root_mean_square,
    row,
    without_unit,
)
from stickslip._util.messages import known_arguments, refuse, shown
from stickslip._util.note import Note
from stickslip._util.units import quantity_of, with_unit
from stickslip.diagnosis.data.errors import FEWEST, Errors, freedom, of_one_meter
from stickslip.diagnosis.data.outliers import (
    FEW,
    alike_and_lost,
    far_from_all_others,
)
from stickslip.diagnosis.data.readings import AVERAGED, GAP, find_readings, scatter_about_a_curve
from stickslip.diagnosis.data.settings import Settings
from stickslip.diagnosis.data.signal import Signal
from stickslip.diagnosis.data.table import (
    Table,
    rows_in_words,
    stated_errors,
    without_gaps,
)
from stickslip.errors import ScenarioError

STRETCHES = 12
"""Stretches into which each record is cut, and parts of all readings, to be held out in turn.
Chosen: more cost more and tell little more."""

SMOOTH = "noise-smooth"
"""Code of the note on errors that the scatter about a smooth curve tells."""

LOST_SENSOR = "lost-sensor"
"""Code of the note on alike readings that are too many to be left out, a problem of the data."""

_SAME = 1e-6  # of a step: times of a repeat that are the same


@known_arguments
class Series(Table):
    """Readings in time: one record, with what was put in.

    Parameters
    ----------
    t : array_like, shape (n,)
        Time of each reading, s, increasing; steps may differ. Dates are read as s from the first.
    y : array_like, shape (n,)
        Readings. A row with a gap (masked, None, NaN) is left out, and a note says so; its inputs
        act all the same. So are up to three single readings, three spans beyond all others, and
        readings of one value far from those before and after them, as of a lost sensor, up to 5 %.
    inputs : mapping, optional
        What acts on the system, by name, each of shape (n,); one with a unit becomes SI, and a
        temperature has the zero of the readings.
    sd : float or array_like, shape (n,), optional
        Standard deviation of each reading. If not given, it is estimated: from repeats; else from
        the scatter about a smooth curve; else from what the fit of all causes leaves.
    name : str
        Of the record.
    repeat_of : str or Series, optional
        The record, or its name, that this one repeats: the same inputs at the same times.
    unit : str
        Of the readings.

    Attributes
    ----------
    t, y : ndarray, shape (n,)
    inputs : dict of ndarray
        In `predict` those that a cause acts on have the shape (vectors, n). They are values at the
        readings alone: a late input is a line between its values, which on even steps is the mean
        of a held one up to the next reading.
    input_units : dict of str
        SI units of inputs whose arrays carry one.

    Raises
    ------
    ScenarioError
        If lengths or pandas indexes differ, a time or an input is missing, a number is not finite,
        times do not increase, or an array carries a unit that is not converted.
    """

    def __init__(
        self, t: ArrayLike, y: ArrayLike, inputs: Mapping[str, ArrayLike] | None = None,
        sd: ArrayLike | None = None, name: str = "", repeat_of: str | Series | None = None, *,
        unit: str = "-",
    ) -> None:  # fmt: skip
        self.name, self.unit = str(name), unit
        self.repeat_of = repeat_of.name if isinstance(repeat_of, Series) else repeat_of
        if inputs is not None and not isinstance(inputs, Mapping):
            refuse(f"{self.at}inputs", inputs, 'a table of rows, such as {"torque": [...]}')
        given = {str(key): values for key, values in (inputs or {}).items()}
        check_indexes(self.at, {"t": t, "y": y, "sd": sd, **given})
        times = row(f"{self.at}t", t, unit="s")
        count = len(times)
        notes: list[Note] = []
        readings = row(f"{self.at}y", y, count, unit=unit, gaps=True).copy()
        times, events = _before_events(self.at, times, readings)
        units = {key: _unit_of_input(values, unit) for key, values in given.items()}
        acting = {key: row(f"{self.at}inputs {key}", values, count, unit=units[key])
                  for key, values in given.items()}  # fmt: skip
        self.input_units = {key: each for key, each in units.items() if each is not None}
        own = {key: (values, units[key]) for key, values in given.items()}
        notes += conversions(self.at, {"t": (t, "s"), "y": (y, unit), "sd": (sd, unit), **own})
        stated = None if sd is None else stated_errors(f"{self.at}sd", sd, count, unit)
        gap = np.isnan(readings) | np.isnan(0.0 if stated is None else stated)
        self.own_notes = (*notes, *without_gaps(self.at, gap))
        gap[events] = True
        sound = np.flatnonzero(~gap)
        acted = [values[sound] for values in acting.values()]
        for lost in alike_and_lost(readings[sound], acted):
            self.own_notes += (_lost(self.at, readings, sound[lost]),)
            if self.own_notes[-1].code != LOST_SENSOR:
                gap[sound[lost]] = True
        for k in np.flatnonzero(~gap)[far_from_all_others(readings[~gap])].tolist():
            text = f"{self.at}row {k}: {readings[k]:g} is far from all others, and left out."
            self.own_notes += (Note("wild-reading", text, float(readings[k])),)
            gap[k] = True
        sound = np.flatnonzero(~gap)
        acted = [values[sound] for values in acting.values()]
        if LOST_SENSOR not in {note.code for note in self.own_notes}:
            found = find_readings(self.at, times[sound], readings[sound], unit, acted)
            readings[sound], self.own_notes = found.y, (*self.own_notes, *found.notes)
            gap[sound[~found.kept]] = True
            self.window = range(1 - found.averaged, 1)
        if gap.any():
            read = np.interp(times, times[~gap], readings[~gap])
            self._take(times, read, acting, np.ones(count), np.ones(count, dtype=bool))
            whole = self.having(stated=True, rows=np.arange(count), own_notes=())
            self._take_of(whole, np.flatnonzero(~gap))
        self.stated = stated is not None
        self.rows = np.flatnonzero(~gap)
        self._take(times, readings, acting, stated, ~gap)

    def _take(
        self, t: Array, y: Array, inputs: Mapping[str, Array], sd: Array | None, kept: Mask
    ) -> None:
        """Let these rows be the record; without an `sd` its errors are estimated from them."""
        vars(self).pop("named_settings", None)  # of other rows
        self.t, self.y = locked(t[kept]), locked(y[kept])
        self.inputs = {key: locked(values[kept]) for key, values in inputs.items()}
        self.signals: Mapping[str, Callable[[bool], Signal]] = {}
        count = len(self.t)
        self.settings = {"t": self.t, **self.inputs}
        self.condition = self.first = np.arange(count)
        self.mean = self.y
        self.run, self.order = np.zeros(count, dtype=np.int64), np.arange(count, dtype=float)
        self.group = np.arange(count) * min(STRETCHES, count) // count
        if sd is None:
            self.errors = _about_a_curve(self.t, self.y, self.unit)
        else:
            self.errors = Errors(sd[kept], sizes={"s0": root_mean_square(sd[kept]), "rho": 0.0})

    @property
    def at(self) -> str:
        """The start of messages."""
        return f"series {self.name}: " if self.name else "series: "

    def __getitem__(self, column: str) -> Array:
        """Times, as ``t``, or an input."""
        if column == "t":
            return self.t
        if column not in self.inputs:
            known = ", ".join(map(shown, ["t", *self.inputs]))
            raise ScenarioError(
                f"{self.at}there is no input {shown(column)}; there are {known}, by name"
            )
        return self.inputs[column]

    def __repr__(self) -> str:
        return f"<Series {self.name}: {len(self.y)} readings in {np.ptp(self.t):g} s>"

    @functools.cached_property
    def named_settings(self) -> Settings:
        """The time alone, as the inputs follow."""
        return Settings({"t": (self.t.tolist(), "s")}, len(self.t))

    @property
    def step(self) -> float:
        """Usual time between two readings, s."""
        return float(np.median(np.diff(self.t))) if len(self.t) > 1 else 1.0

    def named(self, name: str) -> Series:
        """The same record under a name."""
        whole = self.whole.named(name) if isinstance(self.whole, Series) else self.whole
        return self.having(name=name, whole=whole)

    def noted(self, notes: Sequence[Note]) -> Series:
        """The same with notes on how it was read."""
        return self.having(own_notes=(*notes, *self.own_notes))

    def without(self, gone: Mask, why: str) -> Series:
        """The same without some readings, and a note on their rows that ends with `why`."""
        made = self.having()
        sd = self.errors.sd if self.stated else None
        made._take(self.t, self.y, self.inputs, sd, ~gone)
        return made._less(self, ~gone, why)

    def first_readings(self, count: int) -> Series:
        """The beginning of the record, with its errors as they are."""
        kept, made = np.arange(len(self)) < count, self.having()
        made._take(self.t, self.y, self.inputs, self.errors.sd, kept)
        return made.having(errors=replace(self.errors, sd=self.errors.sd[kept]))

    def windows(self) -> list[Series]:
        """The same where a mean of rows is of the last, of those about a reading, or of errors."""
        count = len(self.window)
        each = {
            "each reading is the mean of the last {} rows": range(1 - count, 1),
            "each reading is the mean of {} rows about it":
                range(-((count - 1) // 2), count // 2 + 1),
            "errors of {} rows in a row are alike": range(1),
        }  # fmt: skip
        made = []
        for text, window in each.items() if count > 1 else ():
            note = Note(AVERAGED, f"{self.at}{text.format(count)}: one of {count} counts.", count)
            others = [each for each in self.own_notes if each.code != AVERAGED]
            made.append(self.having(window=window, own_notes=(*others, note)))
        return made or [self]

    def pieces(self) -> list[Series]:
        """Parts between gaps in which an input changed, as nothing says when it did."""
        base = self.whole if isinstance(self.whole, Series) else self
        if self.repeat_of is not None or not base.inputs:
            return [self]
        changed = np.any([np.diff(row) != 0.0 for row in base.inputs.values()], axis=0)
        gaps = np.flatnonzero(changed & (np.diff(base.t) > GAP * base.step)) + 1
        cuts = itertools.pairwise((0, *gaps.tolist(), len(base)))
        return [part for part in itertools.starmap(self._part, cuts) if len(part)]

    def _part(self, begin: int, end: int) -> Series:
        """The rows of the whole record from one to another."""
        base = self.whole if isinstance(self.whole, Series) else self
        row, kept = np.arange(len(base)), np.arange(len(self)) if self.whole is None else self.kept
        here, there = ((each >= begin) & (each < end) for each in (kept, row))
        part = self.having(rows=self.rows[here], kept=kept[here] - begin)
        part._take(self.t, self.y, self.inputs, self.errors.sd if self.stated else None, here)
        if base is not self:
            part.whole = base.having(rows=row[there])
            part.whole._take(base.t, base.y, base.inputs, base.errors.sd, there)
        if begin:
            before, after = base.t[begin - 1 : begin + 1].tolist()
            text = f"{self.at}no row is between {before:.6g} and {after:.6g} s, where an input "
            text += "changed: readings behind this gap start anew."
            part = part.having(own_notes=(Note("gap", text, after - before),))
            part = part.named(f"{self.name or 'log'} from {after:.6g} s")
        return part

    def signal(self, name: str, held: bool) -> Signal:
        """An input as it acts, where it is held between readings or else a line."""
        if name in self.signals:
            return self.signals[name](held)
        return Signal.of(self.t, np.atleast_2d(self[name]), held)

    def acted_on(self, signals: Mapping[str, Callable[[bool], Signal]]) -> Series:
        """The same with inputs as causes let them act, see `signal`."""
        seen = {name: made(False).sampled() for name, made in signals.items()}
        return self.with_inputs(seen).having(signals=signals)

    def with_inputs(self, inputs: Mapping[str, Array]) -> Series:
        """The same record with other inputs, of shape (n,) or (vectors, n)."""
        acting = {key: locked(values) for key, values in inputs.items()}
        return self.having(inputs={**self.inputs, **acting}, signals={})


def _before_events(at: str, t: Array, y: Array) -> tuple[Array, Indices]:
    """Times that increase, and the first of two rows each that a log has of an event.

    These have one time and one reading; the first one's inputs act until then.
    """
    late = np.flatnonzero(np.diff(t) <= 0.0)
    differs = np.abs(y[late + 1] - y[late]) > 0.0  # a gap does not
    again = np.append(False, np.diff(late) == 1)
    for k in late[(t[late + 1] < t[late]) | differs | again][:1].tolist():
        same = ", or the same reading at an event" if t[k + 1] == t[k] else ""
        refuse(f"{at}t: row {k + 1}", float(t[k + 1]), f"a time after {float(t[k])!r}{same}")
    before = t.copy()
    before[late] -= _SAME * float(np.median(np.diff(t)[np.diff(t) > 0.0])) if len(late) else 0.0
    return before, late


def _unit_of_input(values: ArrayLike, unit: str) -> str | None:
    """The unit that an input is taken in: SI, or of temperatures that of the readings."""
    carried = without_unit(values)[1]
    if carried is None:
        return None
    si = quantity_of(carried)
    return unit if si == "K" == quantity_of(unit) else si or carried


def _lost(at: str, readings: Array, rows: Indices) -> Note:
    """A note on alike readings of a lost sensor, which are left out if they are few."""
    few = len(rows) <= FEW * len(readings)
    code, end = ("lost-readings", ", and left out.") if few else (LOST_SENSOR, ".")
    text = f"{at}{rows_in_words(rows)}: {len(rows)} of {len(readings)} readings are "
    text += f"{readings[rows[0]]:g}, far from those before and after them{end}"
    return Note(code, text, len(rows))


def with_repeats(series: Sequence[Series]) -> list[Table]:
    """Records whose repeats tell the error of a reading, where it was not stated.

    A ScenarioError is raised if a record repeats none of the others, or was read at other times or
    with other inputs.
    """
    first = {record.name: record for record in series}
    groups: dict[str, list[Series]] = {}
    for record in series:
        if record.repeat_of is None:
            continue
        of = first.get(record.repeat_of)
        if of is None or of is record:
            names = ", ".join(name for name in first if name != record.name) or "no other record"
            refuse(f"series {record.name}: repeat_of", record.repeat_of, names)
        _check_repeat(of, record)
        groups.setdefault(of.name, [of]).append(record)
    known: dict[str, Table] = {}
    for group in groups.values():
        errors = _from_repeats(group)
        for record in group:
            if not record.stated and errors.dof >= FEWEST:
                sd = np.full(len(record), errors.sizes["s0"])
                known[record.name] = record.having(errors=replace(errors, sd=sd))
    return _of_one_meter([known.get(record.name, record) for record in series])


def _of_one_meter(records: list[Table]) -> list[Table]:
    """Records whose errors smooth curves tell, where those of one unit share them."""
    told = [k for k, record in enumerate(records)
            if SMOOTH in {note.code for note in record.errors.notes}]  # fmt: skip
    dof = np.array([records[k].errors.dof for k in told])
    sd = np.array([records[k].errors.sizes["s0"] for k in told])
    shared = of_one_meter([records[k].unit for k in told], sd, dof, dof)
    for k, one, free in zip(told, *shared, strict=True):
        record = records[k]
        records[k] = record.having(errors=_of_a_curve(one, len(record), free, record.unit))
    return records


def _check_repeat(of: Series, repeat: Series) -> None:
    rows, (first, other) = _common_rows([of, repeat])
    at = f"series {repeat.name}: repeat_of = {of.name}: "
    apart = np.flatnonzero(np.abs(of.t[first] - repeat.t[other]) > _SAME * of.step)
    if len(apart):
        k = int(apart[0])
        time, same = repeat.t[other[k]], of.t[first[k]]
        text = f"row {rows[k]}: t = {time:g}: allowed is the same time, {same:g}"
        raise ScenarioError(at + text)
    for key, values in of.inputs.items():
        if key not in repeat.inputs:
            raise ScenarioError(f"{at}allowed is a record with the same inputs; {key} is missing")
        size = root_mean_square(values) or 1.0
        repeated = repeat.inputs[key][other]
        apart = np.flatnonzero(np.abs(values[first] - repeated) > 0.1 * size)
        if len(apart):
            k = int(apart[0])
            text = f"row {rows[k]}: {key} = {repeated[k]:g}: allowed is the same input"
            raise ScenarioError(f"{at}{text}, {values[first[k]]:g}")


def _common_rows(group: Sequence[Series]) -> tuple[Indices, list[Indices]]:
    """Rows, as they were given, that all records still have, and their places in each."""
    rows = functools.reduce(np.intersect1d, [record.rows for record in group])
    return rows, [np.searchsorted(record.rows, rows) for record in group]


def _from_repeats(group: Sequence[Series]) -> Errors:
    """Error of a reading from the scatter of repeats, with what its correlation leaves of them."""
    common, places = _common_rows(group)
    count = len(common)
    rows = np.array([record.y[at] for record, at in zip(group, places, strict=True)])
    away = rows - rows.mean(axis=0)
    sd = math.sqrt(float(np.sum(away**2)) / max(count * (len(group) - 1), 1))
    dof = (len(group) - 1) * freedom(away[0]) if sd else 0.0
    size = with_unit(sd, group[0].unit)
    text = f"A reading scatters by {size}, from {len(group)} repeats of a record."
    note = Note("noise-repeats", text, sd)
    return Errors.alike(sd, np.ones(count), dof, note)


def _about_a_curve(t: Array, y: Array, unit: str) -> Errors:
    """Errors of readings about a smooth curve, where there is one; else of no known size."""
    sd = scatter_about_a_curve(t, y)
    if not sd:
        return Errors.alike(float(np.std(y)) or 1.0, np.ones(len(y)), 0.0)
    # A median of n differences of order 5, which overlap, tells as much as n / 8 free readings.
    return _of_a_curve(sd, len(y), len(y) / 8.0, unit)


def _of_a_curve(sd: float, count: int, dof: float, unit: str) -> Errors:
    note = Note(SMOOTH, f"A reading scatters by {with_unit(sd, unit)} about a smooth curve.", sd)
    return Errors.alike(sd, np.ones(count), dof, note)
