"""The size of many numbers in one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def root_mean_square(values: ArrayLike) -> float:
    """Of all numbers of an array, in their unit."""
    return float(np.sqrt(np.mean(np.square(values))))
