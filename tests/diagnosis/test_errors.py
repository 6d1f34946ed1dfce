"""The error model: what it estimates, and that tests that use it are wrong as often as they say."""

import math
import tracemalloc

import numpy as np
import pytest
from scipy.special import ndtr
from scipy.stats import f as f_law
from scipy.stats import t as t_law

from stickslip.diagnosis.data.errors import _Scatter, along_runs, estimate, meter_step
from stickslip.walker.simulated import of_readings

LEVEL = np.geomspace(1e-4, 2e-3, 30) * (-1.0) ** np.arange(30)
SIZE = np.hypot(1e-5, 0.03 * LEVEL)


def codes(errors):
    return [each.code for each in errors.notes]


def autoregressive(noise, phi):
    """Errors of variance 1 along the last axis."""
    errors = noise.copy()
    for k in range(1, errors.shape[-1]):
        fresh = math.sqrt(1.0 - phi**2) * noise[..., k]
        errors[..., k] = phi * errors[..., k - 1] + fresh
    return errors


@pytest.mark.parametrize("stated", [False, True])
def test_the_likelihood_is_that_of_the_whole_covariance(stated):
    # Against matrices of all readings, with one condition at rest, runs with gaps and a lone
    # reading, and three blocks.
    random = np.random.default_rng(1)
    condition = np.tile(np.arange(8), 3)
    y = LEVEL[:8][condition] * (1.0 + 0.05 * random.standard_normal(24))
    y[condition == 3] = 0.0
    known = condition != 3
    run = np.repeat([0, 1, -1], [15, 8, 1])
    mean = np.bincount(condition, y) / 3.0
    block = random.integers(0, 3, 24)
    sd = 2e-5 * random.uniform(0.5, 2.0, 24) if stated else None
    chain = along_runs(run, None, known, known)
    scatter = _Scatter(
        condition, mean, mean != 0.0, 1e-3, y - mean[condition], sd, 2e-5, block, *chain
    )
    lag = np.abs(np.subtract.outer(np.arange(24.0), np.arange(24.0)))
    lag[(run[:, None] != run) | (run[:, None] < 0)] = np.inf
    np.fill_diagonal(lag, 0.0)
    shares = np.eye(3)[block]
    gains = shares * np.sign(mean)[condition, None]
    levels = np.delete(np.eye(8)[condition][known], 3, axis=1)

    def whole(p):
        size = np.exp(p["s0"]) * np.ones(24)
        if not stated:
            size = np.hypot(size, np.exp(p["rho"]) * mean[condition] / 1e-3)
        # Where errors are stated, only their ratios count.
        size = size * (2e-5 if sd is None else 2e-5 * sd / np.sqrt(np.mean(sd**2)))
        inner = ndtr(p["phi"]) ** lag + np.exp(2.0 * p["shift"]) * shares @ shares.T
        inner += np.exp(2.0 * p["gain"]) * gains @ gains.T
        covariance = (size[:, None] * inner * size)[np.ix_(known, known)]
        weight = np.linalg.inv(covariance)
        seen = levels.T @ weight @ levels
        left = weight - weight @ levels @ np.linalg.solve(seen, levels.T @ weight)
        determinants = np.linalg.slogdet(covariance)[1] + np.linalg.slogdet(seen)[1]
        return determinants + y[known] @ left @ y[known]

    assert scatter.noise.names == ["s0", *([] if stated else ["rho"]), "phi", "shift", "gain"]
    draws = [{name: random.normal(-0.5, 1.0) for name in scatter.noise.names} for _ in range(5)]
    columns = {name: np.array([each[name] for each in draws]) for name in scatter.noise.names}
    rise = scatter.noise.loss(columns) - [whole(each) for each in draws]
    assert rise - rise[0] == pytest.approx(np.zeros(5), abs=1e-5)
    # What readings share is so many of their errors: twice as much, four times the covariance.
    ones = np.ones((5, 8))
    for place, name in enumerate(("shift", "gain"), 1):
        once, twice = (
            scatter._covariances({**columns, name: columns[name] + more}, np.ones(5), ones)
            for more in (0.0, math.log(2.0))
        )
        assert twice[0][place] == pytest.approx(4.0 * once[0][place])


@pytest.mark.parametrize(
    ("readings", "step"),
    [
        ((0.0, 0.2, 0.4, 1.0, 0.6), 0.2), ((0.0, 0.2, 0.4, 1.0), 0.0),
        ((7.0, 8.0, 9.5, 11.0, 12.25), 0.25), ((7.0, 8.0, 9.4, 11.0, 12.2), 0.0),
        ((0.0, 1.0, 2.0, 3.0, 4.0008), 1.0), ((0.0, 1.0, 2.0, 3.0, 4.0012), 0.0),
    ],
)  # fmt: skip
def test_readings_show_the_step_of_their_meter(readings, step):
    assert meter_step(np.array(readings)) == pytest.approx(step)


