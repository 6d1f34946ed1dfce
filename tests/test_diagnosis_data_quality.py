"""What makes the data itself suspect: rounding, set-ups that scatter, too few readings."""

import math

import numpy as np

from stickslip.diagnosis import Prior, Uncertain, diagnose_model
from stickslip.diagnosis.data.data_quality import (
    FEWEST_CONDITIONS,
    find_data_problem,
    uneven_setups,
)
from stickslip.diagnosis.data.trial_noise import fit_noise
from stickslip.facts import Code, Fact


def test_few_velocities_are_accepted_beside_other_data():
    values, index = np.array([1.0, 2.0]), np.arange(2)
    noise = fit_noise(values, index)
    few = find_data_problem(values, index, noise, None)
    assert few == Fact(Code.TOO_FEW_CONDITIONS, {"count": 2, "needed": FEWEST_CONDITIONS})
    assert find_data_problem(values, index, noise, None, alone=False) is None


def _trouble(trials):
    """What is said of trials of shape (conditions, trials)."""
    index = np.indices(trials.shape)[0].ravel()
    return find_data_problem(trials.ravel(), index, fit_noise(trials.ravel(), index), None)


def _uneven(trials):
    """What is said of trials of shape (conditions, set-ups)."""
    index, block = np.indices(trials.shape).reshape(2, -1)
    return uneven_setups(trials.ravel(), index, fit_noise(trials.ravel(), index, block), block)


def test_readings_rounded_more_than_their_scatter_are_a_problem():
    # Steps of three standard deviations leave most trials alike; of half of one a share of 0.14.
    random = np.random.default_rng(5)
    level = np.linspace(1e-4, 1e-3, 20)[:, None]
    trials = level + 1e-5 * random.standard_normal((20, 3))
    assert _trouble(3e-5 * np.round(trials / 3e-5)).code is Code.ROUNDED
    assert _trouble(5e-6 * np.round(trials / 5e-6)) is None


def test_a_set_up_with_larger_scatter_is_distinguished_from_heavy_tails():
    # What is left of a trial beside the mean of its condition's four: of the one that scatters four
    # times as much sqrt(9 + 3 / 16) = 3, of the others sqrt(9 / 16 + 2 / 16 + 1) = 1.3. Where all
    # scatter alike, with Student's four degrees of freedom, 0.002 of tables may be blamed.
    random = np.random.default_rng(6)
    level = np.linspace(1e-4, 1e-3, 60)[:, None]
    blamed = 0
    for _ in range(40):
        trials = level * (1.0 + 0.03 * random.standard_t(4, (60, 4)))
        blamed += _uneven(trials) is not None
    assert blamed <= 1
    trials = level * (1.0 + 0.03 * random.standard_normal((60, 4)) * np.array([1, 1, 4, 1]))
    assert _uneven(trials).fields["setup"] == 3


def test_set_ups_with_different_numbers_of_trials_are_accepted():
    # A trial that is alone in its condition or set-up lies on its mean whatever its error.
    random = np.random.default_rng(9)
    level = np.linspace(1e-4, 1e-3, 30)
    every, some = np.arange(30), np.repeat(np.arange(0, 24, 2), 3)
    once_then_thrice = np.concatenate([every, some]), np.repeat([0, 1], [30, 36])
    index, block = np.indices((30, 3)).reshape(2, -1)
    half_empty = index, np.where(random.random(90) < 0.5, -1, block)
    blamed = 0
    for _ in range(40):
        for at, setup in (once_then_thrice, half_empty):
            values = level[at] * (1.0 + 0.03 * random.standard_normal(len(at)))
            noise = fit_noise(values, at, setup)
            blamed += uneven_setups(values, at, noise, setup) is not None
    assert blamed <= 1


def test_zero_readings_neither_hide_an_uneven_set_up_nor_give_a_drift():
    # More conditions stand still than move: medians over all of them would be theirs.
    random = np.random.default_rng(14)
    level = np.concatenate([np.linspace(1e-4, 1e-3, 60), np.zeros(80)])[:, None]
    trials = level * (1.0 + 0.03 * random.standard_normal((140, 4)) * np.array([1, 1, 4, 1]))
    assert _uneven(trials).fields["setup"] == 3
    # Still conditions in a row at the end know nothing of time, and count as no degrees of freedom.
    blamed = 0
    index = np.repeat(np.arange(24), 3)
    for _ in range(500):
        order = np.concatenate([random.permutation(24), np.arange(24, 72)])
        trials = np.linspace(1e-4, 1e-3, 8)[:, None] * (1.0 + 0.03 * random.standard_normal((8, 3)))
        values = np.concatenate([trials.ravel(), np.zeros(48)])
        blamed += find_data_problem(values, index, fit_noise(values, index), order) is not None
    # 0.002 of 500 tables is one; more than six come once in 1e4 such studies.
    assert blamed <= 6


def test_rounding_is_accepted_if_the_error_is_stated():
    x = np.linspace(1.0, 3.0, 12)
    level = 0.1 * np.round(10.0 * np.repeat(x, 3))
    found = diagnose_model(
        lambda x, p: p[:, :1] * x, x, level + 0.1 * (np.arange(36) == 5),
        [Uncertain("slope", Prior("normal", 1.0, 0.1))],
        condition=np.repeat(np.arange(12), 3), sd=0.1 / math.sqrt(12.0),
    ).findings  # fmt: skip
    assert found.verdict.kind == "none"
