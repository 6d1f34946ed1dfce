"""Tables of mean velocities: one row a trial, grouped into conditions."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from stickslip._util.arrays import Array, Indices, Mask
from stickslip._util.equal_numbers import RELATIVE, representatives
from stickslip._util.number_text import number
from stickslip._util.one_line import OneLine
from stickslip._util.unit_factor import unit_factor, unit_meant
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.measurement.outliers import far_from_their_group
from stickslip.measurement.tables import (
    LARGEST,
    Line,
    NothingSound,
    Rows,
    check_columns,
    in_lines,
    not_used,
)
from stickslip.scenario.csv_cells import Units
from stickslip.scenario.keys import Value, in_allowed_case, known_keys
from stickslip.scenario.scenario import Scenario

FASTEST = 1.0
"""Mean velocity, m/s; a robot of this size is slower, and beyond it a unit is wrong. Chosen: the
paper's robots walk some mm/s."""

_USUAL = 1e-3
"""The size that velocities in another unit are compared with, m/s; the paper's, about."""

_ALIKE = 1.1
"""Ratio within which trials of one condition are alike. Chosen: their errors are some per cent."""

_STRONGEST, _SLOWEST = 0.1, 0.2
"""Fields above, T, and frequencies below, Hz, are in another unit. Chosen: the coils of the paper
give some mT, and the robot is driven at some Hz or more."""

_MANY_LOST = 0.1
"""Part of the rows; if more are left out, the first fact says so. Chosen: it changes the design."""

_MOST = 0.5
"""Part of the rows; if more have a setting in another unit, the table is refused. Chosen: most."""

NOT_SETTINGS: Units = {"velocity": "m/s", "trial": None, "block": None, "order": "-"}
"""Columns that say nothing of the drive, with the units of their numbers."""


@dataclass(frozen=True, repr=False, eq=False)
class VelocityData(OneLine):
    """Trials of mean velocities, sound ones only.

    Attributes
    ----------
    conditions : tuple of dict
        Drive settings by dotted key, one for each condition.
    velocity : ndarray, shape (n,)
        m/s, one for each trial.
    condition : ndarray, shape (n,)
        Index of each trial's condition.
    block : ndarray, shape (n,)
        Index of the set-up; -1 where the table does not say.
    order : ndarray, shape (n,)
        Sequence number; NaN where the table does not say.
    sweep : ndarray, shape (n,)
        Which trial of its condition it is: trials of several conditions with the same number were
        measured in one sweep. By the labels of `trial` where conditions share them, else by the
        order of the rows of a condition.
    relative_sd : float
        Stated relative error of one trial; NaN where it is not known.
    extra : dict of tuple of str
        Cells of the columns that are neither settings nor known otherwise, one for each trial.
    """

    conditions: tuple[Mapping[str, Value], ...]
    velocity: Array
    condition: Indices
    block: Indices
    order: Array
    sweep: Indices
    relative_sd: float = math.nan
    extra: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


class _Unsound(Exception):
    """A row that is not used; `why` is its code and fields."""

    def __init__(self, code: Code, **fields: Any) -> None:
        self.why = code, tuple(fields.items())


class _Trial(NamedTuple):
    """A sound row."""

    velocity: float
    setting: tuple[tuple[str, Any], ...]
    block: str
    label: str
    order: float
    line: Line
    extra: tuple[str, ...]


def velocity_units() -> Units:
    """The columns that a table of velocities may have, with the units of their numbers."""
    drive = {name: key for name, key in known_keys().items() if name.startswith("drive.")}
    return {
        **NOT_SETTINGS,
        **{
            name.removeprefix("drive."): None if key.kind == "word" else key.unit
            for name, key in drive.items()
        },
    }


def with_index_columns(table: Any) -> Any:
    """A table in memory whose index levels that are columns of velocities have become columns.

    They are what ``set_index`` and ``groupby`` leave there; other levels stay what rows are called.
    """
    names = getattr(getattr(table, "index", None), "names", ())
    known = [name for name in names if name in velocity_units() and name not in table]
    return table.reset_index(known) if known else table