@pytest.mark.parametrize("relative", [0.03, 0.035, 0.04])
def test_many_readings_tell_the_size_as_well_as_they_can(relative):
    # 200 conditions of 20 readings tell the sd to 1 / sqrt(2 * 3800) = 1.1 %; four times that.
    random = np.random.default_rng(7)
    level = np.geomspace(2e-5, 2e-3, 200)
    sd = np.hypot(relative * level, 1e-5)
    readings = level[:, None] + sd[:, None] * random.standard_normal((200, 20))
    mean, errors = estimate(readings.ravel(), np.repeat(np.arange(200), 20))
    assert np.median(errors.of_reading(level) / sd) == pytest.approx(1.0, abs=0.046)
    assert errors.sd * math.sqrt(20) == pytest.approx(errors.of_reading(mean))
    assert errors.sizes["rho"] == pytest.approx(relative, rel=0.08)
    # All levels weigh alike, and all readings tell one size; known to some per cent from draws.
    assert errors.dof == pytest.approx(3800, rel=0.2)
    assert errors.covariance is None


def test_one_size_of_errors_has_the_degrees_of_freedom_of_the_readings():
    # Without a level there is nothing to be relative to.
    y = 1e-3 * np.random.default_rng(2).standard_normal(60)
    _, errors = estimate(y, np.repeat(np.arange(20), 3), sd=None)
    assert errors.dof == pytest.approx(40.0, rel=0.25)


def test_repeats_of_no_level_tell_the_size_better_than_repeats_of_all():
    # By how errors grow with the level they would count up to twenty degrees of freedom.
    condition = np.repeat(np.arange(4), 3)
    for seed in range(30):
        noise = 0.1 * np.random.default_rng(seed).standard_normal(12)
        assert estimate(1.0 + condition + noise, condition)[1].dof <= 7.0


@pytest.mark.parametrize("signed", [True, False])
def test_a_set_up_that_is_faster_is_no_error_of_its_readings(signed):
    # Blocks scatter by 6 % as a gain or as a shift, readings by 3 %: twice an error of a reading,
    # known to 0.3 from 24 blocks.
    random = np.random.default_rng(3)
    level = (1.0 + np.arange(12)) * (-1.0) ** np.arange(12)
    index, block = np.repeat(np.arange(12), 24), np.tile(np.arange(24), 12)
    off = 0.06 * random.standard_normal(24)[block] * (level if signed else abs(level))[index]
    y = level[index] + off + 0.03 * level[index] * random.standard_normal(len(index))
    # One in five is not known: such a reading is a block of its own.
    block = np.where(random.random(len(index)) < 0.2, -1, block)
    _, errors = estimate(y, index, block=block)
    assert errors.sizes["rho"] == pytest.approx(0.03, rel=0.2)
    found, other = ("gain", "shift") if signed else ("shift", "gain")
    assert errors.sizes[found] == pytest.approx(2.0, abs=0.9)
    assert errors.sizes[other] < 0.4
    assert codes(errors) == ["blocks"]
    # The means of two conditions that go opposite ways are off by a gain in opposite directions.
    assert errors.covariance[0, 1] * (-1.0 if signed else 1.0) > 0.0


@pytest.mark.parametrize(
    ("block", "said"),
    [
        (None, []), (np.full(12, -1), []), (np.zeros(12, dtype=int), ["one-block"]),
        (np.tile([0, 1, 2], 4), ["blocks"]), (np.repeat([0, 1], 6), ["blocks-not-crossed"]),
    ],
)  # fmt: skip
def test_blocks_are_used_where_conditions_were_repeated_in_another(block, said):
    index = np.repeat(np.arange(4), 3)
    y = (1.0 + index) * (1.0 + 0.03 * np.random.default_rng(4).standard_normal(12))
    _, errors = estimate(y, index, block=block)
    assert codes(errors) == said
    assert (errors.covariance is None) == ("blocks" not in said)


