"""A camera between robots and their controller."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, fields

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.messages import check_above_zero, check_kind, known_arguments, refuse
from stickslip._util.text import is_number
from stickslip.errors import ScenarioError


@known_arguments
@dataclass(frozen=True, kw_only=True)
class Camera:
    """Frames of place, pitch and heading: late, noisy, and some of them lost.

    Attributes
    ----------
    frame_rate : float
        Frames a second.
    exposure : float
        Time over which a frame averages, s.
    latency : float
        From the end of an exposure to the controller, s.
    noise_x, noise_theta, noise_heading : float
        Standard deviations of the tracking: of x and y, m; of the pitch and the heading, rad.
    pixel : float
        Resolution of x and y, m; 0 for none.
    dropped : float
        Share of lost frames.
    """

    frame_rate: float = 30.0
    exposure: float = 0.0
    latency: float = 0.0
    noise_x: float = 0.0
    noise_theta: float = 0.0
    noise_heading: float = 0.0
    pixel: float = 0.0
    dropped: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):  # the frame rate first: the range of the exposure is by it
            value = getattr(self, field.name)
            low, high = (1e-3 if field.name == "frame_rate" else 0.0), math.inf
            if field.name == "dropped":
                high = 1.0
            elif field.name == "exposure":
                high = 1.0 / self.frame_rate
            if not (is_number(value) and low <= value <= high and math.isfinite(value)):
                until = f" to {high:g}" if math.isfinite(high) else ""
                refuse(f"camera.{field.name}", value, f"a finite number from {low:g}{until}")


class Film:
    """The frames of a camera since an episode began: of one robot, or of many in one image.

    A pose is x (m) and theta (rad), of shape (2,), or (n, 2) for n robots; in the plane it is x, y
    (m), theta and heading (rad), of shape (4,) or (n, 4).

    Raises
    ------
    ScenarioError
        If the camera is none, the period is not above 0, or a pose has another number of values.
    """

    def __init__(self, camera: Camera, period: float, pose: Array) -> None:
        check_kind("camera", camera, Camera)
        check_above_zero("period", period, "s")
        if np.shape(pose)[-1:] not in ((2,), (4,)):
            raise ScenarioError(f"pose of shape {np.shape(pose)}: allowed is (..., 2) or (..., 4)")
        self._camera = camera
        self._places = 1 if pose.shape[-1] == 2 else 2  # x, or x and y
        noises = [camera.noise_x] * self._places + [camera.noise_theta, camera.noise_heading]
        self._noises = noises[: pose.shape[-1]]
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
            seen = self._averaged() + random.standard_normal(pose.shape) * self._noises
            if camera.pixel > 0.0:
                places = seen[..., : self._places]
                places[...] = camera.pixel * np.round(places / camera.pixel)
            if random.random() >= camera.dropped:
                self._coming.append((time, seen))
        while self._coming and self._coming[0][0] + camera.latency <= time + slack:
            self.taken, self.pose = self._coming.popleft()
        return self.pose, time - self.taken

    def _averaged(self) -> Array:
        """The mean over the exposure; headings about the newest one, as they jump by 2 pi."""
        poses = np.array(self._exposed)
        if self._places == 2:
            newest = poses[-1, ..., 3]
            poses[..., 3] = newest + np.remainder(poses[..., 3] - newest + np.pi, 2 * np.pi) - np.pi
        return np.asarray(np.mean(poses, axis=0))
