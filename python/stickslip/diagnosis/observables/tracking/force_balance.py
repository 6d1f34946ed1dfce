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

    Attributes
    ----------
    theta, omega, alpha : ndarray
        Tilt, nose-down positive, and its derivatives.
    x, vx, ax : ndarray
        Of the centre of mass.
    """

    theta: Array
    omega: Array
    alpha: Array
    x: Array
    vx: Array
    ax: Array


@dataclass(frozen=True)
class Balances:
    """What the forces of a scenario leave over of a motion, Eqs. (8)-(14), (18), (19), (..., g).

    Attributes
    ----------
    torque : ndarray
        About a pinned corner: inertia less all that acts, N m.
    force : ndarray
        Along the surface, while the corner slips: inertia less all that acts, N.
    friction_ratio : ndarray
        Friction over normal force while the corner is pinned.
    contact_velocity : ndarray
        Of the corner along the surface, m/s.
    torque_scale, weight : float
        Largest torque of the field, N m, and weight with adhesion, N, to judge sizes.
    """

    torque: Array
    force: Array
    friction_ratio: Array
    contact_velocity: Array
    torque_scale: float
    weight: float


class Balance:
    """The forces of a simulated run at given times, with every effect of its scenario.

    Parameters
    ----------
    scenario : Scenario
    motion : mapping of ndarray
        Its recording: where the robot is, and which of its corners touches.
    times : ndarray, shape (g,)
        s.
    direction : ndarray, shape (g,)
        The way in which the corner slips, +1 or -1 in the robot's own frame.
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
