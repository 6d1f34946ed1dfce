"""For controllers, beside a `Simulator`: a camera, paths, voltages along a heading.

`stickslip.control.environments` has environments of Gymnasium; it needs the extra ``gym``.
"""

from __future__ import annotations

from stickslip.control.camera import Camera, Film
from stickslip.control.follower import Followed, Follower, follow
from stickslip.control.path import Path
from stickslip.control.steering import field_voltages, heading_voltages

__all__ = [
    "Camera",
    "Film",
    "Followed",
    "Follower",
    "Path",
    "field_voltages",
    "follow",
    "heading_voltages",
]
