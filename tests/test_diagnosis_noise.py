"""Noise of trials and set-ups: what is estimated, and that its p-values are what they say."""

import math

import numpy as np
import pytest

from line_model import X, line
from stickslip.diagnosis import Prior, Uncertain, diagnose_model
from stickslip.diagnosis.data.trial_noise import fit_noise
from stickslip.diagnosis.fit.goodness import lack_of_fit_p
from stickslip.facts import Code


def test_errors_that_set_ups_share_do_not_pull_a_fit_down():
    # All velocities of a set-up are off by the same share. The mean of the fitted slopes over many
    # data sets is the true one, within three standard errors.
    random = np.random.default_rng(8)
    slopes = []
    for seed in range(24):
        share = 1.0 + 0.1 * random.standard_normal(4)
        block = np.tile(np.arange(4), len(X))
        index = np.repeat(np.arange(len(X)), 4)
        values = X[index] * share[block] * (1.0 + 0.03 * random.standard_normal(len(index)))
        free = Uncertain("slope", Prior("log-uniform", 0.1, 10.0))
        found = diagnose_model(
            line, None, values, [free], condition=index, block=block, seed=seed
        ).findings
        slopes.append(float(free.prior.value(found.null.x[0])))
    error = np.std(slopes, ddof=1) / math.sqrt(len(slopes))
    assert abs(np.mean(slopes) - 1.0) < 3.0 * error
    assert error < 0.02


@pytest.mark.parametrize("signed", [True, False])
def test_a_set_up_that_is_faster_is_no_noise_whatever_the_direction(signed):
    # Both directions; set-ups scatter by 6 % as a gain or as a shift, trials by 3 %: twice a
    # trial's error, known to 0.3 from 24 set-ups.
    random = np.random.default_rng(3)
    level = (1.0 + np.arange(12)) * (-1.0) ** np.arange(12)
    index, block = np.repeat(np.arange(12), 24), np.tile(np.arange(24), 12)
    off = 0.06 * random.standard_normal(24)[block] * (level if signed else abs(level))[index]
    trials = level[index] + off + 0.03 * level[index] * random.standard_normal(len(index))
    noise = fit_noise(trials, index, block)
    assert noise.relative == pytest.approx(0.03, rel=0.2)
    found, other = noise.between, noise.between_gain
    if signed:
        found, other = other, found
    assert found == pytest.approx(2.0, abs=0.9)
    assert other < 0.3
    # The mean of two conditions that go opposite ways is off by a gain in opposite directions.
    shared = noise.covariance[0, 1]
    assert shared * (-1.0 if signed else 1.0) > 0.0


def test_an_empty_cell_of_a_set_up_leaves_the_others_known():
    # 24 set-ups that are off by 6 %, trials of 3 %: set-ups scatter by twice a trial's error. From
    # 24 of them that is known to 2 / sqrt(2 * 23) = 0.3.
    random = np.random.default_rng(12)
    index, block = np.repeat(np.arange(12), 24), np.tile(np.arange(24), 12)
    share = 1.0 + 0.06 * random.standard_normal(24)
    trials = (1.0 + index) * share[block] * (1.0 + 0.03 * random.standard_normal(len(index)))
    block = np.where(random.random(len(index)) < 0.2, -1, block)
    noise = fit_noise(trials, index, block)
    assert noise.between == pytest.approx(2.0, abs=0.9)
    assert noise.relative == pytest.approx(0.03, rel=0.2)


@pytest.mark.parametrize(
    ("block", "said"),
    [
        (None, Code.NO_BLOCK_COLUMN),
        (np.full(12, -1), Code.NO_BLOCK_COLUMN),
        (np.zeros(12, dtype=int), Code.ONE_BLOCK),
        (np.tile([0, 1, 2], 4), Code.SETUPS),
        (np.repeat([0, 1], 6), Code.SETUPS_NOT_CROSSED),  # each condition in one set-up
    ],
)
def test_a_scatter_of_set_ups_that_cannot_be_separated_is_reported(block, said):
    random = np.random.default_rng(4)
    index = np.repeat(np.arange(4), 3)
    trials = (1.0 + index) * (1.0 + 0.03 * random.standard_normal(12))
    assert [each.code for each in fit_noise(trials, index, block).notes] == [said]


def test_pure_noise_is_as_rare_as_its_p_value_says():
    # 4000 tables of 30 conditions, of which some are slower than the noise; three binomial standard
    # deviations above the rates of the F law. A mean variance is a little too large, so the rate of
    # 0.05 may be less by a third.
    random = np.random.default_rng(2)
    level = np.geomspace(3e-6, 3e-3, 30) * (-1.0) ** np.arange(30)
    sd, index = np.hypot(0.03 * level, 1e-5), np.repeat(np.arange(30), 3)
    p_values = []
    for _ in range(4000):
        trials = level[:, None] + sd[:, None] * random.standard_normal((30, 3))
        noise = fit_noise(trials.ravel(), index)
        chi2 = np.sum((noise.mean - level) ** 2 / np.diag(noise.covariance))
        p_values.append(lack_of_fit_p(float(chi2), 30, noise.dof))
    rates = {rate: np.mean(np.array(p_values) < rate) for rate in (0.001, 0.01, 0.05)}
    assert all(found < rate + 3.0 * math.sqrt(rate / 4000) for rate, found in rates.items())
    assert rates[0.05] > 0.05 / 1.5 - 3.0 * math.sqrt(0.05 / 4000)


