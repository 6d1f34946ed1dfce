"""Numbers as a user's file has them, and as they stand in messages."""

from __future__ import annotations

from decimal import ROUND_FLOOR, Context
from typing import TypeGuard


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value of a TOML file is a number; True and False are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def highest(limit: float) -> str:
    """A computed limit in six digits and not above it, so that what is printed is allowed."""
    below = Context(prec=6, rounding=ROUND_FLOOR).create_decimal(repr(float(limit)))
    return f"{float(below):.6g}"
