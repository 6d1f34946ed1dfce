"""Causes in the fluid, the magnet and the measurement, by analytic consequence."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip
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
from stickslip import Scenario, Waveform

KINETIC, DRAG = 0.145, 1e-5  # -, N s/m
TIGHT = {"solver.rtol": 1e-10}
# OPP with hops and slips.
DRIVE = {"mode": "OPP", "hold": 2.5e-3, "base": 0.0, "pulses": 8}
MOTION = ("t", "x", "z", "theta", "vx", "vz", "omega", "contact_x", "slip_velocity")
UNTOUCHED = ("normal_force", "friction_force", "bx", "bz", "current", "contact")
# Units of length and of time that each reported quantity has.
DIMENSIONS = {
    "t": (0, 1),
    "x": (1, 0),
    "z": (1, 0),
    "contact_x": (1, 0),
    "vx": (1, -1),
    "vz": (1, -1),
    "slip_velocity": (1, -1),
    "theta": (0, 0),
    "omega": (0, -1),
}
VELOCITIES = ("mean_velocity", "finished_velocity", "slip_up", "slip_down", "slip_flat")


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


@pytest.mark.parametrize("fraction", [1.0, -0.5])
def test_magnetization_scale_by_a_power_of_two_is_that_magnetization(fraction):
    scaled = run({"effects.magnetization_scale.fraction": fraction}, rate=2e3, **DRIVE)
    same = run({"robot.magnetization": 5e5 * (1.0 + fraction)}, rate=2e3, **DRIVE)
    for name in MOTION + UNTOUCHED:
        assert np.array_equal(getattr(scaled, name), getattr(same, name), equal_nan=True), name
    assert scaled.summary() == same.summary()


def test_magnetization_scale_by_any_part_is_that_magnetization_to_rounding():
    # Tipping, at a corner that sticks: rounding of the moment is not amplified there.
    final = volts(2.5e-3, -2.5e-3)
    keys = [
        program(Waveform.ramp(0.1, final)),
        {"contact.static_friction": 50.0, "effects.rotational_drag.coefficient": 1e-12},
    ]
    scaled = run(*keys, {"effects.magnetization_scale.fraction": 0.1}, rate=1e3)
    same = run(*keys, {"robot.magnetization": 5.5e5}, rate=1e3)
    plain = run(*keys, rate=1e3)
    assert scaled.theta == pytest.approx(same.theta, abs=1e-9)
    assert np.abs(scaled.theta - plain.theta).max() > 1e-3


def test_demagnetized_block_does_not_move():
    of = run({"effects.magnetization_scale.fraction": -1.0}, rate=1e3, **DRIVE)
    assert np.all(of.x == 0.0)
    assert of.normal_force == pytest.approx(WEIGHT + ADHESION, rel=1e-12)


@pytest.mark.parametrize("rate", [2e3, "events"])
@pytest.mark.parametrize(("length", "clock"), [(0.05, 0.0), (0.0, 0.05), (-0.1, 0.2)])
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_scales_of_length_and_clock_are_on_all_that_is_read(direction, length, clock, rate):
    scales = {"effects.length_scale.fraction": length, "effects.clock_scale.fraction": clock}
    read = run(scales, rate=rate, direction=direction, **DRIVE)
    true = run(rate=rate, direction=direction, **DRIVE)
    for name, (lengths, times) in DIMENSIONS.items():
        factor = (1.0 + length) ** lengths * (1.0 + clock) ** times
        expected = factor * getattr(true, name)
        assert getattr(read, name) == pytest.approx(expected, rel=1e-14, nan_ok=True), name
    for name in UNTOUCHED:
        assert np.array_equal(getattr(read, name), getattr(true, name)), name
    for name in VELOCITIES:
        expected = (1.0 + length) / (1.0 + clock) * true.summary()[name]
        assert read.summary()[name] == pytest.approx(expected, rel=1e-14), name
    for name in ("theta_min", "theta_max", "airborne_fraction", "events"):
        assert read.summary()[name] == true.summary()[name], name
    assert true.mean_velocity != 0.0


def test_length_and_clock_cannot_be_told_apart_by_mean_velocities():
    # (1 + a) against 1 / (1 + b): the same for b = -a / (1 + a), and for b = -a within a^2.
    a = 0.02
    longer = run({"effects.length_scale.fraction": a}, **DRIVE).mean_velocity
    twin = run({"effects.clock_scale.fraction": -a / (1.0 + a)}, **DRIVE).mean_velocity
    near = run({"effects.clock_scale.fraction": -a}, **DRIVE).mean_velocity
    assert twin == pytest.approx(longer, rel=1e-14)
    difference = near / longer - 1.0
    assert difference == pytest.approx(a**2 / (1.0 - a**2), rel=1e-9)


@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_angle_offset_is_on_angles_alone(direction):
    read = run({"effects.angle_offset.angle": 0.1}, rate=2e3, direction=direction, **DRIVE)
    true = run(rate=2e3, direction=direction, **DRIVE)
    assert read.theta == pytest.approx(true.theta + 0.1, abs=1e-15)
    for name in (*MOTION, *UNTOUCHED):
        if name != "theta":
            assert np.array_equal(getattr(read, name), getattr(true, name), equal_nan=True), name
    expected = true.summary()
    for name in ("theta_min", "theta_max"):
        assert read.summary()[name] == pytest.approx(expected[name] + 0.1, abs=1e-15)
        expected[name] = read.summary()[name]
    assert read.summary() == expected


def test_a_sweep_reports_what_the_instruments_read():
    base = Scenario().replace({f"drive.{key}": value for key, value in DRIVE.items()})
    fractions = [0.0, 0.1]
    table = stickslip.sweep(base, {"effects.length_scale.fraction": fractions})
    velocity = np.asarray(table["mean_velocity"])
    assert velocity[1] == pytest.approx(1.1 * velocity[0], rel=1e-14)
