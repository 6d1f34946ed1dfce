"""Checks of numbers that all modules of this package take."""

from __future__ import annotations

import math
import numbers

import numpy as np

from stickslip._util.messages import refuse
from stickslip._util.numbers import Array


def check_above_zero(name: str, value: object, unit: str) -> None:
    """Refuse what is not a finite number above 0."""
    is_real = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not (is_real and 0.0 < float(value) < math.inf):  # type: ignore[arg-type]
        refuse(name, value, f"a finite number of {unit} above 0")


def numbers_of(name: str, values: object, allowed: str) -> Array:
    """The finite numbers that the values are, in whatever shape; else refuse them."""
    try:
        given = np.asarray(values)
    except ValueError:  # rows of several lengths
        refuse(name, values, allowed)
    if given.dtype.kind not in "iuf" or not np.isfinite(given).all():
        refuse(name, values, allowed)
    return given.astype(float)
