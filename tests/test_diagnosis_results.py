"""What a person gets from a diagnosis: tables, predictions, pictures, text, and its options."""

import json
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import stickslip
from line_model import SD, SLOPE, WAVE, X, line
from made_measurement import write
from stickslip import Options, Scenario, diagnose, diagnose_model, read_measurement
from stickslip.diagnosis.inference.extended_model import extended_scenario
from stickslip.errors import ScenarioError
from toy_model import CAUSES, UNCERTAIN, predict, result, shared_result, trials, truth

WAVE_SIZE = 0.5


@pytest.fixture(scope="module")
def waved():
    """A line with a wave of height 0.5 on it, 24 readings of stated errors."""
    random = np.random.default_rng(3)
    observed = X + WAVE_SIZE * np.sin(4 * X) + SD * random.standard_normal(len(X))
    return diagnose_model(shapes, X, observed, [SLOPE], [WAVE], sd=SD)


def shapes(x, p):
    return p[:, :1] * x + p[:, 1:2] * np.sin(4 * x)


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """A diagnosis of a measurement of velocities, whose surface tilts by 0.04 rad."""
    path = write(tmp_path_factory.mktemp("measured"), {"effects.surface_tilt.angle": 0.04})
    return diagnose(read_measurement(path), threads=2)


def test_parameters_are_those_of_the_linear_answer(waved):
    # Slope and height are linear, and all readings have the same error: the covariance is that of
    # least squares; the priors, of widths 0.5 and 1, change it by (0.01 / 0.5)^2.
    assert (waved.verdict.kind, waved.verdict.causes) == ("named", ("wave",))
    design = np.stack([X, np.sin(4 * X)], axis=1)
    covariance = SD**2 * np.linalg.inv(design.T @ design)
    table = waved.params
    assert list(table.index) == ["slope", "wave.height"]
    assert list(table.columns) == ["value", "sd", "unit", "prior", "pull"]
    np.testing.assert_allclose(waved.covariance, covariance, rtol=0.02)
    assert table["sd"].to_numpy() == pytest.approx(np.sqrt(np.diag(covariance)), rel=0.02)
    assert abs(table.loc["wave.height", "value"] - WAVE_SIZE) < 3 * table.loc["wave.height", "sd"]
    assert table.loc["slope", "pull"] == pytest.approx((table.loc["slope", "value"] - 1.0) / 0.5)
    assert table.loc["slope", "prior"] == "normal(1, 0.5)"


def test_intervals_are_those_of_a_normal_law_where_the_model_is_linear(waved):
    table, values = waved.conf_int(0.95), waved.params
    assert list(table.columns) == ["low", "high", "unit"]
    for name in table.index:
        # A profile is drawn by straight lines between roots of chi-square, so to a few per cent.
        half = (table.loc[name, "high"] - table.loc[name, "low"]) / 2
        assert half == pytest.approx(1.96 * values.loc[name, "sd"], rel=0.05)
        assert table.loc[name, "low"] < values.loc[name, "value"] < table.loc[name, "high"]
    narrower = waved.conf_int(0.5)
    assert np.all(narrower["low"] > table["low"])
    assert np.all(narrower["high"] < table["high"])


@pytest.mark.parametrize("level", [0.0, 1.0, 0.999, -1, "a"])
def test_a_level_that_no_profile_reaches_is_refused(waved, level):
    with pytest.raises(ScenarioError, match=r"level = .*: allowed is a number above 0, at"):
        waved.conf_int(level)


def test_candidates_are_ranked_and_compared_with_the_best():
    given = result(7, {"wave": 1.2, "swell": -1.2})
    table = given.compare()
    assert list(table.columns) == ["log_evidence", "delta", "chi2", "p", "converged"]
    assert table.index[0] == given.verdict.fit.name == "swell + wave"
    assert table["delta"].iloc[0] == 0.0
    assert table["delta"].is_monotonic_increasing
    assert table.loc["none", "log_evidence"] == 0.0
    gaps = table["log_evidence"].iloc[0] - table["log_evidence"]
    np.testing.assert_allclose(table["delta"], gaps, atol=1e-9)


