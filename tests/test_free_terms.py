"""Free terms of a model of one's own: where a law has another shape, and which."""

import json

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from report_page import without_pictures
from sliding_block import (
    CONDITIONS,
    DRAG,
    FRICTION,
    HIDDEN,
    LOAD,
    OVER_LOAD,
    OVER_SPEED,
    OVER_WARMTH,
    SD,
    SPEED,
    TERMS,
    UNCERTAIN,
    WARMTH,
    measured,
    push,
    result,
)
from stickslip import (
    Cause,
    CauseParameter,
    FreeTerm,
    Prior,
    ScenarioError,
    Uncertain,
    diagnose_model,
    instruments,
)
from stickslip.diagnosis import Curves
from stickslip.diagnosis.inference.formulas import Formula

SEEDS = (0, 1, 2)


def hidden(term, seed):
    law, at = HIDDEN[term]
    return measured(seed, 1.0 + law(at))


# `python -m bench laws` counts the same on 90 others.
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("term", HIDDEN, ids=lambda term: term.argument)
def test_a_hidden_term_is_found_over_its_argument(term, seed):
    found = result(hidden(term, seed), seed=seed)
    shapes = found.open_set
    assert found.verdict.kind == "unexplained"
    assert (shapes.accepted, shapes.rivals) == (True, ())
    assert shapes.first.term.name == term.name
    assert found.findings.free_shape is shapes.first
    assert shapes.table()["effect"].iloc[0] == term.name
    assert set(shapes.table()["argument"]) == {"speed", "load", "temperature"}
    assert shapes.gain.chi2_after < 0.5 * shapes.gain.chi2_before


@pytest.mark.parametrize("term", HIDDEN, ids=lambda term: term.argument)
def test_the_band_holds_the_hidden_law(term):
    law, _ = HIDDEN[term]
    held = []
    for seed in SEEDS:
        curve = result(hidden(term, seed), seed=seed).open_set.curve
        assert (curve.argument[0], curve.argument[-1]) == (term.low, term.high)
        truth = FRICTION * (1.0 + law(curve.argument))
        held.append(np.all((curve.low <= truth) & (truth <= curve.high)))
        # Not for want of a narrow band: the law varies by far more than that.
        assert np.mean(curve.high - curve.low) < 0.4 * np.ptp(truth)
    # Of three bands of 90 %, fewer than two hold all of their law with a probability of 3 %.
    assert sum(held) >= 2


def test_a_curve_that_bends_faster_than_its_knots_gets_more_of_them():
    # A wave of 0.1 of the friction and of 0.9 m/s, where knots are 0.5 m/s apart.
    observed = measured(0, 1.0 + 0.1 * np.sin(7.0 * SPEED))
    found = result(observed)
    assert found.open_set.accepted
    assert found.findings.free_shape.term.name == OVER_SPEED.name
    assert found.findings.free_shape.term.knots == OVER_SPEED.finer.knots
    assert len(found.findings.free_shape.term.knots) == 9
    # Three conditions are asked for each knot.
    few = slice(None, None, 2)
    fewer = diagnose_model(
        push, (SPEED[few], LOAD[few], WARMTH[few]), observed[few], UNCERTAIN, free_terms=TERMS,
        sd=np.full(20, SD),
    )  # fmt: skip
    assert len(fewer.open_set.first.term.knots) == 5
    assert not fewer.open_set.accepted


# Without an alarm there is no search. Of the seeds below 200 these give a false one. All of the
# seven have a curve that fits and predicts no worse, and is not claimed for want of evidence alone.
@pytest.mark.parametrize("seed", [26, 102, 108, 113, 135, 158, 190])
def test_without_a_hidden_term_nothing_is_claimed(seed):
    found = result(measured(seed), seed=seed)
    assert found.verdict.kind == "unexplained"
    assert found.open_set is not None
    assert not found.open_set.accepted
    assert found.findings.free_shape is None


def test_the_extended_model_has_the_curve(tmp_path):
    law, _ = HIDDEN[OVER_SPEED]
    found = result(hidden(OVER_SPEED, 0))
    assert list(found.extended) == ["friction", "drag", *OVER_SPEED.knots]
    assert list(found.params.index) == list(found.extended)
    assert set(found.params.loc[OVER_SPEED.knots, "unit"]) == {"-"}
    # Between what was measured.
    new = tuple(np.array(row) for row in ((0.3, 1.1), (2.0, 5.0), (300.0, 310.0)))
    table = found.predict(new)
    truth = FRICTION * (1.0 + law(new[0])) * new[1] + DRAG * new[0]
    assert np.all(np.abs(table["extended"] - truth) < 4.0 * table["extended_sd"])
    assert np.all(np.abs(table["recalibrated"] - truth) > 4.0 * table["recalibrated_sd"])
    values = found.extended
    knots = [[values[name] for name in OVER_SPEED.knots]]
    own = values["friction"] * (1.0 + OVER_SPEED.at(new[0], knots)[0]) * new[1]
    assert table["extended"].to_numpy() == pytest.approx(own + values["drag"] * new[0])
    found.save_report(tmp_path, place=SPEED, labels=("speed (m/s)", "force (N)"), unit="N")
    said = json.loads((tmp_path / "report.json").read_text())["open_set"]
    assert said["accepted"]
    assert said["hooks"][0] | {"lead": 0, "p": 0} == {
        "effect": "friction over speed", "law": "friction", "argument": "speed",
        "span": 2.0, "unit": "m/s", "lead": 0, "p": 0,
    }  # fmt: skip
    page = without_pictures(tmp_path / "report.html")
    assert "The friction depends on the speed in another way than the model says" in page
    assert "A law of another shape" in page


