"""A model of one vector as a model of many, and low-pass filters for logs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import butter, sosfiltfilt

from stickslip._util.arrays import Array, numbers, row
from stickslip._util.messages import check_kind, refuse
from stickslip._util.text import OneLine, is_number
from stickslip._util.units import same_unit, si_of
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.errors import ScenarioError
from stickslip.models.log import Columns

_ORDER = 4  # of the filter, half of it each way; common in the identification of robots
_UNEVEN = 0.01  # of a step: how even steps have to be; chosen
_PERIODS = 2.0
"""Periods that a record has of a cutoff, and of half its rate less that. Chosen: of a sine at the
cutoff the middle half of a record keeps half of the power to a tenth; with 5, to a hundredth."""


def vectorised(function: Callable[[Any, dict[str, float]], ArrayLike]) -> Callable[..., Array]:
    """A model of one vector of parameters as `diagnose_model` asks for it.

    Parameters
    ----------
    function : callable
        ``function(table, p)`` of a `Table` or `Series` returns readings, shape (rows,); ``p[name]``
        is a number, ``table[name]`` and ``table.t`` are of shape (rows,).

    Returns
    -------
    callable
        ``predict(table, p)``, which calls it for one vector after another.
    """
    if not callable(function):
        refuse("vectorised", function, "a function of (table, p)")
    return partial(_one_by_one, function)


def _one_by_one(
    function: Callable[[Any, dict[str, float]], ArrayLike], table: Table, p: Mapping[str, Array]
) -> Array:
    inputs = table.inputs if isinstance(table, Series) else {}
    many = [name for name, array in inputs.items() if array.ndim == 2]
    vectors = max((len(array) for array in p.values()), default=1)
    rows = []
    for k in range(vectors):
        single = {name: inputs[name][k] for name in many}
        seen = table.with_inputs(single) if single and isinstance(table, Series) else table
        values = {name: float(column[k, 0]) for name, column in p.items()}
        made = function(seen, values)
        if made is None:
            return None
        rows.append(numbers("model: its answer", made, gaps=True, finite=False))
    return np.array(rows)


@dataclass(frozen=True, repr=False, eq=False)
class Own(OneLine):
    """A model of one's own with its terms and the columns of its logs; see `own`."""

    predict: Callable[..., Array]
    uncertain: tuple[Parameter, ...]
    causes: tuple[Cause, ...]
    columns: Columns

    def __call__(self, table: Table, p: Mapping[str, Array], *curves: Any) -> Array:
        return self.predict(table, p, *curves)

    def terms(self, data: object) -> tuple[tuple[Parameter, ...], tuple[Cause, ...]]:
        """Uncertain parameters and causes, whatever the data."""
        return self.uncertain, self.causes


def own(
    predict: Callable[..., Array],
    uncertain: Sequence[Parameter],
    causes: Sequence[Cause],
    *,
    reads: Mapping[str, str],
    inputs: Mapping[str, str] | None = None,
) -> Own:
    """A model of one's own that ``stickslip diagnose LOG.csv --model FILE.py:NAME`` takes.

    Parameters
    ----------
    predict, uncertain, causes
        As for `diagnose_model`; a model of one vector is wrapped by `vectorised`.
    reads : dict
        The column that is read, and its SI unit: ``{"level": "V"}``.
    inputs : dict, optional
        Columns of inputs and their SI units. All of them have to be there.

    Raises
    ------
    ScenarioError
        If something is given that is not allowed.
    """
    check_kind("own: inputs", inputs or {}, Mapping)
    if not isinstance(reads, Mapping) or len(reads) != 1:
        refuse("own: reads", reads, 'one column and its unit, such as {"speed": "m/s"}')
    ((name, unit),) = reads.items()
    for column, given in (*reads.items(), *(inputs or {}).items()):
        if si_of(given) != given and not same_unit(given, si_of(given)):
            refuse(f"own: unit of {column}", given, f"the SI unit, {si_of(given)}")
    named = {key: (unit_of,) for key, unit_of in (inputs or {}).items()}
    return Own(predict, tuple(uncertain), tuple(causes), Columns(name, unit, named, needed=True))


def low_pass(t: ArrayLike, y: ArrayLike, cutoff: float, *, derivatives: int = 0) -> Array:
    """A row of a log without what is faster than a frequency, or its derivative.

    A Butterworth filter of order 2 runs forwards and backwards, so nothing comes late; derivatives
    are central differences of what it leaves. The readings at both ends are worse. Errors of
    neighbours are correlated then: keep every n-th reading, about four a period of `cutoff`, for a
    diagnosis.

    Parameters
    ----------
    t, y : array_like, shape (n,)
        Times, s, with even steps, and what was read.
    cutoff : float
        Frequency at which half of the power is left, Hz: two periods in the record or more, and as
        far below half the rate of the log.
    derivatives : int
        0, 1 or 2.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    ScenarioError
        If steps are uneven, a row is too short or not finite, or `cutoff` is not allowed.
    """
    times = row("t", t, unit="s")
    values = row("y", y, len(times))
    steps = np.diff(times)
    if len(times) < 3 * _ORDER:
        raise ScenarioError(f"t: {len(times)} times; allowed are {3 * _ORDER} or more")
    step = float(np.median(steps))
    uneven = np.flatnonzero(~(np.abs(steps - step) <= _UNEVEN * step))
    if len(uneven):
        at = int(uneven[0]) + 1
        refuse(f"t: row {at}", float(times[at]), f"{times[at - 1] + step:.12g}, an even step")
    least = _PERIODS / float(times[-1] - times[0])
    most = 0.5 / step - least
    if not is_number(cutoff) or not least <= cutoff <= most:
        away = f"{_PERIODS:g} periods of the record away from 0 and from half its rate"
        refuse("cutoff", cutoff, f"a frequency from {least:g} to {most:g} Hz, {away}")
    if derivatives not in (0, 1, 2):
        refuse("derivatives", derivatives, "0, 1 or 2")
    # Twice the filter: at the cutoff each pass leaves the root of a half. In the bilinear transform
    # a frequency is the tangent of half its phase from one reading to the next.
    width = np.tan(np.pi * step * cutoff) / (np.sqrt(2.0) - 1.0) ** (1.0 / _ORDER)
    edge = np.arctan(width) / (np.pi * step)
    sections = butter(_ORDER // 2, edge, fs=1.0 / step, output="sos")
    result = np.asarray(sosfiltfilt(sections, values))
    for _ in range(derivatives):
        result = np.gradient(result, step, edge_order=2)
    return result
