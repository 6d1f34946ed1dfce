"""Tables of mean velocities: how they are pooled, predicted, and how exactly they are computed."""

import dataclasses

import numpy as np
import pandas as pd
import pytest

from made_velocities import FRICTION, SCENARIO, drives, measurement, trials, velocities
from stickslip import simulate_batch
from stickslip.diagnosis import Prior
from stickslip.diagnosis.data.velocity import TOLERANCES, VelocityTable, in_words, varied

NAMES = ["contact.kinetic_friction", "velocity_offset.shift"]


@pytest.fixture(scope="module")
def found():
    return VelocityTable(measurement(trials()), threads=2)


def test_predictions_are_simulations_read_by_the_instruments(found):
    values = np.array([[0.145, 0.0], [0.15, 2e-4], [0.15, 0.0]])
    before = found.simulated
    got = found.predict(NAMES, values)
    # Vectors that differ in the instrument alone share a simulation.
    assert found.simulated - before == 2 * len(found.mean)
    for (friction, shift), row in zip(values.tolist(), got, strict=True):
        runs = [
            SCENARIO.replace({**each, "contact.kinetic_friction": friction})
            for each in found.conditions
        ]
        expected = [run.mean_velocity + shift for run in simulate_batch(runs)]
        assert row.tolist() == pytest.approx(expected, rel=1e-12)
    assert np.array_equal(found.predict(NAMES, values[:1])[0], got[0])


def test_what_the_model_refuses_is_not_a_number(found):
    # A kinetic friction above the static one.
    got = found.predict(NAMES[:1], np.array([[0.145], [0.9]]))
    assert np.all(np.isfinite(got[0]))
    assert np.all(np.isnan(got[1]))


def test_predictions_do_not_depend_on_threads(found):
    one = VelocityTable(measurement(trials()), threads=1)
    values = np.array([[0.14], [0.15], [0.16]])
    assert np.array_equal(one.predict(NAMES[:1], values), found.predict(NAMES[:1], values))


def test_low_fidelity_has_fewer_pulses_and_a_loose_tolerance(found):
    got = found.low_fidelity(NAMES[:1], np.array([[0.145]]))[0]
    short = [
        SCENARIO.replace({**each, "drive.pulses": 4, "solver.rtol": 1e-4})
        for each in found.conditions
    ]
    expected = [run.mean_velocity for run in simulate_batch(short)]
    assert got.tolist() == pytest.approx(expected, rel=1e-12)


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
    # Of two tables, conditions are repeats, set-ups and runs are not shared.
    table = trials().assign(block=lambda rows: np.where(rows.trial == 0, "a", "b"))
    pooled = measurement(table)
    pooled = dataclasses.replace(pooled, velocity=2 * pooled.velocity)
    twice = VelocityTable(pooled)
    assert np.bincount(twice.condition).tolist() == [6] * 8
    assert np.unique(twice.block).tolist() == [0, 1, 2, 3]
    assert len(np.unique(twice.curve)) == 12
    assert {"shift", "gain", "phi"} <= set(twice.errors.told)


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
    wrong = table.assign(frequency=table.frequency.replace(90.0, 95.0))
    given = measurement(wrong)
    data = given.velocity[0]
    settings = [
        {**each, "drive.hold": -1.0} if each["drive.frequency"] == 95.0 else each
        for each in data.conditions
    ]
    broken = dataclasses.replace(
        given, velocity=(dataclasses.replace(data, conditions=tuple(settings)),)
    )
    found = VelocityTable(broken)
    assert [each.code for each in found.left_out] == ["condition-not-computed"] * 2
    assert "95 Hz" in found.left_out[0].text
    assert len(found.mean) == len(found.conditions) == 6
    assert found.condition.max() == 5
    assert np.all(np.isfinite(found.stated))
    assert found.predict([], np.zeros((1, 0)))[0] == pytest.approx(found.stated, rel=1e-3)


def test_the_stated_error_is_used_without_repeats():
    found = VelocityTable(measurement(trials(1), velocity_sd=0.05))
    assert found.errors.told["rho"] == 0.05
    assert found.errors.dof == np.inf


