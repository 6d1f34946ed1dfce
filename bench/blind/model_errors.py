"""Errors of a model that is right in the main: changes of the velocity that have no cause.

They belong to the robot: every trial has the same ones, and so has a repeat on another day.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from blind.settings import Drive

Array = NDArray[np.float64]

_WAVES = 24  # of a smooth function
_LENGTH = 1.2  # over which it changes, in the units of its arguments
_GRID = np.linspace(np.log(5.0), np.log(300.0), 400)  # log(f / 1 Hz)
_ALONG = 0.6  # of log f, over which a correlated error changes: 0.25 to 1 in the study's curves


def _smooth(drives: Sequence[Drive], number: int) -> Array:
    """A function of log frequency, peak, hold and mode, drawn from a normal process."""
    random = np.random.default_rng([number, 1])
    places = np.array(
        [
            [
                np.log(float(each["frequency"]) / 50.0) / 0.5,
                (float(each["peak"]) - 2.3e-3) / 0.5e-3,
                (float(each["hold"]) - 1e-3) / 0.5e-3,
                0.5 if each["mode"] == "OPP" else -0.5,
            ]
            for each in drives
        ]
    )
    waves = random.standard_normal((places.shape[1], _WAVES)) / _LENGTH
    phases = random.uniform(0.0, 2.0 * np.pi, _WAVES)
    return np.asarray(np.sqrt(2.0 / _WAVES) * np.cos(places @ waves + phases).sum(axis=1))


def _correlated(drives: Sequence[Drive], number: int) -> Array:
    """First-order correlated along the frequencies of a curve, independent between curves."""
    result = []
    decay = np.exp(-(_GRID[1] - _GRID[0]) / _ALONG)
    for each in drives:
        others = sorted((key, value) for key, value in each.items() if key != "frequency")
        random = np.random.default_rng([number, 2, zlib.crc32(repr(others).encode())])
        path = random.standard_normal(len(_GRID))
        for k in range(1, len(path)):
            path[k] = decay * path[k - 1] + np.sqrt(1.0 - decay**2) * path[k]
        result.append(np.interp(np.log(float(each["frequency"])), _GRID, path))
    return np.array(result)


MODEL_ERRORS = {"smooth_error": _smooth, "correlated_error": _correlated}
"""Changes of the velocity at drives, of a size of about 1, by a number that was drawn."""
