"""Named extensions of moment, field and drag: one consequence of each that can be derived."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from helpers import (
    BUSY,
    FLIGHT,
    GRAVITY,
    HEIGHT,
    HELD,
    INERTIA,
    MASS,
    MOMENT,
    QUICK_COILS,
    TIGHT,
    program,
    run,
    still_for,
    volts,
)
from stickslip import Coils, Waveform

DRAG = 1e-5  # N s/m

# A swing of the moment about a field along +x, in flight without weight and drag.
SWING = {
    "effects.ambient_field.Bx": 2.5e-3,
    "environment.gravity": 0.0, "contact.adhesion": 0.0, "drag.linear": 0.0, "drag.rotational": 0.0,
}  # fmt: skip


@pytest.mark.parametrize("angle", [0.3, -2.5, 1.5])
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
