"""Each named extension: absent at zero, and one consequence that can be derived."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import stickslip
from helpers import (
    ADHESION,
    BUSY,
    FLIGHT,
    GRAVITY,
    HEIGHT,
    HELD,
    HOPS,
    INERTIA,
    MASS,
    MOMENT,
    NO_FIELD,
    QUICK_COILS,
    TIGHT,
    WEIGHT,
    program,
    run,
    still_for,
    torque_about_corner,
    volts,
)
from stickslip import Coils, Waveform
from stickslip.scenario.effects import is_free_shape

KINETIC, DRAG = 0.145, 1e-5  # -, N s/m

# A swing of the moment about a field along +x, in flight without weight and drag.
SWING = {
    "effects.ambient_field.Bx": 2.5e-3,
    "environment.gravity": 0.0,
    "contact.adhesion": 0.0,
    "drag.linear": 0.0,
    "drag.rotational": 0.0,
}

# One value at which each parameter counts.
PARAMETERS = {
    "surface_tilt.angle": 0.05,
    "ambient_field.Bx": 2e-4,
    "ambient_field.Bz": -2e-4,
    "misalignment.angle": 0.2,
    "angle_drag.strength": 20.0,
    "rotational_drag.coefficient": 1e-13,
    "stribeck_friction.velocity": 2e-3,
    "eddy_lag.time": 1e-3,
    "coil_heating.coefficient": 1.0,
    "amplifier_limit.voltage": 15.0,
    "sample_hold.period": 1.1e-3,
    "mutual_inductance.coupling": 0.1,
    "gradient_scale.fraction": 2.0,
    "field_gain.in_plane": 0.1,
    "field_gain.clamp": 0.1,
    "viscous_friction.coefficient": 20.0,
    "friction_anisotropy.fraction": 0.2,
    "angle_adhesion.strength": 0.9,
    "adhesion_ageing.rate": 0.5,
    "quadratic_drag.coefficient": 1e-3,
    "friction_patches.amplitude": 0.5,
}
# What shapes an extension that another parameter makes present.
SHAPES = {"adhesion_ageing.time", "friction_patches.period"}
ARRAYS = ("t", "x", "z", "theta", "vx", "vz", "omega", "normal_force", "friction_force", "current")


def test_every_extension_of_a_known_law_is_tested_here():
    # Those of a free shape: test_effects_free_shapes.py; coils: test_own_coils.py; what acts across
    # the plane y = 0: cpp/tests/test_plane.cpp.
    listed = {f"{effect.name}.{key.name.rpartition('.')[2]}"
              for effect in stickslip.effects()
              if not is_free_shape(effect.name)
              for key in effect.parameters}  # fmt: skip
    across = {"ambient_field.By", "surface_tilt.azimuth"}
    assert listed == set(PARAMETERS) | SHAPES | across


@pytest.mark.parametrize("name", PARAMETERS)
def test_zero_is_absent_to_the_last_bit(name):
    without = run(rate=2000.0, **HOPS)
    zero = run({f"effects.{name}": 0.0}, rate=2000.0, **HOPS)
    counts = run({f"effects.{name}": PARAMETERS[name]}, rate=2000.0, **HOPS)
    for array in ARRAYS:
        assert np.array_equal(getattr(zero, array), getattr(without, array)), array
    assert zero.summary() == without.summary()
    for extended, plain in zip(_reported(counts), _reported(without), strict=True):
        if extended != pytest.approx(plain, rel=0.004):
            return
    pytest.fail(f"{name} = {PARAMETERS[name]} changes nothing that a run reports")


def _reported(moving):
    return moving.mean_velocity, moving.summary()["theta_min"], moving.summary()["theta_max"]


def test_tilt_adds_the_weight_along_the_surface():
    # Analytic motion on a tilt is in test_physics_statics.py; here the forces at rest.
    angle = 0.2
    still = run(NO_FIELD, {"effects.surface_tilt.angle": angle}, rate=1e3, pulses=4)
    assert still.friction_force == pytest.approx(-WEIGHT * np.sin(angle), rel=1e-12)
    assert still.normal_force == pytest.approx(WEIGHT * np.cos(angle) + ADHESION, rel=1e-12)


def test_ambient_field_adds_to_that_of_the_coils():
    ambient = {"effects.ambient_field.Bx": 3e-5, "effects.ambient_field.Bz": -2e-5}
    held = {"contact.adhesion": 1.0}
    keys = program(Waveform.hold(0.02, volts(1e-3, -1e-3)))
    one, other = run(keys, held, rate=1e3), run(keys, held, ambient, rate=1e3)
    assert other.bx - one.bx == pytest.approx(3e-5, abs=1e-18)
    assert other.bz - one.bz == pytest.approx(-2e-5, abs=1e-18)


@pytest.mark.parametrize("field", [1e-3, -1e-3])
def test_ambient_field_alone_tips_the_block(field):
    # (weight + adhesion) L / 2 = 59 pN m needs 36 uT.
    for share, tips in ((0.99, 0), (1.01, 1)):
        needed = (WEIGHT + ADHESION) * 125e-6 / MOMENT
        keys = {"effects.ambient_field.Bz": np.sign(field) * share * needed}
        assert run(still_for(0.01), keys).summary()["events"]["tip"] == tips


@pytest.mark.parametrize("angle", [0.3, -0.4, 1.5])
def test_misaligned_moment_is_turned_by_its_angle(angle):
    # Flying in a uniform field without weight, the moment swings about the field, so the body
    # about minus the angle of misalignment.
    keys = {
        **SWING,
        "effects.misalignment.angle": angle,
        "effects.rotational_drag.coefficient": 2e-13,
    }
    swing = run(still_for(0.05), keys, rate=1e4)
    assert swing.contact[-1] == FLIGHT
    # Within 50 ms the drag damps by exp(-2e-13 / (2 J) 50 ms) = e^-32.
    assert swing.theta[-1] == pytest.approx(-angle, abs=1e-5)


@pytest.mark.parametrize("strength", [4.0, -0.5])
def test_angle_drag_of_a_lying_block_is_one_plus_its_strength(strength):
    # Sliding flat down a tilt, cos theta = 1: the drag is 1 + k times what it was.
    keys = {"effects.surface_tilt.angle": 0.6}
    slide = run(still_for(0.05), keys, {"effects.angle_drag.strength": strength}, rate=1e3)
    same = run(still_for(0.05), keys, {"drag.linear": 1e-5 * (1 + strength)}, rate=1e3)
    assert slide.x == pytest.approx(same.x, rel=1e-12)


def test_angle_drag_does_not_act_on_a_block_that_stands():
    # On end cos theta is zero. The moment is turned with the body so that it does not fall.
    stand = {
        "effects.misalignment.angle": 0.0,
        "effects.ambient_field.Bz": -5e-3,
        "effects.rotational_drag.coefficient": 1e-12,
        "effects.surface_tilt.angle": 0.4,
        "contact.adhesion": 0.0,
    }
    one = run(still_for(0.3), stand, rate=1e3)
    other = run(still_for(0.3), stand, {"effects.angle_drag.strength": 9.0}, rate=1e3)
    late = one.t > 0.2
    for slide in (one, other):
        assert slide.theta[late] == pytest.approx(np.pi / 2, abs=1e-12)
    # Both have the terminal velocity of a drag without the extension, within 1e-7 of the scale of
    # velocities, 1 m/s.
    push = WEIGHT * (np.sin(0.4) - 0.145 * np.cos(0.4))
    assert one.vx[late] == pytest.approx(push / 1e-5, abs=1e-7)
    assert other.vx[late] == pytest.approx(push / 1e-5, abs=1e-7)


def test_rotational_drag_damps_a_swing_at_c_over_2j():
    # Free flight in a uniform field without weight, a swing of 0.01 rad.
    drag, angle = 2e-14, 0.01
    keys = {
        **SWING,
        "effects.misalignment.angle": angle,
        "effects.rotational_drag.coefficient": drag,
        "solver.rtol": 1e-9,
    }
    swing = run(still_for(0.03), keys, rate=1e5)
    flying = swing.contact == FLIGHT
    t, offset = swing.t[flying], swing.theta[flying] + angle
    rate = drag / (2 * INERTIA)
    frequency = np.sqrt(MOMENT * 2.5e-3 / INERTIA - rate**2)
    # Amplitude from angle and angular rate together, which together do not oscillate.
    amplitude = np.hypot(offset, (swing.omega[flying] + rate * offset) / frequency)
    assert np.log(amplitude[0] / amplitude[-1]) == pytest.approx(rate * (t[-1] - t[0]), rel=1e-4)


@pytest.mark.parametrize("velocity", [1e-3, 1e-2])
def test_stribeck_friction_of_a_sliding_block(velocity):
    # m dv/dt = push - c v - mu(v) N with mu falling from 0.2 to 0.145 by a Gaussian.
    angle, drag = 0.5, 1e-5
    keys = {"effects.surface_tilt.angle": angle, "effects.stribeck_friction.velocity": velocity}
    slide = run(still_for(0.02), keys, {"solver.rtol": 1e-10}, rate=1e4)
    push, normal = WEIGHT * np.sin(angle), WEIGHT * np.cos(angle) + ADHESION

    def rates(_, y):
        mu = 0.145 + 0.055 * np.exp(-((y[1] / velocity) ** 2))
        return [y[1], (push - drag * y[1] - mu * normal) / MASS]

    exact = solve_ivp(rates, (0.0, 0.02), [0.0, 0.0], rtol=1e-11, atol=1e-16, t_eval=slide.t)
    assert slide.vx == pytest.approx(exact.y[1], rel=1e-6, abs=1e-9)
    assert slide.x == pytest.approx(exact.y[0], rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("lag", [1e-3, 7e-3, 3e-2])
def test_eddy_lag_delays_the_field_behind_a_step(lag):
    # Two first-order lags in a row; where they are equal, the form t exp(-t / T).
    coil = 7e-3
    keys = [program(Waveform.hold(0.05, volts(1e-3))), {"effects.eddy_lag.time": lag}]
    step = run(*keys, {"contact.adhesion": 1.0}, rate=1e4)
    if lag == coil:
        share = 1.0 - (1.0 + step.t / coil) * np.exp(-step.t / coil)
        tolerance = 1e-5  # the solution moves the lag by 1e-6 of itself
    else:
        fading = coil * np.exp(-step.t / coil) - lag * np.exp(-step.t / lag)
        share = 1.0 - fading / (coil - lag)
        tolerance = 1e-9
    assert (step.bx[0], share[0]) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert step.bx[-1] == pytest.approx(1e-3 * share[-1], rel=1e-4)
    assert step.bx / step.bx[-1] == pytest.approx(share / share[-1], abs=tolerance)


@pytest.mark.parametrize("fraction", [0.5, -1.0, 2.0])
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_gradient_scale_scales_the_magnetic_force_alone(direction, fraction):
    keys = {"effects.gradient_scale.fraction": fraction, "contact.adhesion": 1e-4}
    waveform = Waveform.hold(0.03, {"xp": 50.0, "clamp": -20.0, "xm": 5.0})
    of = run(keys, program(waveform), rate=1e3, direction=direction)
    gradient = Coils().gradient([0.0, 0.0, HEIGHT / 2], of.current)
    moment = MOMENT if direction == "+x" else -MOMENT
    along, up = ((1.0 + fraction) * moment * gradient[:, i, 0] for i in (0, 2))
    # The field near the robot is good to 1e-9 of itself, some 100 nN.
    assert of.friction_force == pytest.approx(-along, abs=1e-15)
    assert of.normal_force == pytest.approx(WEIGHT + 1e-4 - up, abs=1e-15)
    field = Coils().field([0.0, 0.0, HEIGHT / 2], of.current)
    assert of.bx == pytest.approx(field[:, 0], rel=1e-8, abs=1e-15)
    assert of.bz == pytest.approx(field[:, 2], rel=1e-8, abs=1e-15)


@pytest.mark.parametrize(("in_plane", "clamp"), [(0.3, 0.0), (0.0, -0.2), (-0.1, 0.4), (-1, 1)])
def test_field_gain_scales_the_field_of_its_coils(in_plane, clamp):
    gains = {"effects.field_gain.in_plane": in_plane, "effects.field_gain.clamp": clamp}
    ambient = {"effects.ambient_field.Bx": 1e-4}
    of = run(HELD, gains, ambient, program(BUSY), rate=5e3)
    plain = run(HELD, program(BUSY), rate=5e3)
    assert np.array_equal(of.current, plain.current)
    scaled = of.current * (1.0 + np.array([in_plane] * 4 + [clamp]))
    field = Coils().field([0.0, 0.0, HEIGHT / 2], scaled)
    assert of.bx == pytest.approx(1e-4 + field[:, 0], abs=1e-11)
    assert of.bz == pytest.approx(field[:, 2], abs=1e-11)
    gradient = Coils().gradient([0.0, 0.0, HEIGHT / 2], scaled)
    assert of.friction_force == pytest.approx(-MOMENT * gradient[:, 0, 0], abs=1e-15)


@pytest.mark.parametrize(("in_plane", "clamp"), [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5)])
def test_field_gain_turns_the_angle_at_which_a_tilted_block_rests(in_plane, clamp):
    final = volts(in_plane=2.5e-3, clamp=-2.5e-3)
    keys = {
        "effects.field_gain.in_plane": in_plane,
        "effects.field_gain.clamp": clamp,
        "effects.rotational_drag.coefficient": 1e-12,
        "contact.static_friction": 50.0,
    }
    waveform = Waveform.ramp(0.5, final) + Waveform.hold(1.5, final)
    of = run(keys, program(waveform), rate=10.0)
    scaled = of.current[-1] * (1.0 + np.array([in_plane] * 4 + [clamp]))
    at = of.contact_x[-1], scaled
    steady = brentq(torque_about_corner, 0.05, 1.5, args=at, xtol=1e-12)
    # What is left of the rocking is of the integrator's tolerance.
    assert of.theta[-1] == pytest.approx(steady, abs=1e-5)
    # Field alone, without weight (some 31 of 4000 pN m), would turn it to atan(Bz/Bx).
    bare = np.arctan((1.0 + clamp) / (1.0 + in_plane))
    assert steady == pytest.approx(bare, abs=0.02)


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
    of = run({"robot.magnetization": 0.0}, rate=1e3, **HOPS)
    assert np.all(of.x == 0.0)
    assert of.normal_force == pytest.approx(WEIGHT + ADHESION, rel=1e-12)
