"""Numbers as a user's file has them, and as they stand in messages."""

from __future__ import annotations

import math
from decimal import ROUND_FLOOR, Context
from typing import TypeGuard


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value of a TOML file is a number; True and False are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def number(cell: str, below: float = math.inf) -> float:
    """The number of a cell of a table; NaN where it is none, or its size is not below a limit."""
    try:
        value = float(cell)
    except ValueError:
        return math.nan
    # Python reads 1_000 as a number; no laboratory writes it.
    return value if abs(value) < below and "_" not in cell else math.nan


def comma_hint(cell: str) -> str:
    """What to do about a comma in a cell that is no number; "" for a cell without one."""
    hint = "; write numbers with a decimal point and without separators of thousands"
    return hint if "," in cell else ""


def highest(limit: float) -> str:
    """A computed limit in six digits and not above it, so that what is printed is allowed."""
    below = Context(prec=6, rounding=ROUND_FLOOR).create_decimal(repr(float(limit)))
    return f"{float(below):.6g}"


def alike(step: float, *values: float) -> list[str]:
    """Numbers to the second digit of a step, all to the same place, so that they keep their order.

    So a value that lies in an interval is printed within it.
    """
    if not (math.isfinite(step) and step > 0.0):
        return [f"{each:.6g}" for each in values]
    places = 1 - math.floor(math.log10(step))
    return [f"{round(each, places) + 0.0:.12g}" for each in values]
