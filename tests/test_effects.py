"""Each named extension: absent at zero, and one consequence that can be derived."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip
from helpers import (
    ADHESION,
    FLIGHT,
    GRAVITY,
    HEIGHT,
    INERTIA,
    MASS,
    MOMENT,
    NO_FIELD,
    QUICK_COILS,
    WEIGHT,
    program,
    run,
    still_for,
    volts,
)
from stickslip import Waveform
from stickslip.scenario.effects import is_free_shape

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
# OPP with hops.
DRIVE = {"mode": "OPP", "hold": 2.5e-3, "base": 0.0, "pulses": 8}
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
@pytest.mark.parametrize("method", ["tsit5", "arkode"])
def test_zero_is_absent_to_the_last_bit(name, method):
    solver = {"solver.method": method}
    without = run(solver, rate=2000.0, **DRIVE)
    zero = run(solver, {f"effects.{name}": 0.0}, rate=2000.0, **DRIVE)
    counts = run(solver, {f"effects.{name}": PARAMETERS[name]}, rate=2000.0, **DRIVE)
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
        "effects.misalignment.angle": angle,
        "effects.ambient_field.Bx": 2.5e-3,
        "environment.gravity": 0.0,
        "contact.adhesion": 0.0,
        "drag.linear": 0.0,
        "drag.rotational": 0.0,
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
        "effects.misalignment.angle": angle,
        "effects.ambient_field.Bx": 2.5e-3,
        "environment.gravity": 0.0,
        "contact.adhesion": 0.0,
        "drag.linear": 0.0,
        "drag.rotational": 0.0,
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


def test_fast_stribeck_friction_is_static_friction_and_slow_is_kinetic():
    angle = {"effects.surface_tilt.angle": 0.6}
    kinetic = run(still_for(0.02), angle, {"effects.stribeck_friction.velocity": 1e-9}, rate=1e3)
    plain = run(still_for(0.02), angle, rate=1e3)
    assert kinetic.x == pytest.approx(plain.x, rel=1e-4, abs=1e-9)
    static = run(still_for(0.02), angle, {"effects.stribeck_friction.velocity": 100.0}, rate=1e3)
    other = run(still_for(0.02), angle, {"contact.kinetic_friction": 0.2}, rate=1e3)
    assert static.x == pytest.approx(other.x, rel=1e-6)


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


def test_eddy_lag_reaches_the_dc_field():
    held = run(
        program(Waveform.hold(0.2, volts(1e-3))),
        {"effects.eddy_lag.time": 5e-3, "contact.adhesion": 1.0, **QUICK_COILS},
        rate=100.0,
    )
    assert held.bx[-1] == pytest.approx(1e-3, rel=1e-4)
    assert held.z[-1] == HEIGHT / 2
    assert held.normal_force[-1] > MASS * GRAVITY
