"""A diagnosis of a toy model whose truth is known, as a person gets it."""

import json

import numpy as np
import pytest

import made_findings as made
from stickslip.diagnosis.decision.limits import upper_limits
from stickslip.diagnosis.decision.posterior import discrepancy
from stickslip.errors import ScenarioError

TRUTH = (1.1, 1.9, made.BUMP, 0.0, 0.0)


@pytest.fixture(scope="module")
def named():
    return made.toy(TRUTH)


@pytest.fixture(scope="module")
def none():
    return made.toy((1.1, 1.9, 0.0, 0.0, 0.0))


@pytest.fixture(scope="module")
def rough():
    """With an error along the curves that is no cause."""
    return made.toy(TRUTH, error=0.12)


def test_parameters_are_those_of_the_truth(named):
    assert named.verdict.causes == ("bump",)
    table = named.params
    assert list(table.index) == ["level", "slope", "bump.height"]
    off = (table["value"] - np.array(TRUTH[:3])) / table["sd"]
    assert np.all(np.abs(off) < 3.0)
    assert np.allclose(np.diag(named.covariance), table["sd"] ** 2)


def test_errors_are_those_of_linear_least_squares(named):
    """The model is linear, and the prior of the bump is wide beside what the data tell."""
    x = named.problem.tables[0]["x"]
    design = np.stack([made.predict(x, row[None])[0] for row in np.eye(5)[:3]], axis=1) / made.SD
    # The constants' priors are ten errors wide; they count.
    precision = design.T @ design + np.diag([0.3**-2, 0.3**-2, 0.0])
    sd = np.sqrt(np.diag(np.linalg.inv(precision)))
    assert np.allclose(named.params["sd"], sd, rtol=0.03)
    table = named.conf_int(0.6827)
    half = (table["high"] - table["low"]).to_numpy() / 2.0
    assert np.allclose(half, sd, rtol=0.03)


def test_intervals_end_at_the_limits_of_their_parameter(none):
    ends = none.candidate("wave").interval(0.95).loc["wave.size"]
    assert ends["low"] == 0.0 < ends["high"]


@pytest.mark.parametrize("level", [0.0, 1.0, "0.9", True])
def test_a_level_is_a_number_between_0_and_1(named, level):
    with pytest.raises(ScenarioError, match="level"):
        named.conf_int(level)


def test_every_model_that_was_fitted_is_a_candidate(named, none, rough):
    for result in (named, none, rough):
        table = result.compare()
        assert np.isclose(table["probability"].sum(), 1.0)
        assert table["probability"].is_monotonic_decreasing
        assert table.loc["none", "log_evidence"] == 0.0
        for name in table.index:
            candidate = result.candidate(name)
            assert candidate.name == name
            assert (candidate.gain is None) == (name == "none")
            rows = candidate.prediction
            assert len(rows) == 40
            assert np.all(np.isfinite(rows["predicted_sd"]))
    pair = next(name for name in named.compare().index if "+" in name)
    assert named.candidate(" + ".join(reversed(pair.split(" + ")))).name == pair
    assert named.candidate("bump").fit is named.verdict.fit
    assert named.candidate("bump").share == 1.0
    assert named.candidate("none").share == 0.0


def test_an_unknown_candidate_is_refused_with_a_hint(named):
    with pytest.raises(ScenarioError, match='did you mean "bump"') as raised:
        named.candidate("bmup")
    assert "\n" not in str(raised.value)


def test_a_discrepancy_widens_the_errors_by_what_is_left(rough):
    best = rough.best
    assert rough.verdict.kind == "dominant"
    left = discrepancy(best.fit)
    models = rough.findings.models
    whole = max(
        (fit for (names, form), fit in models.best.items() if not names and form != "none"),
        key=models.log_posterior,
    )
    taken = discrepancy(whole) - left
    assert np.isclose(best.widening, np.sqrt(1.0 + left / taken))
    narrow = np.sqrt(best.fit.covariance[0, 0]) * 0.3  # of the level, by its prior
    assert np.isclose(best.params.loc["level", "sd"], narrow * best.widening)
    assert (
        abs(best.params.loc["bump.height", "value"] - made.BUMP)
        < 3.0 * (best.params.loc["bump.height", "sd"])
    )
    assert set(best.left) >= {"form", "kappa", "size"}
    assert 0.03 < best.left["size"]["volts"] < 0.4  # the error's size is 0.12


def test_predictions_follow_the_fitted_values(named):
    at = np.array([0.1, 0.5, 0.9])
    table = named.predict(at)
    values = np.zeros((1, 5))
    values[0, :3] = named.params["value"]
    assert np.allclose(table["extended"], made.predict(at, values)[0])
    jacobian = np.stack([made.predict(at, row[None])[0] for row in np.eye(5)[:3]], axis=1)
    sd = np.sqrt(np.diag(jacobian @ named.covariance.to_numpy() @ jacobian.T))
    assert np.allclose(table["extended_sd"], sd, rtol=0.02)


def test_models_are_separated_where_they_differ(rough, none):
    table = rough.separate(np.linspace(0.0, 1.0, 21))
    assert set(table["first"]) | set(table["second"]) >= {"bump", "none"}
    shown = table["separation"].where(table["second"] == "none")
    assert abs(0.05 * shown.idxmax() - 0.5) < 0.2
    # What is far behind the first rival is told apart from the claim in any case.
    chance = rough.chance.models
    rivals = [chance[name] for name in table.columns if name in chance and name != "bump"]
    assert rivals
    assert min(rivals) >= 1e-3 * max(rivals)
    assert none.separate([0.5]) is None
    with pytest.raises(ScenarioError, match="separate"):
        rough.propose_experiments()


def test_upper_limits_are_those_of_linear_least_squares(none):
    found = none.findings
    limits = upper_limits(found.problem, found.models.null, found.responses)
    x, y = found.problem.tables[0]["x"], found.problem.y
    design = np.stack([made.predict(x, row[None])[0] for row in np.eye(5)], axis=1) / made.SD
    prior = np.diag([1.0 / 0.3, 1.0 / 0.3])
    whole = np.vstack([design, np.zeros((2, 5))])
    whole[-2:, :2] = prior
    target = np.concatenate([y / made.SD, prior @ [1.0, 2.0]])
    for k, name in ((2, "bump.height"), (3, "wave.size"), (4, "kink.slope")):
        used = whole[:, [0, 1, k]]
        covariance = np.linalg.inv(used.T @ used)
        value, sd = (covariance @ used.T @ target)[2], np.sqrt(covariance[2, 2])
        either = max(value, 0.0 if name == "wave.size" else abs(value))
        assert np.isclose(limits[name], either + 1.96 * sd, rtol=0.02)


def test_the_extended_model_has_what_was_fitted(named):
    assert named.extended == dict(named.params["value"])
    json.dumps(named.as_dict())
    assert "bump" in repr(named)
    assert "\n" not in repr(named)


def test_refused_data_teach_nothing(named):
    refused = made.refused(named)
    assert not len(refused.params)
    assert not len(refused.compare())
    assert not len(refused.conf_int())
    assert refused.extended == {}
    with pytest.raises(ScenarioError, match="no diagnosis"):
        refused.predict([0.5])
    with pytest.raises(ScenarioError, match="no diagnosis"):
        refused.candidate("none")
