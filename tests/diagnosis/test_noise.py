"""The restricted likelihood of any design, beside matrices and a grid."""

import math

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.special import ndtr

from stickslip.diagnosis.data.errors import estimate
from stickslip.diagnosis.data.noise import Noise, along, averaged, whitener


def one_way(blocks, each, seed):
    """Readings of one level in blocks that share an error of twice that of a reading."""
    random = np.random.default_rng([80, seed])
    block = np.repeat(np.arange(blocks), each)
    y = 2.0 * random.standard_normal(blocks)[block] + random.standard_normal(len(block))
    ones, own = csr_array(np.ones((len(y), 1))), np.eye(blocks)
    return y, Noise(
        y, ones, np.zeros(len(y), dtype=int), np.array([len(y) - 1]), np.full(len(y), np.inf),
        shared={"shift": (csr_array(own[block]), own)},
    )  # fmt: skip


def test_the_likelihood_of_any_design_is_that_of_the_whole_covariance():
    # Two runs with a lost reading, free terms that are one too many, shares that add up.
    random = np.random.default_rng([80, 1])
    gap = np.ones(20)
    gap[[0, 12]], gap[5] = np.inf, 2.0
    free = random.standard_normal((20, 4))
    free[:, 3] = free[:, 0] - free[:, 2]
    shares = np.eye(5)[np.arange(20) // 4]
    covariance = np.tri(5) @ np.tri(5).T
    y = random.standard_normal(20)
    noise = Noise(
        y, csr_array(free), np.zeros(20, dtype=int), np.array([17]), gap,
        shared={"period": (csr_array(shares), covariance)},
    )  # fmt: skip
    place = np.cumsum(np.where(np.isinf(gap), 1e9, gap))
    lag = np.abs(np.subtract.outer(place, place))

    def dense(s0, phi, period):
        inner = ndtr(phi) ** lag + math.exp(2 * period) * shares @ covariance @ shares.T
        whole = math.exp(2 * s0) * inner
        weight, seen = np.linalg.inv(whole), free[:, :3]
        left = weight - weight @ seen @ np.linalg.solve(seen.T @ weight @ seen, seen.T @ weight)
        determinants = [np.linalg.slogdet(each)[1] for each in (whole, seen.T @ weight @ seen)]
        return sum(determinants) + y @ left @ y

    draws = random.normal(0.0, 0.7, (3, 8))
    found = noise.loss(dict(zip(noise.names, draws, strict=True)))
    rise = found - [dense(*draw) for draw in draws.T]
    assert noise.names == ["s0", "phi", "period"]
    assert rise == pytest.approx(np.full(8, rise[0]), abs=1e-5)


def test_draws_have_the_mean_of_a_grid_where_the_posterior_is_no_normal_law():
    # Three blocks hardly tell what they share.
    for seed in range(5):
        _, noise = one_way(3, 4, seed)
        s0, shift = (each.ravel() for each in np.meshgrid(*[np.linspace(-4.0, 4.0, 81)] * 2))
        p = {"s0": -0.7 + 1.5 * s0, "shift": -1.0 + 1.0 * shift}
        density = -0.5 * (noise.loss(p) + s0**2 + shift**2)
        grid = np.exp(density - density.max())
        q, weight = noise.draws(seed)
        assert weight @ weight < 1.0 / 40.0
        for name in p:
            mean = grid @ p[name] / grid.sum()
            width = math.sqrt(grid @ (p[name] - mean) ** 2 / grid.sum())
            assert weight @ q[name] == pytest.approx(mean, abs=0.3 * width)


def test_combinations_of_correlated_errors_have_their_covariance():
    random = np.random.default_rng([80, 2])
    gap = np.array([np.inf, 1.0, 3.0, np.inf, 1.0])
    place = np.cumsum(np.where(np.isinf(gap), 1e9, gap))
    matrix, phi = random.standard_normal((2, 5)), np.linspace(0.2, 0.6, 40)
    weight, size = np.full(40, 1 / 40), np.ones((40, 2))
    dense = [each ** np.abs(np.subtract.outer(place, place)) for each in phi]
    means, factor, dof = averaged(along(matrix, gap, phi, weight, size), weight)
    wanted = matrix @ np.mean(dense, axis=0) @ matrix.T
    assert np.sum(means, axis=0) == pytest.approx(wanted, rel=3e-3)
    assert (factor, dof > 100.0) == (pytest.approx(1.0, rel=0.02), True)
    white = whitener(gap, 0.6).toarray().T
    assert white @ dense[-1] @ white.T == pytest.approx(np.eye(5), abs=1e-12)


def test_an_estimate_follows_the_unit_and_not_the_order_of_rows():
    random = np.random.default_rng([80, 3])
    condition, block = np.tile(np.arange(6), 4), np.repeat(np.arange(4), 6)
    y = 1.0 + condition + 0.3 * random.standard_normal(4)[block] + 0.1 * random.standard_normal(24)
    mean, errors = estimate(y, condition, block=block)
    small, again = estimate(1e-9 * y, condition, block=block)
    assert small == pytest.approx(1e-9 * mean)
    assert again.covariance == pytest.approx(1e-18 * errors.covariance, rel=1e-6, abs=0.0)
    rows = random.permutation(24)
    same, again = estimate(y[rows], condition[rows], block=block[rows])
    assert same == pytest.approx(mean)
    assert again.covariance == pytest.approx(errors.covariance, rel=1e-5)
