"""The simulator's named extensions as causes."""

import math

import numpy as np
import pytest

from stickslip import Scenario, simulate
from stickslip._util.prior import Prior
from stickslip.scenario.effects import effects
from stickslip.walker.library import alike, known, library

VOLTS = 20.0
SHORT = Scenario().replace({"drive.frequency": 50.0, "drive.pulses": 5, "drive.base": 0.5e-3})


def parameters(causes):
    return {each.name: each for cause in causes for each in cause.parameters}


def test_every_extension_of_a_known_law_is_a_cause_that_starts_absent():
    causes = library(SHORT, {}, VOLTS)
    # The curves of free shape are none.
    left_out = {each.name for each in effects()} - {each.name for each in causes}
    assert len(left_out) == 4
    assert all(name.startswith("free_") for name in left_out)
    # Each has words and sizes of its own, which else would be guessed from all that physics allows.
    rows = known()["causes"]
    sized = {name for name in rows if "'size'" in repr(rows[name]["sizes"])}
    assert {each.name for each in causes} == sized
    for cause in causes:
        sizes = rows[cause.name]["sizes"]
        assert list(sizes) == [each.name.rpartition(".")[2] for each in cause.parameters]
        assert all("size" in each or "middle" in each for each in sizes.values())
    absent = {name: float(each.value(np.zeros(1))[0]) for name, each in parameters(causes).items()}
    assert simulate(SHORT.replace(absent)).mean_velocity == simulate(SHORT).mean_velocity


@pytest.mark.parametrize(
    ("name", "at_one", "far", "unit"),
    [
        # The size at the coordinate 1, and sinh(3) / sinh(1) = 8.524 sizes, or the end, at -3.
        ("surface_tilt.angle", 0.025, -0.2131, "rad"),
        ("field_gain.clamp", 0.05, -0.4262, "-"),
        ("angle_drag.strength", 1.0, -0.9, "-"),
        ("rotational_drag.coefficient", 1e-13, 0.0, "N m s"),
        # exp(0.7 u) times the middle.
        ("friction_patches.period", 5e-4 * 2.0138, 5e-4 * 0.12246, "m"),
        ("adhesion_ageing.time", 0.01 * 2.0138, 0.01 * 0.12246, "s"),
        # 0.15 of the largest voltage below it; no limit is zero.
        ("amplifier_limit.voltage", 0.85 * VOLTS, 0.0, "V"),
    ],
)
def test_coordinates_give_known_sizes(name, at_one, far, unit):
    parameter = parameters(library(SHORT, {}, VOLTS))[f"effects.{name}"]
    assert parameter.unit == unit
    np.testing.assert_allclose(parameter.value(np.array([1.0, -3.0])), [at_one, far], rtol=2e-4)


@pytest.mark.parametrize(
    ("key", "stated", "at_one", "range"),
    [
        ("robot.magnetization", 4e5, 4.4e5, (1.6e5, 8e5)),
        ("drive.edge_time", 1e-3, 1.4e-3, (1e-3, 5e-3)),
        ("contact.restitution", 0.4, 0.55, (0.4, 1.0)),
        ("shake.amplitude_x", -2e-5, -1.8e-5, (-3.2e-5, 0.0)),
    ],
)
def test_a_constant_is_a_cause_about_what_is_stated(key, stated, at_one, range):
    known = parameters(library(SHORT.replace({key: stated}), (), VOLTS))[key]
    assert known.value(np.array([0.0, 1.0])) == pytest.approx([stated, at_one])
    assert (known.low, known.high) == pytest.approx(range)
    at_its_end = {"robot.magnetization": 0.0, "contact.restitution": 1.0, "shake.amplitude_x": 0.0}
    if key in at_its_end:
        assert key not in parameters(library(SHORT.replace({key: at_its_end[key]}), (), VOLTS))


def test_a_fast_controller_has_no_steps_and_a_slow_one_a_fine_scan():
    period = parameters(library(SHORT, {}, VOLTS))["effects.sample_hold.period"]
    just = math.asinh(1e-4 / 4e-4 * math.sinh(1.0))
    assert period.value(np.array([just - 1e-6])) == 0.0
    assert period.value(np.array([just + 1e-6])) > 1e-4
    assert period.fineness == 0.01


def test_what_the_model_has_already_is_no_cause():
    def names(model=SHORT, **uncertain):
        given = {key.replace("__", "."): Prior("normal", 1.0, 0.1) for key in uncertain}
        return {each.name for each in library(model, given, VOLTS)}

    every = names()
    assert every - names(SHORT.replace({"effects.surface_tilt.angle": 0.01})) == {"surface_tilt"}
    assert every - names(effects__misalignment__angle=1) == {"misalignment"}
    assert names(contact__kinetic_friction=1) == every
    # Nor is another name of an uncertain constant.
    shaken = SHORT.replace(dict.fromkeys(known()["shaken"]["keys"], 1e-06))
    every = names(shaken)
    assert set(alike()) <= every
    for name, constant in alike().items():
        assert every - names(shaken, **{constant: 1}) == {name}


def test_rotational_drags_look_alike_over_the_drives():
    drives = [{"drive.mode": m, "drive.frequency": f} for m in ("IPP", "OPP") for f in (5, 20, 30)]
    more = Scenario().drag.rotational + 1.6e-16
    changes = [{}, {"effects.rotational_drag.coefficient": 4e-14}, {"drag.rotational": more}]
    level, linear, quadratic = (
        np.array([simulate(Scenario().replace({**d, **c})).mean_velocity for d in drives])
        for c in changes
    )
    one, other = linear - level, quadratic - level
    assert one @ other > 0.97 * np.linalg.norm(one) * np.linalg.norm(other)
