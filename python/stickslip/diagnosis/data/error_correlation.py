"""Correlation of errors along the order of readings, estimated and used in their covariance.

Readings that follow each other in one run, such as the frequencies of a curve in one sweep, often
share a part of their error: a temperature, a focus or a charge that changes slowly. Errors counted
as independent then look like a cause. The errors of a run are taken as first-order autoregressive,

    e_t = phi e_(t-1) + sqrt(1 - phi^2) u_t,

with one correlation phi of neighbouring readings for all runs.

Why not from residuals of the physical model
    A hidden cause leaves a smooth misfit, which has the same correlation as such errors. So phi
    comes from what no cause can change, *contrasts of repeats*: where conditions were measured in
    several runs, each has a free level. Without repeats each run has a free *smooth curve*, a
    polynomial with a third as many parameters as readings, eight at most, which follows any smooth
    cause; what is finer counts as errors.

Restricted maximum likelihood
    Levels or curves are linear in free parameters, the columns of X, and take up a part of the
    errors: what is left has another correlation than the errors had, negative if phi is zero. The
    likelihood of what X does not take up accounts for that exactly. With R(phi) the correlation of
    n readings, p the rank of X and r the residuals of generalised least squares,

        -2 ln L = ln det R + ln det X' R^-1 X + (n - p) ln r' R^-1 r,

    in which the variance is replaced by its estimate r' R^-1 r / (n - p). (Patterson and Thompson,
    Biometrika 58 (1971) 545; for autoregressive errors Cheang and Reinsel, JASA 95 (2000) 1173.)
    The interval is where -2 ln L is within the chi-square quantile of its minimum. Its maximum lies
    low by 2 phi / (n - p), as it would with a known mean (Marriott and Pope, Biometrika 41 (1954)
    390), which is added. Means and coverage over many seeds are in
    tests/test_diagnosis_correlation.py.

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
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.stats import chi2 as chi2_law

from stickslip._util.arrays import Array, Indices, Mask
from stickslip._util.one_line import OneLine
from stickslip.diagnosis.data.trial_noise import (
    NoiseModel,
    column_basis,
    completed,
    moving,
    setup_columns,
)
from stickslip.diagnosis.data.trials import Trials
from stickslip.facts import Code, Fact

LEVEL = 0.95
"""Of the interval. A correlation is used where its lower end is above 0. Chosen: then one table in
forty of independent errors is treated as correlated, and a correlation that is missed is so small
that the rates of false alarms stay (tests/test_diagnosis_correlation.py)."""

FEWEST_FREE = 8
"""Degrees of freedom of the contrasts in runs, from which on a correlation is estimated. Chosen:
with eight its standard error is about 0.35."""

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

_TRIED = np.linspace(math.atanh(-0.95), math.atanh(0.98), 43)
"""Inverse hyperbolic tangents of the correlations that are tried. Chosen: in these steps of 0.1 the
likelihood is smooth, so that a spline through it is exact to a thousandth. At 0.98 a run of fifty
readings is one error."""

_FINER = np.linspace(_TRIED[0], _TRIED[-1], 2101)


@dataclass(frozen=True, repr=False, eq=False)
class Runs(OneLine):
    """In which run each of n readings was taken, and where in it.

    Attributes
    ----------
    run : ndarray of int, shape (n,)
        -1 where it is not known; the errors of such a reading are independent of all others.
    place : ndarray, shape (n,)
        Number of the reading in its run, ascending; larger steps are gaps, in readings.
    """

    run: Indices
    place: Array

    def at(self, kept: Mask) -> Runs:
        """Those of some readings, `kept` of shape (n,)."""
        return Runs(self.run[kept], self.place[kept])

    def rows(self) -> Iterator[Indices]:
        """Indices of the readings of each run in their order."""
        for each in np.unique(self.run[self.run >= 0]):
            mine = np.flatnonzero(self.run == each)
            yield mine[np.argsort(self.place[mine], kind="stable")]

    def gaps(self) -> tuple[Indices, Array]:
        """All readings, run by run, and the distance of each from the one before it.

        The distance is infinite for the first reading of a run; no reading is nearer than one.
        """
        lone = np.flatnonzero(self.run < 0)
        runs = [*self.rows(), *lone[:, None]]
        steps = [np.maximum(np.diff(self.place[rows], prepend=-math.inf), 1.0) for rows in runs]
        return np.concatenate(runs), np.concatenate(steps)

    def whitened(self, columns: Array, correlation: float) -> Array:
        """Columns, shape (n, k), in which errors of this correlation are independent, run by run.

        The rows are those of `gaps`.
        """
        order, gap = self.gaps()
        return _whitened(columns[order], _links(correlation, gap))

    def matrix(self, rows: Indices, correlation: float) -> Array:
        """Correlation of the readings of one run, shape (k, k); `rows` is from `rows()`."""
        steps = np.maximum(np.diff(self.place[rows]), 1.0)
        at = np.concatenate([[0.0], np.cumsum(steps)])
        return np.asarray(correlation ** np.abs(at[:, None] - at))


@dataclass(frozen=True, repr=False, eq=False)
class ErrorCorrelation(OneLine):
    """First-order correlation of the errors of neighbouring readings.

    Attributes
    ----------
    value : float
        Estimate by restricted maximum likelihood, without its bias.
    low, high : float
        Its interval of `LEVEL`.
    origin : str
        ``repeats`` or ``smooth curves``.
    free : int
        Degrees of freedom of the estimate.
    readings : int
        How many readings are in runs.
    effective : float
        To how many independent readings they amount, for a level that all share: the sum of all
        entries of the inverse of R (Vallejos and Osorio, Spatial Statistics 9 (2014) 66). Their
        number itself where the correlation is not used.
    variance : float
        Variance of an error with this correlation over the one that independence would give.
    """

    value: float
    low: float
    high: float
    origin: str
    free: int
    readings: int
    effective: float
    variance: float

    @property
    def used(self) -> bool:
        """Whether errors are taken as correlated."""
        return self.low > 0.0

    def fact(self) -> Fact:
        """What is said of it."""
        known = {"value": self.value, "low": self.low, "high": self.high, "origin": self.origin}
        if not self.used:
            return Fact(Code.ERRORS_INDEPENDENT, known)
        amount = {"readings": self.readings, "effective": self.effective}
        return Fact(Code.ERRORS_CORRELATED, {**known, **amount})


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
    # A statement of the noise stays; an estimate that took errors as independent does not.
    factor = 1.0 if math.isinf(noise.dof) else math.sqrt(found.variance)
    shared = np.diag(1.0 / noise.count)
    for rows in runs.rows():
        at = trials.condition[rows]
        own = (runs.matrix(rows, found.value) - np.eye(len(rows))) / noise.count[at]
        np.add.at(shared, (at[:, None], at), own / noise.count[at][:, None])
    return replace(
        noise,
        sd=factor * noise.sd,
        floor=factor * noise.floor,
        relative=factor * noise.relative,
        runs=runs,
        mean_correlation=shared,
    )


def _estimate(noise: NoiseModel, trials: Trials, runs: Runs) -> ErrorCorrelation | Fact:
    """The correlation from repeats, or else from smooth curves; or why it is not known."""
    long = np.isin(runs.run, [runs.run[rows[0]] for rows in runs.rows() if len(rows) > 1])
    used = long & moving(trials.value, trials.condition)
    if not used.any():
        return _too_few(0)
    condition, sd = trials.condition[used], noise.sd[trials.condition[used]]
    value, within = trials.value[used], runs.at(used)
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
        return _likeliest(scatter, basis, within, "repeats")
    scatter, basis, curves = _about_curves(value, sd, within)
    free = len(scatter) - basis.shape[1]
    if free < FEWEST_FREE:
        return _too_few(free)
    # Of errors with a positive correlation the curves would leave less than the stated variance.
    left = _independent_variance(scatter, basis)
    if math.isinf(noise.dof) and chi2_law.sf(free * left, free) < _NOT_SMOOTH:
        return Fact(Code.CURVES_NOT_SMOOTH, {"ratio": math.sqrt(left)})
    return _likeliest(scatter, basis, curves, "smooth curves")


def _too_few(free: int) -> Fact:
    return Fact(Code.CORRELATION_UNKNOWN, {"free": free, "needed": FEWEST_FREE})


def _about_curves(value: Array, sd: Array, runs: Runs) -> tuple[Array, Array, Runs]:
    """Readings of the longer runs over their error, and a basis of smooth curves, one a run."""
    kept = [rows for rows in runs.rows() if len(rows) >= SHORTEST_CURVE]
    if not kept:
        return np.zeros(0), np.zeros((0, 0)), runs.at(np.zeros(len(value), dtype=bool))
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


def _likeliest(scatter: Array, basis: Array, runs: Runs, origin: str) -> ErrorCorrelation:
    """The correlation of scatter, shape (n,), about what a basis, shape (n, p), takes up."""
    free = len(scatter) - basis.shape[1]
    order, gap = runs.gaps()
    columns = np.column_stack([basis, scatter])[order]
    losses = [_loss(columns, gap, math.tanh(each), free) for each in _TRIED]
    curve = CubicSpline(_TRIED, losses)(_FINER)
    best = int(np.argmin(curve))
    inside = np.flatnonzero(curve - curve[best] <= chi2_law.ppf(LEVEL, 1))
    likeliest, low, high = (float(np.tanh(_FINER[k])) for k in (best, inside[0], inside[-1]))
    value = float(np.clip(likeliest * (1.0 + 2.0 / free), *np.tanh(_TRIED[[0, -1]])))
    ones = runs.whitened(np.ones((len(scatter), 1)), value)
    variance = _variance(columns, gap, value, free) / _independent_variance(scatter, basis)
    return ErrorCorrelation(
        value=value,
        low=low,
        high=high,
        origin=origin,
        free=free,
        readings=len(scatter),
        effective=float(np.sum(ones**2)) if low > 0.0 else float(len(scatter)),
        variance=variance,
    )


def _loss(columns: Array, gap: Array, correlation: float, free: int) -> float:
    """-2 ln of the restricted likelihood, but for a constant; the last column is the scatter."""
    links = _links(correlation, gap)
    size = np.abs(np.diag(np.linalg.qr(_whitened(columns, links), mode="r")))
    log_determinants = np.sum(np.log(1.0 - links**2)) + 2.0 * np.sum(np.log(size[:-1]))
    return float(log_determinants + 2.0 * free * np.log(size[-1]))


def _variance(columns: Array, gap: Array, correlation: float, free: int) -> float:
    """Variance of an error with a correlation, by generalised least squares."""
    triangle = np.asarray(np.linalg.qr(_whitened(columns, _links(correlation, gap)), mode="r"))
    return float(triangle[-1, -1] ** 2) / free


def _independent_variance(scatter: Array, basis: Array) -> float:
    left = scatter - basis @ (basis.T @ scatter)
    return float(left @ left / (len(scatter) - basis.shape[1]))


def _links(correlation: float, gap: Array) -> Array:
    """Correlation of each reading with the one before it; 0 for the first of a run."""
    return np.asarray(np.sign(correlation) * np.abs(correlation) ** gap)


def _whitened(columns: Array, links: Array) -> Array:
    """Innovations of columns, shape (n, k), over their standard deviation."""
    left = columns.copy()
    left[1:] -= links[1:, None] * columns[:-1]
    return np.asarray(left / np.sqrt(1.0 - links**2)[:, None])
