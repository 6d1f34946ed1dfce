"""Data with a model of one's own: tables, what is refused, and what is named."""

import math

import numpy as np
import pandas as pd
import pytest

from stickslip import (
    Cause,
    Parameter,
    Prior,
    ScenarioError,
    Table,
    diagnose_model,
    free_law,
    instruments,
)
from stickslip.diagnosis.own_model import Values, overflows, pose_own
from toys import BEND, LEVEL, SLOPE, WAVE, data, line, problem

X = np.linspace(1.0, 3.0, 12)


# ---------------------------------------------------------------------------------------- tables
def test_rows_of_equal_settings_are_repeats():
    # Settings are equal to 1e-6 of themselves: what a spreadsheet rounds is the same condition.
    x = np.array([1.0, 2.0, 1.0 + 5e-7, 3.0, 1.0 + 1e-4])
    table = Table({"x": x}, [1.0, 5.0, 3.0, 7.0, 9.0], sd=0.2)
    assert table.condition.tolist() == [0, 1, 0, 2, 3]
    assert table.first.tolist() == [0, 1, 3, 4]
    assert table.mean.tolist() == [2.0, 5.0, 7.0, 9.0]
    # The mean of two readings has half the variance of one.
    assert table.errors.sd == pytest.approx([0.2 / math.sqrt(2.0), 0.2, 0.2, 0.2])


def test_zero_and_nearly_zero_are_one_setting():
    table = Table({"x": [0.0, 1e-13, 1.0, -1.0]}, [1.0, 2.0, 3.0, 4.0], sd=0.1)
    assert table.condition.tolist() == [0, 0, 1, 2]


def test_texts_tell_conditions_apart_and_have_no_place():
    settings = {"oil": ["thin", "thin", "thick", "thin"], "load": [1, 2, 1, 1]}
    table = Table(settings, [1.0, 2.0, 3.0, 4.0], sd=0.1)
    assert table.condition.tolist() == [0, 1, 2, 0]
    assert table.places.tolist() == [[1.0], [2.0], [1.0]]
    assert table["oil"].tolist() == settings["oil"]
    assert Table({"oil": ["a", "b"]}, [1.0, 2.0], sd=0.1).places is None


@pytest.mark.parametrize(
    "settings",
    [
        {"x": X, "k": np.arange(12)},
        pd.DataFrame({"x": X, "k": np.arange(12)}),
        np.column_stack([X, np.arange(12)]),
        [{"x": x, "k": k} for k, x in enumerate(X)],
    ],
    ids=["mapping", "DataFrame", "array", "rows"],
)
def test_settings_are_given_in_any_usual_way(settings):
    table = Table(settings, X, sd=0.1)
    assert table.condition.tolist() == list(range(12))
    assert table.places == pytest.approx(np.column_stack([X, np.arange(12)]))


def test_the_error_is_that_of_repeats_if_it_is_not_stated():
    random = np.random.default_rng(0)
    table = Table({"x": np.repeat(X, 10)}, np.repeat(X, 10) + 0.3 * random.standard_normal(120))
    # 108 degrees of freedom: 7 % of the error, of which the means have a third.
    assert table.errors.sd * math.sqrt(10.0) == pytest.approx(np.full(12, 0.3), rel=0.25)


