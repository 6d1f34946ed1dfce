"""Errors that are correlated within a run: the estimate, its interval, and the tests with it."""

import math

import numpy as np
import pytest

from stickslip.diagnosis import Cause, CauseParameter, Prior, Uncertain, diagnose_model
from stickslip.diagnosis.data.data_quality import find_data_problem
from stickslip.diagnosis.data.error_correlation import as_correlated_as_possible, with_correlation
from stickslip.diagnosis.data.trial_noise import fit_noise, stated_noise
from stickslip.diagnosis.data.trials import Trials
from stickslip.diagnosis.fit.goodness import lack_of_fit_p
from stickslip.diagnosis.input_checks import check_inputs
from stickslip.diagnosis.options import Options
from stickslip.diagnosis.pipeline import State, estimate_noise, fit_baseline, pose
from stickslip.errors import ScenarioError
from stickslip.facts import Code

CURVES = (8, 9, 10, 11, 12)
"""Readings of each curve."""

SWEEPS = 3
SIZE = sum(CURVES)
CURVE = np.repeat(np.arange(len(CURVES)), CURVES)
X = np.concatenate([np.linspace(0.0, 1.0, count) for count in CURVES])
LEVEL = 1.0 + X
SD = 0.05
CONDITION = np.repeat(np.arange(SIZE), SWEEPS)
RUN = (CURVE[:, None] * SWEEPS + np.arange(SWEEPS)).ravel()


def errors(random, correlation, curve=CURVE, sweeps=SWEEPS):
    """First-order correlated errors along each curve, independent between sweeps."""
    draws = random.standard_normal((len(curve), sweeps))
    for row in range(1, len(curve)):
        if curve[row] == curve[row - 1]:
            draws[row] *= math.sqrt(1.0 - correlation**2)
            draws[row] += correlation * draws[row - 1]
    return draws


def noise_of(values, run=RUN, order=None):
    """The noise of trials that scatter alike, with and without the correlation."""
    alone = fit_noise(values, CONDITION)
    return alone, with_correlation(alone, Trials(values, CONDITION, None, order, run))


@pytest.mark.parametrize("correlation", [0.0, 0.3, 0.6, 0.9])
def test_repeats_tell_the_correlation_and_its_interval(correlation):
    # The mean of 100 tables is within three of its standard errors; of 100 intervals of 95 % six
    # or seven more may miss.
    random = np.random.default_rng(1)
    found = []
    for _ in range(100):
        values = (LEVEL[:, None] + SD * errors(random, correlation)).ravel()
        found.append(noise_of(values)[1].correlation)
    value = np.array([each.value for each in found])
    assert abs(np.mean(value) - correlation) < 3.0 * np.std(value) / 10.0
    assert sum(each.low <= correlation <= each.high for each in found) >= 88
    assert {each.origin for each in found} == {"repeats"}
    used = np.mean([each.used for each in found])
    assert used <= 0.07 if correlation == 0.0 else used >= 0.5


@pytest.mark.parametrize("correlation", [0.0, 0.3, 0.6])
def test_smooth_curves_tell_the_correlation_without_repeats(correlation):
    # One sweep of four curves with a smooth cause; what the free curves take up of the errors does
    # not bias the estimate. Three standard errors of the mean of 100 tables.
    random = np.random.default_rng(2)
    curve, x = np.repeat(np.arange(4), 30), np.tile(np.linspace(0.0, 1.0, 30), 4)
    index, found = np.arange(len(x)), []
    for _ in range(100):
        values = np.sin(6.0 * x) + SD * errors(random, correlation, curve, sweeps=1)[:, 0]
        noise, _ = stated_noise(values, index, SD)
        found.append(with_correlation(noise, Trials(values, index, None, None, curve)).correlation)
    # One in a hundred is refused, as its curves scatter too much.
    found = [each for each in found if each is not None]
    assert len(found) >= 95
    value = np.array([each.value for each in found])
    assert {each.origin for each in found} == {"smooth curves"}
    assert abs(np.mean(value) - correlation) < 3.0 * np.std(value) / 10.0
    assert sum(each.low <= correlation <= each.high for each in found) >= 88


