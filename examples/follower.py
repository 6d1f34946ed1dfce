"""Pure pursuit: a robot follows a path by what a camera shows, pulse by pulse.

``python follower.py`` takes the robot of walk.toml around a corner, and prints how far it was from
the path. The follower is made from a scenario with a drive (IPP) with which the robot walks; its
pulses differ in their heading alone. ``steer.py`` judges it on robots that differ.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip import (
    COIL_NAMES,
    STATE_COLUMNS,
    Coils,
    Scenario,
    SimulationError,
    Simulator,
    State,
    Waveform,
    load,
)
from stickslip.control import Camera, Film, heading_voltages

Array = NDArray[np.float64]

# All chosen. Times are steps of a tenth of the drive's period, fields parts of its peak.
PULSE = np.linspace(1.0, 0.2, 10)  # rises at once and falls slowly
STANDS = np.full(50, 0.5)
MOST = 0.25  # rad, by which one pulse turns the robot at most
KNOWN = 20  # pulses, after which the steps of this robot count and not the table's
TRIED = 12  # pulses along each heading before a robot is taken for one that walks
HEADINGS = np.radians([0.0, 45.0, 90.0, 180.0, -90.0])
BEHIND, AHEAD = 0.2e-3, 0.6e-3  # m, where along the path a robot is looked for
PLACE = [STATE_COLUMNS.index("x"), STATE_COLUMNS.index("y")]


def field_voltages(
    scenario: Scenario, heading: ArrayLike, along: ArrayLike, clamp: ArrayLike
) -> Array:
    """Convert fields at the centre into voltages of a scenario's coils, V, shape (..., 5).

    `heading` is from +x to the left, rad; `along` the field along the surface and `clamp` that of
    the clamp coil, T. Of each axis the coil that lies ahead makes its part, or with
    ``drive.coils = "pairs"`` both alike.
    """
    fields = heading_voltages(heading, along, clamp)
    if scenario.drive.coils == "pairs":
        for pair in ([0, 1], [2, 3]):
            fields[..., pair] = 0.5 * fields[..., pair].sum(axis=-1, keepdims=True)
    ohms = np.array([scenario.get(f"coil.{name}.resistance") for name in COIL_NAMES])
    return fields * ohms / Coils.of(scenario).centre_field_per_ampere


class Path:
    """A polyline along the surface, by its arc length; `points` are its corners, (k, 2), m."""

    def __init__(self, points: ArrayLike) -> None:
        self.points = np.asarray(points, dtype=float)
        sides = np.diff(self.points, axis=0)
        self._lengths = np.hypot(*sides.T)
        self._along = sides / self._lengths[:, None]
        self._starts = np.concatenate([[0.0], np.cumsum(self._lengths)])
        self.length = float(self._starts[-1])

    def at(self, progress: float) -> Array:
        """Return the place at an arc length, m; beyond an end, that end."""
        return np.array([np.interp(progress, self._starts, each) for each in self.points.T])

    def project(self, place: Array, before: float) -> tuple[float, float]:
        """Return the progress of a robot and its distance to the left of the path, m.

        Progress is the arc length of the nearest point. That is looked for near the progress
        before, so that a path may cross itself.
        """
        low, high = before - BEHIND, before + AHEAD
        (along_x, along_y), (off_x, off_y) = self._along.T, (place - self.points[:-1]).T
        near = off_x * along_x + off_y * along_y
        near = np.clip(near, low - self._starts[:-1], high - self._starts[:-1])
        near = np.clip(near, 0.0, self._lengths)
        away_x, away_y = off_x - near * along_x, off_y - near * along_y
        progress, squares = self._starts[:-1] + near, away_x**2 + away_y**2
        within = (progress > low - 1e-12) & (progress < high + 1e-12)  # m, rounding
        best = int(np.argmin(np.where(within, squares, np.inf)))
        left = along_x[best] * away_y[best] - along_y[best] * away_x[best]
        return float(progress[best]), math.copysign(math.sqrt(squares[best]), left)


class Follower:
    """Follows a path by the fields and coils of a scenario's drive; each pulse aims ahead.

    It expects the robot where the newest frame shows it, plus the pulses since then, and heads for
    the point of the path one body length ahead. All pulses have one shape, from ``drive.peak`` down
    to a fifth of it within a period of the drive, with the field ``drive.hold`` of the
    clamp. A ValueError says why a robot cannot be steered.
    """

    def __init__(self, scenario: Scenario, path: Path) -> None:
        drive = scenario.drive
        if drive.mode != "IPP" or 0.0 in (drive.peak, drive.hold):
            raise ValueError("the robot cannot be steered: give IPP with drive.peak and drive.hold")
        self.scenario, self.path = scenario, path
        self.period = 0.1 / drive.frequency  # s, of a voltage; a pulse has ten
        self.ahead = float(scenario.robot.length)  # m, to the point that it heads for
        self.progress = self._seen = 0.0  # m, now and in the newest frame
        self.heading = math.pi if drive.facing < 0.0 else 0.0
        self.step = self._simulated_step()  # m, of a pulse; once it is known that of this robot
        self._headings: list[float] = []  # of all pulses

    def stand(self) -> Array:
        """Return voltages with which the robot stands up, V, shape (50, 5)."""
        return self._voltages(self.heading, STANDS)

    def decide(self, seen: Array, age: float) -> Array:
        """Return voltages of the next pulse, V, shape (10, 5).

        `seen` is the place in the newest frame, m, and `age` the time since it was taken, s.
        """
        headings = self._headings
        before = max(len(headings) - round(age / (self.period * len(PULSE))), 0)
        self._seen, _ = self.path.project(seen, self._seen)
        if before > KNOWN and self._seen > 0.0:
            self.step = self._seen / before
        since = headings[before:]
        place = seen + self.step * np.array([np.cos(since).sum(), np.sin(since).sum()])
        self.progress, _ = self.path.project(place, self.progress)
        ahead = self.path.at(self.progress + self.ahead) - place
        bearing = math.atan2(ahead[1], ahead[0])
        turn = math.remainder(bearing - self.heading, 2.0 * math.pi)
        self.heading += min(max(turn, -MOST), MOST)
        headings.append(self.heading)
        return self._voltages(self.heading, PULSE)

    @property
    def arrived(self) -> bool:
        """Whether the robot should be at the end, within a pulse."""
        return self.progress >= self.path.length - self.step

    def _voltages(self, heading: float, along: Array) -> Array:
        drive = self.scenario.drive
        clamp = -drive.hold if drive.clamp == "down" else drive.hold
        return field_voltages(self.scenario, heading, drive.peak * along, clamp)

    def _simulated_step(self) -> float:
        """Return the median step of a pulse over some headings, m, if it walks along all."""
        steps = []
        for heading in self.heading + HEADINGS:
            turned = {"initial.heading": math.remainder(heading, math.tau)}
            sim = Simulator(self.scenario.replace(turned), whole_plane=True)
            places = [sim.state]
            try:
                for along in (STANDS, *[PULSE] * TRIED):
                    for volts in self._voltages(heading, along):
                        state = sim.step(volts, self.period)
                    places.append(state)
            except SimulationError as error:
                raise ValueError(f"the robot cannot be steered: {error}") from None
            towards = np.array([math.cos(heading), math.sin(heading)])
            ways = np.diff([np.dot([place.x, place.y], towards) for place in places[1:]])
            steps.append(float(np.median(ways[2:])))
        if not 1e-3 * self.ahead < min(steps):
            degrees = np.degrees(HEADINGS)[int(np.argmin(steps))]
            raise ValueError(
                f"the robot cannot be steered: {degrees:.0f} degrees to the left its pulses take "
                f"it {1e6 * min(steps):.3g} um ahead; change the drive until it walks"
            )
        if max(steps) > 0.5 * self.ahead:
            raise ValueError(
                f"the robot cannot be steered: a pulse takes it {1e6 * max(steps):.3g} um, more "
                "than half of its length; give a higher drive.frequency or a lower drive.peak"
            )
        return float(np.median(steps))


@dataclass(frozen=True)
class Followed:
    """A robot that followed a path, in simulation.

    Attributes
    ----------
    states : numpy.ndarray, shape (steps, 28)
        After each step, with the columns of `STATE_COLUMNS`.
    voltages : numpy.ndarray, shape (steps, 5)
        V, each held for `period`.
    period : float
        s.
    arrived : bool
        Whether it came to the end and was never lost, a body length from the path.
    across : numpy.ndarray
        Distance from the path after each pulse, m, to the one by which it was lost.
    """

    states: Array
    voltages: Array
    period: float
    arrived: bool
    across: Array

    def program(self) -> Waveform:
        """Return the voltages, for a drive with ``mode="program"``."""
        times = self.period * np.repeat(np.arange(len(self.voltages) + 1), 2)[1:-1]
        return Waveform.from_points(times, np.repeat(self.voltages, 2, axis=0))


def follow(
    scenario: Scenario,
    path: Path,
    robot: Scenario | None = None,
    *,
    camera: Camera | None = None,
    seed: int = 0,
    limit: float = 30.0,
) -> Followed:
    """Simulate how a `Follower` of a scenario takes a robot along a path, from where it stands.

    Parameters
    ----------
    scenario : Scenario
        What the follower knows.
    path : Path
    robot : Scenario, optional
        The robot that it steers, with the same coils; by default that of `scenario`.
    camera : Camera, optional
        By default an exact one of 1000 frames a second.
    seed : int
        Of the camera's noise.
    limit : float
        After which a robot that has not arrived is given up, s.

    Raises
    ------
    ValueError
        If such a robot cannot be steered; it says why.
    SimulationError
        If the robot's simulation fails on the way.
    """
    follower, random = Follower(scenario, path), np.random.default_rng(seed)
    sim = Simulator(scenario if robot is None else robot, whole_plane=True)
    film = Film(camera or Camera(frame_rate=1000.0), follower.period, pose(sim.state))
    states, played, voltages = [], [], follower.stand()
    while not follower.arrived and sim.time < limit:
        for volts in voltages:
            state = sim.step(volts, follower.period)
            seen, age = film.watch(sim.time, pose(state), random)
            states.append(state.row)
            played.append(volts)
        voltages = follower.decide(seen[:2], age)
    reached = np.array(states)
    arrived, across = judge(reached[:, PLACE], path, follower)
    return Followed(reached, np.array(played), follower.period, arrived, across)


def judge(places: Array, path: Path, follower: Follower) -> tuple[bool, Array]:
    """Return whether a robot came to the end and was never lost, and its distances from the path.

    `places` are where it truly was after each step, (steps, 2), m. It has come to the end within
    two pulses and a tenth of its length.
    """
    progress, across = 0.0, [0.0]
    for place in places[len(PULSE) - 1 :: len(PULSE)]:
        if across[-1] > follower.ahead:
            break
        progress, off = path.project(place, progress)
        across.append(abs(off))
    near = 2.0 * follower.step + 0.1 * follower.ahead
    return progress >= path.length - near and across[-1] <= follower.ahead, np.array(across[1:])


def pose(state: State) -> Array:
    """Return what the camera reads: x, y, theta, heading."""
    return np.array([state.x, state.y, state.theta, state.heading])


def main() -> None:
    """Take the robot of walk.toml around a corner."""
    camera = Camera(frame_rate=30.0, latency=0.05, noise_x=3e-6)
    corner = Path([(0.0, 0.0), (2e-3, 0.0), (2e-3, 1e-3)])
    walk = follow(load("walk.toml"), corner, camera=camera, seed=2)
    arrived = "arrived" if walk.arrived else "lost"
    time, most = len(walk.states) * walk.period, 1e6 * max(walk.across)
    print(f"{arrived} after {time:.2f} s, and at most {most:.0f} um beside the path")


if __name__ == "__main__":
    main()
