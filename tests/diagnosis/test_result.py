"""A diagnosis of a toy model whose truth is known, as a person gets it."""

import json

import numpy as np
import pandas as pd
import pytest

import made_findings as made
from stickslip import Parameter, Prior, Series, Table, diagnose_model
from stickslip.diagnosis.fitting.rivals import Rivals
from stickslip.diagnosis.terms.words import Vocabulary, Words
from toys import LEVEL, SLOPE, WAVE, data, line


def columns(x, count):
    """Derivatives of the readings by each parameter of the linear model, shape (len(x), count)."""
    return np.stack([made.predict(x, row[None])[0] for row in np.eye(5)[:count]], axis=1)


def test_parameters_and_errors_are_those_of_linear_least_squares(named, none):
    table = named.params
    assert list(table.index) == ["level", "slope", "bump.height"]
    assert np.all(np.abs(table["value"] - np.array(made.TRUTH[:3])) < 3.0 * table["sd"])
    assert np.allclose(np.diag(named.covariance), table["sd"] ** 2)
    # The prior of the bump is wide beside what the data tell; those of the constants count.
    design = columns(named.problem.tables[0]["x"], 3) / made.SD
    precision = design.T @ design + np.diag([0.3**-2, 0.3**-2, 0.0])
    sd = np.sqrt(np.diag(np.linalg.inv(precision)))
    assert np.allclose(table["sd"], sd, rtol=0.03)
    interval = named.conf_int(0.6827)
    half = (interval["high"] - interval["low"]).to_numpy() / 2.0
    assert np.allclose(half, sd, rtol=0.03)
    # Intervals end at the limits of their parameter.
    ends = none.candidate("wave").interval(0.95).loc["wave.size"]
    assert ends["low"] == 0.0 < ends["high"]
    assert named.extended == dict(table["value"])
    json.dumps(named.as_dict())
    assert "bump" in repr(named)
    assert "\n" not in repr(named)


def test_every_model_that_was_fitted_is_a_candidate(named, none, rough):
    for result in (named, none, rough):
        table = result.compare()
        assert np.isclose(table["probability"].sum(), 1.0)
        chances = table["probability"].to_numpy()
        assert np.all(np.diff(chances) <= 1e-8 * chances[:-1])  # but for what rounding decides
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
    assert named.candidate("bump").share > 0.99
    assert named.candidate("none").share == 0.0


def test_a_discrepancy_widens_the_errors_by_what_is_left(rough):
    best, models = rough.best, rough.findings.models
    assert rough.verdict.kind == "dominant"
    plain, null, n = models.get(best.fit.names), models.null, len(models.problem.y)
    left, whole = (fit.chi2 - (n - len(fit.free)) for fit in (plain, null))
    taken = whole - left
    assert best.share == pytest.approx(taken / whole)
    assert np.isclose(best.widening, np.sqrt(1.0 + left / taken))
    narrow = np.sqrt(best.fit.covariance[0, 0]) * 0.3  # of the level, by its prior
    assert np.isclose(best.params.loc["level", "sd"], narrow * best.widening)
    bump = best.params.loc["bump.height"]
    assert abs(bump["value"] - made.BUMP) < 3.0 * bump["sd"]
    assert set(best.left) >= {"form", "kappa", "size"}
    assert 0.03 < best.left["size"]["volts"] < 0.4  # the error's size is 0.12


def test_predictions_follow_the_fitted_values(named):
    at = np.array([0.1, 0.5, 0.9])
    table, design = named.predict(at), columns(at, 3)
    assert np.allclose(table["extended"], design @ named.params["value"])
    sd = np.sqrt(np.diag(design @ named.covariance.to_numpy() @ design.T))
    assert np.allclose(table["extended_sd"], sd, rtol=0.02)


def test_models_are_separated_where_they_differ(rough, none):
    table = rough.separate(np.linspace(0.0, 1.0, 21))
    assert set(table["first"]) | set(table["second"]) >= {"bump", "none"}
    assert table["separation"].is_monotonic_decreasing
    shown = table["separation"].where(table["second"] == "none")
    assert abs(0.05 * shown.idxmax() - 0.5) < 0.2
    # What is far behind the first rival is told apart from the claim in any case.
    chance = rough.chance.models
    rivals = [chance[name] for name in table.columns if name in chance and name != "bump"]
    assert rivals
    assert min(rivals) >= 1e-3 * max(rivals)
    assert none.separate([0.5]) is None
    at = {"x": [0.2, 0.5]}
    for given in (at, pd.DataFrame(at), Table(at, np.zeros(2)), Series([0.2, 0.5], [0.0, 0.0], at)):
        assert Rivals().conditions(given)[1]["x"] == [0.2, 0.5]
    # Of a set each member, also one that is last and hardly probable.
    members = rough.chance.fits
    assert len(members) > 4
    assert chance[members[-1].name] < 1e-3 * chance[members[1].name]
    whole = made.said(rough, "ambiguous", members=members).separate([0.2, 0.5])
    assert {*whole.columns} >= {fit.name for fit in members}
    assert np.all(whole["least"] < whole["separation"])


def test_upper_limits_are_those_of_linear_least_squares(none):
    found = none.findings
    limits = none.cannot_tell.limits
    x, y = found.problem.tables[0]["x"], found.problem.y
    prior = np.eye(2, 5) / 0.3
    whole = np.vstack([columns(x, 5) / made.SD, prior])
    target = np.concatenate([y / made.SD, np.array([1.0, 2.0]) / 0.3])
    for k, name in ((2, "bump.height"), (3, "wave.size"), (4, "kink.slope")):
        used = whole[:, [0, 1, k]]
        covariance = np.linalg.inv(used.T @ used)
        value, sd = (covariance @ used.T @ target)[2], np.sqrt(covariance[2, 2])
        either = max(value, 0.0 if name == "wave.size" else abs(value))
        assert np.isclose(limits[name].value, either + 1.96 * sd, rtol=0.02)


@pytest.mark.parametrize("extra", [0.0, 2.0], ids=["none", "unexplained"])
def test_candidates_are_there_after_verdicts_that_claim_none(extra):
    jumps = extra * np.random.default_rng(3).standard_normal(30)
    result = diagnose_model(line, data(jumps), [SLOPE, LEVEL], [WAVE])
    assert result.verdict.kind == ("unexplained" if extra else "none")
    assert result.best.name == "none"
    assert np.isfinite(result.candidate("wave").params["value"]).all()


def test_the_number_of_constants_is_told_where_they_are_too_many():
    idle = [Parameter(f"idle {k}", Prior("normal", 0.0, 1.0)) for k in range(3)]
    refused = diagnose_model(line, data(n=5), [SLOPE, LEVEL, *idle], [WAVE])
    (reason,) = refused.verdict.reasons
    assert reason.text.startswith("5 conditions cannot tell 5 uncertain constants")
    assert Words(Vocabulary()).data_problem(reason)[1] == "5 uncertain constants."


def test_data_that_cannot_be_judged_teach_nothing():
    refused = diagnose_model(line, data(n=3), [SLOPE, LEVEL], [WAVE])
    assert refused.verdict.kind == "data-problem"
    assert [reason.code for reason in refused.verdict.reasons] == ["too-few-conditions"]
    for table in (refused.params, refused.compare(), refused.conf_int(), refused.covariance):
        assert len(table) == 0
    assert refused.extended == {}
