"""Causes in the coils' field: scales of field and gradient, by the forces and angles they make."""

import numpy as np
import pytest
from scipy.optimize import brentq

from helpers import BUSY, HEIGHT, HELD, LENGTH, MOMENT, RADIUS, WEIGHT, program, run, volts
from stickslip import Coils, Waveform


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
    corner = np.arctan2(HEIGHT, LENGTH)

    def torque(theta):
        lever, height = RADIUS * np.cos(theta + corner), RADIUS * np.sin(theta + corner)
        centre = [of.contact_x[-1] - lever, 0.0, height]
        moment = MOMENT * np.array([np.cos(theta), 0.0, -np.sin(theta)])
        field, gradient = Coils().field(centre, scaled), Coils().gradient(centre, scaled)
        force = gradient @ moment
        turning = moment[2] * field[0] - moment[0] * field[2]
        return turning + height * force[0] + lever * (force[2] - WEIGHT)

    steady = brentq(torque, 0.05, 1.5, xtol=1e-12)
    # What is left of the rocking is of the integrator's tolerance.
    assert of.theta[-1] == pytest.approx(steady, abs=1e-5)
    # Field alone, without weight (some 31 of 4000 pN m), would turn it to atan(Bz/Bx).
    bare = np.arctan((1.0 + clamp) / (1.0 + in_plane))
    assert steady == pytest.approx(bare, abs=0.02)
