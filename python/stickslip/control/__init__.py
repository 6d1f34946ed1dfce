"""For controllers, beside a `Simulator`: a camera, paths, voltages along a heading.

`stickslip.control.environments` has environments of Gymnasium; it needs the extra ``gym``.
"""

from __future__ import annotations

from stickslip.control.camera import Camera, Film
from stickslip.control.path import Path
from stickslip.control.steering import heading_voltages

__all__ = ["Camera", "Film", "Path", "heading_voltages"]
