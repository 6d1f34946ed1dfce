"""Summaries of many simulations that differ in the keys which the study varies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip import _core
from stickslip.scenario.scenario import Scenario

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

Array = NDArray[np.float64]

KEYS = (
    "drive.mode",
    "drive.edge",
    "drive.clamp",
    "drive.base",
    "drive.hold",
    "drive.peak",
    "drive.frequency",
    "drive.pulses",
    "contact.static_friction",
    "contact.kinetic_friction",
    "contact.adhesion",
    "drag.linear",
    "drag.rotational",
    "robot.mass",
)
"""Keys of a scenario that the study varies, in the order of a point's numbers."""

RTOL = 1e-6
"""Enough for mean velocities: an order below what shows in a figure."""


def point(keys: Mapping[str, Any]) -> Array:
    """The numbers of one point: the paper's values but for `keys`; shape (len(KEYS),)."""
    scenario = Scenario().replace(dict(keys))
    words = {choice["key"]: choice["allowed"] for choice in _core.choices()}
    numbers = []
    for key in KEYS:
        value = scenario.get(key)
        numbers.append(words[key].index(str(value)) if key in words else float(value))
    return np.array(numbers, dtype=np.float64)


def column(key: str) -> int:
    """Where a key stands in a point."""
    return KEYS.index(key)


def evaluate(points: Array, threads: int, progress: Progress | None = None) -> dict[str, Any]:
    """Simulate all points.

    Parameters
    ----------
    points : numpy.ndarray, shape (..., len(KEYS))
    threads : int
    progress : callable, optional
        Called with the fraction of the simulated time that is done.

    Returns
    -------
    dict of numpy.ndarray, shape (...)
        Columns of the summary by name; NaN where a simulation failed.
    """
    flat = np.ascontiguousarray(points.reshape(-1, len(KEYS)))
    base = Scenario().replace({"solver.rtol": RTOL})
    report = None
    if progress is not None:
        duration = (
            base.drive.ramp + flat[:, column("drive.pulses")] / (flat[:, column("drive.frequency")])
        )
        total = float(duration.sum())

        def report(simulated: float) -> object:
            return progress(min(simulated / total, 1.0) if total > 0.0 else 1.0)

    columns, _ = _core.sweep(base.to_core(), list(KEYS), flat, threads, report)
    shape = points.shape[:-1]
    failed = columns["status"] != 0
    result: dict[str, Any] = {}
    for name, values in columns.items():
        if values.dtype == np.float64:
            values[failed] = np.nan
        result[name] = values.reshape(shape)
    return result


def evaluate_all(
    batches: Sequence[Array], threads: int, progress: Progress | None = None
) -> list[dict[str, Any]]:
    """`evaluate` several arrays of points in one go."""
    columns = evaluate(
        np.concatenate([batch.reshape(-1, len(KEYS)) for batch in batches]), threads, progress
    )
    results = []
    start = 0
    for batch in batches:
        stop = start + batch.size // len(KEYS)
        parts = {name: values[start:stop] for name, values in columns.items()}
        results.append({name: part.reshape(batch.shape[:-1]) for name, part in parts.items()})
        start = stop
    return results


def variations(count: int) -> Array:
    """Evenly spread points in the cube from -1 to 1, shape (count, 3); the first is its centre.

    Roberts' additive recurrence with the plastic number of three dimensions: no random draw, so
    the study gives the same numbers each time.
    """
    ratio = 1.2207440846057596  # the real root of x^4 = x + 1
    steps = np.array([1.0 / ratio, 1.0 / ratio**2, 1.0 / ratio**3])
    return np.asarray(2.0 * np.mod(0.5 + np.arange(count)[:, np.newaxis] * steps, 1.0) - 1.0)


SPREAD = 0.02
"""Half width of the small changes of frequency, friction and field."""


def varied(points: Array, count: int, spread: float = SPREAD) -> Array:
    """Copies of points with small changes; shape (..., len(KEYS)) becomes (..., count, len(KEYS)).

    Frequency, both friction coefficients together, and all fields together are each changed by up
    to `spread` of themselves. The first copy is unchanged.
    """
    changes = 1.0 + spread * variations(count)
    result = np.repeat(points[..., np.newaxis, :], count, axis=-2)
    for which, keys in enumerate(
        (
            ("drive.frequency",),
            ("contact.static_friction", "contact.kinetic_friction"),
            ("drive.peak", "drive.base", "drive.hold"),
        )
    ):
        for key in keys:
            result[..., column(key)] *= changes[:, which]
    return result


def set_key(points: Array, key: str, values: ArrayLike) -> None:
    """Put values into the points' number for a key; `values` broadcasts against the points."""
    points[..., column(key)] = values
