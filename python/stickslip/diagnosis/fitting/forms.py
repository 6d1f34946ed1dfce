"""The errors and the discrepancy of a model: the inner products in which it is fitted.

A discrepancy d stands beside the terms of any model: y = f(x) + d + e, with independent e of kappa
times the stated errors (Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 425, 2001). Its forms:

``exact``
    d = 0 and kappa = 1: the errors are as stated, or Student's where their size was estimated.
``ar1``
    First-order correlated along each run, with size s and correlation time tau.
``white``
    Only kappa is free, where no table has runs.
``slow``
    Such a process along each run, with size s, that lasts for a part of it. No verdict compares it,
    as it would take what a cause does: it tells how far a size may be off.
"""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.linalg import lapack, solve_triangular
from scipy.special import gammaln

from stickslip._util.arrays import Array, Indices
from stickslip.diagnosis.data.errors import Errors
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.fitting.problem import LOST, Problem

PRIOR = {"exact": 3 / 4, "white": 1 / 4, "ar1": 1 / 4}
"""Prior probabilities of the forms, of which data allow two. Chosen; between 0.1 and 0.99 for exact
hardly a verdict of the prototype changed."""

HYPER = {
    "kappa": (0.0, 0.7, math.log(0.1), math.log(100.0)),
    "s": (0.0, 2.0, -5.0, 8.0),
    "tau": (math.log(0.03), 1.0, math.log(1e-4), math.log(0.1)),
    "lasts": (math.log(0.2), 0.7, math.log(0.03), 0.0),
}
"""Middle, standard deviation and range of the logarithms of kappa; s over the median error of its
table; tau and `lasts` over the span of a run. Chosen: with longer tau a discrepancy takes what a
cause does."""

FEWEST_IN_RUN = 8
"""Readings that a run needs for `ar1`: with fewer the prior decides. Chosen."""

DISCREPANT = 3.0
"""Standard deviation of the half-normal prior of s, in errors: one of fifty is none. Chosen."""

_MOST_DENSE = 1000  # readings of a table, whose covariance is a matrix
_WAVES = np.pi * np.arange(32)  # of `slow`, over a run; chosen: enough for the shortest
_RAREST = 1e-12  # least variance of a wave of `slow`, over the largest; chosen


