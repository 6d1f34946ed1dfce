"""Events at an unknown time, as causes: a step or a pulse of the readings or of an input.

Each public function but `edge` makes a `stickslip.Cause` for data in time (`stickslip.Series`).
They share these parameters:

size : float
    Usual height, above 0, in `unit`; its sign is free. Heights of up to 30 times it are searched.
begin, end : float
    Times between which it happens, s.
unit : str
    Of what is changed.
input : str
    Name of the input that is changed; the readings, if not given.
table : str
    Name of the record; all records, if not given.
name : str
    Of the cause; its parameters are ``<name>.<word>``.

Each raises a ScenarioError if a value is not allowed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.messages import refuse, shown
from stickslip._util.prior import Prior
from stickslip._util.text import is_number
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.signal import Signal
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter, either_way
from stickslip.errors import ScenarioError

_WIDTH = 0.4
"""Standard deviation of the prior of a time, in the range. Chosen: nearly even over it."""


def step(
    size: float, begin: float, end: float, *, unit: str = "-", input: str | None = None,
    table: str | None = None, name: str = "step",
) -> Cause:  # fmt: skip
    """A change that stays: ``height`` is added from ``time``, s, on."""
    height, time = either_way(f"{name}.height", unit, size), _time(name, begin, end)
    return _event((height, time), "a step", table, input, (begin, end))


def pulse(
    size: float, begin: float, end: float, longest: float, *, unit: str = "-",
    input: str | None = None, table: str | None = None, name: str = "pulse",
) -> Cause:  # fmt: skip
    """A change that passes: ``height`` is added from ``time``, s, for a ``length``, s.

    Parameters
    ----------
    longest : float
        Largest length, s; down to a hundredth of it all lengths are alike probable, by their
        logarithm.
    """
    if not is_number(longest) or not 0.0 < longest < math.inf:
        refuse("longest", longest, "a time above 0, s")
    height, time = either_way(f"{name}.height", unit, size), _time(name, begin, end)
    prior = Prior("log-uniform", longest / 100.0, longest)
    length = Parameter(f"{name}.length", prior, unit="s", cause=False)
    return _event((height, time, length), "a pulse", table, input, (begin, end + longest))


def _event(
    parts: tuple[Parameter, ...], what: str, table: str | None, input: str | None,
    between: tuple[float, float],
) -> Cause:  # fmt: skip
    names = [each.name for each in parts]
    read, acts = (partial(_read, names), None) if input is None else (None, partial(_acted, names))
    return Cause(
        names[0].rpartition(".")[0], parts, f"{what} of {input or 'the readings'}", read=read,
        acts=acts, table=table, input=input, between=between,
    )  # fmt: skip


def _read(
    names: Sequence[str], values: Array, _: Array, p: dict[str, Array], table: Table
) -> Array:
    return values + _happened(names, p, partial(edge, table))


def _acted(names: Sequence[str], signal: Signal, p: dict[str, Array]) -> Signal:
    """A held input has its mean in each step, so that its momentum is right.

    An input that acts late already is changed by when it acts.
    """
    gaps = np.diff(signal.t)
    usual = float(np.median(gaps)) if len(gaps) else 1.0
    step = np.append(gaps, usual) if signal.held else usual
    t = signal.t + 0.5 * step * signal.held
    added = _happened(names, p, lambda time: _edge(t, step, time - signal.late[:, None]))
    return replace(signal, values=signal.values + added)


def _happened(names: Sequence[str], p: dict[str, Array], begun: Callable[[Array], Array]) -> Array:
    height, time, *length = (p[name] for name in names)
    shape = begun(time)
    return height * (shape - begun(time + length[0]) if length else shape)


def edge(table: Table, time: Array) -> Array:
    """A step from 0 to 1 at times, shape (vectors, 1), as (vectors, rows).

    It takes one step of the record, so that it has a derivative by its time.
    """
    if not isinstance(table, Series):
        raise ScenarioError(f"events: table {table.name} has no times; allowed is a Series")
    return _edge(table.t, table.step, time)


def _edge(t: Array, step: Array | float, time: Array) -> Array:
    return np.clip((t - time) / step + 0.5, 0.0, 1.0)


def _time(name: str, begin: float, end: float) -> Parameter:
    if not is_number(begin) or not is_number(end) or not -math.inf < begin < end < math.inf:
        raise ScenarioError(
            f"cause {name}: begin = {shown(begin)}, end = {shown(end)}: allowed is begin < end, s"
        )
    prior = Prior("normal", 0.5 * (begin + end), _WIDTH * (end - begin))
    return Parameter(f"{name}.time", prior, unit="s", low=begin, high=end, cause=False)
