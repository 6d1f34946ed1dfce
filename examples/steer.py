"""A robot follows a path by what a camera shows: pure pursuit, pulse by pulse.

``python steer.py`` takes it along a figure of eight and draws its path into path.png.
``python steer.py --robots 100`` judges that on robots that differ.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

import numpy as np
from controllers import drawn
from matplotlib.figure import Figure
from numpy.typing import NDArray

from stickslip import (
    STATE_COLUMNS,
    Drive,
    Run,
    Scenario,
    Simulator,
    State,
    Waveform,
    plot,
    rollout,
    simulate,
)
from stickslip.control import Camera, Film, Path, heading_voltages

Array = NDArray[np.float64]
Random = np.random.Generator

CAMERA = Camera(frame_rate=30.0, latency=0.05, noise_x=3e-6, noise_heading=0.02)
STEP = 1e-3  # s
STANDS = np.full(50, 13.0)  # V, of a coil along the heading: the robot stands up
PULSE = np.linspace(26.0, 5.0, 10)  # V: the field rises at once and falls slowly
CLAMP = -10.4  # V
AHEAD = 0.25e-3  # m
MOST = 0.25  # rad, by which one pulse turns the robot at most
LIMIT = 30.0  # s, after which a robot that has not arrived is given up


class Follower:
    """Each pulse heads for a point of the path that lies ahead of the robot."""

    def __init__(self, path: Path) -> None:
        self.path, self.progress, self.heading = path, 0.0, 0.0
        self.step = 19e-6  # of a pulse, m: a median, until this robot's is known
        self._seen = 0.0  # progress in the newest frame, m
        self._headings: list[float] = []  # of all pulses

    def decide(self, seen: Array, age: float) -> float:
        """Heading of the next pulse, rad, by the newest frame's place (m) and age (s)."""
        headings = self._headings
        before = max(len(headings) - round(age / (STEP * len(PULSE))), 0)
        self._seen, _ = self.path.project(seen, self._seen)
        if before > 20:
            self.step = self._seen / before
        since = headings[before:]
        place = seen + self.step * np.array([np.cos(since).sum(), np.sin(since).sum()])
        self.progress, _ = self.path.project(place, self.progress)
        ahead = self.path.at(self.progress + AHEAD) - place
        bearing = math.atan2(ahead[1], ahead[0])
        turn = math.remainder(bearing - self.heading, 2.0 * math.pi)
        self.heading += min(max(turn, -MOST), MOST)
        headings.append(self.heading)
        return self.heading

    @property
    def arrived(self) -> bool:
        """Whether the robot should be at the end, within a pulse."""
        return bool(self.progress >= self.path.length - self.step)


def follow(robot: Scenario, path: Path, random: Random) -> tuple[Array, Array]:
    """States after each step of 1 ms, (steps, 21), and its voltages, (steps, 5).

    `random` makes the noise of the camera.
    """
    sim, follower = Simulator(robot, whole_plane=True), Follower(path)
    film = Film(CAMERA, STEP, pose_of(sim.state))
    states, played = [], []
    voltages = heading_voltages(follower.heading, STANDS, CLAMP)
    while not follower.arrived and sim.time < LIMIT:
        for volts in voltages:
            state = sim.step(volts, STEP)
            seen, age = film.watch(sim.time, pose_of(state), random)
            states.append(state.row)
            played.append(volts)
        heading = follower.decide(seen[:2], age)
        voltages = heading_voltages(heading, PULSE, CLAMP)
    return np.array(states), np.array(played)


def pose_of(state: State) -> Array:
    """What the camera sees: x, y, theta, heading."""
    return np.array([state.x, state.y, state.theta, state.heading])


def replayed(played: Array) -> Run:
    """The recorded run of voltages, (steps, 5), each held for a step."""
    times = STEP * np.repeat(np.arange(len(played) + 1), 2)[1:-1]
    program = Waveform.from_points(times, np.repeat(played, 2, axis=0))
    steered = Scenario(drive=Drive(mode="program", program=program))
    return simulate(steered.replace({"record.rate": 1e3}))


LOST = 0.25e-3  # m; a robot one body length beside the path has lost it
ARRIVED = 50e-6  # m, from the end; a pulse and a half, and the error of the place expected
PLACE = [STATE_COLUMNS.index("x"), STATE_COLUMNS.index("y")]


def judged(places: Array, path: Path) -> tuple[bool, Array]:
    """Whether a robot came to the end and was never lost, and its distances from the path.

    `places` are where it truly was after each step, (steps, 2), m, NaN where the simulation
    failed; the distances are those after each pulse, m, as long as it was not lost.
    """
    progress, across = 0.0, [0.0]
    for place in places[len(PULSE) - 1 :: len(PULSE)]:
        if np.isnan(place).any() or across[-1] > LOST:
            break
        progress, off = path.project(place, progress)
        across.append(abs(float(off)))
    return progress >= path.length - ARRIVED and across[-1] <= LOST, np.array(across[1:])


def row(name: str, robots: Sequence[Array], path: Path) -> str:
    """A row of the table; what a robot does once it is lost does not count in it."""
    outcomes = [judged(places, path) for places in robots]
    times = [STEP * len(PULSE) * len(off) for followed, off in outcomes if followed]
    errors = 1e6 * np.quantile(np.concatenate([off for _, off in outcomes]), [0.5, 0.95, 1.0])
    numbers = " | ".join(f"{error:.0f}" for error in errors)
    spans = "{:.1f} ({:.1f} to {:.1f})".format(*np.quantile(times or [math.nan], [0.5, 0.0, 1.0]))
    return f"| {name} | {len(times)} of {len(outcomes)} | {numbers} | {spans} |"


def main() -> None:
    """Draw the path of one robot, or print how many follow it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=0)
    count, eight = parser.parse_args().robots, Path.figure_of_eight()
    if count:
        robots = drawn(count, seed=2)
        seen = [follow(robot, eight, np.random.default_rng(k)) for k, robot in enumerate(robots)]
        _, volts = follow(Scenario(), eight, np.random.default_rng(0))
        blind = rollout(robots, None, volts, STEP, record=("x", "y")).states
        print("| by | followed | error, um | 95 % | largest | time, s |")
        print("| --- | --- | --- | --- | --- | --- |")
        print(row("camera", [states[:, PLACE] for states, _ in seen], eight))
        print(row("the voltages of another robot", list(blind), eight))
        return
    _, volts = follow(Scenario(), eight, np.random.default_rng(1))
    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    plot.path(replayed(volts), along=eight, ax=figure.subplots())
    plot.save(figure, "path.png")


if __name__ == "__main__":
    main()
