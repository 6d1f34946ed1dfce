"""Laws of a free shape as causes."""

import sys

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.stats import multivariate_normal

from free_shapes import SHAPES
from stickslip import Drive, Law, Measurement, Prior, Scenario, simulate
from stickslip.diagnosis.decision.candidate import Candidate
from stickslip.diagnosis.fitting.law_forms import with_forms
from stickslip.diagnosis.fitting.models import log_prior
from stickslip.diagnosis.fitting.search import Models, Start, search
from stickslip.diagnosis.report.sections.size import law_of
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.curve import LENGTHS, SIZES
from stickslip.diagnosis.terms.curve import SHAPES as SHAPES_OF
from stickslip.diagnosis.terms.laws import Curves, beside_constants, forms, free_law
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.walker.laws import find_spans, laws
from stickslip.walker.problem import posed_by

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=8)).replace({"solver.rtol": 1e-6})
FREE = set(SHAPES)
FRICTION = {"contact.kinetic_friction": Prior("normal", 0.145, 0.01)}


def valued(cause, knots):
    return {
        each.name: np.array(v)
        for each, v in zip(cause.parameters, np.transpose(knots), strict=True)
    }


# ------------------------------------------------------------------------- a model of one's own
def test_a_curve_goes_through_its_knots_and_is_constant_beyond_them():
    law = free_law("pull", "gap", "m", -1.0, 3.0, knots=6)
    places, fine = np.linspace(-1.0, 3.0, 6), np.linspace(-1.0, 3.0, 37)
    values = np.array([0.3, -0.2, 0.5, 0.1, 0.0, 0.4])
    slopes = np.gradient(values, places, edge_order=2)
    parabola = 0.2 + 0.1 * places - 0.3 * places**2
    over, exact = Curves([law], valued(law, [values, parabola]))["pull over gap"](fine)
    assert over == pytest.approx(CubicHermiteSpline(places, values, slopes)(fine), abs=1e-14)
    assert exact == pytest.approx(0.2 + 0.1 * fine - 0.3 * fine**2)
    over = Curves([law], valued(law, [values]))["pull over gap"]
    assert over([-9.0, -1.0, 3.0, 9.0])[0] == pytest.approx([0.3, 0.3, 0.4, 0.4])


def test_a_curve_takes_arguments_of_each_vector():
    law = free_law("friction", "speed", "m/s", 0.0, 2.0)
    values = valued(law, [[0.0, 0.1, 0.2, 0.3, 0.4], [1.0, 1.0, 1.0, 1.0, 1.0]])
    columns = {name: each[:, None] for name, each in values.items()}
    curves = Curves([Cause("wind", Parameter("wind", size=1.0, low=-5, high=5)), law], columns)
    assert list(curves) == ["friction over speed"]
    over = curves["friction over speed"]
    assert over([0.5, 1.0]) == pytest.approx(np.array([[0.1, 0.2], [1.0, 1.0]]))
    own = np.array([[0.5, 1.0, 1.5], [0.0, 1.0, 2.0]])
    assert over(own) == pytest.approx(np.array([[0.1, 0.2, 0.3], [1.0, 1.0, 1.0]]))
    assert over(own[:, :, None]).shape == (2, 3, 1)
    assert over(1.0) == pytest.approx(np.array([[0.2], [1.0]]))
    # A law that is not in the model is flat.
    flat = Curves([law], {"drag": np.array([[0.1], [0.2], [0.3]])})["friction over speed"]
    assert np.array_equal(flat([0.5, 1.0]), np.zeros((3, 2)))
    for each in (over, flat):
        assert np.isnan(each([np.nan, 1.0])[0]).tolist() == [True, False]


def test_a_free_law_is_a_factor_of_its_constant():
    law = free_law("friction", "speed", "m/s", 0.0, 2.0, factor_of="mu")
    mu = Parameter("mu", Prior("log-normal", 0.3, 1.1), "1/m")
    (bound,) = beside_constants([law], [mu])
    assert (law.frees, bound.curve.law_unit, bound.curve.relative) == ("mu", "1/m", True)
    assert (bound.curve.constant, bound.curve.stated) == ("mu", pytest.approx(0.3))
    wind = free_law("wind", "speed", "m/s", 0.0, 2.0, size=4e5, law_unit="uN")
    assert beside_constants([wind], [mu]) == [wind]
    assert (wind.curve.constant, wind.curve.stated) == (None, 0.0)
    assert {(p.unit, p.high) for p in wind.parameters} == {("uN", 4e6)}
    # Formulas count from zero where it is near.
    for low, high, origin in ((0.1, 2.0, 0.0), (280.0, 330.0, 280.0), (-1.0, 1.0, 0.0)):
        assert free_law("friction", "x", "K", low, high).curve.origin == origin


