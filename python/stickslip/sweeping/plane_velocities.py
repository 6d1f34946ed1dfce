"""Velocities along the headings of a sweep's points."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stickslip._util.numbers import Array
from stickslip.simulation.seen_from_drive import VELOCITIES, seen_from_drive
from stickslip.sweeping.points import Points


def plane_velocities(points: Points, numbers: Mapping[str, Array]) -> dict[str, Array]:
    """`VELOCITIES` of all points, shape (n,), m/s; {} where they say no more than `numbers`.

    So it is where no robot went across x, and where every drive is a program, which has no heading.
    """
    x, y = numbers["mean_velocity"], numbers["mean_velocity_y"]
    mode = points.at_each("drive.mode")
    if not np.nan_to_num(y).any() or np.all(mode == "program"):
        return {}
    drive = mode, points.at_each("drive.direction"), points.at_each("drive.heading")
    return dict(zip(VELOCITIES, seen_from_drive(x, y, *drive), strict=True))
