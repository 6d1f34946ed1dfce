"""Trials, and the tables of velocities of a measurement put together as those of one problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array, Indices, Mask
from stickslip._util.one_line import OneLine
from stickslip.measurement.velocity import VelocityData
from stickslip.scenario.keys import Value


@dataclass(frozen=True, repr=False, eq=False)
class Trials(OneLine):
    """Trials, each of shape (n,).

    Values are in the observable's unit; conditions are indices 0 to m - 1, none missing; blocks are
    indices of set-ups, -1 where one is not known; the order is NaN where it is not known; runs are
    indices too, and the readings of a run are in the order of the rows, or in that of `order` where
    all of them have one.
    """

    value: Array
    condition: Indices
    block: Indices | None
    order: Array | None
    run: Indices | None = None

    @property
    def mean(self) -> Array:
        """Mean of the trials of each condition, shape (m,)."""
        return np.bincount(self.condition, self.value) / np.bincount(self.condition)

    def at(self, kept: Mask) -> Trials:
        """Those of some conditions, `kept` of shape (m,), which are numbered anew."""
        rows = kept[self.condition]
        number = np.cumsum(kept) - 1
        block = None if self.block is None else self.block[rows]
        order = None if self.order is None else self.order[rows]
        run = None if self.run is None else self.run[rows]
        return Trials(self.value[rows], number[self.condition[rows]], block, order, run)


def pooled_velocities(tables: Sequence[VelocityData]) -> tuple[list[dict[str, Value]], Trials]:
    """All tables as one, m/s, with conditions in an order that does not depend on the rows'.

    A run is a curve, whose conditions differ in the frequency alone, in one sweep of one set-up of
    one table; where a table gives the order of all trials, it is the curve with all its sweeps.
    """
    found: dict[tuple[tuple[str, Value], ...], list[tuple[float, int, float, int]]] = {}
    runs: dict[tuple[object, ...], int] = {}
    above = 0
    for table, data in enumerate(tables):
        sweeps = np.where(np.all(np.isfinite(data.order)), 0, data.sweep)
        rows = zip(data.velocity, data.condition, data.block, data.order, sweeps, strict=True)
        for velocity, at, block, order, sweep in rows:
            key = tuple(sorted(data.conditions[at].items()))
            shifted = int(block) + above if block >= 0 else -1
            curve = tuple(each for each in key if each[0] != "drive.frequency")
            run = runs.setdefault((table, int(block), int(sweep), curve), len(runs))
            found.setdefault(key, []).append((float(velocity), shifted, float(order), run))
        above += int(data.block.max()) + 1
    ordered = sorted(found, key=_rank)
    trials = [(number, *trial) for number, key in enumerate(ordered) for trial in found[key]]
    columns = np.array(trials, dtype=float).reshape(-1, 5).T
    condition, velocity, block, order, run = np.ascontiguousarray(columns)
    condition, block, run = (each.astype(np.int64) for each in (condition, block, run))
    return [dict(key) for key in ordered], Trials(velocity, condition, block, order, run)


def _rank(key: tuple[tuple[str, Value], ...]) -> tuple[object, ...]:
    """Words first, then the field, then the frequency: neighbours lie on one curve."""
    words = tuple(value for _, value in key if isinstance(value, str))
    numbers = {name: float(value) for name, value in key if not isinstance(value, str)}
    frequency = numbers.pop("drive.frequency", 0.0)
    return (*words, *(numbers[name] for name in sorted(numbers)), frequency)
