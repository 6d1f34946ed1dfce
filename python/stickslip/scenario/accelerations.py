"""Accelerations of a surface that is shaken."""

from __future__ import annotations

import csv
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _core
from stickslip._util.arrays import Array, locked, numbers
from stickslip._util.tables import read_table
from stickslip.errors import ScenarioError, prefixed

_COLUMNS = {"t": "s", "ax": "m/s^2", "az": "m/s^2"}


class Accelerations:
    """Accelerations of a shaken surface over one period, linear between rows.

    The surface plays them again and again. Its velocity and place follow by integration; so that it
    does not drift away, the mean of the accelerations is taken out, and that of the velocity is
    zero.

    Parameters
    ----------
    rows : array_like, shape (n, 3)
        Time from 0 on, s, and accelerations along x and z, m/s^2. The last time is the period.

    Raises
    ------
    ScenarioError
        If there are fewer than two rows, or one is not allowed.
    """

    __slots__ = ("mean", "rows")

    rows: Array
    """As given, shape (n, 3)."""
    mean: tuple[float, float]
    """What is taken out along x and z, m/s^2."""

    def __init__(self, rows: ArrayLike) -> None:
        given = numbers("rows", rows, "numbers of s and m/s^2")
        if given.ndim != 2 or given.shape[1] != len(_COLUMNS):
            raise ScenarioError(f"rows of shape {given.shape}: allowed is (n, 3): t, ax, az")
        self.rows = locked(given)
        along, up = _core.Scenario().set_accelerations(self.rows)
        self.mean = along, up

    @classmethod
    def from_csv(cls, path: str | PathLike[str]) -> Accelerations:
        """Read a CSV file with the columns t, ax and az; headings may state other units."""
        rows = read_table(path, _COLUMNS).numbers
        with prefixed(path):
            return cls(rows)

    @property
    def period(self) -> float:
        """The last time, s."""
        return float(self.rows[-1, 0])

    @property
    def most(self) -> float:
        """The largest along either axis, m/s^2."""
        return float(np.abs(self.rows[:, 1:]).max())

    def write(self, path: str | PathLike[str]) -> None:
        """Write the CSV file that `from_csv` reads."""
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(_COLUMNS)
            writer.writerows(self.rows.tolist())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Accelerations) and np.array_equal(self.rows, other.rows)

    def __hash__(self) -> int:
        return hash((self.rows + 0.0).tobytes())

    def __reduce__(self) -> tuple[Any, ...]:
        return Accelerations, (self.rows,)

    def __repr__(self) -> str:
        return f"<Accelerations: {len(self.rows)} rows, period {self.period:g} s>"
