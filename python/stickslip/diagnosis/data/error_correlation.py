"""Correlation of errors along the order of readings, estimated and used in their covariance.

Readings that follow each other in one run, such as the frequencies of a curve in one sweep, often
share a part of their error: a temperature, a focus or a charge that changes slowly. Errors counted
as independent then look like a cause. The errors of a run are taken as autoregressive, see
`autoregression`.

Why not from residuals of the physical model
    A hidden cause leaves a smooth misfit, which has the same correlation as such errors. So phi
    comes from what no cause can change, *contrasts of repeats*: where conditions were measured in
    several runs, each has a free level. Without repeats each run has a free *smooth curve*, a
    polynomial with a third as many parameters as readings, eight at most, which follows any smooth
    cause; what is finer counts as errors.

What is confounded
    - An error that all runs share at a condition, such as a stage that is tilted at one place, is
      in no contrast of repeats: it is a cause, or is taken for one.
    - What one curve of a single run has beyond its smooth function may be a step of the motion and
      no error. Then the curve misses by more than the stated error, and nothing is estimated.
    - What changes more slowly than a single run follows is taken up by its smooth curve, so that a
      correlation near 1 is hardly distinguishable from none; the interval is wide, and tells it.
    - A set-up that is off as a whole looks like a correlation near 1 where set-ups are not told.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.stats import chi2 as chi2_law

from stickslip._util.arrays import Array, Indices
from stickslip.diagnosis.data.autoregression import (
    FEWEST_FREE,
    ErrorCorrelation,
    Runs,
    averaged,
    likeliest,
)
from stickslip.diagnosis.data.trial_noise import (
    NoiseModel,
    column_basis,
    completed,
    moving,
    setup_columns,
)
from stickslip.diagnosis.data.trials import Trials
from stickslip.facts import Code, Fact

SHORTEST_CURVE = 8
"""Readings of a run from which on a smooth curve is drawn through it. Chosen: a cubic leaves half
of eight free."""

_FREE_SHARE = 1.0 / 3.0
"""Parameters of a smooth curve over its readings. Chosen: it follows waves of six readings and
longer, and leaves two thirds of the errors."""

_MOST_FREE = 8
"""Most parameters of a smooth curve. Chosen: it follows three waves; with more, long runs would say
little of a strong correlation."""

_NOT_SMOOTH = 0.01
"""p-value of the curves' scatter against the stated error, below which they do not follow the
readings. Chosen: as for a model that is not adequate."""


def make_runs(run: Indices, order: Array | None) -> Runs:
    """Runs of readings; a run is in the order of `order` if it has no gap, else in that of rows.

    Steps of `order` count in units of the run's usual step, so that a run that was interrupted is
    correlated across the interruption by less.
    """
    place = np.arange(len(run), dtype=float)
    for each in np.unique(run[run >= 0]):
        mine = np.flatnonzero(run == each)
        place[mine] = np.arange(len(mine))
        if order is not None and len(mine) > 1 and np.all(np.isfinite(order[mine])):
            steps = np.diff(np.unique(order[mine]))
            place[mine] = order[mine] / (float(np.median(steps)) if len(steps) else 1.0)
    return Runs(run, place)


def with_correlation(noise: NoiseModel, trials: Trials) -> NoiseModel:
    """The noise with the correlation of errors within runs, as far as the trials tell it.

    Where the runs are not known, or the noise is not, nothing changes.
    """
    if trials.run is None or not np.any(trials.run >= 0) or noise.dof <= 0.0:
        return noise
    runs = make_runs(trials.run, trials.order)
    found = _estimate(noise, trials, runs)
    if isinstance(found, Fact):
        return replace(noise, notes=(*noise.notes, found))
    noise = replace(noise, notes=(*noise.notes, found.fact()), correlation=found)
    if not found.used:
        return noise
    covariances = np.array([_of_means(noise, trials, runs, each) for each in found.points])
    # A statement of the noise stays; an estimate that took errors as independent does not. Its
    # degrees of freedom are in the tests, so that it need not be widened.
    stated = math.isinf(noise.dof)
    factor = 1.0 if stated else math.sqrt(found.variance)
    return replace(
        noise,
        sd=factor * noise.sd,
        floor=factor * noise.floor,
        relative=factor * noise.relative,
        # In units of a trial's error, which has grown; what set-ups share has not.
        between=noise.between / factor,
        between_gain=noise.between_gain / factor,
        runs=runs,
        mean_correlation=averaged(covariances) if stated else np.mean(covariances, axis=0),
    )


def as_correlated_as_possible(noise: NoiseModel, trials: Trials) -> NoiseModel | None:
    """Errors that are taken as independent with the largest correlation of its interval instead.

    None where they are taken as correlated already, or nothing is known of it.
    """
    found = noise.correlation
    if found is None or found.used or found.high <= 0.0:
        return None
    assert trials.run is not None
    runs = make_runs(trials.run, trials.order)
    means = _of_means(noise, trials, runs, found.high)
    return replace(noise, runs=runs, mean_correlation=means)


def _of_means(noise: NoiseModel, trials: Trials, runs: Runs, correlation: float) -> Array:
    """Covariance of the means in units of a trial's error, shape (m, m)."""
    found = np.diag(1.0 / noise.count)
    for rows in runs.rows():
        at = trials.condition[rows]
        own = (runs.matrix(rows, correlation) - np.eye(len(rows))) / noise.count[at]
        np.add.at(found, (at[:, None], at), own / noise.count[at][:, None])
    return found


