"""Root mean square."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def root_mean_square(values: ArrayLike) -> float:
    """Root mean square of all numbers of an array, in their unit."""
    return float(np.sqrt(np.mean(np.square(values))))
