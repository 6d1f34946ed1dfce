"""For controllers, next to a `Simulator`: a camera, and voltages along a heading.

`stickslip.control.environments` has environments of Gymnasium; it needs the extra ``gym``.
"""

from __future__ import annotations

from stickslip.control.camera import Camera, Film
from stickslip.control.steering import heading_voltages

__all__ = ["Camera", "Film", "heading_voltages"]
