"""Slip and normal force of a recorded run, told apart by stroke.

The upstroke is where the tilt's magnitude rises, d|theta|/dt > 0, the downstroke where it falls.
With clamp "up" theta is negative, so the sign of omega alone would tell them apart the wrong way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.simulation.run import Run, resting_force


@dataclass(frozen=True)
class Strokes:
    """One run by stroke, over its measuring window."""

    slip_up: float  # of the contact along +x, m
    slip_down: float
    path_up: float  # the same without sign, m
    path_down: float
    normal_up: float  # mean normal force while the contact slips, over that at rest; or NaN
    normal_down: float
    tilt: float  # mean of |theta|, rad

    @property
    def share_up(self) -> float:
        """Part of the slip's path that falls on the upstroke, 0 to 1; NaN without slip."""
        path = self.path_up + self.path_down
        return self.path_up / path if path > 0.0 else np.nan


def in_window(run: Run) -> NDArray[np.bool_]:
    """Which samples lie in the measuring window."""
    start, stop = run.scenario.window
    return (run.t >= start) & (run.t <= stop)


def tilt_rate(run: Run) -> NDArray[np.float64]:
    """d|theta|/dt in the measuring window, rad/s."""
    seen = in_window(run)
    return np.asarray(np.sign(run.theta[seen]) * run.omega[seen])


def interval(run: Run) -> float:
    """Time between two samples, s."""
    return float((run.t[-1] - run.t[0]) / (len(run.t) - 1))


def strokes(run: Run) -> Strokes:
    """Slip and normal force by stroke, of a run that is recorded on a uniform grid."""
    seen = in_window(run)
    rate, step = tilt_rate(run), interval(run)
    slip = np.nan_to_num(run.slip_velocity[seen])
    force = run.normal_force[seen]
    found = {"tilt": float(np.abs(run.theta[seen]).mean())}
    for name, stroke in (("up", rate > 0.0), ("down", rate < 0.0)):
        found[f"slip_{name}"] = float(slip[stroke].sum() * step)
        found[f"path_{name}"] = float(np.abs(slip[stroke]).sum() * step)
        slips = force[stroke & (slip != 0.0)]
        mean = float(slips.mean() / resting_force(run.scenario)) if len(slips) else np.nan
        found[f"normal_{name}"] = mean
    return Strokes(**found)
