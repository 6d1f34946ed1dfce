"""How well an angle was read."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.observables.curve_noise import noise_of_curve
from stickslip.diagnosis.observables.repeats import ENOUGH, FEWEST, Repeats, widening
from stickslip.facts import Code, Fact

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
    note : Fact
        How it was found.
    """

    sd: float
    note: Fact


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
        sd, dof, origin = merged.sd, float(merged.dof), "repeats"
    else:
        sd, dof, origin = smooth, free, "smoothness"
    told = {"origin": origin, "dof": dof, "taken": READING, "unit": "rad"}
    if dof < FEWEST:
        return Noise(READING, Fact(Code.READING_NOISE_UNKNOWN, {**told, "needed": FEWEST}))
    wide = sd * widening(len(theta), dof)
    if wide <= READING:
        return Noise(READING, Fact(Code.READING_NOISE_SMALL, told))
    return Noise(wide, Fact(Code.READING_NOISE, {**told, "sd": sd, "taken": wide}))
