"""What a robot is asked to do, and what it gets for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip._util.arrays import Array
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import shown, suggestion
from stickslip.scenario.state import CONTACT_WORDS

_RESTS = [CONTACT_WORDS.index(name) for name in ("corner_stick", "face_stick")]
_MILLIMETRE = 1e-3


@dataclass(frozen=True)
class Task:
    """A goal, and when it is reached.

    Attributes
    ----------
    name : str
    nearest, farthest : float
        Distances from the start between which the goal is drawn, m; both zero: there is none, and
        the way along +x counts.
    tolerance : float
        Distance at which the goal is reached, m.
    at_rest : bool
        Whether the contact has to stick there.
    """

    name: str
    nearest: float = 0.0
    farthest: float = 0.0
    tolerance: float = 0.0
    at_rest: bool = False

    def draw_goal(self, random: np.random.Generator) -> float:
        """A goal ahead of the start, m."""
        return float(random.uniform(self.nearest, self.farthest))

    def reward(self, before: Array, after: Array, goal: Array, reached: NDArray[np.bool_]) -> Array:
        """For going from `before` to `after`, m: mm of the way, and one for reaching the goal."""
        if self.farthest == 0.0:
            return (after - before) / _MILLIMETRE
        nearer = np.abs(before - goal) - np.abs(after - goal)
        return np.asarray(nearer / _MILLIMETRE + reached)

    def reached(self, x: Array, goal: Array, contact: Array) -> NDArray[np.bool_]:
        """Whether robots at x (m), with contacts as in an array of states, are at the goal."""
        if self.farthest == 0.0:
            return np.zeros(len(x), dtype=bool)
        near = np.abs(x - goal) <= self.tolerance
        return near & np.isin(contact, _RESTS) if self.at_rest else near


TASKS = {
    task.name: task
    for task in (
        Task("walk"),
        Task("reach", nearest=0.5e-3, farthest=2e-3, tolerance=50e-6),
        Task("place", nearest=0.05e-3, farthest=0.3e-3, tolerance=2e-6, at_rest=True),
    )
}
"""Walk as fast as may be; reach a point within 50 um; be put down within 2 um of one.

The distances are chosen: a second at some 2 mm/s, ten body lengths, a fifth of one; the fine
tolerance is a fortieth of a pulse's step.
"""


def task_named(name: object) -> Task:
    """The task of that name; a ScenarioError names what there is."""
    if not isinstance(name, str) or name not in TASKS:
        raise ScenarioError(f"task = {shown(name)}: {suggestion(str(name), TASKS)}")
    return TASKS[name]
