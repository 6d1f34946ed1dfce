"""Balances of torque and force of a body on one corner, from its motion and the coils' field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.observables.tracking.camera import Recording
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.coils import Coils

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


class Balance:
    """Eqs. (8)-(14) and (18)-(19) with the fields of a simulated run at given times.

    Parameters
    ----------
    scenario : Scenario
    motion : mapping of ndarray
        Its recording.
    times : ndarray, shape (g,)
        s, where the fields are taken.
    """

    def __init__(self, scenario: Scenario, motion: Recording, times: Array) -> None:
        robot, contact, drag = scenario.robot, scenario.contact, scenario.drag
        self.sign = -1.0 if scenario.drive.direction == "-x" else 1.0
        self.mass = robot.mass
        self.half = (0.5 * robot.length, 0.5 * robot.height)
        self.inertia = robot.mass * (robot.length**2 + robot.height**2) / 12.0
        self.moment = robot.length * robot.width * robot.height * robot.magnetization
        self.moment *= 1.0 + float(scenario.get("effects.magnetization_scale.fraction"))
        self.turned = float(scenario.get("effects.misalignment.angle"))
        tilt = float(scenario.get("effects.surface_tilt.angle"))
        gravity = scenario.environment.gravity * self.mass
        self.gravity = (self.sign * gravity * np.sin(tilt), -gravity * np.cos(tilt))
        self.adhesion, self.friction = contact.adhesion, contact.kinetic_friction
        self.linear, self.rotational = drag.linear, drag.rotational
        self.weight = gravity + contact.adhesion
        t = motion["t"]
        at = {name: np.interp(times, t, motion[name]) for name in ("x", "z", "theta", "bx", "bz")}
        self.field = (self.sign * at["bx"], at["bz"])
        current = np.stack([np.interp(times, t, each) for each in motion["current"].T], axis=1)
        points = np.stack([at["x"], np.zeros(len(times)), at["z"]], axis=1)
        coil = scenario.coil
        gradient = Coils(coil.side, coil.distance, coil.turns).gradient(points, current)
        gradient *= 1.0 + float(scenario.get("effects.gradient_scale.fraction"))
        self.gradient = (gradient[:, 0, 0], self.sign * gradient[:, 0, 2], gradient[:, 2, 2])
        # The corner that touches: the lowest of the simulated body.
        corners = [
            (a, b) for a in (self.half[0], -self.half[0]) for b in (-self.half[1], self.half[1])
        ]
        heights = np.stack([-a * np.sin(at["theta"]) + b * np.cos(at["theta"]) for a, b in corners])
        lowest = np.argmin(heights, axis=0)
        self.corner = (
            np.array([a for a, _ in corners])[lowest],
            np.array([b for _, b in corners])[lowest],
        )
        self.torque_scale = float(np.max(np.abs(self._torque_of_field(at["theta"]))))

    def _torque_of_field(self, theta: Array) -> Array:
        angle = theta + self.turned
        return -self.moment * (np.sin(angle) * self.field[0] + np.cos(angle) * self.field[1])

    def _force_of_field(self, theta: Array) -> tuple[Array, Array]:
        angle = theta + self.turned
        mx, mz = self.moment * np.cos(angle), -self.moment * np.sin(angle)
        xx, xz, zz = self.gradient
        return mx * xx + mz * xz, mx * xz + mz * zz

    def _offset(self, theta: Array) -> tuple[Array, Array]:
        """From the centre of mass to the touching corner."""
        a, b = self.corner
        cosine, sine = np.cos(theta), np.sin(theta)
        return a * cosine + b * sine, -a * sine + b * cosine

    def contact_velocity(self, k: Kinematics) -> Array:
        """Of the touching corner along the surface, m/s."""
        return k.vx + k.omega * self._offset(k.theta)[1]

    def torque(self, k: Kinematics) -> Array:
        """What the torque about a pinned corner lacks, N m: inertia less all that acts on it."""
        ox, oz = self._offset(k.theta)
        force = self._force_of_field(k.theta)
        # The centre of mass turns about the corner, from which it is at (-ox, -oz).
        vx, vz = -oz * k.omega, ox * k.omega
        fx = force[0] + self.gravity[0] - self.linear * vx
        fz = force[1] + self.gravity[1] - self.linear * vz
        acting = self._torque_of_field(k.theta) - oz * fx + ox * fz
        acting = acting - self.rotational * np.abs(k.omega) * k.omega
        arm = self.half[0] ** 2 + self.half[1] ** 2
        return np.asarray((self.inertia + self.mass * arm) * k.alpha - acting)

    def _normal(self, k: Kinematics) -> Array:
        """Compressive reaction at a corner that stays on the surface, N."""
        ox, oz = self._offset(k.theta)
        vz, az = ox * k.omega, oz * k.omega**2 + ox * k.alpha
        force = self._force_of_field(k.theta)[1] + self.gravity[1] - self.linear * vz
        return np.asarray(self.mass * az - force + self.adhesion)

    def force(self, k: Kinematics, direction: Array) -> Array:
        """What the force along the surface lacks while the corner slips in `direction`, N."""
        acting = self._force_of_field(k.theta)[0] + self.gravity[0] - self.linear * k.vx
        return np.asarray(self.mass * k.ax - acting + self.friction * direction * self._normal(k))

    def ratio(self, k: Kinematics) -> Array:
        """Friction over normal force while the corner is pinned."""
        ox, oz = self._offset(k.theta)
        vx, ax = -oz * k.omega, ox * k.omega**2 - oz * k.alpha
        acting = self._force_of_field(k.theta)[0] + self.gravity[0] - self.linear * vx
        normal = np.maximum(self._normal(k), 1e-3 * self.weight)
        return np.asarray(np.abs(self.mass * ax - acting) / normal)
