"""The band of a law of a free shape: what the data leave open of it."""

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import multivariate_normal, norm

from stickslip import Drive, Scenario
from stickslip.diagnosis import Cause, CauseParameter, Prior, Uncertain
from stickslip.diagnosis.fit.fit_result import Fitted, Start, free_parameters, make_candidate
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.inference.between_knots import covariance_between_knots
from stickslip.diagnosis.inference.law_posterior import linear_draws, posterior_draws
from stickslip.diagnosis.inference.law_prior import with_learned_prior
from stickslip.diagnosis.inference.simultaneous_band import simultaneous_band
from stickslip.diagnosis.model.free_shapes import HOOKS, curve_design
from stickslip.diagnosis.model.problem import Problem

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=8)).replace({"solver.rtol": 1e-6})
HOOK = {hook.effect: hook for hook in HOOKS}
SIZE = 0.5


def test_a_smooth_law_lies_about_its_curve_as_far_as_is_said():
    # Laws drawn from the processes that are averaged over, which normal bands of 90 % must hold.
    hook, span, sd = HOOK["free_drag_speed"], 0.01, 0.01
    argument = np.linspace(0.0, span, 61)
    design = curve_design(BASE, hook, span, argument)
    project, covariance = np.linalg.pinv(design), sd**2 * np.eye(5)
    random = np.random.default_rng(1)
    held, without = [], []
    for length, size in itertools.product((0.15, 0.3, 0.6, 1.5), (0.1, 0.5, 2.0)):
        distance = (argument[:, None] - argument) / span
        process = size**2 * np.exp(-0.5 * (distance / length) ** 2)
        for _ in range(10):
            law = random.multivariate_normal(np.zeros(61), process, method="svd")
            knots = project @ law + sd * random.standard_normal(5)
            between = covariance_between_knots(argument, design, knots, covariance, 0.3)
            of_knots = np.sum((design @ covariance) * design, axis=1)
            off = np.abs(law - design @ knots)
            held.append(np.mean(off < 1.645 * np.sqrt(of_knots + np.diag(between))))
            without.append(np.mean(off < 1.645 * np.sqrt(of_knots)))
    # Points of a law go together: of 120 laws the mean has a deviation of about 0.02.
    assert np.mean(held) == pytest.approx(0.9, abs=0.05)
    assert np.mean(without) < 0.8


def test_a_law_may_be_as_large_where_nothing_is_known_as_it_is_elsewhere():
    # Of knots that are seen by themselves, y = k + noise, everything is known in closed form: with
    # a prior covariance C of k, y has C + sd^2, and k the mean C (C + sd^2)^-1 y.
    size, y, sd = 0.3, np.array([0.9, -1.2, 1.5, 0.0]), np.array([0.1, 0.2, 0.1, 30.0])
    parameters = [CauseParameter(f"k{i}", "-", -9.0, 9.0, size) for i in range(4)]

    def slope(p, x):
        return size * np.cosh(x) / np.sinh(1.0)

    # Where the fit ends: the derivative of its chi-square by the coordinate is zero.
    x = [
        brentq(lambda u, p=p, a=a, b=b: (a - p.value(u)) / b**2 * slope(p, u) - u, -9.0, 9.0)
        for p, a, b in zip(parameters, y, sd, strict=True)
    ]
    g = np.array([slope(p, u) for p, u in zip(parameters, x, strict=True)])
    fit = SimpleNamespace(x=np.array(x), covariance=np.diag(1.0 / ((g / sd) ** 2 + 1.0)))
    knots = [Fitted(p, i, i) for i, p in enumerate(parameters)]
    shift, covariance = with_learned_prior(fit, [], knots, size)
    weights, means, squares = [], [], []
    place = np.linspace(0.0, 1.0, 4)
    for factor, length in itertools.product(np.geomspace(1.0, 10.0, 7), (1e-3, 0.25, 0.5)):
        prior = (factor * size) ** 2 * np.exp(-0.5 * ((place[:, None] - place) / length) ** 2)
        total = prior + np.diag(sd**2)
        likely = -0.5 * (y @ np.linalg.solve(total, y) + np.linalg.slogdet(total)[1])
        weights.append(np.exp(likely - 0.5 * np.log(factor) ** 2))
        means.append(prior @ np.linalg.solve(total, y))
        inside = prior - prior @ np.linalg.solve(total, prior)
        squares.append(inside + np.outer(means[-1], means[-1]))
    mean = np.average(means, axis=0, weights=weights)
    expected = np.average(squares, axis=0, weights=weights) - np.outer(mean, mean)
    at = np.array([p.value(u) for p, u in zip(parameters, x, strict=True)])
    # The fit's slopes are differences over 0.02 of a coordinate: right to 2e-5.
    assert at + shift == pytest.approx(mean, abs=1e-3)
    assert covariance == pytest.approx(expected, abs=1e-3)
    # The knot that nothing is known of may be about as large as the others.
    assert np.sqrt(covariance[3, 3]) > 2.0 * size


