"""Times of a log: dates and clocks become seconds; and counters that begin anew go on."""

from __future__ import annotations

import datetime
import math
import re
from collections.abc import Mapping, Sequence

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.cells import STAMP
from stickslip._util.columns import Column, Line
from stickslip._util.messages import shown
from stickslip._util.note import Note
from stickslip._util.units import CLOCKS, split_unit
from stickslip.errors import ScenarioError

JUMP = 20.0
"""Steps of a clock that has jumped. Chosen: a link loses a few readings, and a break loses many."""

_LATE = 1e8
"""Time, s, from which on times are counted from the first. Chosen: no experiment runs for three
years, and fractions of a microsecond stay."""

_EPOCH = datetime.date(1970, 1, 1)


def seconds(cell: str) -> float:
    """A time, s, of a `STAMP`, with a clock of two parts in hours; NaN of other cells."""
    stamp = STAMP.fullmatch(cell)
    since = _nanoseconds(stamp, False) if stamp else None
    return math.nan if since is None else 1e-9 * since


def _nanoseconds(stamp: re.Match[str], minutes: bool) -> int | None:
    """Time of a date since 1970, of a clock since midnight; one of two parts may be in minutes."""
    whole, _, fraction = stamp["clock"].replace(",", ".").partition(".")
    parts = [*map(int, whole.split(":"))]
    if len(parts) == 2:
        parts = [0, *parts] if minutes else [*parts, 0]
    hours, minute, second = parts
    zone = stamp["zone"] or "+0000"
    ahead = 3600 * int(zone[:3]) + 60 * int(zone[0] + zone[-2:])
    date = [*map(int, re.split("[-/.]", (stamp["date"] or "1970-01-01").strip(" T")))]
    if hours > 23 or second > 59 or (minute > 59 and not minutes):
        return None
    try:
        days = (datetime.date(*(date if date[0] > 31 else date[::-1])) - _EPOCH).days
    except ValueError:
        return None
    since = 86400 * days + 3600 * hours + 60 * minute + second - ahead
    return since * 10**9 + int(f"{fraction[:9]:0<9}")


def times(column: Column, path: object, lines: Sequence[Line]) -> tuple[Array, list[Note]]:
    """Times of a column, s, NaN where there is none, and notes.

    Dates, and numbers as large as dates, are counted from the first.
    """
    heading, t = column.what.heading, column.values
    stamps = {k: stamp for k, cell in column.odd.items() if (stamp := STAMP.fullmatch(cell))}
    known = np.flatnonzero(np.isfinite(t)).tolist()
    if stamps and known:
        k = min(stamps)
        raise ScenarioError(
            f"{path}: column {split_unit(heading)[0]} has numbers beside {shown(column.odd[k])} in "
            f"line {lines[k]}: allowed is one of these"
        )
    if stamps:
        return _of_stamps(stamps, column, path)
    if known and column.what.unit in CLOCKS:
        raise ScenarioError(
            f"{path}: column {heading} has the number {t[known[0]]:g} in line {lines[known[0]]}: "
            "allowed are clocks such as 12:00:01.5, or another unit"
        )
    if not known or abs(t[known[0]]) < _LATE:
        return t, []
    first = float(t[known[0]])
    note = Note("dates", f"Times are counted from the first, {first:.10g} s.", first)
    return t - first, [note]


def _of_stamps(
    stamps: Mapping[int, re.Match[str]], column: Column, path: object
) -> tuple[Array, list[Note]]:
    """Times, s, of dates from the first, and of clocks from midnight."""
    dated = any(stamp["date"] for stamp in stamps.values())
    unit = column.what.unit
    two = [stamp["clock"] for stamp in stamps.values() if stamp["clock"].count(":") == 1]
    if two and not dated and unit not in CLOCKS:
        name = split_unit(column.what.heading)[0]
        raise ScenarioError(
            f"{path}: column {column.what.heading}: {shown(two[0])} may be hours or minutes: write "
            f'"{name} (hh:mm)" or "{name} (mm:ss)"'
        )
    minutes = not dated and unit == "mm:ss"
    known = {k: since for k, stamp in stamps.items() if bool(stamp["date"]) == dated
             and (since := _nanoseconds(stamp, minutes)) is not None}  # fmt: skip
    first = next(iter(known.values()), 0) if dated else 0
    t = np.full(len(column.values), math.nan)
    t[list(known)] = [(each - first) / 1e9 for each in known.values()]
    text = f"Times are counted from the first, {np.datetime64(round(1e-6 * first), 'ms')}."
    return t, [Note("dates", text)] if dated else []