def test_a_page_where_no_curve_explains_the_data_says_so(tmp_path):
    # A wave that is none of speed, load or temperature.
    found = result(measured(0, extra=0.2 * np.sin(np.arange(40))))
    assert found.verdict.kind == "unexplained"
    assert not found.open_set.accepted
    found.save_report(tmp_path, place=SPEED)
    page = without_pictures(tmp_path / "report.html")
    assert "no cause was given" in page
    assert "No law of the model with another shape is claimed" in page
    assert list(found.extended) == ["friction", "drag"]


def test_a_term_that_is_a_force_has_its_unit():
    # The same term with other units of its own, so that nothing in it is of the order of one. Ten
    # sizes are searched, and the largest wind is 2 N.
    micro = FreeTerm("wind", "speed", "m/s", 0.0, 2.0, size=4e5, law_unit="uN")

    def predict(conditions, parameters, curves):
        own = Curves(TERMS, np.zeros((len(parameters), 15)))
        return push(conditions, parameters, own) + 1e-6 * curves[micro.name](conditions[0])

    found = result(measured(0, extra=0.5 * SPEED**2), [micro], predict)
    assert found.open_set.accepted
    assert set(found.params.loc[micro.knots, "unit"]) == {"uN"}
    curve, formula = found.open_set.curve, found.open_set.formula
    assert (curve.unit, curve.without) == ("uN", 0.0)
    assert formula.text == "a u^2"
    # Each of drag and constant force is hidden in it, so within 20 % and no closer.
    assert formula.a == pytest.approx(0.5e6, rel=0.2)
    said = formula.in_numbers("f of wind", "m/s", "uN", relative=False)
    assert said.startswith("f of wind = a u^2 with a = ")
    assert said.endswith(" uN per (m/s)^2")
    level = Formula("a exp(-|u| / b)", 0.5, (0.25,), 0.0, 0.3, 1.0, 0.5)
    said = level.in_numbers("friction", "m/s", "-", relative=True)
    assert said == "friction = 0.3 (1 + a exp(-|u| / b)) with a = 0.5, b = 0.25 m/s"
    root = Formula("a sqrt(|u|)", 0.5, (), 0.0, 0.3, 1.0, 0.5)
    said = root.in_numbers("drag", "rad", "N s/m", relative=True)
    assert said == "drag = 0.3 N s/m (1 + a sqrt(|u|)) with a = 0.5 per rad^0.5"


def test_a_cause_that_explains_the_data_comes_first():
    wind = Cause("wind", (CauseParameter("wind.strength", "N s^2/m^2", -5.0, 5.0, 0.3),))
    observed = measured(0, extra=0.5 * SPEED**2)

    def predict(conditions, parameters, curves):
        return push(conditions, parameters, curves) + parameters[:, 2:] * conditions[0] ** 2

    named = result(observed, predict=predict, causes=[wind])
    assert (named.verdict.kind, named.verdict.causes) == ("named", ("wind",))
    assert named.open_set is None
    # Where it does not, it is absent beside the curves.
    found = result(hidden(OVER_WARMTH, 0), predict=predict, causes=[wind])
    assert found.open_set.first.term.name == OVER_WARMTH.name
    assert found.open_set.accepted
    assert "wind.strength" not in found.extended


def test_an_instrument_reads_a_model_with_curves():
    meter = instruments.offset("N", 0.1)
    read = instruments.with_instruments(push, [meter])
    knots = np.zeros((3, 15))
    knots[1, 2] = 0.5
    parameters = np.array([[0.3, 0.2, 0.0], [0.3, 0.2, 0.0], [0.3, 0.2, 0.7]])
    given = Curves(TERMS, knots)
    plain = push(CONDITIONS, parameters[:, :2], given)
    assert np.max(np.abs(plain[1] - plain[0])) > 0.1
    assert read(CONDITIONS, parameters, given) == pytest.approx(
        plain + 0.7 * np.array([[0], [0], [1]])
    )
    found = result(hidden(OVER_LOAD, 0), predict=read, causes=[meter])
    assert found.open_set.first.term.name == OVER_LOAD.name


