"""Verdicts on models of which the answer is known."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import Cause, Prior, Series, diagnose_model
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.decision.gain import Gain
from stickslip.diagnosis.decision.misfit_test import GOF_LEVEL, goodness_of_fit
from stickslip.diagnosis.decision.posterior import Posterior, posterior
from stickslip.diagnosis.decision.verdict import _takes_little
from stickslip.diagnosis.fitting.scatter import with_scatter
from stickslip.diagnosis.pipeline import run
from stickslip.diagnosis.terms.parameter import Parameter
from toys import BEND, LEVEL, SLOPE, STEP, TWIN, WAVE, data, problem, shapes

X = np.linspace(1.0, 3.0, 30)
ALONE = (WAVE, STEP, BEND)


def extra(**sizes):
    """Sum of the effects of causes of these sizes, to be added to the line."""
    added = {name.partition(".")[0]: shape for name, shape in shapes(X).items()}
    return sum(size * added[name] for name, size in sizes.items())


def found(table, causes=ALONE, seed=0):
    return run(problem(table, causes), seed)


def test_nothing_hidden_is_none():
    result = found(data())
    assert result.verdict.kind == "none"
    assert result.verdict.probabilities["none"] > 0.5
    assert sum(posterior(result.models).models.values()) == pytest.approx(1.0)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("name", "size"), [("wave", 0.4), ("step", 0.5), ("bend", 0.9)])
@pytest.mark.daily("0")
def test_one_cause_is_named_with_its_size(name, size, seed):
    result = found(data(extra(**{name: size}), seed=seed), seed=seed)
    assert (result.verdict.kind, result.verdict.causes) == ("named", (name,))
    fit = result.verdict.fit
    (column,) = result.problem.columns(fit.causes)
    sd = np.sqrt(fit.covariance[-1, -1])
    value = result.problem.parameters[column].value
    low, middle, high = (float(value(fit.x[column] + s * sd)) for s in (-3.0, 0.0, 3.0))
    assert low < size < high
    assert middle == pytest.approx(size, rel=0.3)
    assert result.verdict.gain.certain


@pytest.mark.nightly
def test_a_large_cause_beside_a_model_error_is_dominant():
    error = 0.12 * np.random.default_rng(5).standard_normal(30)
    result = found(data(extra(wave=1.5) + error, sd=0.03))
    assert (result.verdict.kind, result.verdict.causes) == ("dominant", ("wave",))
    assert result.verdict.share > 0.95
    assert 2.5 < result.verdict.fit.sizes["kappa"] < 6.5  # truth 4.1


def test_a_cause_that_takes_half_is_not_claimed():
    error = 0.5 * np.sin(9.0 * X + 1.0) + 0.2 * np.random.default_rng(1).standard_normal(30)
    result = found(data(extra(step=0.9) + error, sd=0.03))
    assert result.verdict.kind in ("unexplained", "ambiguous")
    assert result.verdict.leader is not None


def test_errors_stated_too_large_are_said():
    table = data(extra(wave=0.4), sd=0.1)
    verdict = found(Table({"x": X}, table.y, sd=0.5, name="line")).verdict
    assert verdict.causes == ("wave",)
    assert any(each.code == "errors-too-large" for each in verdict.reasons)


def test_twins_are_a_set_and_two_causes_a_pair():
    result = found(data(extra(wave=0.4)), (WAVE, TWIN, BEND))
    assert result.verdict.kind == "ambiguous"
    assert set(result.verdict.causes) >= {"wave", "twin"}
    pair = found(data(extra(wave=0.6, step=0.8))).verdict
    assert (pair.kind, pair.causes) == ("pair", ("step", "wave"))


def test_three_causes_are_said_where_two_leave_a_misfit():
    result = found(data(extra(wave=0.6, step=0.9, bend=1.4)))
    assert (result.verdict.kind, result.verdict.causes) == ("pair", ("bend", "step", "wave"))
    # A third is not tried where two explain the data.
    assert max(len(names) for names, _ in result.models.best) == 3
    pair = found(data(extra(wave=0.6, step=0.8)))
    assert max(len(names) for names, _ in pair.models.best) == 2


def test_shuffled_readings_have_no_name():
    table = data(extra(wave=0.6))
    order = np.random.default_rng(3).permutation(30)
    assert found(Table({"x": X}, table.y[order], sd=0.1)).verdict.kind not in ("named", "pair")


@pytest.mark.parametrize(("chance", "sure", "members"), [(0.949, [], 2), (0.951, ["wave"], 1)])
def test_what_is_sure_and_what_a_set_holds_has_19_of_20(chance, sure, members):
    left = {"none": 0.6 * (1.0 - chance), "bend": 0.4 * (1.0 - chance)}
    fits = run(problem(data(extra(wave=0.4)), ALONE), 0).models.leaders()
    one = {name: next(fit for fit in fits if fit.name == name) for name in ("wave", *left)}
    found = Posterior(tuple(one.values()), {"wave": chance, **left}, {"wave": chance})
    assert found.sure == sure
    assert [fit.name for fit in found.smallest_set()] == [*one][:members]


@pytest.mark.parametrize(
    ("share", "interval", "against"),
    [
        (0.69, (0.1, 2.0), ["small-share"]),
        (0.71, (0.1, 2.0), []),
        (0.89, (-0.1, 2.0), ["uncertain-gain"]),
        (0.89, None, ["uncertain-gain"]),
        (0.91, (-0.1, 2.0), []),
        (0.91, None, []),
        (0.91, (-2.0, -0.1), ["uncertain-gain"]),
    ],
)
def test_causes_that_take_nearly_all_only_must_not_predict_worse(share, interval, against):
    (leader,) = found(data(extra(wave=0.4))).models.leaders(1)
    gain = interval and Gain(2.0, 1.0, interval)
    assert [note.code for note in _takes_little(leader, share, gain)] == against


@pytest.mark.nightly
def test_a_set_asks_what_a_claim_asks():
    """Two near twins beside scatter of an eighth of their size, and of three quarters."""
    x = np.linspace(0.0, 1.0, 60)
    scatter = np.random.default_rng(6).standard_normal(60)
    kinds = {}
    for size in (0.05, 0.3):
        amplitude = {"low": -20.0, "high": 20.0, "size": 0.3}
        twins = [Cause(name, Parameter(name, **amplitude)) for name in ("sine", "hump")]
        result = diagnose_model(
            lambda t, p: (
                p["level"]
                + p["sine"] * np.sin(np.pi * t["x"])
                + p["hump"] * 4.0 * t["x"] * (1.0 - t["x"])
            ),
            Table({"x": x}, 1.0 + 0.4 * np.sin(np.pi * x) + size * scatter, sd=0.01),
            [Parameter("level", Prior("normal", 1.0, 0.01))],
            twins,
        )
        kinds[size] = result.verdict.kind
        assert set(result.verdict.probabilities) >= {"sine", "hump"}
    assert kinds == {0.05: "ambiguous", 0.3: "unexplained"}


def ends(table, p):
    x = table["x"]
    first, last = x < 1.05, x > 2.95
    return p["slope"] * x + p["level"] + p["first.size"] * first + p["last.size"] * last


ENDS = 1.0 * (X < 1.05) - 1.0 * (X > 2.95)
AT_ENDS = [Cause(name, Parameter(f"{name}.size", size=0.5, low=-5.0, high=5.0))
           for name in ("first", "last")]  # fmt: skip


@pytest.mark.parametrize("size", [0.5, 0.55], ids=["one is sure", "both are sure"])
@pytest.mark.daily("both are sure")
def test_two_causes_that_nothing_held_out_proves_are_left_open(size):
    """Each moves one reading by five errors or more, so that no other part tells its size."""
    result = diagnose_model(ends, data(size * ENDS), [SLOPE, LEVEL], AT_ENDS)
    verdict = result.verdict
    sure = [name for name in ("first", "last") if verdict.probabilities[name] > 0.95]
    assert sure == (["first"] if size == 0.5 else ["first", "last"])
    models = result.findings.models
    assert posterior(models).among_small(models.get(["first"])) < 0.95
    assert (verdict.kind, set(verdict.causes)) == ("ambiguous", {"first", "last"})
    assert verdict.members[0].name == "first + last"
    told = result.as_dict()
    assert told["unproven"]
    assert ("alone" in told["headline"]) == (len(told["members"]) == 3)


@pytest.mark.parametrize(
    ("after", "low", "kind"),
    [(0.89, 0.01, "pair"), (0.91, 0.01, "ambiguous"), (0.89, -0.01, "ambiguous")],
)
def test_a_further_cause_lowers_the_held_out_error_by_a_tenth(monkeypatch, after, low, kind):
    gain = Gain(1.0, after, (low, 0.2))
    monkeypatch.setattr("stickslip.diagnosis.decision.verdict.measured", lambda *_: gain)
    result = diagnose_model(ends, data(0.55 * ENDS), [SLOPE, LEVEL], AT_ENDS)
    assert (result.verdict.kind, set(result.verdict.causes)) == (kind, {"first", "last"})


def test_sizes_are_known_as_well_as_the_likelier_form_of_the_errors_tells():
    random = np.random.default_rng(4)
    noise = [random.standard_normal()]
    for _ in range(119):
        noise.append(0.8 * noise[-1] + 0.6 * random.standard_normal())
    x = np.linspace(1.0, 3.0, 120)
    y = x + 0.5 * np.sin(5.0 * x) + 0.1 * np.array(noise)
    table = Table({"x": x}, y, sd=0.1, run=np.zeros(120, dtype=int))
    verdict = found(table).verdict
    assert (verdict.kind, verdict.causes) == ("named", ("wave",))
    assert verdict.fit.form == "ar1"


def test_a_constant_other_than_stated_is_named_by_the_test():
    # Five stated errors off: it follows the data within its prior too, so that nothing held out
    # tells the two apart.
    x = np.linspace(1.0, 3.0, 60)
    uncertain = [replace(SLOPE, cause=True), LEVEL]
    result = run(problem(data(0.5 * x, n=60), (WAVE, BEND), uncertain), 0)
    assert goodness_of_fit(result.problem, result.models.null) >= GOF_LEVEL
    assert not result.verdict.gain.certain
    assert (result.verdict.kind, result.verdict.causes) == ("named", ("slope",))


def test_causes_that_no_reading_tells_apart_are_in_the_order_of_their_names():
    idle = [Cause(name, Parameter(f"{name}.size", size=0.5, low=-3.0, high=3.0))
            for name in ("zeta", "alpha", "mu")]  # fmt: skip
    names = [*posterior(run(problem(data(), idle), 0).models).models]
    assert names == ["none", "alpha", "mu", "zeta"]


@pytest.mark.nightly
def test_errors_of_the_fit_of_all_causes_prove_no_name():
    # A wave that nobody lists counts as noise; the step beside it hardly lowers what is left.
    x = np.linspace(1.0, 3.0, 60)
    noise = 0.05 * np.random.default_rng(1).standard_normal(60)
    y = 1.05 * x + 0.2 + 0.9 * (x > 2.0) + 0.5 * np.sin(4.0 * x + 1.0) + noise
    table = Table({"x": x, "z": np.random.default_rng(9).permutation(60) / 60}, y)
    result = run(with_scatter(problem(table, (STEP, BEND, WAVE)), 0), 0)
    assert [each.of_fit for each in result.problem.errors] == [True]
    assert result.verdict.kind == "unexplained"


@pytest.mark.parametrize("sd", [0.002, 0.0005])
@pytest.mark.daily("0.002")
def test_a_model_that_computes_nothing_explains_nothing(sd):
    """Readings so precise that every model misses them by more errors than a lost row counts."""
    t = np.linspace(0.0, 10.0, 200)
    noise = 0.01 * np.random.default_rng(1).standard_normal(200)
    y = 1.0 + 0.2 * t + 5.0 * np.sin(1.3 * t) + 2.0 * np.sin(3.1 * t + 1.0) + noise

    def predict(table, p):
        made = p["level"] + p["ramp"] * table["t"] / 10.0 + p["bend"] * (table["t"] - 5.0) ** 2
        return np.where(p["ramp"] > 0.5, np.nan, made)

    causes = [Cause(name, Parameter(name, size=size, low=0.0, high=20.0))
              for name, size in (("ramp", 0.3), ("bend", 0.01))]  # fmt: skip
    level = Parameter("level", Prior("normal", 1.0, 0.1))
    verdict = diagnose_model(predict, Series(t, y, sd=sd), [level], causes).verdict
    assert verdict.kind == "unexplained"
    assert np.all(np.abs(verdict.leader.residual) < 100.0)