def rates_of_false_alarms(correlation, count):
    """Share of tables without a cause in which two tests of 5 % find one, of each noise.

    A line through the origin is fitted. The tests are the lack of fit, and the score of a cause
    that acts in one curve.
    """
    random, alarms = np.random.default_rng(3), np.zeros((count, 2, 2))
    for number in range(count):
        values = (LEVEL[:, None] + SD * errors(random, correlation)).ravel()
        for which, noise in enumerate(noise_of(values)):
            whiten = np.linalg.inv(np.linalg.cholesky(noise.covariance))
            columns = whiten @ np.column_stack([LEVEL, CURVE == 2, noise.mean])
            triangle = np.linalg.qr(columns, mode="r")
            score, rest = triangle[1, 2] ** 2, triangle[2, 2] ** 2
            chances = (
                lack_of_fit_p(score + rest, SIZE - 1, noise.dof),
                lack_of_fit_p(score, 1, noise.dof),
            )
            alarms[number, which] = np.array(chances) < 0.05
    return alarms.mean(axis=0)


@pytest.mark.nightly
def test_correlated_errors_raise_no_more_false_alarms_than_independent_ones():
    # 400 tables tell a rate of 5 % to 1.1 %.
    without, with_estimate = rates_of_false_alarms(0.6, 400)
    assert np.all(with_estimate <= 0.08)
    assert without[0] > 1.7 * with_estimate[0]
    assert without[1] > 0.20


def test_independent_errors_keep_their_rate():
    without, with_estimate = rates_of_false_alarms(0.0, 200)
    assert np.all(np.abs(with_estimate - without) <= 0.01)
    assert np.all(with_estimate <= 0.08)


@pytest.mark.nightly
def test_correlated_errors_of_a_stated_size_raise_few_false_alarms():
    # One sweep of four curves of 30 readings; the score of a cause that acts in one of them, and
    # the lack of fit. 150 tables tell a rate of 5 % to 1.8 %.
    random, alarms = np.random.default_rng(13), np.zeros((150, 2, 2))
    curve, x = np.repeat(np.arange(4), 30), np.tile(np.linspace(0.0, 1.0, 30), 4)
    index = np.arange(len(x))
    for number in range(150):
        values = 1.0 + x + SD * errors(random, 0.6, curve, sweeps=1)[:, 0]
        alone, _ = stated_noise(values, index, SD)
        noise = with_correlation(alone, Trials(values, index, None, None, curve))
        for which, each in enumerate((alone, noise)):
            whiten = np.linalg.inv(np.linalg.cholesky(each.covariance))
            columns = whiten @ np.column_stack([1.0 + x, curve == 0, values])
            triangle = np.linalg.qr(columns, mode="r")
            score, rest = triangle[1, 2] ** 2, triangle[2, 2] ** 2
            chances = (
                lack_of_fit_p(score + rest, len(x) - 1, math.inf),
                lack_of_fit_p(score, 1, math.inf),
            )
            alarms[number, which] = np.array(chances) < 0.05
    without, with_estimate = alarms.mean(axis=0)
    assert np.all(with_estimate <= 0.11)
    assert without[1] > 0.25


def test_where_no_correlation_is_seen_the_noise_stays_as_it_was():
    random = np.random.default_rng(4)
    alone, noise = noise_of((LEVEL[:, None] + SD * errors(random, 0.0)).ravel())
    assert not noise.correlation.used
    assert np.array_equal(noise.covariance, alone.covariance)
    assert [each.code for each in noise.notes[-1:]] == [Code.ERRORS_INDEPENDENT]
    assert noise.correlation.effective == noise.correlation.readings == len(RUN)


