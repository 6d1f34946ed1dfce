"""Fits of models: a set of causes, a form of the discrepancy, and the log-evidence of both."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import log_ndtr, logsumexp

from stickslip._util.arrays import Array, Indices
from stickslip._util.text import OneLine
from stickslip.diagnosis.fitting.descent import Batched, End, derivatives, precision_of, refine
from stickslip.diagnosis.fitting.forms import PRIOR, Correlated, Form, forms
from stickslip.diagnosis.fitting.problem import MANY, Problem
from stickslip.diagnosis.terms.cause import Cause

PRIOR_NONE, PRIOR_CAUSES, PRIOR_MORE = 0.6, 0.4, 0.1
"""Prior probability of no cause, of a single one (shared by all), and of each further one beside
the first as a share of that. Chosen."""

NEAR_DATA = 100.0
"""Cost per row up to which a model is near the data. Chosen."""

_ROUNDS = 8
# g' A^-1 g below which a descent is at the minimum that the evidence takes: an evidence that is
# promised too large by less does not matter.
_AT_MINIMUM = 0.3
# Of the hyperparameters: step of their differences; most of Newton's steps, how long one may be,
# and the promised fall of the loss that ends them; the least curvature that is believed; and the
# loss where the likelihood is none. Chosen: far below what a lead counts.
_STEP_H, _NEWTON, _LONGEST_H, _SETTLED_H, _FLAT, _IMPOSSIBLE = 0.05, 12, 2.0, 0.01, 0.05, 1e12
# First guesses of the hyperparameters of a long record come from each hundredth, then each tenth
# block of so many readings. Chosen.
_THIN, _TOGETHER = (100, 10), 20


@dataclass(frozen=True, repr=False, eq=False)
class Fit(OneLine):
    """A fitted model.

    Attributes
    ----------
    causes : tuple of Cause
    form : str
        Of the discrepancy.
    x : ndarray, shape (size,)
    h : ndarray
        Logarithms of the form's hyperparameters.
    free : ndarray of int
        Coordinates that are fitted.
    residual, slopes : ndarray, shape (n,), (n, free)
        Data less predictions, and derivatives of the predictions.
    precision : ndarray, shape (free, free)
        Inverse covariance of the prior.
    covariance : ndarray, shape (free, free)
    log_evidence : float
        Of the data, with all constants.
    chi2 : float
        Of the data with the stated errors, whatever the form.
    cost : float
        Misfit in the form's inner product, and prior.
    sizes : dict
        Hyperparameters as they are told.
    """

    causes: tuple[Cause, ...]
    form: str
    x: Array
    h: Array
    free: Indices
    residual: Array
    slopes: Array
    precision: Array
    covariance: Array
    log_evidence: float
    chi2: float
    cost: float
    sizes: dict[str, float]

    @property
    def names(self) -> frozenset[str]:
        """Names of the causes."""
        return frozenset(cause.name for cause in self.causes)

    @property
    def name(self) -> str:
        """Names of the causes, or ``none``."""
        return " + ".join(sorted(self.names)) or "none"

    def swaps(self, other: Fit) -> bool:
        """Whether another model has one other cause in place of one of these."""
        return len(self.names ^ other.names) == 2 and len(self.names) == len(other.names)

    @property
    def end(self) -> End:
        """Where it is, to begin another descent of the same model."""
        return End(self.x, self.residual, self.slopes, math.nan)


def is_near_data(problem: Problem, residual: Array) -> bool:
    """Whether a residual is below ten errors in the mean."""
    return float(np.sum(problem.chi2_of_tables(residual[None]))) < NEAR_DATA * len(problem.y)


def log_prior(causes: Sequence[Cause], form: str, odds: float) -> float:
    """Log prior probability of a model where all causes have these odds together."""
    if not causes:
        return math.log(PRIOR_NONE * PRIOR[form])
    prior = sum(math.log(PRIOR_CAUSES * cause.odds / odds) for cause in causes)
    return prior + (len(causes) - 1) * math.log(PRIOR_MORE) + math.log(PRIOR[form])


def minimise(
    problem: Problem, form: Form, causes: Sequence[Cause], x: Array, *, h: Array | None = None,
    slopes: Array | None = None, cost_bound: float = math.inf, least: float = -math.inf,
) -> Batched[Fit]:  # fmt: skip
    """Fit a model from `x`: its coordinates in the inner product of h, and h at the coordinates.

    They take turns until the coordinates are at the minimum of the new inner product, until the
    first descent would not end below a cost of `cost_bound`, or until the promised log-evidence is
    below `least`.
    """
    causes = tuple(sorted(causes, key=lambda cause: cause.name))
    precision = precision_of(problem, causes)
    end, reached, steps, stuck = None, -math.inf, 10, 0
    if h is None:
        (residual,) = yield x[None, :], False
        h = form.begin(residual)
    for turn in range(_ROUNDS):
        end = yield from refine(
            problem, form, h, causes, x, precision=precision, steps=steps, begin=end,
            slopes=slopes, cost_bound=cost_bound,
        )  # fmt: skip
        x = end.x
        given_up = end.cost >= cost_bound
        if not end.exact and not given_up:
            slopes = yield from derivatives(problem, x, problem.free(causes), end.residual)
            end = replace(end, slopes=slopes, exact=True)
        fit, left = _fit(problem, form, causes, end, h)
        h, precision = fit.h, fit.precision
        # With one inner product the first descent may end at its minimum.
        alone = not form.names and len(problem.precisions(causes)) == 1
        settled = left < _AT_MINIMUM and (turn > 0 or alone)
        # What is promised may be out of reach; where predictions are smooth, other hyperparameters
        # get one more turn.
        before, reached = reached, fit.log_evidence - 0.5 * left
        stuck = stuck + 1 if reached < before + 0.5 * _AT_MINIMUM else 0
        stays = stuck > (1 if form.names and not problem.effort.early else 0)
        stays |= alone and end.cost > NEAR_DATA * form.n
        given_up, cost_bound = given_up or fit.log_evidence < least, math.inf
        if given_up or settled or stays:
            break
        steps = 6
    if settled and not given_up:
        return fit
    # No minimum was reached: what was only promised does not count.
    return replace(fit, log_evidence=fit.log_evidence - 0.5 * left)


def _fit(
    problem: Problem, form: Form, causes: tuple[Cause, ...], end: End, h: Array
) -> tuple[Fit, float]:
    """A fit that stays where it is, from hyperparameters h on; see `evidence` for the number."""
    h, log_evidence, precision, covariance, left = evidence(problem, form, causes, end, h)
    chi2, free = float(np.sum(problem.chi2_of_tables(end.residual[None, :]))), problem.free(causes)
    x = end.x[free]
    total = float(form.cost(end.residual[None, :], h)[0] + x @ precision @ x)
    return Fit(
        causes, form.name, end.x, h, free, end.residual, end.slopes, precision, covariance,
        log_evidence, chi2, total, form.sizes(h),
    ), left  # fmt: skip


def sharpened(problem: Problem, form: Form, old: Fit) -> Batched[Fit]:
    """The same fit with central derivatives, and so a better evidence."""
    spread = np.sqrt(np.maximum(np.diag(old.covariance), 0.0))
    if problem.low_fidelity is None:  # a simulation jumps within a narrower step
        # As wide as the data leave each coordinate open by itself: with others it may be far wider.
        spread = np.maximum(np.diag(np.linalg.pinv(old.covariance)), 1.0) ** -0.5
    slopes = yield from derivatives(problem, old.x, old.free, old.residual, False, spread, True)
    return _fit(problem, form, old.causes, replace(old.end, slopes=slopes), old.h)[0]


def linear(problem: Problem, form: Form, causes: Sequence[Cause], end: End) -> Fit:
    """A fit that stays where it is, with the evidence of the linear model there."""
    causes, h = tuple(sorted(causes, key=lambda cause: cause.name)), form.begin(end.residual)
    for thin in _THIN:
        if isinstance(form, Correlated) and problem.is_long and form.n >= _TOGETHER * thin**2:
            part = form.of_rows(np.flatnonzero(np.arange(form.n) % (_TOGETHER * thin) < _TOGETHER))
            h = evidence(problem, part, causes, end, h)[0]
    return _fit(problem, form, causes, end, h)[0]


def covariance_beside(problem: Problem, fit: Fit) -> Array:
    """Covariance of a fit's coordinates beside a discrepancy, shape (free, free).

    What is left may last for longer than a form lets it, and act as a cause does: it is the least
    upper bound of the fit's own and, about the fit, that by the likeliest slow process.
    """
    own, slow = fit.covariance, forms(problem, ["slow"])
    if fit.form == "exact" or "slow" not in slow:
        return own
    form = slow["slow"]
    begin = form.begin(fit.residual)
    h, _, precision, other, _ = evidence(problem, form, fit.causes, fit.end, begin)
    gram = form.gram(form.prepared(np.column_stack([fit.slopes, fit.residual])), h)
    move = other @ (gram[:-1, -1] - precision @ fit.x[fit.free])
    inner = np.flatnonzero(np.diag(own) > 0.0)
    at = np.ix_(inner, inner)
    lower = np.linalg.cholesky(own[at])
    beside = np.linalg.solve(lower, (other + np.outer(move, move))[at])
    scale, axes = np.linalg.eigh(np.linalg.solve(lower, beside.T))
    axes = lower @ axes * np.sqrt(np.maximum(scale, 1.0))
    whole = own.copy()
    whole[at] = axes @ axes.T
    return whole


def evidence(
    problem: Problem, form: Form, causes: Sequence[Cause], end: End, h: Array
) -> tuple[Array, float, Array, Array, float]:
    """Hyperparameters at their likeliest and the log-evidence, by Laplace's rule.

    Also the prior's precision that is likeliest, the covariance of the coordinates, and by how much
    the linear model promises twice the log-likelihood to grow from here.
    """
    prepared = form.prepared(np.column_stack([end.slopes, end.residual]))
    every = problem.precisions(causes)
    at_end = _At(problem, causes, end)

    def values(points: Array, precision: Array) -> tuple[Array, Array, Array]:
        grams, misfits, beside = [], [], []
        for point in points:
            grams.append(form.weighted(prepared, end.residual, point))
            # A normal form has its misfit in the last column, that of the residual.
            normal = bool(form.names)
            misfit = grams[-1][-1, -1] if normal else form.cost(end.residual[None, :], point)[0]
            misfits.append(float(misfit))
            beside.append(form.log_det(point) + form.n * math.log(2.0 * math.pi))
        return at_end.integrals(np.stack(grams), np.array(misfits), np.array(beside), precision)

    total = 0.0
    if form.names:
        _, sd, low, high = form.limits()
        first = every[len(every) // 2]

        def loss(points: Array) -> Array:
            fits = _possible(lambda some: values(some, first)[0], points)
            losses = form.hyperprior(points) - fits
            return np.where(np.isfinite(losses), losses, _IMPOSSIBLE)

        step = _STEP_H  # of a long record the likelihood narrows as 1/sqrt(n)
        if problem.is_long:
            step *= math.sqrt(min(MANY / form.n, 1.0))
        h, second = _minimum(loss, np.clip(h, low, high), low, high, step)
        # At the edge of a range the curvature says little: no more than the prior is left open.
        scale = np.maximum(np.linalg.eigvalsh(second), 1.0 / np.max(sd) ** 2)
        total -= 0.5 * float(np.sum(np.log(scale))) + float(form.hyperprior(h[None])[0])
    results = [[part[0] for part in values(h[None], precision)] for precision in every]
    best = int(np.argmax([one[0] for one in results]))
    total += float(logsumexp([one[0] for one in results])) - math.log(len(every))
    return h, total, every[best], results[best][1], float(results[best][2])


def _possible(function: Callable[[Array], Array], points: Array) -> Array:
    """A function of points, each by itself if they fail together; -inf where a point fails."""
    try:
        return function(points)
    except np.linalg.LinAlgError:
        if len(points) == 1:
            return np.array([-math.inf])
    return np.concatenate([_possible(function, point[None]) for point in points])


def _minimum(
    loss: Callable[[Array], Array], h: Array, low: Array, high: Array, step: float
) -> tuple[Array, Array]:
    """Where a loss, of points of shape (count, d), is least within limits, and its curvature.

    By Newton's steps; each takes slopes and curvature from one batch of points.
    """
    d = len(h)
    steps, (one, other) = step * np.eye(d), np.tril_indices(d, -1)
    around = np.vstack([steps, -steps, steps[one] + steps[other]])
    least, last, longest = math.inf, h, _LONGEST_H
    for _ in range(_NEWTON):
        (here,) = loss(h[None])
        if here < least:
            up, down, both = np.split(loss(h + around), [d, 2 * d])
            second = np.diag((up + down - 2.0 * here) / step**2)
            second[one, other] = (both - up[one] - up[other] + here) / step**2
            second[other, one] = second[one, other]
            downhill = (down - up) / (2.0 * step)
            free = np.where(downhill > 0.0, h < high, h > low)
            scale, axes = np.linalg.eigh(np.where(np.outer(free, free), second, np.eye(d)))
            scale = np.maximum(np.abs(scale), _FLAT)
            move = axes @ (axes.T @ np.where(free, downhill, 0.0) / scale)
            least, last, longest = here, h, min(2.0 * longest, _LONGEST_H)
        else:
            longest *= 0.25
        part = min(1.0, longest / max(float(np.max(np.abs(move))), 1e-300))
        h = np.clip(last + part * move, low, high)
        if downhill @ (h - last) < _SETTLED_H:
            break
    else:
        h = last
    return h, second


class _At:
    """Integral over the coordinates of a model that is linearised at an end."""

    def __init__(self, problem: Problem, causes: Sequence[Cause], end: End) -> None:
        free = problem.free(causes)
        self._x = end.x[free]
        low, high = problem.limits[:, free]
        self._low, self._high = self._x <= low + 1e-9, self._x >= high - 1e-9
        # The side of zero on which an amplitude of one side may be; 0 for all others.
        sides = [
            math.copysign(1.0, sum(parameter.limits)) if parameter.one_sided else 0.0
            for parameter in problem.parameters
        ]
        self._sides = np.array(sides)[free]

    def integrals(
        self, gram: Array, misfit: Array, beside: Array, precision: Array
    ) -> tuple[Array, Array, Array]:
        """Logs of integrals, covariances, and promised falls of the cost, of several `gram`.

        Half-normal priors have twice the density on their side. A coordinate that is pushed
        against an end of its range falls off exponentially there.
        """
        x = self._x
        curvature = gram[:, :-1, :-1] + precision
        downhill = gram[:, :-1, -1] - precision @ x
        pushed = (self._low & (downhill < 0.0)) | (self._high & (downhill > 0.0))
        total = 0.5 * float(np.linalg.slogdet(precision)[1]) - 0.5 * (misfit + beside)
        total += math.log(2.0) * int(np.sum(self._sides != 0.0)) - 0.5 * float(x @ precision @ x)
        covariance, fall = np.zeros_like(curvature), np.zeros(len(gram))
        for mask in np.unique(pushed, axis=0) if pushed.any() else pushed[:1]:
            rows = np.flatnonzero(np.all(pushed == mask, axis=1))
            inner = np.flatnonzero(~mask)
            mine = np.ix_(rows, inner, inner)
            lower = np.linalg.cholesky(curvature[mine])
            inverse = np.linalg.inv(lower)
            inverse = np.swapaxes(inverse, 1, 2) @ inverse
            down = downhill[np.ix_(rows, inner)]
            move = np.einsum("rij,rj->ri", inverse, down)
            fall[rows] = np.sum(down * move, axis=1)
            part = 0.5 * fall[rows] - np.sum(np.log(np.diagonal(lower, 0, 1, 2)), axis=1)
            for k in np.flatnonzero(mask).tolist():
                # With the others where they are best for it.
                beyond = curvature[rows, k][:, inner]
                across = np.einsum("rj,rji->ri", beyond, inverse)
                bend = curvature[rows, k, k] - np.sum(across * beyond, axis=1)
                score = -np.abs(downhill[rows, k] - np.sum(across * down, axis=1)) / np.sqrt(bend)
                part += 0.5 * score**2 + log_ndtr(score) - 0.5 * np.log(bend)
            for place, k in enumerate(inner.tolist()):
                if self._sides[k]:
                    inside = self._sides[k] * (x[k] + move[:, place])
                    inside /= np.sqrt(inverse[:, place, place])
                    part += log_ndtr(np.maximum(inside, -5.0))
            total[rows] += part
            covariance[mine] = inverse
        return total, covariance, fall
