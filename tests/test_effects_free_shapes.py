"""Effects whose law is a free curve: the curve, and what it multiplies in a run."""

import numpy as np
import pytest

from free_shapes import BOTH_WAYS, KNOTS, LAWS, SHAPES, curve, shaped
from helpers import (
    ADHESION,
    INERTIA,
    MASS,
    MOMENT,
    QUICK_COILS,
    TIGHT,
    WEIGHT,
    energy,
    friction,
    program,
    run,
    scenario,
    still_for,
    volts,
)
from own_effects import nothing, nothing_stays, register  # noqa: F401 (around every test)
from stickslip import Waveform
from stickslip.scenario.effects import effects, is_free_shape

STATIC, KINETIC, DRAG, TURNING = 0.2, 0.145, 1e-5, 9e-17  # -, -, N s/m, N m s^2
# Walking and hopping, with slips both ways.
DRIVES = {
    "IPP": {"mode": "IPP", "base": 0.5e-3, "pulses": 4},
    "OPP": {"mode": "OPP", "hold": 2.5e-3, "base": 0.0, "pulses": 4},
}
drives = pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES)
names = pytest.mark.parametrize("name", SHAPES)


def test_these_are_all_extensions_of_a_free_shape():
    found = {each.name: each for each in effects() if is_free_shape(each.name)}
    assert set(found) == set(SHAPES) - set(LAWS)
    for each in found.values():
        parameters = [key.name.rpartition(".")[2] for key in each.parameters]
        assert parameters == ["span", *(f"knot_{i}" for i in range(1, 6))]
        assert [key.default for key in each.parameters[1:]] == [0.0] * 5


def test_a_users_extension_is_no_free_shape_whatever_its_name():
    register(nothing, name="free_fall")
    assert not is_free_shape("free_fall")


@names
def test_the_curve_is_hermites_with_central_differences(name):
    random = np.random.default_rng(1)
    span = SHAPES[name][0]
    for _ in range(20):
        knots = random.uniform(-1.0, 3.0, 5)
        at = random.uniform(-1.5 * span, 1.5 * span, (7, 30))
        if SHAPES[name][1] is not BOTH_WAYS:
            at = np.abs(at)
        core = scenario(shaped(name, knots)).to_core()
        # Some roundings of numbers up to 10.
        assert core.free_curve(name, at) == pytest.approx(curve(name, knots, at), abs=1e-13)
    with pytest.raises(ValueError, match="angle_drag: there is no curve of this name"):
        core.free_curve("angle_drag", at)


@names
def test_without_knots_it_is_absent_to_the_last_bit(name):
    without = run(rate=2e3, **DRIVES["OPP"])
    zero = run(shaped(name, [0.0] * 5), rate=2e3, **DRIVES["OPP"])
    with_knots = run(shaped(name, KNOTS), rate=2e3, **DRIVES["OPP"])
    for array in ("x", "z", "theta", "vx", "vz", "omega", "normal_force", "friction_force", "bx"):
        assert np.array_equal(getattr(zero, array), getattr(without, array)), array
    assert zero.summary() == without.summary()
    assert with_knots.mean_velocity != pytest.approx(without.mean_velocity, rel=1e-4)


def _friction(factor):
    return {
        "contact.static_friction": factor * STATIC,
        "contact.kinetic_friction": factor * KINETIC,
    }


def _adhesion(factor):
    return {"contact.adhesion": factor * ADHESION}


def _drag(factor):
    return {"drag.linear": factor * DRAG}


def _field(factor):
    return {f"effects.field_gain.{coils}": factor - 1.0 for coils in ("in_plane", "clamp")}


CONSTANTS = {
    "free_friction_angle": _friction,
    "free_friction_load": _friction,
    "free_friction_age": _friction,
    "free_adhesion_angle": _adhesion,
    "free_adhesion_age": _adhesion,
    "free_drag_angle": _drag,
    "free_drag_speed": _drag,
    "free_drag_rate": lambda factor: {**_drag(factor), "drag.rotational": factor * TURNING},
    "free_field_time": _field,
    "free_field_frequency": _field,
    "free_field_amplitude": _field,
}


