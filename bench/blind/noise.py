"""Random errors of the readings, and what a camera does to positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from blind.kinds import Noise
from blind.readings import Readings
from blind.settings import (
    ANGLE_SD,
    FIELD_SD,
    FILM_SD,
    FLOOR,
    PULSES,
    SCATTER,
    TRIALS,
    Drive,
    curves,
)

Array = NDArray[np.float64]
Random = np.random.Generator

RESOLUTION = 0.2e-6  # m, of a position between pixels
_COUNTED = PULSES - 3  # the velocity is the mean over the pulses after the third


def correlated(draws: Array, correlation: float) -> Array:
    """First-order correlated errors along the first axis, of the variance of independent draws."""
    result = np.array(draws)
    for k in range(1, len(result)):
        result[k] = correlation * result[k - 1] + np.sqrt(1.0 - correlation**2) * draws[k]
    return result


def trials(
    level: Array, drives: list[Drive], noise: Noise, correlation: float, random: Random
) -> tuple[Array, NDArray[np.int64]]:
    """Trials of each velocity as a camera reads them, (drives, trials), and the set-up of each.

    Set-ups differ by half the noise, by a shift of one sign or by being faster or slower.
    """
    shape = (len(drives), TRIALS)
    draws = random.standard_normal(shape)
    setup = np.tile(np.arange(TRIALS), (len(drives), 1))
    if noise.t4:
        draws = random.standard_t(4, shape) / np.sqrt(2.0)
    for curve in curves(drives):
        draws[curve] = correlated(draws[curve], correlation)
    if noise.setups:
        sign = np.sign(level)[:, None] if random.random() < 0.5 else 1.0
        draws += 0.5 * random.standard_normal(TRIALS)[setup] * sign
    values = level[:, None] + np.hypot(SCATTER * level, FLOOR)[:, None] * draws
    if noise.outlier:
        values[random.integers(len(drives)), random.integers(TRIALS)] *= random.choice([0.5, 1.6])
    seconds = _COUNTED / np.array([float(drive["frequency"]) for drive in drives])[:, None]
    begin = random.uniform(0.0, 1e-4, shape)
    steps = np.round((begin + values * seconds) / RESOLUTION) - np.round(begin / RESOLUTION)
    return steps * RESOLUTION / seconds, setup


def noisy_tables(level: Readings, correlation: float, random: Random) -> Readings:
    """Angles, fields and films with errors; velocities as they are."""
    films = []
    for film in level.films:
        # Each camera is turned a little, and the origin of its pixels is nobody's.
        turned = np.radians(0.5) * random.standard_normal()
        seen = {"t": film["t"], "x": film["x"] + 1e-4, "theta": film["theta"] + turned}
        for name, sd in FILM_SD.items():
            draws = random.standard_normal(len(film["t"]))
            seen[name] = seen[name] + sd * correlated(draws, correlation)
        films.append(seen)
    return Readings(
        level.velocity,
        level.angle + ANGLE_SD * random.standard_normal(level.angle.shape),
        level.field + FIELD_SD * random.standard_normal(level.field.shape),
        tuple(films),
    )
