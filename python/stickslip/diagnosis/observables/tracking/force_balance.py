"""Balances of torque and force of a body on one corner: the core's, of smoothed motions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.diagnosis.observables.tracking.camera import Recording
from stickslip.scenario.scenario import Scenario

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Kinematics:
    """Motion over a grid of phases, shape (..., g), in the robot's own frame, SI units.

    The tilt, nose-down positive, with its derivatives, and the centre of mass with its own.
    """

    theta: Array
    omega: Array
    alpha: Array
    x: Array
    vx: Array
    ax: Array


@dataclass(frozen=True)
class Balances:
    """Inertia of a motion less all forces of a scenario, Eqs. (8)-(14), (18), (19), shape (..., g).

    `torque` is about a pinned corner, N m; `force` along the surface while the corner slips, N;
    `friction_ratio` friction over normal force while it is pinned; `contact_velocity` that of the
    corner along the surface, m/s. The largest torque of the field, `torque_scale`, N m, and the
    `weight` with adhesion, N, are for judging sizes.
    """

    torque: Array
    force: Array
    friction_ratio: Array
    contact_velocity: Array
    torque_scale: float
    weight: float


class Balance:
    """The forces of a simulated run at given `times`, shape (g,), s, with all its effects.

    The recording `motion` says where the robot is and which of its corners touches; `direction`,
    shape (g,), is the way in which the corner slips, +1 or -1 in the robot's own frame.
    """

    def __init__(
        self, scenario: Scenario, motion: Recording, times: Array, direction: Array
    ) -> None:
        self._core = scenario.to_core()
        t = motion["t"]
        touched = np.maximum.accumulate(np.where(motion["contact"] == 0, t, t[0]))
        age = times - touched[np.searchsorted(t, times, side="right") - 1]
        place = [np.interp(times, t, motion[name]) for name in ("x", "z", "theta")]
        self._points = np.stack([times, *place, age, direction], axis=1)

    def __call__(self, moving: Kinematics) -> Balances:
        """Balances of motions at these times."""
        shape = moving.theta.shape
        columns = (moving.theta, moving.omega, moving.alpha, moving.vx, moving.ax)
        motions = np.stack(columns, axis=-1).reshape(-1, shape[-1], len(columns))
        found = _core.corner_balances(self._core, self._points, motions)
        return Balances(
            found["torque"].reshape(shape),
            found["force"].reshape(shape),
            found["friction_ratio"].reshape(shape),
            found["contact_velocity"].reshape(shape),
            found["torque_scale"],
            found["weight"],
        )
