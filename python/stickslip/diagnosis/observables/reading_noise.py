"""The noise of a reading of a table: from repeats, or from a fit or a smooth curve without them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2 as chi2_law
from scipy.stats import f as f_law

from stickslip._util.arrays import Array, Indices
from stickslip._util.one_line import OneLine
from stickslip._util.root_mean_square import root_mean_square
from stickslip.facts import Code, Fact
from stickslip.measurement.outliers import free_of_bends

FEWEST = 4
"""Degrees of freedom from which on a scatter is taken as the noise. Chosen: four determine it to
35 %, and fewer would be widened by more than a factor of two."""

ENOUGH = 12
"""Degrees of freedom from which on repeats need no comparison with another estimate. Chosen:
twelve determine it to 20 %."""

_LEVEL = 0.975
"""At which the two tests of `widening` agree. Chosen: nearer to the verdict's levels than the
median."""

_INDEPENDENT = 0.51
"""Differences of neighbours share readings: the sum of their squares varies as that of this part of
them would if they were independent, 1 / (1 + 2 (4/6)^2 + 2 (1/6)^2)."""


@dataclass(frozen=True, repr=False, eq=False)
class Repeats(OneLine):
    """Means of the rows with the same settings, which are in ascending order.

    `settings` has shape (m, columns), `mean` (m, observables) and `count`, the rows of each, (m,).
    `sd` is that of one reading, pooled over all conditions with `dof` degrees of freedom; NaN where
    there are none.
    """

    settings: Array
    mean: Array
    count: Indices
    sd: float
    dof: int


def merge(settings: Array, values: Array) -> Repeats:
    """Merge rows with the same settings; all columns of `values` share one standard deviation."""
    unique, index = np.unique(settings, axis=0, return_inverse=True)
    index = index.reshape(-1)
    count = np.bincount(index)
    mean = np.stack([np.bincount(index, column) / count for column in values.T], axis=1)
    dof = (len(values) - len(unique)) * values.shape[1]
    sd = math.sqrt(float(np.sum((values - mean[index]) ** 2)) / dof) if dof else math.nan
    return Repeats(unique, mean, count.astype(np.int64), sd, dof)


def reading_noise(
    merged: Repeats, origin: str, sd: float, dof: float, smallest: float, unit: str
) -> tuple[float, Fact]:
    """Standard deviation of one reading as it is used, and how it was found.

    From repeats, unless `origin`, another estimate with `sd` and `dof`, has more degrees of freedom
    and repeats have few. An error below `smallest` is not believed.
    """
    if merged.dof >= ENOUGH or merged.dof >= max(dof, FEWEST):
        # Of the other estimate's type, so that a table always reports the same kind of number.
        origin, sd, dof = "repeats", merged.sd, type(dof)(merged.dof)
    told = {"origin": origin, "dof": dof, "taken": smallest, "unit": unit}
    if dof < FEWEST:
        return smallest, Fact(Code.READING_NOISE_UNKNOWN, {**told, "needed": FEWEST})
    wide = sd * widening(merged.mean.size, dof)
    if wide <= smallest:
        return smallest, Fact(Code.READING_NOISE_SMALL, told)
    return wide, Fact(Code.READING_NOISE, {**told, "sd": sd, "taken": wide})


def widening(count: int, dof: float) -> float:
    """Factor by which an estimated standard deviation is widened before it is used as known.

    With it a chi-square test of `count` observables has the size of the F test that the degrees of
    freedom of the estimate ask for.
    """
    if not math.isfinite(dof):
        return 1.0
    chi2 = float(chi2_law.ppf(_LEVEL, count)) / count
    return math.sqrt(float(f_law.ppf(_LEVEL, count, max(dof, 1.0))) / chi2)


def order_along(settings: Array) -> Indices:
    """Order of rows, shape (m, 2), in which the settings change in the smallest steps.

    By the first column within the second, the second within the first, by direction or by size,
    whichever has the shortest way from row to row.
    """
    first, second = settings.T
    turn, size = np.arctan2(second, first), np.hypot(first, second)
    keys = ((second, first), (first, second), (size, turn), (turn, size))
    orders = [np.lexsort(each) for each in keys]
    lengths = [float(np.sum(_steps(settings[order]))) for order in orders]
    return np.asarray(orders[int(np.argmin(lengths))], dtype=np.int64)


def _steps(settings: Array) -> Array:
    return np.asarray(np.hypot(*np.diff(settings, axis=0).T))


def curvature(settings: Array, values: Array) -> tuple[Array, Array]:
    """Distance of each inner row from the line through its neighbours, and their difference.

    Both have shape (m - 2,). `settings`, shape (m, 2), are in the order of `order_along`, no two
    alike in a row. The distance is scaled to the standard deviation of a value, if the curve is
    straight.
    """
    steps = _steps(settings)
    share = steps[:-1] / (steps[:-1] + steps[1:])
    line = (1.0 - share) * values[:-2] + share * values[2:]
    size = np.sqrt(1.0 + (1.0 - share) ** 2 + share**2)
    return (values[1:-1] - line) / size, values[2:] - values[:-2]


def noise_of_curve(settings: Array, values: Array) -> tuple[float, float]:
    """Standard deviation of a value and its degrees of freedom, of arguments as for `curvature`.

    NaN and 0 where nothing is known.
    """
    if len(values) < 3:
        return math.nan, 0.0
    distance, slope = curvature(settings, values)
    # Where the curve is exactly flat it says nothing of the noise where it changes.
    distance = distance[(distance != 0.0) | (slope != 0.0)]
    if len(distance) < 3:
        return math.nan, 0.0
    kept = distance[free_of_bends(distance)]
    return root_mean_square(kept), _INDEPENDENT * len(kept)
