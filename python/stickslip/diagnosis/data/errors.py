"""The errors of readings: one model, estimated by restricted likelihood."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from stickslip._util.arrays import Array, Indices
from stickslip._util.one_line import OneLine
from stickslip.simulation.note import Note


@dataclass(frozen=True, repr=False, eq=False)
class Errors(OneLine):
    """Errors of the mean of each condition.

    Attributes
    ----------
    sd : ndarray, shape (m,)
        Standard deviation of each mean.
    covariance : ndarray, shape (m, m), or None
        Of the means; None where they are independent.
    dof : float
        Degrees of freedom of their size; infinity where it was stated.
    told : dict
        What is reported of them: ``s0``, ``rho``, ``phi``, ``shift``, ``gain``.
    notes : tuple of Note
    """

    sd: Array
    covariance: Array | None = None
    dof: float = math.inf
    told: dict[str, float] = field(default_factory=dict)
    notes: tuple[Note, ...] = ()

    def at(self, level: Array) -> Errors:
        """The same where errors that conditions share follow another level, shape (m,)."""
        del level
        return self

    def of_reading(self, level: Array) -> Array:
        """Standard deviation of one reading at levels, shape (k,)."""
        return np.full(len(level), float(np.median(self.sd)))


def estimate(
    y: Array,
    condition: Indices,
    *,
    sd: Array | None = None,
    relative: float = math.nan,
    run: Indices | None = None,
    place: Array | None = None,
    setup: Indices | None = None,
    seed: int = 0,
) -> tuple[Array, Errors]:
    """Means of the conditions, shape (m,), and their errors."""
    count = np.bincount(condition).astype(float)
    mean = np.bincount(condition, y) / count
    if sd is not None:
        return mean, Errors(np.sqrt(np.bincount(condition, sd**2)) / count)
    spread = math.sqrt(float(np.sum((y - mean[condition]) ** 2)) / max(len(y) - len(mean), 1))
    return mean, Errors(spread / np.sqrt(count), dof=float(len(y) - len(mean)))
