"""Uncertain parameters of a scenario: their file, their draws, and refusals."""

import functools
import math
import pickle

import numpy as np
import pytest

from stickslip import (
    JointPrior,
    Measurement,
    Prior,
    Scenario,
    ScenarioError,
    load,
    simulate,
    sweep,
)
from stickslip.scenario.scenario import with_uncertain_of
from stickslip.walker import read_measurement

KEYS = ("coil.resistance", "effects.surface_tilt.angle", "drag.linear")
# Correlations of 0.5, -0.8 and 0.1; the middles below lie at least 5 standard deviations inside.
SD = np.array([0.2, 0.01, 1e-6])
MATRIX = np.outer(SD, SD) * [[1.0, 0.5, -0.8], [0.5, 1.0, 0.1], [-0.8, 0.1, 1.0]]
PRIORS = {
    "contact.kinetic_friction": Prior("normal", 0.13, 0.005),
    "drag.rotational": Prior("log-normal", 9e-17, 2.0),
    "contact.adhesion": Prior("log-uniform", 1e-8, 1e-6),
    "effects.surface_tilt.azimuth": Prior("uniform", -1.0, 2.0),
}


def scenario():
    return Scenario(uncertain=JointPrior(PRIORS, KEYS, MATRIX)).replace(
        {"effects.surface_tilt.angle": 0.02}
    )


DRAWS = 1000


@functools.cache
def drawn():
    given = scenario()
    return {
        key: np.array([each.get(key) for each in given.draws(DRAWS)])
        for key in given.uncertain.names
    }


def test_a_scenario_with_all_that_is_uncertain_survives_file_and_pickle(tmp_path):
    given = scenario()
    given.to_toml(tmp_path / "scenario.toml")
    for again in (load(tmp_path / "scenario.toml"), pickle.loads(pickle.dumps(given))):
        assert again == given
        assert hash(again) == hash(given)
        assert again.draws(2) == given.draws(2)
    assert given != given.with_uncertain(None)
    assert given.replace({"drive.peak": 2e-3}).uncertain is given.uncertain


def test_tables_and_objects_are_the_same_whatever_their_order():
    tables = {
        "surface_tilt.angle": {"mean": 0.0, "sd": 0.01},
        "drag.linear": {"median": 1e-5, "factor": 2},
    }
    given = Scenario(uncertain=tables)
    turned = Scenario(uncertain=dict(reversed(tables.items())))
    assert given == turned
    assert given.draws(3) == turned.draws(3)
    assert given.uncertain == JointPrior(
        {
            "drag.linear": Prior("log-normal", 1e-5, 2.0),
            "effects.surface_tilt.angle": Prior("normal", 0.0, 0.01),
        }
    )


def test_a_run_and_a_sweep_take_the_values_of_the_keys():
    given = scenario().replace({"drive.pulses": 4})
    known = given.with_uncertain(None)
    runs = [simulate(each).summary() | {"notes": []} for each in (given, known)]
    assert runs[0] == runs[1]
    speeds = [
        sweep(each, {"drive.frequency": [50.0]}).mean_velocity.item() for each in (given, known)
    ]
    assert speeds[0] == speeds[1]


@pytest.mark.parametrize(
    ("key", "prior", "far"),
    [
        ("contact.static_friction", Prior("normal", 0.3, 0.03), True),  # of the default, 0.2
        ("contact.static_friction", Prior("normal", 0.21, 0.01), False),
        ("contact.static_friction", Prior("log-normal", 0.35, 1.2), True),
        ("contact.static_friction", Prior("uniform", 0.25, 0.4), True),
        ("contact.static_friction", Prior("uniform", 0.0, 0.4), False),
        ("contact.static_friction", Prior("uniform", 0.2, 0.4), False),  # its ends are in it
        ("contact.static_friction", Prior("uniform", 0.199, 0.4), False),
        ("contact.static_friction", Prior("log-uniform", 0.25, 0.4), True),
        ("effects.surface_tilt.angle", Prior("uniform", 0.0, 0.001), False),  # 0
    ],
)
def test_a_run_notes_a_value_that_is_far_from_its_prior(key, prior, far):
    given = Scenario(uncertain=JointPrior({key: prior}))
    notes = simulate(given.replace({"drive.pulses": 2})).notes
    found = [note for note in notes if note.code == "prior"]
    assert [note.value for note in found] == [given.get(key)] * far
    assert all(note.text.endswith(f"set {key} = {float(prior.value(0.0)):g}") for note in found)


