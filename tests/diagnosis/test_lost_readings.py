"""Readings of a lost sensor in logs of the ready-made models, and what looks like them."""

import numpy as np
import pytest

from stickslip import Series, diagnose_model, models

N = 400
T = np.arange(N) * 0.02
STEPS = np.repeat(np.random.default_rng(3).uniform(0.4, 1.0, 8), N // 8)
DRY = {"inertia": 0.3, "coulomb": 0.3}


def joint():
    made = models.joint(inertia=0.3, viscous=0.2).simulate(T, {"torque": STEPS}, start_speed=3.0)
    return {"torque": STEPS}, made


def sticking_joint():
    torque = np.where((np.arange(N) // 25) % 3 > 0, STEPS, 0.0)
    return {"torque": torque}, models.joint(**DRY).simulate(T, {"torque": torque})


def axis():
    made = models.axis(mass=2.0, viscous=1.0, gain=1.0, reads="position")
    return {"command": STEPS}, made.simulate(T, {"command": STEPS}, start_position=5.0)


def pendulum():
    return {"pivot": 0.0 * T}, models.pendulum(length=0.5).simulate(T, start_position=0.5)


def oscillator():
    made = models.oscillator(mass=1.0, stiffness=20.0, viscous=0.5)
    return {"force": STEPS}, made.simulate(T, {"force": STEPS}, start_position=0.1)


def heater():
    power = 60.0 * STEPS
    made = models.thermal(capacity=200.0, loss=2.0, ambient=20.0)
    return {"power": power}, made.simulate(100.0 * T, {"power": power}, start_temperature=20.0)


KINDS = [joint, sticking_joint, axis, pendulum, oscillator, heater]


def rows_of(spread):
    """Rows of losses: single ones, runs of up to four, or every fifth of all."""
    return {
        "single": np.array([20, 55, 90, 133, 190, 260, 301]),
        "runs": np.concatenate([np.arange(k, k + m) for k, m in ((30, 4), (120, 2), (333, 3))]),
        "every fifth": np.arange(3, N, 5),
    }[spread]


def record(make, noise=0.01):
    inputs, y = make()
    return inputs, y + noise * np.ptp(y) * np.random.default_rng(1).standard_normal(N)


@pytest.mark.parametrize("make", KINDS)
@pytest.mark.parametrize("spread", ["single", "runs", "every fifth"])
@pytest.mark.parametrize("value", ["far below", "far above", "just above"])
def test_alike_readings_far_from_their_neighbours_are_told(make, spread, value):
    inputs, y = record(make)
    size = {"far below": -9.0, "far above": 9.0, "just above": 1.5}[value]
    y[rows_of(spread)] = round(float(y.min() + size * np.ptp(y)), 3)
    (note,) = Series(T, y, inputs).own_notes
    few = spread != "every fifth"
    assert note.code == ("lost-readings" if few else "lost-sensor")
    assert f"{len(rows_of(spread))} of {N} readings are {y[rows_of(spread)[0]]:g}" in note.text
    kept = Series(T, y, inputs).rows
    assert np.isin(rows_of(spread), kept).any() != few
    assert len(kept) == N - few * len(rows_of(spread))


@pytest.mark.parametrize("make", [joint, axis, heater])
@pytest.mark.parametrize("spread", ["single", "runs", "every fifth"])
def test_zeros_among_readings_that_are_none(make, spread):
    inputs, y = record(make, 1e-3)
    y[rows_of(spread)] = 0.0
    (note,) = Series(T, y, inputs).own_notes
    assert "readings are 0, far from" in note.text


@pytest.mark.parametrize("make", [pendulum, oscillator])
def test_zeros_of_a_curve_that_passes_zero_are_lost_where_it_is_far(make):
    inputs, y = record(make, 1e-3)
    far = np.flatnonzero(np.abs(y) > 0.2 * np.ptp(y))[5::23]
    y[far] = 0.0
    made = Series(T, y, inputs)
    assert [note.code for note in made.own_notes] == ["lost-readings"]
    assert {*range(N)} - {*made.rows.tolist()} == {*far.tolist()}


def short_events(y):
    y[[40, 41, 120, 200, 201, 202, 310]] += np.ptp(y) * np.array([3, 2, 4, 3, 5, 2, 3.5])
    return y


def quantised(y):
    step = np.ptp(y) / 12.0
    return np.round(y / step) * step


@pytest.mark.parametrize("make", KINDS)
@pytest.mark.parametrize(
    "change",
    [np.array, quantised, short_events],
    ids=["as made", "quantised", "short events"],
)
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_no_sound_reading_is_taken_for_a_lost_one(make, change, noise):
    inputs, y = record(make, noise)
    kept = Series(T, change(y), inputs)
    assert len(kept) == N
    assert kept.own_notes == ()


def test_a_rest_that_an_input_makes_is_no_loss():
    off = np.arange(N) % 5 == 0
    torque = np.where(off, 0.0, STEPS)
    y = np.where(off, 0.0, 3.0 + 0.01 * np.random.default_rng(2).standard_normal(N))
    assert Series(T, y, {"torque": torque}).own_notes == ()
    assert [each.code for each in Series(T, y, {"torque": STEPS}).own_notes] == ["lost-sensor"]


@pytest.mark.nightly
def test_a_log_with_many_lost_readings_ends_in_a_data_problem():
    inputs, y = record(joint)
    y[rows_of("every fifth")] = 0.0
    found = diagnose_model(
        models.joint(inertia=(0.3, 0.01), viscous=(0.2, 0.01)), Series(T, y, inputs)
    )
    assert found.verdict.kind == "data-problem"
    assert "80 of 400 readings are 0, far from those before and after them" in found.summary()


@pytest.mark.nightly
def test_a_misfit_of_a_few_readings_is_told_by_these():
    inputs, y = record(joint)
    wild = np.array([50, 51, 120, 121, 122, 300])
    y[wild] += np.array([1.0, 1.3, 1.1, 1.5, 1.2, 1.4])
    made = models.joint(inertia=(0.3, 0.01), viscous=(0.2, 0.01))
    found = diagnose_model(made, Series(T, y, inputs, sd=0.01 * np.ptp(y)))
    said = found.summary().splitlines()[0]
    assert found.verdict.kind == "unexplained"
    assert f"t 1 s ({y[50]:g}), t 1.02 s ({y[51]:g})" in said
    assert "6 of 400 readings" in said