def test_the_means_are_correlated_along_a_curve_alone():
    random = np.random.default_rng(5)
    _, noise = noise_of((LEVEL[:, None] + SD * errors(random, 0.6)).ravel())
    sd, phi = np.sqrt(np.diag(noise.covariance)), noise.correlation.value
    found = noise.covariance / sd / sd[:, None]
    same = CURVE[:, None] == CURVE
    apart = np.abs(np.subtract.outer(np.arange(SIZE), np.arange(SIZE)))
    # Of neighbours phi, but for its bias; all are means over what phi may be.
    points = noise.correlation.points
    expected = np.mean(points[:, None, None] ** apart, axis=0)
    assert found == pytest.approx(np.where(same, expected, 0.0), abs=1e-12)
    assert found[0, 1] == pytest.approx(phi, abs=0.03)
    # Of a run of n readings n - (n - 2) phi count, over 1 + phi.
    expected = SWEEPS * sum((n - (n - 2) * phi) / (1.0 + phi) for n in CURVES)
    assert noise.correlation.effective == pytest.approx(expected, rel=1e-9)


def test_runs_follow_the_order_where_it_is_given():
    # The errors follow each other in time, and the rows are in another order.
    random = np.random.default_rng(6)
    values = (LEVEL[:, None] + SD * errors(random, 0.8)).ravel()
    time = np.argsort(np.lexsort((CONDITION, RUN))).astype(float)
    mixed = random.permutation(len(values))
    condition, run = CONDITION[mixed], RUN[mixed]
    alone = fit_noise(values[mixed], condition)
    ordered = with_correlation(alone, Trials(values[mixed], condition, None, time[mixed], run))
    sorted_rows = noise_of(values)[1]
    assert ordered.correlation.value == pytest.approx(sorted_rows.correlation.value, abs=0.03)
    assert ordered.covariance == pytest.approx(sorted_rows.covariance, abs=2e-4)


def test_correlated_errors_are_no_drift():
    # Of a single run with a correlation of 0.9 the slope often looks significant.
    random = np.random.default_rng(7)
    time = np.argsort(np.lexsort((CONDITION, RUN))).astype(float)
    whole = np.zeros(len(RUN), dtype=np.int64)
    drifts = np.zeros(2)
    for _ in range(60):
        draws = random.standard_normal(len(RUN))
        for k in range(1, len(draws)):
            draws[k] = 0.9 * draws[k - 1] + math.sqrt(1.0 - 0.9**2) * draws[k]
        values = LEVEL[CONDITION] + 0.02 * draws[time.astype(int)]
        for which, noise in enumerate(noise_of(values, whole, time)):
            problem = find_data_problem(values, CONDITION, noise, time)
            drifts[which] += problem is not None and problem.code == Code.DRIFT
    assert drifts[1] <= 3
    assert drifts[0] > 10


def test_a_steady_drift_is_no_correlation():
    random = np.random.default_rng(8)
    time = np.argsort(np.lexsort((CONDITION, RUN))).astype(float)
    values = LEVEL[CONDITION] + SD * (random.standard_normal(len(RUN)) + 0.3 * time)
    _, noise = noise_of(values, np.zeros(len(RUN), dtype=np.int64), time)
    assert not noise.correlation.used
    assert find_data_problem(values, CONDITION, noise, time).code == Code.DRIFT


def test_too_few_readings_and_steps_are_said():
    few = np.array([1.0, 2.0, 3.0, 4.0])
    noise, _ = stated_noise(few, np.arange(4), SD)
    found = with_correlation(noise, Trials(few, np.arange(4), None, None, np.zeros(4, int)))
    assert found.correlation is None
    assert [each.code for each in found.notes] == [Code.CORRELATION_UNKNOWN]
    # Readings without any scatter tell nothing of it.
    for exact in (LEVEL, 0.0 * LEVEL):
        noise, _ = stated_noise(exact, np.arange(SIZE), SD)
        found = with_correlation(noise, Trials(exact, np.arange(SIZE), None, None, CURVE))
        assert [each.code for each in found.notes] == [Code.CORRELATION_UNKNOWN]
    steps = np.where(X > 0.5, 3.0, 1.0)
    noise, _ = stated_noise(steps, np.arange(SIZE), SD)
    found = with_correlation(noise, Trials(steps, np.arange(SIZE), None, None, CURVE))
    assert found.correlation is None
    assert [each.code for each in found.notes] == [Code.CURVES_NOT_SMOOTH]


