"""What a robot is asked to do, and what it gets for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip._util.numbers import Array
from stickslip.control.path import Path
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import shown, suggestion

_MILLIMETRE = 1e-3


@dataclass(frozen=True)
class Task:
    """A goal, and when it is reached.

    Attributes
    ----------
    name : str
    in_plane : bool
        Whether the robot is steered in the whole plane, or stays in its own, ahead of which the
        goal lies.
    nearest, farthest : float
        Distances from the start between which the goal is drawn, m; both zero: there is none, and
        the way along +x counts.
    tolerance : float
        Distance at which the goal, or the end of the path, is reached, m.
    at_rest : bool
        Whether the contact has to stick there.
    look_ahead : float
        Where a path is to be followed: how far along it the next goal is ahead of the robot, m.
    lost : float
        Distance from the path at which it is lost, m.
    """

    name: str
    in_plane: bool = False
    nearest: float = 0.0
    farthest: float = 0.0
    tolerance: float = 0.0
    at_rest: bool = False
    look_ahead: float = 0.0
    lost: float = 0.0

    @property
    def has_goal(self) -> bool:
        """Whether there is a place to go to."""
        return self.farthest > 0.0 or self.look_ahead > 0.0


TASKS = {
    task.name: task
    for task in (
        Task("walk"),
        Task("reach", in_plane=True, nearest=0.5e-3, farthest=2e-3, tolerance=50e-6),
        Task("place", nearest=0.05e-3, farthest=0.3e-3, tolerance=2e-6, at_rest=True),
        Task("follow", in_plane=True, tolerance=50e-6, look_ahead=0.25e-3, lost=0.25e-3),
    )
}
"""Walk as fast as may be; reach a point of the plane within 50 um; be put down within 2 um of a
point ahead; follow a path.

The distances are chosen: a second at some 2 mm/s, ten body lengths, a fifth of one; the fine
tolerance is a fortieth of a pulse's step; a path is lost at one body length beside it, and its next
goal is as far ahead.
"""


def task_named(name: object) -> Task:
    """The task of that name; a ScenarioError names what there is."""
    if not isinstance(name, str) or name not in TASKS:
        raise ScenarioError(f"task = {shown(name)}: {suggestion(str(name), TASKS)}")
    return TASKS[name]


@dataclass(frozen=True)
class Judged:
    """What a step of robots has brought, arrays of shape (n,).

    `lost` says who has left the path; `figures` go into the `info` of an environment.
    """

    rewards: Array
    reached: NDArray[np.bool_]
    lost: NDArray[np.bool_]
    figures: dict[str, Array]


class PointTargets:
    """A goal for each robot, drawn for each episode; or none, and the way along +x counts.

    `goal`, x and y in m, is that of all robots and episodes.
    """

    def __init__(self, task: Task, count: int, goal: Array | None = None) -> None:
        self._task, self._goal = task, goal
        self._goals, self._before = np.zeros((count, 2)), np.zeros((count, 2))

    def begin(self, robot: int, place: Array, random: np.random.Generator) -> None:
        """An episode of one robot at `place`, x and y in m."""
        distance = random.uniform(self._task.nearest, self._task.farthest)
        bearing = random.uniform(-np.pi, np.pi) if self._task.in_plane else 0.0
        offset = distance * np.array([np.cos(bearing), np.sin(bearing)])
        self._goals[robot] = place + offset if self._goal is None else self._goal
        self._before[robot] = place

    def judge(self, places: Array, rests: NDArray[np.bool_]) -> Judged:
        """A step to places (n, 2), m, of robots that rest there or not.

        The reward is the millimetres by which a robot comes nearer, and one for reaching the goal.
        """
        before, self._before = self._before, places.copy()
        none = np.zeros(len(places), dtype=bool)
        if not self._task.has_goal:
            return Judged((places - before)[:, 0] / _MILLIMETRE, none, none, {})
        left = _distances(places - self._goals)
        reached = (left <= self._task.tolerance) & (rests | (not self._task.at_rest))
        nearer = _distances(before - self._goals) - left
        return Judged(nearer / _MILLIMETRE + reached, reached, none, {})

    def goals(self, robots: NDArray[np.int64], places: Array, exact: bool) -> Array:
        """Where robots that are seen at places (k, 2) are to go, (k, 2); see `PathTargets`."""
        return self._goals[robots] if self._task.has_goal else places


class PathTargets:
    """A path, and how far each robot has come along it."""

    def __init__(self, task: Task, count: int, path: Path) -> None:
        self._task, self._path = task, path
        self._progress, self._seen = np.zeros(count), np.zeros(count)

    def check_begin(self, place: Array) -> None:
        """Refuse a robot that begins at `place`, x and y in m, too far from the path's start."""
        away = float(_distances(place - self._path.points[0]))
        if away > self._task.lost:
            raise ScenarioError(
                f"the path begins {1e3 * away:.3g} mm from the robot: allowed is at most "
                f"{1e3 * self._task.lost:.3g} mm; see `initial` of the scenario"
            )

    def begin(self, robot: int, place: Array, random: np.random.Generator) -> None:
        """An episode of one robot at `place`, x and y in m, near the start of the path."""
        self.check_begin(place)
        self._progress[robot] = self._seen[robot] = self._path.project(place, 0.0)[0]

    def judge(self, places: Array, rests: NDArray[np.bool_]) -> Judged:
        """A step to places (n, 2), m.

        The reward is the millimetres of progress, which count less and less with the distance
        beside the path, and one for reaching the end.
        """
        progress, across = self._path.project(places, self._progress)
        gain, self._progress = progress - self._progress, progress
        beside = np.abs(across) / self._task.lost
        lost = beside > 1.0
        reached = ~lost & (progress >= self._path.length - self._task.tolerance)
        rewards = gain / _MILLIMETRE * np.maximum(1.0 - beside, 0.0) + reached
        return Judged(rewards, reached, lost, {"progress": progress, "across": across})

    def goals(self, robots: NDArray[np.int64], places: Array, exact: bool) -> Array:
        """The places ahead on the path of robots that are seen at places (k, 2); (k, 2).

        Exact places are those that the step before was judged by.
        """
        progress = self._progress[robots]
        if not exact:
            progress = self._seen[robots] = self._path.project(places, self._seen[robots])[0]
        return self._path.at(progress + self._task.look_ahead)


Targets = PointTargets | PathTargets


def _distances(offsets: Array) -> Array:
    return np.asarray(np.hypot(offsets[..., 0], offsets[..., 1]))
