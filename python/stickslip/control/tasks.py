"""The tasks of a robot, and their rewards; places are complex numbers, x + i y, in m."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._util.arrays import Array, Indices, Mask, in_columns
from stickslip.errors import ScenarioError
from stickslip.field.coils import Coils
from stickslip.scenario.scenario import Scenario

Places = NDArray[np.complex128]

_BEHIND, _AHEAD = 0.2e-3, 0.6e-3  # chosen: m, where along the path a robot is looked for
_SLACK = 1e-12  # m, rounding


@dataclass(frozen=True)
class Task:
    """A goal, and when it is reached; distances in m, of which 0 says that there is none."""

    steps: int  # of 1 ms, after which an episode of Gymnasium is truncated
    steered: bool = False  # in the whole plane, else along x
    nearest: float = 0.0  # from here to the farthest the goal is drawn, from the start
    farthest: float = 0.0
    tolerance: float = 0.0  # within which the goal, or the end of the path, is reached
    at_rest: bool = False  # the contact has to stick there
    corridor: float = 0.0  # from the path, where it is lost, and along it to the next goal


TASKS = {
    "walk": Task(1000),
    "reach": Task(2000, steered=True, nearest=0.5e-3, farthest=2e-3, tolerance=50e-6),
    "place": Task(1000, nearest=0.05e-3, farthest=0.3e-3, tolerance=2e-6, at_rest=True),
    "follow": Task(12_000, steered=True, tolerance=50e-6, corridor=0.25e-3),
}
"""Walk as fast as may be along +x; reach a point of the plane; be put down on a point ahead; follow
a path.

