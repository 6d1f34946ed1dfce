"""Film an episode of an environment of Gymnasium: pixels by numpy, from the robots' states.

``python side_view.py`` lets a robot walk and writes walk.webp, seen from its right.
``python side_view.py --above`` drives it to a point and writes reach.webp, seen from above.

``View(env)`` gives any environment of stickslip a `render`, so that
``gymnasium.wrappers.RecordVideo(View(env), folder)`` works too, with the package moviepy. Of a
vector, draw row i by ``side_view(envs.robots[i], envs.states[i])``.
"""

from __future__ import annotations

import argparse
import itertools
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from stickslip import STATE_COLUMNS, Scenario
from stickslip.control import environments

Array = NDArray[np.float64]
Pixels = NDArray[np.uint8]

SIZE = (240, 400)  # rows and columns, chosen
LENGTHS = 6.0  # of the robot, that a view is wide; chosen
WHITE, GREY, BLUE, RED = (255, 255, 255), (190, 190, 190), (0, 114, 178), (213, 94, 0)
PLACE = [STATE_COLUMNS.index(name) for name in ("x", "y", "z", "theta", "heading")]
FRAMES = 25  # a second: a film of every step of 1 ms is 40 times slower than the motion
PULSE = np.linspace(1.0, 0.2, 10)


def side_view(robot: Scenario, state: Array, goal: Array | None = None) -> Pixels:
    """Draw a robot from its right, over a surface with marks as long as it.

    `state` has the columns of `STATE_COLUMNS`; `goal` is a place along the surface, (2,), m, of
    which x is drawn. The pixels are of shape (240, 400, 3).
    """
    x, _, z, theta, heading = state[PLACE]
    length, height = robot.robot.length, robot.robot.height
    image, points = empty(x, 0.15 * LENGTHS * length, LENGTHS * length)
    ground = points[..., 1] < 0.0
    image[ground] = 0.93 * np.array(GREY)
    image[ground & (np.floor(points[..., 0] / length) % 2 == 0)] = GREY
    if goal is not None:
        image[ground & (np.abs(points[..., 0] - goal[0]) < 0.02 * length)] = RED
    ahead = 1.0 if np.cos(heading) >= 0.0 else -1.0
    draw_body(image, ahead * (points[..., 0] - x), points[..., 1] - z, -theta, length, height)
    return image


def view_from_above(
    robot: Scenario, state: Array, goal: Array | None = None, path: Array | None = None
) -> Pixels:
    """Draw a robot from above, with its goal and its path, shape (k, 2), m; as `side_view`."""
    x, y, _, _, heading = state[PLACE]
    length, width = robot.robot.length, robot.robot.width
    image, points = empty(x, y, 2.0 * LENGTHS * length)
    for begin, end in [] if path is None else itertools.pairwise(path):
        along = np.clip((points - begin) @ (end - begin) / np.sum((end - begin) ** 2), 0.0, 1.0)
        away = points - begin - along[..., None] * (end - begin)
        image[np.hypot(away[..., 0], away[..., 1]) < 0.05 * length] = GREY
    if goal is not None:
        image[np.hypot(*np.moveaxis(points - goal, -1, 0)) < 0.2 * length] = RED
    draw_body(image, points[..., 0] - x, points[..., 1] - y, heading, length, width)
    return image


def empty(x: float, y: float, width: float) -> tuple[Pixels, Array]:
    """Make white pixels, and the places that they show, (rows, columns, 2), about (x, y), m."""
    rows, columns = SIZE
    step = width / columns
    across = x + step * (np.arange(columns) - 0.5 * (columns - 1))
    up = y - step * (np.arange(rows) - 0.5 * (rows - 1))
    image = np.full((rows, columns, 3), WHITE, dtype=np.uint8)
    return image, np.stack(np.meshgrid(across, up), axis=-1)


def draw_body(image: Pixels, x: Array, y: Array, angle: float, length: float, side: float) -> None:
    """Draw a rectangle about x = y = 0, turned to the left; its front is the north pole."""
    along = np.cos(angle) * x + np.sin(angle) * y
    across = np.cos(angle) * y - np.sin(angle) * x
    inside = (np.abs(along) <= 0.5 * length) & (np.abs(across) <= 0.5 * side)
    image[inside] = BLUE
    image[inside & (along > 0.0)] = RED


class View(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Draw an environment of one robot: from its right, or in the whole plane from above.

    The goal is where the observation shows it; a `path`, shape (k, 2), m, is drawn if it is given.
    """

    render_mode = "rgb_array"

    def __init__(self, env: gymnasium.Env[Any, Any], path: Array | None = None) -> None:
        super().__init__(env)
        self.metadata = {**env.metadata, "render_modes": ["rgb_array"], "render_fps": FRAMES}
        self._path, self._goal = path, np.zeros(2)

    def reset(self, **options: Any) -> tuple[Any, dict[str, Any]]:
        """Begin an episode."""
        observation, info = self.env.reset(**options)
        self._see(observation)
        return observation, info

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Play one period."""
        found = self.env.step(action)
        self._see(found[0])
        return found

    def render(self) -> Pixels:
        """Draw the robot as it is now."""
        envs = self.unwrapped.vector
        robot, state = envs.robots[0], envs.states[0]
        if envs.task in ("reach", "follow"):
            return view_from_above(robot, state, self._goal, self._path)
        return side_view(robot, state, self._goal if envs.task == "place" else None)

    def _see(self, observation: Array) -> None:
        # With a camera or without, the goal from the body and the place of the body come first.
        units = [*environments.OBSERVED.values()][:6]
        ahead, left, cosine, sine, x, y = observation[:6] * units
        self._goal = np.array([x + cosine * ahead - sine * left, y + sine * ahead + cosine * left])


def film(env: View, steps: int, every: int) -> tuple[list[Pixels], bool]:
    """Play pulses towards the goal, at most so many steps, and draw every so many of them.

    Also returns whether the goal is reached.
    """
    observation, info = env.reset(seed=1)
    frames, over = [env.render()], False
    for step in range(steps):
        xp = PULSE[step % 10]
        turn = np.clip(np.arctan2(observation[1], observation[0]), -1.0, 1.0)
        action = [xp, -0.4] if env.action_space.shape == (2,) else [turn, 2.5 * xp - 1.5, -0.4]
        observation, _, *ends, info = env.step(np.float32(action))
        over = any(ends)
        if step % every == 0 or over:
            frames.append(env.render())
        if over:
            break
    return frames, bool(info["success"])


def main() -> None:
    """Write a film of an episode."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--above", action="store_true")
    task, steps, every = ("reach", 2000, 20) if parser.parse_args().above else ("walk", 100, 1)
    frames, reached = film(View(gymnasium.make(f"stickslip/{task.capitalize()}-v0")), steps, every)
    first, *others = map(Image.fromarray, frames)
    timing = {"duration": 1000 // FRAMES, "loop": 0}  # ms; for ever
    first.save(f"{task}.webp", save_all=True, append_images=others, lossless=True, **timing)
    print(f"{len(frames)} frames{', the goal is reached' * reached}")


if __name__ == "__main__":
    main()
