"""What controllers need beside a `Simulator`: a camera, and environments of Gymnasium.

The environments, `stickslip.control.environments`, need the extra ``gym``.
"""

from __future__ import annotations

from stickslip.control.camera import Camera, Film

__all__ = ["Camera", "Film"]
