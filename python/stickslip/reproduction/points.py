"""Summaries of many simulations that differ in the keys which the study varies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip import _core
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.simulate import fraction_of
from stickslip.sweeping.points import encoded

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

Array = NDArray[np.float64]

KEYS = tuple(
    f"{section}.{name}"
    for section, names in {
        "drive": ("mode", "edge", "clamp", "base", "hold", "peak", "frequency", "pulses"),
        "contact": ("static_friction", "kinetic_friction", "adhesion"),
        "drag": ("linear", "rotational"),
        "robot": ("mass",),
    }.items()
    for name in names
)
"""Keys of a scenario that the study varies, in the order of a point's numbers."""

RTOL = 1e-6
"""Enough for mean velocities: an order below what shows in a figure."""


def point(keys: Mapping[str, Any]) -> Array:
    """The numbers of one point: the paper's values but for `keys`; shape (len(KEYS),)."""
    scenario = Scenario().replace(dict(keys))
    return np.concatenate([encoded(key, [scenario.get(key)]) for key in KEYS])


def column(key: str) -> int:
    """Where a key stands in a point."""
    return KEYS.index(key)


def evaluate(points: Array, threads: int, progress: Progress | None = None) -> dict[str, Any]:
    """Simulate all points, shape (..., len(KEYS)).

    Returns
    -------
    dict of numpy.ndarray, shape (...)
        Columns of the summary by name; NaN where a simulation failed.
    """
    flat = np.ascontiguousarray(points.reshape(-1, len(KEYS)))
    base = Scenario().replace({"solver.rtol": RTOL})
    pulses, frequency = flat[:, column("drive.pulses")], flat[:, column("drive.frequency")]
    report = fraction_of(float((base.drive.ramp + pulses / frequency).sum()), progress)
    columns, _ = _core.sweep(base.to_core(), list(KEYS), flat, threads, report)
    failed = columns["status"] != 0
    for values in columns.values():
        if values.dtype == np.float64:
            values[failed] = np.nan
    return {name: values.reshape(points.shape[:-1]) for name, values in columns.items()}


def evaluate_all(
    batches: Sequence[Array], threads: int, progress: Progress | None = None
) -> list[dict[str, Any]]:
    """`evaluate` several arrays of points in one go."""
    flat = [batch.reshape(-1, len(KEYS)) for batch in batches]
    columns = evaluate(np.concatenate(flat), threads, progress)
    ends = np.cumsum([len(each) for each in flat])[:-1]
    parts = {name: np.split(values, ends) for name, values in columns.items()}
    return [
        {name: part[k].reshape(batch.shape[:-1]) for name, part in parts.items()}
        for k, batch in enumerate(batches)
    ]


def variations(count: int) -> Array:
    """Evenly spread points in the cube from -1 to 1, shape (count, 3); the first is its centre.

    Roberts' additive recurrence with the plastic number of three dimensions: no random draw, so
    the study gives the same numbers each time.
    """
    ratio = 1.2207440846057596  # the real root of x^4 = x + 1
    steps = np.array([1.0 / ratio, 1.0 / ratio**2, 1.0 / ratio**3])
    return np.asarray(2.0 * np.mod(0.5 + np.arange(count)[:, np.newaxis] * steps, 1.0) - 1.0)


SPREAD = 0.02
"""Half width of the small changes of frequency, friction and field; a choice of this study."""

_CHANGED_TOGETHER = (
    ("drive.frequency",),
    ("contact.static_friction", "contact.kinetic_friction"),
    ("drive.peak", "drive.base", "drive.hold"),
)


def varied(points: Array, count: int) -> Array:
    """Copies of points with small changes; shape (..., len(KEYS)) becomes (..., count, len(KEYS)).

    Frequency, both friction coefficients together, and all fields together are each changed by up
    to `SPREAD` of themselves. The first copy is unchanged.
    """
    changes = 1.0 + SPREAD * variations(count)
    result = np.repeat(points[..., np.newaxis, :], count, axis=-2)
    for which, keys in enumerate(_CHANGED_TOGETHER):
        for key in keys:
            result[..., column(key)] *= changes[:, which]
    return result


def set_key(points: Array, key: str, values: ArrayLike) -> None:
    """Put values into the points' number for a key; `values` broadcasts against the points."""
    points[..., column(key)] = values
