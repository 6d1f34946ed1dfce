"""Readings of one kind with their settings: what the diagnosis asks of all data."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.numbers import Array, Indices, representatives
from stickslip._util.text import brief
from stickslip.diagnosis.data.errors import Errors, estimate
from stickslip.errors import ScenarioError
from stickslip.simulation.note import Note

_FEWEST_RUNS = 3  # that are held out whole


class Table:
    """Readings at settings. Rows with equal settings (to 1e-6) are repeats of one condition.

    Parameters
    ----------
    settings : mapping, DataFrame or array_like
        Columns by name, each of shape (n,), or an array of shape (n,) or (n, columns). Texts are
        allowed.
    y : array_like, shape (n,)
        Readings.
    sd : float or array_like, shape (n,), optional
        Standard deviation of each reading; estimated from repeats, if not given.
    block : array_like, shape (n,), optional
        Set-up of each reading: readings of one set-up share an error.
    run : array_like, shape (n,), optional
        Run of each reading: errors of neighbours in a run may be correlated, in the order of the
        rows.
    name, unit : str
        Of the table, and of its readings.

    Attributes
    ----------
    settings : as given
    y : ndarray, shape (n,)
    condition : ndarray of int, shape (n,)
        Of each reading, numbered in the order of their first rows.
    first : ndarray of int, shape (m,)
        First row of each condition.
    mean : ndarray, shape (m,)
        Mean of each condition.
    errors : Errors
        Of `mean`.
    places : ndarray, shape (m, d), or None
        Numbers of the conditions that vary, over which a discrepancy may be smooth.
    run, order : ndarray, shape (m,), or None
        Run of each condition and its place in it, along which a discrepancy may be correlated.
    group : ndarray of int, shape (m,)
        Conditions that are held out together, numbered from 0.
    notes : list of Note

    Raises
    ------
    ScenarioError
        If lengths differ or a number is not finite.
    """

    run: Indices | None
    order: Array | None
    places: Array | None
    notes: list[Note]

    def __init__(
        self,
        settings: Any,
        y: ArrayLike,
        *,
        sd: ArrayLike | None = None,
        block: ArrayLike | None = None,
        run: ArrayLike | None = None,
        name: str = "",
        unit: str = "-",
    ) -> None:
        self.name, self.unit, self.settings = str(name), unit, settings
        at = f"table {name}: " if name else "table: "
        self.y = _row(y, at + "y")
        count = len(self.y)
        columns = _columns(settings, count, at)
        keys = list(zip(*(_equal(each) for each in columns), strict=True)) or [()] * count
        number = {key: k for k, key in enumerate(dict.fromkeys(keys))}
        self.condition = np.array([number[key] for key in keys], dtype=np.int64)
        self.first = np.unique(self.condition, return_index=True)[1]
        self.places = _places([each[self.first] for each in columns])
        self.group = np.arange(len(number), dtype=np.int64)
        runs = None if run is None else _labels(run, count, at + "run")
        stated = None if sd is None else stated_errors(sd, count, at + "sd")
        self.mean, self.errors = estimate(
            self.y, self.condition, sd=stated, run=runs,
            setup=None if block is None else _labels(block, count, at + "block"),
        )  # fmt: skip
        self.notes = list(self.errors.notes)
        self.run = self.order = None
        if runs is not None and len(number) == count:
            self.run, self.order = runs, np.arange(count, dtype=float)
            if int(runs.max()) + 1 >= _FEWEST_RUNS:
                self.group = runs  # a whole run is predicted from the others

    def __getitem__(self, column: str) -> Array:
        """A column of the settings, shape (n,)."""
        return np.asarray(self.settings[column])

    def with_errors(self, errors: Errors) -> Table:
        """The same readings with other errors, and notes of these alone."""
        made = copy.copy(self)
        made.errors, made.notes = errors, list(errors.notes)
        return made

    def __len__(self) -> int:
        return len(self.y)

    def __repr__(self) -> str:
        return f"<Table {self.name}: {len(self.y)} readings, {len(self.mean)} conditions>"


def _row(values: ArrayLike, what: str) -> Array:
    try:
        row = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        row = np.zeros(0)
    if row.ndim != 1 or not len(row) or not np.all(np.isfinite(row)):
        raise ScenarioError(f"{what} = {brief(values)}: allowed is one row of finite numbers")
    return row


def stated_errors(sd: ArrayLike, count: int, what: str) -> Array:
    """The stated error of each reading."""
    try:
        each = np.broadcast_to(np.asarray(sd, dtype=float), (count,))
    except (TypeError, ValueError):
        each = np.zeros(1)
    if not np.all(np.isfinite(each) & (each > 0.0)):
        raise ScenarioError(
            f"{what} = {brief(sd)}: allowed is a number above 0, or {count} of them"
        )
    return each


def _labels(values: ArrayLike, count: int, what: str) -> Indices:
    labels = np.asarray(values)
    if labels.shape != (count,):
        raise ScenarioError(f"{what}: allowed is one for each of {count} readings")
    texts = labels if labels.dtype.kind in "fiub" else labels.astype(str)
    return np.asarray(np.unique(texts, return_inverse=True)[1], dtype=np.int64)


def _columns(settings: Any, count: int, at: str) -> list[Array]:
    """Columns of settings, each of shape (n,)."""
    if isinstance(settings, Mapping) or hasattr(settings, "columns"):
        columns = [np.asarray(settings[key]) for key in settings]
    elif isinstance(settings, Sequence) and settings and isinstance(settings[0], Mapping):
        if any(not isinstance(row, Mapping) or row.keys() != settings[0].keys()
               for row in settings):  # fmt: skip
            raise ScenarioError(f"{at}settings: allowed are rows with the same names")
        columns = [np.asarray([row[key] for row in settings]) for key in settings[0]]
    else:
        array = np.asarray(settings)
        columns = list(array.T) if array.ndim == 2 else [array]
    for each in columns:
        if each.shape != (count,):
            raise ScenarioError(f"{at}settings: allowed are {count} rows, one for each reading")
        if each.dtype.kind == "f" and not np.all(np.isfinite(each)):
            raise ScenarioError(f"{at}settings: allowed are finite numbers")
    return columns


def _equal(column: Array) -> list[Any]:
    """What stands for each value, the same for equal settings."""
    if column.dtype.kind not in "fiu":
        return [str(each) for each in column.tolist()]
    size = float(np.max(np.abs(column), initial=0.0))
    same = representatives(column.astype(float).tolist(), absolute=1e-12 * size)
    return [same[float(each)] for each in column.tolist()]


def _places(columns: list[Array]) -> Array | None:
    """The columns of numbers that vary; None where there is none."""
    varying = [
        each.astype(float) for each in columns if each.dtype.kind in "fiu" and np.ptp(each) > 0.0
    ]
    return np.stack(varying, axis=1) if varying else None
