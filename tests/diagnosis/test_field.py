"""Tables of the coils' field: predictions, errors, what is left out and what is refused."""

import math

import numpy as np
import pytest
from scipy.stats import f as f_law
from scipy.stats import kstest

from stickslip import COIL_NAMES, Coils, Scenario, Waveform, simulate, volts_per_tesla
from stickslip.errors import ScenarioError
from stickslip.walker.field import FieldTable

COLUMNS = (*COIL_NAMES, "x", "y", "z", "Bx", "By", "Bz")
NOISE = 5e-6  # T

# Each coil by itself at four currents, and no current, at the centre and beside it.
CURRENTS = np.vstack([*(i * np.eye(5) for i in (-2.0, -1.0, 1.0, 2.0)), np.zeros((1, 5))])
PLACES = np.array([[0.0, 0.0, 0.0], [2e-3, 1e-3, -1e-3]])
ROWS = np.array([[*amperes, *place] for amperes in CURRENTS for place in PLACES])
ON_WIRE = [1.0, 0.0, 0.0, 0.0, 0.0, 0.099, 0.06925, 0.0, 1e-3, 0.0, 0.0]


def probed(in_plane=0.0, clamp=0.0, ambient=(0.0, 0.0), seed=0, repeats=1, noise=NOISE):
    """Rows of a table: each coil's gain and a uniform field, by superposition."""
    random = np.random.default_rng(seed)
    rows = np.repeat(ROWS, repeats, axis=0)
    field = Coils().field(rows[:, 5:], rows[:, :5] * (1.0 + np.array([in_plane] * 4 + [clamp])))
    field += [ambient[0], 0.0, ambient[1]] + noise * random.standard_normal(field.shape)
    return np.hstack([rows, field])


def table(rows):
    return FieldTable(dict(zip(COLUMNS, np.array(rows).T, strict=True)), Scenario())


def test_predictions_are_the_field_that_a_simulated_robot_sees():
    # The field beside the robot's place as it was recorded, with every effect that changes it.
    V = volts_per_tesla()
    held = Waveform.hold(0.03, {"xp": 1e-3 * V, "xm": 2e-3 * V, "clamp": -1e-3 * V})
    keys = {
        "effects.field_gain.in_plane": 0.05, "effects.field_gain.clamp": -0.1,
        "effects.ambient_field.Bx": 3e-5, "effects.ambient_field.Bz": -4e-5,
        "coil.side": 0.13, "coil.distance": 0.1, "coil.turns": 480.0,
        "effects.gradient_scale.fraction": 0.4, "effects.eddy_lag.time": 0.0,
        "coil.resistance": 12.0,
    }  # fmt: skip
    drive = {"drive.mode": "program", "drive.program": held, "record.rate": 1e3}
    run = simulate(Scenario().replace({**drive, **keys}))
    assert run.ok
    shown = run.t > 5e-3
    place = np.stack([run.x, np.zeros_like(run.x), run.z], axis=1)[shown]
    field = np.stack([run.bx, np.zeros_like(run.bx), run.bz], axis=1)[shown]
    found = table(np.hstack([run.current[shown], place, field]))
    got = found.predict(list(keys), np.array([list(keys.values())])).reshape(-1, 3)
    expected = found.mean.reshape(-1, 3)
    # The core expands the field about the robot to within 1e-9 of it (test_expansion.cpp).
    assert np.abs(got - expected)[:, [0, 2]].max() < 1e-8 * np.abs(field).max()
    assert np.abs(got[:, 1]).max() < 1e-15


