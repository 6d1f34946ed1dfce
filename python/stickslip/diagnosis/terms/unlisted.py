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

ACTING, READ, SCALE, _SLOW = 0.1, 0.05, 0.1, 0.03
"""Usual size of what acts, in the root mean square of its input, of an error of a reading, in their
scatter, and of the logarithm of a scale; and part of the largest speed below which a sign is
smooth. Chosen."""

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

Function = Callable[[Array], Array]
Shape = Callable[[Array, Table], Array]
"""``shape(given, table)`` is of what is recorded or predicted, (vectors, rows): that or (rows,)."""


def unlisted(
    tables: Sequence[Table], listed: Collection[Cause],
    states: Sequence[Mapping[str, Array]] = (), units: Mapping[str, str] = MappingProxyType({}),
) -> list[Cause]:  # fmt: skip
    """Make the effects that nobody listed of tables, as they are predicted.

    Shapes of `listed` causes are left out. `states` are those of the recalibrated model in each
    record, ``x`` and ``v`` or ``v`` alone, shape (n,), which act with the first of its inputs;
    `units` are the inputs' SI units by name.
    """
    made = [_shaped(tables, None, *each) for each in _of_readings(tables).items()]
    records = [table for table in tables if isinstance(table, Series)]
    named = records[0].inputs if len(records) == len(tables) else {}
    inputs = [name for name in units or named if all(name in one.inputs for one in records)]
    gone = {_LISTED.get(cause.name, "") for cause in listed}
    for name in inputs[:1] if states else inputs:
        acting = _of_states(tables, states) if states else {}
        over: dict[str, Function] = {"1": np.ones_like, "|u|": np.abs}
        over |= {"u^2": np.square, "u^3": _cube}
        acting |= {word: partial(_of_given, each) for word, each in over.items()} | {"t": _of_time}
        if all(np.all(table[name] >= 0.0) for table in tables):
            acting.pop("|u|")  # which is another scale
        made += [_shaped(tables, name, *each) for each in acting.items() if each[0] not in gone]
    if records == [*tables]:
        units = {name: units.get(name, "") for name in inputs}
        known = {_formula(cause) for cause in listed}
        each = _instruments(records[0], units | {"": records[0].unit})
        made += [cause for cause in each if _formula(cause) not in known]
    return [replace(cause, odds=1.0 / len(made), listed=False) for cause in made]


def at_scale(cause: Cause, factor: float) -> dict[str, float]:
    """The coordinate of a scale at a factor; nothing of another cause."""
    return {one.name: one.coordinate(math.log(factor)) for one in cause.parameters
            if one.name.endswith(_FACTOR)}  # fmt: skip


def _of_readings(tables: Sequence[Table]) -> dict[str, Shape]:
    """Shapes of an error of the readings: over themselves, and over time or settings."""
    shapes: dict[str, Function] = {"|y|": np.abs, "y^2": np.square, "y^3": _cube}
    made: dict[str, Shape] = {"1": partial(_of_given, np.ones_like)}
    made |= {word: partial(_about_mean, each) for word, each in shapes.items()}
    if isinstance(tables[0], Series):
        return made | {"t": _of_time}
    settings = [table.settings if isinstance(table.settings, dict) else {} for table in tables]
    for name in settings[0] if all(settings) else ():
        every = np.concatenate([np.asarray(each.get(name, ())) for each in settings])
        if every.dtype.kind in "fiu" and len(np.unique(every)) > 2:
            ends = float(every.min()), float(np.ptp(every))
            over: dict[str, Function] = {
                name: np.asarray, f"{name}^2": np.square, f"{name}^3": _cube,
                f"ln {name}": np.log1p, f"a wave of {name}": _wave,
            }  # fmt: skip
            made |= {word: partial(_of_setting, name, *ends, each) for word, each in over.items()}
    return made


def _of_states(tables: Sequence[Table], states: Sequence[Mapping[str, Array]]) -> dict[str, Shape]:
    """Shapes of what acts with the states of each table."""
    largest = max(float(np.max(np.abs(each["v"]))) for each in states) or 1.0
    shapes: dict[str, tuple[str, float, Function]] = {
        "|v|": ("v", 0.0, np.abs), "v|v|": ("v", 0.0, _signed_square), "v^3": ("v", 0.0, _cube)
    }  # fmt: skip
    if "x" in states[0]:
        middle = float(np.mean(np.concatenate([each["x"] for each in states])))
        shapes |= {"sign v": ("v", 0.0, partial(_sign, _SLOW * largest)),
                   "x": ("x", middle, np.asarray), "x^2": ("x", middle, np.square),
                   "x^3": ("x", middle, _cube), "sin x": ("x", 0.0, np.sin)}  # fmt: skip
    return {word: partial(_of_state, tables, states, *each) for word, each in shapes.items()}


