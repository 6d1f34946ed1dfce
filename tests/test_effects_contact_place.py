"""The effect `free_contact_place`: a contact beside the corner of the rectangle, over the tilt."""

import numpy as np
import pytest

from free_shapes import KNOTS, curve, shaped
from helpers import (
    MASS,
    MOMENT,
    QUICK_COILS,
    WEIGHT,
    energy,
    friction,
    program,
    run,
    volts,
)
from stickslip import Waveform

# The corner that touches at theta > 0, from the centre of mass along the body and below it, m.
FRONT, BELOW = 0.5 * 250e-6, 0.5 * 100e-6


def rocking(knots):
    """A swing on one corner, without friction's work or drag, in fields that are soon steady."""
    keys = {
        **shaped("free_contact_place", knots),
        **friction(100.0),
        **QUICK_COILS,
        "contact.adhesion": 20e-6,
        "drag.linear": 0.0,
        "drag.rotational": 0.0,
        "solver.rtol": 1e-11,
    }
    drive = program(Waveform.hold(0.02, volts(in_plane=2.5e-3, clamp=-2.5e-3)))
    of = run(keys, drive, rate=1e5)
    assert of.summary()["events"]["tip"] == 1
    assert of.summary()["events"]["landing"] == of.summary()["events"]["slip_start"] == 0
    assert np.ptp(of.theta) > 1.0
    return of


def corner(theta, front):
    """Lever and height of the centre of mass over a corner that lies so far to the front."""
    sine, cosine = np.sin(theta), np.cos(theta)
    return front * cosine - BELOW * sine, front * sine + BELOW * cosine


@pytest.mark.parametrize("part", [0.2, -0.2])
def test_a_contact_that_lies_farther_by_a_constant_is_another_corner(part):
    of = rocking([part] * 5)
    front = FRONT * (1.0 + part)
    lever, height = corner(of.theta, front)
    assert of.z == pytest.approx(height, abs=1e-15)
    assert of.x + lever == pytest.approx(np.full_like(lever, of.x[0] + lever[0]), abs=1e-15)
    assert of.contact_x == pytest.approx(of.x + lever, abs=1e-15)
    # A pendulum about it: J' omega' is the moment. The coils' gradients pull at the centre of mass
    # too; omega' by differences errs by (2 pi 1000 Hz 10 us)^2 / 6.
    inertia = MASS * ((250e-6**2 + 100e-6**2) / 12 + front**2 + BELOW**2)
    moment = -MOMENT * (np.sin(of.theta) * of.bx + np.cos(of.theta) * of.bz) - WEIGHT * lever
    late = slice(50, -1)
    measured = np.gradient(of.omega, 1e-5)[late]
    assert measured == pytest.approx((moment / inertia)[late], abs=5e-3 * np.abs(measured).max())


def test_a_contact_whose_place_depends_on_the_tilt_rolls_and_keeps_the_energy():
    of = rocking(KNOTS)
    lever = corner(of.theta, FRONT)[0]
    lever += FRONT * curve("free_contact_place", KNOTS, of.theta) * np.cos(of.theta)
    # z = h(theta) with the lever for its slope, and what touches stands still.
    assert of.vz == pytest.approx(of.omega * lever, abs=1e-15 * np.abs(of.omega).max())
    assert of.vx == pytest.approx(of.omega * of.z, abs=1e-15 * np.abs(of.omega).max())
    assert of.contact_x - of.x == pytest.approx(lever, abs=1e-15)
    for place, velocity in ((of.x, of.vx), (of.z, of.vz)):
        # Simpson's rule of steps of 20 us, of which the swing takes some hundred.
        steps = (velocity[:-2:2] + 4 * velocity[1:-1:2] + velocity[2::2]) * 1e-5 / 3
        assert np.diff(place[::2])[25:] == pytest.approx(steps[25:], abs=1e-10)
    assert np.ptp(of.contact_x) > 1e-6
    late = of.t > 1e-4
    assert np.ptp(energy(of)[late]) < 1e-8 * MOMENT * 2.5e-3
