"""The engine's search, on models whose jumps, twins and best points are known."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip.diagnosis import Cause, CauseParameter, Prior, Uncertain, diagnose_model
from stickslip.diagnosis.data.trial_noise import whitener
from stickslip.diagnosis.fit.cause_pairs import beside_a_released_constant
from stickslip.diagnosis.fit.fit_result import Start, make_candidate
from stickslip.diagnosis.fit.least_squares import spread_factor
from stickslip.diagnosis.fit.multistart import LARGEST_INFLATION, fit_candidates
from stickslip.diagnosis.fit.single_cause import (
    distant_starts,
    quick_fits,
    refit_worse_than_null,
    search_near_leaders,
)
from stickslip.diagnosis.fit.start_points import sobol_scan
from stickslip.diagnosis.fit.view import View
from stickslip.diagnosis.inference import model_comparison
from stickslip.diagnosis.inference.cross_validation import folds, predictive_gain
from stickslip.diagnosis.inference.model_comparison import assess_baseline, explore, reweighed
from stickslip.diagnosis.model.prediction_cache import PredictionCache
from stickslip.diagnosis.model.problem import Problem

X = np.linspace(1.0, 3.0, 16)
SD = 0.05
SLOPE = Uncertain("slope", Prior("normal", 0.0, 1.0))


def problem(predict, observed, uncertain=(SLOPE,), causes=(), covariance=None):
    whiten = np.eye(len(observed)) / SD if covariance is None else whitener(covariance)
    return Problem(predict, None, observed, whiten, math.inf, tuple(uncertain), tuple(causes))


def test_the_weights_have_the_slope_of_the_loss():
    # Steps of Gauss-Newton are right only if d loss / d r = 2 w r.
    given = problem(lambda _, p: p[:, :1] * X, X).with_inflated_errors(1.0, 1.5)
    r, h = np.array([-4.0, -0.3, 0.0, 1.5, 9.0]), 1e-6
    slope = [(given.misfit(r + h * e) - given.misfit(r - h * e)) / (2 * h) for e in np.eye(5)]
    # Central differences of a smooth loss of size 10: rounding of 1e-15 * 10 / 1e-6.
    assert slope == pytest.approx(2.0 * given.weights(r) * r, abs=1e-7)


def test_without_a_bound_the_loss_is_least_squares():
    given = problem(lambda _, p: p[:, :1] * X, X)
    r = np.array([[3.0, -4.0], [0.0, 2.0]])
    assert given.misfit(r).tolist() == [25.0, 4.0]
    assert given.weights(r).tolist() == [[1.0, 1.0], [1.0, 1.0]]


def test_stages_with_inflated_errors_use_the_low_fidelity_model():
    given = Problem(
        lambda _, p: p[:, :1] * X, None, X, np.eye(len(X)) / SD, math.inf, (SLOPE,),
        low_fidelity=lambda _, p: p[:, :1] * X + 7.0,
    )  # fmt: skip
    at = np.zeros((1, 1))
    assert given.with_inflated_errors(3.0).predicted(at)[0].tolist() == [7.0] * len(X)
    assert given.with_inflated_errors(1.0, 1.5).predicted(at)[0].tolist() == [0.0] * len(X)


def test_no_prediction_is_made_twice():
    asked = []

    def square(_, p):
        asked.extend(p[:, 0].tolist())
        return np.hstack([p**2, np.where(p > 2.0, np.nan, 0.0)])

    remembered = PredictionCache(square, 2)
    first = remembered(None, np.array([[1.0], [3.0], [1.0]]))
    second = remembered(None, np.array([[3.0], [2.0]]))
    assert asked == [1.0, 3.0, 2.0]
    np.testing.assert_array_equal(first, [[1.0, 0.0], [9.0, np.nan], [1.0, 0.0]])
    np.testing.assert_array_equal(second, [[9.0, np.nan], [4.0, 0.0]])


def test_predictions_are_kept_for_the_conditions_that_they_were_made_for():
    remembered = PredictionCache(lambda x, p: p * x, 3)
    one, other = np.array([1.0, 2.0, 3.0]), np.array([5.0, 6.0, 7.0])
    at = np.array([[2.0]])
    np.testing.assert_array_equal(remembered(one, at), [[2.0, 4.0, 6.0]])
    np.testing.assert_array_equal(remembered(other, at), [[10.0, 12.0, 14.0]])
    np.testing.assert_array_equal(remembered(one, at), [[2.0, 4.0, 6.0]])


def test_the_least_recently_used_prediction_is_dropped_first():
    asked = []

    def twice(_, p):
        asked.extend(p[:, 0].tolist())
        return np.hstack([p, p])

    # Each prediction takes three numbers, its parameter and two observables: room for two.
    remembered = PredictionCache(twice, 2, most_values=7)
    for value in (1.0, 2.0, 1.0, 3.0, 1.0, 2.0):
        assert remembered(None, np.array([[value]])).tolist() == [[value, value]]
    assert asked == [1.0, 2.0, 3.0, 2.0]
    # More at once than there is room for are still given.
    many = np.arange(10.0)[:, None]
    np.testing.assert_array_equal(remembered(None, many), np.hstack([many, many]))


@pytest.mark.parametrize("edge", [0.004, -0.004])
def test_a_jump_is_not_taken_for_a_derivative(edge):
    # Beside the point, closer than any difference is wide, one condition jumps by 20 errors.
    def jumping(_, p):
        jump = np.where(np.sign(edge) * (p[:, :1] - edge) > 0.0, 20 * SD, 0.0)
        return p[:, :1] * X + jump * (np.arange(len(X)) == 5)

    given = problem(jumping, np.zeros(len(X)))
    fit = fit_candidates(given, [make_candidate(given)], [[Start(np.zeros(1))]], 0)[0]
    # The model is linear on this side of the jump, so its slope is exact to rounding.
    assert fit.slope[:, 0] == pytest.approx(X, rel=1e-9)


def test_a_jump_at_the_end_of_a_range_is_not_taken_for_a_derivative():
    # The amplitude cannot be negative, and beyond 0.004 one condition jumps by 20 errors.
    cause = Cause("bump", (CauseParameter("bump.size", "-", 0.0, 5.0, 1.0),))

    def jumping(_, p):
        jump = np.where(p[:, 1:2] > 0.004, 20 * SD, 0.0) * (np.arange(len(X)) == 5)
        return p[:, :1] * X + p[:, 1:2] * np.sin(X) + jump

    given = problem(jumping, np.zeros(len(X)), causes=[cause])
    fit = fit_candidates(given, [make_candidate(given, [cause])], [[Start(np.zeros(2))]], 0)[0]
    # At a small amplitude d value / d u is 1 / sinh 1, to a few parts in ten thousand.
    assert fit.slope[:, 1] == pytest.approx(np.sin(X) / math.sinh(1.0), rel=1e-2)


def test_a_difference_uses_the_side_that_can_be_computed():
    def cut(_, p):
        return np.where(p[:, :1] > 0.001, np.nan, p[:, :1] * X)

    given = problem(cut, np.zeros(len(X)))
    fit = fit_candidates(given, [make_candidate(given)], [[Start(np.zeros(1))]], 0)[0]
    assert fit.slope[:, 0] == pytest.approx(X, rel=1e-9)


def test_derivatives_that_are_taken_anew_are_followed_by_whole_steps():
    # The search begins with derivatives that point the wrong way. Two failures shrink its radius to
    # 0.04, and then new derivatives, exact on a line, promise the whole way of 1.7: to double the
    # radius from there would take six steps, from 1 it takes two.
    shapes = np.stack([X, X**2, np.sin(2 * X)])
    uncertain = [Uncertain(name, Prior("normal", 0.0, 1.0)) for name in "abc"]
    given = problem(lambda _, p: p @ shapes, np.array([1.0, -1.0, 1.0]) @ shapes, uncertain)
    start = Start(np.zeros(3), -shapes.T)
    found = fit_candidates(given, [make_candidate(given)], [[start]], 5)[0]
    # The linear answer, J'J + 1 being the normal matrix with the prior's rows.
    j = shapes.T / SD
    expected = np.linalg.solve(j.T @ j + np.eye(3), j.T @ j @ [1.0, -1.0, 1.0])
    assert found.x == pytest.approx(expected, abs=1e-3)


def test_a_search_gets_past_the_jump_of_a_condition():
    # One condition is off by 40 errors while the slope is below 0.78. It pulls the least squares of
    # that side down by 40 j_5 / J'J = 0.05, to where the walk stays; with Cauchy's loss it weighs
    # 700 times less, and the others lead on.
    truth, place = 0.8, 5

    def walled(_, p):
        wall = np.where(p[:, :1] < 0.78, 40 * SD, 0.0)
        return p[:, :1] * X + wall * (np.arange(len(X)) == place)

    given = problem(walled, truth * X)
    candidate, start = make_candidate(given), [Start(np.array([-1.0]))]
    plain = fit_candidates(given, [candidate], [start], 30)[0]
    assert plain.x[0] == pytest.approx(0.75, abs=0.01)
    found = quick_fits(given, [candidate], [start], 2)[0]
    j = X / SD
    # The linear answer beyond the jump: the prior pulls by truth / (J'J + 1).
    assert found.x[0] == pytest.approx(truth - truth / (j @ j + 1.0), abs=1e-3)


def test_a_suspected_constant_is_scanned_far_beyond_its_prior():
    other = Uncertain("other", Prior("normal", 0.0, 1.0))
    suspect = Cause("slope", (), "", relaxes_prior="slope")
    given = problem(lambda _, p: p[:, :1] * X, -6.0 * X, (SLOPE, other), (suspect,))
    points = sobol_scan(given, make_candidate(given, [suspect]), 128, 3)
    # 128 even points over 14 standard deviations: one lies within 14/128 of -6.
    assert points[0, 0] == pytest.approx(-6.0, abs=14 / 128)
    # The other constant keeps its prior: by chance one in a thousand is beyond 3.3.
    assert 0.8 < points[:, 1].std() < 1.2
    assert np.abs(points[:, 1]).max() < 3.3


def test_a_cause_is_scanned_with_all_constants():
    # The slope can make up for the product with the cause, so that only a scan of both sees it.
    push = Cause("push", (CauseParameter("push.height", "-", -5.0, 5.0, 1.0),))
    observed = 2.0 * np.sin(2 * X)
    given = problem(lambda _, p: p[:, :1] * X + p[:, 1:] * np.sin(2 * X), observed, causes=[push])
    best = sobol_scan(given, make_candidate(given, [push]), 128, 1)[0]
    # 128 points of a square of 5 x 5 lie 0.4 apart, and 2 is at asinh(2 sinh 1) = 1.59.
    assert np.hypot(best[0], best[1] - math.asinh(2.0 * math.sinh(1.0))) < 0.6
    alone = sobol_scan(given, make_candidate(given), 128, 1)
    assert not alone[:, 1].any()


def test_a_distant_start_is_the_best_sum_of_two_responses():
    # The model is a sum, so that the sums are exact, and eight of them are simulated.
    push = Cause("push", (CauseParameter("push.height", "-", -5.0, 5.0, 1.0),))
    asked = []

    def both(_, p):
        asked.append(len(p))
        return p[:, :1] * X + p[:, 1:] * np.sin(2 * X)

    given = problem(both, 3.0 * np.sin(2 * X) - 1.5 * X, causes=[push])
    null = fit_candidates(given, [make_candidate(given)], [[Start(np.zeros(2))]], 20)[0]
    scanned = sobol_scan(given, make_candidate(given), 128, 1)
    view, candidate = View.of(given, null), make_candidate(given, [push])
    asked.clear()
    ((start,),) = distant_starts(given, [view], [candidate], scanned)
    # The scanned points are asked for again, of which a diagnosis has kept the predictions.
    assert asked == [128, 8]
    every = np.array([[a, u] for a in scanned[:, 0] for u in view.sensitivities.amplitude])
    softer = given.with_inflated_errors(LARGEST_INFLATION)
    misfit = np.sum(softer.residuals(every) ** 2, axis=1) + np.sum(every**2, axis=1)
    assert start.x == pytest.approx(every[np.argmin(misfit)])


@pytest.mark.parametrize("searched", [True, False])
def test_a_cause_that_acts_far_from_the_recalibrated_constants_is_sought_all_over(
    searched, monkeypatch
):
    # A wave that the model has only at slopes near 0. Without it the slope is drawn to -0.4, where
    # the wave's response is exp(-16) of its height. The test without the search shows that it is
    # needed.
    if not searched:
        monkeypatch.setattr(model_comparison, "search_all_over", lambda _, fits, *a: tuple(fits))
    wave, bend = (
        Cause(name, (CauseParameter(f"{name}.height", "-", -9.0, 9.0, 1.0),))
        for name in ("wave", "bend")
    )

    def model(_, p):
        near = np.exp(-((p[:, :1] / 0.1) ** 2))
        return p[:, :1] * X + p[:, 1:2] * near * np.sin(2 * X) + p[:, 2:] * (X - 2.0) ** 2

    noise = SD * np.random.default_rng(1).standard_normal(len(X))
    slope = Uncertain("slope", Prior("normal", 0.0, 0.5), suspect=False)
    found = diagnose_model(
        model, X, 2.0 * np.sin(2 * X) + noise, [slope], [wave, bend], sd=np.full(len(X), SD)
    )
    assert slope.prior.value(found.findings.null.x[0]) == pytest.approx(-0.4, abs=0.03)
    assert ((found.verdict.kind, found.verdict.causes) == ("named", ("wave",))) is searched


def test_a_second_cause_begins_where_a_pulled_constant_was():
    # Wave and push are hidden; beside the wave alone the slope is pulled to the push's share.
    bend, wave = 0.1 * np.sin(5 * X), np.sin(2 * X)
    push = Cause("push", (CauseParameter("push.height", "-", -9.0, 9.0, 1.0),))
    other = Cause("wave", (CauseParameter("wave.height", "-", -9.0, 9.0, 1.0),))
    observed = 2.0 * (X + bend) + 1.0 * wave

    def model(_, p):
        return p[:, :1] * X + p[:, 1:2] * (X + bend) + p[:, 2:] * wave

    given = problem(model, observed, causes=[push, other])
    candidate = make_candidate(given, [other])
    single = fit_candidates(given, [candidate], [[Start(np.zeros(3))]], 20)[0]
    assert single.x[0] > 1.5
    begins = [start for key, start in beside_a_released_constant(given, single) if key[0] == "push"]
    closest = min(begins, key=lambda start: float(np.sum(given.residuals(start.x[None, :]) ** 2)))
    assert closest.x[0] == 0.0
    assert closest.x[2] == single.x[2]
    # Amplitudes of 2 in coordinates, 3.1 in height, are scaled by a factor of at least a half.
    assert 0.8 < math.sinh(closest.x[1]) / math.sinh(1.0) < 3.2
    # A freed constant is as far as it may be, and is the cause itself.
    slope = Cause("slope", (), relaxes_prior="slope")
    relaxed = replace(
        single, candidate=replace(make_candidate(given, [slope])), x=np.array([5.0, 0.0, 0.0])
    )
    assert beside_a_released_constant(given, relaxed) == []
    # A constant that is where its prior has it makes room for nothing.
    level = problem(model, 1.0 * wave, causes=[push, other])
    calm = fit_candidates(level, [candidate], [[Start(np.zeros(3))]], 20)[0]
    assert beside_a_released_constant(level, calm) == []


def test_a_cause_that_does_nothing_here_is_not_fitted():
    causes = [Cause(name, (CauseParameter(f"{name}.size", "-", -5, 5, 1.0),)) for name in "ab"]
    given = problem(lambda _, p: p[:, :1] * X + p[:, 1:2] * np.sin(4 * X), X, causes=causes)
    leader = fit_candidates(given, [make_candidate(given, causes[:1])], [[Start(np.zeros(3))]], 20)[
        0
    ]
    assert [fit.name for fit in search_near_leaders(given, [leader], [leader])] == ["a"]


def test_no_candidate_fits_worse_than_a_model_that_it_contains():
    # A walk that was stuck at 5 begins again where the model without a cause stands.
    suspect = Cause("slope", (), "", relaxes_prior="slope")
    given = problem(lambda _, p: p[:, :1] * X, 0.5 * X, causes=[suspect])
    null = fit_candidates(given, [make_candidate(given)], [[Start(np.zeros(1))]], 20)[0]
    stuck = fit_candidates(
        given, [make_candidate(given, [suspect])], [[Start(np.array([5.0]))]], 0
    )[0]
    assert stuck.chi2 > null.chi2
    (again,) = refit_worse_than_null(given, null, [stuck])
    assert again.chi2 < null.chi2


def test_a_fit_stays_converged_with_other_errors():
    # Found twice, then errors 1.5 times larger: the same place, and still found twice.
    given = problem(lambda _, p: p[:, :1] * X, 0.5 * X)
    starts = [Start(np.array([place])) for place in (-1.0, 2.0)]
    found = fit_candidates(given, [make_candidate(given)], [starts], 20)[0]
    assert found.converged
    (again,) = reweighed(given.with_inflated_errors(1.5), [found])
    assert again.converged
    j = X / (1.5 * SD)
    assert again.x[0] == pytest.approx(0.5 * (j @ j) / (j @ j + 1.0), abs=1e-3)


def test_the_spread_of_parameters_that_trade_off_has_a_factor():
    # J'J loses half of the digits: its inverse need not be positive definite, a factor still is.
    j = np.vstack([1e6 * np.ones((1, 3)), np.eye(3)])
    lower = spread_factor(j)
    across = np.array([1.0, -1.0, 0.0])
    # Along (1, -1, 0) only the prior's rows of 1 act: a variance of |across|^2.
    assert across @ lower @ lower.T @ across == pytest.approx(2.0, rel=1e-6)


def test_a_cause_that_acts_only_at_the_leaders_constants_is_found():
    # Without a cause the best constant is 0, where the second cause does nothing at all; at the
    # leader's constant of 1 it does what the leader does.
    h, g = np.zeros(16), np.zeros(16)
    h[0], g[0], g[1] = 1.0, -1.0, 5.0

    def twins(_, p):
        return p[:, :1] * h + (p[:, 1:2] + p[:, 2:3] * p[:, :1] ** 2) * g

    causes = [Cause(name, (CauseParameter(f"{name}.size", "-", -5, 5, 1.0),)) for name in "ab"]
    given = problem(twins, h + g, causes=causes)
    null = fit_candidates(given, [make_candidate(given)], [[Start(np.zeros(3))]], 20)[0]
    assert abs(null.x[0]) < 1e-6
    leader = fit_candidates(given, [make_candidate(given, causes[:1])], [[Start(np.zeros(3))]], 20)[
        0
    ]
    found = {fit.name: fit for fit in search_near_leaders(given, [leader], [leader])}
    assert set(found) == {"a", "b"}
    # Both reproduce the data; they differ in the prior's rows alone, which are 1 + 1.
    assert found["a"].data_chi2 < 0.1
    assert found["b"].data_chi2 < 0.1
    # Beside a third cause, which explains a part and leaves the constant at 0, only one of the two
    # can be seen; the other begins where that one has come to lead.
    push = Cause("c", (CauseParameter("c.size", "-", -1, 1, 1.0),))
    three = problem(
        lambda _, p: twins(_, p) + p[:, 3:] * np.eye(16)[1], h + g, causes=[*causes, push]
    )
    alone = fit_candidates(three, [make_candidate(three, [push])], [[Start(np.zeros(4))]], 20)[0]
    assert abs(alone.x[0]) < 1e-6
    assert {fit.name for fit in search_near_leaders(three, [alone], [alone])} == {"a", "c"}
    none = fit_candidates(three, [make_candidate(three)], [[Start(np.zeros(4))]], 20)[0]
    base = assess_baseline(three, np.eye(16), none, 0)
    _, explored = explore(base, np.eye(16), [alone], [alone], 0)
    last = {fit.name: fit for fit in explored}
    assert set(last) == {"a", "b", "c"}
    assert last["b"].data_chi2 < 0.1


@pytest.mark.parametrize(
    ("count", "group", "parts"), [(30, None, 5), (7, None, 0), (12, np.repeat([0, 1, 2], 4), 3)]
)
def test_every_condition_is_left_out_once(count, group, parts):
    found = folds(count, group)
    assert len(found) == parts
    if parts:
        assert sorted(np.concatenate(found).tolist()) == list(range(count))
        assert all(np.all(np.diff(part) == 1) for part in found)
    if group is not None:
        assert all(len(set(group[part])) == 1 for part in found)


@pytest.mark.parametrize("shared", [0.0, 0.1])
def test_the_predictive_density_is_that_of_a_normal_law(shared):
    # Of a linear model with normal priors all data are jointly normal, so the density of a part,
    # given the others, is that of the conditional law, whatever errors they share.
    wave = Cause("wave", (CauseParameter("wave.height", "-", -50, 50, 0.01),))
    random = np.random.default_rng(5)
    covariance = SD**2 * np.eye(len(X)) + shared**2
    observed = 0.7 * X + random.multivariate_normal(np.zeros(len(X)), covariance)

    # The coordinate of an amplitude is bent by sinh; its inverse makes the model linear in it.
    def straight(_, p):
        u = np.arcsinh(p[:, 1:2] / 0.01 * math.sinh(1.0)) if p.shape[1] > 1 else 0.0
        return p[:, :1] * X + 0.2 * u * np.sin(4 * X)

    given = problem(straight, observed, causes=[wave], covariance=covariance)
    fits = [
        fit_candidates(given, [make_candidate(given, each)], [[Start(np.zeros(2))]], 20)[0]
        for each in ([], [wave])
    ]
    parts = folds(len(X))
    found = predictive_gain(given, covariance, *fits, parts)

    def density(design):
        joint = covariance + design @ design.T
        total = 0.0
        for part in parts:
            keep = np.setdiff1d(np.arange(len(X)), part)
            gain = joint[np.ix_(part, keep)] @ np.linalg.inv(joint[np.ix_(keep, keep)])
            left = observed[part] - gain @ observed[keep]
            law = joint[np.ix_(part, part)] - gain @ joint[np.ix_(keep, part)]
            total -= 0.5 * left @ np.linalg.solve(law, left) + 0.5 * np.linalg.slogdet(law)[1]
        return total

    both = np.stack([X, 0.2 * np.sin(4 * X)], axis=1)
    # The fits stop when a step would gain less than 0.02 of chi-square.
    assert found == pytest.approx(density(both) - density(both[:, :1]), abs=0.05)