def read_velocity(
    path: Path,
    table: Rows,
    scenario: Scenario,
    relative_sd: float,
    word: str = "line",
    earlier: Sequence[VelocityData] = (),
) -> tuple[VelocityData, list[Fact]]:
    """The sound rows of a table of velocities, and what was left out of it.

    The scenario gives the drive settings that have no column; `relative_sd` is the relative error
    of one trial, NaN if not known. Messages name the path, and call a row `word`. Settings that are
    equal to one of the scenario or of the `earlier` tables become that one.
    """
    others = check_columns(path, table.header, ["velocity"], list(velocity_units()))
    trials, left_out = _sound_rows(path, table, scenario, word, others)
    known = [each for data in earlier for each in data.conditions]
    trials, merged = _with_equal_settings(path.name, trials, scenario, known)
    left_out += [*table.left_out, *not_used(path, others), *merged]
    velocity = np.array([each.velocity for each in trials])
    condition = _numbered([each.setting for each in trials])
    size = float(np.median(np.abs(velocity)))
    if size > FASTEST:
        raise ScenarioError(
            f"{path}: velocities of {size:.3g} m/s; allowed is at most {FASTEST} m/s"
            + _unit_hint(size)
        )
    sound = _without_outliers(path.name, velocity, condition, left_out)
    fast = sound & (np.abs(velocity) > FASTEST)
    if fast.any():
        lines = [trials[k].line for k in np.flatnonzero(fast)]
        left_out.append(in_lines(Code.TOO_FAST, path.name, lines, word=word, limit=FASTEST))
        sound &= ~fast
    block = _numbered([each.block for each in trials])
    kept = [trials[k] for k in np.flatnonzero(sound)]
    data = VelocityData(
        tuple(dict(each) for each in dict.fromkeys(each.setting for each in kept)),
        velocity[sound],
        _numbered([each.setting for each in kept]),
        block[sound],
        np.array([each.order for each in kept]),
        _sweeps(trials)[sound],
        relative_sd,
        {name: tuple(each.extra[k] for each in kept) for k, name in enumerate(others)},
    )
    return data, left_out


def _unit_hint(size: float) -> str:
    """What to do about velocities of a size that no robot has, m/s."""
    meant = unit_meant("m/s", size / _USUAL, math.inf)
    return "" if meant is None else f"; if they are in {meant[0]}, divide them by {meant[1]:.7g}"


def _with_equal_settings(
    table: str, trials: Sequence[_Trial], scenario: Scenario, known: Sequence[Mapping[str, Value]]
) -> tuple[list[_Trial], list[Fact]]:
    """The trials with one number for all that are the same setting, and where that changed any."""
    said: list[Fact] = []
    taken: list[Mapping[Any, Any]] = []
    for column in zip(*(each.setting for each in trials), strict=True):
        key, first = column[0]
        one: dict[Any, Any] = {}
        if isinstance(first, float):
            given = {value for _, value in column}
            kept = {float(each[key]) for each in known} | {float(scenario.get(key))}
            one = representatives(given, kept)
            count = sum(one[value] != value for value in given)
            name = {"table": table, "column": key.partition(".")[2], "count": count}
            if count:
                said.append(Fact(Code.EQUAL_SETTINGS, {**name, "relative": RELATIVE}))
        taken.append(one)
    if not said:
        return list(trials), said
    merged = []
    for each in trials:
        pairs = zip(each.setting, taken, strict=True)
        setting = tuple((key, one.get(value, value)) for (key, value), one in pairs)
        merged.append(each._replace(setting=setting))
    return merged, said


def _numbered(values: Sequence[Any]) -> Indices:
    """Each value's place among the different ones in the order in which they come; -1 of none."""
    places = {value: k for k, value in enumerate(dict.fromkeys(filter(None, values)))}
    return np.array([places.get(value, -1) for value in values], dtype=np.int64)


def _sweeps(trials: Sequence[_Trial]) -> Indices:
    """See `VelocityData`; outliers must not be left out before, as they are part of a sweep."""
    labelled = {(each.label, each.setting) for each in trials if each.label}
    if len({label for label, _ in labelled}) < len(labelled):
        return _numbered([each.label for each in trials])
    seen: Counter[tuple[object, ...]] = Counter()
    places = []
    for each in trials:
        key = (each.block, each.setting)
        places.append(seen[key])
        seen[key] += 1
    return np.array(places, dtype=np.int64)


