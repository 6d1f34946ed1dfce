"""Numbers as they stand in messages."""

from __future__ import annotations

from decimal import ROUND_FLOOR, Context


def highest(limit: float) -> str:
    """A computed limit in six digits and not above it, so that what is printed is allowed."""
    below = Context(prec=6, rounding=ROUND_FLOOR).create_decimal(repr(float(limit)))
    return f"{float(below):.6g}"
