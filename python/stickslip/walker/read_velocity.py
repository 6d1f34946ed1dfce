"""Tables of mean velocities: one row a trial, grouped into conditions."""

from __future__ import annotations

import itertools
import math
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from stickslip._util.arrays import RELATIVE, Array, Indices, Mask, representatives
from stickslip._util.messages import shown
from stickslip._util.note import Note
from stickslip._util.tables import Units
from stickslip._util.text import OneLine, comma_hint, counted, number
from stickslip._util.units import factor_text, split_unit, unit_factor, unit_meant
from stickslip.diagnosis.data.outliers import far_from_their_group
from stickslip.diagnosis.data.read_table import (
    LARGEST,
    STAMP,
    Line,
    NothingSound,
    Rows,
    check_columns,
    not_used,
    refuse_twice,
    seconds,
    valid_rows,
)
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import Value, full_name, in_allowed_case, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.sweeping.points import name_of

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

_LONGEST_DAY = 12 * 3600.0
"""Time between clocks of one day, s. Chosen: as long as people measure."""

_MOST = 0.5
"""Part of the rows; if more have a setting in another unit, the table is refused. Chosen: most."""

_DRIVE, _EFFECTS = "drive.", "effects_"
"""What keys of settings begin with, and what those of effects may leave out of a column's name."""