def test_a_draw_is_the_same_however_many_there_are():
    given = scenario()
    assert given.draws(3, seed=5) == given.draws(7, seed=5)[:3]
    assert given.draws(1, seed=5) != given.draws(1, seed=6)
    assert all(each.uncertain is None for each in given.draws(3))


def test_draws_have_the_covariance_that_was_stated():
    # A sample covariance of n normal draws has the variance (c_ii c_jj + c_ij^2) / n. Five standard
    # errors: one of six entries is farther off once in 3e5 seeds.
    n, found = DRAWS, drawn()
    values = np.array([found[key] for key in KEYS])
    error = np.sqrt((np.outer(SD, SD) ** 2 + MATRIX**2) / n)
    assert (np.abs(np.cov(values) - MATRIX) < 5.0 * error).all()
    middle = np.array([scenario().get(key) for key in KEYS])
    assert (np.abs(values.mean(axis=1) - middle) < 5.0 * SD / math.sqrt(n)).all()
    # What has a prior of its own is independent of the covariance: correlations are 1/sqrt(n).
    others = [found["contact.kinetic_friction"], np.log(found["contact.adhesion"])]
    cross = np.corrcoef([*values, *others])[:3, 3:]
    assert (np.abs(cross) < 5.0 / math.sqrt(n)).all()


def test_draws_have_the_quantiles_of_their_priors():
    # A share q of n draws lies below the quantile q, to within sqrt(q (1 - q) / n).
    n, found = DRAWS, drawn()
    for key, prior in PRIORS.items():
        for z, share in ((-1.2816, 0.1), (0.0, 0.5), (1.2816, 0.9)):
            below = np.mean(found[key] < float(prior.value(z)))
            assert abs(below - share) < 5.0 * math.sqrt(share * (1.0 - share) / n), key


def test_a_prior_says_itself_where_it_lies_and_a_covariance_lies_about_the_keys():
    both = {
        "drag.linear": {"mean": 3e-5, "sd": 1e-9},
        "covariance": {"keys": ["coil.resistance"], "matrix": [[1e-6]]},
    }
    given = Scenario(uncertain=both).replace({"drag.linear": 1e-6, "coil.resistance": 4.0})
    (draw,) = given.draws(1)
    assert draw.drag.linear == pytest.approx(3e-5, abs=1e-8)
    assert draw.coil.resistance == pytest.approx(4.0, abs=1e-2)


def test_values_that_make_no_scenario_are_drawn_again():
    # Half of the normal law lies below zero, which a drag cannot.
    given = Scenario(uncertain={"drag.linear": {"mean": 0.0, "sd": 1e-5}})
    values = np.array([each.drag.linear for each in given.draws(500)])
    assert (values >= 0.0).all()
    # Mean of a half-normal law, and its standard error.
    assert values.mean() == pytest.approx(
        1e-5 * math.sqrt(2.0 / math.pi), abs=5e-5 * math.sqrt((1.0 - 2.0 / math.pi) / 500)
    )


