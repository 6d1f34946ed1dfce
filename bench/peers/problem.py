"""The reference problem, written once for all peers and independent of stickslip.

IPP at 100 Hz (Pawashe, Floyd and Sitti, RSS 2008): the +x coil plays a sawtooth with a sudden rise,
the clamp coil holds the nose down. One corner of the body, the front bottom one, touches or flies
from the moment the flat body tips; peers stop with an error where that is not so.

Field. In the plane of motion the field of a coil derives from a potential, of which the peers use
the expansion to third order about the middle of the path: a user who wants speed would not evaluate
Eqs. (4)-(6) anew for a body that travels half a millimetre between coils 100 mm away.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

GRAVITY = 9.81  # m/s^2
STATIC_FRICTION, KINETIC_FRICTION = 0.2, 0.145
RESISTANCE, INDUCTANCE = 10.0, 0.07  # ohm, H
SIDE, DISTANCE, TURNS = 0.1385, 0.099, 510  # m, m
LENGTH, WIDTH, HEIGHT = 250e-6, 130e-6, 100e-6  # m
MASS = 25.6e-9  # kg
MOMENT = 5e5 * LENGTH * WIDTH * HEIGHT  # A m^2
RAMP, BASE = 0.05, 0.5e-3  # s, T
PULSES, SETTLING_PULSES = 20, 3

# Where the expansion of the field is centred, m: the middle of the path in the 17 counted pulses.
CENTRE = (0.25e-3, 0.11e-3)


@dataclass(frozen=True)
class Drive:
    """Settings that differ between runs: peak and hold in T at the centre, frequency in Hz."""

    peak: float = 2.5e-3
    frequency: float = 100.0
    hold: float = 1.0e-3


REFERENCE = Drive()

FAMILY = (
    REFERENCE,
    Drive(2.40e-3, 90.0, 1.10e-3),
    Drive(2.60e-3, 110.0, 0.90e-3),
    Drive(2.30e-3, 80.0, 1.00e-3),
    Drive(2.70e-3, 120.0, 1.10e-3),
    Drive(2.45e-3, 105.0, 1.20e-3),
    Drive(2.55e-3, 95.0, 0.80e-3),
    Drive(2.35e-3, 115.0, 0.95e-3),
)
"""Runs over which the velocity error is taken: one run alone can be right by luck."""


@dataclass(frozen=True)
class Body:
    """Constants of the body and its surroundings; SI, or any other consistent units."""

    half_length: float = LENGTH / 2
    half_height: float = HEIGHT / 2
    half_width: float = WIDTH / 2
    mass: float = MASS
    inertia: float = MASS * (LENGTH**2 + HEIGHT**2) / 12
    weight: float = MASS * GRAVITY
    adhesion: float = 0.22e-6
    linear_drag: float = 1.0e-5
    quadratic_drag: float = 9.0e-17  # torque by angular rate squared

    def scaled(self, length: float, mass: float, time: float) -> Body:
        """In other units; each argument is how many new units make one SI unit."""
        force = mass * length / time**2
        factors = {
            "half_length": length, "half_height": length, "half_width": length, "mass": mass,
            "inertia": mass * length**2, "weight": force, "adhesion": force,
            "linear_drag": mass / time, "quadratic_drag": mass * length**2,
        }  # fmt: skip
        return Body(**{name: factor * getattr(self, name) for name, factor in factors.items()})


@dataclass(frozen=True)
class Segment:
    """A stretch between two kinks of the voltages.

    current: (2, 3), for the +x and the clamp coil: I = a + b tau + c exp(-tau/T), A, with tau the
        time since `start`.
    """

    start: float
    end: float
    current: np.ndarray


@dataclass(frozen=True)
class Problem:
    """One run. Times in s and lengths in m, or in the units of `scaled`.

    field: (2, 9), magnetic moment times the expansion of one coil's field per ampere; columns bx bz
        (torque), gxx gxz gzz (force), xxx xxz xzz zzz (force by length).
    """

    body: Body
    segments: tuple[Segment, ...]
    field: np.ndarray
    centre: tuple[float, float]
    time_constant: float

    @property
    def duration(self) -> float:
        return self.segments[-1].end

    def scaled(self, length: float, mass: float, time: float) -> Problem:
        """In other units; each argument is how many new units make one SI unit."""
        per_length = length ** np.array([2, 2, 1, 1, 1, 0, 0, 0, 0])
        return replace(
            self,
            body=self.body.scaled(length, mass, time),
            segments=tuple(
                Segment(s.start * time, s.end * time, s.current * [1.0, 1.0 / time, 1.0])
                for s in self.segments
            ),
            field=self.field * per_length * mass / time**2,
            centre=(self.centre[0] * length, self.centre[1] * length),
            time_constant=self.time_constant * time,
        )


def loop_field(axis: int, position: float, points: np.ndarray) -> np.ndarray:
    """Field of a square coil by Biot and Savart, per ampere.

    axis: 0 for a coil whose axis is x, 2 for z; position: of its plane on that axis, m.
    points: (n, 3), m. Returns (n, 3), T/A.
    """
    corners = np.zeros((5, 3))
    corners[:, axis] = position
    corners[:, (axis + 1) % 3] = np.array([1, -1, -1, 1, 1]) * SIDE / 2
    corners[:, (axis + 2) % 3] = np.array([1, 1, -1, -1, 1]) * SIDE / 2
    total = np.zeros((len(points), 3))
    for begin, end in itertools.pairwise(corners):
        a, b = points - begin, points - end
        la, lb = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)
        factor = (la + lb) / (la * lb * (la * lb + np.sum(a * b, axis=1)))
        total += factor[:, None] * np.cross(a, b)
    return 1e-7 * TURNS * total


def field_expansion(axis: int, position: float, centre: tuple[float, float]) -> np.ndarray:
    """The nine derivatives of one coil's potential that `Problem.field` names, per ampere.

    Fitted to the field within 1 mm of `centre`, two orders higher than is kept.
    """
    offsets = np.linspace(-1e-3, 1e-3, 9)
    x, z = (grid.ravel() for grid in np.meshgrid(offsets, offsets))
    points = np.stack([centre[0] + x, np.zeros_like(x), centre[1] + z], axis=1)
    exact = loop_field(axis, position, points)
    columns = []
    for order in range(1, 6):
        for power in range(order + 1):
            # d^order of the potential, `power` times by z, is the factor of these two monomials.
            p, q = order - power, power
            scale = 1.0 / (math.factorial(p) * math.factorial(q))
            along_x = scale * p * x ** max(p - 1, 0) * z**q
            along_z = scale * q * x**p * z ** max(q - 1, 0)
            columns.append(np.concatenate([along_x, along_z]))
    matrix = np.stack(columns, axis=1)
    size = np.linalg.norm(matrix, axis=0)
    values = np.concatenate([exact[:, 0], exact[:, 2]])
    return (np.linalg.lstsq(matrix / size, values, rcond=None)[0] / size)[:9]


def _segments(drive: Drive) -> tuple[Segment, ...]:
    centre_field = loop_field(0, DISTANCE, np.zeros((1, 3)))[0, 0]
    lag = INDUCTANCE / RESISTANCE
    period = 1.0 / drive.frequency
    bottom = np.array([BASE, -drive.hold]) / centre_field  # A, in the steady state
    top = np.array([drive.peak, -drive.hold]) / centre_field
    stretches = [(0.0, RAMP, np.zeros(2), bottom)]
    for k in range(PULSES):
        stretches.append((RAMP + k * period, RAMP + (k + 1) * period, top, bottom))
    now = np.zeros(2)
    segments = []
    for start, end, first, last in stretches:
        slope = (last - first) / (end - start)
        steady = first - slope * lag
        current = np.stack([steady, slope, now - steady], axis=1)
        segments.append(Segment(start, end, current))
        now = current @ [1.0, end - start, math.exp(-(end - start) / lag)]
    return tuple(segments)


def problem_of(drive: Drive = REFERENCE) -> Problem:
    """The run of `drive` in SI units."""
    coils = ((0, DISTANCE), (2, -DISTANCE))
    field = MOMENT * np.stack([field_expansion(*coil, CENTRE) for coil in coils])
    return Problem(
        body=Body(),
        segments=_segments(drive),
        field=field,
        centre=CENTRE,
        time_constant=INDUCTANCE / RESISTANCE,
    )


def mean_velocity(problem: Problem, path: list[float]) -> float:
    """Mean velocity after the third pulse; path: x of the centre of mass as each pulse ends."""
    begin, end = problem.segments[SETTLING_PULSES], problem.segments[PULSES]
    return (path[PULSES - 1] - path[SETTLING_PULSES - 1]) / (end.end - begin.end)