def test_predictions_at_new_conditions_have_the_error_of_the_fit(waved):
    new = np.array([1.3, 3.5, 5.0])
    table = waved.predict(new)
    assert list(table.columns) == ["recalibrated", "recalibrated_sd", "extended", "extended_sd"]
    value = waved.params["value"]
    expected = value["slope"] * new + value["wave.height"] * np.sin(4 * new)
    np.testing.assert_allclose(table["extended"], expected, rtol=1e-9)
    design = np.stack([new, np.sin(4 * new)], axis=1)
    variance = np.einsum("ij,jk,ik->i", design, waved.covariance.to_numpy(), design)
    # A height is no linear function of its coordinate, so to some per mille.
    np.testing.assert_allclose(table["extended_sd"], np.sqrt(variance), rtol=0.01)


@pytest.mark.nightly
def test_the_extended_scenario_has_the_covariance_of_what_was_fitted(measured):
    scenario = measured.extended
    keys = list(scenario.uncertain.keys)
    assert keys == list(measured.params.index)
    np.testing.assert_array_equal(scenario.uncertain.matrix, measured.covariance.loc[keys, keys])
    assert [scenario.get(key) for key in keys] == measured.params["value"].tolist()
    # Draws scatter as the same covariance makes a linear model: half of the middle 68 % of 400
    # draws is their standard deviation to within 5 %.
    column = "recalibrated_sd" if measured.verdict.fit is None else "extended_sd"
    at = scenario.replace({"drive.frequency": 50.0})
    low, high = stickslip.predict(at, draws=400, quantiles=[0.1587, 0.8413]).data["mean_velocity"]
    sd = measured.predict([{"frequency": 50.0}])[column].item()
    assert 0.5 * (high - low).item() == pytest.approx(sd, rel=0.25)
    # Fits that do not agree have none that can be trusted.
    found = measured.findings
    fit = found.verdict.fit and replace(found.verdict.fit, converged=False)
    null, verdict = replace(found.null, converged=False), replace(found.verdict, fit=fit)
    doubtful = replace(found, null=null, verdict=verdict)
    again = extended_scenario(doubtful, measured.measurement.scenario)
    assert again == scenario.with_uncertain(None)


def test_without_a_finding_there_is_no_extended_model():
    given = result(5)
    assert given.verdict.kind == "none"
    assert list(given.params.index) == ["k0", "k1", "k2", "k3"]
    assert list(given.predict(None).columns) == ["recalibrated", "recalibrated_sd"]
    assert set(given.extended) == {"k0", "k1", "k2", "k3"}
    with pytest.raises(ScenarioError, match="no candidate was fitted"):
        given.plot.ranking()
    with pytest.raises(ScenarioError, match="wave: there is no such profile; there is none"):
        given.plot.profile("wave")


def test_data_that_cannot_be_judged_give_no_parameters():
    given = result(11, data_problem="nothing moves")
    assert given.verdict.kind == "data-problem"
    assert given.params.empty
    assert given.conf_int().empty
    assert given.extended == {}
    assert given.compare().empty
    assert given.gain is None
    assert "p = " not in repr(given)
    assert "nothing moves" in given.summary()
    assert "no gain on held-out conditions: there is no extended model" in given.summary()
    assert "log_evidence" not in given.summary()
    with pytest.raises(ScenarioError, match="the data allow no diagnosis"):
        given.predict(None)


def test_a_summary_of_a_set_says_whose_parameters_it_has():
    given = shared_result(0, split=0.4)
    assert given.verdict.kind == "ambiguous"
    first, *others = given.verdict.causes
    assert given.verdict.fit.name == first
    line = next(each for each in given.summary().splitlines() if "the first of the set" in each)
    assert f"are of {first}," in line
    assert all(name in line for name in others)


def test_convergence_is_not_denied_where_it_was_not_checked(waved, tmp_path):
    assert waved.compare().loc["wave", "converged"] == "yes"
    lone = replace(waved.findings.verdict.fit, converged=False, starts=(1.0,))
    ranking = replace(waved.findings.ranking, singles=(lone,))
    given = replace(waved, findings=replace(waved.findings, ranking=ranking))
    assert given.compare().loc["wave", "converged"] == "not checked"
    given.save_report(tmp_path)
    full = json.loads((tmp_path / "report.json").read_text())
    assert full["ranking"][1]["converged"] == "not checked"
    page = (tmp_path / "report.html").read_text()
    assert re.findall(r"<tr><td>wave</td>.*<td>([a-z ]+)</td></tr>", page) == ["not checked"]