def test_a_band_holds_a_whole_curve_with_its_probability():
    # Of independent points the largest deviation has a law of its own, of equal ones that of one.
    # The quantile of 4000 draws has a standard deviation of at most 0.023, a sd one of 1.1 %.
    random = np.random.default_rng(3)
    for count in (1, 5, 40):
        one = norm.ppf(0.5 + 0.5 * 0.9 ** (1.0 / count))
        sizes = np.linspace(1e-3, 2.0, count)
        mean, sd, reach = simultaneous_band(
            7.0 + sizes * random.standard_normal((4000, count)), 0.9
        )
        assert mean == pytest.approx(7.0, abs=4.0 * 2.0 / np.sqrt(4000))
        assert sd == pytest.approx(sizes, rel=0.05)
        assert reach == pytest.approx(one, abs=0.08)
        equal = 1e-6 * np.tile(random.standard_normal((4000, 1)), count)
        assert simultaneous_band(equal, 0.9)[2] == pytest.approx(norm.ppf(0.95), abs=0.07)
    # A point that is known for sure is no deviation.
    known = np.column_stack([np.ones(4000), random.standard_normal(4000)])
    assert simultaneous_band(known, 0.9)[2] == pytest.approx(norm.ppf(0.95), abs=0.07)
    assert simultaneous_band(np.ones((4000, 2)), 0.9)[2] == 0.0


def test_where_a_law_is_zero_for_sure_nothing_lies_about_its_curve():
    hook, span = HOOK["free_friction_speed"], 0.01
    argument = np.linspace(0.0, span, 61)
    design = curve_design(BASE, hook, span, argument)
    knots = np.array([0.3, -0.1, 0.4, 0.1, 0.2])
    between = np.diag(covariance_between_knots(argument, design, knots, 1e-4 * np.eye(5), 0.3))
    assert between[0] == pytest.approx(0.0, abs=1e-12)
    assert between[3] > 1e-5


def fitted(predict, observed, sd, constants=1, knots=3):
    """A problem of some constants and knots, of which the first constant is the law's own."""
    law = tuple(CauseParameter(f"law.{i}", "-", -9.0, 9.0, SIZE) for i in range(knots))
    known = tuple(Uncertain(f"constant.{i}", Prior("normal", 1.0, 0.3)) for i in range(constants))
    given = Problem(
        predict, None, observed, np.eye(len(observed)) / sd, math.inf, known, (Cause("law", law),)
    )
    candidate = make_candidate(given, given.causes)
    fit = fit_candidates(given, [candidate], [[Start(np.zeros(given.size))]], 40)[0]
    free = free_parameters(given, fit)
    return given, fit, free[:1], free[constants:], SIZE


def priors(knots=3):
    """Weight and covariance of the normal priors of the knots that are averaged over."""
    place = np.linspace(0.0, 1.0, knots)
    for factor, length in itertools.product(np.geomspace(1.0, 10.0, 7), (1e-3, 0.25, 0.5)):
        alike = np.exp(-0.5 * ((place[:, None] - place) / length) ** 2)
        yield np.exp(-0.5 * np.log(factor) ** 2), (factor * SIZE) ** 2 * alike


# A walker forgets its place after some ten steps, so that all draws tell as much as 300: their mean
# is right to 0.06 sd, and their sd to 4 %. They have to be as near as four times that.
MEAN, SPREAD = 0.23, 0.16