def _sound_rows(
    path: Path, table: Rows, scenario: Scenario, word: str, others: Sequence[str]
) -> tuple[list[_Trial], list[Fact]]:
    """Rows that can be used, at least one, and why the others cannot."""
    header, rows = table.header, table.rows
    drive = [key.split(".", 1)[1] for key in known_keys() if key.startswith("drive.")]
    counted = "trial" in header or "order" in header
    # Lines by what is wrong with them, in the order of the file.
    wrong: dict[tuple[Code, tuple[tuple[str, Any], ...]], list[Line]] = {}
    kept: list[_Trial] = []
    seen: set[tuple[str, ...]] = set()
    for line, row in rows:
        try:
            if len(row) != len(header):
                raise _Unsound(Code.CELL_COUNT, cells=len(row), columns=len(header))
            if counted and tuple(row) in seen:
                raise _Unsound(Code.REPEATED_ROW)
            cells = dict(zip(header, row, strict=True))
            extra = tuple(cells[name] for name in others)
            kept.append(_trial(line, cells, extra, drive, scenario))
        except _Unsound as error:
            wrong.setdefault(error.why, []).append(line)
        else:
            seen.add(tuple(row))
    left_out = [
        in_lines(code, path.name, lines, word=word, **dict(fields))
        for (code, fields), lines in wrong.items()
    ]
    _refuse_other_unit(path, left_out, len(rows))
    if not kept:
        raise NothingSound(path, left_out[0])
    lost = len(rows) - len(kept)
    if lost > _MANY_LOST * len(rows):
        part = {"table": path.name, "count": lost, "rows": len(rows)}
        left_out.insert(0, Fact(Code.ROWS_LEFT_OUT, part))
    return kept, left_out


def _refuse_other_unit(path: Path, left_out: list[Fact], rows: int) -> None:
    """Refuse a table most of whose rows have a setting in another unit."""
    units = (Code.SETTING_TOO_LARGE, Code.SETTING_TOO_SMALL)
    wrong = [each for each in left_out if each.code in units]
    count = sum(each.fields["count"] for each in wrong)
    if count > _MOST * rows:
        first = Fact(wrong[0].code, {**wrong[0].fields, "table": str(path)})
        raise ScenarioError(f"{first} {count} rows are like this")


def _trial(
    line: Line,
    cells: Mapping[str, str],
    extra: tuple[str, ...],
    drive: list[str],
    scenario: Scenario,
) -> _Trial:
    """A row of the table, if it is sound."""
    velocity = _number("velocity", cells["velocity"])
    setting = _setting(cells, drive, scenario)
    _check_units(dict(setting))
    order = _number("order", cells["order"]) if cells.get("order") else math.nan
    words = (cells.get("block", ""), cells.get("trial", ""))
    return _Trial(velocity, setting, *words, order, line, extra)


def _number(column: str, cell: str) -> float:
    value = number(cell, LARGEST)
    if math.isnan(value):
        raise _Unsound(Code.NOT_A_NUMBER, column=column, cell=cell)
    return value


def _setting(
    cells: Mapping[str, str], drive: list[str], scenario: Scenario
) -> tuple[tuple[str, Any], ...]:
    """The drive settings of a row, in the order of the keys; checked as a scenario."""
    keys = known_keys()
    changes: dict[str, Value] = {}
    for name in drive:
        if name not in cells:
            continue
        key = keys[f"drive.{name}"]
        value: Value
        if key.kind == "word":
            value = in_allowed_case(key, cells[name])
        else:
            value = _number(name, cells[name])
            if key.kind == "whole" and value == int(value):
                value = int(value)
        changes[key.name] = value
    if changes.get("drive.mode") == "program":
        refusal = 'mode "program" has no place in a table of velocities'
        raise _Unsound(Code.SETTING_REFUSED, refusal=refusal)
    try:
        full = scenario.replace(changes)
    except ScenarioError as error:
        raise _Unsound(Code.SETTING_REFUSED, refusal=str(error)) from None
    return tuple((f"drive.{name}", full.get(f"drive.{name}")) for name in drive)


def _check_units(setting: Mapping[str, Value]) -> None:
    """Leave out a setting that can only be in mT or kHz."""
    for name in ("peak", "base", "hold"):
        field = float(setting[f"drive.{name}"])
        if field > _STRONGEST:
            limit = {"unit": "T", "limit": _STRONGEST, "other": "mT"}
            raise _Unsound(Code.SETTING_TOO_LARGE, key=name, value=field, **limit)
    frequency = float(setting["drive.frequency"])
    if frequency < _SLOWEST:
        limit = {"unit": "Hz", "limit": _SLOWEST, "other": "kHz"}
        raise _Unsound(Code.SETTING_TOO_SMALL, key="frequency", value=frequency, **limit)


def _without_outliers(name: str, velocity: Array, condition: Indices, left_out: list[Fact]) -> Mask:
    """Leave out trials that are outliers among the others of their condition."""
    far, level = far_from_their_group(velocity, condition)
    for index in np.flatnonzero(far):
        ratio = abs(velocity[index] / level[index]) if level[index] else math.inf
        trial = {
            "table": name,
            "velocity": float(velocity[index]),
            "others": float(level[index]),
            "unit_factor": unit_factor(ratio, _ALIKE),
        }
        left_out.append(Fact(Code.OUTLIER, trial))
    return np.asarray(~far)