@drives
@pytest.mark.parametrize("part", [0.25, -0.2])
@pytest.mark.parametrize("name", CONSTANTS)
def test_equal_knots_are_another_constant(name, part, drive):
    of = run(shaped(name, [part] * 5), TIGHT, rate=2e3, **drive)
    same = run(CONSTANTS[name](1.0 + part), TIGHT, rate=2e3, **drive)
    plain = run(TIGHT, rate=2e3, **drive)
    # A thousand steps, each within 1e-10 of the swing's scales, 0.13 mm, and contacts that may
    # amplify their errors some ten times.
    assert of.x == pytest.approx(same.x, abs=1e-10)
    assert of.theta == pytest.approx(same.theta, abs=1e-6)
    assert np.abs(of.x - plain.x).max() > 1e-7


def test_a_resting_block_is_let_go_when_its_friction_has_worn():
    # No force changes but the limit of sticking, over less time than rests are else looked at.
    angle, span = 0.3, 0.05
    knots = (0.0, -0.4, 0.3, 0.0, 0.0)
    needed = WEIGHT * np.sin(angle) / (WEIGHT * np.cos(angle) + ADHESION)
    assert 0.6 * STATIC < needed < STATIC
    t = np.linspace(0.0, span, 1_000_001)
    limit = STATIC * (1.0 + curve("free_friction_age", knots, t, span))
    slips_at = t[np.argmax(limit < needed)]
    of = run(still_for(3.0), {"effects.surface_tilt.angle": angle},
             shaped("free_friction_age", knots, span), rate="events")  # fmt: skip
    start = np.flatnonzero(of.event == of.event_names.index("slip_start"))[0]
    assert of.t[start] == pytest.approx(slips_at, abs=2e-7)


def test_a_drive_of_voltages_from_a_file_has_no_frequency():
    sawtooth = program(Waveform.opp(hold=2.5e-3, base=0.0, pulses=4))
    of, plain = (
        run(sawtooth, shaped("free_field_frequency", KNOTS), rate=2e3),
        run(sawtooth, rate=2e3),
    )
    assert np.array_equal(of.theta, plain.theta)
    assert np.ptp(plain.theta) > 0.1


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
    inertia = INERTIA + MASS * (front**2 + BELOW**2)
    moment = -MOMENT * (np.sin(of.theta) * of.bx + np.cos(of.theta) * of.bz) - WEIGHT * lever
    late = slice(50, -1)
    measured = np.gradient(of.omega, 1e-5)[late]
    assert measured == pytest.approx((moment / inertia)[late], abs=5e-3 * np.abs(measured).max())


@pytest.mark.parametrize("knots", [KNOTS, [0.0] * 5], ids=["beside the corner", "at the corner"])
def test_a_contact_whose_place_depends_on_the_tilt_rolls_and_keeps_the_energy(knots):
    of = rocking(knots)
    lever = corner(of.theta, FRONT)[0]
    lever += FRONT * curve("free_contact_place", knots, of.theta) * np.cos(of.theta)
    # z = h(theta) with the lever for its slope, and what touches stands still.
    assert of.vz == pytest.approx(of.omega * lever, abs=1e-15 * np.abs(of.omega).max())
    assert of.vx == pytest.approx(of.omega * of.z, abs=1e-15 * np.abs(of.omega).max())
    assert of.contact_x - of.x == pytest.approx(lever, abs=1e-15)
    for place, velocity in ((of.x, of.vx), (of.z, of.vz)):
        # Simpson's rule of steps of 20 us, of which the swing takes some hundred.
        steps = (velocity[:-2:2] + 4 * velocity[1:-1:2] + velocity[2::2]) * 1e-5 / 3
        assert np.diff(place[::2])[25:] == pytest.approx(steps[25:], abs=1e-10)
    assert (np.ptp(of.contact_x) > 1e-6) == any(knots)
    late = of.t > 1e-4
    assert np.ptp(energy(of)[late]) < 1e-8 * MOMENT * 2.5e-3
