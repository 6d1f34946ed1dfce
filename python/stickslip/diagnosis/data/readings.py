"""What counts as a reading of a record: rows that no sensor gave by itself are found here.

A logger that is faster than its sensor writes each reading again; tools fill in rows by lines; a
device gives the mean of its last readings; an angle wraps; a sensor saturates. Each is told from
the readings and inputs, before any search, with one note.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array, Mask, root_mean_square
from stickslip._util.note import Note
from stickslip._util.text import counted
from stickslip._util.units import is_of, per_si
from stickslip.diagnosis.data.errors import meter_step

_ORDERS, _FLAT, _SMALL = (3, 5), 1.3, 0.5
"""Orders of the differences that tell a smooth curve from its noise, the ratio of what they say up
to which they agree, and the largest noise beside the scatter of the readings. Chosen: a sine of
five readings a period has a ratio of 1.6."""

AVERAGED = "averaged"
"""Code of the note on means of rows."""

CLIPPED = "clipped"
"""Code of the note on readings at an end of a range that are too many to be left out."""

_FEWEST, _REGULAR, _CLEAR = 20, 0.95, 3.0
"""Fewest readings that show how rows were made; the part of the rows that have to be made so; and
how many times larger than by chance or by rounding what shows it has to be. Chosen."""

_KNOWN = "a turn", "a counter"  # ranges that readings need not fill to wrap

_FILLED = 1e-4  # least part of a mean's spectrum in its zeros; chosen: 40 dB below its neighbours

_LEAST, _LONGEST, _DEEP = 5, 24, 20.0
"""Fewest readings at an end of a range and about a zero of a spectrum, the longest mean of rows,
and by how many nats a spectrum has to tell it. Chosen: 153 sound logs have at most 3, means of 3 to
24 rows at least 34; a mean of 2 rows is told from no other noise."""

GAP = 5.0
"""Usual steps from which on a row without readings is a gap in which an input may have switched.
Chosen: starts anew cost a parameter or two."""


@dataclass(frozen=True)
class Readings:
    """Rows that are readings: `y`, unwrapped, of which some are `kept`, all of shape (n,).

    The logger has averaged so many rows for each, 1 where it has not.
    """

    y: Array
    kept: Mask
    averaged: int = 1
    notes: tuple[Note, ...] = ()


def find_readings(at: str, t: Array, y: Array, unit: str, inputs: Iterable[Array]) -> Readings:
    """Find the rows of a record that are readings; notes begin with `at`. Arrays are (n,)."""
    y, notes = unwrap(at, y, unit)
    kept = np.ones(len(y), dtype=bool)
    for made, text in (
        (_repeated, "repeat the one before them: the logger is faster than its sensor"),
        (_on_lines, "lie on lines between others: filled in"),
    ):
        gone = np.flatnonzero(kept)[made(t[kept], y[kept])]
        if len(gone):
            text = f"{at}{len(gone)} of {len(y)} readings {text}. They are left out."
            notes.append(Note(made.__name__.strip("_").replace("_", "-"), text, len(gone)))
            kept[gone] = False
    gone = np.flatnonzero(kept)[_at_the_ends(t[kept], y[kept])]
    if len(gone):
        many = len(gone) > 0.5 * len(y)
        ends = " and ".join(f"{end:.6g}" for end in np.unique(y[gone]))
        text = f"{at}{len(gone)} of {len(y)} readings stand at {ends}, perhaps an end of the range"
        notes.append(Note(CLIPPED if many else "saturated",
                          f"{text}{'' if many else ', and are left out'}.", len(gone)))  # fmt: skip
        kept[gone] = many
    averaged = _averaged_rows(t, y, inputs) if kept.all() else 1
    if averaged > 1:
        row = np.arange(len(y))
        kept[:] = ((row + 1) % averaged == 0) & (row + averaged // 2 < len(y))
        text = f"{at}readings are means of {averaged} rows: one of {averaged} counts."
        notes.append(Note(AVERAGED, text, averaged))
    return Readings(y, kept, averaged, tuple(notes))


def _regular(new: Mask) -> bool:
    """Whether some rows come at distances that differ by hardly one, of at least two at times."""
    runs = np.diff(np.flatnonzero(np.r_[new, True]))
    near = np.abs(runs - np.mean(runs)) <= 1.0
    return len(runs) >= _FEWEST and bool(np.sum(runs[near]) >= _REGULAR * np.sum(runs))


def _repeated(t: Array, y: Array) -> Mask:
    """Rows with the reading of the row before, more than by chance, at even distances."""
    new = np.append(True, np.diff(y) != 0.0)
    changes = np.abs(np.diff(y[new]))
    by_chance = 0.5 * meter_step(y) / np.median(changes) if len(changes) else 1.0
    often = np.mean(~new) > max(_CLEAR * by_chance, 1.0 - _REGULAR)
    return ~new & (often and by_chance * _CLEAR < 0.5 and _regular(new))


def _on_lines(t: Array, y: Array) -> Mask:
    """Rows between two others, at even distances, that lie on a line up to rounding."""
    gone = np.zeros(len(y), dtype=bool)
    if len(y) < _FEWEST:
        return gone
    share = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
    share[np.isclose(share, 0.5)] = 0.5  # even steps, but for rounding
    off = np.abs(y[1:-1] - y[:-2] - share * (y[2:] - y[:-2]))
    steepest = float(np.max(np.abs(np.diff(y) / np.diff(t))))
    rounding = max(meter_step(y), _rounding(y), 1e-300) + steepest * _rounding(t)
    gone[1:-1] = (off <= rounding) & (np.diff(y)[1:] != 0.0)
    others = off[off > rounding]
    clear = len(others) >= _FEWEST and np.median(others) > _CLEAR**2 * rounding
    # A wave of a few rows a period lies on lines too, with few values.
    several = len(np.unique(np.round(y[~gone] / (_CLEAR * rounding)))) > 0.5 * np.sum(~gone)
    return gone & (clear and several and np.mean(gone) > 1.0 - _REGULAR and _regular(~gone))


def _at_the_ends(t: Array, y: Array) -> Mask:
    """Readings that stand at the least or the largest, as no others stand, which scatter.

    What stands at zero rests.
    """
    same, there = np.diff(y) == 0.0, (y == np.min(y)) | (y == np.max(y))
    for end in (np.min(y), np.max(y)):
        stands = np.sum(same & (y[1:] == end))
        if end == 0.0 or stands < max(_LEAST, _CLEAR * np.sum(same & ~there[1:])):
            there &= y != end
    inside = (y > np.min(y)) & (y < np.max(y))
    scatter = scatter_about_a_curve(t[inside], y[inside])
    return np.asarray(there & (scatter > _CLEAR * max(meter_step(y[inside]), _rounding(y))))


def _rounding(y: Array) -> float:
    """By how much equal readings may differ in a computer."""
    return 100.0 * np.finfo(float).eps * float(np.max(np.abs(y)))


def _averaged_rows(t: Array, y: Array, inputs: Iterable[Array]) -> int:
    """Find how many rows a logger has averaged for each, by the zeros of its spectrum; 1 if none.

    An input that is held for as many rows, or its changes, may have them too: that does not count.
    """
    count, steps = len(y) - 1, np.diff(t)
    least = _CLEAR * meter_step(y)
    if count < _FEWEST or np.ptp(steps) > 0.5 * np.median(steps) or np.std(np.diff(y)) < least:
        return 1
    gain = {1: _DEEP} | _spectral_zeros(np.diff(y))
    for row in inputs:
        held, changed = map(_spectral_zeros, (row[1:], np.diff(row)))
        for width in held if np.ptp(row) else ():
            gain[width] -= max(held[width], changed[width], 0.0)
    return max(gain, key=lambda width: gain[width])


def _spectral_zeros(values: Array) -> dict[int, float]:
    """Compare a spectrum with those of means over some rows: gains in log-likelihood by width.

    About each zero, a spectrum that falls evenly is set beside such a one times that of the mean,
    both in logarithms.
    """
    count, gain = len(values), {}
    windowed = (values - np.median(values)) * np.hanning(count + 2)[1:-1]
    power = np.log(np.abs(np.fft.rfft(windowed)) ** 2 + 1e-300)
    place = np.arange(len(power)) / count
    wave = np.sin(np.pi * np.maximum(place, 1.0 / count))
    for width in range(3, min(_LONGEST, count // 10) + 1):
        mean = (np.sin(np.pi * place * width) / (width * wave)) ** 2
        # A Hann window's main lobe, two lines wide, fills a zero; readings are rounded besides.
        mean = np.log(mean + (0.7 * np.pi / count / wave) ** 2 + _FILLED)
        cell = np.floor(place * width + 0.5).astype(int)
        parts = [np.flatnonzero(cell == k) for k in range(1, cell[-1] + 1)]
        gain[width] = sum(0.5 * len(at) * math.log(_residual_squares(place[at], power[at])
                          / _residual_squares(place[at], power[at] - mean[at]))
                          for at in parts if len(at) > _LEAST)  # fmt: skip
    return gain


def _residual_squares(x: Array, values: Array) -> float:
    """Sum the squares of what a line leaves of some values."""
    line = np.polyval(np.polyfit(x, values, 1), x)
    return float(np.sum((values - line) ** 2)) + 1e-300


def unwrap(at: str, y: Array, unit: str, parts: bool = True) -> tuple[Array, list[Note]]:
    """Unwrap angles and counters, and say so in a note.

    Angles wrap at a turn, or with `parts` at a part or multiple of one; whole numbers of steps at
    the 16 or 32 bits that they use. Readings that only jump, as a set point does, do not fill the
    range between.
    """
    if len(y) < 2 or not np.ptp(y):
        return y, []
    for span, what in _spans(y, unit, parts):
        turns = -np.round(np.diff(y) / span)
        wide = np.flatnonzero(turns)
        left = np.abs(np.diff(y) + span * turns)[wide]
        fits = np.ptp(y) <= span * (2.0 - _REGULAR) and np.all(left < 0.5 * 0.5 * span)
        fills = np.max(np.diff(np.sort(y))) < 0.5 * 0.5 * span
        if len(wide) and fits and (fills or (what in _KNOWN and np.ptp(y) < span - _rounding(y))):
            made = y + span * np.concatenate([[0.0], np.cumsum(turns)])
            if what == _KNOWN[1]:  # a count below zero was written as a large one
                made -= span * np.round(made[0] / span)
            text = f"{at}readings wrap {counted(len(wide), 'time')}, first at row {wide[0] + 1}: "
            return made, [Note("unwrapped", f"{text}unwrapped by {span:.6g}, {what}.", len(wide))]
    return y, []


def _spans(y: Array, unit: str, parts: bool) -> Iterator[tuple[float, str]]:
    """Yield ranges after which readings may wrap, and what they are."""
    width, jumps = float(np.ptp(y)), np.diff(y)
    is_wide = np.abs(jumps) > 0.5 * width
    steps, wide = np.where(is_wide, 0.0, jumps), np.flatnonzero(is_wide)
    if is_of(unit, "rad"):
        turn = math.tau * per_si(unit, "rad")
        yield turn, _KNOWN[0]
        inside = wide[(wide > 0) & (wide < len(jumps) - 1)]
        if parts and len(inside) > 1:  # less how it changes before and after
            change = jumps[inside] - 0.5 * (steps[inside - 1] + steps[inside + 1])
            span = float(np.median(np.abs(change)))
            part = max(round(turn / span), 1) / max(round(span / turn), 1)
            yield turn / part, f"{part:g} of them a turn"
    step = meter_step(y)
    for end in (2.0**16, 2.0**32):
        if step and _REGULAR * end < width / step < end:
            yield end * step, _KNOWN[1]


def scatter_about_a_curve(t: Array, y: Array) -> float:
    """Return the standard deviation of readings about a smooth curve; 0 where there is none.

    Differences of an order take a polynomial away. Where those of two orders leave the same, it is
    noise; where the higher order leaves less, they still see the curve. Medians, as a curve may
    have a few jumps. A meter's step leaves its rounding, also where readings look exact.
    """
    least = meter_step(y) / math.sqrt(12.0)
    scatter = [max(_left_by_differences(t, y, order), least) for order in _ORDERS]
    smooth = len(y) >= 4 * max(_ORDERS) and 0.0 < scatter[0] < _FLAT * scatter[1]
    return scatter[1] if smooth and scatter[1] < _SMALL * np.std(y) else 0.0


def _left_by_differences(t: Array, y: Array, order: int) -> float:
    """Standard deviation of a reading by divided differences of an order; 0 of too few readings."""
    if len(y) < 2 * order:
        return 0.0
    times = np.lib.stride_tricks.sliding_window_view(t, order + 1)
    apart = times[:, :, None] - times[:, None, :]
    apart[:, range(order + 1), range(order + 1)] = times[:, -1:] - times[:, :1]
    weight = np.exp(-np.sum(np.log(np.abs(apart)), axis=2)) * (-1.0) ** np.arange(order + 1)
    weight /= np.linalg.norm(weight, axis=1)[:, None]
    values = np.lib.stride_tricks.sliding_window_view(y, order + 1)
    size = np.abs(np.sum(weight * values, axis=1))
    # Readings of few digits often have a difference of zero.
    return float(np.median(size)) / 0.6745 or root_mean_square(size)
