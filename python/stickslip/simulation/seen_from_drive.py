"""Mean velocities relative to the drive: along its heading, and to its left."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.simulation.quantities import Column

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike, NDArray

    from stickslip._util.arrays import Array

ALONG, ACROSS = "velocity_along", "velocity_across"

VELOCITIES = {
    ALONG: Column("m/s", "mean velocity along the heading of the drive, measuring window"),
    ACROSS: Column("m/s", "the same to the left of the heading"),
}
"""The velocities of a robot that a pulsed drive moves in the whole plane."""

FROM_DRIVE = {ALONG: "along the heading", ACROSS: "to its left"}
FROM_AXES = {"mean_velocity": "along x", "mean_velocity_y": "along y"}
IN_ONE_PLANE = {"mean_velocity": ""}
"""Names of the velocities that describe a motion, the main one first, with their directions.

`FROM_AXES` are those of a program, which has no heading.
"""


def seen_from_drive(
    x: ArrayLike,
    y: ArrayLike,
    kind: NDArray[Any] | str,
    direction: NDArray[Any] | str,
    heading: ArrayLike,
) -> tuple[Array, Array]:
    """Velocities along the heading of the drive and to its left, m/s.

    Parameters
    ----------
    x, y : array_like
        Velocities along x and y, m/s.
    kind, direction, heading : array_like
        Of the drive, see `Drive`; of a program, +x counts as its heading.
    """
    program = np.equal(kind, "program")
    sign = np.where(np.equal(direction, "-x") & ~program, -1.0, 1.0)
    angle = np.where(program, 0.0, heading)
    cosine, sine = sign * np.cos(angle), sign * np.sin(angle)
    return np.asarray(cosine * x + sine * y), np.asarray(cosine * y - sine * x)


def shown_velocities(data: xarray.Dataset) -> dict[str, str]:
    """The velocities that describe the motions of a sweep or a prediction, like `FROM_DRIVE`."""
    if ALONG in data:
        return FROM_DRIVE
    across = data["mean_velocity_y"].values if "mean_velocity_y" in data else np.zeros(1)
    return FROM_AXES if np.nan_to_num(across).any() else IN_ONE_PLANE
