"""What makes the data itself suspect, before any cause is blamed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import mannwhitneyu
from scipy.stats import t as t_law

from stickslip._util.arrays import Array, Indices
from stickslip.diagnosis.data.trial_noise import (
    NoiseModel,
    column_basis,
    completed,
    moving,
    setup_columns,
)
from stickslip.facts import Code, Fact

FEWEST_CONDITIONS = 4
"""Conditions without which no cause is told from another, if there are no other data. Chosen: two
constants and a cause leave one degree of freedom."""

_RARE = 0.002
"""p-value below which a drift or an uneven set-up is said. Chosen: one in 500 sound data sets."""

_LASTING = 0.97
"""Correlation of errors that follow each other above which they are a drift themselves. Chosen:
such errors last for thirty readings, most of a table."""

_SPREAD = 3.0
"""Variance of the conditions, in units of that of their means' errors, below which they are alike.
Chosen: means of nothing but noise have 1."""

_FEWEST_PAIRS = 12
"""Pairs or trials, and ordered trials, to judge by. Chosen: a share or a rank test of fewer says
little."""

_ALIKE = 0.4
"""Share of pairs of trials that read exactly alike; see `_rounded`."""

_UNEVEN = 1.5
"""Ratio of median deviations from which on a set-up is called uneven. Chosen: its trials then weigh
more than twice too much."""

_ALONE = 0.05
"""Part of a trial's variance that fits of levels and set-ups leave, below which it shows no
scatter. Chosen: such a trial stands nearly alone in its condition or set-up."""


def find_data_problem(
    values: Array,
    index: Indices,
    noise: NoiseModel,
    order: ArrayLike | None,
    block: Indices | None = None,
    alone: bool = True,
) -> Fact | None:
    """What makes the data itself suspect, if anything does.

    Few trials, or trials without repeats, are no trouble where they do not stand alone: other data
    can tell causes apart.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Trials, in the observable's unit.
    index : ndarray of int, shape (n,)
        Index of each trial's condition, 0 to m - 1, none missing.
    noise : NoiseModel
        Noise of these trials.
    order : array_like, shape (n,), optional
        Place of each trial in time; NaN where it is not known.
    block : ndarray of int, shape (n,), optional
        Index of each trial's set-up; -1 where it is not known.
    alone : bool
        Whether there are no other data.

    Returns
    -------
    Fact, optional
    """
    if np.all(values == 0.0):
        return Fact(Code.ALL_ZERO, {})
    count = len(noise.mean)
    if alone and count < FEWEST_CONDITIONS:
        return Fact(Code.TOO_FEW_CONDITIONS, {"count": count, "needed": FEWEST_CONDITIONS})
    if alone and noise.dof == 0.0:
        return Fact(Code.NO_NOISE, {})
    if 0.0 < noise.dof < math.inf and count > 3:
        between, within = float(np.var(noise.mean)), float(np.mean(noise.sd**2 / noise.count))
        if between < _SPREAD * within:
            ratio = {"ratio": between / within, "needed": _SPREAD}
            return Fact(Code.CONDITIONS_ALIKE, ratio)
    rounded = _rounded(values, index) if noise.dof < math.inf else None
    return rounded or _drifting(values, index, noise, order, completed(block))


def _rounded(values: Array, index: Indices) -> Fact | None:
    """A fact if readings are in steps so wide that the scatter of trials is not their error.

    If two trials with normal errors are rounded to steps of q, a share q / (2 sqrt(pi) sd) of them
    reads alike: 0.4 of them at 1.4 sd, where rounding adds half to the variance of a mean of three.
    """
    pairs = alike = 0
    for each in np.unique(index[moving(values, index)]):
        mine = values[index == each]
        counts = np.unique(mine, return_counts=True)[1]
        pairs += len(mine) * (len(mine) - 1) // 2
        alike += int(np.sum(counts * (counts - 1) // 2))
    if pairs < _FEWEST_PAIRS or alike in (pairs, 0) or alike < _ALIKE * pairs:
        return None
    return Fact(Code.ROUNDED, {"percent": 100.0 * alike / pairs, "limit": 100.0 * _ALIKE})


def uneven_setups(
    values: Array, index: Indices, noise: NoiseModel, block: Indices | None
) -> Fact | None:
    """A note if the trials of one set-up scatter more than all others.

    Such a set-up has too much weight, but a diagnosis remains possible. Tested by ranks, so that
    heavy tails of all set-ups do not count. Residuals are scaled up by the variance that the fitted
    levels have taken. The true ratio is larger than that of the residuals, as every set-up is a
    part of the means.
    """
    block = completed(block)
    if block is None or not noise.setups.shape[1]:
        return None
    used = moving(values, index)
    values, index, block = values[used], index[used], block[used]
    basis = column_basis(_design(index, block, noise))
    free = 1.0 - np.sum(basis**2, axis=1)
    shown = free > _ALONE
    scatter = (values - noise.mean[index]) / noise.sd[index]
    size = np.abs(_projected(scatter, basis)) / np.sqrt(np.maximum(free, _ALONE))
    counts = np.bincount(block[shown], minlength=int(block.max()) + 1)
    looked = np.flatnonzero((counts >= _FEWEST_PAIRS) & (shown.sum() - counts >= _FEWEST_PAIRS))
    for each in looked.tolist():
        mine, others = size[shown & (block == each)], size[shown & (block != each)]
        ratio = float(np.median(mine) / np.median(others)) if np.median(others) > 0.0 else math.inf
        chance = float(mannwhitneyu(mine, others, alternative="greater").pvalue)
        p_value = len(looked) * chance
        if ratio > _UNEVEN and p_value < _RARE:
            uneven = {"setup": each + 1, "ratio": ratio, "p_value": p_value}
            return Fact(Code.UNEVEN_SETUP, uneven)
    return None


def _design(index: Indices, block: Indices | None, noise: NoiseModel) -> Array:
    """Levels of the conditions, and shifts and gains of the set-ups where they are known."""
    design = np.eye(len(noise.mean))[index]
    if block is None or not noise.setups.shape[1]:
        return design
    return np.hstack([design, setup_columns(index, block, noise.mean)])


def _projected(values: Array, basis: Array) -> Array:
    """Values without what the columns of an orthonormal basis explain."""
    return np.asarray(values - basis @ (basis.T @ values))


def _drifting(
    values: Array, index: Indices, noise: NoiseModel, order: ArrayLike | None, block: Indices | None
) -> Fact | None:
    """A fact if velocities change with time; what differs between set-ups is not drift."""
    place = np.full(len(values), np.nan) if order is None else np.asarray(order, dtype=float)
    usable = np.isfinite(place) & moving(values, index)
    if usable.sum() < _FEWEST_PAIRS:
        return None

    def independent(columns: Array) -> Array:
        """In which errors that are correlated along a run, as a drift is, are independent."""
        if noise.runs is None or noise.correlation is None:
            return columns
        if noise.correlation.value > _LASTING:
            return columns
        flat, runs = columns.reshape(len(columns), -1), noise.runs.at(np.flatnonzero(usable))
        return runs.whitened(flat, noise.correlation.value).reshape(columns.shape)

    basis = column_basis(independent(_design(index, block, noise)[usable]))
    free = int(usable.sum()) - basis.shape[1] - 1
    timed = independent(place[usable])
    centred = _projected(timed, basis)
    if free < 1 or float(centred @ centred) <= 1e-9 * float(timed @ timed):
        return None
    # A drift shifts all velocities alike, or all in proportion, whatever their sign.
    scatter = (values - noise.mean[index]) / noise.sd[index]
    chances = [
        _drift(_projected(independent((scatter * toward)[usable]), basis), centred, free)
        for toward in (1.0, np.sign(noise.mean[index]))
    ]
    p_value = 2.0 * min(chances)
    return Fact(Code.DRIFT, {"p_value": p_value, "level": _RARE}) if p_value < _RARE else None


def _drift(residual: Array, centred: Array, free: int) -> float:
    """p-value of a slope of residuals against time, with conditions and set-ups projected out."""
    power = float(centred @ centred)
    slope = float(centred @ residual) / power
    left = residual - slope * centred
    score = slope * math.sqrt(power) / math.sqrt(max(float(left @ left) / free, 1e-12))
    return 2.0 * float(t_law.sf(abs(score), free))
