"""Verdicts on models of which the answer is known."""

import numpy as np
import pytest

from stickslip import Prior
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.decision.posterior import posterior
from stickslip.diagnosis.steps import run
from stickslip.diagnosis.terms.parameter import Parameter
from toys import BEND, LEVEL, STEP, TWIN, WAVE, data, problem, shapes

X = np.linspace(1.0, 3.0, 30)
ALONE = (WAVE, STEP, BEND)


def extra(**sizes):
    """What causes of these sizes add to the line."""
    return sum(size * shapes(X)[f"{name.replace('_', '.')}"] for name, size in sizes.items())


def found(table, causes=ALONE, seed=0):
    return run(problem(table, causes), seed)


def test_nothing_hidden_is_none():
    result = found(data())
    assert result.verdict.kind == "none"
    assert result.verdict.probabilities["none"] > 0.5
    assert sum(posterior(result.models).models.values()) == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("name", "sizes"),
    [("wave", {"wave_height": 0.4}), ("step", {"step_height": 0.5}), ("bend", {"bend_size": 0.9})],
)
def test_one_cause_is_named_with_its_size(name, sizes, seed):
    result = found(data(extra(**sizes), seed=seed), seed=seed)
    assert (result.verdict.kind, result.verdict.causes) == ("named", (name,))
    fit = result.verdict.fit
    (column,) = result.problem.columns(fit.causes)
    value = float(result.problem.physical(fit.x[None, :])[0, column])
    sd = np.sqrt(fit.covariance[-1, -1])
    near = [float(result.problem.parameters[column].value(fit.x[column] + s * sd))
            for s in (-3.0, 3.0)]  # fmt: skip
    assert near[0] < next(iter(sizes.values())) < near[1]
    assert value == pytest.approx(next(iter(sizes.values())), rel=0.3)
    assert result.verdict.gain.certain


def test_twins_are_a_set():
    result = found(data(extra(wave_height=0.35)), (WAVE, TWIN, BEND))
    assert result.verdict.kind == "ambiguous"
    assert set(result.verdict.causes) >= {"wave", "twin"}


def test_two_causes_are_a_pair():
    result = found(data(extra(wave_height=0.6, step_height=0.8), n=30))
    assert (result.verdict.kind, result.verdict.causes) == ("pair", ("step", "wave"))


def test_a_large_cause_beside_a_model_error_is_dominant():
    error = 0.12 * np.random.default_rng(5).standard_normal(30)
    result = found(data(extra(wave_height=1.5) + error, sd=0.03))
    assert (result.verdict.kind, result.verdict.causes) == ("dominant", ("wave",))
    assert result.verdict.share > 0.95
    assert 2.5 < result.verdict.fit.sizes["kappa"] < 6.5  # truth 4.1


def test_a_cause_that_takes_half_is_not_claimed():
    error = 0.5 * np.sin(9.0 * X + 1.0) + 0.2 * np.random.default_rng(1).standard_normal(30)
    result = found(data(extra(step_height=0.9) + error, sd=0.03))
    assert result.verdict.kind in ("unexplained", "ambiguous")
    assert result.verdict.leader is not None


def test_errors_stated_too_large_are_said():
    table = data(extra(wave_height=0.4), sd=0.1)
    wide = Table({"x": X}, table.y, sd=0.5, name="line")
    result = found(wide)
    assert result.verdict.causes == ("wave",)
    assert any(each.code == "errors-too-large" for each in result.verdict.reasons)


def test_shuffled_readings_have_no_name():
    table = data(extra(wave_height=0.6))
    order = np.random.default_rng(3).permutation(30)
    mixed = Table({"x": X}, table.y[order], sd=0.1)
    assert found(mixed).verdict.kind not in ("named", "pair")


@pytest.mark.parametrize("stated", [0.75, 0.5])
def test_a_constant_that_is_stated_far_off_leads(stated):
    # 30 and 55 standard deviations off.
    slope = Parameter("slope", Prior("normal", stated, 0.01))
    result = run(problem(data(), ALONE, (slope, LEVEL)), 0)
    assert result.verdict.leader.name == "slope"
    assert "slope" in result.verdict.causes
    value = stated + 0.01 * float(result.verdict.leader.x[0])
    assert value == pytest.approx(1.05, abs=0.1)