def test_a_summary_is_one_screen_and_a_representation_one_line(waved, measured):
    for given in (waved, measured, result(0, {"split": 0.4})):
        text = given.summary()
        assert given.verdict.kind in text
        assert all(cause in text for cause in given.verdict.causes[:3])
        assert all(name in text for name in given.params.index)
        assert len(text.splitlines()) <= 45
        found = given.findings
        parts = [
            given, found, found.problem, found.verdict, found.null, found.noise, found.ranking,
            found.sensitivities, found.gain, *found.profiles, given.posed, given.measurement,
            Options(sd=np.ones(100)),
        ]  # fmt: skip
        if given.measurement is not None:
            parts += given.measurement.velocity
        for each in parts:
            assert "\n" not in repr(each)
            assert len(repr(each)) < 800, type(each)


def test_what_is_printed_can_be_read(waved, measured):
    tables = (measured.params, measured.compare().head(3), measured.predict([{"frequency": 33.0}]))
    for table in tables:
        assert isinstance(table, pd.DataFrame)
        header, *rows = (line for line in repr(table).splitlines() if line)
        assert all(name in header for name in table.columns)
        assert len(rows) in (len(table), len(table) + 1)  # a line for the index's name
    assert repr(measured.measurement) == (
        '<Measurement "test bench": 24 trials at 8 conditions, 0 left out>'
    )
    assert all(name in repr(measured.plot) for name in ("fit", "residuals", "ranking", "profile"))
    first = measured.propose_experiments()[0]
    assert str(first.why) in str(first)
    assert "frequency" in str(first)
    assert measured.plot.residuals().axes[0].get_xlabel() == "condition"
    assert waved.plot.residuals().axes[0].get_xlabel() == "observable"


def test_verdicts_and_measurements_can_be_compared(waved, measured):
    assert waved.verdict == replace(waved.verdict)
    assert waved.verdict != measured.verdict
    assert measured.measurement == measured.measurement
    assert len({waved.findings, measured.findings, waved.verdict.fit}) == 3


def test_only_public_names_are_listed():
    assert dir(stickslip) == sorted(stickslip.__all__)
    assert dir(stickslip.plot) == sorted(stickslip.plot.__all__)


def test_pictures_are_figures(waved, measured):
    for given in (waved, measured):
        for figure in (given.plot.fit(), given.plot.residuals(), given.plot.ranking()):
            assert isinstance(figure, Figure)
            assert figure.axes
    figure = waved.plot.profile("wave.height")
    assert "wave.height" in figure.axes[0].get_xlabel()
    with pytest.raises(ScenarioError, match=r'did you mean "wave\.height"'):
        waved.plot.profile("wave.heigth")
    lines = waved.plot.residuals().axes[0].lines
    (points,) = (each for each in lines if each.get_label() == "extended")
    np.testing.assert_array_equal(points.get_ydata(), waved.verdict.fit.residual[: len(X)])


def test_a_measurement_is_predicted_at_drives(measured):
    rows = [{"frequency": 40.0}, {"drive.frequency": 55, "direction": "-x"}]
    table = measured.predict(rows)
    assert table["frequency"].tolist() == [40.0, 55]
    assert (
        measured.predict(pd.DataFrame({"frequency": [40.0]}))["recalibrated"].iloc[0]
        == (table["recalibrated"].iloc[0])
    )
    written = pd.DataFrame({"frequency": [40.0], "mode": "ipp", "direction": "+X"})
    as_measured = written.assign(velocity=1e-3, trial=1, block="a", order=3, velocity_sd=0.1)
    again = measured.predict(as_measured)
    assert list(again.columns[:3]) == ["frequency", "mode", "direction"]
    assert again["recalibrated"].iloc[0] == table["recalibrated"].iloc[0]
    scenario = measured.extended
    assert isinstance(scenario, Scenario)
    run = stickslip.simulate(scenario.replace({"drive.frequency": 40.0, "solver.rtol": 1e-8}))
    column = "extended" if measured.verdict.fit is not None else "recalibrated"
    # The diagnosis simulates with an error below a twentieth of a mean's, here 2 % / sqrt 3.
    assert table[column].iloc[0] == pytest.approx(run.mean_velocity, rel=1e-3)
    for bad, said in (
        ([{"frequencies": 40.0}], 'row 0: "frequencies" is not known; did you mean "frequency"'),
        ([{"frequency": 40.0}, {"frequency": -1.0}], "row 1: drive.frequency = -1.0: allowed is"),
        ({"frequency": 40.0}, "allowed is a DataFrame or a list of dicts"),
        ("frequency", "allowed is a DataFrame or a list of dicts"),
        (None, "allowed is a DataFrame or a list of dicts"),
        ([40.0], "allowed is a DataFrame or a list of dicts"),
        ([], "there is no row"),
        (pd.DataFrame({"frequency": []}), "there is no row"),
        (pd.DataFrame({"frequency": [np.nan]}, index=["a"]), "row a: frequency is empty"),
    ):
        with pytest.raises(ScenarioError, match=said):
            measured.predict(bad)


