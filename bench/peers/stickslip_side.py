"""The same runs with stickslip."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

import stickslip
from peers.problem import BASE, PULSES, RAMP, Drive

TOLERANCES = [first * 10.0**power for power in range(-11, -3) for first in (1.0, 2.0, 5.0)]
EXACT = 1e-12  # tolerance of the solution that all errors are taken from


def scenario_of(drive: Drive, rtol: float) -> stickslip.Scenario:
    """The scenario of `drive`, at the solver tolerance `rtol`."""
    return stickslip.Scenario(
        drive=stickslip.Drive(mode="IPP", peak=drive.peak, frequency=drive.frequency,
                              hold=drive.hold, base=BASE, ramp=RAMP, pulses=PULSES),
        solver=stickslip.Solver(rtol=rtol),
    )  # fmt: skip


def velocity(drive: Drive, rtol: float) -> float:
    """Mean velocity, m/s."""
    run = stickslip.simulate(scenario_of(drive, rtol))
    if not run.ok:
        raise RuntimeError(run.message)
    return run.mean_velocity


def exact_velocities(drives: Iterable[Drive]) -> np.ndarray:
    """Mean velocities at the tightest tolerance, m/s."""
    return np.array([velocity(drive, EXACT) for drive in drives])


def creep(share: float, seconds: float) -> float:
    """Drift in m of a flat block on a slope where gravity takes `share` of the friction limit."""
    nominal = stickslip.Scenario()
    weight = nominal.robot.mass * nominal.environment.gravity
    contact = nominal.contact
    angle = 0.0
    # sin(a) = share mu (cos(a) + adhesion / weight), a contraction by the factor share mu.
    for _ in range(50):
        pull = np.cos(angle) + contact.adhesion / weight
        angle = float(np.arcsin(share * contact.static_friction * pull))
    resting = nominal.replace({
        **dict.fromkeys(("drive.peak", "drive.base", "drive.hold", "drive.ramp"), 0.0),
        "drive.frequency": 100.0, "drive.pulses": round(100.0 * seconds),
        "effects.surface_tilt.angle": angle, "record.rate": 100.0,
    })  # fmt: skip
    run = stickslip.simulate(resting)
    if not run.ok:
        raise RuntimeError(run.message)
    return float(np.abs(run.x).max())