@pytest.mark.parametrize("phi", [0.0, 0.6, 0.9])
def test_the_correlation_along_runs_is_found(phi):
    # 30 runs of 20 tell it to sqrt((1 - phi^2) / 600) and better; four times the largest of these,
    # and what a prior near 0.16 and the levels take.
    random = np.random.default_rng(5)
    noise = autoregressive(random.standard_normal((30, 20)), phi)
    y = np.tile(np.linspace(1.0, 3.0, 20), (30, 1)) + 0.1 * noise
    condition, run = np.tile(np.arange(20), 30), np.repeat(np.arange(30), 20)
    mean, errors = estimate(y.ravel(), condition, run=run)
    assert errors.sizes["phi"] == pytest.approx(phi, abs=0.17)
    correlation = errors.covariance / np.outer(errors.sd, errors.sd)
    # Levels of one run after the other are as alike as errors are.
    assert np.diag(correlation, 1) == pytest.approx(errors.sizes["phi"], abs=0.01)
    # The order of rows says nothing where places are known.
    mixed = random.permutation(600)
    place = 10.0 * np.tile(np.arange(20.0), 30)
    same, again = estimate(
        y.ravel()[mixed], condition[mixed], run=run[mixed], place=place[mixed]
    )  # fmt: skip
    assert same == pytest.approx(mean)
    assert again.covariance == pytest.approx(errors.covariance)


def test_a_reading_that_is_missing_in_a_run_is_a_gap():
    order, gap = along_runs(
        np.array([0, 0, 0, 1, -1, -1]), np.array([0.0, 0.2, 0.8, 5.0, 1.0, 2.0]),
        np.ones(6, bool), np.ones(6, bool),
    )  # fmt: skip
    at = dict(zip(order.tolist(), gap.tolist(), strict=True))
    # Steps of 0.2 and 0.6, of which the median is the usual one.
    assert at == pytest.approx({0: np.inf, 1: 1.0, 2: 1.5, 3: np.inf, 4: np.inf, 5: np.inf})


def test_runs_without_repeats_tell_no_correlation():
    y = np.random.default_rng(0).standard_normal(40)
    _, errors = estimate(y, np.arange(40), run=np.zeros(40, dtype=int), sd=np.ones(40))
    assert (errors.covariance, errors.dof, errors.notes) == (None, math.inf, ())
    # Repeats that no run joins.
    condition = np.concatenate([np.arange(30), np.arange(10)])
    for run in (np.repeat([0, -1], [30, 10]), np.repeat([-1, 0], [30, 10]) * (condition < 0)):
        assert "phi" in estimate(y, condition, run=run)[1].sizes


@pytest.mark.parametrize("blocks", [False, True])
def test_zero_readings_are_no_part_of_the_estimate(blocks):
    # Readings of exactly zero, as below the resolution of a camera, have no scatter at all.
    random = np.random.default_rng(21)
    level = np.linspace(0.2e-3, 2e-3, 20)
    index = np.repeat(np.arange(20), 3)
    y = level[index] + np.hypot(1e-5, 0.03 * level)[index] * random.standard_normal(60)
    still = np.array([0, 4, 9, 14, 21, 25])
    others = np.setdiff1d(np.arange(26), still)
    known = [{"block": np.tile(np.arange(3), count)} if blocks else {} for count in (20, 26)]
    _, moving = estimate(y, index, **known[0])
    mean, both = estimate(
        np.concatenate([y, np.zeros(18)]), np.repeat(np.append(others, still), 3), **known[1]
    )
    # The size is that of all means, of which more are small: some per cent.
    assert both.sizes == pytest.approx(moving.sizes, rel=0.02)
    assert both.sd[others] == pytest.approx(moving.sd, rel=0.02)
    assert mean[still].tolist() == [0.0] * 6
    # A condition at rest has the error of the level zero, and no gain.
    own = both.sizes["s0"] / math.sqrt(3.0)
    assert own * (1.0 - 1e-6) <= both.sd[still[0]] < 1.5 * own
    if blocks:
        np.linalg.cholesky(both.covariance)


def test_with_few_nonzero_readings_the_stated_error_is_used():
    # Of two degrees of freedom where something moves, and many where nothing does.
    index = np.repeat(np.arange(9), 3)
    y = np.zeros(27)
    y[[0, 1, 2]] = 1e-3, 1.05e-3, 0.98e-3
    y[[24, 25, 26]] = -2e-3, -2.1e-3, -0.0
    assert estimate(y, index, relative=0.05)[1].dof < math.inf
    mean, lone = estimate(y[:24], index[:24], relative=0.05)
    assert (codes(lone), lone.dof) == (["noise-stated"], math.inf)
    # A tenth of the error of what moves.
    assert lone.of_reading(mean)[1:] == pytest.approx(np.full(7, 0.1 * 0.05 * 1.01e-3))
    assert lone.sd * math.sqrt(3) == pytest.approx(lone.of_reading(mean))
    _, unknown = estimate(y[:24], index[:24])
    assert (codes(unknown), unknown.dof) == (["noise-unknown"], 0.0)