def test_experiments_are_as_many_as_asked_for(measured):
    three = measured.propose_experiments()
    assert measured.propose_experiments(1) == three[:1]
    assert measured.propose_experiments(0) == []
    for count in (-1, 1.5):
        with pytest.raises(ScenarioError, match=r"count = .*: allowed is a whole number"):
            measured.propose_experiments(count)
    assert len(measured.propose_experiments(5)) >= len(three)
    assert measured.as_dict()["next_experiments"][0]["drive"] == three[0].drive


def test_a_report_is_refused_before_it_is_made(measured, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match=r"cannot write .*file: it is not a folder"):
        measured.save_report(tmp_path / "file")
    with pytest.raises(ScenarioError, match="folder = 3: allowed is a path"):
        measured.save_report(3)
    with pytest.raises(ScenarioError, match="save_report: title, unit: allowed for a model of"):
        measured.save_report(tmp_path / "out", title="Bench", unit="mm/s")
    with pytest.raises(ScenarioError, match=r"plot\.fit: labels: allowed for a model of"):
        measured.plot.fit(labels=("f", "v"))
    assert not (tmp_path / "out").exists()


def test_a_model_of_ones_own_has_no_drives_to_propose(waved):
    with pytest.raises(ScenarioError, match="separate"):
        waved.propose_experiments()
    worth = waved.separate(np.array([1.0, 5.0]))
    assert worth.chi2.shape == (2,)


def test_the_numbers_of_the_command_are_there(measured, waved):
    assert set(measured.as_dict()) == set(waved.as_dict())
    assert json.loads(json.dumps(waved.as_dict(), default=float))["cause"] == "wave"


def test_options_may_be_made_before():
    values, index = trials(truth({"wave": 1.0}), np.random.default_rng(1))
    options = Options(condition=index, seed=1)
    one = diagnose_model(predict, None, values, UNCERTAIN, CAUSES, options)
    other = diagnose_model(predict, None, values, UNCERTAIN, CAUSES, condition=index, seed=1)
    assert repr(one.params.to_dict()) == repr(other.params.to_dict())
    changed = diagnose_model(predict, None, values, UNCERTAIN, CAUSES, options, seed=2)
    assert (one.findings.seed, changed.findings.seed) == (1, 2)


def test_an_option_that_is_not_there_is_refused_with_the_nearest():
    with pytest.raises(TypeError, match='there is no option conditon; did you mean "condition"'):
        diagnose_model(line, None, X, [SLOPE], [WAVE], conditon=np.arange(len(X)))
    with pytest.raises(TypeError, match=r"options = .*: allowed is an Options"):
        diagnose_model(line, None, X, [SLOPE], [WAVE], {"sd": 1.0})


def test_what_is_public_has_public_types():
    # The types of what a function takes and returns, and of all attributes.
    import dataclasses
    import re

    rooms = (stickslip, stickslip.diagnosis, stickslip.facts, stickslip.measurement)
    known = {name for room in rooms for name in room.__all__}
    pattern = re.compile(r"\b[A-Z]\w+\b")
    outside = {"Any", "None", "Array", "Indices", "NDArray", "Mapping", "Sequence", "Callable",
               "ArrayLike", "PathLike", "Path", "DataFrame", "Figure", "Value", "Table", "Index",
               "VerdictKind", "Literal", "Predict", "PredictWithCurves", "Progress"}  # fmt: skip
    inner = {"Combined", "Simulator", "Comparison", "FilmComparison"}  # of PosedProblem
    missing = set()
    for name in stickslip.diagnosis.__all__:
        value = getattr(stickslip.diagnosis, name)
        texts = list(getattr(value, "__annotations__", {}).values())
        if dataclasses.is_dataclass(value) or isinstance(value, type):
            members = [each for each in vars(value).values() if callable(each)]
            members += [each.fget for each in vars(value).values() if isinstance(each, property)]
            for each in members:
                if not getattr(each, "__name__", "_").startswith("_"):
                    texts += getattr(each, "__annotations__", {}).values()
        missing |= {word for text in texts for word in pattern.findall(str(text))}
    assert missing - known - outside - inner == set()