def _cube(values: Array) -> Array:
    return np.asarray(values**3)


def _signed_square(values: Array) -> Array:
    return np.asarray(values * np.abs(values))


def _wave(values: Array) -> Array:
    return np.asarray(np.sin(2.0 * np.pi * values))


def _sign(slow: float, values: Array) -> Array:
    return np.asarray(np.tanh(values / slow))


def _of_given(shape: Function, given: Array, table: Table) -> Array:
    return shape(given)


def _about_mean(shape: Function, given: Array, table: Table) -> Array:
    return shape(given - given.mean(axis=1, keepdims=True))


def _of_time(given: Array, table: Table) -> Array:
    t = table.t if isinstance(table, Series) else np.zeros(len(table))
    return np.asarray((t - t.mean()) / (np.ptp(t) or 1.0))


def _of_setting(
    name: Any, low: float, span: float, shape: Function, given: Array, table: Table
) -> Array:
    at = table.settings.get(name, np.full(len(table), low))  # a prediction may state no place
    return shape((np.asarray(at, dtype=float) - low) / span)


def _of_state(
    tables: Sequence[Table], states: Sequence[Mapping[str, Array]], state: str, middle: float,
    shape: Function, given: Array, table: Table,
) -> Array:  # fmt: skip
    mine = next((each for one, each in zip(tables, states, strict=True) if one is table), None)
    # Of other conditions no state is known, and nothing is added.
    return shape(mine[state] - middle) if mine else np.zeros(len(table))


def _shaped(tables: Sequence[Table], name: str | None, word: str, shape: Shape) -> Cause:
    """Make an effect with an input, or else an error of the readings, of a shape."""
    given = [np.asarray(table[name] if name else table.y, dtype=float)[None] for table in tables]
    pairs = zip(given, tables, strict=True)
    every = np.concatenate([shape(values, table).ravel() for values, table in pairs])
    whole = np.hstack(given)
    usual = ACTING * root_mean_square(whole) if name else READ * float(np.std(whole))
    size = max(usual, 1e-300) / max(root_mean_square(every), 1e-300)
    what = f"unlisted {name or 'reading'} as {word}"
    amplitude = either_way(f"{what}.size", "-", size)
    grows = {"1": "that is constant", "t": "that drifts"}.get(word, f"that goes with {word}")
    meaning = f"an unlisted {name or 'error of the readings'} {grows}"
    read = partial(_added, amplitude.name, shape)
    return Cause(what, (amplitude,), meaning, read=read, input=name)


def _added(
    name: str, shape: Shape, values: Array, given: Array, p: Mapping[str, Array], table: Table
) -> Array:
    return values + p[name] * shape(given, table)


def _instruments(record: Series, units: Mapping[str, str]) -> Iterator[Cause]:
    """Yield delays and lags, and scales; the readings have the name ``""``."""
    for name, unit in units.items():
        of = name or "the readings"
        if name:
            late = delay(size=record.step, input=name, name=f"unlisted delay of {of}")
            yield replace(late, told=None)  # nothing that is said of a claim
        yield lag(record.step, input=name or None, name=f"unlisted lag of {of}")
        if not is_of(unit, "K"):  # of temperatures, whose zero is another, it says nothing
            what = f"unlisted scale of {of}"
            factor = either_way(f"{what}{_FACTOR}", "-", SCALE, _FARTHEST)
            read = partial(_scaled, factor.name)
            yield Cause(what, (factor,), f"another scale of {of}", read=read, input=name or None,
                        told=partial(_scale_in_words, name, unit))  # fmt: skip


def _formula(cause: Cause) -> tuple[Any, ...]:
    """What two causes of one formula have alike, of those that `instruments` makes."""
    of: Any = cause.acts or cause.read
    changes = [each for each in getattr(of, "args", ())[:1] if callable(each)]
    return cause.input, getattr(of, "func", of), *changes


def _scaled(name: str, values: Array, given: Array, p: Mapping[str, Array], table: Table) -> Array:
    return values * np.exp(p[name])


def _scale_in_words(name: str, unit: str, value: float, amount: str, step: float) -> str:
    """A sentence on a scale, which asks for a unit where there is one of about that ratio."""
    per = math.exp(-value if name else value)  # of an input less acts than is recorded
    known = units_of(unit) if unit not in ("", "-") else {}
    asked = (each for each, ratio in known.items() if abs(per / ratio - 1.0) < _UNIT)
    text = f"The scale of {name or 'the readings'} is off by a factor of {math.exp(value):.3g}"
    return next((f"{text}: is the unit {each}?" for each in asked), f"{text}.")
