"""The tables of a measurement put together as the rows of one problem."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import Value

Array = NDArray[np.float64]


def pooled_velocities(
    measurement: Measurement,
) -> tuple[list[dict[str, Value]], Array, NDArray[np.int64], NDArray[np.int64], Array]:
    """All tables as one, with conditions in an order that does not depend on the rows'.

    The conditions and, of each trial, velocity (m/s), condition, set-up (-1 if unknown) and order.
    """
    found: dict[tuple[tuple[str, Value], ...], list[tuple[float, int, float]]] = {}
    above = 0
    for data in measurement.velocity:
        rows = zip(data.velocity, data.condition, data.block, data.order, strict=True)
        for velocity, at, block, order in rows:
            key = tuple(sorted(data.conditions[at].items()))
            shifted = int(block) + above if block >= 0 else -1
            found.setdefault(key, []).append((float(velocity), shifted, float(order)))
        above += int(data.block.max()) + 1
    ordered = sorted(found, key=_rank)
    trials = [(number, *trial) for number, key in enumerate(ordered) for trial in found[key]]
    columns = np.array(trials, dtype=float).reshape(-1, 4).T
    condition, velocity, setup, place = np.ascontiguousarray(columns)
    conditions = [dict(key) for key in ordered]
    return conditions, velocity, condition.astype(np.int64), setup.astype(np.int64), place


def _rank(key: tuple[tuple[str, Value], ...]) -> tuple[object, ...]:
    """Words first, then the field, then the frequency: neighbours lie on one curve."""
    words = tuple(value for _, value in key if isinstance(value, str))
    numbers = {name: float(value) for name, value in key if not isinstance(value, str)}
    frequency = numbers.pop("drive.frequency", 0.0)
    return (*words, *(numbers[name] for name in sorted(numbers)), frequency)
