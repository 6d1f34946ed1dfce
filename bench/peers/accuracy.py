"""Velocity errors, and which tolerance of stickslip makes none larger than a peer's."""

from __future__ import annotations

import numpy as np


def rms_error(velocities: list[float], exact: np.ndarray) -> float:
    """Root mean square of the relative errors."""
    return float(np.sqrt(np.mean((np.array(velocities) / exact - 1.0) ** 2)))


def tolerance_within(error: float, own_errors: dict[float, float]) -> float:
    """The loosest tolerance of stickslip whose error, and that of all tighter ones, is within."""
    chosen = None
    for rtol, own in sorted(own_errors.items()):
        if own > error:
            break
        chosen = rtol
    if chosen is None:
        raise RuntimeError(f"no tolerance of stickslip reaches a velocity error of {error:.1e}")
    return chosen
