"""Formulas of a law: the form that made the data is found, or none is claimed."""

import numpy as np
import pytest

from stickslip.diagnosis.decision.formulas import _FORMS, Formula, formula
from stickslip.diagnosis.terms.laws import free_law
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.scenario.uncertain import Prior

SD, LEVEL, READINGS = 0.02, 1.5, 40


def drawn(law, unit="m/s", low=0.0, high=0.02, seed=4, sd=SD):
    """Curve, its points, mean and covariance from data, beside a level that is free too.

    The model is linear in the level and the knots, so that their posterior is normal under each of
    the curve's priors.
    """
    curve = free_law("force", "speed", unit, low, high, size=0.3, law_unit="N").curve
    # Between 0 and the next knot no curve has the cusp of a root.
    at = np.linspace(low, high, READINGS + 4)[4:]
    y = LEVEL + law(at) + sd * np.random.default_rng(seed).standard_normal(READINGS) - 1.0
    design = np.column_stack([np.ones(READINGS), curve.design(at)]) / sd
    logs, means, covariances = [], [], []
    for precision in curve.precisions():
        prior = np.zeros((6, 6))
        prior[0, 0], prior[1:, 1:] = 1.0 / 5.0**2, precision / 0.3**2
        covariance = np.linalg.inv(design.T @ design + prior)
        mean = covariance @ design.T @ y / sd
        misfit = np.sum((y / sd - design @ mean) ** 2) + mean @ prior @ mean
        logs.append(0.5 * (np.linalg.slogdet(prior)[1] + np.linalg.slogdet(covariance)[1] - misfit))
        means.append(mean)
        covariances.append(covariance)
    share = np.exp(np.array(logs) - max(logs))
    share /= share.sum()
    mean = share @ np.array(means)
    apart = np.array(means) - mean
    covariance = np.tensordot(share, covariances, 1) + (apart.T * share) @ apart
    u = np.linspace(low, high, 61)
    knots = curve.design(u)
    return u, knots @ mean[1:], knots @ covariance[1:, 1:] @ knots.T, curve


def errors(form, low, span, a, places):
    """Standard deviations of a factor and its places, where the level is free too."""
    at, step = np.linspace(low, span, 44)[4:], 1e-4 * span
    moved = [
        [a * form.shape(at, *(np.array(places) + by * row)) for by in (step, -step)]
        for row in np.eye(len(places))
    ]
    slopes = [(more - less) / (2.0 * step) for more, less in moved]
    jacobian = np.stack([np.ones(READINGS), form.shape(at, *places), *slopes], axis=1)
    return SD * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))[1:]


@pytest.mark.parametrize("form", _FORMS[1:], ids=lambda form: form.text)
def test_a_formula_that_is_claimed_is_that_of_the_data(form):
    span, unit = (1.2, "rad") if form.of_angles else (0.02, "m/s")
    low, places = -span if form.even else 0.0, [0.4 * span, 0.5 * span][: form.places]
    a = (0.4 if form.even else 0.8) / span**form.power

    def law(u):
        return a * form.shape(u, *places)

    claims = [formula(*drawn(law, unit, low, span, seed)) for seed in (4, 5, 6)]
    claims = [each for each in claims if each is not None]
    for found in claims:
        # A level less a form is as good as the form.
        assert form.text in (found.text, *found.others)
        u = np.linspace(low, span, 19)
        assert np.ptp((found.at(u) - law(u))[np.abs(u) >= 0.1 * span]) < 5.0 * SD
        if form.text == found.text:
            values, sd = np.transpose(list(found.parameters.values()))
            expected = errors(form, low, span, a, places)
            # The errors are those of the data, and what knots leave of the form beside.
            assert np.all(sd > 0.8 * expected)
            assert np.all(sd < 4.0 * expected)
            assert np.all(np.abs(values - [a, *places]) < 4.0 * sd)
    # Roots and logarithms look like what levels off slowly.
    alike = ("a sqrt(|u|)", "a ln(1 + |u| / b)", "a u / (b + |u|)", "a (1 - exp(-|u| / b))")
    assert claims or form.text in alike


BOTH, ANGLES = {"low": -0.02}, {"unit": "rad", "low": -0.3, "high": 0.3}


@pytest.mark.parametrize(
    ("law", "given", "text"),
    [
        (lambda u: 40.0 * u, {}, "a u"),
        (lambda u: 0.8 * (u / 0.02) ** 2, {}, "a u^2"),
        (lambda u: 0.8 * np.exp(-((u - 0.01) ** 2) / 0.005**2), {}, "a exp(-((|u| - b) / c)^2)"),
        # An odd law over both signs is told from an even one; angles have sines for a corner.
        (lambda u: 20.0 * u, BOTH, "a u"),
        (lambda u: 20.0 * np.abs(u), BOTH, "a |u|"),
        (lambda u: 1.2 * np.abs(np.sin(u)), ANGLES, "a |sin(u)|"),
        # No form follows it.
        (lambda u: 0.5 * np.cos(2.0 * np.pi * u / 0.01), {}, None),
        # Forms of different shape tie; with a tenth of the noise a line levels off no longer.
        (lambda u: 0.3 * np.sqrt(u / 0.02), {"sd": 0.03}, None),
        (lambda u: 0.3 * u / 0.02, {"sd": 0.003}, "a u"),
    ],
)
def test_forms_that_are_unlike_all_others_are_claimed(law, given, text):
    found = formula(*drawn(law, **given))
    assert (found and found.text) == text
    if found is not None:
        assert 0.01 <= found.p_value <= 1.0
    if given is ANGLES:
        assert "a |u|" not in found.others
        a, sd = found.parameters["a"]
        assert abs(a - 1.2) < 4.0 * sd


