"""Noise of a trial and of a set-up, pooled over all conditions, or stated by the user.

Three trials have two degrees of freedom, so no condition has a variance of its own: all share one
curve sd^2 = s0^2 + (rho v)^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.arrays import Array, Indices, Mask
from stickslip._util.one_line import OneLine
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact

if TYPE_CHECKING:
    from stickslip.diagnosis.data.autoregression import ErrorCorrelation, Runs

FEWEST_DOF = 4
"""Degrees of freedom from which on the noise is taken from the trials and not from a statement.
Chosen: four determine a standard deviation to 35 %."""

_WIDEST, _POINTS = (-4.0, 2.0), 31
"""Range of the logarithms of s0 and rho about the pooled scatter, and points of each. Chosen: from
2 % of it, which adds nothing to the other, to seven times."""

_NEGLIGIBLE = 1e-5
"""Posterior density over its maximum that does not count. Chosen: all that is left out is less than
1 % of the sum."""

_CLOSE = 0.5
"""Shrinkage of the range beyond which it is sampled again. Chosen: a posterior that fills half of
the points is resolved."""

_ALIKE = 1e-9
"""Part of the usual velocity by which trials differ that differ by rounding alone. Chosen: between
the rounding of a double, 1e-16, and that of any table."""

_SCATTERS = [0.0, *np.geomspace(0.05, 8.0, 40).tolist()]
"""Scatters of set-ups in units of a trial's sd that are tried. Chosen: 14 % apart, from what no
measurement resolves to far above what a mean of trials is good for."""


@dataclass(frozen=True, repr=False, eq=False)
class NoiseModel(OneLine):
    """Noise of the mean of each condition's trials.

    Attributes
    ----------
    mean : ndarray, shape (m,)
        Mean of the trials, in the observable's unit.
    sd : ndarray, shape (m,)
        Standard deviation of one trial.
    count : ndarray, shape (m,)
        Number of trials.
    floor, relative : float
        s0 in the observable's unit, and rho.
    between, between_gain : float
        Scatter of set-ups in units of `sd`: of a shift that has one sign for all conditions, and of
        a gain, which has that of the condition's level.
    dof : float
        Degrees of freedom; infinity where the noise was stated, 0 where nothing is known.
    setups : ndarray, shape (m, set-ups)
        Share of each condition's trials in each set-up; no columns where that is not known.
    notes : tuple of Fact
    correlation : ErrorCorrelation, optional
        Of the errors within runs, where it could be estimated; see `with_correlation`.
    runs : Runs, optional
        Runs of the trials, where their errors are taken as correlated.
    mean_correlation : ndarray, shape (m, m), optional
        There, the covariance of the means in units of `sd`.
    """

    mean: Array
    sd: Array
    count: Indices
    floor: float
    relative: float
    between: float
    between_gain: float
    dof: float
    setups: Array
    notes: tuple[Fact, ...]
    correlation: ErrorCorrelation | None = None
    runs: Runs | None = None
    mean_correlation: Array | None = None

    @property
    def shared(self) -> bool:
        """Whether conditions share errors that are in proportion to a level."""
        correlated = self.mean_correlation is not None and self.relative > 0.0
        return correlated or self.between > 0.0 or self.between_gain > 0.0

    @property
    def covariance(self) -> Array:
        """Covariance of `mean`, shape (m, m), from the trials alone."""
        return self.covariance_at(self.mean)

    def covariance_at(self, level: Array) -> Array:
        """Covariance of `mean`, with errors that conditions share in proportion to a level, (m,).

        An error that many conditions share, by their set-up or their place in a run, must not
        follow what was measured: conditions that came out low would then weigh more, and a fit
        would end below them all.
        """
        sd = np.sqrt(self.floor**2 + (self.relative * level) ** 2)
        shift = self.setups * sd[:, None]
        gain = shift * np.sign(level)[:, None]
        own = np.diag(self.sd**2 / self.count)
        if self.mean_correlation is not None:
            # Without a curve of the noise the errors are as they were stated.
            sd = sd if self.relative > 0.0 else self.sd
            own = sd[:, None] * self.mean_correlation * sd
        shared = self.between**2 * shift @ shift.T + self.between_gain**2 * gain @ gain.T
        return np.asarray(own + shared)


def fit_noise(
    value: Array, condition: Indices, block: Indices | None = None, stated: float = math.nan
) -> NoiseModel:
    """Noise from the scatter of trials, or from a stated relative error.

    A robot that does not move has no scatter, which would draw s0 to zero. So conditions whose
    trials all read zero are excluded, and have the noise of a level of zero.

    Parameters
    ----------
    value : ndarray, shape (n,)
        Trials, in the observable's unit.
    condition : ndarray, shape (n,)
        Index of each trial's condition, 0 to m - 1, none missing.
    block : ndarray, shape (n,), optional
        Index of its set-up; -1 where it is not known: such a trial counts as a set-up of its own.
    stated : float
        Relative standard deviation of one trial, if known.
    """
    block = completed(block)
    m = int(condition.max()) + 1
    count = np.bincount(condition, minlength=m)
    mean = np.bincount(condition, value, minlength=m) / count
    used = moving(value, condition)
    trial, where = value[used], condition[used]
    setup = None if block is None else block[used]
    if setup is not None and len(np.unique(setup)) == 1:
        setup = None
    crossed = setup if setup is not None and _are_crossed(where, setup) else None
    moved = np.unique(where)
    deviation, dof = trial - mean[where], len(trial) - len(moved)
    leverage = 1.0 - 1.0 / count[where]
    if crossed is not None and dof > 0:
        deviation, dof, leverage = _without_setups(trial, where, crossed, mean)
    # Where nothing moved, any size will do: there is no relative error of zero.
    size = float(np.sqrt(np.mean(mean[moved] ** 2))) or 1.0
    if not np.any(np.abs(deviation) > _ALIKE * size):
        dof = 0  # readings that are all alike carry no information on the noise
    notes = []
    if dof >= FEWEST_DOF:
        squares, freedom = np.zeros(m), np.zeros(m)
        np.add.at(squares, where, deviation**2)
        np.add.at(freedom, where, leverage)
        floor, relative = _curve(squares, freedom, mean, size)
        free = float(dof)
    elif math.isfinite(stated):
        # Chosen: a tenth of the usual error is left where the velocity is near zero.
        floor, relative, free = 0.1 * stated * size, stated, math.inf
        known_by = {"dof": dof, "needed": FEWEST_DOF, "stated": stated}
        notes.append(Fact(Code.NOISE_STATED, known_by))
    else:
        floor, relative, free = size, 0.0, 0.0
        notes.append(Fact(Code.NOISE_UNKNOWN, {"dof": dof, "needed": FEWEST_DOF}))
    sd = np.sqrt(floor**2 + (relative * mean) ** 2)
    between, gain, shares = 0.0, 0.0, np.zeros((m, 0))
    if block is None or setup is None:
        notes.append(Fact(Code.NO_BLOCK_COLUMN if block is None else Code.ONE_BLOCK, {}))
    elif crossed is None:
        notes.append(Fact(Code.SETUPS_NOT_CROSSED, {}))
    else:
        between, gain = _between(trial, where, crossed, mean, sd)
        scatter = {"count": len(np.unique(crossed)), "shift": between, "gain": gain}
        notes.append(Fact(Code.SETUPS, scatter))
        shares = np.zeros((m, int(block.max()) + 1))
        np.add.at(shares, (condition, block), 1.0)
        shares /= count[:, None]
    return NoiseModel(
        mean, sd, count, floor, relative, between, gain, free, shares, tuple(notes)
    )  # fmt: skip


def stated_noise(values: Array, condition: Indices, sd: ArrayLike) -> tuple[NoiseModel, Array]:
    """Noise that the user states, and the covariance of the means of each condition's trials.

    `sd` is the standard deviation of each mean, shape () or (m,), or their covariance, (m, m).
    """
    count = np.bincount(condition)
    stated = np.asarray(sd, dtype=float)
    if stated.ndim == 2:
        if stated.shape != (len(count), len(count)) or not np.all(np.isfinite(stated)):
            raise ScenarioError("sd: allowed is a covariance of one row a condition")
        covariance = stated
    else:
        if stated.shape not in ((), count.shape):
            raise ScenarioError("sd: allowed is a standard deviation for each condition")
        covariance = np.diag(np.broadcast_to(stated, count.shape) ** 2)
    variance = np.diag(covariance)
    sound = np.all(stated > 0.0) if stated.ndim < 2 else np.all(variance > 0.0)
    if not (sound and np.all(np.isfinite(variance))):
        raise ScenarioError("sd: allowed are finite numbers above 0")
    known = np.sqrt(variance)
    mean = np.bincount(condition, values) / count
    none = np.zeros((len(count), 0))
    noise = NoiseModel(mean, known * np.sqrt(count), count, 0.0, 0.0, 0.0, 0.0, math.inf, none, ())
    return noise, covariance


def _are_crossed(condition: Indices, setup: Indices) -> bool:
    """Whether conditions and set-ups are mixed enough to separate their effects."""
    pairs = np.unique(np.stack([condition, setup]), axis=1).shape[1]
    return bool(pairs > max(len(np.unique(condition)), len(np.unique(setup)) + 1))


def moving(value: Array, condition: Indices) -> Mask:
    """Trials of conditions that do not all read zero, shape (n,); all of them if nothing moves."""
    moves = np.bincount(condition, value != 0.0) > 0
    return np.asarray(moves[condition] if moves.any() else np.ones(len(value), dtype=bool))


def completed(block: Indices | None) -> Indices | None:
    """Set-ups, each trial whose set-up is not known having its own; None if none is known."""
    if block is None or bool(np.all(block < 0)):
        return None
    lost = block < 0
    return np.asarray(np.where(lost, int(block.max()) + np.cumsum(lost), block), dtype=np.int64)


def setup_columns(condition: Indices, block: Indices, mean: Array) -> Array:
    """What a shift and what a gain of each set-up does to each trial, shape (n, 2 set-ups).

    A gain has the sign of its condition's mean.
    """
    shifts = np.eye(int(block.max()) + 1)[block]
    return np.hstack([shifts, shifts * np.sign(mean)[condition, None]])


def whitener(covariance: Array) -> Array:
    """Matrix, shape (m, m), that takes errors of this covariance to independent ones of size 1."""
    lower = np.linalg.cholesky(covariance)
    return np.linalg.inv(lower)


def _without_setups(
    value: Array, condition: Indices, setup: Indices, mean: Array
) -> tuple[Array, int, Array]:
    """Residuals of a fit of one level a condition and one shift and gain a set-up.

    And their degrees of freedom in all, and of each trial.
    """
    m = len(mean)
    levels = np.eye(m)[condition]
    # Weights are those of relative errors; chosen: slow conditions keep a tenth of the usual error.
    usual = np.median(np.abs(mean[np.unique(condition)]))
    size = np.abs(mean) + 0.1 * usual + 1e-300
    design = np.hstack([levels / size[condition, None], setup_columns(condition, setup, mean)])
    target = value / size[condition]
    basis = column_basis(design)
    residual = (target - basis @ (basis.T @ target)) * size[condition]
    leverage = np.maximum(1.0 - np.sum(basis**2, axis=1), 1e-6)
    return residual, len(value) - basis.shape[1], leverage


def column_basis(design: Array) -> Array:
    """Orthonormal basis of the columns of a design, as many as its rank."""
    left, singular, _ = np.linalg.svd(design, full_matrices=False)
    return np.asarray(left[:, singular > 1e-9 * singular[0]])


def _curve(squares: Array, freedom: Array, level: Array, size: float) -> tuple[float, float]:
    """s0 and rho, each the root of its square's posterior mean, under priors flat in the logarithm.

    The maximum would often have one of them near zero, and conditions of which that one is the
    noise would be trusted far too much. `squares`, `freedom` and `level`, shape (m,), are the sum
    of each condition's squared residuals, their degrees of freedom and the mean; `size` is the
    usual level.
    """
    spread = float(np.sum(squares) / np.sum(freedom))
    low, high = np.full(2, _WIDEST[0]), np.full(2, _WIDEST[1])
    while True:
        # Logarithms of s0, and of rho at the usual level, beside that of the pooled scatter.
        logs = np.linspace(low, high, _POINTS)
        floor, relative = (
            each.ravel() for each in np.meshgrid(*(spread * np.exp(2.0 * logs.T)), indexing="ij")
        )
        variance = floor[:, None] + relative[:, None] * (level / size) ** 2
        loss = np.log(variance) @ freedom + (1.0 / variance) @ squares
        weight = np.exp(-0.5 * (loss - np.min(loss))).reshape(_POINTS, _POINTS)
        # With many trials the posterior is narrower than one step, so the range is refined.
        width = high - low
        for axis in range(2):
            share = np.max(weight, axis=1 - axis)
            seen = np.flatnonzero(share > _NEGLIGIBLE)
            low[axis] = logs[max(seen[0] - 1, 0), axis]
            high[axis] = logs[min(seen[-1] + 1, _POINTS - 1), axis]
        if np.all(high - low > _CLOSE * width):
            break
    chance = weight.ravel() / np.sum(weight)
    return math.sqrt(float(chance @ floor)), math.sqrt(float(chance @ relative)) / size


def _between(
    value: Array, condition: Indices, block: Indices, mean: Array, sd: Array
) -> tuple[float, float]:
    """Scatter of the set-ups' shifts and gains in units of a trial's sd.

    By restricted maximum likelihood, one after the other, from the better of either alone.
    """
    # Deviations from the level of each condition; trials of one condition share their sd.
    target = _centred(((value - mean[condition]) / sd[condition])[:, None], condition)
    parts = _centred(setup_columns(condition, block, mean), condition)
    gram, along, power = parts.T @ parts, (parts.T @ target)[:, 0], float(np.sum(target**2))
    # Where all go one way a shift and a gain are the same.
    both = len(set(np.sign(mean).tolist())) > 1

    def score(taus: tuple[float, float]) -> float:
        # Of the covariance 1 + W W' with W = parts times tau, by the small matrix 1 + W' W.
        scale = np.repeat(taus, parts.shape[1] // 2)
        small = np.eye(len(scale)) + scale[:, None] * gram * scale
        seen = scale * along
        quadratic = power - float(seen @ np.linalg.solve(small, seen))
        return float(-0.5 * np.linalg.slogdet(small)[1] - 0.5 * quadratic)

    best = max(((tau, 0.0) for tau in _SCATTERS), key=score)
    if both:
        best = max([best, *((0.0, tau) for tau in _SCATTERS)], key=score)
        for _ in range(2):
            best = max(((tau, best[1]) for tau in _SCATTERS), key=score)
            best = max(((best[0], tau) for tau in _SCATTERS), key=score)
    return best


def _centred(columns: Array, condition: Indices) -> Array:
    """Columns without the mean of each condition."""
    sums = np.zeros((int(condition.max()) + 1, columns.shape[1]))
    np.add.at(sums, condition, columns)
    counts = np.maximum(np.bincount(condition), 1)
    return np.asarray(columns - (sums / counts[:, None])[condition])
