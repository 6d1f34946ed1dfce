"""How well a probe reads a field, and which of its rows are no readings of it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.observables.repeats import ENOUGH, FEWEST, Repeats, widening
from stickslip.facts import Code, Fact

Array = NDArray[np.float64]

READING = 5e-7
"""Smallest error of a probe's reading that is believed, T."""

RELATIVE = 1e-3
"""The same relative to the field's root mean square: placing and turning a probe is no better."""

_FAR = 8.0
_FEW = 0.05


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
    near = np.ones(len(fields), dtype=bool)
    floor = floor_of(fields)
    # One by one, as the worst drags the fit of all others along.
    for _ in range(int(_FEW * len(fields)) + 1):
        left, dof = free_fit(shares[near], fields[near])
        if dof < FEWEST:
            break
        size = np.max(np.abs(left), axis=1)
        if np.max(size) <= _FAR * max(1.48 * float(np.median(np.abs(left))), floor):
            return np.asarray(~near)
        near[np.flatnonzero(near)[np.argmax(size)]] = False
    return np.zeros(len(fields), dtype=bool)


def floor_of(fields: Array) -> float:
    """Error of a reading below which none is taken, T."""
    return max(READING, RELATIVE * math.sqrt(float(np.mean(fields**2))))


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