def test_runs_are_an_order_and_are_held_out_whole():
    run = np.repeat(["a", "b", "c"], 4)
    table = Table({"x": X}, X, sd=0.1, run=run)
    assert table.run.tolist() == table.group.tolist() == [0] * 4 + [1] * 4 + [2] * 4
    assert table.order.tolist() == list(range(12))
    # Of two runs none can be predicted from the others.
    few = Table({"x": X}, X, sd=0.1, run=np.repeat([7, 3], 6))
    assert few.group.tolist() == list(range(12))
    # Repeats in a run have no place of their own in it.
    assert Table({"x": X // 1}, X, sd=0.1, run=np.zeros(12)).run is None


def test_readings_of_a_set_up_share_an_error():
    # Four set-ups, each 0.5 off in its own way; all measure the same three conditions twice.
    random = np.random.default_rng(2)
    block = np.repeat(np.arange(8), 6)
    x = np.tile([1.0, 2.0, 3.0], 16)
    y = 5.0 * x + 0.5 * random.standard_normal(8)[block] + 0.05 * random.standard_normal(48)
    alone, shared = Table({"x": x}, y), Table({"x": x}, y, block=block)
    assert alone.errors.covariance is None
    covariance = shared.errors.covariance
    assert covariance is not None
    # What all conditions share is nearly all of their error.
    correlation = covariance[0, 1] / math.sqrt(covariance[0, 0] * covariance[1, 1])
    assert correlation > 0.8


def test_a_number_is_refused_in_one_line(refused):
    row = np.ones(3)
    refused(lambda: Table({"x": row}, [1.0, math.nan, 2.0]), "table: y = .*finite numbers")
    refused(lambda: Table({"x": row}, [1.0, "b", 2.0], name="t"), "table t: y = .*finite numbers")
    refused(lambda: Table({"x": row}, np.ones((3, 1))), "y = .* one row")
    refused(lambda: Table({"x": []}, []), "y = .* one row")
    refused(lambda: Table({"x": row}, np.ones(4)), "settings: allowed are 4 rows")
    refused(lambda: Table({"x": [1.0, math.inf, 2.0]}, row), "settings: allowed are finite")
    refused(
        lambda: Table({"x": row}, row, sd=0.0), "sd = 0.0: allowed is a number above 0, or 3 of"
    )
    refused(
        lambda: Table({"x": row}, row, sd=[0.1, math.nan, 0.1]),
        "sd = .*: allowed is a number above 0",
    )
    refused(lambda: Table({"x": row}, row, sd=[0.1, 0.1]), "sd = .*: allowed is a number above 0")
    refused(lambda: Table({"x": row}, row, sd="small"), "sd = .*: allowed is a number above 0")
    refused(lambda: Table({"x": row}, row, block=[1, 2]), "block: allowed is one for each of 3")
    refused(lambda: Table({"x": row}, row, run=[[1], [2], [3]]), "run: allowed is one for each")


@pytest.fixture
def refused():
    """Refuse something in one line that says this."""

    def check(make, said):
        with pytest.raises(ScenarioError, match=said) as caught:
            make()
        assert "\n" not in str(caught.value)

    return check


# ------------------------------------------------------------------------------------- refusals
def flat(table, p):
    return p["slope"] * table["x"]


HEIGHT = Parameter("wave.height", size=0.5, low=-5.0, high=5.0)
LAW = free_law("pull", "gap", "m", 0.0, 1.0)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"predict": 3}, r"predict = 3: allowed is a function of \(table, p\)"),
        ({"predict": lambda p: p}, r"predict takes \(p\): allowed is a function of \(table, p\)"),
        (
            {"causes": [LAW]},
            r"predict takes \(table, p\): allowed is a function of \(table, p, curves\)",
        ),
        ({"predict": lambda t, p: flat(t, p)[0]}, r"shape \(12,\) for 1 .*here \(1, 12\)"),
        ({"predict": lambda t, p: flat(t, p).T}, r"shape \(12, 1\)"),
        ({"predict": lambda t, p: p["slope"]}, r"shape \(1, 1\)"),
        ({"predict": lambda t, p: "fast"}, r"shape \(\)"),
        ({"predict": lambda t, p: flat(t, p) * math.nan}, "it computes no reading"),
        (
            {"predict": lambda t, p: p["slop"]},
            'p: there is no parameter slop; did you mean "slope"',
        ),
        ({"data": X}, "data = .*: allowed is a Table or a Series, or a list of them"),
        ({"data": []}, r"data = \[\]: allowed is a Table"),
        ({"uncertain": SLOPE}, "uncertain = .*: allowed is a list of Parameter"),
        ({"uncertain": [SLOPE, 0.3]}, "uncertain = .*: allowed is a list of Parameter"),
        ({"uncertain": [HEIGHT]}, "uncertain: wave.height has no prior"),
        ({"uncertain": [SLOPE, SLOPE]}, "slope comes twice"),
        ({"causes": WAVE}, "causes = .*: allowed is a list of Cause"),
        ({"causes": [HEIGHT]}, "causes = .*: allowed is a list of Cause"),
        ({"causes": [WAVE, WAVE]}, "wave comes twice"),
        ({"causes": [WAVE, Cause("b", WAVE.parameters)]}, "parameters: wave.height comes twice"),
        ({"causes": [Cause("slope", HEIGHT)]}, "causes and uncertain: slope comes twice"),
        ({"causes": [Cause("a", frees="slop")]}, 'cause a: frees = slop: .*did you mean "slope"'),
        (
            {"causes": [instruments.scale(table="lines")]},
            'cause scale: there is no table lines; did you mean "line"',
        ),
        ({"seed": -1}, "seed = -1: allowed is a whole number from 0"),
        ({"seed": 1.5}, "seed = 1.5: allowed is a whole number from 0"),
    ],
)
def test_what_is_not_allowed_is_refused_in_one_line(changes, said, refused):
    given = {
        "predict": flat, "data": Table({"x": X}, X, sd=0.1, name="line"), "uncertain": [SLOPE],
        "causes": [WAVE], **changes,
    }  # fmt: skip
    refused(lambda: diagnose_model(**given), said)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Parameter("a"), "parameter a: allowed is one of prior and size"),
        (lambda: Parameter("a", Prior("normal", 0.0, 1.0), size=1.0), "one of prior and size"),
        (lambda: Parameter("a", 0.1), "parameter a: prior = 0.1: allowed is a Prior"),
        (lambda: Parameter(5, Prior("normal", 2.0, 0.2)), "name of a parameter = 5: .* a text"),
        (lambda: Parameter("", size=1.0, low=-1.0, high=1.0), "name of a parameter"),
        (lambda: Parameter("a", size=0.0, low=-1.0, high=1.0), "size = 0.0: allowed is a number"),
        (lambda: Parameter("a", size=True, low=-1.0, high=1.0), "size = .*: allowed is a number"),
        (lambda: Parameter("a", size="b", low=-1.0, high=1.0), "size = .*: allowed is a number"),
        (lambda: Parameter("a", size=1.0, low=1.0, high=-1.0), "allowed is low < high"),
        (lambda: Parameter("a", size=1.0), "allowed are a finite low and high for an amplitude"),
        (lambda: Parameter("a", size=1.0, low=1.0, high=2.0), "absent = 0.0: allowed is 1.0 to 2"),
        (lambda: Parameter("a", size=1.0, low=0.0, high=2.0, fineness=0.0), "fineness = 0.0"),
        (lambda: Parameter("a", size=1.0, low=0.0, high=2.0, fineness=1.5), "fineness = 1.5"),
        (lambda: Cause("none", HEIGHT), 'a text other than "none"'),
        (lambda: Cause("", HEIGHT), "name of a cause"),
        (lambda: Cause("a"), "cause a has no Parameter"),
        (lambda: Cause("a", [0.3]), "cause a: parameters: allowed are Parameters"),
    ],
)
def test_terms_that_make_no_sense_are_refused(make, said, refused):
    refused(make, said)


