"""Outliers of a measured walker: readings that are left out, as they are none of what was measured.

A reading is left out if it lies farther than `FAR` robust standard deviations from the value that
the other readings let expect. What that is differs with the table: repeats of a condition have
their median; a curve that was never repeated the line through two neighbours; rows with several
settings a fit to all others; frames of nearly one phase, which are many, a running median; frames
of a track the frames that lead to them and on from them.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from stickslip._util.arrays import Array, Indices, Mask
from stickslip.diagnosis.data.outliers import FAR, FEW, robust_sd
from stickslip.errors import ScenarioError

FAR_FROM_PHASE = 14.0
"""The same of frames. Chosen: nine neighbours tell a scale to some 40 %, and of thousands of frames
none that is sound should go: one in 10,000 of the same law is as far."""

NEIGHBOURS = 9
"""Frames of nearly the same phase that are compared. Chosen: four of them may be wrong."""

_BEND = 3.5  # standard deviations; chosen: one normal error in 2000 is as far
_SHARE, _QUANTILE = 0.8, 1.2816  # of normal errors four fifths are below so many sd
_ENOUGH = 2000  # trials; chosen: they tell a scale to 3 %, and more would only cost time
_GRID, _WIDEST = 40, 50.0  # steps and reach of a scale about the median; chosen: 22 % a step
_SOME, _SOME_NORMAL = 0.25, 0.3186  # a quarter of normal errors are below so many sd
ONE_TRACK = "the track of one body"
"""Words of refusals: the places that are allowed."""

_RETURN = 0.1  # of the way from frame to frame, back after two; chosen: no walk returns so often
_OTHER = 8  # frames in a row that are another body; chosen: as many as make a velocity


def far_from_their_group(values: Array, group: Indices) -> tuple[Mask, Array]:
    """Which values are far from the median of their group, and these medians, shape (n,).

    Groups of fewer than three tell nothing of their own values. The scale has a part that does not
    fall with the level: small values scatter by more than their share.
    """
    deviation, level = np.zeros(values.shape), np.zeros(values.shape)
    for label in np.unique(group):
        inside = group == label
        level[inside] = np.median(values[inside])
        if inside.sum() >= 3:
            deviation[inside] = np.abs(values[inside] - level[inside])
    # The median of three leaves one deviation at zero, so the rest are the scale.
    positive = deviation > 0.0
    if not positive.any():
        return positive, level
    return deviation > FAR * _scale(deviation[positive], level[positive])(level), level


def _scale(deviation: Array, level: Array) -> Callable[[Array], Array]:
    """Standard deviation at a level, sqrt(a^2 + (b level)^2).

    The likeliest of a grid under Student's law with two degrees of freedom, which wild values do
    not move, made to agree with the median. Of a long table some values tell enough.
    """
    if len(deviation) > _ENOUGH:
        some = np.random.default_rng(0).choice(len(deviation), _ENOUGH, replace=False)
        deviation, level = deviation[some], level[some]
    moving = np.abs(level[level != 0.0])
    size = float(np.median(moving)) if len(moving) else 1.0
    parts = float(np.median(deviation)) * np.geomspace(1.0 / _WIDEST, _WIDEST, _GRID)
    floor, slope = (axis.ravel() for axis in np.meshgrid(parts, parts / size))
    scale = np.hypot(floor[:, None], slope[:, None] * level)
    loss = np.sum(np.log(scale) + 1.5 * np.log1p(0.5 * (deviation / scale) ** 2), axis=1)
    best = int(np.argmin(loss))
    unit = float(robust_sd(deviation / scale[best]))
    return lambda at: np.asarray(unit * np.hypot(floor[best], slope[best] * at))


def far_from_their_neighbours(distance: Array, slope: Array, least: float) -> Mask:
    """Which rows are far from the line through their two neighbours, which agree with each other.

    `distance`, shape (n,), is that from the line, and `slope` the difference of the neighbours:
    where that is half the distance the curve is steep. A distance below `least` is never far.
    """
    limit = max(FAR * float(robust_sd(distance)), least)
    return np.asarray((np.abs(distance) > limit) & (np.abs(distance) > 2.0 * np.abs(slope)))


def free_of_bends(distance: Array) -> Mask:
    """Which distances from a line through neighbours are errors, and no bends of the curve.

    For an estimate of the noise alone: bends are more than a few, so the limit is nearer, and the
    scale is that of four fifths; no reading is left out for them.
    """
    size = np.abs(distance)
    return np.asarray(size <= _BEND * float(np.quantile(size, _SHARE)) / _QUANTILE)


def far_from_a_fit(fit: Callable[[Mask], Array | None], count: int, floor: float) -> Mask:
    """Which of `count` rows are far from a fit to the others, if they are few; else none.

    ``fit(rows)`` gives the residuals of a fit to these rows, shape (rows, components), or None
    where they are too few. No standard deviation below `floor` is used as the scale.
    """
    near = np.ones(count, dtype=bool)
    # One by one, as the worst row shifts the fit of all others.
    for _ in range(int(FEW * count) + 1):
        left = fit(near)
        if left is None:
            break
        size = np.max(np.abs(left), axis=1)
        if np.max(size) <= FAR * max(float(robust_sd(left)), floor):
            return np.asarray(~near)
        near[np.flatnonzero(near)[np.argmax(size)]] = False
    return np.zeros(count, dtype=bool)


def far_from_their_phase(level: Array, quantum: float) -> Mask:
    """Which frames are far from those of nearly the same phase.

    `level`, shape (n,), is in the order of the phase, which is periodic, without what else is
    known of the frames; `quantum` is the step to which it is rounded, 0 for none.
    """
    if len(level) < 2 * NEIGHBOURS:
        return np.zeros(len(level), dtype=bool)
    half = NEIGHBOURS // 2
    window = np.lib.stride_tricks.sliding_window_view(
        np.concatenate([level[-half:], level, level[:half]]), NEIGHBOURS
    )
    middle = np.median(window, axis=1)
    spread = robust_sd(window - middle[:, None], axis=1)
    # Rounding scatters evenly over a step, which has the variance of a twelfth.
    usual = max(float(np.median(spread)), quantum / math.sqrt(12.0))
    return np.asarray(np.abs(level - middle) > FAR_FROM_PHASE * np.maximum(spread, usual))


def one_place_each(t: Array, x: Array) -> Indices:
    """Frames in the order of time, each time once; two places at one are refused."""
    order = np.argsort(t, kind="stable")
    t, x = t[order], x[order]
    again = np.append(False, np.diff(t) == 0.0)
    two = np.flatnonzero(again & np.append(False, np.diff(x) != 0.0))
    if len(two):
        k = int(two[0])
        raise ScenarioError(
            f"x: two places at t = {t[k]:.6g} s, {x[k - 1]:.6g} and {x[k]:.6g} m: allowed is one, "
            f"{ONE_TRACK}; of times that were rounded write more digits"
        )
    return np.asarray(order[~again])


def lost_frames(t: Array, x: Array, size: float) -> Mask:
    """Which frames show no place of the tracked body; frames of another body are refused.

    `t`, shape (n,), s, rises; `x`, shape (n,), m; `size` is the length of the body, m. The track is
    cut where a frame lies farther from the one before than half a body, or than the others let
    expect. The body is on the longest sequence of pieces of which each begins where an earlier one
    ends. A piece that is not on it is of another body if it is long; whole numbers of metres are
    what trackers write where they see none.
    """
    if len(x) >= _OTHER:
        _refuse_turns(t, x, size)
    step = np.diff(x)
    away = x - float(np.median(step / np.diff(t))) * (t - t[0])
    jump = np.abs(np.diff(away))
    # Two of three frames may be lost.
    usual = float(np.quantile(jump, _SOME, method="lower")) / _SOME_NORMAL
    far = max(0.5 * size, FAR * usual)
    pieces = np.split(np.arange(len(x)), np.flatnonzero(jump > far) + 1)
    held, before = [len(piece) for piece in pieces], [-1] * len(pieces)
    for k, piece in enumerate(pieces):
        for j in range(k):
            near = abs(away[piece[0]] - away[pieces[j][-1]]) <= far
            if near and held[j] + len(piece) > held[k]:
                held[k], before[k] = held[j] + len(piece), j
    off, k = np.ones(len(x), dtype=bool), int(np.argmax(held))
    while k >= 0:
        off[pieces[k]] = False
        k = before[k]
    for piece in pieces:
        if off[piece[0]] and len(piece) >= _OTHER and np.any(x[piece] != np.round(x[piece])):
            begin = max(int(piece[0]), int(np.argmin(off)))
            raise ScenarioError(
                f"x: another body from t = {t[begin]:.6g} s on, at {x[begin]:.6g} m: "
                f"allowed is {ONE_TRACK}"
            )
    return off


def _refuse_turns(t: Array, x: Array, size: float) -> None:
    """Refuse two bodies whose places take turns, each of them moving."""
    one, two = (float(np.median(np.abs(x[k:] - x[:-k]))) for k in (1, 2))
    moving = all(np.any(some != np.round(some)) for some in (x[::2], x[1::2]))
    if moving and one > size and two < _RETURN * one:
        raise ScenarioError(
            f"x: two places in turn, {x[0]:.6g} and {x[1]:.6g} m at t = {t[0]:.6g} and {t[1]:.6g} "
            f"s: allowed is {ONE_TRACK}"
        )
