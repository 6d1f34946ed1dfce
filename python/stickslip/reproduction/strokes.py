"""Slip and normal force of a recorded run, told apart by stroke.

The upstroke is where the tilt's magnitude rises, d|theta|/dt > 0, the downstroke where it falls.
With clamp "up" theta is negative, so the sign of omega alone would tell them apart the wrong way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.simulation.run import Run


@dataclass(frozen=True)
class Strokes:
    """One run by stroke, over its measuring window.

    Attributes
    ----------
    slip_up, slip_down : float
        Slip of the contact along +x, m.
    path_up, path_down : float
        The same without sign, m.
    normal_up, normal_down : float
        Mean normal force while the contact slips, over that at rest, weight and adhesion; NaN
        where it never slips.
    tilt : float
        Mean of |theta|, rad.
    """

    slip_up: float
    slip_down: float
    path_up: float
    path_down: float
    normal_up: float
    normal_down: float
    tilt: float

    @property
    def share_up(self) -> float:
        """Part of the slip's path that falls on the upstroke, 0 to 1; NaN without slip."""
        path = self.path_up + self.path_down
        return self.path_up / path if path > 0.0 else np.nan


def strokes(run: Run) -> Strokes:
    """Slip and normal force by stroke, of a run recorded on a uniform grid.

    Parameters
    ----------
    run : Run
        With ``record.rate`` in Hz.

    Returns
    -------
    Strokes
    """
    start, stop = run.scenario.window
    seen = (run.t >= start) & (run.t <= stop)
    rate = np.sign(run.theta[seen]) * run.omega[seen]
    slip = np.nan_to_num(run.slip_velocity[seen])
    force = run.normal_force[seen]
    scenario = run.scenario
    at_rest = scenario.robot.mass * scenario.environment.gravity + scenario.contact.adhesion
    interval = (run.t[-1] - run.t[0]) / (len(run.t) - 1)

    up, down = rate > 0.0, rate < 0.0
    slips = slip != 0.0

    def mean_force(stroke: np.ndarray) -> float:
        chosen = stroke & slips
        return float(force[chosen].mean() / at_rest) if chosen.any() else np.nan

    return Strokes(
        slip_up=float(slip[up].sum() * interval),
        slip_down=float(slip[down].sum() * interval),
        path_up=float(np.abs(slip[up]).sum() * interval),
        path_down=float(np.abs(slip[down]).sum() * interval),
        normal_up=mean_force(up),
        normal_down=mean_force(down),
        tilt=float(np.abs(run.theta[seen]).mean()),
    )
