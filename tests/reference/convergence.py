"""The simulator's estimate of its own error: halve the step and compare."""

from dataclasses import dataclass

import numpy as np

from .simulate import ReferenceRun, simulate_reference


@dataclass(frozen=True)
class ConvergenceReport:
    """Mean velocity at a ladder of halved steps.

    dt: (n,) s, decreasing. velocity: (n,) m/s. extrapolated: m/s, linear in the step from the last
    two. error: m/s, largest difference of the last three velocities (two if there are only two):
    switching times are rounded to the step, so the error is first order but scatters, and the last
    difference alone can be small by accident. run: the run at the smallest step.
    """

    dt: np.ndarray
    velocity: np.ndarray
    extrapolated: float
    error: float
    run: ReferenceRun

    @property
    def relative_error(self) -> float:
        """error over the velocity at the smallest step; inf where nothing moves."""
        finest = abs(self.velocity[-1])
        return float(self.error / finest) if finest > 0.0 else np.inf


def converge_reference(drive: dict, *, dt: float = 4e-7, halvings: int = 2, **sections):
    """Run at dt, dt/2, ... (`halvings` times) and report how far the mean velocity still moves.

    sections: the further arguments of `simulate_reference` (robot, contact, drag, effects, rate).
    """
    if halvings < 1:
        raise ValueError(f"halvings = {halvings}, at least 1 is needed")
    steps = dt / 2.0 ** np.arange(halvings + 1)
    runs = [simulate_reference(drive, dt=float(step), **sections) for step in steps]
    velocity = np.array([run.mean_velocity for run in runs])
    return ConvergenceReport(
        dt=steps,
        velocity=velocity,
        extrapolated=float(2 * velocity[-1] - velocity[-2]),
        error=float(np.ptp(velocity[-3:])),
        run=runs[-1],
    )