@pytest.mark.parametrize("relative", [0.03, 0.035, 0.04])
def test_many_trials_tell_the_noise_as_well_as_they_can(relative):
    # 200 conditions of 20 trials tell the sd to 1 / sqrt(2 * 3800) = 1.1 %; four times that.
    random = np.random.default_rng(7)
    level = np.geomspace(2e-5, 2e-3, 200)
    sd = np.hypot(relative * level, 1e-5)
    trials = level[:, None] + sd[:, None] * random.standard_normal((200, 20))
    noise = fit_noise(trials.ravel(), np.repeat(np.arange(200), 20))
    assert np.median(noise.sd / sd) == pytest.approx(1.0, abs=0.046)
    assert noise.relative == pytest.approx(relative, rel=0.08)


def test_few_trials_make_the_noise_too_large_and_not_too_small():
    # Four conditions of two trials. Of one variance alone the mean is 4 / (4 - 2) = 2 times its
    # best estimate, 1.4 in sd, and the split in two parts adds to it. The median of 400 tables is
    # known to about 1.25 * 0.4 / sqrt(400) = 0.03.
    random = np.random.default_rng(10)
    level = np.geomspace(1e-4, 2e-3, 4)
    sd, index = np.hypot(0.03 * level, 1e-5), np.repeat(np.arange(4), 2)
    ratio = []
    for _ in range(400):
        trials = level[:, None] + sd[:, None] * random.standard_normal((4, 2))
        ratio.append(np.median(fit_noise(trials.ravel(), index).sd / sd))
    assert 1.3 < np.median(ratio) < 1.75


def test_trials_that_differ_only_by_rounding_do_not_give_the_noise():
    # A mean of three equal decimals is often off by its last bit.
    random = np.random.default_rng(8)
    for _ in range(20):
        level = np.round(random.uniform(1e-4, 1e-3, 6), 6)
        noise = fit_noise(np.repeat(level, 3), np.repeat(np.arange(6), 3), stated=0.03)
        assert noise.relative == 0.03


@pytest.mark.parametrize("setups", [False, True])
def test_zero_readings_are_excluded_from_the_noise_estimate(setups):
    # Readings of exactly zero, as below the resolution of a camera, have no scatter at all.
    random = np.random.default_rng(21)
    level = np.linspace(0.2e-3, 2e-3, 20)
    index = np.repeat(np.arange(20), 3)
    spread = np.hypot(1e-5, 0.03 * level)[index]
    trials = level[index] + spread * random.standard_normal(60)
    block = np.tile(np.arange(3), 20) if setups else None
    moving = fit_noise(trials, index, block)
    # Six that stand still, the first condition among them.
    still = np.repeat(np.array([0, 4, 9, 14, 21, 25]), 3)
    others = np.repeat(np.setdiff1d(np.arange(26), still), 3)
    both = fit_noise(
        np.concatenate([trials, np.zeros(18)]),
        np.concatenate([others, still]),
        None if block is None else np.tile(np.arange(3), 26),
    )
    # The same sums with zeros among them, which may be rounded otherwise.
    same = pytest.approx
    assert both.dof == moving.dof
    assert (both.floor, both.relative) == same((moving.floor, moving.relative), rel=1e-9)
    assert (both.between, both.between_gain) == same((moving.between, moving.between_gain))
    assert both.sd[still[::3]] == same(np.full(6, moving.floor), rel=1e-9)
    assert both.sd[others[::3]] == same(moving.sd, rel=1e-9)
    assert both.mean[still[::3]].tolist() == [0.0] * 6
    assert both.count.tolist() == [3] * 26
    np.linalg.cholesky(both.covariance)
    assert both.setups.shape == (26, 3 if setups else 0)


def test_with_few_nonzero_readings_the_stated_error_is_used():
    # Of three degrees of freedom where something moves, and many where nothing does.
    index = np.repeat(np.arange(9), 3)
    values = np.zeros(27)
    values[[0, 1, 2]] = 1e-3, 1.05e-3, 0.98e-3
    values[[24, 25, 26]] = -2e-3, -2.1e-3, -0.0
    noise = fit_noise(values, index, stated=0.05)
    assert noise.dof == 4.0
    lone = fit_noise(values[:24], index[:24], stated=0.05)
    # A tenth of the error of what moves.
    assert (lone.dof, lone.floor) == (math.inf, pytest.approx(0.1 * 0.05 * 1.01e-3))
    assert lone.sd[1:].tolist() == [lone.floor] * 7
