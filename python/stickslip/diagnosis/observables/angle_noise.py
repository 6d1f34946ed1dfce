"""How well an angle was read."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.observables.curve_noise import noise_of_curve
from stickslip.diagnosis.observables.repeats import ENOUGH, FEWEST, Repeats, widening

Array = NDArray[np.float64]

READING = math.radians(0.5)
"""Error of reading an angle off a picture, rad; no noise is taken as smaller. Chosen: a side of
250 um at one um a pixel has ends that are known to a pixel or two."""


@dataclass(frozen=True)
class Noise:
    """Noise of one reading.

    Attributes
    ----------
    sd : float
        Standard deviation as it is used, rad.
    notes : tuple of str
    """

    sd: float
    notes: tuple[str, ...]


def estimate(fields: Array, theta: Array, merged: Repeats) -> Noise:
    """Noise from repeats, else from how smoothly the angle follows the field.

    Parameters
    ----------
    fields : ndarray, shape (m, 2)
        T, in the order of `order_along`.
    theta : ndarray, shape (m,)
        Mean at each field, rad.
    merged : Repeats
    """
    smooth, free = noise_of_curve(fields, theta)
    if merged.dof >= ENOUGH or merged.dof >= max(free, FEWEST):
        sd, dof = merged.sd, float(merged.dof)
        origin = f"the scatter of readings at the same field ({merged.dof} degrees of freedom)"
    else:
        sd, dof = smooth, free
        origin = f"how smoothly theta follows the field (about {dof:.0f} degrees of freedom)"
    if dof < FEWEST:
        return Noise(READING, (f"the noise cannot be told from so few rows; {_taken()}",))
    factor = widening(len(theta), dof)
    if sd * factor <= READING:
        return Noise(READING, (f"noise from {origin} is below a reading's; {_taken()}",))
    return Noise(
        sd * factor,
        (
            f"noise of a reading from {origin}: {math.degrees(sd):.2f} degrees, taken as "
            f"{math.degrees(sd * factor):.2f} because so little tells it",
        ),
    )


def _taken() -> str:
    return f"{math.degrees(READING):.1f} degrees are taken"
