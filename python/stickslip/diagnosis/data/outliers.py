"""Outliers: readings that are left out, as they are no readings of what was measured.

Of a log, whose curve is what is asked, that are readings beyond the span of all others or, where
they are alike, far from the readings before and after them.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from stickslip._util.arrays import Array, Indices, Mask

FAR = 8.0
"""Robust standard deviations beyond which a reading is left out. Chosen: one normal error in 1e15
and one of Student's law with four degrees of freedom in 1000 is as far; a wrong unit is farther."""

ROBUST = 1.48
"""Standard deviation over the median of absolute deviations, of a normal law: 1 / 0.6745."""

_RECORD, _SINGLE, _SPANS, _WILD = 20, 3, 3.0, 1e6
"""Fewest readings of a record, most that are left out of it, and how many spans of all others they
lie beyond these: single ones, and neighbours of one value. Chosen: no motion does the first for one
reading, nor the second at all; what meters write for none does."""

FEW = 0.05
"""Part of the rows that may be left out. Chosen: where more are far it is the fit that is wrong, or
the sensor."""

_ALIKE, _MOST_ALIKE, _STEEP, _TAKEN = 3, 1.0 / 3.0, 3.0, 0.5
"""Fewest places of alike readings that are lost, two if beyond all others; the largest part of the
rows; how many times farther from their neighbours than these from each other; and the part that may
lie near. Chosen: a rest is entered and left by steps that are no smaller than those beside it."""
_APART = 4.0
"""Usual bends of the curve by which a reading has to be beyond both neighbours, once others of its
value are lost. Chosen on 300 made records, of which no sound reading was lost."""

_USUAL_STEPS = 0.8  # part of the steps of a curve that are no larger; chosen
_TRIED, _JUMP = 20, 0.1  # values; of an input's range, which is no noise of it; chosen
_RUN = 5  # readings of a place, on average; chosen: longer ones may be a level that is held


def robust_sd(deviation: Array, axis: int | None = None) -> Array:
    """Standard deviation from the median of absolute values, which a few outliers do not change."""
    return np.asarray(ROBUST * np.median(np.abs(deviation), axis=axis))


def far_from_all_others(y: Array) -> Mask:
    """Which readings of a record, a few or neighbours of one value, are beyond all others."""
    far = np.zeros(len(y), dtype=bool)
    order = np.argsort(np.abs(y - np.median(y)), kind="stable")
    for count in range(1, _SINGLE + 1) if len(y) >= _RECORD else ():
        top, others = np.sort(order[-count:]), y[order[:-count]]
        low, high = float(others.min()), float(others.max())
        beyond = np.abs(y[top] - np.clip(y[top], low, high))
        one_value = (np.diff(y[top]) == 0.0) & (beyond[1:] > _WILD * (high - low))
        single = np.all((np.diff(top) > 1) | one_value)
        if high > low and np.all(beyond > _SPANS * (high - low)) and single:
            far[:] = False
            far[top] = True
    return far


def alike_and_lost(y: Array, acting: Iterable[Array]) -> list[Mask]:
    """Readings of one value each that a lost sensor gave, such as -127 or 0: single ones and runs.

    They are far from the readings before and after them, which agree; hardly one of that value is
    near, and hardly another reading is as far. Where an input jumps with them they are sound.
    """
    step, found, left = np.abs(np.diff(y)), [], np.ones(len(y), dtype=bool)
    if len(y) < _RECORD or not step.any():
        return []
    entered = y[1:][step > _STEEP * float(np.median(step))]
    values, counts = np.unique(entered, return_counts=True)
    for value in values[np.argsort(-counts, kind="stable")[:_TRIED]][: np.sum(counts > 1)]:
        alike, others = left & (y == value), np.flatnonzero(left & (y != value))
        if alike.sum() > _MOST_ALIKE * len(y) or len(others) < _RECORD // 2:
            continue
        lost = alike & _off_the_curve(y, value, np.flatnonzero(alike), others, acting)
        if lost.any():
            found.append(alike if _is_beyond(value, y[others]) else lost)
            left &= ~found[-1]
    return found


def _is_beyond(value: float, curve: Array) -> bool:
    """Whether a value is beyond a curve by more than its steps: it may rest where it ends."""
    beyond = max(float(np.min(curve)) - value, value - float(np.max(curve)))
    return beyond > _STEEP * float(np.quantile(np.abs(np.diff(curve)), _USUAL_STEPS))


def _off_the_curve(
    y: Array, value: float, at: Indices, others: Indices, acting: Iterable[Array]
) -> Mask:
    """Which rows are of a lost sensor, if those of `value`, `at`, are; none if they are not."""
    none = np.zeros(len(y), dtype=bool)
    curve, place = y[others], np.searchsorted(others, at)
    inside = (place >= 2) & (place <= len(others) - 2)
    at, place = at[inside], place[inside]
    step = np.abs(np.diff(curve))
    bend = np.abs(curve[1:-1] - 0.5 * (curve[:-2] + curve[2:]))
    usual = float(np.median(bend[bend > 0.0])) if bend.any() else 0.0
    near = np.max([step[place - 2], step[place - 1], step[place]], axis=0)
    before, after = value - curve[place - 1], value - curve[place]
    away = 0.5 * np.abs(before + after)
    apart = np.where(before * after > 0.0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    limit = np.maximum(_STEEP * near, FAR * usual)
    far = away > limit
    places = len(np.unique(place[far]))
    if not _ALIKE - _is_beyond(value, curve) <= places <= np.sum(far) <= _RUN * places:
        return none
    held = np.bincount(place)[place]
    lost = far | ((apart > _APART * usual) & (held <= _RUN))
    if np.sum(~lost) > _TAKEN * np.sum(lost):
        # The curve is often there: single readings alone, far from both neighbours, are none of it.
        lost = (apart > limit) & (held == 1)
        if np.sum(lost) < _ALIKE:
            return none
    as_far = bend > 0.5 * np.median(away[far])
    turned = np.abs(curve[2:] - curve[:-2]) < 0.5 * np.median(away[far])
    if np.sum(as_far & turned) > _TAKEN * places:
        return none
    for row in acting:
        jump = np.append(0.0, np.abs(np.diff(row))) > _JUMP * np.ptp(row)
        jump[1:] |= jump[:-1]
        share = float(np.mean(jump[at[far]]))
        if share > 0.5 and share > 1.5 * float(np.mean(jump[others])):
            return none
    none[at[lost]] = True
    return none


def far_readings(deviation: Array) -> Mask:
    """Which deviations from a model are far beyond all others, if they are few; else none."""
    far = np.abs(deviation) > FAR * max(float(robust_sd(deviation)), 1.0)
    return far & bool(np.sum(far) <= FEW * len(far))
