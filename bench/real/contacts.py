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
"""x at which the plate's height is given, m. Chosen: near the impacts, of which most are at -0.25
to -0.6 m, so that height and slope of the plate depend little on each other."""

_LEAST_RISE = 0.4
"""Change of the upward velocity by an impact, m/s. Chosen: seven frames on each side, with `NOISE`,
tell to 0.14 ms when the heights of two parabolas cross."""
_LEAST_TURN = 6.0
"""Change of the spin, rad/s. Chosen: the angles then tell the time as well as the heights do."""
_MOST_APART = 0.5e-3
"""Between these two times, s. Chosen: two and a half standard deviations of their difference."""
_HEIGHT_ERROR = 0.2e-3
"""Error of a height at contact from which on the loss flattens, m. Chosen: below the scatter that
is left, 0.3 mm, so that outliers hardly count."""
_GROUPS = 10
"""Groups of drops for a jackknife. Chosen: each costs a fit of a fraction of a second."""
_QUARTER = np.pi / 2


@dataclass(frozen=True)
class ContactGeometry:
    """Constants that the heights at contact tell.

    angle_offset: Error of theta as read, against the plate, rad. plate: Height of the
    plate at x = `ABOUT`, m. slope: Its rise by x. middle_x, middle_z: The square's middle from
    its centre of mass, m, in the body's axes. rounding: Radius of its corners, m: a rounded
    square touches as one whose corners lie at `SIDE` / 2 - rounding does on a plate that is
    higher by the rounding.
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
        return np.concatenate([_gap(some, unit * values) / _HEIGHT_ERROR, values[3:5]])

    return unit * least_squares(misfit, np.full(6, 1e-3), loss="cauchy").x


def slipping_friction(impacts: Impacts, geometry: ContactGeometry) -> tuple[np.ndarray, np.ndarray]:
    """Approach speed (m/s) and ratio of the impulses of impacts that slip one way all along.

    Slip of at least 0.3 m/s before and 0.15 m/s after, so that its sense is sure.
    """
    angle = impacts.before[:, 2] - geometry.angle_offset
    quarter = np.floor(angle / _QUARTER) * _QUARTER
    # In the square's quarter turn that has the corner ahead below: (1, -1) times half a side.
    half = 0.5 * SIDE - geometry.rounding
    ahead = half * (np.cos(angle - quarter) - np.sin(angle - quarter))
    down = reach(angle, half) + geometry.rounding

    def corner(state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        vx, vz, omega = state[:, 3:].T
        return vx - omega * down, vz - omega * ahead

    (slip, approach), (slip_after, _) = corner(impacts.before), corner(impacts.after)
    gain = impacts.after[:, 3:5] - impacts.before[:, 3:5]
    one_way = (slip * slip_after > 0.0) & (np.abs(slip) > 0.3) & (np.abs(slip_after) > 0.15)
    ratio = -np.sign(slip) * gain[:, 0] / gain[:, 1]
    return -approach[one_way], ratio[one_way]
