"""Fits of many rival models at once, in step, so that all predictions go through one batch call.

Gauss-Newton steps inside a trust radius, on whitened residuals with a prior row for every free
coordinate. Derivatives are differences about as wide as what the data leaves open, so that they see
over the steps of a piecewise smooth model: one-sided on the way, central at the end, and Broyden's
updates, which cost nothing, in between.
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

_WIDE, _NARROW = 0.03, 1e-3
_SECANT = 1e-3
_CLOUD = 16
_NEAR, _FAR = 1.0, 4.0
_BEHIND = 40.0
_SHARES = (1.0,)
_SETTLED = 0.02
_GOOD = 0.3


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
    slope : ndarray, shape (m, free)
        Of the model's prediction, in the observable's unit.
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
    slope: Array
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


@dataclass(frozen=True)
class Start:
    """Where a fit begins.

    Attributes
    ----------
    x : ndarray, shape (size,)
    slope : ndarray, shape (m, free), optional
        Derivatives that were found near by.
    """

    x: Array
    slope: Array | None = None

    @staticmethod
    def of(fit: Fit, rows: NDArray[np.int64] | slice = slice(None)) -> Start:
        """The end of another fit, of some of its conditions."""
        return Start(fit.x, fit.slope[rows])


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
    predicted: Array
    residual: Array
    slope: Array | None = None
    fresh: bool = False
    radius: float = _NEAR
    quiet: int = 0

    @property
    def chi2(self) -> float:
        return float(self.residual @ self.residual)

    def jacobian(self, problem: Problem) -> Array:
        assert self.slope is not None
        return np.vstack([problem.whiten @ self.slope, np.diag(1.0 / self.rival.width)])


def fit_rivals(
    problem: Problem,
    rivals: Sequence[Rival],
    starts: Sequence[Sequence[Start]],
    iterations: int = 10,
    hopeless: float = np.inf,
    clouds: int = 0,
    exact: bool = True,
) -> list[Fit]:
    """Fit rivals from their starts, all in step.

    Parameters
    ----------
    problem : Problem
    rivals : sequence of Rival
    starts : sequence of sequence of Start
        For each rival at least one.
    iterations : int
        Most steps of a start.
    hopeless : float
        Rivals farther than this behind the best after two steps are not refined.
    clouds : int
        Rounds of random points about every end, which get over steps that stop a slope.
    exact : bool
        Whether the derivatives at the end are taken anew; otherwise they are those of the last
        steps.

    Returns
    -------
    list of Fit
        The best start of each rival.
    """
    low, high = problem.limits()
    groups = [
        [_Walk(rival, np.clip(start.x, low, high), np.zeros(0), np.zeros(0), start.slope)
         for start in points]
        for rival, points in zip(rivals, starts, strict=True)
    ]  # fmt: skip
    walks = [walk for group in groups for walk in group]
    if not walks:
        return []
    data = problem.predicted(np.stack([walk.x for walk in walks]))
    for walk, row in zip(walks, data, strict=True):
        walk.predicted, walk.residual = row, _residual(problem, walk.rival, walk.x, row)
    active = walks
    for count in range(iterations):
        _derive(problem, [walk for walk in active if walk.slope is None], low, high)
        _advance(problem, active, low, high)
        active = [walk for walk in active if walk.quiet < 2]
        if count >= 1:
            best = min(walk.chi2 for walk in walks) + hopeless
            active = [walk for walk in active if walk.chi2 < best]
        if count >= 3:
            leads = {id(walk): min(each.chi2 for each in group)
                     for group in groups for walk in group}  # fmt: skip
            active = [walk for walk in active if walk.chi2 < leads[id(walk)] + _BEHIND]
        if not active:
            break
    _derive(problem, [walk for walk in walks if walk.slope is None], low, high)
    for number in range(clouds):
        _scatter(problem, walks, low, high, number)
    winners = [min(group, key=lambda walk: walk.chi2) for group in groups]
    if exact:
        limit = min(walk.chi2 for walk in walks) + hopeless
        _derive(problem, [each for each in winners if each.chi2 < limit], low, high, central=True)
    return [_fit(problem, winner, group) for winner, group in zip(winners, groups, strict=True)]


def _residual(problem: Problem, rival: Rival, x: Array, predicted: Array) -> Array:
    data = problem.whitened(predicted[None, :])[0]
    return np.concatenate([data, -x[rival.free] / rival.width])


def _scatter(
    problem: Problem, walks: Sequence[_Walk], low: Array, high: Array, number: int
) -> None:
    """Move each walk to the best of some points about it, wide and narrow in turn."""
    random = np.random.default_rng([number, 3])
    rows = []
    for walk in walks:
        free = walk.rival.free
        scale = (1.0, 0.4, 0.15)[number % 3]
        jacobian = walk.jacobian(problem)
        lower = np.linalg.cholesky(np.linalg.inv(jacobian.T @ jacobian))
        draws = random.standard_normal((_CLOUD, len(free)))
        width = np.clip(np.sqrt(np.sum(lower**2, axis=1)), 0.03, 0.5)
        step = np.where(np.arange(_CLOUD)[:, None] % 2 == 0, draws @ lower.T, draws * width)
        points = np.tile(walk.x, (_CLOUD, 1))
        points[:, free] += scale * step
        rows.append(np.clip(points, low, high))
    data = problem.predicted(np.vstack(rows)).reshape(len(walks), _CLOUD, -1)
    for walk, points, predicted in zip(walks, rows, data, strict=True):
        _move(problem, walk, points, predicted)


def _move(problem: Problem, walk: _Walk, points: Array, predicted: Array) -> float:
    """Go to the best of some points if it is better; the fall of chi-square, or less than 0."""
    residuals = [
        _residual(problem, walk.rival, x, row) for x, row in zip(points, predicted, strict=True)
    ]
    costs = [float(each @ each) for each in residuals]
    best = int(np.argmin(costs))
    fall = walk.chi2 - costs[best]
    if fall > 0.0:
        walk.x, walk.predicted, walk.residual = points[best], predicted[best], residuals[best]
        walk.fresh = False
    return fall


def _derive(
    problem: Problem, walks: Sequence[_Walk], low: Array, high: Array, central: bool = False
) -> None:
    """Derivatives of all walks by one batch of differences, one-sided or central."""
    rows, owner, widths = [], [], []
    for number, walk in enumerate(walks):
        width = np.full(len(walk.rival.free), _WIDE)
        if walk.slope is not None:
            spread = 1.0 / np.sqrt(np.sum(walk.jacobian(problem) ** 2, axis=0))
            width = np.clip(spread, _NARROW, _WIDE)
        for column, k in enumerate(walk.rival.free):
            above, below = walk.x.copy(), walk.x.copy()
            above[k] = min(walk.x[k] + width[column], high[k])
            below[k] = max(walk.x[k] - width[column], low[k])
            if central:
                rows += [above, below]
                widths.append(max(above[k] - below[k], 1e-12))
                continue
            # To the side with room.
            up = above[k] - walk.x[k] >= 0.5 * width[column]
            rows.append(above if up else below)
            owner.append(number)
            widths.append((above if up else below)[k] - walk.x[k])
    predicted = np.zeros((0, len(problem.observed)))
    if rows:
        predicted = problem.predicted(np.stack(rows))
    if central:
        gaps = predicted[::2] - predicted[1::2]
    else:
        level = np.array([walks[number].predicted for number in owner])
        gaps = predicted - level.reshape(predicted.shape)
    slopes = gaps / np.array(widths)[:, None]
    slopes = np.where(np.isfinite(slopes), slopes, 0.0)
    at = 0
    for walk in walks:
        count = len(walk.rival.free)
        walk.slope, walk.fresh = slopes[at : at + count].T.copy(), True
        at += count


def _advance(problem: Problem, walks: Sequence[_Walk], low: Array, high: Array) -> None:
    """One step of each walk inside its trust radius, the better of a long and a short one."""
    rows, hoped = [], []
    for walk in walks:
        jacobian = walk.jacobian(problem)
        normal = jacobian.T @ jacobian
        slope = jacobian.T @ walk.residual
        for share in _SHARES:
            step = _within(normal, slope, share * walk.radius)
            point = walk.x.copy()
            point[walk.rival.free] += step
            rows.append(np.clip(point, low, high))
            taken = (rows[-1] - walk.x)[walk.rival.free]
            hoped.append(float(2.0 * slope @ taken - taken @ normal @ taken))
    points = np.stack(rows)
    count = len(_SHARES)
    predicted = problem.predicted(points)
    for number, walk in enumerate(walks):
        mine = slice(count * number, count * (number + 1))
        exact, before = walk.fresh, walk.x
        slope_now = _broyden(walk, points[mine], predicted[mine])
        fall = _move(problem, walk, points[mine], predicted[mine])
        walk.slope = slope_now
        took = [np.array_equal(walk.x, point) for point in points[mine]]
        promised = hoped[mine][took.index(True)] if fall > 0.0 else max(hoped[mine])
        good = fall > _GOOD * promised
        length = float(np.linalg.norm(walk.x - before))
        if fall <= 0.0:
            # Updates that went astray are replaced before the radius is blamed.
            if exact:
                walk.radius *= 0.2
            else:
                walk.slope = None
        elif not good:
            walk.radius = max(0.5 * length, 1e-3)
            walk.slope = None if not exact else walk.slope
        elif took[0]:
            walk.radius = min(2.0 * walk.radius, _FAR)
        small = fall < _SETTLED and (exact or promised < _SETTLED)
        walk.quiet = walk.quiet + 1 if small else 0


def _within(normal: Array, slope: Array, radius: float) -> Array:
    """Step of least predicted chi-square that is no longer than the radius."""
    values, vectors = np.linalg.eigh(normal)
    along = vectors.T @ slope
    values = np.maximum(values, 1e-12)

    def length(damping: float) -> float:
        return float(np.linalg.norm(along / (values + damping)))

    damping = 0.0
    if length(0.0) > radius:
        low, high = 0.0, float(np.linalg.norm(along)) / radius
        for _ in range(40):
            damping = 0.5 * (low + high)
            low, high = (damping, high) if length(damping) > radius else (low, damping)
    return np.asarray(vectors @ (along / (values + damping)))


def _broyden(walk: _Walk, points: Array, predicted: Array) -> Array:
    """Derivatives that agree with what the steps from here have shown."""
    assert walk.slope is not None
    slope = walk.slope
    for point, row in zip(points, predicted, strict=True):
        step = (point - walk.x)[walk.rival.free]
        length = float(step @ step)
        gap = row - walk.predicted - slope @ step
        # A short step says more of the jumps of the model than of its slope.
        if length > _SECANT**2 and np.all(np.isfinite(gap)):
            slope = slope + np.outer(gap, step) / length
    return slope


def _fit(problem: Problem, best: _Walk, walks: Sequence[_Walk]) -> Fit:
    ends = sorted(walk.chi2 for walk in walks)
    assert best.slope is not None
    jacobian = best.jacobian(problem)
    scaled = jacobian * best.rival.width
    determinant = np.linalg.slogdet(scaled.T @ scaled)[1]
    m = len(problem.observed)
    return Fit(
        best.rival,
        best.x,
        best.chi2,
        float(np.sum(best.residual[:m] ** 2)),
        best.residual,
        jacobian,
        best.slope,
        float(-0.5 * best.chi2 - 0.5 * determinant),
        len(ends) > 1 and ends[1] - ends[0] < AGREE,
        tuple(ends),
    )