def _estimate(noise: NoiseModel, trials: Trials, runs: Runs) -> ErrorCorrelation | Fact:
    """The correlation from repeats, or else from smooth curves; or why it is not known."""
    long = np.isin(runs.run, [runs.run[rows[0]] for rows in runs.rows() if len(rows) > 1])
    used = long & moving(trials.value, trials.condition)
    if not used.any():
        return _too_few(0)
    condition, sd = trials.condition[used], noise.sd[trials.condition[used]]
    value, within = trials.value[used], runs.at(np.flatnonzero(used))
    design = np.eye(len(noise.mean))[condition][:, np.unique(condition)]
    block = completed(trials.block)
    if block is not None and noise.setups.shape[1]:
        design = np.hstack([design, setup_columns(condition, block[used], noise.mean)])
    if trials.order is not None and np.all(np.isfinite(trials.order[used])):
        # A steady drift has a test of its own, and is no correlation.
        slope = trials.order[used] - np.mean(trials.order[used])
        design = np.column_stack([design, slope / max(float(np.max(np.abs(slope))), 1e-300)])
    basis = column_basis(design)
    free = len(value) - basis.shape[1]
    if free >= FEWEST_FREE:
        scatter = (value - noise.mean[condition]) / sd
        return likeliest(scatter, basis, within, "repeats") or _too_few(0)
    scatter, basis, curves = _about_curves(value, sd, within)
    free = len(scatter) - basis.shape[1]
    if free < FEWEST_FREE:
        return _too_few(free)
    # Of errors with a positive correlation the curves would leave less than the stated variance.
    left = _independent_variance(scatter, basis)
    if math.isinf(noise.dof) and chi2_law.sf(free * left, free) < _NOT_SMOOTH:
        return Fact(Code.CURVES_NOT_SMOOTH, {"ratio": math.sqrt(left)})
    return likeliest(scatter, basis, curves, "smooth curves") or _too_few(0)


def _too_few(free: int) -> Fact:
    return Fact(Code.CORRELATION_UNKNOWN, {"free": free, "needed": FEWEST_FREE})


def _about_curves(value: Array, sd: Array, runs: Runs) -> tuple[Array, Array, Runs]:
    """Readings of the longer runs over their error, and a basis of smooth curves, one a run."""
    kept = [rows for rows in runs.rows() if len(rows) >= SHORTEST_CURVE]
    if not kept:
        return np.zeros(0), np.zeros((0, 0)), runs.at(np.zeros(0, dtype=np.int64))
    used = np.concatenate(kept)
    columns: list[Array] = []
    first = 0
    for rows in kept:
        count = min(1 + round(_FREE_SHARE * len(rows)), _MOST_FREE)
        place = np.linspace(-1.0, 1.0, len(rows))
        mine = np.zeros((len(used), count))
        mine[first : first + len(rows)] = np.polynomial.chebyshev.chebvander(place, count - 1)
        columns.append(mine)
        first += len(rows)
    basis = column_basis(np.hstack(columns) / sd[used][:, None])
    return value[used] / sd[used], basis, Runs(runs.run[used], runs.place[used])


def _independent_variance(scatter: Array, basis: Array) -> float:
    left = scatter - basis @ (basis.T @ scatter)
    return float(left @ left / (len(scatter) - basis.shape[1]))