def test_a_singular_covariance_is_drawn_from():
    matrix = np.outer([0.2, 1e-6, 0.0], [0.2, 1e-6, 0.0])
    given = Scenario(
        uncertain=JointPrior({}, ("coil.resistance", "drag.linear", "robot.mass"), matrix)
    )
    for each in given.draws(20):
        z = (each.coil.resistance - given.coil.resistance) / 0.2
        assert (each.drag.linear - given.drag.linear) / 1e-6 == pytest.approx(z, abs=1e-6)
        assert each.robot.mass == given.robot.mass


def test_what_cannot_be_drawn_is_refused_in_one_line():
    with pytest.raises(ScenarioError, match="no uncertain parameter to draw"):
        Scenario().draws(3)
    for count, seed in ((0, 0), (2.5, 0), (True, 0), (3, -1)):
        with pytest.raises(ScenarioError, match="allowed is a whole number"):
            scenario().draws(count, seed)
    above = {"contact.kinetic_friction": {"mean": 0.9, "sd": 0.01}}  # of the static friction
    with pytest.raises(ScenarioError, match=r"100 draws.*contact\.kinetic_friction"):
        Scenario(uncertain=above).draws(1)


def test_a_measurement_takes_what_its_scenario_says_unless_it_says_it_itself(tmp_path):
    (tmp_path / "velocity.csv").write_text("velocity,frequency\n1e-3,50\n1.1e-3,50\n")
    own = Scenario(uncertain={"drag.linear": {"median": 1e-5, "factor": 2.0}})
    joint = Scenario(uncertain=JointPrior({}, ("drag.linear",), ((1e-12,),)))
    head = 'stickslip_measurement = 1\nscenario = "scenario.toml"\n'
    table = '[[velocity]]\nfile = "velocity.csv"\n'
    other = '[uncertain]\n"robot.mass" = { mean = 1e-9, sd = 1e-11 }\n'

    def read(given, section):
        given.to_toml(tmp_path / "scenario.toml")
        (tmp_path / "measurement.toml").write_text(head + section + table)
        return read_measurement(tmp_path / "measurement.toml")

    assert read(own, "").uncertain == own.uncertain.priors
    assert list(read(own, other).uncertain) == ["robot.mass"]
    assert read(joint, "[uncertain]\n").uncertain == {}
    assert read(own, "").scenario == Scenario()
    with pytest.raises(ScenarioError, match=r"measurement\.toml: the scenario's .*covariance"):
        read(joint, "")
    with pytest.raises(ScenarioError, match="priors of single keys"):
        read(own, '[uncertain.covariance]\nkeys = ["drag.linear"]\nmatrix = [[1e-12]]\n')


def test_a_file_says_what_is_uncertain_in_another_scenario(tmp_path):
    path = tmp_path / "uncertain.toml"
    other = Scenario().replace({"drive.frequency": 30.0, "coil.resistance": 7.0})
    scenario().to_toml(path)
    found = with_uncertain_of(other, path)
    # The covariance lies about the values that its keys have there.
    assert found == other.replace({key: scenario().get(key) for key in KEYS}).with_uncertain(
        scenario().uncertain
    )
    # Of a measurement only this section is read: its tables need not be there.
    path.write_text(
        'stickslip_measurement = 1\n[uncertain]\n"drag.linear" = {mean=1e-5, sd=1e-6}\n'
    )
    assert with_uncertain_of(other, path).uncertain == JointPrior(
        {"drag.linear": Prior("normal", 1e-5, 1e-6)}
    )
    with pytest.raises(ScenarioError, match="no uncertain parameter"):
        other.with_uncertain(Scenario())


def test_a_table_in_memory_takes_what_its_scenario_says():
    pandas = pytest.importorskip("pandas")
    rows = pandas.DataFrame({"velocity": [1e-3, 1.1e-3], "frequency": [50.0, 50.0]})
    own = Scenario(uncertain={"drag.linear": {"median": 1e-5, "factor": 2.0}})
    assert Measurement.from_dataframe(rows, own).uncertain == own.uncertain.priors
    assert Measurement.from_dataframe(rows, own, {}).uncertain == {}
