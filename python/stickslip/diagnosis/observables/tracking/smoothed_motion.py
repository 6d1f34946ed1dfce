"""The motion of a film, smoothed by a Fourier series, and the core's balances of its forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array
from stickslip.diagnosis.observables.tracking.camera import Camera, Recording
from stickslip.scenario.scenario import Scenario

if TYPE_CHECKING:
    from stickslip.diagnosis.observables.tracking.film import FilmObservable

_MOST_ORDERS = 40
"""Harmonics. Chosen: at 17 Hz the 40th is above the rocking, at 421 Hz."""

_GRID = 240
"""Phases at which the motion is evaluated. Chosen: six for a period of the highest harmonic."""


@dataclass(frozen=True, eq=False)
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


class Folds:
    """Steady frames of theta and x, and the Fourier series through them.

    `motion` is the recording of the simulation that is compared, `camera` the fitted one.
    """

    def __init__(self, observable: FilmObservable, motion: Recording, camera: Camera) -> None:
        run = observable.run
        theta, x = (each for each in observable.quantities[:2])
        steady = np.zeros(len(run.columns["t"]), dtype=bool)
        steady[np.flatnonzero(theta.frames)] = theta.folded.steady
        both = theta.frames & x.frames & steady
        inside = both[theta.frames]
        folded = theta.folded
        self.phase, self.cycle = folded.phase[inside], folded.cycle[inside]
        self.whole = folded.cycles[inside].astype(float)
        self.period, self.distinct = folded.period, folded.distinct()
        times = run.columns["t"][both]
        self.count = len(times)
        self.sd = {"theta": theta.sd / camera.angle_scale, "x": x.sd}
        self.sign = run.scenario.drive.facing
        frames = camera.frames(motion, times)
        raw = {"theta": run.columns["theta"][both], "x": run.columns["x"][both]}
        self.measured, self.simulated = self._true(raw, camera), self._true(frames, camera)
        self.grid = (np.arange(_GRID) + 0.5) / _GRID
        self.orders = self._best_order()
        middle = np.floor(0.5 * float(self.whole.max(initial=0.0)))
        start = run.scenario.window[0]
        self.true_times = start + (middle + self.grid) * self.period + camera.trigger
        self.trigger = camera.trigger / self.period

    def _true(self, frames: Mapping[str, Array], camera: Camera) -> dict[str, Array]:
        theta = (frames["theta"] - camera.angle_offset) / camera.angle_scale
        return {"theta": theta, "x": self.sign * (frames["x"] - camera.marker(theta)[0])}

    def _series(self, phase: Array, orders: int, derivative: int = 0) -> Array:
        """Columns 1, cos and sin of the phase, or their derivatives by time."""
        k = np.arange(1, orders + 1)
        angle = 2.0 * np.pi * phase[:, None] * k + 0.5 * np.pi * derivative
        scale = (2.0 * np.pi * k / self.period) ** derivative
        first = np.full((len(phase), 1), 1.0 if derivative == 0 else 0.0)
        return np.hstack([first, scale * np.cos(angle), scale * np.sin(angle)])

    def _best_order(self) -> int:
        """Order by the Bayesian information criterion, where the film's phases allow it."""
        # A harmonic is two numbers: chosen are a third more phases and three times as many frames.
        most = min(self.distinct // 3, self.count // 6, _MOST_ORDERS)
        scores = {}
        for orders in range(2, most + 1):
            design = self._design(orders)
            misfit = 0.0
            for name, sd in self.sd.items():
                y = self.measured[name]
                left = y - design @ np.linalg.lstsq(design, y, rcond=None)[0]
                misfit += float(left @ left) / sd**2
            scores[orders] = misfit + 2 * design.shape[1] * np.log(self.count)
        return min(scores, key=lambda orders: scores[orders]) if scores else 0

    def _design(self, orders: int) -> Array:
        return np.hstack([self.cycle[:, None], self._series(self.phase, orders)])

    def smooth(self, frames: Mapping[str, Array]) -> Kinematics:
        """Series through frames of shape (n,) or (draws, n), on the grid."""
        inverse = np.linalg.pinv(self._design(self.orders))
        found = {name: y @ inverse.T for name, y in frames.items()}
        bases = [self._series(self.grid, self.orders, k) for k in range(3)]
        theta, omega, alpha = (found["theta"][..., 1:] @ basis.T for basis in bases)
        x, vx, ax = (found["x"][..., 1:] @ basis.T for basis in bases)
        drift = found["x"][..., :1] / self.period
        return Kinematics(theta, omega, alpha, x - x.mean(-1, keepdims=True), vx + drift, ax)

    def drift(self, name: str, power: int) -> tuple[float, float]:
        """Slow change of measured minus simulated frames, for each period, and its error."""
        y = self.measured[name] - self.simulated[name]
        slow = np.stack([self.whole**k for k in range(1, power + 1)], axis=1)
        design = np.hstack([slow[:, ::-1], self._series(self.phase, max(self.orders, 2))])
        found = np.linalg.lstsq(design, y, rcond=None)[0]
        covariance = np.linalg.pinv(design.T @ design) * self.sd[name] ** 2
        factor = float(power)  # the advance changes by twice the square's coefficient
        return factor * float(found[0]), factor * float(np.sqrt(covariance[0, 0]))


@dataclass(frozen=True, eq=False)
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
