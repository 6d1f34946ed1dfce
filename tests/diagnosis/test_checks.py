"""What makes data suspect is said before any cause is blamed, and sound data pass."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

from made_velocities import drives, measurement, trials
from stickslip.diagnosis.data.checks import (
    FEWEST_CONDITIONS,
    find_problem,
    find_velocity_problem,
    velocity_notes,
)
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.data.velocity import VelocityTable


@pytest.fixture(scope="module")
def sound():
    """Three trials of both modes and directions at four frequencies."""
    return trials(table=pd.concat([drives(mode="IPP"), drives(mode="OPP")]))


def problem(table, **options):
    found = find_velocity_problem(VelocityTable(measurement(table)), **options)
    return None if found is None else found.code


def test_sound_data_pass(sound):
    assert problem(sound) is None


def of(level, repeats=3, seed=0, sd=0.03, **known):
    """A table of readings at levels, with errors of 3 %."""
    random = np.random.default_rng(seed)
    y = np.repeat(level, repeats) * (1.0 + sd * random.standard_normal(repeats * len(level)))
    return Table({"x": np.repeat(np.arange(len(level)), repeats)}, y, **known)


def code(table, **options):
    found = find_problem(table, **options)
    return None if found is None else found.code


def test_readings_that_are_all_zero_tell_nothing():
    assert code(of(np.zeros(6))) == "all-zero"
    assert code(of(np.array([0.0, 0.0, 0.0, 0.0, 1.0]))) != "all-zero"


def test_few_conditions_are_enough_beside_other_data():
    few = of(np.linspace(1.0, 2.0, FEWEST_CONDITIONS - 1))
    assert code(few) == "too-few-conditions"
    assert code(few, alone=False) is None
    assert code(of(np.linspace(1.0, 2.0, FEWEST_CONDITIONS))) is None


def test_without_repeats_the_error_has_to_be_stated():
    level = np.linspace(1.0, 2.0, 8)
    assert code(of(level, 1)) == "no-noise"
    assert code(of(level, 1), alone=False) is None
    assert code(of(level, 1, sd=0.03)) == "no-noise"
    stated = Table({"x": level}, level, sd=0.03)
    assert code(stated) is None


def test_conditions_that_are_all_alike_may_have_mixed_labels():
    # Means of nothing but errors: three times their variance with 19 degrees of freedom is rare.
    alike = [code(of(np.ones(20), seed=seed)) for seed in range(10)]
    assert alike == ["conditions-alike"] * 10
    # Levels that scatter by four times the error of a mean have a ratio of 17.
    random = np.random.default_rng(1)
    level = 1.0 + 4 * 0.03 / np.sqrt(3.0) * random.standard_normal(20)
    assert code(of(level)) is None


def test_what_a_set_up_shares_makes_conditions_no_less_different():
    # Set-ups differ by as much as the conditions do, and all conditions were in all set-ups.
    random = np.random.default_rng(2)
    x, setup = np.repeat(np.arange(10), 3), np.tile(np.arange(3), 10)
    y = 1.0 + 0.02 * x + 0.06 * random.standard_normal(3)[setup]
    table = Table({"x": x}, y + 0.01 * random.standard_normal(30), block=setup)
    assert table.errors.told["shift"] > 1.5
    assert code(table) is None


@pytest.mark.parametrize("factor", [500.0, 1e-3])
def test_another_unit_is_recognised_by_its_size(sound, factor):
    # Rows faster than 1 m/s would be left out, so a thousand is not quite reached.
    table = VelocityTable(measurement(sound.assign(velocity=factor * sound.velocity)))
    found = find_velocity_problem(table)
    assert found.code == "velocities-size"
    assert found.value == pytest.approx(factor, rel=0.1)
    assert "a unit that is wrong by 1000" in found.text


def test_one_velocity_of_another_size_is_named(sound):
    table = VelocityTable(measurement(sound))
    table.mean[5] *= 200.0
    found = find_velocity_problem(table)
    assert found.code == "velocity-size"
    assert "direction +x, frequency 40 Hz" in found.text
    assert "mode OPP" in found.text
    # A slow one is none: the robot may stand still.
    table.mean[5] /= 200.0 * 200.0
    assert find_velocity_problem(table) is None


CHANGES = {
    "opposite-sign": lambda table: -table.velocity,
    "speeds": lambda table: table.velocity.abs(),
    "reversed": lambda table: table.velocity.where(table.direction == "+x", -table.velocity),
}


@pytest.mark.parametrize("expected", list(CHANGES))
def test_signs_that_follow_a_rule_are_a_problem_of_the_data(sound, expected):
    table = sound.assign(velocity=1.1 * CHANGES[expected](sound))
    stated = VelocityTable(measurement(sound)).stated
    if np.array_equal(np.sign(stated), [1] * 4 + [-1] * 4 + [1] * 4 + [-1] * 4):
        # Then speeds and the reverse of -x are the same.
        expected = "speeds" if expected == "reversed" else expected
    assert problem(table) == expected


def test_a_mode_that_is_reversed_is_named(sound):
    turned = sound.velocity.where(sound["mode"] == "IPP", -sound.velocity)
    found = find_velocity_problem(VelocityTable(measurement(sound.assign(velocity=turned))))
    assert found.code == "reversed"
    assert "wherever mode is OPP" in found.text


def test_signs_without_a_rule_are_left_to_the_causes(sound):
    flipped = (sound.frequency == 25.0) & (sound.direction == "+x") | (sound.frequency == 60.0)
    assert problem(sound.assign(velocity=sound.velocity.where(~flipped, -sound.velocity))) is None
    # A bias, as of a tilt, reverses one direction and makes the other faster.
    bias = 2.1 * sound.velocity.abs().median()
    assert problem(sound.assign(velocity=sound.velocity + bias)) is None


def test_a_model_that_computes_nothing_says_why(sound):
    table = VelocityTable(measurement(sound))
    table.stated = np.full(len(table.mean), np.nan)
    table.refusal = "contact.static_friction = 0.1: too small"
    found = find_velocity_problem(table)
    assert found.code == "nothing-computed"
    assert "contact.static_friction" in found.text


def in_order(table, random):
    """Trials in an order in time that has nothing to do with their settings."""
    return table.assign(order=random.permutation(len(table)))


def test_a_drift_is_found_and_is_rare_without_one(sound):
    table = VelocityTable(measurement(in_order(sound, np.random.default_rng(0))))
    for toward in (np.ones(16), np.sign(table.mean)):
        # All velocities alike or all in proportion, by six errors from the first to the last.
        slope = 6.0 * table.errors.of_reading(table.mean) * toward
        drifting = VelocityTable(measurement(in_order(sound, np.random.default_rng(0))))
        drifting.y = table.y + slope[table.condition] * table.sequence / 48.0
        drifting.mean = np.bincount(table.condition, drifting.y) / 3.0
        found = find_velocity_problem(drifting)
        assert found.code == "drift"
        assert found.value < 1e-3
    # 0.002 of 300 tables is 0.6; five come once in 4000 such studies. In half of them errors are
    # correlated along the curves, which looks like a drift.
    random = np.random.default_rng(3)
    blamed = 0
    for seed in range(300):
        noise = random.standard_normal(48)
        if seed % 2:
            for curve in np.unique(table.curve):
                mine = np.flatnonzero(table.curve == curve)
                mine = mine[np.argsort(table.sequence[mine])]
                for before, after in pairwise(mine):
                    noise[after] = 0.5 * noise[before] + 0.75**0.5 * noise[after]
            table.errors.told["phi"] = 0.5
        else:
            table.errors.told["phi"] = 0.0
        size = table.errors.of_reading(table.stated)
        table.y = table.stated[table.condition] + (size[table.condition] * noise)
        table.mean = np.bincount(table.condition, table.y) / 3.0
        blamed += find_velocity_problem(table) is not None
    assert blamed < 5


def test_what_differs_between_set_ups_is_no_drift(sound):
    # Set-ups one after the other, each slower than the one before by three errors of a trial.
    order = sound.trial * 100 + np.random.default_rng(1).permutation(len(sound))
    slower = sound.velocity * (1.0 - 0.06 * sound.trial)
    known = sound.assign(velocity=slower, order=order, block=sound.trial)
    table = VelocityTable(measurement(known))
    assert find_velocity_problem(table) is None
    table.errors.told.update(phi=0.0)
    del table.errors.told["shift"]
    assert find_velocity_problem(table).code == "drift"


def test_zero_readings_where_the_model_walks_are_noted(sound):
    table = VelocityTable(measurement(sound))
    assert velocity_notes(table) == []
    table.mean[:6] = 0.0
    (found,) = velocity_notes(table)
    assert found.code == "stands-still"
    assert found.value == pytest.approx(np.max(np.abs(table.stated[:6])))
    assert "at 6 of 16 conditions" in found.text
    assert found.text.endswith("and 2 more.")
    # Where the model hardly moves either, zero is no news.
    table.stated[:6] = 1e-6
    assert velocity_notes(table) == []


def test_drives_that_measure_the_start_up_are_noted():
    table = VelocityTable(measurement(trials(table=drives(pulses=3))))
    (found,) = velocity_notes(table)
    assert (found.code, found.value) == ("few-pulses", 8)
    assert velocity_notes(VelocityTable(measurement(trials(table=drives(pulses=4))))) == []