# ------------------------------------------------------------------------------ prior of a curve
def test_knots_are_linear_and_reach_as_far_as_is_searched():
    law = free_law("friction", "speed", "m/s", 0.0, 2.0, size=0.2)
    u = np.linspace(-10.0, 10.0, 9)
    for knot in law.parameters:
        assert knot.limits == pytest.approx((-10.0, 10.0))
        assert knot.value(u) == pytest.approx(0.2 * u)
    sliding = laws(BASE, {}, {"free_friction_speed": 0.01})[0]
    # 1 + f is not below zero, and f at most three times the law.
    assert sliding.parameters[0].limits == pytest.approx((-1.0 / 0.3, 3.0 / 0.3))


def test_the_prior_prefers_a_smooth_law_to_a_rough_one_of_the_same_size():
    inverses = free_law("friction", "speed", "m/s", 0.0, 2.0).curve.precisions()
    assert len(inverses) == len(SIZES) * len(LENGTHS)
    # It depends on the range and not on units.
    assert np.allclose(
        inverses, free_law("friction", "speed", "mm/s", 0.0, 2000.0).curve.precisions()
    )

    def density(knots):
        zero = np.zeros(len(knots))
        return np.mean([multivariate_normal(zero, np.linalg.inv(p)).pdf(knots) for p in inverses])

    smooth, rough = np.array([0.0, 0.5, 1.0, 1.5, 2.0]), np.array([2.0, 0.0, 1.5, 0.5, 1.0])
    assert density(smooth) > 100.0 * density(rough)
    # A law of ten sizes surprises, but is not excluded: with the usual size alone it had e^-50.
    large = density(np.full(5, 10.0)) / density(np.zeros(5))
    assert np.exp(-25.0) < large < np.exp(-8.0)


# ---------------------------------------------------------------------------------- the simulator
def test_the_curve_is_the_law_of_the_core():
    span = 0.01
    (law,) = laws(BASE, {}, {"free_drag_speed": span})
    knots = (0.1, 0.4, -0.2, 0.3, 0.0)
    arguments = np.linspace(0.0, 0.012, 26)
    values = dict(zip([each.name for each in law.parameters], knots, strict=True))
    bent = BASE.replace({**law.curve.statement.fixed, **values})
    expected = bent.to_core().free_curve("free_drag_speed", arguments)
    assert law.curve.design(arguments) @ knots == pytest.approx(expected, abs=1e-15)
    assert law.curve.design(arguments.reshape(2, 13)).shape == (2, 13, 5)
    # Where a knot is, f is its value.
    assert law.curve.design(law.curve.places) == pytest.approx(np.eye(5), abs=1e-9)


def test_every_free_shape_of_the_core_is_a_law_that_starts_absent():
    causes = laws(BASE, FRICTION, dict.fromkeys(FREE, 0.5))
    by_effect = {each.parameters[0].name.split(".")[1]: each for each in causes}
    assert set(by_effect) == FREE
    keys = {each.name: 0.0 for cause in causes for each in cause.parameters}
    fixed = {key: value for cause in causes for key, value in cause.curve.statement.fixed.items()}
    plain = simulate(BASE).mean_velocity
    assert simulate(BASE.replace({**fixed, **keys})).mean_velocity == plain
    for name, each in by_effect.items():
        frees = set(FRICTION) if name.startswith("free_friction") else {None}
        assert {each.frees} == frees
    assert by_effect["free_drag_rate"].curve.stated == BASE.drag.linear
    assert by_effect["free_field_time"].curve.stated == 1.0
    place = by_effect["free_contact_place"].curve
    assert (place.stated, place.relative, place.law_unit) == (0.0, False, "half lengths")
    assert (place.low, place.high) == (-0.5, 0.5)
    assert by_effect["free_friction_load"].name == "friction over normal force"


