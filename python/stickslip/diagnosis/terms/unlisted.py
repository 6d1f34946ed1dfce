"""Effects that nobody listed: rivals of the listed causes, which are never claimed.

A list of causes is a sample. Where it has all the probability, what nobody listed gets a listed
name. So effects of the same kinds of shape compete, each with one amplitude: something that acts
with an input, an error of the readings, and another scale of either. All together have the odds of
one listed cause.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from stickslip._util.arrays import Array, root_mean_square
from stickslip._util.units import is_of, units_of
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.instruments import delay, lag
from stickslip.diagnosis.terms.parameter import either_way

_ACTING, _READ, _SLOW, _SCALE = 0.1, 0.05, 0.03, 0.1
"""Usual size of what acts, in the root mean square of its input, and of an error of a reading, in
their scatter; part of the largest speed below which a sign is smooth; and usual logarithm of a
scale. Chosen."""

_FACTOR = ".logarithm"  # ends the name of a scale's parameter
_FARTHEST = math.log(2e3)  # of a scale; chosen: a wrong prefix
_UNIT = 0.02  # part by which a scale may differ from a ratio of units that is asked for; chosen

_LISTED = {
    "load": "1", "coulomb": "sign v", "quadratic": "v|v|", "cubic_damping": "v^3",
    "quadratic_stiffness": "x^2", "cubic_stiffness": "x^3", "stiffness": "x", "gravity": "sin x",
    "viscous_asymmetry": "|v|", "gain_asymmetry": "|u|", "loss_growth": "v|v|",
    "saturation": "u^3",
}  # fmt: skip
"""Shapes of what listed causes do, by their names."""

Shape = Callable[[Array, Table], Array]
"""``shape(given, table)`` is of what is recorded or predicted, (vectors, rows)."""


def unlisted(
    tables: Sequence[Table], listed: Collection[str],
    states: Sequence[Mapping[str, Array]] = (), units: Mapping[str, str] = MappingProxyType({}),
) -> list[Cause]:  # fmt: skip
    """Make the effects that nobody listed of some tables.

    Parameters
    ----------
    tables : sequence of Table
        As they are predicted.
    listed : collection of str
        Names of listed causes, whose shapes are left out.
    states : sequence of dict of ndarray, shape (n,)
        Of the recalibrated model in each record, ``x`` and ``v`` or ``v`` alone; they act with the
        first of the inputs.
    units : dict
        SI units of inputs, by name.
    """
    made = [_shaped(tables, None, *each) for each in _of_readings(tables).items()]
    records = [table for table in tables if isinstance(table, Series)]
    named = records[0].inputs if len(records) == len(tables) else {}
    inputs = [name for name in units or named if all(name in one.inputs for one in records)]
    gone = {_LISTED.get(each, "") for each in listed}
    for name in inputs[:1] if states else inputs:
        acting = _of_states(tables, states) if states else {}
        acting |= {"1": _one, "t": _time, "|u|": _size, "u^2": _power(2), "u^3": _power(3)}
        made += [_shaped(tables, name, *each) for each in acting.items() if each[0] not in gone]
    if records == [*tables]:
        units = {name: units.get(name, "") for name in inputs}
        made += _instruments(records[0], units | {"": records[0].unit}, listed)
    return [replace(cause, odds=1.0 / len(made), listed=False) for cause in made]


def at_scale(cause: Cause, factor: float) -> dict[str, float]:
    """The coordinate of a scale at a factor above 0; nothing of another cause."""
    (first, *_) = cause.parameters or (None,)
    is_scale = first is not None and first.name.endswith(_FACTOR)
    return {first.name: first.coordinate(math.log(factor))} if is_scale else {}


def _one(given: Array, table: Table) -> Array:
    return np.ones_like(given)


def _size(given: Array, table: Table) -> Array:
    return np.abs(given)


def _power(exponent: int) -> Shape:
    return lambda given, table: given**exponent


def _time(given: Array, table: Table) -> Array:
    t = table.t if isinstance(table, Series) else np.zeros(len(table))
    return np.asarray((t - t.mean()) / np.ptp(t))[None]


def _about_mean(shape: Shape, given: Array, table: Table) -> Array:
    return shape(given - given.mean(axis=1, keepdims=True), table)


def _of_setting(
    name: Any, low: float, span: float, shape: Callable[[Array], Array], given: Array, table: Table
) -> Array:  # fmt: skip
    return shape((np.asarray(table[name], dtype=float) - low) / span)[None]


def _of_readings(tables: Sequence[Table]) -> dict[str, Shape]:
    """Shapes of an error of the readings: over themselves, and over time or settings."""
    shapes = {"|y|": _size, "y^2": _power(2), "y^3": _power(3)}
    made = {"1": _one} | {word: partial(_about_mean, each) for word, each in shapes.items()}
    if isinstance(tables[0], Series):
        return made | {"t": _time}
    settings = [table.settings if isinstance(table.settings, dict) else {} for table in tables]
    for name in settings[0] if all(settings) else ():
        columns = [np.asarray(each.get(name, ())) for each in settings]
        every = np.concatenate(columns)
        if all(map(len, columns)) and every.dtype.kind in "fiu" and len(np.unique(every)) > 2:
            of = partial(partial, _of_setting, name, float(every.min()), float(np.ptp(every)))
            made |= {f"{name}": of(lambda u: u), f"{name}^2": of(np.square),
                     f"{name}^3": of(lambda u: u**3), f"ln {name}": of(np.log1p),
                     f"a wave of {name}": of(lambda u: np.sin(2.0 * np.pi * u))}  # fmt: skip
    return made


def _of_states(
    tables: Sequence[Table], states: Sequence[Mapping[str, Array]]
) -> dict[str, Shape]:
    """Shapes of what acts with states, each of one table; elsewhere nothing is known of them."""
    largest = max(float(np.max(np.abs(each["v"]))) for each in states) or 1.0
    shapes: dict[str, tuple[str, Callable[[Array], Array]]] = {
        "|v|": ("v", np.abs), "v|v|": ("v", lambda v: v * np.abs(v)), "v^3": ("v", lambda v: v**3)
    }  # fmt: skip
    if "x" in states[0]:
        middle = float(np.mean(np.concatenate([each["x"] for each in states])))
        shapes |= {"sign v": ("v", lambda v: np.tanh(v / (_SLOW * largest))),
                   "x": ("x", lambda x: x - middle), "x^2": ("x", lambda x: (x - middle) ** 2),
                   "x^3": ("x", lambda x: (x - middle) ** 3), "sin x": ("x", np.sin)}  # fmt: skip

    def at(state: str, shape: Callable[[Array], Array], given: Array, table: Table) -> Array:
        mine = (each for one, each in zip(tables, states, strict=True) if one is table)
        return shape(next(mine, {state: np.zeros(len(table))})[state])[None]

    return {word: partial(at, *each) for word, each in shapes.items()}


def _shaped(tables: Sequence[Table], name: str | None, word: str, shape: Shape) -> Cause:
    """Make an effect with an input, or else an error of the readings, of a shape."""
    given = [np.asarray(table[name] if name else table.y, dtype=float)[None] for table in tables]
    every = np.hstack([shape(*each) for each in zip(given, tables, strict=True)])
    whole = np.hstack(given)
    usual = _ACTING * root_mean_square(whole) if name else _READ * float(np.std(whole))
    size = max(usual, 1e-300) / max(root_mean_square(every), 1e-300)
    what = f"unlisted {name or 'reading'} as {word}"
    amplitude = either_way(f"{what}.size", "-", size)

    def read(readings: Array, given: Array, p: Mapping[str, Array], table: Table) -> Array:
        return readings + p[amplitude.name] * shape(given, table)

    grows = {"1": "that is constant", "t": "that drifts"}.get(word, f"that goes with {word}")
    meaning = f"an unlisted {name or 'error of the readings'} {grows}"
    return Cause(what, amplitude, meaning, read=read, input=name)


def _instruments(
    record: Series, units: Mapping[str, str], listed: Collection[str]
) -> Iterator[Cause]:
    """Yield delays and lags that are not listed, and scales; the readings have the name ``""``."""
    for name, unit in units.items():
        of = name or "the readings"
        if name and f"late {name}" not in listed:
            late = delay(size=record.step, input=name, name=f"unlisted delay of {of}")
            yield replace(late, told=None)  # nothing that is said of a claim
        slow = {f"slow {name}", "slow motor"} if name else {"slow sensor", "slow thermometer"}
        if not slow & {*listed}:
            yield lag(record.step, input=name or None, name=f"unlisted lag of {of}")
        if not is_of(unit, "K"):  # of temperatures, whose zero is another, it says nothing
            yield _scale(name, of, unit)


def _scale(name: str, of: str, unit: str) -> Cause:
    """Make another scale of an input or of the readings, however far off."""
    what = f"unlisted scale of {of}"
    factor = either_way(f"{what}{_FACTOR}", "-", _SCALE, _FARTHEST)

    def read(values: Array, given: Array, p: Mapping[str, Array], table: Table) -> Array:
        return values * np.exp(p[factor.name])

    def told(value: float, amount: str, step: float) -> str:
        per, known = math.exp(value), units_of(unit) if unit else {}
        asked = (each for each, ratio in known.items() if abs(per / ratio - 1.0) < _UNIT)
        text = f"The scale of {of} is off by a factor of {per:.3g}"
        return next((f"{text}: is the unit {each}?" for each in asked), f"{text}.")

    return Cause(what, factor, f"another scale of {of}", read=read, input=name or None, told=told)