def test_a_parameter_that_is_not_there_has_a_hint(refused):
    refused(lambda: Values({"slope": np.ones((1, 1))})["sloop"], 'sloop; did you mean "slope"')


# ---------------------------------------------------------------------------------- several tables
def test_tables_have_their_own_rows_and_instruments():
    # The second table alone is read 20 % too large.
    def two(table, p):
        return p["slope"] * table["x"] + (1.0 if table.name == "high" else 0.0)

    random = np.random.default_rng(4)
    low = Table({"x": X}, 1.02 * X + 0.02 * random.standard_normal(12), sd=0.02, name="low")
    wrong = 1.2 * (1.02 * X + 1.0) + 0.02 * random.standard_normal(12)
    high = Table({"x": X}, wrong, sd=0.02, name="high")
    meters = [instruments.scale(table=name, name=f"scale of {name}") for name in ("low", "high")]
    result = diagnose_model(two, [low, high], [SLOPE], meters)
    assert (result.verdict.kind, result.verdict.causes) == ("named", ("scale of high",))
    size = result.params.loc["scale of high.error"]
    assert abs(size["value"] - 0.2) < 4.0 * size["sd"] < 0.05
    made = result.best.prediction
    assert made["table"].tolist() == ["low"] * 12 + ["high"] * 12
    assert np.abs(made["reading"] - made["predicted"]).max() < 0.1


def test_two_tables_without_names_of_their_own_are_refused(refused):
    pair = [Table({"x": X}, X, sd=0.1), Table({"x": X}, X, sd=0.1)]
    refused(lambda: pose_own(flat, pair, [SLOPE], []), "tables: no name comes twice")