def test_an_argument_far_from_zero_is_counted_from_the_lower_end():
    found = formula(*drawn(lambda u: 0.03 * (u - 290.0), "K", 290.0, 310.0))
    assert (found.text, found.origin) == ("a u", 290.0)
    # With the level free, 40 readings over 20 K have the slope within 0.02 / (5.8 sqrt(40)) = 2 %.
    a, sd = found.parameters["a"]
    assert a == pytest.approx(0.03, rel=0.06)
    assert 0.01 < sd / a < 0.06
    assert found.at(np.array([300.0])) == pytest.approx(0.3, rel=0.06)
    curve = free_law("force", "heat", "K", 290.0, 310.0, law_unit="N").curve
    assert found.in_words(curve).startswith("f of force = a u with a = 0.0")
    assert found.in_words(curve).endswith(" N per K")


def test_a_formula_has_the_constant_as_stated():
    # The data know the law c (1 + f), and c itself hardly: as c grows by d, f falls by (1 + f) d/c.
    curve = free_law("friction", "speed", "m/s", 0.0, 2.0, factor_of="mu").curve
    u = np.linspace(0.0, 2.0, 61)
    truth, c, d = 0.5 * np.exp(-u / 0.5), 0.3, 0.03
    joint = np.append(-(1.0 + truth) / c, 1.0)
    mean = np.append(truth, c) + d * joint
    knots = curve.design(u)
    covariance = (2.0 * d) ** 2 * np.outer(joint, joint)
    covariance[:-1, :-1] += 1e-4 * knots @ knots.T
    mu = Parameter("mu", Prior("normal", c, 0.01))
    found = formula(u, mean, covariance, curve, mu)
    # A level that is known leaves no other form.
    assert (found.text, found.others) == ("a exp(-|u| / b)", ())
    # What is stated and what the data say of c weigh as the inverse squares of 0.01 and 0.06; the
    # form of f, which is 0 at its end, tells c as well as f, to 0.3 times 0.01.
    assert found.without == pytest.approx(c + d / 37.0, abs=0.003)
    for (value, sd), expected in zip(found.parameters.values(), (0.5, 0.5), strict=True):
        assert abs(value - expected) < 4.0 * sd
    # Of a constant that is not stated, the same curve leaves the level open, and so its form.
    loose = formula(u, mean, covariance, curve, Parameter("mu", Prior("normal", c, 10.0)))
    assert loose is None or loose.others


def test_curves_of_three_knots_have_forms_of_one_number_or_two():
    curve = free_law("force", "speed", "m/s", 0.0, 2.0, knots=3).curve
    u = np.linspace(0.0, 2.0, 61)
    knots = curve.design(u)
    found = formula(u, knots @ [0.0, 0.1, 0.2], 1e-6 * knots @ knots.T, curve)
    assert found.text == "a u"
    assert found.parameters["a"] == (pytest.approx(0.1), pytest.approx(0.0018, rel=0.5))


@pytest.mark.parametrize(
    ("text", "law", "unit", "own", "factor", "said"),
    [
        ("a exp(-|u| / b)", "friction", "m/s", "-", "mu",
         "friction = 0.3 (1 + a exp(-|u| / b)) with a = 0.5 ± 0.02, b = 0.25 ± 0.1 m/s"),
        ("a sqrt(|u|)", "drag", "rad", "-", "mu",
         "drag = 0.3 (1 + a sqrt(|u|)) with a = 0.5 ± 0.02 per rad^0.5"),
        ("a u^2", "wind", "m/s", "uN", None,
         "f of wind = a u^2 with a = 0.5 ± 0.02 uN per (m/s)^2"),
        ("a u", "wind", "-", "uN", None, "f of wind = a u with a = 0.5 ± 0.02 uN"),
    ],
)  # fmt: skip
def test_a_formula_is_said_with_its_numbers_and_units(text, law, unit, own, factor, said):
    curve = free_law(law, "speed", unit, 0.0, 1.0, law_unit=own, factor_of=factor).curve
    numbers = {"a": (0.5, 0.02)} | ({"b": (0.25, 0.1)} if "b" in text else {})
    assert Formula(text, numbers, 0.0, 0.3, 0.5, ()).in_words(curve) == said
