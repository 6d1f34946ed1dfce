"""How well a probe reads a field, and which of its rows are no readings of it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from stickslip._util.root_mean_square import root_mean_square
from stickslip.diagnosis.observables.repeats import ENOUGH, FEWEST, Repeats, widening
from stickslip.facts import Code, Fact
from stickslip.measurement.outliers import far_from_a_fit

Array = NDArray[np.float64]

READING = 5e-7
"""Smallest error of a probe's reading that is believed, T. Chosen: 1 % of the Earth's field."""

RELATIVE = 1e-3
"""The same relative to the field's root mean square. Chosen: a probe is placed to 0.1 mm and turned
to 2 degrees at the best, which is some 1e-3 each."""


def free_fit(shares: Array, fields: Array) -> tuple[Array, int]:
    """What a free gain of each coil that has current and a free uniform field leave over.

    Parameters
    ----------
    shares : ndarray, shape (n, 5, 3)
        Field of each coil, T.
    fields : ndarray, shape (n, 3)
        T.

    Returns
    -------
    left : ndarray, shape (n, 3)
    dof : int
        Its degrees of freedom.
    """
    driven = np.any(shares != 0.0, axis=(0, 2))
    gains = np.moveaxis(shares[:, driven], 1, 2).reshape(-1, int(driven.sum()))
    design = np.hstack([gains, np.tile(np.eye(3), (len(fields), 1))])
    solution, _, rank, _ = np.linalg.lstsq(design, fields.reshape(-1), rcond=None)
    left = fields - (design @ solution).reshape(-1, 3)
    return left, fields.size - int(rank)


def far_rows(shares: Array, fields: Array) -> NDArray[np.bool_]:
    """Rows that no gain and no uniform field bring near the others, if they are few."""

    def left_by(rows: NDArray[np.bool_]) -> Array | None:
        left, dof = free_fit(shares[rows], fields[rows])
        return None if dof < FEWEST else left

    return far_from_a_fit(left_by, len(fields), floor_of(fields))


def floor_of(fields: Array) -> float:
    """Error of a reading below which none is taken, T."""
    return max(READING, RELATIVE * root_mean_square(fields))


def estimate(shares: Array, merged: Repeats) -> tuple[float, Fact]:
    """Standard deviation of one reading as it is used, T, and how it was found.

    Parameters
    ----------
    shares : ndarray, shape (m, 5, 3)
        Field of each coil at each condition, T.
    merged : Repeats
    """
    floor = floor_of(merged.mean)
    left, dof = free_fit(shares, merged.mean)
    sd = math.sqrt(float(np.sum(left**2)) / dof) if dof else math.nan
    origin = "free-fit"
    if merged.dof >= ENOUGH or merged.dof >= max(dof, FEWEST):
        sd, dof, origin = merged.sd, merged.dof, "repeats"
    told = {"origin": origin, "dof": dof, "taken": floor, "unit": "T"}
    if dof < FEWEST:
        return floor, Fact(Code.READING_NOISE_UNKNOWN, {**told, "needed": FEWEST})
    wide = sd * widening(merged.mean.size, dof)
    if wide <= floor:
        return floor, Fact(Code.READING_NOISE_SMALL, told)
    return wide, Fact(Code.READING_NOISE, {**told, "sd": sd, "taken": wide})