def test_repeats_and_single_readings_give_one_row_a_condition():
    x = np.array([1.0, 2.0, 1.0, 3.0])
    posed = pose_own(flat, Table({"x": x}, [1.0, 2.0, 3.0, 4.0], sd=0.1), [SLOPE], [])
    assert posed.y.tolist() == [2.0, 2.0, 4.0]
    # The model is asked for all rows, and answers for the conditions.
    assert posed.model(np.array([[2.0]])).tolist() == [[2.0, 4.0, 6.0]]


# -------------------------------------------------------------------------------------- verdicts
@pytest.fixture(scope="module")
def named():
    wave = 0.6 * np.sin(5.0 * np.linspace(1.0, 3.0, 30))
    return diagnose_model(line, data(wave), [SLOPE, LEVEL], [WAVE, BEND])


def test_a_constant_that_is_stated_far_off_is_named():
    # 1.05 is 55 standard deviations from what is stated.
    slope = Parameter("slope", Prior("normal", 0.5, 0.01))
    result = diagnose_model(line, data(), [slope, LEVEL], [WAVE])
    assert (result.verdict.kind, result.verdict.causes) == ("named", ("slope",))
    found = result.params.loc["slope"]
    assert abs(found["value"] - 1.05) < 4.0 * found["sd"]
    assert 45.0 < found["pull"] < 65.0


def test_a_constant_that_is_no_suspect_is_not_named():
    slope = Parameter("slope", Prior("normal", 0.5, 0.01), suspect=False)
    posed = pose_own(line, data(), [slope, Parameter("level", LEVEL.prior)], [])
    assert [each.name for each in posed.causes] == ["level"]


def test_a_cause_that_overflows_is_noted_by_its_name():
    burst = Cause("burst", Parameter("burst.rate", size=400.0, low=0.0, high=1000.0))

    def growing(table, p):
        with np.errstate(over="ignore"):
            return p["slope"] * table["x"] + np.expm1(p.get("burst.rate", 0.0) * table["x"])

    posed = pose_own(growing, data(), [SLOPE], [burst, *problem(data()).causes[:1]])
    (note,) = overflows(posed)
    assert (note.code, note.text.count("\n")) == ("predictions-overflow", 0)
    assert "burst makes 30 of 30 predictions" in note.text
    # exp(400 x) passes 1e100 where x > 0.58: everywhere.
    assert note.value == 30.0


def test_candidates_are_there_by_name(named, refused):
    assert (named.verdict.kind, named.verdict.causes) == ("named", ("wave",))
    assert named.candidate("wave").name == "wave"
    assert named.candidate("none").params.index.tolist() == ["slope", "level"]
    assert named.candidate(" wave ").share == pytest.approx(named.verdict.share)
    assert named.candidate("wave").left["form"] == "none"
    assert named.candidate("none").gain is None
    for each in named.compare().index:
        assert named.candidate(each).name == each
    refused(
        lambda: named.candidate("wav"), 'no such model was fitted; compare.*did you mean "wave"'
    )
    refused(lambda: named.candidate(""" a "\n" """), "no such model was fitted")


@pytest.mark.parametrize("extra", [0.0, 2.0], ids=["none", "unexplained"])
def test_candidates_are_there_after_other_verdicts(extra):
    jumps = extra * np.random.default_rng(3).standard_normal(30)
    result = diagnose_model(line, data(jumps), [SLOPE, LEVEL], [WAVE])
    assert result.verdict.kind == ("unexplained" if extra else "none")
    assert result.candidate("none").name == "none"
    assert np.isfinite(result.candidate("wave").params["value"]).all()
    assert result.best.name == "none"


def test_data_that_cannot_be_judged_have_no_candidates(refused):
    result = diagnose_model(flat, Table({"x": X[:3]}, X[:3], sd=0.1), [SLOPE], [WAVE])
    assert result.verdict.kind == "data-problem"
    (reason,) = result.verdict.reasons
    assert reason.code == "too-few-conditions"
    assert len(result.params) == len(result.conf_int()) == len(result.compare()) == 0
    assert len(result.covariance) == 0
    refused(lambda: result.candidate("wave"), "candidate: the data allow no diagnosis")
    refused(lambda: result.predict({"x": X}), "predict: the data allow no diagnosis")