def test_gains_geometry_and_a_turned_probe_have_their_analytic_consequences():
    found = table(probed())
    names = ["effects.field_gain.clamp", "effects.ambient_field.By", "effects.ambient_field.Bz",
             "coil.turns", "drag.linear",
             "probe_turned.about_x", "probe_turned.about_y", "probe_turned.about_z"]  # fmt: skip
    quarter = 0.5 * math.pi
    values = np.array(
        [[0, 0, 0, 510, 1e-5, 0, 0, 0], [0.5, 0, 0, 510, 1e-3, 0, 0, 0],
         [0, 2e-5, 1e-5, 1020, 1e-5, 0, 0, 0], [0, 0, 0, 510, 1e-5, 0, quarter, 0]]
    )  # fmt: skip
    plain, clamp, doubled, turned = found.predict(names, values).reshape(4, -1, 3)
    assert plain == pytest.approx(Coils().field(found.points, found.currents), rel=1e-12, abs=1e-18)
    driven = found.currents[:, 4] != 0.0
    assert clamp[driven] == pytest.approx(1.5 * plain[driven], rel=1e-12)
    assert np.array_equal(clamp[~driven], plain[~driven])
    assert doubled == pytest.approx(2.0 * plain + [0, 2e-5, 1e-5], rel=1e-12, abs=1e-18)
    # The probe's x axis points down after a quarter turn about y.
    assert turned == pytest.approx(plain[:, [2, 1, 0]] * [-1, 1, 1], abs=1e-18)


def test_a_geometry_that_puts_a_wire_on_a_probe_has_no_prediction():
    found = table([[1, 0, 0, 0, 0, 0.05, 0.05, 0.05, 1e-3, 0, 0]] * 2)
    values = np.array([[0.099, 0.1385], [0.05, 0.1]])
    predicted = found.predict(["coil.distance", "coil.side"], values)
    assert np.all(np.isfinite(predicted[0]))
    assert np.all(np.isnan(predicted[1]))


@pytest.mark.parametrize("repeats", [1, 2])
@pytest.mark.daily("2")
def test_errors_are_those_of_the_readings_with_and_without_repeats(repeats):
    # Chi-square of the true model is an F law with the degrees of freedom of the errors: nearly,
    # as without repeats the fit and the misfit share readings.
    gains, levels = ["effects.field_gain.clamp", "effects.ambient_field.Bx"], []
    for seed in range(200):
        found = table(probed(clamp=0.3, ambient=(1e-4, 0.0), seed=seed, repeats=repeats))
        left = found.mean - found.predict(gains, np.array([[0.3, 1e-4]]))[0]
        chi2 = np.mean((left / found.errors.sd) ** 2)
        levels.append(f_law.sf(chi2, len(left), min(found.errors.dof, 1e9)))
        assert 0.7 * NOISE < found.errors.sd.max() * math.sqrt(repeats) < 1.4 * NOISE
    if repeats == 2:
        assert kstest(levels, "uniform").pvalue > 0.01
    assert np.mean(np.array(levels) < 0.05) < 0.05 + 3.0 * math.sqrt(0.05 * 0.95 / 200)
    # Without scatter there is a least error.
    found = table(probed(noise=0.0))
    size = 1e-3 * math.sqrt(np.mean(found.mean**2))
    assert found.errors.sd == pytest.approx(np.full(len(found.mean), size))


@pytest.mark.parametrize("copied", [[0], range(6), range(len(ROWS))])
@pytest.mark.parametrize("times", [2, 3])
def test_copies_of_rows_change_nothing(copied, times):
    rows = probed(clamp=0.3)
    once = table(rows)
    found = table(np.vstack([rows, *(times - 1) * [rows[copied]]]))
    assert found.mean == pytest.approx(once.mean, rel=1e-12)
    assert found.errors.sd == pytest.approx(once.errors.sd, rel=1e-9)
    assert found.errors.dof == once.errors.dof
    said, _ = found.notes
    assert (said.code, said.value) == ("copies", 3 * (times - 1) * len(copied))


def test_a_probe_on_a_wire_and_a_slip_are_left_out():
    rows = probed(seed=4, repeats=2)
    rows[20, 10] = 0.5  # a slip of the point
    rows[30] = ON_WIRE
    found = table(rows)
    assert [(each.code, each.value) for each in found.left_out] == [
        ("probes-on-wire", 1), ("far-field", 0.5),
    ]  # fmt: skip
    assert len(found) == 3 * (len(rows) - 2)
    # Two rows each are repeats, but for those that lost one; components are held out together.
    assert np.array_equal(found.group, np.repeat(np.arange(len(ROWS)), 3))
    assert sorted(np.bincount(found.condition))[:7] == [1] * 6 + [2]
    with pytest.raises(ScenarioError, match="every probe lies on the wire"):
        table([ON_WIRE] * 3)
