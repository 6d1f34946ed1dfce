"""What controllers need beside a `Simulator`: a camera, and environments of Gymnasium.

The environments, `stickslip.control.environments`, need the extra ``gym``.
"""

from __future__ import annotations

from stickslip.control.camera import Camera, Film

__all__ = ["Camera", "Film", "register"]

_TASKS = {"Walk": "walk", "Reach": "reach", "Place": "place"}


def register() -> None:
    """Tell Gymnasium of the environments ``stickslip/...-v0``; it calls this itself."""
    import gymnasium

    for name, task in _TASKS.items():
        gymnasium.register(
            id=f"stickslip/{name}-v0",
            entry_point="stickslip.control.environments:RobotEnv",
            vector_entry_point="stickslip.control.environments:RobotVectorEnv",
            max_episode_steps=1000,
            kwargs={"task": task},
        )
