"""Data with a model of one's own: tables, and what is named."""

import math
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import roller_table
from documentation_blocks import EXAMPLES
from stickslip import (
    Cause,
    Parameter,
    Prior,
    ScenarioError,
    Series,
    Table,
    diagnose_model,
    events,
    instruments,
    models,
)
from stickslip.diagnosis.model import bare_problem, overflows, posed, without_effect
from toys import BEND, LEVEL, SLOPE, STEP, WAVE, data, line, problem

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


def test_texts_tell_conditions_apart():
    settings = {"oil": ["thin", "thin", "thick", "thin"], "load": [1, 2, 1, 1]}
    table = Table(settings, [1.0, 2.0, 3.0, 4.0], sd=0.1)
    assert table.condition.tolist() == [0, 1, 2, 0]
    assert table["oil"].tolist() == settings["oil"]


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
    # Four blocks, each 0.5 off in its own way; all measure the same three conditions twice.
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


def test_repeats_and_single_readings_give_one_row_a_condition():
    x = np.array([1.0, 2.0, 1.0, 3.0])
    readings = Table({"x": x}, [1.0, 2.0, 3.0, 4.0], sd=0.1)
    made = posed(readings, lambda table, p: p["slope"] * table["x"], [SLOPE], [])
    assert made.y.tolist() == [2.0, 2.0, 4.0]
    # The model is asked for all rows, and answers for the conditions.
    assert made.model(np.array([[2.0]])).tolist() == [[2.0, 4.0, 6.0]]


# -------------------------------------------------------------------------------------- verdicts


@pytest.mark.parametrize("stated", [0.75, 0.5])
@pytest.mark.daily("0.5")
def test_a_constant_that_is_stated_far_off_is_named(stated):
    # 1.05 is 30 and 55 standard deviations from what is stated.
    slope = Parameter("slope", Prior("normal", stated, 0.01))
    result = diagnose_model(line, data(), [slope, LEVEL], [WAVE, STEP, BEND])
    assert result.verdict.leader.name == "slope"
    assert "slope" in result.verdict.causes
    found = result.candidate("slope").params.loc["slope"]
    assert abs(found["value"] - 1.05) < 4.0 * found["sd"]
    assert found["pull"] == pytest.approx((1.05 - stated) / 0.01, abs=10.0)


def test_constants_of_which_data_tell_only_ratios_are_known_as_their_priors_tell():
    # Nothing changes where all are larger by the same factor; dry friction bends the predictions.
    def pushed(table, p):
        force = p["gain"] * 5.0 * np.sin(table["t"])
        return np.sign(force) * np.maximum(np.abs(force) - p["friction"], 0.0) / p["mass"]

    parts, t = {"mass": 0.05, "gain": 0.04, "friction": 0.2}, np.linspace(0.0, 40.0, 2000)
    constants = [Parameter(name, Prior("normal", 1.0, part)) for name, part in parts.items()]
    y = pushed({"t": t}, dict.fromkeys(parts, 1.0)) + 3e-3 * np.random.default_rng(3).normal(
        size=2000
    )
    found = diagnose_model(pushed, Table({"t": t}, y, sd=3e-3), constants, [])
    expected = 1.0 / math.sqrt(sum(1.0 / part**2 for part in parts.values()))
    assert found.params["sd"].tolist() == pytest.approx(3 * [expected], rel=1e-2)


def test_a_constant_that_is_no_cause_is_not_named():
    slope = Parameter("slope", Prior("normal", 0.5, 0.01), cause=False)
    made = posed(data(), line, [slope, Parameter("level", LEVEL.prior)], [])
    assert [each.name for each in made.causes] == ["level"]


def test_a_cause_that_overflows_is_noted_by_its_name():
    burst = Cause("burst", Parameter("burst.rate", size=400.0, low=0.0, high=1000.0))

    def growing(table, p):
        with np.errstate(over="ignore"):
            return p["slope"] * table["x"] + np.expm1(p.get("burst.rate", 0.0) * table["x"])

    made = posed(data(), growing, [SLOPE], [burst, *problem(data()).causes[:1]])
    (note,) = overflows(made)
    assert (note.code, note.text.count("\n")) == ("predictions-overflow", 0)
    assert "burst makes 30 of 30 predictions" in note.text
    # exp(400 x) passes 1e100 where x > 0.58: everywhere.
    assert note.value == 30.0


TIME = 1000.0 + np.arange(30.0)
HEIGHT = Parameter("bump.height", size=0.5, low=-5.0, high=5.0)
WIDTH = Parameter("bump.width", Prior("log-normal", 5.0, 2.0), cause=False)


