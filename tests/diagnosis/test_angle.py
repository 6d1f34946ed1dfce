"""Tables of static tilt: predictions, errors, what is left out and what is refused."""

import math

import numpy as np
import pytest
from scipy.stats import f as f_law
from scipy.stats import kstest

from stickslip import Scenario, _core
from stickslip.errors import ScenarioError
from stickslip.walker.angle import READING, AngleTable

DEGREE = math.radians(1.0)
SCENARIO = Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 6})

# Without field the robot lies flat; it rolls over between fields of either sign.
FIELDS = 1e-3 * np.array(
    [[0, 0], [0.02, 0], [0, 0.02], [0, -0.02]]
    + [[2, z] for z in (-3, -2.5, -2, -1.6, -1.3, -1, -0.7, 0.7, 1, 1.3, 1.6, 2, 2.5, 3)]
)


def angles(changes, fields):
    core = SCENARIO.replace(changes).to_core()
    return _core.static_tilts(core, [], np.zeros((1, 0)), np.atleast_2d(fields))[0]


TRUE = angles({}, FIELDS)


def table(theta, fields=FIELDS):
    return AngleTable({"Bx": fields[:, 0], "Bz": fields[:, 1], "theta": theta}, SCENARIO)


def measured(seed, repeats=1, noise=DEGREE):
    fields = np.repeat(FIELDS, repeats, axis=0)
    random = np.random.default_rng(seed)
    theta = np.repeat(TRUE, repeats) + noise * random.standard_normal(len(fields))
    mixed = random.permutation(len(fields))
    return table(theta[mixed], fields[mixed])


def test_predictions_are_those_of_the_core_read_by_its_instruments():
    found = measured(0, repeats=2)
    names = ["angle_scale.error", "angle_offset.angle", "drag.linear",
             "effects.misalignment.angle", "angle_clipping.limit"]  # fmt: skip
    values = np.array([[0.0, 0.0, 1e-5, 0.0, 0.0], [0.1, 0.1, 1e-4, 0.2, 0.8]])
    plain, changed = found.predict(names, values)
    assert plain == pytest.approx(angles({}, found.fields), abs=1e-14)
    turned = angles({"effects.misalignment.angle": 0.2}, found.fields)
    read = np.clip(1.1 * (turned + 0.1), -0.8, 0.8)
    assert changed == pytest.approx(read, abs=1e-14)


def test_repeats_are_one_condition_and_their_scatter_is_the_error():
    found = measured(3, repeats=3)
    assert (len(found), found.group.tolist()) == (54, list(range(18)))
    within = found.y - found.mean[found.condition]
    sd = math.sqrt(np.sum(within**2) / 36)
    assert found.errors.sd == pytest.approx(np.full(18, sd / math.sqrt(3)))
    assert found.errors.dof == pytest.approx(36, rel=0.15)
    assert "repeat" in found.notes[0].text


@pytest.mark.parametrize("repeats", [1, 2])
@pytest.mark.daily("2")
def test_errors_are_those_of_the_readings_with_and_without_repeats(repeats):
    # Chi-square of the true model is an F law with the degrees of freedom of the errors. Without
    # repeats seven of them are left beside lines, and a curved part takes a share of these.
    levels = []
    for seed in range(300):
        found = measured(seed, repeats)
        left = (found.mean - found.predict([], np.zeros((1, 0)))[0]) / found.errors.sd
        levels.append(f_law.sf(np.mean(left**2), len(left), min(found.errors.dof, 1e9)))
    if repeats == 2:
        assert kstest(levels, "uniform").pvalue > 0.01
    assert np.mean(np.array(levels) < 0.05) < 0.05 + 3.0 * math.sqrt(0.05 * 0.95 / 300)


def test_a_jump_of_the_curve_is_no_error():
    random = np.random.default_rng(5)
    fields = np.stack([np.full(40, 1e-3), np.linspace(0.0, 1e-3, 40)], axis=1)
    jump = np.where(fields[:, 1] > 0.5e-3, -1.5, 0.0)
    found = table(jump + 0.02 * random.standard_normal(40), fields)
    # Some twenty degrees of freedom: three standard deviations are a half.
    assert np.all(np.abs(found.errors.sd / 0.02 - 1.0) < 0.5)


def test_without_scatter_or_with_few_readings_the_error_is_the_least():
    exact = measured(0, 3, noise=0.0)  # copies count once
    assert exact.errors.sd == pytest.approx(READING)
    assert [each.code for each in exact.notes] == ["copies", "noise-smallest"]
    few = table(TRUE[5:7], FIELDS[5:7])
    assert few.errors.sd == pytest.approx(READING)
    assert [each.code for each in few.notes] == ["noise-unknown"]


def test_a_slip_is_left_out_and_a_turn_too_many_as_well():
    theta = TRUE + 0.002 * np.random.default_rng(1).standard_normal(len(TRUE))
    theta[7] += 0.8
    theta[12] += 2 * math.pi
    found = table(theta)
    assert [each.code for each in found.left_out] == ["angle-beyond-turn", "lonely-angle"]
    assert found.left_out[1].value == pytest.approx(theta[7])
    assert len(found.mean) == len(TRUE) - 2
    # Of repeats none is left out: their scatter says what an error is.
    both = table(np.concatenate([theta, TRUE]), np.tile(FIELDS, (2, 1)))
    assert [each.code for each in both.left_out] == ["angle-beyond-turn"]


def test_angles_beyond_half_a_turn_are_refused():
    with pytest.raises(ScenarioError, match=r"angle.*: theta of .* rad; .*or state the unit"):
        table(np.degrees(TRUE))
