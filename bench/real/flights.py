"""Drops as they were read, and what their free flights say: drag, gravity, the marker's place.

A flight is a row of frames in which every seven follow one parabola. A body at rest does not: its
height would have to change by 0.4 mm, so that no pose at rest is ever used.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

FRAME = 1.0 / 250
"""Time between two frames, s."""
NOISE = np.array([14e-6, 51e-6, 0.74e-3])
"""Scatter of x, z (m) and theta (rad) about parabolas, standard deviations: of free flights of the
drops that the documentation tells of."""
COLUMNS = ("drop", "frame", "x", "z", "theta_ccw")

_WINDOW = 7
_TOLERANCE = np.array([0.12e-3, 0.25e-3, 8e-3])
"""Largest misfit of a window, m and rad: what an impact of 0.1 m/s exceeds."""
_NEAR = 14
"""Frames of a flight that say how it ends or begins. Chosen: with `NOISE` they give the velocity of
z to 1 mm/s, and more of them would only rely more on the drag."""


@dataclass(frozen=True)
class Drops:
    """Poses of a marker on each body, in this project's sense of theta.

    name: shape (n,): What the file calls each drop. poses: shape (n, frames, 3): x, z (m) and
    theta (rad) of the marker.
    """

    name: np.ndarray
    poses: np.ndarray

    def __len__(self) -> int:
        return len(self.name)


def read_drops(path: Path) -> Drops:
    """Drops of a table, which may be compressed; a ValueError that names the file if it is none."""
    import pandas as pd

    try:
        table = pd.read_csv(path)
    except (OSError, ValueError) as error:
        raise ValueError(f"{path}: {' '.join(str(error).split())}") from None
    missing = [name for name in COLUMNS if name not in table.columns]
    if missing:
        raise ValueError(f"{path}: no column {missing[0]}; needed are {', '.join(COLUMNS)}")
    table = table.sort_values(["drop", "frame"])
    name, frames = np.unique(table["drop"].to_numpy(), return_counts=True)
    poses = table[["x", "z", "theta_ccw"]].to_numpy(float)
    if len(set(frames)) != 1 or not np.isfinite(poses).all():
        raise ValueError(f"{path}: each drop needs the same number of frames, all of them numbers")
    return Drops(name, poses.reshape(len(name), frames[0], 3) * [1.0, 1.0, -1.0])


@dataclass(frozen=True)
class FlightConstants:
    """Constants of free flights.

    drag, spin_drag: Rates at which velocity and spin die away, 1/s. gravity_x, gravity_z:
    m/s^2, in the camera's axes. marker_x, marker_z: The marker from the centre of mass, m, in
    axes that turn with the angle as it is read.
    """

    drag: float = 0.5
    spin_drag: float = 0.5
    gravity_x: float = 0.0
    gravity_z: float = -9.81
    marker_x: float = 0.0
    marker_z: float = 0.0

    def marker(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """x and z of the marker from the centre of mass, m."""
        cos, sin = np.cos(theta), np.sin(theta)
        return (
            self.marker_x * cos + self.marker_z * sin,
            self.marker_z * cos - self.marker_x * sin,
        )

    def travel(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Way of a unit velocity, of a unit acceleration, and angle of a unit spin after a time."""
        way = -np.expm1(-self.drag * time) / self.drag
        return way, (time - way) / self.drag, -np.expm1(-self.spin_drag * time) / self.spin_drag


class Flight(NamedTuple):
    drop: int
    first: int
    """Frame."""
    end: int
    """Frame after the last one."""


def find_flights(drops: Drops) -> list[Flight]:
    """All flights, drop by drop in the order of time."""
    time = FRAME * (np.arange(_WINDOW) - (_WINDOW - 1) / 2)
    line = np.stack([np.ones(_WINDOW), time], axis=1)
    rest = np.eye(_WINDOW) - line @ np.linalg.pinv(line)
    fallen = drops.poses + np.zeros(3)
    frames = fallen.shape[1]
    fallen[:, :, 1] += 0.5 * 9.81 * (FRAME * np.arange(frames)) ** 2
    windows = np.lib.stride_tricks.sliding_window_view(fallen, _WINDOW, axis=1)
    free = (np.abs(windows @ rest) < _TOLERANCE[:, None]).all(axis=(2, 3))
    found = []
    for drop, row in enumerate(free):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], row, [0]])))
        found += [
            Flight(drop, int(first), int(last) + _WINDOW - 1)
            for first, last in edges.reshape(-1, 2)
        ]
    return found


def state_of(
    drops: Drops, flight: Flight, constants: FlightConstants, time: float, at_end: bool
) -> np.ndarray:
    """x, z, theta, vx, vz, omega of the centre of mass at a time, s since the first frame.

    From the frames nearest to the flight's end or beginning, by least squares.
    """
    first, end = flight.first, flight.end
    first, end = (max(first, end - _NEAR), end) if at_end else (first, min(end, first + _NEAR))
    since = FRAME * np.arange(first, end) - time
    x, z, theta = drops.poses[flight.drop, first:end].T
    way, fallen, turned = constants.travel(since)
    one = np.ones_like(since)
    angle, omega = np.linalg.lstsq(np.stack([one, turned], 1), theta, rcond=None)[0]
    beside, above = constants.marker(angle + omega * turned)
    centre = np.stack(
        [x - beside - constants.gravity_x * fallen, z - above - constants.gravity_z * fallen], 1
    )
    start, velocity = np.linalg.lstsq(np.stack([one, way], 1), centre, rcond=None)[0]
    return np.array([*start, angle, *velocity, omega])


def fit_flights(drops: Drops, flights: list[Flight]) -> FlightConstants:
    """Constants that all flights of ten frames and more have in common.

    Where each flight begins and how fast is projected out. The loss is Cauchy's: some flights touch
    the walls.
    """
    long = [flight for flight in flights if flight.end - flight.first >= 10]
    names = [field.name for field in fields(FlightConstants)]
    start = FlightConstants()
    unit = np.array([0.1, 0.1, 0.1, 0.1, 1e-3, 1e-3])

    def misfit(changes: np.ndarray) -> np.ndarray:
        values = np.array([getattr(start, name) for name in names]) + unit * changes
        constants = FlightConstants(*values)
        return np.concatenate([_misfit(drops, flight, constants) for flight in long])

    found = least_squares(misfit, np.zeros(6), loss="cauchy", f_scale=2.0, method="trf")
    values = np.array([getattr(start, name) for name in names]) + unit * found.x
    return FlightConstants(*map(float, values))


def _misfit(drops: Drops, flight: Flight, constants: FlightConstants) -> np.ndarray:
    x, z, theta = drops.poses[flight.drop, flight.first : flight.end].T
    way, fallen, turned = constants.travel(FRAME * np.arange(len(x)))
    one = np.ones_like(way)
    angle = np.linalg.qr(np.stack([one, turned], 1))[0]
    place = np.linalg.qr(np.stack([one, way], 1))[0]
    smooth = angle @ (angle.T @ theta)
    beside, above = constants.marker(smooth)
    centre = np.stack(
        [x - beside - constants.gravity_x * fallen, z - above - constants.gravity_z * fallen], 1
    )
    left = centre - place @ (place.T @ centre)
    return np.concatenate([left[:, 0], left[:, 1], theta - smooth]) / np.repeat(NOISE, len(x))
