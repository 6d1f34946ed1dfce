"""Fits of many rival models at once, in step, so that all predictions go through one batch call.

Levenberg-Marquardt on whitened residuals with a prior row for every free coordinate. Derivatives
are central differences, wide enough (0.1 of the prior's standard deviation at first) to see over
the steps of a piecewise smooth model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from stickslip.diagnosis.model import FREED, Cause, Problem

Array = NDArray[np.float64]

AGREE = 1.0
"""Starts agree whose chi-squares differ by less."""

_WIDE, _NARROW = 0.1, 0.01
_CLOUD = 16
_FAR = 6.0
_BEHIND = 40.0


@dataclass(frozen=True)
class Rival:
    """A model that competes: the recalibrated baseline and some causes.

    Attributes
    ----------
    causes : tuple of Cause
    free : ndarray of int
        Coordinates that are fitted.
    width : ndarray
        Standard deviation of the prior of each.
    """

    causes: tuple[Cause, ...]
    free: NDArray[np.int64]
    width: Array


@dataclass(frozen=True)
class Fit:
    """A fitted rival.

    Attributes
    ----------
    rival : Rival
    x : ndarray, shape (size,)
        All coordinates.
    chi2 : float
        Of data and prior rows.
    data_chi2 : float
    residual : ndarray, shape (m + free,)
        Whitened, with prior rows.
    jacobian : ndarray, shape (m + free, free)
        Of the model's whitened prediction, with the prior's rows.
    log_evidence : float
        Laplace's, up to a constant that is common to all rivals.
    certified : bool
        Two starts ended within one unit of chi-square.
    starts : tuple of float
        Chi-square of each start.
    """

    rival: Rival
    x: Array
    chi2: float
    data_chi2: float
    residual: Array
    jacobian: Array
    log_evidence: float
    certified: bool
    starts: tuple[float, ...]

    @property
    def covariance(self) -> Array:
        """Of the free coordinates."""
        return np.asarray(np.linalg.inv(self.jacobian.T @ self.jacobian))

    @property
    def name(self) -> str:
        """Names of the causes, or ``none``."""
        return " + ".join(each.name for each in self.rival.causes) or "none"


def make_rival(problem: Problem, causes: Sequence[Cause] = ()) -> Rival:
    """The model with these causes."""
    width = np.ones(problem.base_count)
    names = [each.name for each in problem.uncertain]
    for cause in causes:
        if cause.frees is not None:
            width[names.index(cause.frees)] = FREED
    extra = problem.columns(causes)
    free = np.array([*range(problem.base_count), *extra], dtype=np.int64)
    return Rival(tuple(causes), free, np.concatenate([width, np.ones(len(extra))]))


def scan(problem: Problem, count: int, seed: int) -> tuple[Array, Array]:
    """Coordinates of a Sobol scan of the prior, best first, and their chi-squares."""
    x = np.zeros((count, problem.size))
    if problem.base_count:
        sobol = qmc.Sobol(problem.base_count, scramble=True, seed=seed)
        share = np.clip(sobol.random(count), 1e-3, 1 - 1e-3)
        from scipy.special import ndtri

        x[:, : problem.base_count] = ndtri(share)
        x[0] = 0.0
    chi2 = np.sum(problem.residuals(x) ** 2, axis=1) + np.sum(x**2, axis=1)
    order = np.argsort(chi2, kind="stable")
    return x[order], chi2[order]


@dataclass
class _Walk:
    """One start of one rival."""

    rival: Rival
    x: Array
    residual: Array
    damping: float = 1e-2
    jacobian: Array | None = None
    step: Array | None = None
    quiet: int = 0

    @property
    def chi2(self) -> float:
        return float(self.residual @ self.residual)


def fit_rivals(
    problem: Problem,
    rivals: Sequence[Rival],
    starts: Sequence[Sequence[Array]],
    iterations: int = 10,
    hopeless: float = np.inf,
    clouds: int = 0,
) -> list[Fit]:
    """Fit rivals from their starts, all in step.

    Parameters
    ----------
    problem : Problem
    rivals : sequence of Rival
    starts : sequence of sequence of ndarray, shape (size,)
        For each rival, coordinates to start from.
    iterations : int
        Most steps of a start.
    hopeless : float
        Rivals farther than this behind the best after two steps are not refined.
    clouds : int
        Rounds of random points about every end, which get over steps that stop a slope.

    Returns
    -------
    list of Fit
        The best start of each rival.
    """
    if not rivals:
        return []
    low, high = problem.limits()
    walks, owner = [], []
    for index, (rival, points) in enumerate(zip(rivals, starts, strict=True)):
        for point in points:
            walks.append(_Walk(rival, np.clip(point, low, high), np.zeros(0)))
            owner.append(index)
    if walks:
        data = problem.residuals(np.stack([walk.x for walk in walks]))
        for walk, row in zip(walks, data, strict=True):
            walk.residual = _augmented(walk.rival, walk.x, row)
    active = list(walks)
    for count in range(iterations):
        if not active:
            break
        _derive(problem, active, low, high)
        _advance(problem, active, low, high)
        active = [walk for walk in active if walk.quiet < 2]
        if count >= 1:
            best = min(walk.chi2 for walk in walks) + hopeless
            active = [walk for walk in active if walk.chi2 < best]
        if count >= 3:
            own = [min(w.chi2 for w in walks if w.rival is each) for each in rivals]
            leads = dict(zip(map(id, rivals), own, strict=True))
            active = [walk for walk in active if walk.chi2 < leads[id(walk.rival)] + _BEHIND]
    for number in range(clouds):
        _scatter(problem, walks, low, high, number)
    winners = {id(rival): _best(walks, rival) for rival in rivals}
    _derive(problem, [winners[id(rival)] for rival in rivals if
                      winners[id(rival)].chi2 < min(w.chi2 for w in walks) + hopeless
                      or winners[id(rival)].jacobian is None], low, high)  # fmt: skip
    fits = []
    for index, rival in enumerate(rivals):
        mine = [walk for walk, of in zip(walks, owner, strict=True) if of == index]
        fits.append(_fit(problem, rival, mine))
    return fits


def _scatter(
    problem: Problem, walks: Sequence[_Walk], low: Array, high: Array, number: int
) -> None:
    """Move each walk to the best of some points about it, wide and narrow in turn."""
    random = np.random.default_rng([number, 3])
    rows = []
    for walk in walks:
        assert walk.jacobian is not None
        free = walk.rival.free
        scale = (1.0, 0.4, 0.15)[number % 3]
        lower = np.linalg.cholesky(np.linalg.inv(walk.jacobian.T @ walk.jacobian))
        draws = random.standard_normal((_CLOUD, len(free)))
        width = np.clip(np.sqrt(np.sum(lower**2, axis=1)), 0.03, 0.5)
        step = np.where(np.arange(_CLOUD)[:, None] % 2 == 0, draws @ lower.T, draws * width)
        points = np.tile(walk.x, (_CLOUD, 1))
        points[:, free] += scale * step
        rows.append(np.clip(points, low, high))
    data = problem.residuals(np.vstack(rows)).reshape(len(walks), _CLOUD, -1)
    for walk, points, residuals in zip(walks, rows, data, strict=True):
        prior = points[:, walk.rival.free] / walk.rival.width
        chi2 = np.sum(residuals**2, axis=1) + np.sum(prior**2, axis=1)
        best = int(np.argmin(chi2))
        if chi2[best] < walk.chi2:
            walk.x = points[best]
            walk.residual = _augmented(walk.rival, walk.x, residuals[best])


def _best(walks: Sequence[_Walk], rival: Rival) -> _Walk:
    return min((walk for walk in walks if walk.rival is rival), key=lambda walk: walk.chi2)


def _augmented(rival: Rival, x: Array, data: Array) -> Array:
    return np.concatenate([data, -x[rival.free] / rival.width])


def _derive(problem: Problem, walks: Sequence[_Walk], low: Array, high: Array) -> None:
    """Jacobians of all walks by one batch of central differences."""
    rows, plan = [], []
    for number, walk in enumerate(walks):
        width = np.full(len(walk.rival.free), _WIDE)
        if walk.jacobian is not None:
            spread = 1.0 / np.sqrt(np.sum(walk.jacobian**2, axis=0))
            width = np.clip(0.5 * spread, _NARROW, _WIDE)
        for column, k in enumerate(walk.rival.free):
            above, below = walk.x.copy(), walk.x.copy()
            above[k] = min(walk.x[k] + width[column], high[k])
            below[k] = max(walk.x[k] - width[column], low[k])
            rows += [above, below]
            plan.append((number, column, above[k] - below[k]))
    predicted = problem.predicted(np.stack(rows)) if rows else np.zeros((0, 0))
    m = len(problem.observed)
    fresh = [np.zeros((m, len(walk.rival.free))) for walk in walks]
    for index, (number, column, width_all) in enumerate(plan):
        slope = (predicted[2 * index] - predicted[2 * index + 1]) / max(width_all, 1e-12)
        fresh[number][:, column] = np.where(np.isfinite(slope), slope, 0.0)
    for walk, data in zip(walks, fresh, strict=True):
        prior = np.diag(1.0 / walk.rival.width)
        walk.jacobian = np.vstack([problem.whiten @ data, prior])


def _advance(problem: Problem, walks: Sequence[_Walk], low: Array, high: Array) -> None:
    """One step of each walk, the best of three dampings."""
    rows = []
    for walk in walks:
        assert walk.jacobian is not None
        normal = walk.jacobian.T @ walk.jacobian
        slope = walk.jacobian.T @ walk.residual
        for factor in (0.1, 1.0, 30.0):
            damped = normal + walk.damping * factor * np.diag(np.diag(normal))
            step = np.clip(np.linalg.solve(damped, slope), -_FAR, _FAR)
            point = walk.x.copy()
            point[walk.rival.free] += step
            rows.append(np.clip(point, low, high))
    data = problem.residuals(np.stack(rows))
    for number, walk in enumerate(walks):
        before = walk.chi2
        tried = [
            (
                rows[3 * number + k],
                _augmented(walk.rival, rows[3 * number + k], data[3 * number + k]),
            )
            for k in range(3)
        ]
        costs = [float(residual @ residual) for _, residual in tried]
        best = int(np.argmin(costs))
        if costs[best] < before:
            walk.x, walk.residual = tried[best]
            walk.damping = float(np.clip(walk.damping * (0.1, 1.0, 30.0)[best], 1e-6, 1e4))
            walk.quiet = walk.quiet + 1 if before - costs[best] < 0.02 else 0
        else:
            walk.damping = min(walk.damping * 30.0, 1e4)
            walk.quiet += 1


def _fit(problem: Problem, rival: Rival, walks: Sequence[_Walk]) -> Fit:
    ends = sorted(walk.chi2 for walk in walks)
    best = min(walks, key=lambda walk: walk.chi2)
    assert best.jacobian is not None
    scaled = best.jacobian * rival.width
    determinant = np.linalg.slogdet(scaled.T @ scaled)[1]
    m = len(problem.observed)
    return Fit(
        rival,
        best.x,
        best.chi2,
        float(np.sum(best.residual[:m] ** 2)),
        best.residual,
        best.jacobian,
        float(-0.5 * best.chi2 - 0.5 * determinant),
        len(ends) > 1 and ends[1] - ends[0] < AGREE,
        tuple(ends),
    )