def test_a_cheaper_model_has_the_curves_too():
    calls = []

    def cheaper(conditions, parameters, curves):
        calls.append((parameters.shape[1], bool(curves.knots.any())))
        return push(conditions, parameters, curves)

    found = result(hidden(OVER_SPEED, 0), low_fidelity=cheaper)
    assert found.open_set.accepted
    assert set(calls) == {(2, False), (2, True)}


def test_a_curve_goes_through_its_knots_and_is_constant_beyond_them():
    term = FreeTerm("pull", "gap", "m", -1.0, 3.0, count=6)
    places, values = np.linspace(-1.0, 3.0, 6), np.array([0.3, -0.2, 0.5, 0.1, 0.0, 0.4])
    slopes = np.gradient(values, places, edge_order=2)
    fine = np.linspace(-1.0, 3.0, 37)
    expected = CubicHermiteSpline(places, values, slopes)(fine)
    assert term.at(fine, [values])[0] == pytest.approx(expected, abs=1e-14)
    assert term.at([-9.0, -1.0, 3.0, 9.0], [values])[0] == pytest.approx([0.3, 0.3, 0.4, 0.4])
    parabola = 0.2 + 0.1 * places - 0.3 * places**2
    assert term.at(fine, [parabola])[0] == pytest.approx(0.2 + 0.1 * fine - 0.3 * fine**2)


def test_a_curve_takes_arguments_of_each_vector():
    values = np.array([[0.0, 0.1, 0.2, 0.3, 0.4], [1.0, 1.0, 1.0, 1.0, 1.0]])
    curves = Curves([OVER_SPEED], values)
    assert list(curves) == ["friction over speed"]
    over = curves["friction over speed"]
    assert over([0.5, 1.0]) == pytest.approx(np.array([[0.1, 0.2], [1.0, 1.0]]))
    own = np.array([[0.5, 1.0, 1.5], [0.0, 1.0, 2.0]])
    assert over(own) == pytest.approx(np.array([[0.1, 0.2, 0.3], [1.0, 1.0, 1.0]]))
    assert over(own[:, :, None]).shape == (2, 3, 1)
    assert over(1.0) == pytest.approx(np.array([[0.2], [1.0]]))
    assert np.isnan(over([np.nan, 1.0])[0]).tolist() == [True, False]
    second = curves.rows(np.array([1]))["friction over speed"]
    assert second([0.0]) == pytest.approx(np.array([[1.0]]))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: FreeTerm("friction", "speed", "m/s", 2.0, 2.0), "low < high"),
        (lambda: FreeTerm("friction", "speed", "m/s", 0.0, np.inf), "low < high"),
        (lambda: FreeTerm("", "speed", "m/s", 0.0, 1.0), "law"),
        (lambda: FreeTerm("friction", "speed", "m/s", 0.0, 1.0, size=0.0), "size"),
        (lambda: FreeTerm("friction", "speed", "m/s", 0.0, 1.0, count=2), "count"),
        (lambda: Curves(TERMS, np.zeros((1, 15)))["friction over sped"], "friction over speed"),
        (
            lambda: FreeTerm("drag", "load", "N", 0, 1, law_unit="N s/m", factor_of="drag"),
            'law_unit = "N s/m": allowed is "-" beside factor_of',
        ),
        (lambda: result(measured(0), [UNCERTAIN[0]]), "free_terms: allowed is a list"),
        (lambda: result(measured(0), [OVER_LOAD, OVER_LOAD]), "comes twice"),
        (
            lambda: result(measured(0), [FreeTerm("a", "b", "m", 0, 1, factor_of="drg")]),
            'factor_of = drg: .* "drag"',
        ),
    ],
)
def test_what_does_not_fit_is_refused(make, said):
    with pytest.raises(ScenarioError, match=said):
        make()


KNOT = OVER_SPEED.knots[0]


@pytest.mark.parametrize(
    ("terms", "uncertain", "parameter"),
    [
        ([OVER_SPEED], [Uncertain(KNOT, Prior("normal", 0.0, 0.1))], "other"),
        ([OVER_SPEED], [], KNOT),
        ([OVER_SPEED, FreeTerm("friction", "speed.knot_1", "m/s", 0.0, 1.0)], [], "other"),
    ],
    ids=["constant", "parameter of a cause", "term"],
)
def test_a_name_of_a_knot_is_that_of_nothing_else(terms, uncertain, parameter):
    cause = Cause("wind", (CauseParameter(parameter, "N", -5.0, 5.0, 0.3),))
    with pytest.raises(ScenarioError, match=f"free_terms: {KNOT} comes twice; allowed is once"):
        diagnose_model(
            push, CONDITIONS, measured(0), [*UNCERTAIN, *uncertain], [cause], free_terms=terms
        )