class Form:
    """``exact`` and ``white``, and what the other forms share.

    Hyperparameters h are the logarithms named in `names`. `prepared` does what does not depend on
    them, `gram` the rest. A row that the model cannot compute is no discrepancy: its residual is
    left out of the inner product, and has the same price in every form.
    """

    name = "white"
    names: tuple[str, ...] = ("kappa",)
    factor = 1.0  # of the errors; where it is larger a cheaper model will do
    largest = math.inf  # standard deviation of the half-normal prior of s; else it is log-normal

    def __init__(self, problem: Problem) -> None:
        self.problem, self.n = problem, len(problem.y)
        # s is counted in the median error of each table; it is 0 in tables without a discrepancy.
        self.unit = np.empty(self.n)
        for part in problem.rows:
            self.unit[part] = np.median(problem.sd[part])

    def computed(self, columns: Array) -> Array:
        """Columns, shape (n, k), with 0 where a residual is that of a row that is not computed."""
        lost = columns == LOST * self.problem.sd[:, None]
        return np.where(lost, 0.0, columns) if lost.any() else columns

    def price(self, residual: Array) -> Array:
        """Cost of the rows that are not computed, of residuals, shape (vectors, n)."""
        return np.asarray(LOST**2 * np.sum(residual == LOST * self.problem.sd, axis=1))

    def prepared(self, columns: Array) -> Any:
        """Columns, shape (n, k), as `gram` needs them."""
        whitened = self.problem.whitened(self.computed(columns))
        return whitened.T @ whitened

    def gram(self, prepared: Any, h: Array) -> Array:
        """A' C^-1 A, shape (k, k)."""
        return np.asarray(prepared * math.exp(-2.0 * h[0]))

    def log_det(self, h: Array) -> float:
        """Logarithm of the determinant of C; to be asked after `gram` with the same h."""
        return self.problem.log_det + 2.0 * self.n * float(h[0])

    def cost(self, residual: Array, h: Array) -> Array:
        """r' C^-1 r of residuals, shape (vectors, n), and their price."""
        return self.misfit(self.prepared(residual.T), h) + self.price(residual)

    def misfit(self, prepared: Any, h: Array) -> Array:
        """r' C^-1 r of prepared residuals, shape (vectors,)."""
        return np.diag(self.gram(prepared, h))

    def density(self, residual: Array, h: Array) -> Array:
        """Log-likelihood of residuals, shape (vectors, n)."""
        cost = self.cost(residual, h)
        return -0.5 * (cost + self.log_det(h) + self.n * math.log(2.0 * math.pi))

    def weighted(self, prepared: Any, residual: Array, h: Array) -> Array:
        """`gram` for a step from a residual, the last column; robust forms weigh by it."""
        gram = self.gram(prepared, h)
        gram[-1, -1] += self.price(residual[None])[0]
        return gram

    def gram_of(self, columns: Sequence[Array], residual: Array, h: Array) -> Array:
        """`weighted` of many columns, (n,), and a residual: by pairs of parts, as memory lets."""
        k = len(columns)
        parts = np.array_split(np.arange(k), k // (4 * self.problem.at_once) + 1)
        gram = np.empty((k + 1, k + 1))
        for one, other in itertools.combinations_with_replacement(parts, 2):
            at = np.r_[one, other if other is not one else [], -1].astype(int)
            some = np.column_stack([*(columns[j] for j in at[:-1]), residual])
            gram[np.ix_(at, at)] = self.weighted(self.prepared(some), residual, h)
        return gram

    def begin(self, residual: Array) -> Array:
        """Hyperparameters to begin with."""
        scatter = float(np.mean(self.problem.whitened(residual[:, None]) ** 2))
        return np.array([0.5 * math.log(max(scatter, 0.05))])[: len(self.names)]

    def limits(self) -> tuple[Array, Array, Array, Array]:
        """Middle, standard deviation, lowest and highest of each hyperparameter."""
        middle, sd, low, high = np.array([HYPER[name] for name in self.names]).reshape(-1, 4).T
        return middle.copy(), sd.copy(), low.copy(), high.copy()

    def hyperprior(self, h: Array) -> Array:
        """Minus the log prior density of (points, d), over that of a standard normal's middle."""
        middle, sd, _, _ = self.limits()
        each = 0.5 * ((h - middle) / sd) ** 2 + np.log(sd)
        if math.isfinite(self.largest):
            k, most = self.names.index("s"), self.largest
            each[:, k] = 0.5 * np.exp(2.0 * h[:, k]) / most**2 - h[:, k] + math.log(0.5 * most)
        return np.asarray(np.sum(each, axis=1))

    def sizes(self, h: Array) -> dict[str, float]:
        """Hyperparameters as they are told, s in the median error of a table."""
        return {name: math.exp(value) for name, value in zip(self.names, h.tolist(), strict=True)}


class Whitening(Form):
    """Forms that make columns independent, of size 1."""

    def prepared(self, columns: Array) -> Any:
        return self.problem.whitened(self.computed(columns))

    def _whitened(self, columns: Array, h: Array) -> Array:
        return columns

    def gram(self, prepared: Any, h: Array) -> Array:
        whitened = self._whitened(prepared, h)
        return np.asarray(whitened.T @ whitened)

    def misfit(self, prepared: Any, h: Array) -> Array:
        return np.asarray(np.sum(self._whitened(prepared, h) ** 2, axis=0))


class Exact(Whitening):
    """``exact``: normal errors, or Student's for each table whose errors were estimated."""

    name = "exact"
    names = ()

    def weighted(self, prepared: Any, residual: Array, h: Array) -> Array:
        chi2 = self.problem.chi2_of_tables(self.computed(residual[:, None]).T)[:, 0]
        weights = np.ones(self.n)  # the derivative of the cost by the chi-square of the table
        for part, dof, value in zip(self.problem.rows, self.problem.dof, chi2, strict=True):
            if math.isfinite(dof):
                weights[part] = (dof + part.stop - part.start) / (dof + value)
        return np.asarray(prepared.T @ (weights[:, None] * prepared))

    def misfit(self, prepared: Any, h: Array) -> Array:
        total = np.zeros(prepared.shape[1])
        for part, dof in zip(self.problem.rows, self.problem.dof, strict=True):
            count, value = part.stop - part.start, np.sum(prepared[part] ** 2, axis=0)
            total += (dof + count) * np.log1p(value / dof) if math.isfinite(dof) else value
        return total

    def log_det(self, h: Array) -> float:
        """With what Student's density has beside its power."""
        total = self.problem.log_det
        for part, dof in zip(self.problem.rows, self.problem.dof, strict=True):
            count = part.stop - part.start
            if math.isfinite(dof):
                beside = gammaln((dof + count) / 2) - gammaln(dof / 2)
                total -= 2.0 * float(beside) - count * math.log(dof / 2.0)
        return total


class Softened(Exact):
    """Errors larger by a factor, for a search from afar; with `outlier` Cauchy's loss beyond it."""

    name = "softened"

    def __init__(self, problem: Problem, factor: float, outlier: float = math.inf) -> None:
        super().__init__(problem)
        self.factor, self._outlier = factor, outlier

    def prepared(self, columns: Array) -> Any:
        return self.problem.whitened(columns) / self.factor  # far off is a way to what is computed

    def weighted(self, prepared: Any, residual: Array, h: Array) -> Array:
        whitened = self.prepared(residual[:, None])
        return np.asarray(prepared.T @ (prepared / (1.0 + (whitened / self._outlier) ** 2)))

    def cost(self, residual: Array, h: Array) -> Array:
        squares = self.prepared(residual.T) ** 2
        if math.isfinite(self._outlier):
            squares = self._outlier**2 * np.log1p(squares / self._outlier**2)
        return np.asarray(np.sum(squares, axis=0))


class Correlated(Whitening):
    """``ar1``, for any gaps of a run; in O(n) where errors are independent.

    Differences B along a run, unit bidiagonal, make B C B' tridiagonal; with its factors
    L D L', D^-1/2 L^-1 B whitens. Of the rows of tables without runs only kappa is free.
    """

    name = "ar1"
    names = ("kappa", "s", "tau")
    largest = DISCREPANT

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        run, place, first = np.empty(self.n, dtype=np.int64), np.zeros(self.n), 0
        for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
            if _along_runs(table, problem.errors[k]):
                assert table.run is not None
                run[part], place[part] = first + table.run, table.order
            else:  # as if each row were a run
                self.unit[part], run[part] = 0.0, first + np.arange(part.stop - part.start)
            first = int(run[part].max()) + 1
        order = np.lexsort((place, run))
        run, place = run[order], place[order]
        begins = np.flatnonzero(np.diff(run, prepend=-1))
        gap = np.diff(place, prepend=0.0)
        gap[begins] = np.inf
        # A gap's share of the span of its run, so that runs of any unit can stand together.
        ends = np.append(begins[1:], len(run)) - 1
        span = place[ends] - place[begins]
        share = gap / np.repeat(np.where(span > 0.0, span, 1.0), ends + 1 - begins)
        self._step = float(np.median(share[np.isfinite(share)]))
        self._log_det, self._kept = 0.0, (np.zeros(0), dict[tuple[float, float], Any]())
        self._place(order, share)

    def _place(self, order: Indices, share: Array) -> None:
        """Take rows in their order, each a share of the span of its run after the one before."""
        self._order, self._share = order, share
        # Ways along a run add up over what is left out; one over the start of a run is infinite.
        way, run = np.cumsum(np.where(np.isfinite(share), share, 0.0)), np.cumsum(np.isinf(share))
        self._way, self._run = way, run
        chain = np.ones(len(order), dtype=bool)
        self._dense = list[tuple[Indices, Array, Array, Array]]()
        for k, part in enumerate(self.problem.rows):
            covariance = self.problem.covariance(k)
            if covariance is None:
                continue
            at = np.flatnonzero((order >= part.start) & (order < part.stop))
            apart = np.abs(np.subtract.outer(way[at], way[at]))
            apart[run[at][:, None] != run[at]] = np.inf
            rows, units = order[at] - part.start, self.unit[order[at]]
            own = np.asarray(covariance[np.ix_(rows, rows)])
            self._dense.append((at, own, apart, np.outer(units, units)))
            chain[at] = False
        self._chain = np.flatnonzero(chain) if self._dense else slice(None)
        rows = order[self._chain]
        self._unit2, self._variance = self.unit[rows] ** 2, self.problem.sd[rows] ** 2

    def of_rows(self, rows: Indices) -> Correlated:
        """The inner product of some rows alone: what is between them is a longer gap."""
        kept, made = np.isin(self._order, rows), copy.copy(self)
        way, run = self._way[kept], self._run[kept]
        share = np.where(np.diff(run, prepend=-1) == 0, np.diff(way, prepend=0.0), np.inf)
        made._place(self._order[kept], share)
        return made

    def prepared(self, columns: Array) -> Any:
        return np.asfortranarray(self.computed(columns)[self._order])

    def _whitened(self, columns: Array, h: Array) -> Array:
        kappa2, s2, tau = np.exp([2.0 * h[0], 2.0 * h[1], h[2]])
        phi, variance = np.exp(-self._share[self._chain] / tau), kappa2 * self._variance
        before = np.concatenate([[0.0], variance[:-1]])[: len(phi)]
        diagonal = s2 * self._unit2 * (1.0 - phi**2) + variance + phi**2 * before
        chain, pivots = columns[self._chain], diagonal
        whitened = np.empty_like(chain)
        whitened[:1] = chain[:1]
        if len(chain) > 1:
            pivots, beside, failed = lapack.dpttrf(diagonal, -phi[1:] * variance[:-1])
            if failed:
                raise np.linalg.LinAlgError("the covariance of a run is not positive")
            # In place: a temporary as large costs more than the sums.
            np.multiply(chain[:-1], -phi[1:, None], out=whitened[1:])
            whitened[1:] += chain[1:]
            band = np.ones((2, len(chain)), order="F")
            band[1, :-1] = beside
            whitened, _ = lapack.dtbtrs(band, whitened, uplo="L", diag="U", overwrite_b=True)
        whitened /= np.sqrt(pivots)[:, None]
        self._log_det = float(np.sum(np.log(pivots)))
        for at, covariance, apart, units in self._dense:
            lower = np.linalg.cholesky(kappa2 * covariance + s2 * units * np.exp(-apart / tau))
            self._log_det += 2.0 * float(np.sum(np.log(np.diag(lower))))
            whitened = np.vstack([whitened, solve_triangular(lower, columns[at], lower=True)])
        return whitened

    def gram(self, prepared: Any, h: Array) -> Array:
        if not self.problem.is_long:
            return super().gram(prepared, h)
        # All errors larger by a factor are the same inner product: of many rows it is kept.
        if self._kept[0] is not prepared:
            self._kept = prepared, {}
        key = round(h[1] - h[0], 12), round(h[2], 12)
        if key not in self._kept[1]:
            whitened = self._whitened(prepared, np.array([0.0, h[1] - h[0], h[2]]))
            self._kept[1][key] = whitened.T @ whitened, self._log_det
        gram, log_det = self._kept[1][key]
        self._log_det = log_det + 2.0 * prepared.shape[0] * float(h[0])
        return np.asarray(gram * math.exp(-2.0 * h[0]))

    def log_det(self, h: Array) -> float:
        return self._log_det

    def begin(self, residual: Array) -> Array:
        ordered = residual[self._order] / self.problem.sd[self._order]
        linked = np.isfinite(self._share[1:])
        power = float(np.sum(ordered[:-1][linked] ** 2))
        alike = float(np.sum((ordered[1:] * ordered[:-1])[linked])) / max(power, 1e-300)
        tau = -self._step / math.log(min(max(alike, 0.2), 0.99))
        return np.array([0.0, math.log(max(float(np.std(ordered)), 0.3)), math.log(tau)])

    def limits(self) -> tuple[Array, Array, Array, Array]:
        middle, sd, low, high = super().limits()
        # A correlation time below half a step is white.
        low[2] = math.log(0.5 * self._step)
        high[2] = max(high[2], low[2] + 0.5)
        middle[2] = min(max(middle[2], low[2]), high[2])
        return middle, sd, low, high


class Slow(Form):
    """``slow``, in O(n): by cosines along runs (Solin and Sarkka, Stat. Comput. 30, 419, 2020)."""

    name = "slow"
    names = ("kappa", "s", "lasts")

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        self._runs: list[tuple[Indices, Array]] = []
        for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
            slow = _is_slow(table, problem.errors[k])
            for run in np.unique(np.asarray(table.run)) if slow else ():
                own = np.flatnonzero(table.run == run)
                place = np.asarray(table.order, dtype=float)[own]
                place = (place - place.min()) / (np.ptp(place) or 1.0)
                rows, waves = part.start + own, np.cos(place[:, None] * _WAVES)
                waves[:, 1:] *= math.sqrt(2.0)
                self._runs.append((rows, waves * (self.unit / problem.sd)[rows, None]))
        self._inner = np.array([waves.T @ waves for _, waves in self._runs])
        self._log_det = 0.0

    def prepared(self, columns: Array) -> Any:
        whitened = self.problem.whitened(self.computed(columns))
        return whitened.T @ whitened, np.array([w.T @ whitened[rows] for rows, w in self._runs])

    def gram(self, prepared: Any, h: Array) -> Array:
        (gram, across), (kappa2, s2, lasts2) = prepared, np.exp(2.0 * h)
        size = s2 * np.sqrt(2.0 * np.pi * lasts2) * np.exp(-0.5 * _WAVES**2 * lasts2)
        odds = kappa2 / np.maximum(size, _RAREST * size[0])
        lower = np.linalg.cholesky(self._inner + np.diag(odds))
        half = np.linalg.solve(lower, across).reshape(-1, across.shape[-1])
        self._log_det = 2.0 * float(np.sum(np.log(np.diagonal(lower, 0, 1, 2))))
        self._log_det += self.problem.log_det + 2.0 * self.n * float(h[0])
        self._log_det -= len(lower) * float(np.sum(np.log(odds)))
        return np.asarray((gram - half.T @ half) / kappa2)

    def log_det(self, h: Array) -> float:
        return self._log_det

    def begin(self, residual: Array) -> Array:
        size = float(np.std(residual / self.problem.sd))
        return np.array([0.0, math.log(max(size, 0.3)), HYPER["lasts"][0]])


def _has_runs(table: Table) -> bool:
    return table.run is not None and int(np.bincount(table.run).max()) >= FEWEST_IN_RUN


def _along_runs(table: Table, errors: Errors) -> bool:
    """Whether a discrepancy may be correlated along the runs of a table."""
    banded = errors.covariance is None or len(table.mean) <= _MOST_DENSE
    return _has_runs(table) and banded


def _is_slow(table: Table, errors: Errors) -> bool:
    """Whether it may drift along runs whose readings have errors of their own."""
    return _has_runs(table) and errors.covariance is None


def forms(problem: Problem, wanted: Sequence[str] = tuple(PRIOR)) -> dict[str, Form]:
    """The forms of the discrepancy that the data allow."""
    pairs = list(zip(problem.tables, problem.errors, strict=True))
    runs = any(_along_runs(*pair) for pair in pairs)
    allowed = [Exact(problem), Correlated(problem) if runs else Form(problem)]
    if "slow" in wanted and any(_is_slow(*pair) for pair in pairs):
        allowed.append(Slow(problem))
    return {form.name: form for form in allowed if form.name in wanted}