def test_readings_that_differ_by_rounding_do_not_give_the_error():
    # A mean of three equal decimals is often off by its last bit.
    random = np.random.default_rng(8)
    for _ in range(20):
        level = np.round(random.uniform(1e-4, 1e-3, 6), 6)
        _, errors = estimate(np.repeat(level, 3), np.repeat(np.arange(6), 3), relative=0.03)
        assert errors.sizes["rho"] == 0.03


def test_a_stated_error_stays_and_repeats_tell_the_correlation():
    # Stated twice too large: the correlation must not be blamed for that.
    random = np.random.default_rng(9)
    noise = autoregressive(random.standard_normal((12, 15)), 0.5)
    level = np.linspace(1.0, 3.0, 15)
    y, sd = (level * (1.0 + 0.05 * noise)).ravel(), np.tile(0.1 * level, 12)
    condition, run = np.tile(np.arange(15), 12), np.repeat(np.arange(12), 15)
    mean, errors = estimate(y, condition, sd=sd, run=run)
    assert errors.sd == pytest.approx(0.1 * level / math.sqrt(12.0), rel=0.02)
    assert errors.sizes["phi"] == pytest.approx(0.5, abs=0.2)
    assert errors.of_reading(level) == pytest.approx(0.1 * level, rel=0.02)
    # What a user has stated follows no level.
    assert errors.at(2.0 * mean).covariance == pytest.approx(errors.covariance)


@pytest.mark.nightly
def test_errors_that_readings_share_follow_the_fitted_level():
    # All velocities of a block are off by the same share. The mean of the fitted slopes over many
    # data sets is the true one, within three standard errors; weights by what was measured would
    # draw it down.
    random = np.random.default_rng(8)
    x = np.linspace(1.0, 3.0, 12)
    index, block = np.repeat(np.arange(12), 4), np.tile(np.arange(4), 12)
    slopes = []
    for seed in range(15):
        share = 1.0 + 0.1 * random.standard_normal(4)
        y = x[index] * share[block] * (1.0 + 0.03 * random.standard_normal(48))
        mean, errors = estimate(y, index, block=block, seed=seed)
        slope = 1.0
        for _ in range(20):
            weight = np.linalg.inv(errors.at(slope * x).covariance)
            slope = float(x @ weight @ mean) / float(x @ weight @ x)
        slopes.append(slope)
    error = np.std(slopes, ddof=1) / math.sqrt(len(slopes))
    assert abs(np.mean(slopes) - 1.0) < 3.0 * error
    assert error < 0.02


