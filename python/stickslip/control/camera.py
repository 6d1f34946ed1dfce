"""A camera between robots and what a controller sees of them."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, fields

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.number_text import is_number
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import shown


@dataclass(frozen=True, kw_only=True)
class Camera:
    """Frames of x and theta that come late, with noise, and not always.

    Attributes
    ----------
    frame_rate : float
        Frames a second.
    exposure : float
        Time over which a frame averages, s.
    latency : float
        From the end of an exposure to the controller, s.
    noise_x, noise_theta : float
        Standard deviations of the tracking, m and rad.
    pixel : float
        Quantum of x, m; 0: none.
    dropped : float
        Share of frames that never come.
    """

    frame_rate: float = 30.0
    exposure: float = 0.0
    latency: float = 0.0
    noise_x: float = 0.0
    noise_theta: float = 0.0
    pixel: float = 0.0
    dropped: float = 0.0

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            low = 0.0 if each.name != "frame_rate" else 1e-3
            high = {"dropped": 1.0, "exposure": 1.0 / max(self.frame_rate, 1e-3)}.get(
                each.name, math.inf
            )
            if not (isinstance(value, (int, float)) and low <= value <= high):
                raise ScenarioError(
                    f"camera.{each.name} = {value!r}: allowed is a number from {low:g} to {high:g}"
                )


class Film:
    """What a camera has seen since an episode began: of one robot, or of many in one image.

    A pose is x (m) and theta (rad), of shape (2,), or (n, 2) for n robots.
    """

    def __init__(self, camera: Camera, period: float, pose: Array) -> None:
        if not (is_number(period) and 0.0 < period < math.inf):
            raise ScenarioError(f"period = {shown(period)}: allowed is a number of seconds above 0")
        self._camera = camera
        self._next = 0  # frame
        exposed = max(1, round(camera.exposure / period))
        self._exposed: deque[Array] = deque(maxlen=exposed)
        self._coming: deque[tuple[float, Array]] = deque()
        self.pose, self.taken = pose.copy(), 0.0
        """The newest pose that has arrived, and when it was taken (s)."""

    def watch(self, time: float, pose: Array, random: np.random.Generator) -> tuple[Array, float]:
        """Go on to `time` (s), at which the robot is at `pose`; the newest frame and its age, s."""
        camera, slack = self._camera, 1e-9
        self._exposed.append(pose.copy())
        if time + slack >= self._next / camera.frame_rate:
            self._next = math.floor((time + slack) * camera.frame_rate) + 1
            noise = random.standard_normal(pose.shape) * (camera.noise_x, camera.noise_theta)
            seen = np.mean(self._exposed, axis=0) + noise
            if camera.pixel > 0.0:
                seen[..., 0] = camera.pixel * np.round(seen[..., 0] / camera.pixel)
            if random.random() >= camera.dropped:
                self._coming.append((time, seen))
        while self._coming and self._coming[0][0] + camera.latency <= time + slack:
            self.taken, self.pose = self._coming.popleft()
        return self.pose, time - self.taken