@pytest.mark.parametrize(("constants", "knots"), [(1, 3), (9, 5), (20, 5), (16, 9)])
def test_the_posterior_of_a_linear_model_is_normal_for_each_prior(constants, knots):
    free = constants + knots
    random, sd, count = np.random.default_rng(5), 0.4, free + 10
    design = random.standard_normal((count, free))
    # Of two knots the data tell little.
    design[:, [constants, constants + 2]] *= 0.05
    middle = np.concatenate([np.ones(constants), np.zeros(knots)])
    truth = middle + np.where(middle > 0.0, 0.3, 0.8) * random.standard_normal(free)
    y = design @ truth + sd * random.standard_normal(count)
    given = fitted(lambda _, p: p @ design.T, y, sd * np.ones(count), constants, knots)
    weights, means, squares = [], [], []
    for weight, prior in priors(knots):
        before = 0.3**2 * np.eye(free)
        before[constants:, constants:] = prior
        total = design @ before @ design.T + sd**2 * np.eye(count)
        off = y - design @ middle
        weights.append(weight * multivariate_normal.pdf(off, cov=total))
        gain = before @ design.T @ np.linalg.inv(total)
        means.append(middle + gain @ off)
        squares.append(np.diag(before - gain @ design @ before) + means[-1] ** 2)
    mean = np.average(means, axis=0, weights=weights)
    spread = np.sqrt(np.average(squares, axis=0, weights=weights) - mean**2)
    asked = [0, *range(constants, free)]
    for draws in (linear_draws(*given[1:]), posterior_draws(*given)):
        off = (np.mean(draws, axis=0) - mean[asked]) / spread[asked]
        assert off == pytest.approx(np.zeros(1 + knots), abs=MEAN)
        assert np.std(draws, axis=0) == pytest.approx(spread[asked], rel=SPREAD)


def test_draws_of_a_law_are_within_the_limits_of_its_knots():
    # A law that nothing is known of: most draws about the fit are beyond a limit.
    limit, knots = 0.4, tuple(CauseParameter(f"law.{i}", "-", -0.4, 0.4, 0.3) for i in range(9))
    given = Problem(
        lambda _, p: p[:, :1] + 1e-3 * p[:, 1:2], None, np.ones(2), np.eye(2), math.inf,
        (Uncertain("constant", Prior("normal", 1.0, 0.3)),), (Cause("law", knots),),
    )  # fmt: skip
    candidate = make_candidate(given, given.causes)
    fit = fit_candidates(given, [candidate], [[Start(np.zeros(given.size))]], 10)[0]
    own, *free = free_parameters(given, fit)
    about = linear_draws(fit, [own], free, 0.3)[:, 1:]
    assert np.mean(np.all(np.abs(about) < limit, axis=1)) < 0.2
    draws = posterior_draws(given, fit, [own], free, 0.3)[:, 1:]
    assert np.all(np.abs(draws) < limit * (1.0 + 1e-9))
    # Level between the limits but for the prior, which makes the middle likelier: a uniform law has
    # a standard deviation of 0.58 limits.
    assert np.all((np.std(draws, axis=0) > 0.4 * limit) & (np.std(draws, axis=0) < 0.6 * limit))


def test_the_posterior_follows_what_the_data_leave_open_where_it_is_curved():
    # Products of the constant and the law are seen, so that the two lie on a hyperbola. What is
    # asked is integrated over the constant: given it, the knots are known so well that their prior
    # is level over them.
    seen, sd = np.array([1.6, 1.0, 0.7]), 0.03
    given = fitted(lambda _, p: p[:, :1] * (1.0 + p[:, 1:]), seen, sd * np.ones(3))
    linear, sampled = linear_draws(*given[1:]), posterior_draws(*given)
    constant = np.linspace(0.15, 2.5, 801)
    knots = seen / constant[:, None] - 1.0
    prior = sum(weight * multivariate_normal.pdf(knots, cov=cov) for weight, cov in priors())
    weight = norm.pdf(constant, 1.0, 0.3) * prior / constant**3
    mean = np.average(knots, axis=0, weights=weight)
    spread = np.sqrt(np.average((knots - mean) ** 2, axis=0, weights=weight))
    off = (np.mean(sampled[:, 1:], axis=0) - mean) / spread
    assert off == pytest.approx(np.zeros(3), abs=MEAN)
    assert np.std(sampled[:, 1:], axis=0) == pytest.approx(spread, rel=SPREAD)
    # The linear model misses how much larger the knots are where the constant is small.
    assert np.all(np.mean(linear[:, 1:], axis=0) < mean - 0.3 * spread)
