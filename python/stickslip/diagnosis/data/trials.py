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
    indices of set-ups, -1 where one is not known; the order is NaN where it is not known.
    """

    value: Array
    condition: Indices
    block: Indices | None
    order: Array | None

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
        return Trials(self.value[rows], number[self.condition[rows]], block, order)


def pooled_velocities(tables: Sequence[VelocityData]) -> tuple[list[dict[str, Value]], Trials]:
    """All tables as one, m/s, with conditions in an order that does not depend on the rows'."""
    found: dict[tuple[tuple[str, Value], ...], list[tuple[float, int, float]]] = {}
    above = 0
    for data in tables:
        rows = zip(data.velocity, data.condition, data.block, data.order, strict=True)
        for velocity, at, block, order in rows:
            key = tuple(sorted(data.conditions[at].items()))
            shifted = int(block) + above if block >= 0 else -1
            found.setdefault(key, []).append((float(velocity), shifted, float(order)))
        above += int(data.block.max()) + 1
    ordered = sorted(found, key=_rank)
    trials = [(number, *trial) for number, key in enumerate(ordered) for trial in found[key]]
    columns = np.array(trials, dtype=float).reshape(-1, 4).T
    condition, velocity, block, order = np.ascontiguousarray(columns)
    indices = (condition.astype(np.int64), block.astype(np.int64))
    return [dict(key) for key in ordered], Trials(velocity, *indices, order)


def _rank(key: tuple[tuple[str, Value], ...]) -> tuple[object, ...]:
    """Words first, then the field, then the frequency: neighbours lie on one curve."""
    words = tuple(value for _, value in key if isinstance(value, str))
    numbers = {name: float(value) for name, value in key if not isinstance(value, str)}
    frequency = numbers.pop("drive.frequency", 0.0)
    return (*words, *(numbers[name] for name in sorted(numbers)), frequency)
