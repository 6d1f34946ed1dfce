"""The angle at rest in a held field: against the simulated motion, and against balances by hand."""

import numpy as np
import pytest
from scipy.optimize import brentq

from helpers import ADHESION, HEIGHT, LENGTH, MOMENT, RADIUS, WEIGHT, program, run, volts
from stickslip import Coils, Scenario, Waveform, _core

PHI = np.arctan2(HEIGHT, LENGTH)


def tilts(fields, **effects):
    """Angles at `fields` with effects by key; `__` stands for the dot."""
    keys = [f"effects.{key.replace('__', '.')}" for key in effects]
    values = np.array([list(effects.values())]).reshape(1, -1)
    return _core.static_tilts(Scenario().to_core(), keys, values, np.atleast_2d(fields))[0]


def balance_by_hand(bx, bz):
    """Nose-down: moment against weight about the front corner, both from Eqs. (8) and (12)."""

    def moment(theta):
        magnetic = -MOMENT * (bx * np.sin(theta) + bz * np.cos(theta))
        return magnetic - WEIGHT * RADIUS * np.cos(theta + PHI)

    return brentq(moment, 1e-9, np.pi / 2, xtol=1e-14)


@pytest.mark.parametrize("bx", [1e-3, 3e-3, 10e-3])
@pytest.mark.parametrize("bz", [0.5e-3, 1e-3, 4e-3])
def test_the_balance_by_hand(bx, bz):
    # Nose-up about the rear corner is the same in the mirror.
    expected = balance_by_hand(bx, -bz)
    assert tilts([bx, -bz]) == pytest.approx(expected, abs=1e-11)
    assert tilts([bx, bz]) == pytest.approx(-expected, abs=1e-11)


def test_it_lies_flat_until_an_end_is_lifted_against_weight_and_adhesion():
    # Both corners carry half of weight and adhesion; the magnetic torque takes all from one.
    limit = (WEIGHT + ADHESION) * LENGTH / 2 / MOMENT
    below, above = tilts([[1e-3, -0.999 * limit], [1e-3, -1.001 * limit]])
    assert below == 0.0
    assert above == pytest.approx(balance_by_hand(1e-3, -1.001 * limit), abs=1e-11)
    assert tilts([1e-3, 0.999 * limit]) == 0.0


def test_a_magnet_along_the_body_stands_up_in_a_vertical_field():
    # The weight's lever falls faster than the magnet's, so nothing holds it before upright.
    standing = tilts([[0.0, -1e-3], [0.0, 1e-3]])
    assert standing == pytest.approx([np.pi / 2, -np.pi / 2], abs=1e-12)


def test_adhesion_holds_a_face_that_has_landed():
    # At 90 degrees the magnet turns on with 20 fN m; weight holds with 13 fN m about the next
    # corner, adhesion with another 11.
    keys = ["effects.misalignment.angle", "contact.adhesion"]
    rows = np.array([[-0.003, ADHESION], [-0.003, 0.0]])
    fields = np.array([[0.0, -4e-3]])
    held, turned = _core.static_tilts(Scenario().to_core(), keys, rows, fields)[:, 0]
    assert held == np.pi / 2 < turned


def test_a_misaligned_magnet_turns_past_upright_or_stops_before():
    # Without weight it would align: theta + misalignment = +-90 degrees.
    past, short = (tilts([0.0, 20e-3], misalignment__angle=angle) for angle in (0.3, -0.3))
    assert past < -np.pi / 2 < short < -1.0
    assert abs(past + np.pi / 2 + 0.3) < WEIGHT * RADIUS / (MOMENT * 20e-3)
    assert abs(short + np.pi / 2 - 0.3) < WEIGHT * RADIUS / (MOMENT * 20e-3)


def test_without_weight_and_adhesion_it_aligns_with_any_field():
    free = Scenario().replace({"environment.gravity": 0.0, "contact.adhesion": 0.0}).to_core()
    angle = np.linspace(-3.0, 3.0, 25)
    fields = 1e-3 * np.stack([np.cos(angle), -np.sin(angle)], axis=1)
    found = _core.static_tilts(free, [], np.zeros((1, 0)), fields)[0]
    assert found == pytest.approx(angle, abs=1e-10)