@pytest.mark.parametrize(
    ("causes", "codes"),
    [
        ([Cause("bump", (HEIGHT, WIDTH))], {}),
        ([Cause("idle", Parameter("idle", size=0.5, low=0.0, high=5.0))], {"idle": "without"}),
        ([Cause("bump", (HEIGHT, Parameter("span", WIDTH.prior, cause=False)))],
         {"span": "without"}),
        ([instruments.clipping("-", 4.0, 1.0)], {}),
        ([instruments.clipping("-", 4000.0, 1.0, lowest=4.0)], {"clipping.limit": "without"}),
        ([events.step(0.5, 1000.0, 1029.0)], {}),
        ([events.step(0.5, 0.0, 29.0)], {"step": "event"}),
        ([events.pulse(0.5, 2000.0, 2029.0, 5.0)], {"pulse": "event"}),
    ],
)  # fmt: skip
def test_what_changes_no_prediction_is_noted(causes, codes):
    """A shape acts beside its amplitude only, and a limit at the lowest end of its range."""

    def model(record, p):
        width = p.get("bump.width", 5.0)
        bump = np.exp(-(((record.t - 1015.0) / width) ** 2))
        return p["level"] + p.get("bump.height", 0.0) * bump

    level = Parameter("level", Prior("normal", 3.0, 0.5))
    notes = without_effect(posed(Series(TIME, TIME - 997.0, sd=0.1), model, [level], causes))
    found = {each.text.split(" ")[0]: each.code.split("-")[0] for each in notes}
    assert found == codes


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
        [Parameter("slope", Prior("normal", 1.0, 0.01), cause=False)],
        [instruments.scale(0.1)],
    )
    assert result.verdict.causes == ("scale",)
    for settings in ({"x": [4.0]}, [{"x": 4.0}], pd.DataFrame({"x": [4.0]})):
        assert result.predict(settings)["extended"][0] == pytest.approx(1.3 * 4.0, rel=0.01)


def test_a_model_may_take_the_curves_though_no_cause_is_a_law():
    for model in (lambda t, p, curves: line(t, p), lambda t, p, curves=None: line(t, p)):
        result = diagnose_model(model, data(), [SLOPE, LEVEL], [])
        assert result.predict({"x": [1.0]})["recalibrated"].notna().all()


def test_the_case_of_rollers_has_their_medians():
    stored = (EXAMPLES / "cases" / "rollers" / "roller.csv").read_text()
    data = Path(__file__).parents[1] / "data" / "roller_velocity.csv"
    assert stored == roller_table.table(data)


GIVES_UP = {  # what a model does where its parameter is above 1, and what is said of it
    "nothing": (lambda y: None, "returned None"),
    "a part": (lambda y: y[:9], "returned shape "),
    "an error": (lambda y: y[99], "fails for table monday at slope = "),
}


@pytest.mark.parametrize("way", ["one vector", "all vectors", "of a command"])
@pytest.mark.parametrize(("answer", "said"), GIVES_UP.values(), ids=GIVES_UP)
def test_a_model_that_gives_up_somewhere_is_refused_with_what_it_was_asked(answer, said, way):
    def steep(table, p):
        y = p["slope"] * table.t
        if way == "all vectors":
            over = p["slope"][:, 0] > 1.0
            rows = [answer(row) if over[k] else row for k, row in enumerate(y)]
            return np.array(rows) if all(row is not None for row in rows) else None
        return answer(y) if p["slope"] > 1.0 else y

    slope = Parameter("slope", Prior("normal", 1.0, 0.1))
    model, known = steep if way == "all vectors" else models.vectorised(steep), [slope]
    if way == "of a command":
        model, known = models.own(model, known, [], reads={"level": "V"}), None
    t = np.linspace(0.0, 1.0, 20)
    with pytest.raises(ScenarioError) as refusal:
        diagnose_model(model, Series(t, 1.02 * t, sd=0.01, name="monday"), known)
    (line,) = str(refusal.value).splitlines()
    assert line.startswith(f"predict: steep {said}")
    assert 1.0 < float(re.search(r"table monday at slope = ([\d.]*\d)", line)[1]) < 2.0
    assert "NaN where it has no answer" in line


def _named(made, name, **changes):
    return made(**{"name": name, "sd": 0.1, "y": READINGS, **changes})


READINGS = np.sin(np.arange(12.0))
STEPS = np.arange(12.0)
COPIES = {
    "a record": (Series, {"t": STEPS}, {"t": STEPS}),
    "a record by another clock": (Series, {"t": STEPS}, {"t": 1.7e9 + STEPS}),
    "a record with an input": (Series, {"t": STEPS, "inputs": {"u": STEPS}},
                               {"t": STEPS, "inputs": {"u": STEPS}}),
    "a table": (Table, {"settings": {"x": STEPS}}, {"settings": {"x": STEPS}}),
    "a table in another order": (Table, {"settings": {"x": STEPS}},
                                 {"settings": {"x": STEPS[::-1]}, "y": READINGS[::-1]}),
    "a table in other digits": (Table, {"settings": {"x": STEPS}},
                                {"settings": {"x": STEPS}, "y": READINGS * (1.0 + 1e-12)}),
}  # fmt: skip
MORE = {
    "other noise": (Series, {"t": STEPS}, {"t": STEPS, "y": READINGS + 0.01 * READINGS**2}),
    "another input": (Series, {"t": STEPS, "inputs": {"u": STEPS}},
                      {"t": STEPS, "inputs": {"u": -STEPS}}),
    "at rest": (Series, {"t": STEPS, "y": 0.0 * STEPS}, {"t": STEPS, "y": 0.0 * STEPS}),
    "other settings": (Table, {"settings": {"x": STEPS}}, {"settings": {"x": STEPS + 1.0}}),
}  # fmt: skip


@pytest.mark.parametrize("case", [*COPIES, *MORE])
def test_a_copy_of_data_is_refused_under_another_name(case):
    made, one, other = {**COPIES, **MORE}[case]
    tables = [_named(made, "monday", **one), _named(made, "monday copy", **other)]
    given = (tables, lambda table, p: p["k"] * table.y, [Parameter("k", Prior("normal", 1.0, 1.0))])
    if case in MORE:
        assert len(bare_problem(*given, []).tables) == 2
        return
    with pytest.raises(ScenarioError, match=r"data: monday copy has the readings of monday: "):
        bare_problem(*given, [])
