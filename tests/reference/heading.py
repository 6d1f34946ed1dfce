"""Voltages of all five coils that give the planar drive's field along a heading."""

from dataclasses import dataclass

import numpy as np

from .drive import Voltages, voltages_of
from .field import COIL_NAMES

COILS = COIL_NAMES  # the order of the columns: xp, xm, yp, ym, clamp

# While a heading changes, cos and sin of it are straight between points this far apart; with
# 90 degrees in 10 ms they err by (0.016)^2 / 8.
TURNING_STEP = 1e-4  # s


@dataclass(frozen=True)
class Heading:
    """Heading in rad as a function of time: straight between the points (times s, angles rad)."""

    times: tuple
    angles: tuple

    def __call__(self, t):
        """Heading at t (s, any shape), rad."""
        return np.interp(t, self.times, self.angles)


def coil_shares(angle: float, coils: str) -> np.ndarray:
    """Voltage of each coil per volt of the planar drive's lateral coil, shape (5,).

    single: of each axis the coil that lies ahead, with its field towards itself, so that it pulls:
    a negative current in xm and ym, as positive current gives a field along +x or +y in any coil.
    behind-y: the same, but of the y axis the coil that lies behind. pairs: both coils alike.
    Raises ValueError for any other word.
    """
    shares = np.zeros(5)
    for axis, part in enumerate((np.cos(angle), np.sin(angle))):
        if coils == "pairs":
            shares[2 * axis : 2 * axis + 2] = part / 2
        elif coils in ("single", "behind-y"):
            ahead = (part < 0.0) != (coils == "behind-y" and axis == 1)
            shares[2 * axis + int(ahead)] = part
        else:
            raise ValueError(f"coils = {coils!r}, allowed: single, pairs, behind-y")
    # cos(90 degrees) is 6e-17: no coil is meant.
    return np.where(np.abs(shares) < 1e-15, 0.0, shares)


def heading_voltages(drive: dict, heading: Heading, coils: str = "single") -> Voltages:
    """Voltages of the five `COILS`, whose horizontal part is the planar drive's along the heading.

    drive: keys of `[drive]` without `direction`. Where the heading changes, the voltages are exact
    at points TURNING_STEP apart and straight between.
    """
    planar = voltages_of(drive)
    ends = np.append(planar.start[1:], planar.start[-1] + 1.0)
    start, level, slope = [], [], []
    for begin, end, first, rate in zip(planar.start, ends, planar.level, planar.slope, strict=True):
        cuts = {begin, end, *(t for t in heading.times if begin < t < end)}
        for low, high in zip(heading.times[:-1], heading.times[1:], strict=True):
            inside = low + TURNING_STEP * np.arange(1, int((high - low) / TURNING_STEP))
            cuts.update(float(t) for t in inside if begin < t < end)
        points = np.array(sorted(cuts))
        lateral, clamp = (first + rate * (points[:, None] - begin)).T
        volts = np.array([coil_shares(angle, coils) for angle in heading(points)])
        volts = volts * lateral[:, None]
        volts[:, 4] = clamp
        start.extend(points[:-1])
        level.extend(volts[:-1])
        slope.extend(np.diff(volts, axis=0) / np.diff(points)[:, None])
    counted = planar.first_counted, planar.last_counted, planar.end
    return Voltages(np.array(start), np.array(level), np.array(slope), *counted)