NOT_SETTINGS: Units = {
    "velocity": "m/s", "standard_error": "m/s", "trial": None, "block": None, "order": "-",
}  # fmt: skip
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
        Index of the block; -1 where the table does not say.
    order : ndarray, shape (n,)
        Sequence number; NaN where the table does not say.
    sweep : ndarray, shape (n,)
        Which trial of its condition it is: trials of several conditions with the same number were
        measured in one sweep. By the labels of `trial` where conditions share them, else by the
        order of the rows of a condition.
    relative_sd : float
        Stated relative error of one trial; NaN where it is not known.
    """

    conditions: tuple[Mapping[str, Value], ...]
    velocity: Array
    condition: Indices
    block: Indices
    order: Array
    sweep: Indices
    relative_sd: float = math.nan


class _Unsound(Exception):
    """A row that is not used; its arguments are the code and the text of a note."""


class _Trial(NamedTuple):
    """A sound row."""

    velocity: float
    setting: tuple[tuple[str, Any], ...]
    block: str
    label: str
    order: float
    line: Line


def velocity_units() -> Units:
    """The columns that a table of velocities may have, with the units of their numbers."""
    keys = {name: known_keys()[f"{_DRIVE}{bare}"] for name, bare in bare_names().items()}
    settings = {name: None if key.kind == "word" else key.unit for name, key in keys.items()}
    return {**NOT_SETTINGS, **settings}


def bare_names() -> dict[str, str]:
    """The bare name of a setting by each name of its column: as sweeps write it, too."""
    keys = [name for name in known_keys() if name.startswith(_DRIVE)]
    return {
        name: key.removeprefix(_DRIVE)
        for key in keys
        for name in (key.removeprefix(_DRIVE), key, name_of(key))
    }


def _with_bare_names(table: Rows) -> Rows:
    """The table with settings by their bare names; columns of other keys are refused."""
    bare, keys = bare_names(), known_keys()
    header = [bare.get(name, name) for name in table.header]
    with prefixed(table.path):
        refuse_twice(header)
        written = {name_of(key).removeprefix(start) for key in keys for start in ("", _EFFECTS)}
        for name in header:
            key = split_unit(name)[0]
            if key not in bare and (full_name(key) in keys or key in written):
                raise ScenarioError(
                    f"column {shown(name)} is a key of the scenario: allowed are those of [drive], "
                    f"{', '.join(dict.fromkeys(bare.values()))}; write it into the scenario"
                )
    return table._replace(header=header)


def with_index_columns(table: Any) -> Any:
    """A table in memory whose index levels that are columns of velocities have become columns.

    They are what ``set_index`` and ``groupby`` leave there; other levels stay what rows are called.
    """
    names = getattr(getattr(table, "index", None), "names", ())
    known = [name for name in names if name in velocity_units() and name not in table]
    return table.reset_index(known) if known else table


def read_velocity(
    table: Rows,
    scenario: Scenario,
    relative_sd: float,
    earlier: Sequence[VelocityData] = (),
    strict: bool = False,
) -> tuple[VelocityData, list[Note]]:
    """The sound rows of a table of velocities, and what was left out of it.

    The scenario gives the drive settings that have no column; `relative_sd` is the relative error
    of one trial, NaN if not known. Settings that are equal to one of the scenario or of the
    `earlier` tables become that one. If `strict`, the first row that is not sound is refused.
    """
    table = valid_rows(_with_bare_names(table))
    known_columns = [*NOT_SETTINGS, *bare_names().values()]
    others = check_columns(table.path, table.header, ["velocity"], known_columns)
    _check_clocks(table)
    trials, left_out = _sound_rows(table, scenario, strict)
    left_out += [*table.left_out, *not_used(table.name, others)]
    known = [condition for data in earlier for condition in data.conditions]
    trials = _with_equal_settings(table.name, trials, scenario, known, left_out)
    velocity = np.array([trial.velocity for trial in trials])
    size = float(np.median(np.abs(velocity)))
    if size > FASTEST:
        meant = unit_meant("m/s", size / _USUAL, math.inf)
        hint = f"; if they are in {meant[0]}, divide them by {meant[1]:.7g}" if meant else ""
        text = f"velocities of {size:.3g} m/s; allowed is at most {FASTEST} m/s{hint}"
        raise ScenarioError(f"{table.path}: {text}")
    condition = _numbered([trial.setting for trial in trials])
    sound = _without_outliers(table.name, velocity, condition, left_out)
    fast = sound & (np.abs(velocity) > FASTEST)
    if fast.any():
        at = table.at([trials[k].line for k in np.flatnonzero(fast)])
        text = f"{at}: the velocity is above {FASTEST:g} m/s; divide velocities in mm/s or um/s by "
        left_out.append(Note("too-fast", f"{text}1e3 or 1e6.", int(fast.sum())))
        if strict:
            raise ScenarioError(left_out[-1])
        sound &= ~fast
    kept = [trials[k] for k in np.flatnonzero(sound)]
    data = VelocityData(
        tuple(dict(setting) for setting in dict.fromkeys(trial.setting for trial in kept)),
        velocity[sound],
        _numbered([trial.setting for trial in kept]),
        _numbered([trial.block for trial in trials])[sound],
        np.array([trial.order for trial in kept]),
        _sweeps(trials)[sound],
        relative_sd,
    )
    return data, left_out


def read_new_trials(
    table: Rows, scenario: Scenario, earlier: Sequence[VelocityData]
) -> tuple[VelocityData, list[Note]]:
    """The trials of a table of proposed drives, and which of them are left out as outliers.

    Rows without a velocity were not measured. All others have to be sound, as whoever has just
    filled them in can correct them: where a long table of old data is used as far as it goes, this
    one is refused. What `earlier` tables state of the error of a trial counts for all. A
    ScenarioError is raised with the first row that is not sound, or if no row has a velocity or all
    trials are among the `earlier` ones.
    """
    path = table.path
    check_columns(path, table.header, ["velocity"])
    empty = set(unmeasured(table))
    filled = [(line, row) for line, row in table.rows if line not in empty]
    if not filled:
        raise ScenarioError(f"{path}: no row has a velocity; allowed is one or more")
    # Whoever filled it in has to find it, so notes name its whole path.
    whole = table._replace(rows=filled, name=str(path))
    data, left_out = read_velocity(whole, scenario, math.nan, earlier, strict=True)
    known = {trial for old in earlier for trial in _trials(old)}
    if known.issuperset(_trials(data)):
        twice = "all its trials are in the measurement already"
        raise ScenarioError(f"{path}: {twice}: allowed is once, or they would count twice")
    return data, left_out


def unmeasured(table: Rows) -> list[Line]:
    """Lines of the rows whose velocity is empty."""
    at = table.header.index("velocity")
    return [line for line, row in table.rows if at < len(row) and not row[at]]


def _trials(data: VelocityData) -> list[tuple[object, ...]]:
    """Each trial's settings and velocity."""
    settings = [tuple(sorted(condition.items())) for condition in data.conditions]
    pairs = zip(data.condition.tolist(), data.velocity.tolist(), strict=True)
    return [(settings[at], velocity) for at, velocity in pairs]


