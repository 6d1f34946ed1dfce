"""Voltages that drive a robot along a heading."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _core
from stickslip._util.arrays import Array, numbers
from stickslip.errors import ScenarioError


def heading_voltages(heading: ArrayLike, along: ArrayLike, clamp: ArrayLike) -> Array:
    """Convert a heading into voltages of the coils xp, xm, yp, ym and clamp, V, shape (..., 5).

    Of each axis the coil that lies ahead makes its part of the field along the surface, as a drive
    with ``coils = "single"`` does, so that the robot is pulled the way it faces. The coils are
    taken as equal.

    Parameters
    ----------
    heading : array_like
        From +x to the left, rad.
    along, clamp : array_like
        Of a coil on the axis, if the robot headed along it, and of the clamp coil, V.

    Raises
    ------
    ScenarioError
        If one of these is not finite, or if their shapes do not broadcast.
    """
    given = [
        numbers("heading", heading, "finite numbers of rad"),
        numbers("along", along, "finite numbers of V"),
        numbers("clamp", clamp, "finite numbers of V"),
    ]
    try:
        ahead, strength, held = np.broadcast_arrays(*given)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in given)
        raise ScenarioError(
            f"heading, along and clamp of shapes {shapes}: allowed are shapes that broadcast"
        ) from None
    # Exact along the axes, where the coils across are to stay off.
    towards_x, towards_y = _core.surface_directions(ahead)
    x, y = strength * towards_x, strength * towards_y
    parts = [np.maximum(x, 0.0), np.minimum(x, 0.0), np.maximum(y, 0.0), np.minimum(y, 0.0), held]
    return np.stack(parts, axis=-1)
