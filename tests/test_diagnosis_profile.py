"""Chi-square along a parameter: how sure a size is, and where a fit goes that can be better."""

import math

import numpy as np
import pytest

from line_model import SD, WAVE, X, fitted, problem
from stickslip.diagnosis.fit.fit_result import Start, make_candidate
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.fit.profile_likelihood import Profile, moved_to_profile_minimum, profile


def test_the_profile_of_a_small_effect_has_the_curvature_of_the_fit():
    given = problem(X + 0.1 * np.sin(4 * X))
    fit = fitted(given, [WAVE])
    (found,) = profile(given, fit)
    # d value / d u at a small amplitude is the scale over sinh 1.
    expected = math.sqrt(fit.covariance[1, 1]) / math.sinh(1.0)
    # Straight lines between points half a standard deviation apart: within a tenth.
    assert found.sd == pytest.approx(expected, rel=0.1)
    assert found.chi2.min() == 0.0


def test_the_profile_sees_steps_that_the_curvature_does_not():
    def stepped(_, p):
        return p[:, :1] * X + np.round(5.0 * p[:, 1:2]) / 5.0 * np.sin(4 * X) * 3.0

    given = problem(X + 0.6 * np.sin(4 * X), predict=stepped)
    fit = fitted(given, [WAVE])
    (found,) = profile(given, fit)
    # All heights within half a step of the best one are as good, so the interval is at least 0.1
    # wide on each side of a step's middle.
    assert found.sd > 0.05


def two_valleys(_, p):
    """A height that hurts below 0, between 0 and 0.5 and above 1, and else shows nothing."""
    height = p[:, 1:2]
    ridge = 12.0 * np.sin(2.0 * math.pi * np.clip(height, 0.0, 0.5)) ** 2
    beyond = 8.0 * (np.minimum(height, 0.0) + np.maximum(height - 1.0, 0.0))
    return p[:, :1] * X + SD * (ridge + beyond) / math.sqrt(len(X)) * np.cos(9 * X)


def fitted_from_nothing(given):
    candidate = make_candidate(given, [WAVE])
    (fit,) = fit_candidates(given, [candidate], [[Start(np.zeros(given.size))]], 20)
    assert abs(given.physical(fit.x[None, :])[0, 1]) < 0.2
    return fit


def test_the_error_of_a_size_includes_a_second_local_minimum():
    given = problem(X, predict=two_valleys)
    (found,) = profile(given, fitted_from_nothing(given))
    # Half the square of 12 in the middle of the ridge.
    assert np.any((found.chi2 > 9.0) & (found.value > 0.1) & (found.value < 0.4))
    # The prior alone takes 1 at a height of 1, where the wall begins, and the fit is near 0. Places
    # lie a half apart there, so the crossing is seen to within half of that.
    assert found.sd == pytest.approx(1.0, abs=0.25)


def test_the_fit_moves_to_a_lower_minimum_of_its_profile():
    def tilted(_, p):
        return two_valleys(None, p) + SD * p[:, 1:2] * np.sin(4 * X)

    given = problem(X + SD * np.sin(4 * X), predict=tilted)
    fit = fitted_from_nothing(given)
    better, (found,) = moved_to_profile_minimum(given, fit)
    # The wave's chi-square is about half the number of places; the prior takes 1 of it.
    assert fit.chi2 - better.chi2 == pytest.approx(0.5 * len(X) - 1.0, rel=0.3)
    assert given.physical(better.x[None, :])[0, 1] == pytest.approx(1.0, abs=0.2)
    # Further starts about it end there too.
    assert not fit.converged
    assert better.converged
    assert found.chi2.min() == 0.0


def test_the_value_of_the_fit_lies_within_its_interval():
    # The least chi-square is in a narrow minimum that has less evidence, and is no place to go.
    height = np.linspace(0.0, 1.0, 11)
    chi2 = np.where(height == 1.0, 0.0, 9.0 + 400.0 * (height - 0.2) ** 2)
    low, high = Profile("wave.size", "m", height, chi2, 0.1, best=0.2).interval(1.96**2)
    assert (low, high) == (0.2, 1.0)
    ends = Profile("wave.size", "m", height, chi2, 0.1, best=1.0).interval(1.96**2)
    assert 0.9 < ends[0] < ends[1] == 1.0
