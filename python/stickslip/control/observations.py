"""What a controller sees of robots: their whole state, or what a camera shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip._util.numbers import Array, Indices
from stickslip.control.camera import Camera, Film
from stickslip.control.tasks import Targets
from stickslip.scenario.state import STATE_COLUMNS

OBSERVED = ("to goal", "x", "z", "theta", "vx", "vz", "omega", "current_xp", "current_clamp")
"""Columns of an observation without a camera."""

CAMERA_OBSERVED = ("to goal", "x", "theta", "age")
"""Columns of an observation with a camera: the pose that the newest frame shows, and its age."""

UNITS = (1e-3, 1e-3, 1e-4, 1.0, 1e-2, 1e-2, 100.0, 1.0, 1.0)
"""What one stands for in each column of `OBSERVED`, in SI units: about the size of a walk's."""

CAMERA_UNITS = (1e-3, 1e-3, 1.0, 0.1)
"""The same with a camera; the age is in tenths of a second."""

_CURRENTS = ("current_xp", "current_xm", "current_yp", "current_ym", "current_clamp")
_MOTION = ("x", "y", "z", "theta", "vx", "vy", "vz", "omega", *_CURRENTS)

OBSERVED_IN_PLANE = ("goal ahead", "goal left", "cos heading", "sin heading", *_MOTION)
"""Columns of an observation in the whole plane without a camera: how far the goal is ahead of the
robot and to its left, where it faces, and its state."""

CAMERA_OBSERVED_IN_PLANE = (*OBSERVED_IN_PLANE[:4], "x", "y", "theta", "age")
"""The same with a camera: of the pose that the newest frame shows, and its age."""

UNITS_IN_PLANE = (
    *(1e-3, 1e-3, 1.0, 1.0),
    *(1e-3, 1e-3, 1e-4, 1.0, 1e-2, 1e-2, 1e-2, 100.0),
    *(1.0, 1.0, 1.0, 1.0, 1.0),
)
"""What one stands for in each column of `OBSERVED_IN_PLANE`, in SI units."""

CAMERA_UNITS_IN_PLANE = (1e-3, 1e-3, 1.0, 1.0, 1e-3, 1e-3, 1.0, 0.1)
"""The same with a camera."""


def columns_of(names: Sequence[str]) -> list[int]:
    """Where these fields stand in an array of states."""
    return [STATE_COLUMNS.index(name) for name in names]


PLACE = columns_of(["x", "y"])
_POSE, _POSE_IN_PLANE = columns_of(["x", "theta"]), columns_of(["x", "y", "theta", "heading"])
_STATE, _STATE_IN_PLANE = columns_of(OBSERVED[1:]), columns_of(_MOTION)
_HEADING = STATE_COLUMNS.index("heading")


class Observer:
    """Observations of robots, whose states are rows of `STATE_COLUMNS`."""

    def __init__(self, camera: Camera | None, in_plane: bool, period: float, count: int) -> None:
        self._camera, self._in_plane, self._period = camera, in_plane, period
        self._films: list[Film | None] = [None] * count
        of_state, of_frames = (
            (UNITS_IN_PLANE, CAMERA_UNITS_IN_PLANE) if in_plane else (UNITS, CAMERA_UNITS)
        )
        self.units = np.array(of_state if camera is None else of_frames)
        """What one stands for in each column, SI units."""

    def begin(self, robot: int, state: Array) -> None:
        """An episode of one robot."""
        if self._camera is not None:
            self._films[robot] = Film(self._camera, self._period, self._pose(state))

    def observed(
        self,
        robots: Indices,
        states: Array,
        times: Array,
        targets: Targets,
        random: Sequence[np.random.Generator],
    ) -> Array:
        """Observations (k, columns) of some robots at times (k,), s; to be asked for once a step.

        `states` (k, ...) are theirs, `random` are the generators of all robots.
        """
        if self._camera is None:
            places, headings = states[:, PLACE], states[:, _HEADING]
            seen = states[:, _STATE_IN_PLANE if self._in_plane else _STATE]
        else:
            seen = self._watched(robots, states, times, random)
            places = seen[:, [0, 1]] if self._in_plane else _on_axis(seen[:, 0])
            headings = seen[:, 3] if self._in_plane else np.zeros(len(robots))
            seen = np.delete(seen, 3, axis=1) if self._in_plane else seen
        offsets = targets.goals(robots, places, exact=self._camera is None) - places
        if not self._in_plane:
            return np.asarray(np.column_stack([offsets[:, 0], seen]) / self.units)
        cosine, sine = np.cos(headings), np.sin(headings)
        ahead = cosine * offsets[:, 0] + sine * offsets[:, 1]
        left = cosine * offsets[:, 1] - sine * offsets[:, 0]
        return np.asarray(np.column_stack([ahead, left, cosine, sine, seen]) / self.units)

    def _watched(
        self,
        robots: Indices,
        states: Array,
        times: Array,
        random: Sequence[np.random.Generator],
    ) -> Array:
        """The poses that the frames show, and their ages, s."""
        rows = []
        for robot, state, time in zip(robots, states, times, strict=True):
            film = self._films[robot]
            assert film is not None
            pose, age = film.watch(float(time), self._pose(state), random[robot])
            rows.append([*pose, age])
        return np.array(rows)

    def _pose(self, state: Array) -> Array:
        return state[_POSE_IN_PLANE if self._in_plane else _POSE]


def _on_axis(x: Array) -> Array:
    return np.column_stack([x, np.zeros(len(x))])