def waves(_, p):
    """A line, and a wave in the second column."""
    return p[:, :1] * LEVEL + (p[:, 1:2] * np.sin(3.0 * X) if p.shape[1] > 1 else 0.0)


def test_a_diagnosis_uses_and_reports_the_correlation():
    random = np.random.default_rng(9)
    values = (LEVEL[:, None] + SD * errors(random, 0.8)).ravel()
    slope = Uncertain("slope", Prior("normal", 1.0, 0.5), suspect=False)
    wave = Cause("wave", (CauseParameter("wave.height", "-", -5.0, 5.0, 0.5),))
    options = {"condition": CONDITION, "seed": 1}
    without = diagnose_model(waves, None, values, [slope], [wave], **options)
    found = diagnose_model(waves, None, values, [slope], [wave], run=RUN, **options)
    assert found.findings.noise.correlation.used
    assert found.verdict.kind == "none"
    assert "correlation of 0." in found.summary()
    assert "correlation" not in without.summary()
    # The slope is known less well than independent errors would have it.
    assert found.params["sd"].iloc[0] > 1.5 * without.params["sd"].iloc[0]
    # A covariance that is stated stays as it is.
    covariance = np.diag(np.full(SIZE, SD**2))
    stated = diagnose_model(
        waves, None, LEVEL, [slope], [wave], sd=covariance, run=np.zeros(SIZE, int)
    )
    assert stated.findings.noise.correlation is None
    assert stated.findings.notes == ()


def as_correlated(correlation):
    """Correlation of readings of the same curve."""
    apart = np.abs(np.subtract.outer(np.arange(SIZE), np.arange(SIZE)))
    return np.where(CURVE[:, None] == CURVE, correlation**apart, 0.0)


def test_errors_may_be_as_correlated_as_the_end_of_the_interval_says():
    values = (LEVEL[:, None] + SD * errors(np.random.default_rng(4), 0.0)).ravel()
    trials = Trials(values, CONDITION, None, None, RUN)
    alone, noise = noise_of(values)
    most = as_correlated_as_possible(noise, trials)
    sd = np.sqrt(np.diag(alone.covariance))
    expected = np.outer(sd, sd) * as_correlated(noise.correlation.high)
    assert noise.correlation.high > 0.05
    assert most.covariance == pytest.approx(expected, abs=1e-12)
    # Nothing is known without runs; and what is taken as correlated has been averaged over.
    assert as_correlated_as_possible(alone, trials) is None
    values = (LEVEL[:, None] + SD * errors(np.random.default_rng(5), 0.6)).ravel()
    assert as_correlated_as_possible(noise_of(values)[1], trials) is None


def log_evidence(observed, covariance, wave):
    """Of a level and, if asked for, a wave, by a sum over a grid of their priors."""
    u, v = np.linspace(-1.0, 1.0, 401), np.linspace(-1.0, 1.0, 201) if wave else np.zeros(1)
    # Coordinates are normal: of the height the hyperbolic sine, 0.5 at 1.
    columns = [1.0 + 0.5 * u, 0.5 * np.sinh(v) / math.sinh(1.0)]
    grid = np.stack(np.meshgrid(*columns, indexing="ij"), axis=-1).reshape(-1, 2)
    white = np.linalg.inv(np.linalg.cholesky(covariance))
    squares = np.sum(((waves(None, grid) - observed) @ white.T) ** 2, axis=1)
    squares += np.add.outer(u**2, v**2).ravel()
    steps = (u[1] - u[0]) * ((v[1] - v[0]) / math.sqrt(2.0 * math.pi) if wave else 1.0)
    least = squares.min()
    return math.log(steps * np.sum(np.exp(-0.5 * (squares - least)))) - 0.5 * least