def test_spans_are_what_the_runs_reach():
    slow, fast = BASE.replace({"drive.frequency": 30.0}), BASE.replace({"drive.frequency": 90.0})
    spans = find_spans([slow, fast], threads=1)
    assert set(spans) == FREE
    assert spans["free_field_frequency"] <= 90.0
    assert spans["free_adhesion_age"] == pytest.approx(1.0 / 30.0)
    run = simulate(fast.replace({"record.rate": 20_000.0}))
    angle = np.max(np.abs(run.theta))
    assert 0.5 * angle < spans["free_drag_angle"] <= 1.01 * angle
    # The samples in flight have no slip.
    slips = np.abs(run.slip_velocity)
    assert np.any(np.isnan(slips))
    assert 0.1 * np.nanmax(slips) < spans["free_friction_speed"] <= 1.01 * np.nanmax(slips)
    # One frequency tells nothing of a law over it, and there is no law of what is not there.
    alone = find_spans([slow.replace({"contact.adhesion": 0.0})], threads=1)
    absent = {"free_field_frequency", "free_adhesion_angle", "free_adhesion_age"}
    assert FREE - set(alone) == absent


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_forms_of_the_simulator_compete_with_the_curve_that_is_fitted(seed):
    # Adhesion that grows with the age of a contact, beside the curve that was fitted to it.
    hidden = Law(quantity="adhesion", over="age", form="saturation", scale=4e-3, fraction=2.0)
    base = BASE.replace({"contact.adhesion": 1e-7})
    drives = [{"drive.frequency": f, "drive.mode": mode} for mode in ("IPP", "OPP")
              for f in (15.0, 25.0, 40.0, 60.0, 80.0, 100.0, 130.0, 160.0)]  # fmt: skip
    truth = [simulate(base.replace({**each, "laws.age": hidden})).mean_velocity for each in drives]
    random = np.random.default_rng(seed)
    rows = [{"frequency": each["drive.frequency"], "mode": each["drive.mode"], "velocity": v}
            for each, at in zip(drives, truth, strict=True)
            for v in at + 2e-5 * random.standard_normal(4)]  # fmt: skip
    uncertain = {"contact.adhesion": Prior("log-normal", 1e-7, 1.1)}
    measurement = Measurement.from_dataframe(pd.DataFrame(rows), base, uncertain)
    problem = posed_by(measurement)
    models = Models(problem, problem.causes)
    models.add_fits([Start("exact", (), np.zeros(problem.size))])
    wider = problem.wider(problem, problem.laws(problem, models.null.x))
    (law,) = [each for each in wider.causes if each.name == "adhesion over age of the contact"]
    models = models.widened(wider, wider.causes)
    search(models, [], [law])
    models = with_forms(models)
    told = Candidate(models.get([law.name]), models)
    shape = law_of(told)
    assert (shape["form"], shape["lines"][0]) == ("saturation", "[laws.adhesion_age_saturation]")
    assert shape["forms"]["saturation"] > 0.3
    assert sum(shape["forms"].values()) == pytest.approx(1.0)
    # What the law has besides the stated level is seen through it.
    section = "laws.adhesion_age_saturation"
    for key, true in {"fraction": 2.0, "scale": 4e-3}.items():
        found = told.params.loc[f"{section}.{key}"]
        assert abs(found["value"] - true) < 4.0 * found["sd"]
        assert found["sd"] < 0.5 * true
    # The scenario of these numbers, and of the lines as they are printed, is the model.
    (curve,) = [each.curve for each in told.fit.causes]
    stated = base.replace({**told.params["value"].to_dict(), **curve.statement.fixed})
    own = Law(**tomllib.loads("\n".join(shape["lines"]))["laws"]["adhesion_age_saturation"])
    for scenario in (stated, stated.replace({section: own})):
        made = [simulate(scenario.replace(each)).mean_velocity for each in drives]
        assert np.sort(made) == pytest.approx(np.sort(problem.y - told.fit.residual), abs=4e-6)


def test_forms_act_as_the_core_has_them():
    # Drag over the speed by a curve and by each form: alike where the curve goes through the form.
    (law,) = laws(BASE, {}, {"free_drag_speed": 0.02})
    assert forms(law).keys() == set(SHAPES_OF)
    for each in forms(law).values():
        numbers = dict(zip([p.name for p in each.parameters], (0.2, 0.02), strict=False))
        f = each.curve.at(law.curve.places[None, :], np.array([[*numbers.values()]]))[0]
        knots = dict(zip([p.name for p in law.parameters], f, strict=True))
        stated = (
            {**numbers, **each.curve.statement.fixed},
            {**knots, **law.curve.statement.fixed},
            {},
        )
        runs = [simulate(BASE.replace(values)).mean_velocity for values in stated]
        assert abs(runs[0] - runs[1]) < 0.05 * abs(runs[0] - runs[2])
    assert forms(laws(BASE, {}, {"free_field_time": 0.1})[0]) == {}
    (load,) = laws(BASE, {}, {"free_friction_load": 1e-6})
    assert forms(load).keys() == {"gaussian", "exponential", "saturation"}


def test_laws_have_the_odds_of_one_cause_together():
    causes = laws(BASE, FRICTION, dict.fromkeys(FREE, 0.5))
    assert sum(each.odds for each in causes) == pytest.approx(1.0)
    assert log_prior(causes[:1], "exact", 5.0) == pytest.approx(
        log_prior([Cause("wind", Parameter("wind", size=1.0, low=-5, high=5))], "exact", 5.0)
        - np.log(len(causes))
    )