def test_the_work_without_repeats_is_linear_in_the_readings():
    count = 25_000
    y = 1.0 + 0.1 * np.random.default_rng(0).standard_normal(count)
    run = np.zeros(count, dtype=int)
    tracemalloc.start()
    estimate(y, np.arange(count), sd=np.full(count, 0.1), run=run)
    estimate(y, np.arange(count), relative=0.1)
    estimate(y, np.arange(count) // 2)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # A few hundred draws of each condition's error, and no matrix of 25 000 squared (5 GB).
    assert most < 2e8


def test_the_error_of_a_reading_is_from_repeats_or_a_free_fit():
    random = np.random.default_rng(11)
    x = np.linspace(-1.0, 1.0, 20)
    line = np.column_stack([np.ones(20), x])
    y = 1.0 + 2.0 * x + 0.1 * random.standard_normal(20)
    left = y - line @ np.linalg.lstsq(line, y, rcond=None)[0]
    sd = math.sqrt(float(left @ left) / 18.0)

    def told(condition, smallest=1e-3, free=line):
        errors = of_readings(y[: len(condition)], free[: len(condition)], condition, smallest, "T")
        assert errors.sd == pytest.approx(errors.sizes["s0"] / np.sqrt(np.bincount(condition)))
        return errors.sizes["s0"], errors.dof, errors.notes[0].code

    assert told(np.arange(20)) == pytest.approx((sd, 18.0, "noise-free-fit"))
    assert told(np.arange(20), 1.0) == (1.0, math.inf, "noise-smallest")
    assert told(np.arange(4)) == (1e-3, math.inf, "noise-unknown")
    # Ten pairs have fewer degrees of freedom than the fit; seven triples have enough.
    pairs = np.arange(20) // 2
    assert told(pairs)[2] == "noise-free-fit"
    assert told(np.arange(20) // 3)[1:] == (13.0, "noise-repeats")
    # A fit with a constant for each reading leaves nothing.
    scatter = math.sqrt(np.sum((y[::2] - y[1::2]) ** 2) / 20.0)
    assert told(pairs, free=np.eye(20)) == pytest.approx((scatter, 10.0, "noise-repeats"))


def made(kind, random, draw):
    """Readings, conditions and what `estimate` is told of them."""
    if kind in ("independent", "correlated"):
        # Five curves of six conditions, each in three sweeps.
        condition, run = np.tile(np.arange(30), 3), np.repeat(np.arange(15), 6)
        noise = autoregressive(draw(90).reshape(15, 6), 0.6 if kind == "correlated" else 0.0)
        return LEVEL[condition] + SIZE[condition] * noise.ravel(), condition, {"run": run}
    condition, noise, known = np.repeat(np.arange(30), 3), draw(90), {}
    size = (np.full(30, 3e-5) if kind == "constant" else SIZE)[condition]
    if kind == "blocks":
        known["block"] = block = np.tile(np.arange(3), 30)
        gain = 0.5 * random.standard_normal(3)[block] * np.sign(LEVEL[condition])
        noise = noise + 0.8 * random.standard_normal(3)[block] + gain
    return LEVEL[condition] + size * noise, condition, known


KINDS = ["constant", "relative", "blocks", "independent", "correlated"]


def rates(kind, sets, tails="normal", level=0.05):
    """Rates of a lack-of-fit F test and of two t tests, of causes in one curve, at a level."""
    random = np.random.default_rng([1, KINDS.index(kind)])
    curves = np.zeros((2, 30))
    curves[0, :6] = np.linspace(0.3, 1.0, 6) * np.abs(LEVEL[:6])
    curves[1, 24:] = np.linspace(1.0, 0.3, 6) * np.abs(LEVEL[24:])

    def draw(count):
        # Student's law with four degrees of freedom has the variance 2.
        if tails == "t4":
            return random.standard_t(4, count) / math.sqrt(2)
        return random.standard_normal(count)

    found = np.zeros(3)
    for seed in range(sets):
        y, condition, known = made(kind, random, draw)
        if tails == "outlier":
            y[random.integers(len(y))] *= 1.6
        mean, errors = estimate(y, condition, seed=seed, **known)
        errors = errors.at(LEVEL)
        covariance = np.diag(errors.sd**2) if errors.covariance is None else errors.covariance
        weight, left = np.linalg.inv(covariance), mean - LEVEL
        size = (curves @ weight @ left) / np.sqrt(np.sum(curves @ weight * curves, axis=1))
        chances = [f_law.sf(left @ weight @ left / 30, 30, errors.dof)]
        chances += [2.0 * t_law.sf(abs(each), errors.dof) for each in size]
        found += np.array(chances) < level
    return found / sets


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.daily("constant", "correlated")
def test_half_of_the_sound_data_are_on_either_side_of_the_median(kind):
    # Twenty data sets: fewer than four on a side come once in 800 times, of all 30 sides here once
    # in 26 draws of the seeds.
    found = rates(kind, 20, level=0.5)
    assert np.all((found >= 4 / 20) & (found <= 16 / 20))


@pytest.mark.nightly
@pytest.mark.parametrize("kind", KINDS)
def test_tests_at_five_percent_are_wrong_as_often(kind):
    found = rates(kind, 300)
    assert np.all((found >= 0.025) & (found <= 0.08))


@pytest.mark.nightly
def test_few_readings_are_neither_trusted_nor_distrusted():
    # Six pairs. Three binomial standard deviations are 3.3 % of 400 data sets.
    random = np.random.default_rng(4)
    condition, level = np.repeat(np.arange(6), 2), LEVEL[::5]
    found = np.zeros(2)
    for seed in range(400):
        y = (level * (1.0 + 0.03 * random.standard_normal((2, 6)))).T.ravel()
        mean, errors = estimate(y, condition, seed=seed)
        left = (mean - level) / errors.sd
        lack = f_law.sf(np.mean(left**2), 6, errors.dof)
        shift = 2.0 * t_law.sf(abs(np.sum(left)) / math.sqrt(6.0), errors.dof)
        found += np.array([lack, shift]) < 0.05
    assert np.all(np.abs(found / 400 - 0.05) < 0.033)


@pytest.mark.nightly
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tails", ["t4", "outlier"])
def test_heavy_tails_cost_little(kind, tails):
    found = rates(kind, 300, tails)
    assert found[0] <= 0.08
    # An outlier of twenty errors moves its own curve, of which there are five: to leave it out is
    # the measurement's task.
    assert np.all(found[1:] <= (0.1 if tails == "t4" else 0.2))