def test_a_name_is_withheld_that_leads_too_little_where_errors_may_be_correlated():
    # Independent errors, of which repeats cannot exclude that they are correlated by 0.22.
    draws = SD * errors(np.random.default_rng(4), 0.0)
    values = (LEVEL[:, None] + 0.03 * np.sin(3.0 * X)[:, None] + draws).ravel()
    slope = Uncertain("slope", Prior("normal", 1.0, 0.5), suspect=False)
    wave = Cause("wave", (CauseParameter("wave.height", "-", -5.0, 5.0, 0.5),))
    options = {"condition": CONDITION, "seed": 1}
    without = diagnose_model(waves, None, values, [slope], [wave], **options)
    assert (without.verdict.kind, without.verdict.causes) == ("named", ("wave",))
    found = diagnose_model(waves, None, values, [slope], [wave], run=RUN, **options)
    assert (found.verdict.kind, found.verdict.causes) == ("ambiguous", ("wave",))
    (reason,) = found.verdict.reasons
    assert reason.code == Code.MAY_BE_CORRELATED
    noise = found.findings.noise
    assert reason.fields["correlation"] == noise.correlation.high
    sd = np.sqrt(np.diag(noise.covariance))
    covariance = np.outer(sd, sd) * as_correlated(noise.correlation.high)
    with_wave, alone = (log_evidence(noise.mean, covariance, each) for each in (True, False))
    # Only the height is no linear coordinate: asinh has a relative curvature of (0.03 / 0.5)^2 / 2,
    # of a lead of 2.3.
    assert reason.fields["lead"] == pytest.approx(with_wave - alone, abs=0.01)


@pytest.mark.parametrize("run", [[0, 1], np.full(len(RUN), 0.5)])
def test_runs_of_another_shape_are_refused(run):
    with pytest.raises(ScenarioError, match="run: allowed"):
        diagnose_model(waves, None, LEVEL[CONDITION], [], [], condition=CONDITION, run=run)


def test_correlated_errors_follow_the_fitted_level_and_not_the_readings():
    # Relative errors of a curve of m = 12 readings, mean of four sweeps. With a covariance in
    # proportion to the readings y = v (1 + e), generalised least squares takes the level as
    # 1'Y R 1 / 1'Y R Y 1, with Y = 1 / y and R the inverse of the correlation, whose entries sum to
    # s: to second order in e it is low by sd^2 (1 + (m - 2) / s), 0.8 standard errors here.
    m, sweeps, phi, relative = 12, 4, 0.8, 0.2
    shape = np.linspace(1.0, 3.0, m)
    correlation = phi ** np.abs(np.subtract.outer(np.arange(m), np.arange(m)))
    lower, inverse = np.linalg.cholesky(correlation), np.linalg.inv(correlation)
    s = np.sum(inverse)
    sd = relative / math.sqrt(sweeps)
    bias = sd**2 * (1.0 + (m - 2.0) / s) / (sd / math.sqrt(s))
    assert bias == pytest.approx(0.82, abs=0.01)
    level = Uncertain("level", Prior("log-uniform", 0.2, 5.0), suspect=False)
    options = Options(condition=np.tile(np.arange(m), sweeps), run=np.repeat(np.arange(sweeps), m))
    gaps = []
    for seed in range(60):
        error = relative * np.random.default_rng(seed).standard_normal((sweeps, m)) @ lower.T
        state = State(options, check_inputs((shape * (1.0 + error)).ravel(), [level], [], options))
        estimate_noise(state)
        pose(state, lambda _, p: p[:, :1] * shape, None, [level], [])
        fit_baseline(state)
        found = level.prior.value(state.recalibration.null.x[0])
        # By the covariance of the truth the level is a weighted mean, without any bias.
        right = 1.0 + np.sum(inverse @ error.mean(axis=0)) / s
        gaps.append((found - right) / (sd / math.sqrt(s)))
    # A quarter of that bias, and four standard errors of this mean.
    assert abs(np.mean(gaps)) < 0.25 * bias
    assert 4.0 * np.std(gaps) / math.sqrt(len(gaps)) < 0.25 * bias
