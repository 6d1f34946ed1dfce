"""Times of a log: dates, clocks and counts become seconds, and counters that begin anew go on."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import NoReturn

import numpy as np

from stickslip._util.arrays import Array, Indices
from stickslip._util.columns import LARGEST, Column, Line
from stickslip._util.messages import shown
from stickslip._util.note import Note
from stickslip._util.text import number
from stickslip._util.units import CLOCKS, per_si, split_unit
from stickslip.errors import ScenarioError

STAMP = re.compile(
    r"(?P<date>\d{4}[-/]\d\d[-/]\d\d[T ]\s*|\d{1,2}\.\d{1,2}\.\d{4}\s+)?"
    r"(?P<clock>\d{1,2}:\d\d(:\d\d)?([.,]\d+)?)(Z|(?P<zone>[+-]\d\d:?\d\d))?"
)
"""A date or a clock as ISO 8601 writes it, or a date such as 1.5.2026."""

JUMP = 20.0
"""Steps of a clock that has jumped. Chosen: a link loses a few readings, and a break loses many."""

_DATE, _DATES = 1e8, (631152000.0, 4102444800.0)
"""Seconds since 1970 from which on a time is a date, and the years 1990 to 2100. Chosen: no
experiment runs for three years."""

_DAY, _HALF, _HOUR = 86400.0, 43200.0, 3600.0  # s, after which clocks begin anew
_COUNTED, _SLOW = 1000.0, 1e5
"""Steps of whole numbers that may be ms, us or ns; of what may be ms since 1970. Chosen: hardly a
log has a reading in a quarter of an hour, and one in 100 s is of a slow one."""
_DAYS = (32874.0, 73051.0), (726834.0, 767011.0)  # 1990 to 2100 of Excel and of MATLAB
_DIGITS = 4  # decimals of seconds; chosen: a day's parts have more
_MANY = 100.0  # steps of a counter whose zero was taken away; chosen: else chance would fit
_QUANTA = (1.0, 0.1, 0.01, 1e-3)  # of numbers with 16 or 32 bits, in their unit
_SUNDAY, _NIGHT = 6, 4  # the day and the hours in which a clock is put on or back


def seconds(cell: str) -> float:
    """A time, s, as a number or as `STAMP`, with a clock of two parts in hours; NaN if none."""
    stamp = STAMP.fullmatch(cell)
    if not stamp:
        return number(cell, LARGEST)
    since = _nanoseconds(stamp, False)
    return math.nan if since is None else 1e-9 * since


def _nanoseconds(stamp: re.Match[str], minutes: bool) -> int | None:
    """Time of a date since 1970, of a clock since midnight; one of two parts may be in minutes."""
    parts = stamp["clock"].replace(",", ".").split(":")
    whole, _, fraction = parts[-1].partition(".")
    numbers = [*map(int, parts[:-1]), int(whole)]
    if len(numbers) == 2:
        numbers = [0, *numbers] if minutes else [*numbers, 0]
    hours, minute, second = numbers
    if hours > 23 or second > 59 or (minute > 59 and not minutes):
        return None
    clock = (3600 * hours + 60 * minute + second) * 10**9 + int(f"{fraction[:9]:0<9}")
    zone = stamp["zone"] or "+0000"
    ahead = (3600 * int(zone[:3]) + 60 * int(zone[0] + zone[-2:])) * 10**9
    day = (stamp["date"] or "1970-01-01").strip(" T").replace("/", "-")
    if "." in day:
        day = "{2}-{1:0>2}-{0:0>2}".format(*day.split("."))
    try:
        return int(np.datetime64(day, "D").astype(int)) * 86400 * 10**9 + clock - ahead
    except ValueError:
        return None


def times(column: Column, path: object, lines: Sequence[Line]) -> tuple[Array, list[Note], bool]:
    """Times of a column, s, NaN where there is none; notes, and whether they state their unit.

    Dates are counted from the first. A counter of 16 or 32 bits, a clock that begins anew each day
    and one that is put on or back in a summer's night are counted on. A ScenarioError asks for the
    unit of numbers that may be in several.
    """
    heading, unit = split_unit(column.what.heading)[0], column.what.unit
    notes: list[Note] = []
    stamps = {k: stamp for k, cell in column.odd.items() if (stamp := STAMP.fullmatch(cell))}
    if stamps:
        if np.isfinite(column.values).any():
            k = min(stamps)
            raise ScenarioError(
                f"{path}: column {heading} has numbers beside {shown(column.odd[k])} in line "
                f"{lines[k]}: allowed is one of these"
            )
        t = _of_stamps(stamps, column, path, lines, notes)
        return t, notes, True
    t = column.values
    known = np.flatnonzero(np.isfinite(t))
    if len(known) and unit in CLOCKS:
        raise ScenarioError(
            f"{path}: column {column.what.heading} has the number {column.values[known[0]]:g} in "
            f"line {lines[known[0]]}: allowed are clocks such as 12:00:01.5, or another unit"
        )
    if not len(known):
        return t, notes, unit is not None
    first = float(t[known[0]])
    if unit is None:
        power = _power(t[known], column, path)
        if power is not None:
            told = f"{('s', 'ms', 'us', 'ns')[power]} since 1970, counted from the first"
            notes.append(Note("dates", f"Times are {told}, {_date(first / 1e3**power)}."))
            return (t - first) / 1e3**power, notes, True
    elif abs(first) >= _DATE:
        is_date = _DATES[0] <= first < _DATES[1] and unit not in ("d", "days", "day")
        since = "s since 1970, " if is_date else ""
        of = _date(first) if is_date else f"{first:.10g} s"
        notes.append(Note("dates", f"Times are {since}counted from the first, {of}."))
        t = t - first
    return _wrapped(t, unit, lines, notes), notes, unit is not None


def _date(since: float) -> str:
    return str(np.datetime64(round(since * 1e3), "ms"))


def _ask(column: Column, path: object, why: str, units: str) -> NoReturn:
    name = column.what.heading
    either = " or ".join(f'"{name} ({unit})"' for unit in units.split())
    raise ScenarioError(f"{path}: column {name} has no unit, and {why}: write {either}")


def _power(t: Array, column: Column, path: object) -> int | None:
    """The power of a thousand that makes numbers without a unit seconds since 1970, if any does.

    A ScenarioError asks where several units are as likely.
    """
    first, steps = float(t[0]), np.abs(np.diff(t))
    step = float(np.median(steps)) if len(steps) else 0.0
    whole = bool(np.all(t == np.round(t)))
    counts = whole and step >= _COUNTED
    power = next((p for p in range(4) if _DATES[0] <= first / 1e3**p < _DATES[1]), None)
    if power is not None and (power > 1 or not counts or (power == 1 and step < _SLOW)):
        return power
    if abs(first) >= _DATE:
        why = f"its first time, {first:.12g}, is no date from 1990 to 2100 in any one unit"
        if power is not None:
            why = f"{first:.12g}, with steps of {step:g}, may be a date or a count"
        _ask(column, path, why, "s ms us ns")
    if counts:
        _ask(column, path, f"steps of {step:g} may be counts of a clock", "ms us ns s")
    days = any(low <= float(np.min(t)) and float(np.max(t)) < high for low, high in _DAYS)
    if days and not np.allclose(t, np.round(t, _DIGITS), rtol=0.0, atol=1e-9):
        _ask(column, path, f"{first:.10g} may be a date in days, as Excel counts them", "d s")
    return None


def _wrapped(t: Array, unit: str | None, lines: Sequence[Line], notes: list[Note]) -> Array:
    """Times that go on where a counter or the seconds of a day begin anew."""
    steps = np.diff(t)
    fallen = np.flatnonzero(steps < 0.0)
    if not len(fallen) or not (steps > 0.0).any():
        return t
    usual = float(np.median(steps[steps > 0.0]))
    ticks = {1.0, 1e3, 1e6} if unit in (None, "s") else {per_si(str(unit), "s")}
    spans = {2.0**bits / per: f"a counter of {bits} bits" for bits in (16, 32) for per in ticks}
    spans |= {_DAY: "a day", _HALF: "half a day"}
    far = JUMP * usual
    fits = []
    for span in spans:
        left = steps[fallen] + span
        at_its_end = np.all((t[fallen] > span - far) & (t[fallen] < span + usual))
        exact = span > _MANY * usual and np.all(np.abs(left - usual) < 0.1 * usual)
        # A shorter span would fit the falls of rows in no order.
        if span > far and np.all((left > 0.0) & (left <= far)) and (at_its_end or exact):
            fits.append(span)
    if not fits:
        return t
    span = min(fits, key=lambda each: float(np.max(np.abs(steps[fallen] + each - usual))))
    return _put_on(t, fallen, span, lines, notes, spans[span])


def _put_on(
    t: Array, before: Indices, span: float, lines: Sequence[Line], notes: list[Note], of: str
) -> Array:
    """Times that are later by a span after each of these rows, and a note if there are any."""
    if len(before):
        where = ", ".join(str(lines[k + 1]) for k in before[:3].tolist())
        where += ", ..." if len(before) > 3 else ""
        text = f"The clock begins anew at line {where}: counted on by {span:.10g} s, {of}."
        notes.append(Note("clock-counted-on", text, span))
    later = np.zeros(len(t))
    later[before + 1] = span
    return np.asarray(t + np.cumsum(later))


def _of_stamps(
    stamps: Mapping[int, re.Match[str]],
    column: Column,
    path: object,
    lines: Sequence[Line],
    notes: list[Note],
) -> Array:
    """Times, s, of dates from the first, and of clocks from midnight."""
    dated = any(stamp["date"] for stamp in stamps.values())
    minutes = not dated and _in_minutes(stamps, column, path)
    t, first = np.full(len(column.values), math.nan), None
    for k, stamp in stamps.items():
        since = _nanoseconds(stamp, minutes) if bool(stamp["date"]) == dated else None
        if since is not None:
            first = since if first is None and dated else first
            t[k] = (since - (first or 0)) / 1e9
    steps = np.diff(t)
    usual = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    if not dated:
        span = _HOUR if minutes else _DAY
        hours = [int(stamp["clock"].partition(":")[0]) for stamp in stamps.values()]
        halves = steps[steps < 0.0] + _HALF
        if max(hours) <= 12 and len(halves) and np.all((halves > 0.0) & (halves <= JUMP * usual)):
            span = _HALF
        fallen = np.flatnonzero(steps < -0.5 * span)
        return _put_on(t, fallen, span, lines, notes, "after which the clock is where it was")
    if first is not None:
        notes.append(Note("dates", f"Times are counted from the first, {_date(1e-9 * first)}."))
    for sign in (1.0, -1.0):
        moved = steps + sign * _HOUR
        at = np.flatnonzero((moved > 0.0) & (moved <= JUMP * usual) & (
            (steps <= 0.0) if sign > 0.0 else (steps > JUMP * usual)))  # fmt: skip
        put = [_may_be_put(stamps.get(k + 1), t[k + 1], first) for k in at.tolist()]
        of = "as the clock is put for summer or winter"
        t = _put_on(t, at[np.array(put, dtype=bool)], sign * _HOUR, lines, notes, of)
    return t


def _may_be_put(stamp: re.Match[str] | None, t: float, first: int | None) -> bool:
    """Whether a date without a zone is in a night in which clocks are put on or back."""
    if stamp is None or stamp["zone"] or stamp[0].endswith("Z") or first is None:
        return False
    since = first // 10**9 + int(t)
    day, hour = (since // 86400 + 3) % 7, since % 86400 // 3600
    return day == _SUNDAY and hour < _NIGHT


def _in_minutes(stamps: Mapping[int, re.Match[str]], column: Column, path: object) -> bool:
    """Whether clocks of two parts are minutes and seconds; a ScenarioError asks if both may be."""
    two = [stamp["clock"] for stamp in stamps.values() if stamp["clock"].count(":") == 1]
    if not two or column.what.unit in CLOCKS[1:]:
        return column.what.unit == "mm:ss"
    apart = any(stamp["clock"].count(":") == 2 for stamp in stamps.values())
    if apart or any("." in each or "," in each or int(each.split(":")[0]) > 23 for each in two):
        return True
    name = split_unit(column.what.heading)[0]
    raise ScenarioError(
        f"{path}: column {column.what.heading}: {shown(two[0])} may be hours or minutes: write "
        f'"{name} (hh:mm)" or "{name} (mm:ss)"'
    )


def counted_on(
    values: Array, column: Column, turn: float | None, lines: Sequence[Line]
) -> tuple[Array, Note | None]:
    """Numbers of a column, SI, that go on where they begin anew, and a note on that.

    So do angles at a `turn`, and whole numbers, also in tenths and so on, that use the 16 or 32
    bits which they have.
    """
    known = np.flatnonzero(np.isfinite(values))
    y = values[known]
    for span in [*([] if turn is None else [turn]), *_full_spans(y, column.what.per)]:
        turns = -np.round(np.diff(y) / span)
        wide = np.flatnonzero(turns)
        left = np.abs(np.diff(y) + span * turns)[wide]
        if not len(wide) or np.ptp(y) > span * (1.0 + 1e-6) or np.any(left >= 0.25 * span):
            continue
        made = values.copy()
        made[known] = y + span * np.concatenate([[0.0], np.cumsum(turns)])
        if span != turn:  # a count below zero was written as a large one
            made -= span * np.round(np.median(made[known][:9]) / span)
        text = f"{column.what.heading} begins anew {len(wide)} times, first at line "
        text += f"{lines[known[wide[0] + 1]]}: counted on by {span * column.what.per:.6g} there, "
        text += "a turn." if span == turn else "a counter."
        return made, Note("counted-on", text, len(wide))
    return values, None


def _full_spans(y: Array, per: float) -> list[float]:
    """Spans, SI, of counters whose numbers use all of their 16 or 32 bits.

    They are whole ones `per` SI unit, or in tenths and so on.
    """
    if not len(y) or not np.ptp(y):
        return []
    raw = y * per
    whole = (q for q in _QUANTA if np.allclose(raw / q, np.round(raw / q), rtol=1e-10))
    quantum, spans = next(whole, math.inf), []
    low, high = np.min(raw) / quantum, np.max(raw) / quantum
    for end in (2.0**16, 2.0**32):
        from_zero = 0.0 <= low < 0.01 * end and high > 0.99 * end
        if high - low < end and (from_zero or (low < -0.49 * end and high > 0.49 * end)):
            spans.append(end * quantum / per)
    return spans
