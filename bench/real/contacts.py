"""Where flights end: impacts that stand alone, without any law of impact.

Two flights that meet between two frames are parted by one impact. Where their parabolas cross, the
lowest point of the body lies on the plate.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from .flights import FRAME, Drops, Flight, FlightConstants, state_of

SIDE = 60e-3
"""Side of the square, m."""
ABOUT = -0.6
"""x at which the plate's height is given, m. Chosen: near the impacts, of which most are at -0.25
to -0.6 m, so that height and slope of the plate depend little on each other."""

_LEAST_RISE = 0.4
"""Change of the upward velocity by an impact, m/s. Chosen: seven frames on each side, with `NOISE`,
tell to 0.14 ms when the heights of two parabolas cross."""
_LEAST_TURN = 6.0
"""Change of the spin, rad/s. Chosen: the angles then tell the time as well as the heights do."""
_MOST_APART = 0.5e-3
"""Between these two times, s. Chosen: two and a half standard deviations of their difference."""


@dataclass(frozen=True)
class Impacts:
    """States of the centre of mass just before and after impacts that stand alone.

    drop: shape (n,). before, after: shape (n, 6): x, z, theta, vx, vz, omega; theta as it is
    read.
    """

    drop: np.ndarray
    before: np.ndarray
    after: np.ndarray


def single_impacts(drops: Drops, flights: list[Flight], constants: FlightConstants) -> Impacts:
    """Impacts between two frames after which the body flies on.

    Those that change the spin have to change it when they change the velocity: else there were two.
    """
    found = []
    for one, other in itertools.pairwise(flights):
        # The frame after an impact can still lie within the tolerance.
        if one.drop != other.drop or abs(other.first - one.end) > 1:
            continue
        end = min(one.end, other.first)
        one, other = one._replace(end=end), other._replace(first=max(one.end, other.first))
        middle = FRAME * (0.5 * (end + other.first) - 0.5)
        before = state_of(drops, one, constants, middle, at_end=True)
        after = state_of(drops, other, constants, middle, at_end=False)
        gain = after[3:] - before[3:]
        if gain[1] < _LEAST_RISE:
            continue
        when = -(after[:3] - before[:3])[1:] / gain[1:]
        half = 0.5 * FRAME * (other.first - end + 1)
        turns = abs(gain[2]) > _LEAST_TURN
        if abs(when[0]) > half or (turns and abs(when[1] - when[0]) > _MOST_APART):
            continue
        found.append((one.drop, middle + when[0], one, other))
    states = [
        (
            state_of(drops, one, constants, time, at_end=True),
            state_of(drops, other, constants, time, at_end=False),
        )
        for _, time, one, other in found
    ]
    return Impacts(
        np.array([drop for drop, *_ in found], dtype=int),
        np.array([before for before, _ in states]).reshape(-1, 6),
        np.array([after for _, after in states]).reshape(-1, 6),
    )


def reach(angle: np.ndarray, half: float) -> np.ndarray:
    """How far below its middle a square of half a side reaches, m."""
    return half * (np.abs(np.cos(angle)) + np.abs(np.sin(angle)))
