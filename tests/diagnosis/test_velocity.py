"""Tables of mean velocities: how they are pooled, predicted, and how exactly they are computed."""

import dataclasses

import numpy as np
import pytest

from made_velocities import SCENARIO, drives, measurement, trials, velocities
from stickslip import simulate_batch
from stickslip.diagnosis import Prior
from stickslip.walker.velocity import VelocityTable

NAMES = ["contact.kinetic_friction", "velocity_offset.shift"]


@pytest.fixture(scope="module")
def found():
    return VelocityTable(measurement(trials()), threads=2)


def simulated(conditions, **changes):
    """Mean velocities of the scenario at conditions, m/s."""
    changes = {key.replace("__", "."): value for key, value in changes.items()}
    runs = simulate_batch([SCENARIO.replace({**each, **changes}) for each in conditions])
    return np.array([run.mean_velocity for run in runs])


def test_predictions_are_simulations_read_by_the_instruments(found):
    # In the last row kinetic friction is above the static one.
    values = np.array([[0.145, 0.0], [0.15, 2e-4], [0.15, 0.0], [0.9, 0.0]])
    *got, refused = found.predict(NAMES, values)
    for (friction, shift), row in zip(values.tolist(), got, strict=False):
        expected = simulated(found.conditions, contact__kinetic_friction=friction) + shift
        assert row == pytest.approx(expected, rel=1e-12)
    assert np.all(np.isnan(refused))
    one = VelocityTable(measurement(trials()), threads=1)
    assert np.array_equal(one.predict(NAMES, values[:3]), got)
    assert np.array_equal(found.predict(NAMES, values[:1])[0], got[0])
    # Of low fidelity are fewer pulses and a loose tolerance.
    short = simulated(found.conditions, drive__pulses=4, solver__rtol=1e-4)
    assert one.low_fidelity(NAMES[:1], np.array([[0.145]]))[0] == pytest.approx(short, rel=1e-12)


def test_a_simulation_has_so_many_steps_for_each_pulse(found, monkeypatch):
    monkeypatch.setattr("stickslip.walker.velocity._STEPS_A_PULSE", 1)
    for predict in (found.predict, found.low_fidelity):
        assert np.isnan(predict(NAMES[:1], np.array([[0.145]]))).all()


def test_the_stated_model_is_at_the_middle_of_the_priors(found):
    higher = {"contact.kinetic_friction": Prior("normal", 0.16, 0.01)}
    table = VelocityTable(measurement(trials(), higher))
    expected = simulated(table.conditions, contact__kinetic_friction=0.16, solver__rtol=1e-6)
    assert table.stated == pytest.approx(expected, rel=1e-12)
    assert not np.allclose(table.stated, velocities(drives()), rtol=1e-3)


def test_the_order_of_rows_changes_nothing(found):
    table = trials()
    mixed = table.sample(frac=1.0, random_state=3)
    again = VelocityTable(measurement(mixed))
    assert again.conditions == found.conditions
    assert again.mean == pytest.approx(found.mean)
    assert again.errors.sd == pytest.approx(found.errors.sd)
    # Neighbours lie on one curve.
    keys = [(each["drive.direction"], each["drive.frequency"]) for each in found.conditions]
    assert keys == [(way, f) for way in ("+x", "-x") for f in (25.0, 40.0, 60.0, 90.0)]
    assert np.bincount(found.condition).tolist() == [3] * 8
    assert found["drive.frequency"][found.first].tolist() == 2 * [25.0, 40.0, 60.0, 90.0]


def test_a_curve_in_a_sweep_of_a_set_up_is_a_run(found):
    # Two directions and three sweeps.
    pairs = np.unique(np.stack([found.curve, found.condition]), axis=1)
    assert [np.sum(pairs[0] == run) for run in range(6)] == [4] * 6
    assert found.block.tolist() == [-1] * 24
    assert "no-block-column" in [each.code for each in found.notes]
    # Of two tables, conditions are repeats, blocks and runs are not shared.
    table = trials().assign(block=lambda rows: np.where(rows.trial == 0, "a", "b"))
    pooled = measurement(table)
    pooled = dataclasses.replace(pooled, velocity=2 * pooled.velocity)
    twice = VelocityTable(pooled)
    assert np.bincount(twice.condition).tolist() == [6] * 8
    assert np.unique(twice.block).tolist() == [0, 1, 2, 3]
    assert len(np.unique(twice.curve)) == 12
    assert {"shift", "gain", "phi"} <= set(twice.errors.sizes)


def test_with_an_order_all_sweeps_of_a_curve_are_one_run():
    random = np.random.default_rng(0)
    table = trials(noise=0.05)
    ordered = table.assign(order=random.permutation(len(table)) * 2.0)
    found = VelocityTable(measurement(ordered))
    assert len(np.unique(found.curve)) == 2
    # Sequence and velocity stay together.
    expected = dict(zip(ordered.order, ordered.velocity, strict=True))
    assert dict(zip(found.sequence, found.y, strict=True)) == expected


def test_conditions_that_the_stated_model_refuses_are_left_out():
    # A hold below zero, which no file could state.
    table = trials()
    given = measurement(table.assign(frequency=table.frequency.replace(90.0, 95.0)))
    (data,) = given.velocity
    settings = tuple(
        {**each, "drive.hold": -1.0} if each["drive.frequency"] == 95.0 else each
        for each in data.conditions
    )
    broken = dataclasses.replace(data, conditions=settings)
    found = VelocityTable(dataclasses.replace(given, velocity=(broken,)))
    assert [each.code for each in found.left_out] == ["condition-not-computed"] * 2
    assert "95 Hz" in found.left_out[0].text
    assert len(found.mean) == len(found.conditions) == found.condition.max() + 1 == 6
    assert np.all(np.isfinite(found.stated))
    assert found.predict([], np.zeros((1, 0)))[0] == pytest.approx(found.stated, rel=1e-3)