def test_places_are_the_settings_that_vary():
    table = pd.concat([drives(peak=3e-3), drives(peak=4e-3, mode="OPP")])
    found = VelocityTable(measurement(trials(table=table.fillna({"mode": "IPP"}))))
    frequency, peak, opp, back = found.places.T
    assert np.exp(frequency).tolist() == pytest.approx(
        [each["drive.frequency"] for each in found.conditions]
    )
    assert peak.tolist() == [each["drive.peak"] for each in found.conditions]
    assert opp.tolist() == [each["drive.mode"] == "OPP" for each in found.conditions]
    assert back.tolist() == [each["drive.direction"] == "-x" for each in found.conditions]
    assert found.group.tolist() == list(range(16))


def test_settings_are_named_in_the_units_of_a_laboratory(found):
    keys = varied(found.conditions)
    assert keys == ["drive.direction", "drive.frequency"]
    said = in_words(found.conditions[5], [*keys, "drive.base"])
    assert said == "direction -x, frequency 40 Hz, base 0.5 mT"


def _errors(uncertain, values, conditions):
    """Of each tolerance against one a hundred times finer than the finest, m/s."""

    def computed(rtol):
        runs = [
            SCENARIO.replace(
                {**each, **dict(zip(uncertain, row, strict=True)), "solver.rtol": rtol}
            )
            for row in values
            for each in conditions
        ]
        got = [run.mean_velocity for run in simulate_batch(runs)]
        return np.array(got).reshape(len(values), -1)

    truth = computed(0.01 * TOLERANCES[-1])
    return {rtol: np.abs(computed(rtol) - truth) for rtol in TOLERANCES}


def test_each_condition_has_the_loosest_tolerance_whose_error_is_far_below_its_noise():
    # Without uncertain constants, errors from where the loosest will do to where none does.
    table = drives((20.0, 30.0, 45.0, 70.0, 100.0), pulses=5)
    readings = trials(1, 0.0, table=table)
    found = VelocityTable(measurement(readings, {}, velocity_sd=0.01))
    error = {rtol: each[0] for rtol, each in _errors([], [[]], found.conditions).items()}
    chosen = [each["solver.rtol"] for each in found.conditions]
    assert len(set(chosen)) > 1
    for k, rtol in enumerate(chosen):
        assert error[rtol][k] < found.errors.sd[k] / 20.0 or rtol == TOLERANCES[-1]
        for looser in TOLERANCES[: TOLERANCES.index(rtol)]:
            assert error[looser][k] > found.errors.sd[k] / 20.0
    assert found.scenario.get("solver.rtol") == min(chosen)


def test_tolerances_hold_over_the_prior():
    # Chosen by three quarters of eight draws, so of others most are as good.
    found = VelocityTable(measurement(trials(1, 0.0), velocity_sd=0.5))
    prior = FRICTION["contact.kinetic_friction"]
    others = prior.value(np.random.default_rng(7).standard_normal((20, 1)))
    error = _errors(["contact.kinetic_friction"], others.tolist(), found.conditions)
    looser = 0
    for k, each in enumerate(found.conditions):
        rtol = each["solver.rtol"]
        looser += rtol != TOLERANCES[-1]
        if rtol != TOLERANCES[-1]:
            assert np.mean(error[rtol][:, k] < found.errors.sd[k] / 20.0) > 0.5
    assert looser > 4


def test_the_stated_model_is_at_the_middle_of_the_priors():
    higher = {"contact.kinetic_friction": Prior("normal", 0.16, 0.01)}
    found = VelocityTable(measurement(trials(), higher))
    expected = [
        run.mean_velocity
        for run in simulate_batch(
            [
                SCENARIO.replace({**each, "contact.kinetic_friction": 0.16, "solver.rtol": 1e-6})
                for each in found.conditions
            ]
        )
    ]
    assert found.stated == pytest.approx(np.array(expected), rel=1e-12)
    assert not np.allclose(found.stated, velocities(drives()), rtol=1e-3)
