"""The noise of a curve without repeats, from how smooth it is."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from stickslip._util.root_mean_square import root_mean_square
from stickslip.measurement.outliers import free_of_bends

Array = NDArray[np.float64]

# Differences of neighbours share readings: the sum of their squares varies as that of this part of
# them would if they were independent, 1 / (1 + 2 (4/6)^2 + 2 (1/6)^2).
_INDEPENDENT = 0.51


def order_along(settings: Array) -> NDArray[np.int64]:
    """Order of rows in which the settings change in the smallest steps.

    Parameters
    ----------
    settings : ndarray, shape (m, 2)

    Returns
    -------
    ndarray of int, shape (m,)
        By the first column within the second, the second within the first, by direction or by
        size, whichever has the shortest way from row to row.
    """
    first, second = settings.T
    turn = np.arctan2(second, first)
    size = np.hypot(first, second)
    orders = [
        np.lexsort((second, first)),
        np.lexsort((first, second)),
        np.lexsort((size, turn)),
        np.lexsort((turn, size)),
    ]
    lengths = [float(np.sum(_steps(settings[order]))) for order in orders]
    return np.asarray(orders[int(np.argmin(lengths))], dtype=np.int64)


def _steps(settings: Array) -> Array:
    return np.asarray(np.hypot(*np.diff(settings, axis=0).T))


def curvature(settings: Array, values: Array) -> tuple[Array, Array]:
    """Distance of each inner row from the line through its neighbours.

    Parameters
    ----------
    settings : ndarray, shape (m, 2)
        In the order of `order_along`, no two alike in a row.
    values : ndarray, shape (m,)

    Returns
    -------
    distance : ndarray, shape (m - 2,)
        In units in which its standard deviation is that of a value, if the curve is straight.
    slope : ndarray, shape (m - 2,)
        Difference of the two neighbours.
    """
    steps = _steps(settings)
    share = steps[:-1] / (steps[:-1] + steps[1:])
    line = (1.0 - share) * values[:-2] + share * values[2:]
    size = np.sqrt(1.0 + (1.0 - share) ** 2 + share**2)
    return (values[1:-1] - line) / size, values[2:] - values[:-2]


def noise_of_curve(settings: Array, values: Array) -> tuple[float, float]:
    """Standard deviation of a value and its degrees of freedom; NaN and 0 where nothing is known.

    Parameters
    ----------
    settings, values
        As for `curvature`.
    """
    if len(values) < 3:
        return math.nan, 0.0
    distance, slope = curvature(settings, values)
    # A stretch where nothing moves says nothing of the noise where something does.
    moving = (distance != 0.0) | (slope != 0.0)
    distance = distance[moving]
    if len(distance) < 3:
        return math.nan, 0.0
    kept = distance[free_of_bends(distance)]
    return root_mean_square(kept), _INDEPENDENT * len(kept)
