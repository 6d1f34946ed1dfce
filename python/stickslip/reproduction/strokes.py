"""Slip and normal force of a recorded run, told apart by stroke.

The upstroke is where the tilt's magnitude rises, d|theta|/dt > 0, the downstroke where it falls.
With clamp "up" theta is negative, so the sign of omega alone would tell them apart the wrong way.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip.reproduction.points import Array
from stickslip.simulation.run import Run, resting_force


def in_window(run: Run) -> NDArray[np.bool_]:
    """Which samples lie in the measuring window."""
    start, stop = run.scenario.window
    return (run.t >= start) & (run.t <= stop)


def tilt_rate(run: Run) -> Array:
    """d|theta|/dt in the measuring window, rad/s."""
    seen = in_window(run)
    return np.asarray(np.sign(run.theta[seen]) * run.omega[seen])


def interval(run: Run) -> float:
    """Time between two samples, s."""
    return float((run.t[-1] - run.t[0]) / (len(run.t) - 1))


def strokes(run: Run) -> dict[str, float]:
    """Slip and normal force by stroke, of a run that is recorded on a uniform grid.

    What they are called, and their units, are those of `survey.Behaviour`.
    """
    seen = in_window(run)
    rate, step = tilt_rate(run), interval(run)
    slip = np.nan_to_num(run.slip_velocity[seen])
    force = run.normal_force[seen]
    found = {"tilt": float(np.abs(run.theta[seen]).mean())}
    path = {}
    for name, stroke in (("up", rate > 0.0), ("down", rate < 0.0)):
        found[f"slip_{name}"] = float(slip[stroke].sum() * step)
        path[name] = float(np.abs(slip[stroke]).sum() * step)
        slips = force[stroke & (slip != 0.0)]
        mean = float(slips.mean() / resting_force(run.scenario)) if len(slips) else np.nan
        found[f"normal_{name}"] = mean
    total = path["up"] + path["down"]
    found["share_up"] = path["up"] / total if total > 0.0 else np.nan
    return found
