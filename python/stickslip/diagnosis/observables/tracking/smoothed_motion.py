"""The motion of a film over the phase of its drive, smoothed by a Fourier series."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.observables.tracking.camera import Camera, Recording, record

if TYPE_CHECKING:
    from stickslip.diagnosis.observables.tracking.film import FilmObservable

_MOST_ORDERS = 40
"""Harmonics. Chosen: at 17 Hz the 40th is above the rocking, at 421 Hz."""

_GRID = 240
"""Phases at which the motion is evaluated. Chosen: six for a period of the highest harmonic."""


@dataclass(frozen=True, eq=False)
class SmoothedMotion:
    """A film's steady motion beside that of a simulation.

    Attributes
    ----------
    phase : ndarray, shape (g,)
        Phase of the drive, 0 to 1.
    theta, theta_model : ndarray, shape (g,)
        Measured and simulated, rad; without the camera's offset and scale.
    place, place_model : ndarray, shape (g,)
        x less its drift, along the robot's own +x, m.
    orders : int
        Harmonics of the smoothing.
    drift_theta, drift_advance : tuple of float
        Change from period to period that the simulation lacks, and its error: rad, and m of the
        advance.
    """

    phase: Array
    theta: Array
    theta_model: Array
    place: Array
    place_model: Array
    orders: int
    drift_theta: tuple[float, float]
    drift_advance: tuple[float, float]


def smoothed_motion(
    observable: FilmObservable, names: Sequence[str], values: Array
) -> SmoothedMotion | None:
    """The motion of a film, and that of a simulation with `values`, shape (names,).

    `names` are scenario keys and what is uncertain or suspect of the film. None where the
    simulation fails, the drive has no phase, or the frames are too few.
    """
    run, at = observable.run, observable.keys(names)
    if run.scenario.drive.mode == "program":
        return None
    keys = [names[k] for k in at]
    motion = next(record(run.scenario, keys, values[None, at], observable.rate, 1))
    if motion is None:
        return None
    folds = _Folds(observable, motion, observable.camera(names, values))
    if folds.orders == 0:
        return None
    measured, simulated = folds.smooth(folds.measured), folds.smooth(folds.simulated)
    return SmoothedMotion(
        folds.grid, measured["theta"], simulated["theta"], measured["x"], simulated["x"],
        folds.orders, folds.drift("theta", 1), folds.drift("x", 2),
    )  # fmt: skip


class _Folds:
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
        times = run.columns["t"][both]
        self.sd = {"theta": theta.sd / camera.angle_scale, "x": x.sd}
        self.sign = run.scenario.drive.facing
        frames = camera.frames(motion, times)
        raw = {"theta": run.columns["theta"][both], "x": run.columns["x"][both]}
        self.measured, self.simulated = self._true(raw, camera), self._true(frames, camera)
        self.grid = (np.arange(_GRID) + 0.5) / _GRID
        # A harmonic is two numbers: chosen are a third more phases and three times as many frames.
        self.orders = self._best_order(min(folded.distinct() // 3, len(times) // 6, _MOST_ORDERS))

    def _true(self, frames: Mapping[str, Array], camera: Camera) -> dict[str, Array]:
        theta = (frames["theta"] - camera.angle_offset) / camera.angle_scale
        return {"theta": theta, "x": self.sign * (frames["x"] - camera.marker(theta)[0])}

    def _best_order(self, most: int) -> int:
        """Order by the Bayesian information criterion; 0 where not two are allowed."""
        scores = {}
        for orders in range(2, most + 1):
            design = self._design(orders)
            misfit = 0.0
            for name, sd in self.sd.items():
                y = self.measured[name]
                left = y - design @ np.linalg.lstsq(design, y, rcond=None)[0]
                misfit += float(left @ left) / sd**2
            scores[orders] = misfit + 2 * design.shape[1] * np.log(len(self.phase))
        return min(scores, key=lambda orders: scores[orders]) if scores else 0

    def _design(self, orders: int) -> Array:
        return np.hstack([self.cycle[:, None], _series(self.phase, orders)])

    def smooth(self, frames: Mapping[str, Array]) -> dict[str, Array]:
        """Series through frames, on the grid: theta, and x less its drift and mean."""
        design, basis = self._design(self.orders), _series(self.grid, self.orders)
        theta, x = (
            basis @ np.linalg.lstsq(design, frames[name], rcond=None)[0][1:]
            for name in ("theta", "x")
        )
        return {"theta": theta, "x": x - x.mean()}

    def drift(self, name: str, power: int) -> tuple[float, float]:
        """Slow change of measured minus simulated frames, for each period, and its error."""
        y = self.measured[name] - self.simulated[name]
        slow = np.stack([self.whole**k for k in range(power, 0, -1)], axis=1)
        design = np.hstack([slow, _series(self.phase, self.orders)])
        found = np.linalg.lstsq(design, y, rcond=None)[0]
        covariance = np.linalg.pinv(design.T @ design) * self.sd[name] ** 2
        factor = float(power)  # the advance changes by twice the square's coefficient
        return factor * float(found[0]), factor * float(np.sqrt(covariance[0, 0]))


def _series(phase: Array, orders: int) -> Array:
    """Columns 1, cos and sin of the phase."""
    angle = 2.0 * np.pi * phase[:, None] * np.arange(1, orders + 1)
    return np.hstack([np.ones((len(phase), 1)), np.cos(angle), np.sin(angle)])
