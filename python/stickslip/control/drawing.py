"""A robot as pixels: what an environment draws, by numpy alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip._util.arrays import Array, Mask
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import STATE_COLUMNS

Pixels = NDArray[np.uint8]

_SIZE = (240, 400)  # rows and columns, chosen
_LENGTHS = 6.0  # of the robot, that a view is wide; chosen
_WHITE, _GREY, _BLUE, _RED = (255, 255, 255), (190, 190, 190), (0, 114, 178), (213, 94, 0)
_PLACE = [STATE_COLUMNS.index(name) for name in ("x", "y", "z", "theta", "heading")]


def side_view(scenario: Scenario, state: Array, goal: Array | None) -> Pixels:
    """The robot from its right, over the surface with a mark every length of it.

    Parameters
    ----------
    state : ndarray
        A row of `STATE_COLUMNS`.
    goal : ndarray, shape (2,), or None
        Place along the surface, m; only x is drawn.

    Returns
    -------
    ndarray of uint8, shape (240, 400, 3)
    """
    x, _, z, theta, heading = state[_PLACE]
    robot = scenario.robot
    ahead = 1.0 if np.cos(heading) >= 0.0 else -1.0
    image, points = _empty(x, 0.15 * _LENGTHS * robot.length, _LENGTHS * robot.length)
    ground = points[..., 1] < 0.0
    marked = np.floor(points[..., 0] / robot.length) % 2 == 0
    image[ground] = 0.93 * np.array(_GREY)
    image[ground & marked] = _GREY
    if goal is not None:
        wide = 0.02 * robot.length
        image[ground & (np.abs(points[..., 0] - goal[0]) < wide)] = _RED
    way = ahead * (points[..., 0] - x)
    _draw_body(image, way, points[..., 1] - z, -theta, robot.length, robot.height)
    return image


def view_from_above(
    scenario: Scenario, state: Array, goal: Array | None, path: Array | None
) -> Pixels:
    """The robot from above, with its goal and its path, shape (k, 2), m; else as `side_view`."""
    x, y, _, _, heading = state[_PLACE]
    robot = scenario.robot
    image, points = _empty(x, y, 2.0 * _LENGTHS * robot.length)
    if path is not None:
        begins, steps = path[:-1], np.diff(path, axis=0)
        near = np.full(points.shape[:2], np.inf)
        for begin, step in zip(begins, steps, strict=True):
            part = np.clip((points - begin) @ step / max(float(step @ step), 1e-300), 0.0, 1.0)
            away = points - begin - part[..., None] * step
            near = np.minimum(near, np.hypot(away[..., 0], away[..., 1]))
        image[near < 0.05 * robot.length] = _GREY
    if goal is not None:
        image[np.hypot(*np.moveaxis(points - goal, -1, 0)) < 0.2 * robot.length] = _RED
    _draw_body(image, points[..., 0] - x, points[..., 1] - y, heading, robot.length, robot.width)
    return image


def _empty(x: float, y: float, width: float) -> tuple[Pixels, Array]:
    """White pixels, and the places that they show, (rows, columns, 2), about a middle, m."""
    rows, columns = _SIZE
    step = width / columns
    across = x + step * (np.arange(columns) - 0.5 * (columns - 1))
    up = y - step * (np.arange(rows) - 0.5 * (rows - 1))
    image = np.full((rows, columns, 3), _WHITE, dtype=np.uint8)
    return image, np.stack(np.meshgrid(across, up), axis=-1)


def _draw_body(image: Pixels, x: Array, y: Array, angle: float, length: float, side: float) -> None:
    """A rectangle about the origin of x and y, turned to the left; its front is the north pole."""
    along = np.cos(angle) * x + np.sin(angle) * y
    across = np.cos(angle) * y - np.sin(angle) * x
    inside: Mask = (np.abs(along) <= 0.5 * length) & (np.abs(across) <= 0.5 * side)
    image[inside] = _BLUE
    image[inside & (along > 0.0)] = _RED