def test_parameters_are_those_of_the_linear_answer(named):
    # Of a linear model with normal priors; the amplitude's sinh is what is left of the difference.
    x = np.linspace(1.0, 3.0, 30)
    design = np.column_stack([x, np.ones(30), np.sin(5.0 * x)])
    precision = design.T @ design / 0.1**2 + np.diag([1 / 0.1**2, 1 / 0.5**2, 0.0])
    y = named.problem.y
    wanted = np.linalg.solve(precision, design.T @ y / 0.1**2 + np.array([1.0 / 0.1**2, 0.0, 0.0]))
    sd = np.sqrt(np.diag(np.linalg.inv(precision)))
    made = named.params
    assert made.index.tolist() == ["slope", "level", "wave.height"]
    assert np.all(np.abs(made["value"] - wanted) < 0.15 * sd)
    assert made["sd"].to_numpy() == pytest.approx(sd, rel=0.05)
    level = named.conf_int(0.68)
    assert (level["high"] - level["low"]).to_numpy() == pytest.approx(1.99 * sd, rel=0.05)
    covariance = named.covariance
    assert np.sqrt(np.diag(covariance)) == pytest.approx(made["sd"].to_numpy())
    assert list(named.extended) == made.index.tolist()


def test_a_level_is_a_probability(named, refused):
    for level in (0.0, 1.0, -0.5, math.nan, "high"):
        refused(lambda level=level: named.conf_int(level), "level = .*: allowed is a number above")


def test_predictions_at_new_conditions_have_the_error_of_the_fit(named):
    new = {"x": np.array([1.3, 4.0])}
    table = named.predict(new)
    truth = 1.05 * new["x"] + 0.2 + 0.6 * np.sin(5.0 * new["x"])
    assert np.all(np.abs(table["extended"] - truth) < 4.0 * table["extended_sd"])
    # Beyond the data more is left open.
    assert table["extended_sd"][1] > 2.0 * table["extended_sd"][0]
    assert set(table) == {"recalibrated", "recalibrated_sd", "extended", "extended_sd"}


def test_what_would_tell_two_models_apart_is_a_table(named, refused):
    table = named.separate({"x": np.array([1.26, 2.83])})
    assert set(table["first"]) == {"wave"}
    assert np.all(table["separation"] > 0.0)
    refused(lambda: named.propose_experiments(), "model of one's own.*separate")


def test_an_amplitude_below_zero_alone_is_named_like_one_above():
    """The mirror image of the same data, with the range on the other side."""
    found = []
    for sign in (1.0, -1.0):
        ends = sorted([0.0, 5.0 * sign])
        wave = Cause("wave", Parameter("height", low=ends[0], high=ends[1], size=0.5))
        x = np.linspace(1.0, 3.0, 24)
        table = Table({"x": x}, x + 0.8 * sign * np.sin(5 * x), sd=0.1)
        result = diagnose_model(
            lambda t, p: p["slope"] * t["x"] + p["height"] * np.sin(5 * t["x"]),
            table, [Parameter("slope", Prior("normal", 1.0, 0.1))], [wave],
        )  # fmt: skip
        assert result.verdict.causes == ("wave",)
        found.append(result.chance.fits[0].log_evidence)
    assert found[0] == pytest.approx(found[1], abs=1e-6)


def test_new_conditions_are_read_by_the_instrument_that_was_found():
    x = np.linspace(1.0, 3.0, 24)
    result = diagnose_model(
        lambda t, p: p["slope"] * t["x"],
        Table({"x": x}, 1.3 * x, sd=0.01),
        [Parameter("slope", Prior("normal", 1.0, 0.01), suspect=False)],
        [instruments.scale(0.1)],
    )
    assert result.verdict.causes == ("scale",)
    for settings in ({"x": [4.0]}, [{"x": 4.0}], pd.DataFrame({"x": [4.0]})):
        assert result.predict(settings)["extended"][0] == pytest.approx(1.3 * 4.0, rel=0.01)


def test_a_row_that_is_never_computed_is_refused_by_its_number():
    x = np.arange(12.0)
    table = Table({"x": x}, x, sd=0.1, name="line")
    with pytest.raises(ScenarioError, match="row 7 of table line: it computes no reading"):
        diagnose_model(lambda t, p: np.where(x == 7, np.nan, p["slope"] * x), table, [SLOPE])


def test_a_model_may_take_the_curves_though_no_cause_is_a_law():
    for model in (lambda t, p, curves: line(t, p), lambda t, p, curves=None: line(t, p)):
        result = diagnose_model(model, data(), [SLOPE, LEVEL], [])
        assert result.verdict.kind in ("none", "unexplained", "ambiguous", "named", "dominant")
        assert result.predict({"x": [1.0]})["recalibrated"].notna().all()
