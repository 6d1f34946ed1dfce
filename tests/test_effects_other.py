"""Causes in the fluid, the magnet and the measurement, by analytic consequence."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from helpers import (
    ADHESION,
    FLIGHT,
    GRAVITY,
    INERTIA,
    MASS,
    QUICK_COILS,
    WEIGHT,
    program,
    run,
    still_for,
    volts,
)
from stickslip import Waveform

KINETIC, DRAG = 0.145, 1e-5  # -, N s/m
TIGHT = {"solver.rtol": 1e-10}
# OPP with hops and slips.
DRIVE = {"mode": "OPP", "hold": 2.5e-3, "base": 0.0, "pulses": 8}
MOTION = ("t", "x", "z", "theta", "vx", "vz", "omega", "contact_x", "slip_velocity")
UNTOUCHED = ("normal_force", "friction_force", "bx", "bz", "current", "contact")


@pytest.mark.parametrize("coefficient", [1e-3, 1e-1])
@pytest.mark.parametrize("linear", [0.0, DRAG])
@pytest.mark.parametrize("downhill", [1, -1])
def test_quadratic_drag_of_a_slide_down_a_tilt(downhill, linear, coefficient):
    # m dv/dt = F - c v - q v^2, from rest: with D = sqrt(c^2 + 4 q F),
    # v = (D tanh(D t / 2m + artanh(c/D)) - c) / 2q, and its end (D - c) / 2q.
    angle = 0.8
    push = WEIGHT * np.sin(angle) - KINETIC * (WEIGHT * np.cos(angle) + ADHESION)
    root = np.sqrt(linear**2 + 4.0 * coefficient * push)
    seconds = 20.0 * MASS / root
    keys = {"effects.quadratic_drag.coefficient": coefficient, "drag.linear": linear}
    tilt = {"effects.surface_tilt.angle": downhill * angle}
    of = run(still_for(seconds), tilt, keys, TIGHT, rate=50.0 / seconds)
    t = of.t[1:]
    velocity = (root * np.tanh(root * t / (2 * MASS) + np.arctanh(linear / root)) - linear) / (
        2.0 * coefficient
    )
    assert downhill * of.vx[1:] == pytest.approx(velocity, abs=1e-9)  # 1e-10 of 0.1 m/s a step
    terminal = (root - linear) / (2.0 * coefficient)
    # tanh(10) is 4e-9 short of one.
    assert downhill * of.vx[-1] == pytest.approx(terminal, rel=1e-7)


@pytest.mark.parametrize("angle_drag", [0.0, 3.0])
def test_quadratic_drag_of_a_thrown_block_is_against_its_velocity(angle_drag):
    # A kick of the coils throws it off a steep surface; then no field, both velocities fall under
    # drag along the whole velocity, with that of Eq. (18), which may depend on the angle.
    coefficient = 2e-3
    keys = {
        "effects.surface_tilt.angle": 1.5,
        "contact.adhesion": 0.0,
        "effects.quadratic_drag.coefficient": coefficient,
        "effects.angle_drag.strength": angle_drag,
    }
    kick = Waveform.hold(5e-4, volts(2.5e-3, -2.5e-3)) + Waveform.hold(0.02, {})
    of = run(program(kick), keys, QUICK_COILS, TIGHT, rate=5e3)
    flies = (of.contact == FLIGHT) & (of.t > 6e-4)
    assert flies.sum() > 40

    def rates(t, y):
        vx, vz, theta, omega = y[2:]
        drag = DRAG * (1.0 + angle_drag * np.cos(theta) ** 2) + coefficient * np.hypot(vx, vz)
        return [
            vx,
            vz,
            GRAVITY * np.sin(1.5) - drag / MASS * vx,
            -GRAVITY * np.cos(1.5) - drag / MASS * vz,
            omega,
            -9e-17 * abs(omega) * omega / INERTIA,
        ]

    names = ("x", "z", "vx", "vz", "theta", "omega")
    path = np.array([getattr(of, name)[flies] for name in names])
    t = of.t[flies]
    exact = solve_ivp(rates, (t[0], t[-1]), path[:, 0], "DOP853", t, rtol=1e-12, atol=1e-15).y
    # Steps within 1e-10 of the scales of a swing, 0.1 mm and 1 m/s.
    assert path[:2] == pytest.approx(exact[:2], abs=1e-10)
    assert path[2:4] == pytest.approx(exact[2:4], abs=1e-7)
    # It counts: quadratic drag exceeds the linear one.
    assert coefficient * np.abs(path[2]).max() > DRAG


def test_demagnetized_block_does_not_move():
    of = run({"robot.magnetization": 0.0}, rate=1e3, **DRIVE)
    assert np.all(of.x == 0.0)
    assert of.normal_force == pytest.approx(WEIGHT + ADHESION, rel=1e-12)
