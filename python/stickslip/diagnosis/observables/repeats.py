"""Rows of a table with the same settings are one condition, measured several times."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2 as chi2_law
from scipy.stats import f as f_law

from stickslip._util.one_line import OneLine

Array = NDArray[np.float64]

FEWEST = 4
"""Degrees of freedom from which on a scatter is taken as the noise. Chosen: four tell it to 35 %,
and fewer would be widened by more than a factor of two."""

ENOUGH = 12
"""Degrees of freedom from which on repeats need no comparison with another estimate. Chosen:
twelve tell it to 20 %."""

_LEVEL = 0.975
"""At which the two tests agree. Chosen: nearer to the verdict's levels than the median."""


@dataclass(frozen=True, repr=False)
class Repeats(OneLine):
    """Means of the rows with the same settings.

    Attributes
    ----------
    settings : ndarray, shape (m, columns)
        In ascending order, the first column first.
    mean : ndarray, shape (m, observables)
    count : ndarray of int, shape (m,)
        Rows of each.
    sd : float
        Of one reading, pooled over all conditions; NaN without degrees of freedom.
    dof : int
        Degrees of freedom of `sd`.
    """

    settings: Array
    mean: Array
    count: NDArray[np.int64]
    sd: float
    dof: int


def merge(settings: Array, values: Array) -> Repeats:
    """Merge rows with the same settings.

    Parameters
    ----------
    settings : ndarray, shape (n, columns)
    values : ndarray, shape (n, observables)
        In one unit, so that they share a standard deviation.
    """
    unique, index = np.unique(settings, axis=0, return_inverse=True)
    index = index.reshape(-1)
    count = np.bincount(index)
    mean = np.stack([np.bincount(index, column) / count for column in values.T], axis=1)
    dof = (len(values) - len(unique)) * values.shape[1]
    sd = math.sqrt(float(np.sum((values - mean[index]) ** 2)) / dof) if dof else math.nan
    return Repeats(unique, mean, count.astype(np.int64), sd, dof)


def widening(count: int, dof: float) -> float:
    """Factor by which an estimated standard deviation is widened, for what is made of it as known.

    With it a chi-square test of `count` observables has the size of the F test that the degrees of
    freedom of the estimate ask for.
    """
    if not math.isfinite(dof):
        return 1.0
    chi2 = float(chi2_law.ppf(_LEVEL, count)) / count
    return math.sqrt(float(f_law.ppf(_LEVEL, count, max(dof, 1.0))) / chi2)
