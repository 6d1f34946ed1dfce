"""Tables that shake the surface or drive the inner mass, one period again and again."""

from __future__ import annotations

import json
from os import PathLike
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _core
from stickslip._util.arrays import Array, in_columns
from stickslip._util.columns import read_table
from stickslip._util.files import write_rows
from stickslip._util.messages import known_arguments
from stickslip._util.recipes import Recipe
from stickslip.errors import prefixed
from stickslip.scenario.keys import USUAL

_P = TypeVar("_P", bound="PlayedRows")


class PlayedRows:
    """A table over one period, linear between its rows, that repeats."""

    __slots__ = ("rows",)

    _columns: ClassVar[dict[str, str]]
    """Their units."""

    rows: Array
    """As given, with the time in the first column."""

    def __init__(self, rows: ArrayLike) -> None:
        units = " and ".join(dict.fromkeys(self._columns.values()))
        self.rows = in_columns("rows", rows, [*self._columns], f"numbers of {units}", axes=2)

    @classmethod
    def from_csv(cls: type[_P], path: str | PathLike[str]) -> _P:
        """Read a CSV file with these columns, whose headings may state other units."""
        table = read_table(path, Recipe.of(cls._columns, exact=True))
        rows = np.stack([table.columns[name].values for name in cls._columns], axis=1)
        with prefixed(path):
            return cls(rows)

    @property
    def period(self) -> float:
        """The last time, s."""
        return float(self.rows[-1, 0])

    @property
    def values(self) -> list[tuple[str, tuple[float, float, str], float]]:
        """Its frequency: a name, usual magnitudes, and the value."""
        return [(f"1 / period of {type(self).__name__}", USUAL["shake.frequency"], 1 / self.period)]

    @property
    def missing_end(self) -> float | None:
        """The period with one more step, s, if that would join the last row to the first."""
        step = np.diff(self.rows[:, 0])
        if len(step) < 4 or np.ptp(step) > 1e-3 * step[0]:
            return None  # of fewer, the neighbours of both ends are the same
        first, second, last_but_one, last = self.rows[[0, 1, -2, -1], 1:]
        jump = first - last
        rough = np.linalg.norm(jump - 0.5 * (second - first + last - last_but_one))
        joins = 0.0 < np.linalg.norm(jump) > 2.0 * rough
        return self.period + float(step[0]) if joins else None

    def to_core(self) -> Array:
        """The core's form of it."""
        return self.rows

    def to_json(self) -> str:
        """The rows as JSON, from which `from_json` makes the same bits."""
        return json.dumps(self.rows.tolist())

    @classmethod
    def from_json(cls: type[_P], text: str) -> _P:
        """The table of a text from `to_json`."""
        return cls(json.loads(text))

    def write(self, path: str | PathLike[str]) -> None:
        """Write the CSV file that `from_csv` reads."""
        write_rows(path, [self._columns], self.rows.tolist())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and np.array_equal(self.rows, other.rows)

    def __hash__(self) -> int:
        return hash((self.rows + 0.0).tobytes())

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.rows,)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self.rows)} rows, period {self.period:g} s>"


@known_arguments
class Accelerations(PlayedRows):
    """Accelerations of a shaken surface over one period, linear between rows.

    The period repeats. Velocity and place of the surface follow by integration; so that it does not
    drift away, the mean of the accelerations is subtracted, and that of the velocity is zero.

    Parameters
    ----------
    rows : array_like, shape (n, 3)
        Time from 0 on, s, and accelerations along x and z, m/s^2. The last time is the period. In a
        CSV file the columns are t, ax and az.

    Raises
    ------
    ScenarioError
        If there are fewer than two rows, or one is not allowed.
    """

    __slots__ = ("mean",)

    _columns: ClassVar = {"t": "s", "ax": "m/s^2", "az": "m/s^2"}

    mean: tuple[float, float]
    """Offsets that are subtracted along x and z, m/s^2."""

    def __init__(self, rows: ArrayLike) -> None:
        super().__init__(rows)
        along, up = _core.Scenario().set_accelerations(self.rows)
        self.mean = along, up


@known_arguments
class Forces(PlayedRows):
    """Forces on the inner mass over one period, linear between rows.

    The period repeats. The mean of the forces may be other than zero.

    Parameters
    ----------
    rows : array_like, shape (n, 2)
        Time from 0 on, s, and force, N. The last time is the period. In a CSV file the columns are
        t and force.

    Raises
    ------
    ScenarioError
        If there are fewer than two rows, or one is not allowed.
    """

    __slots__ = ()

    _columns: ClassVar = {"t": "s", "force": "N"}

    def __init__(self, rows: ArrayLike) -> None:
        super().__init__(rows)
        _core.Scenario().set_forces(self.rows)
