"""What controllers need beside a `Simulator`: a camera, paths, and environments of Gymnasium.

The environments, `stickslip.control.environments`, need the extra ``gym``.
"""

from __future__ import annotations

from stickslip.control.camera import Camera, Film
from stickslip.control.path import Path
from stickslip.control.steering import heading_voltages

__all__ = ["Camera", "Film", "Path", "heading_voltages"]