def _with_equal_settings(
    name: str,
    trials: Sequence[_Trial],
    scenario: Scenario,
    known: Sequence[Mapping[str, Value]],
    left_out: list[Note],
) -> list[_Trial]:
    """The trials with one number for all that are the same setting."""
    given: dict[str, set[float]] = defaultdict(set)
    for key, value in {pair for trial in trials for pair in trial.setting}:
        if isinstance(value, float):
            given[key].add(value)
    same: dict[tuple[str, Any], tuple[str, Any]] = {}
    for key, values in sorted(given.items()):
        kept = {float(setting[key]) for setting in known} | {float(scenario.get(key))}
        one = representatives(values, kept)
        other = {(key, value): (key, one[value]) for value in values if one[value] != value}
        same |= other
        if other:
            text = f"{name}: {key.partition('.')[2]} has {counted(len(other), 'value')} within "
            text += f"{RELATIVE:g} of another one; they count as the same setting."
            left_out.append(Note("equal-settings", text, len(other)))
    return [
        trial._replace(setting=tuple(same.get(pair, pair) for pair in trial.setting))
        for trial in trials
    ]


def _numbered(values: Sequence[Any]) -> Indices:
    """Each value's place among the different ones in the order in which they come; -1 of none."""
    places = {value: k for k, value in enumerate(dict.fromkeys(filter(None, values)))}
    return np.array([places.get(value, -1) for value in values], dtype=np.int64)


def _sweeps(trials: Sequence[_Trial]) -> Indices:
    """See `VelocityData`; outliers must not be left out before, as they are part of a sweep."""
    labelled = {(trial.label, trial.setting) for trial in trials if trial.label}
    if len({label for label, _ in labelled}) < len(labelled):
        return _numbered([trial.label for trial in trials])
    seen: defaultdict[object, itertools.count[int]] = defaultdict(itertools.count)
    places = [next(seen[trial.block, trial.setting]) for trial in trials]
    return np.array(places, dtype=np.int64)


def _sound_rows(table: Rows, scenario: Scenario, strict: bool) -> tuple[list[_Trial], list[Note]]:
    """Rows that can be used, at least one, and why the others cannot."""
    header, count = table.header, len(table.rows)
    compared = [tuple(map(_as_compared, row)) for _, row in table.rows]
    times = {*Counter(compared).values()}
    pasted = len(times) == 1 and times != {1}  # all rows equally often: a table put in again
    counts_once = "trial" in header or "order" in header or pasted
    wrong: dict[tuple[str, str], list[Line]] = {}  # in the order of the file
    kept: list[_Trial] = []
    seen: set[tuple[object, ...]] = set()
    for (line, row), same in zip(table.rows, compared, strict=True):
        try:
            if len(row) != len(header):
                text = f"a row of {len(row)} cells is not used, as the header names {len(header)}"
                raise _Unsound("cell-count", f"{text} columns.")
            if counts_once and same in seen:
                raise _Unsound("repeated-row", "the row repeats an earlier one.")
            cells = dict(zip(header, row, strict=True))
            velocity, setting = _number("velocity", cells["velocity"]), _setting(cells, scenario)
            order = _number("order", cells["order"], seconds) if cells.get("order") else math.nan
            labels = cells.get("block", ""), cells.get("trial", "")
            kept.append(_Trial(velocity, setting, *labels, order, line))
            seen.add(same)
        except _Unsound as error:
            wrong.setdefault(error.args, []).append(line)
    in_other_unit = [(key[1], lines) for key, lines in wrong.items() if key[0] == "setting-unit"]
    lost = sum(len(lines) for _, lines in in_other_unit)
    if lost > _MOST * count:
        text, lines = in_other_unit[0]
        where = table._replace(name=str(table.path)).at(lines)
        raise ScenarioError(f"{where}: {text} {lost} rows are like this")
    left_out = [
        Note(code, f"{table.at(lines)}: {text}", len(lines))
        for (code, text), lines in wrong.items()
    ]
    if left_out and strict:
        hint = " Allowed are numbers; a velocity that was not measured stays empty."
        raise ScenarioError(f"{left_out[0]}{hint if left_out[0].code == 'not-a-number' else ''}")
    if not kept:
        raise NothingSound(table.path, left_out[0])
    lost = count - len(kept)
    if lost > _MANY_LOST * count:
        text = f"{table.name}: {lost} of {count} rows were left out."
        left_out.insert(0, Note("rows-left-out", text, lost))
    return kept, left_out


