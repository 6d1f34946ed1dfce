"""What an instrument does to its readings, as suspects beside the physics of one's own model.

Each function here makes an `Instrument`, which is a cause. `with_instruments` lets the instruments
read what a model predicts::

    meters = [instruments.scale(), instruments.offset("m/s", 1e-3)]
    predict = instruments.with_instruments(physics, meters)
    diagnose_model(predict, conditions, observed, uncertain, [*causes, *meters], sd=sd)

The simulator itself has `length_scale`, `clock_scale` and `angle_offset` among its named effects.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from stickslip.diagnosis.model.free_terms import Curves, predicted_once
from stickslip.diagnosis.model.problem import Array, Cause, CauseParameter, Predict
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import refuse

Read = Callable[[Array, Array, Array], Array]
_EVERY = slice(None)
_LARGEST = 30.0  # error that is searched, in sizes that would not surprise; chosen: far out


@dataclass(frozen=True)
class Instrument(Cause):
    """A cause that changes how observables are read, and nothing else.

    Attributes
    ----------
    read : callable
        ``read(reading, predicted, values)`` takes the readings so far and the observables of the
        physics, both of shape (vectors, m), and the values of `parameters`, shape (vectors,
        parameters); it returns the new readings.
    """

    read: Read = lambda reading, predicted, values: reading


def with_instruments(predict: Predict, instruments: Sequence[Instrument]) -> Predict:
    """A model whose observables are read by instruments.

    Parameters
    ----------
    predict : callable
        As for `diagnose_model`, with curves or without, of the physics alone.
    instruments : sequence of Instrument
        The first one reads what `predict` returns, each further one what the one before it has
        read. Rows that are given hold for the measured conditions and for no others.

    Returns
    -------
    callable
        The same with the parameters of the instruments, in their order, as its last columns. So the
        instruments stand last in the list of causes, in the same order.

    Raises
    ------
    ScenarioError
        If something else than an `Instrument` is given.
    """
    if not isinstance(instruments, Sequence):
        raise ScenarioError("instruments: allowed is a list of what instruments.offset(...) makes")
    for each in instruments:
        if not isinstance(each, Instrument):
            raise ScenarioError(f"instruments: {each!r} is none; instruments.offset(...) makes one")
    return ReadModel(predict, tuple(instruments))


@dataclass(frozen=True)
class ReadModel:
    """What `with_instruments` returns: a model, and the instruments that read it."""

    predict: Predict
    instruments: tuple[Instrument, ...]

    def __call__(self, conditions: Any, parameters: Array, *curves: Curves) -> Array:
        """Readings, shape (vectors, m)."""
        own = parameters.shape[1] - sum(len(each.parameters) for each in self.instruments)
        # Derivatives by an instrument's parameter share the physics.
        predicted = predicted_once(self.predict, conditions, parameters[:, :own], *curves)
        reading = predicted
        for each in self.instruments:
            values = parameters[:, own : own + len(each.parameters)]
            reading = each.read(reading, predicted, values)
            own += len(each.parameters)
        return reading


def scale(
    size: float = 0.02,
    *,
    largest: float = 0.5,
    rows: ArrayLike | slice = _EVERY,
    name: str = "scale",
) -> Instrument:
    """A wrong calibration: readings are (1 + error) times the observable.

    Parameters
    ----------
    size : float
        Relative error that would not surprise, above 0.
    largest : float
        Largest relative error that is searched, to both sides.
    rows : array_like or slice
        Observables that the instrument reads: indices, or a mask of shape (m,).
    name : str
        Of the cause; its parameter is ``<name>.error``, without unit.
    """
    parameter = CauseParameter(f"{name}.error", "-", -largest, largest, size)

    def read(reading: Array, _: Array, values: Array) -> Array:
        return _changed(reading, rows, _some(reading, rows) * (1.0 + values[:, :1]))

    return Instrument(name, (parameter,), "readings have a wrong scale", read=read)


def offset(
    unit: str,
    size: float,
    *,
    largest: float | None = None,
    rows: ArrayLike | slice = _EVERY,
    name: str = "offset",
) -> Instrument:
    """A wrong zero: the same is added to all readings.

    Parameters
    ----------
    unit : str
        Of the observables that it reads.
    size : float
        What would not surprise, above 0, in the unit.
    largest : float, optional
        What is searched, to both sides, in the unit; 30 times the size, if not given.
    rows : array_like or slice
        Observables that the instrument reads: indices, or a mask of shape (m,).
    name : str
        Of the cause; its parameter is ``<name>.shift``, in the unit.
    """
    end = _LARGEST * size if largest is None else largest
    parameter = CauseParameter(f"{name}.shift", unit, -end, end, size)

    def read(reading: Array, _: Array, values: Array) -> Array:
        return _changed(reading, rows, _some(reading, rows) + values[:, :1])

    return Instrument(name, (parameter,), "readings have a wrong zero", read=read)


def angle_offset(
    size: float = 0.03,
    *,
    largest: float = 0.5,
    rows: ArrayLike | slice = _EVERY,
    name: str = "angle_offset",
) -> Instrument:
    """A turned camera or marker: the same angle is added to all angles.

    Parameters
    ----------
    size : float
        Angle that would not surprise, above 0, rad.
    largest : float
        Largest angle that is searched, to both sides, rad.
    rows : array_like or slice
        The angles, rad, among the observables: indices, or a mask of shape (m,).
    name : str
        Of the cause; its parameter is ``<name>.shift``, rad.
    """
    return offset("rad", size, largest=largest, rows=rows, name=name)


def clipping(
    unit: str,
    highest: float,
    size: float,
    *,
    lowest: float | None = None,
    rows: ArrayLike | slice = _EVERY,
    name: str = "clipping",
) -> Instrument:
    """A reading that saturates: beyond a limit, on either side of zero, the limit is read.

    Parameters
    ----------
    unit : str
        Of the observables that it reads.
    highest : float
        Magnitude above all that can be expected without a limit, in the unit: there the limit
        begins to act. A good choice is some more than the largest reading.
    size : float
        How far below `highest` a limit would not surprise, above 0, in the unit.
    lowest : float, optional
        Lowest limit that is searched, in the unit; a tenth of `highest`, if not given.
    rows : array_like or slice
        Observables that the instrument reads: indices, or a mask of shape (m,).
    name : str
        Of the cause; its parameter is ``<name>.limit``, in the unit; 0 is no limit.
    """
    low = 0.1 * highest if lowest is None else lowest
    parameter = CauseParameter(f"{name}.limit", unit, low, highest, size, downward=True)

    def read(reading: Array, _: Array, values: Array) -> Array:
        limit = np.where(values[:, :1] > 0.0, values[:, :1], np.inf)
        return _changed(reading, rows, np.clip(_some(reading, rows), -limit, limit))

    return Instrument(name, (parameter,), "readings saturate at a limit", read=read)


def delay(
    times: ArrayLike,
    size: float,
    *,
    largest: float | None = None,
    curve: ArrayLike | None = None,
    rows: ArrayLike | slice = _EVERY,
    name: str = "delay",
) -> Instrument:
    """A clock that is late or early: at time t the observable of t - delay is read.

    Between and beyond the given times the observable is a cubic spline of the prediction, so the
    times have to be dense enough to follow it. A jump is not followed.

    Parameters
    ----------
    times : array_like, shape (rows,)
        Time of each observable that it reads, s.
    size : float
        Delay that would not surprise, above 0, s.
    largest : float, optional
        Largest delay that is searched, to both sides, s; 30 times the size, if not given.
    curve : array_like of int, shape (rows,), optional
        To which curve each of them belongs; all to one, if not given. The times of a curve are all
        different, and there are at least two.
    rows : array_like or slice
        Observables that the instrument reads: indices, or a mask of shape (m,).
    name : str
        Of the cause; its parameter is ``<name>.time``, s.

    Raises
    ------
    ScenarioError
        If the times are not as they should be.
    """
    at = np.asarray(times, dtype=float)
    of = np.zeros(len(at), dtype=int) if curve is None else np.asarray(curve)
    if at.ndim != 1 or of.shape != at.shape or not np.all(np.isfinite(at)):
        raise ScenarioError("times, curve: allowed is one row of numbers each, of one length")
    curves = [np.flatnonzero(of == each) for each in np.unique(of)]
    curves = [each[np.argsort(at[each], kind="stable")] for each in curves]
    if any(len(each) < 2 or not np.all(np.diff(at[each]) > 0.0) for each in curves):
        raise ScenarioError("times: allowed are two or more of each curve, all different")
    end = _LARGEST * size if largest is None else largest
    parameter = CauseParameter(f"{name}.time", "s", -end, end, size)

    def late(some: Array, delays: Array) -> Array:
        _fitting(at, some)
        result = some.copy()
        # One that was not computed stays so, and a delay of zero leaves the very numbers.
        for vector in np.flatnonzero((delays != 0.0) & np.all(np.isfinite(some), axis=1)):
            for each in curves:
                spline = CubicSpline(at[each], some[vector, each])
                result[vector, each] = spline(at[each] - delays[vector])
        return result

    def read(reading: Array, _: Array, values: Array) -> Array:
        return _changed(reading, rows, late(_some(reading, rows), values[:, 0]))

    return Instrument(name, (parameter,), "readings are late", read=read)


def marker_place(
    x: ArrayLike | slice | None,
    z: ArrayLike | slice | None,
    size: float,
    *,
    theta: ArrayLike | slice | None = None,
    angle: ArrayLike | None = None,
    largest: float | None = None,
    name: str = "marker_place",
) -> Instrument:
    """The tracked point lies off the point that the model moves, fixed in the body.

    It is at x + a cos(theta) + b sin(theta) and z - a sin(theta) + b cos(theta), with a along and b
    across the body, and theta in this package's sense: nose-up is negative. For angles that grow
    counter-clockwise in (x, z) give ``angle`` with the other sign.

    Parameters
    ----------
    x, z : array_like or slice
        Places of the point among the observables, m: indices, or masks of shape (m,), of the same
        number in the same order. One that is not observed is None.
    size : float
        Distance that would not surprise, above 0, m.
    theta : array_like or slice, optional
        The predicted angles that belong to them, rad: indices or a mask too.
    angle : array_like, shape (number of rows,), optional
        The angles themselves, rad, where they are known and not predicted.
    largest : float, optional
        What is searched, to all sides, m; 30 times the size, if not given.
    name : str
        Of the cause; its parameters are ``<name>.along`` and ``<name>.across``, m.

    Raises
    ------
    ScenarioError
        If not one of `theta` and `angle` is given.
    """
    if (theta is None) == (angle is None):
        raise ScenarioError("theta, angle: allowed is one of them")
    end = _LARGEST * size if largest is None else largest
    parameters = tuple(
        CauseParameter(f"{name}.{word}", "m", -end, end, size) for word in ("along", "across")
    )

    def read(reading: Array, predicted: Array, values: Array) -> Array:
        turned = np.asarray(angle, dtype=float) if theta is None else _some(predicted, theta)
        along, across = values[:, :1], values[:, 1:]
        aside = along * np.cos(turned) + across * np.sin(turned)
        above = across * np.cos(turned) - along * np.sin(turned)
        for rows, shift in ((x, aside), (z, above)):
            if rows is not None:
                some = _some(reading, rows)
                reading = _changed(reading, rows, some + _fitting(shift, some))
        return reading

    return Instrument(name, parameters, "the tracked point lies elsewhere on the body", read=read)


def _some(observables: Array, rows: ArrayLike | slice) -> Array:
    """Some of the observables, shape (vectors, number of rows)."""
    try:
        return np.asarray(observables[:, rows if isinstance(rows, slice) else np.asarray(rows)])
    except IndexError:
        refuse("rows", rows, f"indices or a mask of {observables.shape[1]} observables")


def _changed(reading: Array, rows: ArrayLike | slice, values: Array) -> Array:
    """A copy of the readings with new values of some of them."""
    result = reading.copy()
    result[:, rows if isinstance(rows, slice) else np.asarray(rows)] = values
    return result


def _fitting(given: Array, some: Array) -> Array:
    """What was given for some observables, if it is as many as they are."""
    if given.shape[-1] != some.shape[1]:
        said = f"{given.shape[-1]} times or angles were given for {some.shape[1]} observables"
        raise ScenarioError(f"instruments: {said}; allowed is one for each")
    return given