def test_a_turned_robot_mirrors_what_is_not_fixed_to_the_world():
    turned = Scenario().replace({"drive.direction": "-x"}).to_core()
    fields = np.array([[1e-3, -1e-3], [2e-3, 1.5e-3]])
    mirrored = fields * [-1.0, 1.0]
    plain = Scenario().to_core()
    keys = ["effects.surface_tilt.angle", "effects.ambient_field.Bx"]
    one = _core.static_tilts(plain, keys, np.array([[0.05, 1e-4]]), fields)
    other = _core.static_tilts(turned, keys, np.array([[-0.05, -1e-4]]), mirrored)
    assert np.array_equal(one, other)


def test_values_out_of_range_have_no_angle():
    found = _core.static_tilts(
        Scenario().to_core(),
        ["robot.length"],
        np.array([[250e-6], [-1.0]]),
        np.array([[1e-3, -1e-3]]),
    )
    assert np.isfinite(found[0, 0])
    assert np.isnan(found[1, 0])


@pytest.mark.parametrize(
    "key",
    ["drag.linear", "effects.field_gain.clamp", "effects.gradient_scale.fraction",
     "contact.static_friction", "effects.angle_adhesion.strength"],
)  # fmt: skip
def test_what_has_no_effect_on_an_angle_at_rest(key):
    fields = np.array([[1e-3, -1e-3], [0.0, 2e-3]])
    found = _core.static_tilts(Scenario().to_core(), [key], np.array([[1e-5], [0.5]]), fields)
    assert np.array_equal(found[0], found[1])


CASES = [
    (3e-3, -1e-3, {}),
    (2e-3, 1.5e-3, {"effects.misalignment.angle": 0.15}),
    (1e-3, 2e-3, {"effects.misalignment.angle": -0.4, "robot.magnetization": 6.5e5}),
    (1e-3, -0.8e-3, {"effects.surface_tilt.angle": 0.1, "robot.magnetization": 4e5}),
    (1e-3, -0.8e-3, {"effects.surface_tilt.angle": -0.1, "drive.direction": "-x"}),
    (0.0, -2e-3, {"effects.misalignment.angle": 0.2, "effects.ambient_field.Bx": 3e-4}),
    (0.0, 2e-3, {"effects.misalignment.angle": 0.2}),
    (1e-3, -0.2e-3, {"effects.ambient_field.Bx": 1e-4}),
    (2e-3, -1e-3, {"robot.length": 300e-6, "robot.height": 80e-6, "environment.gravity": 5.0}),
    (0.0, -3e-3, {"contact.adhesion": 0.0}),
]


@pytest.mark.parametrize(("bx", "bz", "changes"), CASES)
def test_the_simulated_motion_comes_to_rest_there(bx, bz, changes):
    # The +x and -x coils together have no gradient at the centre. A vertical field without one is
    # the ambient field's; it is there at once, so drag that lets nothing swing makes the way slow.
    in_plane = volts(0.5 * bx)["xp"]
    held = Waveform.ramp(0.05, {"xp": in_plane, "xm": in_plane})
    held = held + Waveform.hold(0.45, {"xp": in_plane, "xm": in_plane})
    changes = dict(changes)
    ambient = {"effects.ambient_field.Bz": bz}
    pinned = {"contact.static_friction": 20.0, "effects.rotational_drag.coefficient": 1e-11}
    end = run(program(held), pinned, ambient, changes, rate=100.0)
    coils = Coils().field([end.x[-1], 0.0, end.z[-1]], end.current[-1])
    assert coils[0] == pytest.approx(bx, rel=1e-3, abs=1e-9)  # the currents have settled
    fields = np.array([[coils[0], coils[2] + bz]])
    scenario = Scenario().replace(changes)
    expected = _core.static_tilts(scenario.to_core(), [], np.zeros((1, 0)), fields)[0, 0]
    # A force of the field's curvature, some m B r/c^2, turns it by r^2/c^2 = 2e-6 rad; what it has
    # still to go after 0.45 s is its rate times the time constant of the drag, c/(m B) = 3 ms.
    left = 1e-2 * abs(end.omega[-1])
    assert abs(end.theta[-1] - expected) < 2e-5 + left
    assert left < 1e-5
