"""First-order autoregressive errors: their correlation by restricted maximum likelihood.

The errors of a run, readings that follow each other, are

    e_t = phi e_(t-1) + sqrt(1 - phi^2) u_t

with independent u of one variance and one correlation phi of neighbouring readings for all runs.
What is free besides, such as the level of each condition, is linear in p parameters, the columns of
X. It takes up a part of the errors, and what is left has another correlation than they had,
negative where phi is zero. The likelihood of what X does not take up accounts for that exactly.
With R(phi) the correlation of n readings and r the residuals of generalised least squares,

    -2 ln L = ln det R + ln det X' R^-1 X + (n - p) ln r' R^-1 r,

in which the variance is replaced by its estimate r' R^-1 r / (n - p) (Patterson and Thompson,
Biometrika 58 (1971) 545; for autoregressive errors Cheang and Reinsel, JASA 95 (2000) 1173). The
interval is where -2 ln L is within the chi-square quantile of its minimum. The likeliest phi lies
low by 2 phi / (n - p), as it would with a known mean (Marriott and Pope, Biometrika 41 (1954) 390),
which is added. Means and coverage over many seeds are in tests/test_diagnosis_correlation.py.

The covariance of errors is its mean over the posterior of phi: with the likeliest phi alone,
differences of neighbours would be trusted far too much where phi is too large. As one phi is wrong
for all errors together, that is widened where the noise counts as known, see `averaged`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.stats import chi2 as chi2_law

from stickslip._util.arrays import Array, Indices
from stickslip._util.one_line import OneLine
from stickslip.facts import Code, Fact

LEVEL = 0.95
"""Of the interval. A correlation is used where its lower end is above 0. Chosen: then one table in
forty of independent errors is treated as correlated, and a correlation that is missed is so small
that the rates of false alarms stay (tests/test_diagnosis_correlation.py)."""

FEWEST_FREE = 8
"""Degrees of freedom of what is left in runs, from which on a correlation is estimated. Chosen:
with eight its standard error is about 0.35."""

_TRIED = np.linspace(math.atanh(-0.95), math.atanh(0.98), 43)
"""Inverse hyperbolic tangents of the correlations that are tried. Chosen: in these steps of 0.1 the
likelihood is smooth, so that a spline through it is exact to a thousandth. At 0.98 a run of fifty
readings is one error."""

_POINTS = (np.arange(9) + 0.5) / 9.0
"""Probabilities of the quantiles by which the posterior is averaged. Chosen: more change variances
by less than a hundredth."""

_EXACT = 1e-9
"""Part of the readings below which what is left is rounding. Chosen: between the rounding of a
double, 1e-16, and that of any table."""

_DRAWS, _TAIL = 2000, 0.975
"""Draws for each point in `averaged`, and the quantile that is asked for. Chosen: nearer to the
verdict's levels than the median, as in `reading_noise.widening`; it is then known to 2 %."""

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

    def at(self, kept: Indices) -> Runs:
        """Those of some readings, whose indices are `kept`."""
        return Runs(self.run[kept], self.place[kept])

    def rows(self) -> list[Indices]:
        """Indices of the readings of each run in their order."""
        runs = [np.flatnonzero(self.run == each) for each in np.unique(self.run[self.run >= 0])]
        return [mine[np.argsort(self.place[mine], kind="stable")] for mine in runs]

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
    points : ndarray, shape (k,)
        Correlations from 0 to 1, equally probable, under a prior that is flat there.
    """

    value: float
    low: float
    high: float
    origin: str
    free: int
    readings: int
    effective: float
    variance: float
    points: Array

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


def likeliest(scatter: Array, basis: Array, runs: Runs, origin: str) -> ErrorCorrelation | None:
    """The correlation of scatter, shape (n,), about what is free; None where nothing scatters.

    `basis`, shape (n, p), is an orthonormal basis of the columns of X.
    """
    free = len(scatter) - basis.shape[1]
    # What the columns explain has no influence, but would take digits.
    left = scatter - basis @ (basis.T @ scatter)
    if np.linalg.norm(left) <= _EXACT * np.linalg.norm(scatter):
        return None
    order, gap = runs.gaps()
    products = _products(np.column_stack([basis, left])[order], gap)
    losses, variances = np.array([_loss(products, math.tanh(each), free) for each in _TRIED]).T
    curve = CubicSpline(_TRIED, losses)(_FINER)
    best = int(np.argmin(curve))
    inside = np.flatnonzero(curve - curve[best] <= chi2_law.ppf(LEVEL, 1))
    peak, low, high = (float(np.tanh(_FINER[k])) for k in (best, inside[0], inside[-1]))
    value = float(np.clip(peak * (1.0 + 2.0 / free), *np.tanh(_TRIED[[0, -1]])))
    effective = float(len(scatter))
    if low > 0.0:
        effective = float(np.sum(runs.whitened(np.ones((len(scatter), 1)), value) ** 2))
    alone, correlated = np.interp(np.arctanh([0.0, value]), _TRIED, np.log(variances))
    return ErrorCorrelation(
        value=value,
        low=low,
        high=high,
        origin=origin,
        free=free,
        readings=len(scatter),
        effective=effective,
        variance=math.exp(correlated - alone),
        points=_posterior_points(curve - curve[best]),
    )


def _posterior_points(rise: Array) -> Array:
    """Quantiles of the correlation, of -2 ln L above its minimum at `_FINER`."""
    at = np.tanh(_FINER)
    # A step of the inverse hyperbolic tangent is one of 1 - phi^2 of phi itself.
    share = np.cumsum(np.where(at >= 0.0, np.exp(-0.5 * rise) * (1.0 - at**2), 0.0))
    return np.asarray(at[np.searchsorted(share, _POINTS * share[-1])])


def averaged(covariances: Array) -> Array:
    """Mean of equally probable covariances, shape (points, k, k), so wide that a test is safe.

    Chi-square by this covariance, of errors that have any of the others, is above the quantile of
    the chi-square law as rarely as by a covariance that is known.
    """
    mean = np.mean(covariances, axis=0)
    whiten = np.linalg.inv(np.linalg.cholesky(mean))
    random = np.random.default_rng(0)
    squares = random.standard_normal((_DRAWS, len(mean))) ** 2
    chi2 = [squares @ np.linalg.eigvalsh(whiten @ each @ whiten.T) for each in covariances]
    factor = float(np.quantile(np.concatenate(chi2), _TAIL) / chi2_law.ppf(_TAIL, len(mean)))
    return np.asarray(max(factor, 1.0) * mean)


def _products(columns: Array, gap: Array) -> list[tuple[float, int, Array, Array, Array]]:
    """For each gap, how many readings have it, and sums of products of their rows of columns.

    With themselves, with the rows before and of the rows before, of which X' R^-1 X follows for any
    correlation.
    """
    before = np.vstack([np.zeros_like(columns[:1]), columns[:-1]])
    found = []
    for each in np.unique(gap).tolist():
        now, then = columns[gap == each], before[gap == each]
        across = now.T @ then
        found.append((each, len(now), now.T @ now, across + across.T, then.T @ then))
    return found


def _loss(
    products: list[tuple[float, int, Array, Array, Array]], correlation: float, free: int
) -> tuple[float, float]:
    """-2 ln of the restricted likelihood, but for a constant, and the variance of an error."""
    log_determinant, weighted = 0.0, np.zeros_like(products[0][2])
    for gap, count, own, across, before in products:
        link = float(_links(correlation, np.array(gap)))
        weighted += (own - link * across + link**2 * before) / (1.0 - link**2)
        log_determinant += count * math.log(1.0 - link**2)
    size = np.diag(np.linalg.cholesky(weighted))
    log_determinant += 2.0 * float(np.sum(np.log(size[:-1])))
    return log_determinant + 2.0 * free * math.log(size[-1]), float(size[-1] ** 2 / free)


def _links(correlation: float, gap: Array) -> Array:
    """Correlation of each reading with the one before it; 0 for the first of a run."""
    return np.asarray(np.sign(correlation) * np.abs(correlation) ** gap)


def _whitened(columns: Array, links: Array) -> Array:
    """Innovations of columns, shape (n, k), over their standard deviation."""
    left = columns.copy()
    left[1:] -= links[1:, None] * columns[:-1]
    return np.asarray(left / np.sqrt(1.0 - links**2)[:, None])
