"""A robot follows a path by what a camera shows: pure pursuit, pulse by pulse."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array, in_columns
from stickslip._util.messages import check_above_zero, check_kind, check_whole, known_arguments
from stickslip.control.camera import Camera, Film
from stickslip.control.path import COLUMNS, Path
from stickslip.control.steering import check_within_coils, field_voltages, pulse_fields
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import STATE_COLUMNS, State
from stickslip.scenario.waveform import Waveform
from stickslip.simulation.simulator import Simulator

# All chosen. Times are steps of a tenth of the drive's period, fields parts of its peak.
_PULSE = np.linspace(1.0, 0.2, 10)  # rises at once and falls slowly
_STANDS = np.full(50, 0.5)
_MOST = 0.25  # rad, by which one pulse turns the robot at most
_KNOWN = 20  # pulses, after which the steps of this robot count and not the table's
_TRIED = 12  # pulses along each heading before a robot is taken for one that walks
_HEADINGS = np.radians([0.0, 45.0, 90.0, 180.0, -90.0])
_PLACE = [STATE_COLUMNS.index("x"), STATE_COLUMNS.index("y")]


@known_arguments
class Follower:
    """Follows a path by the fields and coils of a scenario's drive; each pulse aims ahead.

    It expects the robot where the newest frame shows it, plus the pulses since then, and heads for
    the point of the path one body length ahead. All pulses are alike, from ``drive.peak`` down to a
    fifth of it within a period of the drive, with the field ``drive.hold`` of the clamp.

    Parameters
    ----------
    scenario : Scenario
        The robot, its coils, and a drive (IPP) with which it walks.
    path : Path
        From where the robot stands.

    Attributes
    ----------
    period : float
        Duration of a voltage, s; a pulse has ten.
    ahead : float
        Distance to the point that it heads for, m.
    step : float
        Of a pulse, m: by simulation, and once it is known that of this robot.
    progress : float
        Where along the path the robot should be, m.

    Raises
    ------
    ScenarioError
        If such a robot cannot be steered, or the path lies where no field is known; it says why.
    """

    def __init__(self, scenario: Scenario, path: Path) -> None:
        check_kind("scenario", scenario, Scenario)
        check_kind("path", path, Path)
        check_within_coils("path", path.points, scenario)
        self.scenario, self.path = scenario, path
        self._fields = pulse_fields(scenario)
        self.period = 0.1 / scenario.drive.frequency
        self.ahead = float(scenario.robot.length)
        self.progress = self.heading = 0.0
        self.heading = math.pi if scenario.drive.facing < 0.0 else 0.0
        self.step = self._simulated_step()
        self._seen = 0.0  # progress in the newest frame, m
        self._headings: list[float] = []  # of all pulses

    def stand(self) -> Array:
        """Voltages with which the robot stands up, V, shape (50, 5)."""
        return self._voltages(self.heading, _STANDS)

    def decide(self, seen: Array, age: float) -> Array:
        """Voltages of the next pulse, V, shape (10, 5), by the newest frame.

        Parameters
        ----------
        seen : array, shape (2,)
            Its x and y, m.
        age : float
            Since it was taken, s.
        """
        headings, seen = self._headings, in_columns("seen", seen, COLUMNS, unit="m")
        before = max(len(headings) - round(age / (self.period * len(_PULSE))), 0)
        self._seen = float(self.path.project(seen, self._seen)[0])
        if before > _KNOWN and self._seen > 0.0:
            self.step = self._seen / before
        since = headings[before:]
        place = seen + self.step * np.array([np.cos(since).sum(), np.sin(since).sum()])
        self.progress = float(self.path.project(place, self.progress)[0])
        ahead = self.path.at(self.progress + self.ahead) - place
        bearing = math.atan2(ahead[1], ahead[0])
        turn = math.remainder(bearing - self.heading, 2.0 * math.pi)
        self.heading += min(max(turn, -_MOST), _MOST)
        headings.append(self.heading)
        return self._voltages(self.heading, _PULSE)

    @property
    def arrived(self) -> bool:
        """Whether the robot should be at the end, within a pulse."""
        return self.progress >= self.path.length - self.step

    def _voltages(self, heading: float, along: Array) -> Array:
        peak, clamp = self._fields
        return field_voltages(self.scenario, heading, peak * along, clamp)

    def _simulated_step(self) -> float:
        """The least median step of a pulse over some headings, m, or why it cannot be steered."""
        steps = []
        for heading in self.heading + _HEADINGS:
            sim = Simulator(
                self.scenario.replace({"initial.heading": math.remainder(heading, math.tau)}),
                whole_plane=True,
            )
            places = [sim.state]
            try:
                for along in (_STANDS, *[_PULSE] * _TRIED):
                    for volts in self._voltages(heading, along):
                        state = sim.step(volts, self.period)
                    places.append(state)
            except RuntimeError as error:
                raise ScenarioError(f"the robot cannot be steered: {error}") from None
            towards = np.array([math.cos(heading), math.sin(heading)])
            ways = np.diff([np.dot([place.x, place.y], towards) for place in places[1:]])
            steps.append(float(np.median(ways[2:])))
        least, degrees = min(steps), np.degrees(_HEADINGS)[int(np.argmin(steps))]
        if not 1e-3 * self.ahead < least:
            raise ScenarioError(
                f"the robot cannot be steered: {degrees:.0f} degrees to the left its pulses take "
                f"it {1e6 * least:.3g} um ahead; change the drive until it walks"
            )
        if max(steps) > 0.5 * self.ahead:
            raise ScenarioError(
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
        Whether it came to the end and was never a body length beside the path.
    across : numpy.ndarray
        Its distance from the path after each pulse, m, as long as it was not lost.
    """

    states: Array
    voltages: Array
    period: float
    arrived: bool
    across: Array

    def program(self) -> Waveform:
        """The voltages, for a drive with ``mode="program"``."""
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
    """Simulate how a `Follower` of a scenario takes a robot along a path.

    Parameters
    ----------
    scenario : Scenario
        What the follower knows.
    path : Path
        From where the robot stands.
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
    ScenarioError
        If such a robot cannot be steered; it says why.
    SimulationError
        If the robot's simulation fails on the way.
    """
    check_above_zero("limit", limit, "s")
    check_whole("seed", seed)
    follower, random = Follower(scenario, path), np.random.default_rng(seed)
    sim = Simulator(scenario if robot is None else robot, whole_plane=True)
    film = Film(camera or Camera(frame_rate=1000.0), follower.period, _pose(sim.state))
    states, played, voltages = [], [], follower.stand()
    while not follower.arrived and sim.time < limit:
        for volts in voltages:
            state = sim.step(volts, follower.period)
            seen, age = film.watch(sim.time, _pose(state), random)
            states.append(state.row)
            played.append(volts)
        voltages = follower.decide(seen[:2], age)
    reached = np.array(states)
    arrived, across = judged(reached[:, _PLACE], path, follower)
    return Followed(reached, np.array(played), follower.period, arrived, across)


def judged(places: Array, path: Path, follower: Follower) -> tuple[bool, Array]:
    """Whether a robot came to the end and was never lost, and its distances from the path.

    `places` are where it truly was after each step, (steps, 2), m, NaN where the simulation
    failed. It has come to the end within two pulses and a tenth of its length.
    """
    progress, across = 0.0, [0.0]
    for place in places[len(_PULSE) - 1 :: len(_PULSE)]:
        if np.isnan(place).any() or across[-1] > follower.ahead:
            break
        along, off = path.project(place, progress)
        progress = float(along)
        across.append(abs(float(off)))
    near = 2.0 * follower.step + 0.1 * follower.ahead
    return progress >= path.length - near and across[-1] <= follower.ahead, np.array(across[1:])


def _pose(state: State) -> Array:
    """The camera's readings: x, y, theta, heading."""
    return np.array([state.x, state.y, state.theta, state.heading])
