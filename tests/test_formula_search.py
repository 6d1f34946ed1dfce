"""Formulas in the place of a curve of free shape: the one that made the data is found."""

import numpy as np
import pytest

from stickslip import FreeTerm, Prior, Uncertain
from stickslip.diagnosis.fit.fit_result import Start, make_candidate
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.inference.formula_search import find_formulas
from stickslip.diagnosis.inference.formulas import FORMS
from stickslip.diagnosis.model.problem import Problem

SD, LEVEL = 0.02, 1.5


def found(law, unit, low, high, factor_of=None):
    """Formulas of a law that is added to an uncertain level, or that it is times 1 more than."""
    term = FreeTerm("force", "speed", unit, low, high, size=0.3, factor_of=factor_of)
    # Between 0 and the next knot no curve has the cusp of a root.
    at = np.linspace(low, high, 44)[4:]
    level = Uncertain("level", Prior("normal", 1.0, 0.5), "N")

    def predict(conditions, parameters):
        curve = term.at(conditions, parameters[:, 1:])
        return parameters[:, :1] * (1.0 + curve) if factor_of else parameters[:, :1] + curve

    noise = np.random.default_rng(4).normal(0.0, SD, 40)
    observed = (LEVEL * (1.0 + law(at)) if factor_of else LEVEL + law(at)) + noise
    problem = Problem(
        predict, at, observed, np.eye(40) / SD, np.inf, (level,), (term.cause,)
    )  # fmt: skip
    candidate = make_candidate(problem, [term.cause])
    (fit,) = fit_candidates(problem, [candidate], [[Start(np.zeros(6))]], 30)
    return find_formulas(problem, term.term([level]), fit)


def errors(form, low, span, a, places):
    """Standard deviations of a factor and its places, where the level is free too."""
    at, step = np.linspace(low, span, 44)[4:], 1e-4 * span

    def moved(k, by):
        return a * form.shape(at, *(np.array(places) + by * np.eye(len(places))[k]))

    slopes = [(moved(k, step) - moved(k, -step)) / (2.0 * step) for k in range(len(places))]
    jacobian = np.stack([np.ones(40), form.shape(at, *places), *slopes], axis=1)
    return SD * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))[1:]


# With a place between two knots, and with the level free: a form that has one is a constant less
# its opposite, and the constant form is the level itself.
@pytest.mark.parametrize("form", FORMS[1:], ids=lambda form: form.text)
def test_the_form_that_made_the_data_is_among_those_that_are_as_likely(form):
    span = 1.2 if form.angle else 0.02
    low = -span if form.even else 0.0
    places = [0.4 * span, 0.5 * span][: form.places]
    # Nor has a curve with a knot at zero the corner there, which is smaller in a smaller law.
    a = (0.4 if form.even else 0.8) / span**form.power

    def law(u):
        return a * form.shape(u, *places)

    formulas = found(law, "rad" if form.angle else "m/s", low, span)
    (own,) = [each for each in formulas if each.text == form.text]
    u = np.linspace(low, span, 19)
    for each in formulas:
        # Five knots cannot have a form to the last, so several errors of one reading of 40.
        assert np.ptp((each.at(u) - law(u))[np.abs(u) >= 0.1 * span]) < 5.0 * SD
        assert each.p_value >= 0.01
    # Less than two errors of a reading are between a root and what rises to its end.
    assert own is formulas[0] or form.text == "a sqrt(|u|)"
    off = np.array([own.a, *own.places]) - [a, *places]
    assert np.all(np.abs(off) < 4.0 * errors(form, low, span, a, places))


def test_a_law_that_no_form_follows_has_none():
    def waves(u):
        return 0.5 * np.cos(2.0 * np.pi * u / 0.01)

    assert found(waves, "m/s", 0.0, 0.02) == ()


def test_an_odd_law_over_both_signs_is_told_from_an_even_one():
    assert found(lambda u: 20.0 * u, "m/s", -0.02, 0.02)[0].text == "a u"
    assert found(lambda u: 0.4 * (u / 0.02) ** 2, "m/s", -0.02, 0.02)[0].text == "a u^2"


def test_a_sine_over_small_tilts_has_a_large_factor():
    # f reaches 0.26 at 0.3 rad: what would not surprise is the change over the range.
    best = found(lambda u: 3.0 * np.sin(u) ** 2, "rad", 0.0, 0.3)
    (sine,) = [each for each in best if each.text == "a sin(u)^2"]
    assert sine.a == pytest.approx(3.0, rel=0.15)


def test_a_corner_over_tilts_of_both_signs_is_that_of_a_sine():
    best = found(lambda u: 1.2 * np.abs(np.sin(u)), "rad", -0.3, 0.3)
    assert best[0].text == "a |sin(u)|"
    assert "a |u|" not in [each.text for each in best]


def test_an_argument_far_from_zero_is_counted_from_the_lower_end():
    best = found(lambda u: 0.03 * (u - 290.0), "K", 290.0, 310.0)[0]
    assert (best.text, best.origin) == ("a u", 290.0)
    # With the level free, 40 readings over 20 K have the slope within 0.02 / (5.8 sqrt(40)) = 2 %.
    assert best.a == pytest.approx(0.03, rel=0.06)
    assert best.at(np.array([300.0])) == pytest.approx(0.3, rel=0.06)


def test_a_formula_has_the_constant_of_its_own_fit():
    best = found(lambda u: 0.5 * np.exp(-u / 0.005), "m/s", 0.0, 0.02, "level")[0]
    assert best.text == "a exp(-|u| / b)"
    # The level alone is seen at high speeds.
    assert best.without == pytest.approx(LEVEL, abs=3.0 * SD)