def _as_compared(cell: str) -> object:
    """A cell as repeated rows are told: a number whatever its spelling."""
    value = number(cell)
    return cell if math.isnan(value) else value


def _plain_number(cell: str) -> float:
    return number(cell, LARGEST)


def _check_clocks(table: Rows) -> None:
    """Refuse an order by clocks without dates that may go on after midnight."""
    at = table.header.index("order") if "order" in table.header else len(table.header)
    stamps = [STAMP.fullmatch(row[at]) for _, row in table.rows if len(row) > at]
    written = [row[at] for _, row in table.rows if len(row) > at and row[at]]
    kinds = {(stamp is None, stamp is not None and bool(stamp["date"])) for stamp in
             map(STAMP.fullmatch, written)}  # fmt: skip
    if len(kinds) > 1 and any(stamps):
        raise ScenarioError(
            f"{table.path}: column order mixes dates, clocks and numbers: allowed is one of these"
        )
    clocks = [seconds(stamp[0]) for stamp in stamps if stamp and not stamp["date"]]
    if clocks and max(clocks) - min(clocks) > _LONGEST_DAY:
        raise ScenarioError(
            f"{table.path}: clocks in column order are more than {_LONGEST_DAY / 3600:g} h apart: "
            "write dates, such as 2026-05-01 12:00, as the day may have changed"
        )


def _number(column: str, cell: str, read: Callable[[str], float] = _plain_number) -> float:
    value = read(cell)
    if math.isnan(value):
        text = f"{column} {shown(cell)} is not a number{comma_hint(cell)}." if cell else ""
        raise _Unsound("not-a-number", text or f"{column} is empty.")
    return value


def _setting(cells: Mapping[str, str], scenario: Scenario) -> tuple[tuple[str, Any], ...]:
    """The drive settings of a row, in the order of the keys; checked as a scenario."""
    drive = {name: key for name, key in known_keys().items() if name.startswith("drive.")}
    changes: dict[str, Value] = {}
    for name, key in drive.items():
        column = name.removeprefix("drive.")
        if column not in cells:
            continue
        if key.kind == "word":
            changes[name] = in_allowed_case(key, cells[column])
        else:
            value = _number(column, cells[column])
            changes[name] = int(value) if key.kind == "whole" and value == int(value) else value
    if changes.get("drive.mode") == "program":
        raise _Unsound("setting-refused", 'mode "program" has no place in a table of velocities.')
    try:
        full = scenario.replace(changes)
    except ScenarioError as error:
        raise _Unsound("setting-refused", f"{error}.") from None
    for name in ("peak", "base", "hold"):
        field = float(full.get(f"drive.{name}"))
        if field > _STRONGEST:
            text = f"{name} of {field:.3g} T is above {_STRONGEST:g} T; if it is in mT, divide it"
            raise _Unsound("setting-unit", f"{text} by 1e3.")
    frequency = full.drive.frequency
    if frequency < _SLOWEST:
        text = f"frequency of {frequency:.3g} Hz is below {_SLOWEST:g} Hz; if it is in kHz, "
        raise _Unsound("setting-unit", f"{text}multiply it by 1e3.")
    return tuple((name, full.get(name)) for name in drive)


def _without_outliers(name: str, velocity: Array, condition: Indices, left_out: list[Note]) -> Mask:
    """Leave out trials that are outliers among the others of their condition."""
    far, level = far_from_their_group(velocity, condition)
    for k in np.flatnonzero(far):
        factor = unit_factor(abs(velocity[k] / level[k]), _ALIKE) if level[k] else None
        text = f"{name}: a trial of {velocity[k]:.4g} m/s is far from the others of its condition, "
        text += f"which are near {level[k]:.4g} m/s"
        if factor is not None:
            text += f"; the factor of {factor_text(factor)} is that of a wrong unit"
        left_out.append(Note("outlier", f"{text}.", float(velocity[k])))
    return np.asarray(~far)