The numbers are chosen: a second at some 2 mm/s, ten body lengths, a fifth of one; the fine
tolerance is a fortieth of a pulse's step; a path is lost at one body length from it; a robot of
some 2 mm/s needs half of the steps.
"""


class Targets:
    """The goal of each robot, or the path and how far each has come along it."""

    def __init__(
        self, name: str, count: int, scenario: Scenario,
        path: ArrayLike | None, goal: ArrayLike | None,
    ) -> None:  # fmt: skip
        self._task = task = TASKS[name]
        if path is not None and not task.corridor:
            raise ScenarioError(f'path: the task "{name}" follows none')
        if goal is not None and not task.farthest:
            raise ScenarioError(f'goal: the task "{name}" takes none')
        if path is None:  # a figure of eight
            u = np.linspace(0.0, 2.0 * np.pi, 361)
            path = np.column_stack([2e-3 * np.sin(u), 1e-3 * np.sin(2.0 * u)])
        corners = _as_places("path", path, scenario) if task.corridor else None
        self._path = None if corners is None else _Polyline(corners)
        self._draws_goal = goal is None and task.farthest > 0.0
        self._goals = np.full(count, 0j if goal is None else _as_places("goal", goal, scenario))
        self._before = np.zeros(count, dtype=complex)
        self._progress, self._seen = np.zeros(count), np.zeros(count)

    def begin(self, robot: int, place: complex, random: np.random.Generator) -> None:
        """Begin an episode of one robot; refuse a place too far from the start of the path."""
        task, self._before[robot] = self._task, place
        if self._path is not None:
            away, most = abs(place - self._path.corners[0]), task.corridor
            if away > most:
                raise ScenarioError(
                    f"the path begins {1e3 * away:.3g} mm from the robot: allowed is at most "
                    f"{1e3 * most:.3g} mm; see `initial` of the scenario"
                )
            along = self._path.project(np.array([place]), np.zeros(1))[0]
            self._progress[robot] = self._seen[robot] = along[0]
        elif self._draws_goal:
            distance = random.uniform(task.nearest, task.farthest)
            bearing = random.uniform(-np.pi, np.pi) if task.steered else 0.0
            self._goals[robot] = place + distance * complex(np.cos(bearing), np.sin(bearing))

    def judge(self, places: Places, rests: Mask) -> tuple[Array, Mask, Mask, dict[str, Array]]:
        """Judge a step to places of robots that rest there or not.

        Of each robot: the millimetres that it gained along x, or by which the goal is nearer, or
        along the path, which count less and less across it; whether it reached the goal or the
        end, or lost the path; and figures for `info`.
        """
        before, self._before = self._before, places
        none = np.zeros(len(places), dtype=bool)
        if self._path is not None:
            progress, across = self._path.project(places, self._progress)
            gain, self._progress = progress - self._progress, progress
            off = np.abs(across) / self._task.corridor
            reached = (off <= 1.0) & (progress >= self._path.length - self._task.tolerance)
            gain *= 1e3 * np.maximum(1.0 - off, 0.0)
            return gain, reached, off > 1.0, {"progress": progress, "across": across}
        if not self._task.farthest:
            return 1e3 * (places - before).real, none, none, {}
        away = np.abs(places - self._goals)
        reached = (away <= self._task.tolerance) & (rests | (not self._task.at_rest))
        return 1e3 * (np.abs(before - self._goals) - away), reached, none, {}

    def offsets(self, robots: Indices, places: Places, exact: bool) -> Places:
        """Return vectors from robots, as seen at places of shape (k,), to their goals.

        Exact places are those that the step before was judged by.
        """
        if self._path is None:
            return self._goals[robots] - places if self._task.farthest else np.zeros_like(places)
        progress = self._progress[robots]
        if not exact:
            progress = self._seen[robots] = self._path.project(places, self._seen[robots])[0]
        return self._path.at(progress + self._task.corridor) - places


class _Polyline:
    """A path by its arc length."""

    def __init__(self, corners: Places) -> None:
        if len(corners) < 2:
            raise ScenarioError(
                f"path of shape ({len(corners)}, 2): allowed are two corners or more"
            )
        sides = np.diff(corners)
        lengths = np.abs(sides)
        if not lengths.all():
            again = int(np.argmin(lengths)) + 1
            raise ScenarioError(f"path: corner {again} is where the one before it is")
        self.corners, self._lengths, self._directions = corners, lengths, sides / lengths
        self._starts = np.concatenate([[0.0], np.cumsum(lengths)])
        self.length = float(self._starts[-1])
        # Sides that lie within what is looked at from a progress, at most.
        ends = np.searchsorted(self._starts, self._starts[:-1] + _BEHIND + _AHEAD, side="right")
        self._window = np.arange(int(np.max(ends - np.arange(len(lengths)))) + 1)

    def at(self, progress: Array) -> Places:
        """Return the places at arc lengths, m; beyond an end, that end."""
        return np.asarray(np.interp(progress, self._starts, self.corners))

    def project(self, places: Places, before: Array) -> tuple[Array, Array]:
        """Return the arc length of the nearest points of the path, and the distance to its left, m.

        They are looked for near the arc lengths before, so that a path may cross itself.
        """
        low, high = before[:, None] - _BEHIND, before[:, None] + _AHEAD
        first = np.searchsorted(self._starts, low, side="right") - 1
        sides = np.clip(first + self._window, 0, len(self._lengths) - 1)
        starts = self._starts[sides]
        off = (places[:, None] - self.corners[sides]) * self._directions[sides].conj()
        near = np.clip(off.real, low - starts, high - starts)
        near = np.clip(near, 0.0, self._lengths[sides])
        progress, distances = starts + near, np.abs(off - near)
        within = (progress > low - _SLACK) & (progress < high + _SLACK)
        best = np.arange(len(places)), np.argmin(np.where(within, distances, np.inf), axis=1)
        return progress[best], np.copysign(distances, off.imag)[best]


def _as_places(name: str, given: ArrayLike, scenario: Scenario) -> Places:
    """The corners of a path, or a goal, as places, if all lie where the coils' field is known."""
    allowed, axes = (
        ("x and y, m", 1) if name == "goal" else ("shape (k, 2) of finite x and y, m", 2)
    )
    points = in_columns(name, given, ("x", "y"), allowed, axes=axes, unit="m")
    coils = Coils.of(scenario)
    far = float(np.min(coils.distance))
    (x0, y0, *_), (x1, y1, *_) = coils.box or ([-far, -far], [far, far])
    for x, y in np.atleast_2d(points):
        if not (x0 <= x <= x1 and y0 <= y <= y1):
            raise ScenarioError(
                f"{name}: ({x:g}, {y:g}) m lies beyond the coils' field: allowed are x from {x0:g} "
                f"to {x1:g} m and y from {y0:g} to {y1:g} m"
            )
    return np.asarray(points[..., 0] + 1j * points[..., 1])
