"""The tasks of a robot, and their rewards."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array, Indices, Mask
from stickslip.control.path import Path
from stickslip.errors import ScenarioError


@dataclass(frozen=True)
class Task:
    """A goal, and when it is reached.

    Attributes
    ----------
    steered : bool
        Whether the robot is steered in the whole plane, or stays in its own.
    nearest, farthest : float
        Distances from the start between which the goal is drawn, m; 0: there is none.
    tolerance : float
        Distance at which the goal, or the end of the path, is reached, m.
    at_rest : bool
        Whether the contact has to stick there.
    beside : float
        Of a path: the distance beside it at which it is lost, and how far along it the next goal
        is ahead, m; 0: there is no path.
    """

    steered: bool = False
    nearest: float = 0.0
    farthest: float = 0.0
    tolerance: float = 0.0
    at_rest: bool = False
    beside: float = 0.0


TASKS = {
    "walk": Task(),
    "reach": Task(steered=True, nearest=0.5e-3, farthest=2e-3, tolerance=50e-6),
    "place": Task(nearest=0.05e-3, farthest=0.3e-3, tolerance=2e-6, at_rest=True),
    "follow": Task(steered=True, tolerance=50e-6, beside=0.25e-3),
}
"""Walk as fast as may be along +x; reach a point of the plane; be put down on a point ahead; follow
a path.

The distances are chosen: a second at some 2 mm/s, ten body lengths, a fifth of one; the fine
tolerance is a fortieth of a pulse's step; a path is lost at one body length beside it.
"""


@dataclass(frozen=True)
class Judged:
    """The outcome of a step, arrays of shape (n,); `lost` robots are off their path."""

    rewards: Array
    reached: Mask
    lost: Mask
    figures: dict[str, Array]  # for the `info` of an environment


class Targets:
    """The goal of each robot, or the path and how far each has come along it."""

    def __init__(self, task: Task, count: int, path: Path | None, goal: Array | None) -> None:
        self._task, self._path, self._goal = task, path, goal
        self.goals, self._before = np.zeros((count, 2)), np.zeros((count, 2))
        self._progress, self._seen = np.zeros(count), np.zeros(count)

    @property
    def shown(self) -> tuple[Array | None, Array | None]:
        """The goal of each robot, (n, 2), and the path, (k, 2), m, for a picture; None of none."""
        goals = self.goals if self._task.farthest else None
        return goals, None if self._path is None else self._path.points

    def begin(self, robot: int, place: Array, random: np.random.Generator) -> None:
        """An episode of one robot at `place`, x and y in m."""
        task = self._task
        self._before[robot] = place
        if self._path is not None:
            self.check_begin(place)
            self._progress[robot] = self._seen[robot] = self._path.project(place, 0.0)[0]
        elif self._goal is not None:
            self.goals[robot] = self._goal
        else:
            distance = random.uniform(task.nearest, task.farthest)
            bearing = random.uniform(-np.pi, np.pi) if task.steered else 0.0
            self.goals[robot] = place + distance * np.array([np.cos(bearing), np.sin(bearing)])

    def check_begin(self, place: Array) -> None:
        """Refuse a robot that begins too far from the start of the path."""
        assert self._path is not None
        away = float(np.hypot(*(place - self._path.points[0])))
        if away > self._task.beside:
            raise ScenarioError(
                f"the path begins {1e3 * away:.3g} mm from the robot: allowed is at most "
                f"{1e3 * self._task.beside:.3g} mm; see `initial` of the scenario"
            )

    def judge(self, places: Array, rests: Mask) -> Judged:
        """A step to places (n, 2), m, of robots that rest there or not.

        The reward is the millimetres along x, or by which the goal is nearer, or of progress along
        the path, which count less and less beside it; and one for reaching the goal or the end.
        """
        before, self._before = self._before, places.copy()
        none = np.zeros(len(places), dtype=bool)
        if self._path is not None:
            progress, across = self._path.project(places, self._progress)
            gain, self._progress = progress - self._progress, progress
            beside = np.abs(across) / self._task.beside
            reached = (beside <= 1.0) & (progress >= self._path.length - self._task.tolerance)
            rewards = 1e3 * gain * np.maximum(1.0 - beside, 0.0) + reached
            return Judged(rewards, reached, beside > 1.0, {"progress": progress, "across": across})
        if self._task.farthest == 0.0:
            return Judged(1e3 * (places - before)[:, 0], none, none, {})
        left = np.hypot(*(places - self.goals).T)
        reached = (left <= self._task.tolerance) & (rests | (not self._task.at_rest))
        nearer = np.hypot(*(before - self.goals).T) - left
        return Judged(1e3 * nearer + reached, reached, none, {})

    def offsets(self, robots: Indices, places: Array, exact: bool) -> Array:
        """From robots that are seen at places (k, 2) to where they are to go, (k, 2), m.

        Exact places are those that the step before was judged by.
        """
        if self._path is not None:
            progress = self._progress[robots]
            if not exact:
                progress = self._seen[robots] = self._path.project(places, self._seen[robots])[0]
            return self._path.at(progress + self._task.beside) - places
        return self.goals[robots] - places if self._task.farthest else np.zeros_like(places)
