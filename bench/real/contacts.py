"""Where contact begins: the angle's offset, the plate, and the corners, without any law of impact.

Two flights that meet between two frames are parted by one impact. Where their parabolas cross, the
lowest point of the body lies on the plate; how high the centre of mass is there, at many angles,
says how the angle is read, where the plate lies, and how far out the corners are.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from .flights import FRAME, Drops, Flight, FlightConstants, state_of

SIDE = 60e-3
"""Side of the square, m."""
ABOUT = -0.6
"""x at which the plate's height is given, m: the middle of the impacts."""

_GROUPS = 10
_QUARTER = np.pi / 2


@dataclass(frozen=True)
class ContactGeometry:
    """What the heights at contact say.

    Attributes
    ----------
    angle_offset : float
        What is read too much of theta, against the plate, rad.
    plate : float
        Height of the plate at x = `ABOUT`, m.
    slope : float
        Its rise by x.
    middle_x, middle_z : float
        The square's middle from its centre of mass, m, in the body's axes.
    rounding : float
        Radius of its corners, m: a rounded square touches as one whose corners lie at
        `SIDE` / 2 - rounding does on a plate that is higher by the rounding.
    """

    angle_offset: float
    plate: float
    slope: float
    middle_x: float
    middle_z: float
    rounding: float


@dataclass(frozen=True)
class Impacts:
    """States of the centre of mass just before and after impacts that stand alone.

    Attributes
    ----------
    drop : numpy.ndarray, shape (n,)
    before, after : numpy.ndarray, shape (n, 6)
        x, z, theta, vx, vz, omega; theta as it is read.
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
        if gain[1] < 0.4:
            continue
        when = -(after[:3] - before[:3])[1:] / gain[1:]
        half = 0.5 * FRAME * (other.first - end + 1)
        turns = abs(gain[2]) > 6.0
        if abs(when[0]) > half or (turns and abs(when[1] - when[0]) > 0.5e-3):
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


def _gap(impacts: Impacts, values: np.ndarray) -> np.ndarray:
    offset, plate, slope, middle_x, middle_z, rounding = values
    x, z, theta = impacts.before[:, :3].T
    angle = theta - offset
    middle = middle_z * np.cos(angle) - middle_x * np.sin(angle)
    down = reach(angle, 0.5 * SIDE - rounding) + rounding
    return z + middle - down - plate - slope * (x - ABOUT)


def fit_contacts(impacts: Impacts) -> tuple[ContactGeometry, ContactGeometry]:
    """The geometry, and the standard deviation of each part of it.

    The loss is Cauchy's. The deviations are those of a jackknife over groups of drops.
    """
    group = impacts.drop % _GROUPS
    best = _fit(impacts, np.ones(len(group), dtype=bool))
    # A group that is empty says nothing.
    left = np.array([_fit(impacts, group != each) for each in np.unique(group)])
    many = len(left)
    deviation = np.sqrt((many - 1) / many * np.sum((left - left.mean(axis=0)) ** 2, axis=0))
    return ContactGeometry(*map(float, best)), ContactGeometry(*map(float, deviation))


def _fit(impacts: Impacts, which: np.ndarray) -> np.ndarray:
    some = Impacts(impacts.drop[which], impacts.before[which], impacts.after[which])
    unit = np.array([1e-2, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3])

    def misfit(values: np.ndarray) -> np.ndarray:
        # The middle is the centre of mass within a millimetre or so, whatever the data say.
        return np.concatenate([_gap(some, unit * values) / 0.2e-3, values[3:5]])

    return unit * least_squares(misfit, np.full(6, 1e-3), loss="cauchy").x
