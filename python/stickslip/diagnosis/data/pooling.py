"""The tables of a measurement put together as the rows of one problem."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from stickslip.diagnosis.data.conditions import Conditions
from stickslip.diagnosis.inference.smooth_residual import Settings
from stickslip.diagnosis.observables import Observable
from stickslip.diagnosis.pipeline import AuxiliaryData
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import Value

Array = NDArray[np.float64]

_FEW = 8


def pooled_velocities(
    measurement: Measurement,
) -> tuple[list[dict[str, Value]], Array, NDArray[np.int64], NDArray[np.int64], Array]:
    """All tables as one, with conditions in an order that does not depend on the rows'."""
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
    return (
        [dict(key) for key in ordered],
        np.array([trial[1] for trial in trials]),
        np.array([trial[0] for trial in trials], dtype=np.int64),
        np.array([trial[2] for trial in trials], dtype=np.int64),
        np.array([trial[3] for trial in trials]),
    )


def _rank(key: tuple[tuple[str, Value], ...]) -> tuple[object, ...]:
    """Words first, then the field, then the frequency: neighbours lie on one curve."""
    words = tuple(value for _, value in key if isinstance(value, str))
    numbers = {name: float(value) for name, value in key if not isinstance(value, str)}
    frequency = numbers.pop("drive.frequency", 0.0)
    return (*words, *(numbers[name] for name in sorted(numbers)), frequency)


def pooled_observables(observables: Sequence[Observable]) -> AuxiliaryData | None:
    """Rows of all channels one after another."""
    if not observables:
        return None
    groups, above = [], 0
    for observable in observables:
        groups.append(observable.group + above)
        above += int(observable.group.max()) + 1
    return AuxiliaryData(
        np.concatenate([observable.observed for observable in observables]),
        np.asarray(block_diag(*(observable.covariance for observable in observables)), dtype=float),
        np.concatenate(groups),
    )


def smooth_settings(conditions: Conditions) -> Settings | None:
    """Where the conditions lie, if they are enough for a smooth function."""
    if len(conditions) < _FEW:
        return None
    keys = ("drive.frequency", "drive.peak", "drive.hold", "drive.base")
    numbers = np.array([[float(each[key]) for key in keys] for each in conditions])
    numbers[:, 0] = np.log(numbers[:, 0])
    words = [(each["drive.mode"], each["drive.direction"]) for each in conditions]
    number = {word: k for k, word in enumerate(dict.fromkeys(words))}
    return Settings(numbers, np.array([number[word] for word in words]))
