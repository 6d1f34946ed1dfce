"""Errors of instruments, as causes beside the physics.

Each public function makes a `stickslip.Cause` with a `read`, which the diagnosis applies to
predictions, one after another in the order of the causes::

    meters = [instruments.scale(), instruments.offset("m/s", 1e-3)]
    diagnose_model(physics, data, uncertain, [*causes, *meters])

They share these parameters:

size : float
    Usual size of the error, above 0. Errors of up to 30 times it are searched.
rows : array_like or slice
    Rows that are read, of those without a gap: indices, or a mask of shape (m,).
table : str
    Name of the table that is read; all tables, if not given.
name : str
    Of the cause; its parameters are ``<name>.<word>``.

Each raises a ScenarioError if a value is not allowed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from stickslip._util.arrays import Array, Indices, check_indexes, distinct_rows, labels, row
from stickslip._util.messages import refuse
from stickslip._util.prior import Prior
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.signal import Signal
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import LARGEST_ERROR, Parameter, either_way
from stickslip.errors import ScenarioError

Rows = ArrayLike | slice

_EVERY = slice(None)


def scale(
    size: float = 0.02, *, rows: Rows = _EVERY, table: str | None = None, name: str = "scale"
) -> Cause:
    """A wrong calibration: readings are (1 + ``error``) times what they should be.

    Errors of up to a half are searched.
    """
    parameter = Parameter(f"{name}.error", low=-0.5, high=0.5, size=size)
    read = partial(_by_value, _scaled, rows, parameter.name)
    return Cause(name, (parameter,), "a wrong scale of the readings", read=read, table=table)


def _by_value(
    change: Callable[[Array, Array], Array], rows: Rows, name: str, readings: Array, _: Array,
    p: dict[str, Array], table: Table,
) -> Array:  # fmt: skip
    """Readings whose rows a parameter, of shape (vectors, 1), has changed."""
    return _changed(readings, rows, change(_some(readings, rows), p[name]))


def _scaled(some: Array, error: Array) -> Array:
    return some * (1.0 + error)


def offset(
    unit: str, size: float, *, rows: Rows = _EVERY, table: str | None = None, name: str = "offset"
) -> Cause:
    """A wrong zero: a ``shift`` in `unit`, that of the readings, is added to all of them.

    A sensor that was turned is ``offset("rad", 0.03)``.
    """
    parameter = either_way(f"{name}.shift", unit, size)
    read = partial(_by_value, np.add, rows, parameter.name)
    return Cause(name, (parameter,), "a wrong zero of the readings", read=read, table=table)


def clipping(
    unit: str, highest: float, size: float, *, lowest: float | None = None, rows: Rows = _EVERY,
    table: str | None = None, name: str = "clipping",
) -> Cause:  # fmt: skip
    """A reading that saturates: beyond a ``limit``, on either side of zero, the limit is read.

    The limit is in `unit`, that of the readings; 0 is no limit.

    Parameters
    ----------
    highest : float
        Magnitude at which a limit begins to act, in the unit. A good choice is somewhat above the
        largest reading.
    size : float
        Usual distance of the limit below `highest`, above 0, in the unit.
    lowest : float, optional
        Lowest limit that is searched, in the unit; a tenth of `highest`, if not given.
    """
    low = 0.1 * highest if lowest is None else lowest
    parameter = Parameter(f"{name}.limit", unit=unit, low=low, high=highest, size=size, falls=True)
    read = partial(_by_value, _clipped, rows, parameter.name)
    return Cause(name, (parameter,), "a limit at which readings saturate", read=read, table=table)


def _clipped(some: Array, limit: Array) -> Array:
    limit = np.where(limit > 0.0, limit, np.inf)
    return np.clip(some, -limit, limit)


def lag(
    size: float, *, input: str | None = None, table: str | None = None, name: str = "lag"
) -> Cause:
    """A first-order lag, with a ``time`` constant in s, of an input or of readings in time.

    Between readings it takes the value as linear, and an input as a ready-made model does: as held,
    or with ``smooth=True`` as linear. Nobody knows what was before a record, so each has a start of
    its own: by ``before`` the first value is off, as a part of the largest value of an input (-1:
    it begins with the record), or of the largest distance of readings from those after a rest.
    """
    time = Parameter(f"{name}.time", unit="s", low=0.0, high=LARGEST_ERROR * size, size=size)
    # The parts are of one scale each: in a linear machine the two lags read the same, and one with
    # a narrower start, or with none, would get the name of the other.
    prior = Prior("normal", 0.0, 1.0)
    start = Parameter(f"{name}.before", prior, low=-2.0, high=2.0, cause=False, each_record=True)
    what = f"a lag of {input or 'the readings'}"
    if input is None:
        return Cause(name, (time, start), what, read=partial(_lagged, name), table=table)
    acts = partial(_acting, _slow, name)
    return Cause(name, (time, start), what, table=table, input=input, acts=acts)


def _lagged(name: str, values: Array, _: Array, p: dict[str, Array], table: Table) -> Array:
    t, time = _in_time(table, name).t, p[f"{name}.time"]
    rest = Signal.of(t, values, held=False).lagged(time[:, 0], values[:, 0]).values
    largest = np.nan_to_num(np.abs(rest - values)).max(axis=1, keepdims=True)
    fades = np.exp((t[0] - t) / np.where(time > 0.0, time, 1.0))
    return np.asarray(rest + p[f"{name}.before"] * largest * fades)


def _slow(signal: Signal, time: Array, before: Array) -> Signal:
    return signal.lagged(time, signal.values[:, 0] + before * np.abs(signal.values).max(axis=1))


def _acting(
    change: Callable[[Signal, Array, Array], Signal], name: str, signal: Signal,
    p: dict[str, Array],
) -> Signal:  # fmt: skip
    return change(signal, p[f"{name}.time"][:, 0], p[f"{name}.before"][:, 0])


def delay(
    times: ArrayLike | None = None, size: float | None = None, *, curve: ArrayLike | None = None,
    input: str | None = None, rows: Rows = _EVERY, table: str | None = None, name: str = "delay",
) -> Cause:  # fmt: skip
    """A clock that is late or early: at time t the value of t - ``time``, s, is read.

    Between the given times the value is a cubic spline of the prediction, so the times have to be
    dense enough to follow it; a spline does not follow a jump. Beyond the times it is constant.

    In a ready-made model a held input switches later, and with ``smooth=True`` its lines bend
    later, between two readings too. In a model of one's own inputs are values at the readings, with
    lines between them. On even steps these are the means of a held input up to the next reading:
    its momentum is right, and the instant is not. Before its times it was the part ``before`` of
    its first value.

    Parameters
    ----------
    times : array_like, shape (rows,), optional
        Time of each reading, s; those of a `stickslip.Series` are known.
    curve : array_like of int, shape (rows,), optional
        Curve of each reading; one for all, if not given. A curve has two or more different times.
    input : str, optional
        Name of the input that acts late, all of it at the times of its record; the readings, if
        not given.
    """
    if size is None:
        refuse("size", size, "a number above 0")
    parameter = either_way(f"{name}.time", "s", size)
    what = f"a delay of {input or 'the readings'}"
    if input is not None:
        if times is not None or curve is not None or not isinstance(rows, slice):
            raise ScenarioError("times, curve, rows: allowed is none of them with an input")
        acts, told = partial(_acting, Signal.delayed, name), partial(_late_in_words, input)
        prior = Prior("normal", 0.5, 0.5)
        first = Parameter(f"{name}.before", prior, low=0.0, high=1.0, cause=False)
        return Cause(name, (parameter, first), what, table=table, input=input, acts=acts, told=told)
    at, curves = None, [np.arange(0)]
    if times is not None:
        check_indexes("", {"times": times, "curve": curve})
        at = row("times", times, unit="s")
        of = np.zeros(len(at), dtype=int) if curve is None else labels("curve", curve, len(at))
        curves = [np.flatnonzero(of == label) for label in np.unique(of)]
        curves = [rows_of[np.argsort(at[rows_of], kind="stable")] for rows_of in curves]
        if any(len(rows_of) < 2 or not np.all(np.diff(at[rows_of]) > 0.0) for rows_of in curves):
            raise ScenarioError("times: allowed are two or more of each curve, all different")
    read = partial(_late, name, at, curves, slice(None) if at is None else rows)
    return Cause(name, (parameter,), what, read=read, table=table)


def _late_in_words(input: str, time: float, amount: str, step: float) -> str:
    """A sentence on an input that acts late, by less than nothing or less than a step too."""
    text = f"{input[:1].upper()}{input[1:]} acts {amount} {'after' if time > 0.0 else 'before'} "
    if time > step:
        return f"{text}the log says."
    if time < -step:
        return f"{text}the log says: do their clocks agree?"
    asked = "draw a line through a held input" if time > 0.0 else "hold a sampled input"
    return f"{text}the log says, within a step of it: do you {asked}?"


def _late(
    name: str, at: Array | None, curves: Sequence[Indices], rows: Rows,
    values: Array, _: Array, p: dict[str, Array], table: Table,
) -> Array:  # fmt: skip
    if at is None:
        at = _in_time(table, name).t
        curves = [np.arange(len(at))]
    some, delays = _some(values, rows), p[f"{name}.time"][:, 0]
    _fitting(at, some)
    result = some.copy()
    # A row that was not computed stays so, and a delay of zero leaves the very numbers.
    late = np.flatnonzero((delays != 0.0) & np.all(np.isfinite(some), axis=1))
    for rows_of in curves if len(late) else ():
        mine, t = np.ix_(late, rows_of), at[rows_of]
        when = np.clip(t - delays[late, None], t[0], t[-1])
        piece = np.clip(np.searchsorted(t, when, side="right") - 1, 0, len(t) - 2)
        pieces = np.take_along_axis(CubicSpline(t, some[mine], axis=1).c, piece.T[None], axis=1)
        result[mine] = np.polyval(pieces, (when - t[piece]).T).T
    return _changed(values, rows, result)


def _in_time(table: Table, name: str) -> Series:
    if not isinstance(table, Series):
        raise ScenarioError(f"cause {name}: table {table.name} has no times; allowed is a Series")
    return table


def marker_place(
    x: Rows | None, z: Rows | None, size: float, *, theta: Rows | None = None,
    angle: ArrayLike | None = None, largest: float | None = None, table: str | None = None,
    name: str = "marker_place",
) -> Cause:  # fmt: skip
    """The tracked point lies off the point that the model moves, fixed in the body.

    It is where `marker` says, ``along`` and ``across`` the body, m.

    Parameters
    ----------
    x, z : array_like or slice
        Rows of the point's places, m: indices, or masks of shape (m,), of the same number in the
        same order. None for one that was not measured.
    theta : array_like or slice, optional
        Rows of the predicted angles that belong to them, rad.
    angle : array_like, shape (number of rows,), optional
        The angles themselves, rad, where they are known and not predicted.
    largest : float, optional
        Largest distance that is searched, to all sides, m; 30 times `size`, if not given.
    """
    if (theta is None) == (angle is None):
        raise ScenarioError("theta, angle: allowed is one of them")
    known = np.empty(0) if angle is None else row("angle", angle, unit="rad")
    words = "along", "across"
    parameters = tuple(either_way(f"{name}.{word}", "m", size, largest) for word in words)
    read = partial(_marked, name, (x, z), theta, known)
    meaning = "another place of the tracked point on the body"
    return Cause(name, parameters, meaning, read=read, table=table)


def _marked(
    name: str, places: Sequence[Rows | None], theta: Rows | None, known: Array,
    readings: Array, predicted: Array, p: dict[str, Array], _: Table,
) -> Array:  # fmt: skip
    turned = _some(predicted, theta) if theta is not None else known
    shifts = marker(turned, p[f"{name}.along"], p[f"{name}.across"])
    for rows, shift in zip(places, shifts, strict=True):
        if rows is not None:
            some = _some(readings, rows)
            readings = _changed(readings, rows, some + _fitting(shift, some))
    return readings


def marker(theta: Array, along: ArrayLike, across: ArrayLike) -> tuple[Array, Array]:
    """Distance of a point fixed in the body from its centre at a pitch, rad, in x and in z, m.

    It is (a cos(theta) + b sin(theta), b cos(theta) - a sin(theta)) with a `along` and b `across`
    the body: nose-up is negative. For angles that grow counter-clockwise in (x, z) change the sign.
    """
    a, b = np.asarray(along, dtype=float), np.asarray(across, dtype=float)
    return a * np.cos(theta) + b * np.sin(theta), b * np.cos(theta) - a * np.sin(theta)


def _some(readings: Array, rows: Rows) -> Array:
    """Readings at some rows, shape (vectors, number of rows)."""
    try:
        return np.asarray(readings[:, rows if isinstance(rows, slice) else np.asarray(rows)])
    except IndexError:
        refuse("rows", rows, f"indices or a mask of {readings.shape[1]} rows")


def _changed(readings: Array, rows: Rows, values: Array) -> Array:
    """A copy with new values at some rows."""
    result = readings.copy()
    result[:, rows if isinstance(rows, slice) else np.asarray(rows)] = values
    return result


def _fitting(given: Array, some: Array) -> Array:
    """Values for some rows, if there is one for each."""
    if given.shape[-1] != some.shape[1]:
        text = f"{given.shape[-1]} times or angles were given for {some.shape[1]} rows"
        raise ScenarioError(f"instruments: {text}; allowed is one for each")
    return given


def read_by(
    causes: Sequence[Cause], names: Sequence[str], values: Array,
    physics: Callable[[Sequence[str], Array], Array], table: Table,
) -> Array:  # fmt: skip
    """Readings of instruments, shape (vectors, k).

    Vectors that differ in the instruments alone share a prediction. Of the `causes` those with a
    `read` act one after another, if `names`, those of the columns of `values`, shape (vectors,
    names), have their parameters. ``physics(names, values)`` is what a perfect instrument reads.
    """
    acting = [cause for cause in causes if cause.read and cause.parameters[0].name in names]
    if not acting:
        return physics(names, values)
    parameters = {parameter.name for cause in acting for parameter in cause.parameters}
    kept = [k for k, name in enumerate(names) if name not in parameters]
    vectors, which = distinct_rows(values[:, kept])
    predicted = physics([names[k] for k in kept], vectors)[which]
    p = {name: values[:, [names.index(name)]] for name in parameters}
    readings = predicted
    for cause in acting:
        assert cause.read is not None
        readings = cause.read(readings, predicted, p, table)
    return readings
