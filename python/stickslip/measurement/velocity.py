"""Tables of mean velocities: one row a trial, grouped into conditions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.one_line import OneLine
from stickslip.errors import ScenarioError
from stickslip.measurement.outliers import far_from_their_group
from stickslip.measurement.tables import (
    NothingSound,
    check_columns,
    listed,
    number,
    read_rows,
    refuse_unknown,
)
from stickslip.scenario.keys import Value, known_keys, shown
from stickslip.scenario.scenario import Scenario

FASTEST = 1.0
"""Mean velocity that no walking magnet of this size has, m/s; beyond it a unit is wrong."""

_STRONGEST, _SLOWEST = 0.1, 0.2
"""Far above the fields of such coils, T, and below any rocking that steps, Hz."""

_MANY = 0.1
"""Part of the rows; where more are left out a reader is told first. Chosen."""

_SAME_MISTAKE = 0.5
"""Part of the rows; where more are in another unit the table is refused. Chosen: the most."""

_OTHER = ("velocity", "trial", "block", "order")


@dataclass(frozen=True, repr=False)
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
    relative_sd : float
        Stated relative error of one trial; NaN where it is not known.
    """

    conditions: tuple[Mapping[str, Value], ...]
    velocity: NDArray[np.float64]
    condition: NDArray[np.int64]
    block: NDArray[np.int64]
    order: NDArray[np.float64]
    relative_sd: float = math.nan


@dataclass(frozen=True)
class _Trial:
    """A sound row."""

    velocity: float
    setting: tuple[tuple[str, Any], ...]
    block: str
    order: float
    line: int


def read_velocity(
    path: Path, scenario: Scenario, relative_sd: float
) -> tuple[VelocityData, list[str]]:
    """Read a table of velocities, and say what was left out of it.

    Parameters
    ----------
    path : Path
    scenario : Scenario
        Gives the drive settings that have no column.
    relative_sd : float
        Relative error of one trial, NaN if not known.

    Raises
    ------
    ScenarioError
        If a column is missing or unknown, or no row is sound.
    """
    return sound_trials(path, *read_rows(path), scenario, relative_sd)


def sound_trials(
    path: Path,
    header: Sequence[str],
    rows: Sequence[tuple[int, list[str]]],
    scenario: Scenario,
    relative_sd: float,
    word: str = "line",
) -> tuple[VelocityData, list[str]]:
    """The sound rows of a table of text cells, and what was left out; see `read_velocity`.

    Parameters
    ----------
    path : Path
        Of the file, or what the table is called in messages.
    header : sequence of str
    rows : sequence of tuple
        Number of each row in messages, and its cells.
    scenario, relative_sd
        As in `read_velocity`.
    word : str
        What a row is called in messages.
    """
    trials, left_out = _sound_rows(path, header, rows, scenario, word)
    velocity = np.array([each.velocity for each in trials])
    condition = _numbered([each.setting for each in trials])
    size = float(np.median(np.abs(velocity)))
    if size > FASTEST:
        raise ScenarioError(
            f"{path}: velocities of {size:.3g} m/s; allowed is at most {FASTEST} m/s. "
            "If they are in mm/s or um/s, divide them by 1e3 or 1e6"
        )
    sound = _without_outliers(path.name, velocity, condition, left_out)
    fast = sound & (np.abs(velocity) > FASTEST)
    if fast.any():
        lines = [trials[k].line for k in np.flatnonzero(fast)]
        left_out.append(
            f"{path.name} {listed(lines, word)}: a velocity above {FASTEST} m/s; "
            "if it is in mm/s or um/s, divide it by 1e3 or 1e6"
        )
        sound &= ~fast
    blocks = _numbered([each.block for each in trials if each.block])
    block = np.full(len(trials), -1, dtype=np.int64)
    block[[bool(each.block) for each in trials]] = blocks
    kept = [trials[k] for k in np.flatnonzero(sound)]
    data = VelocityData(
        tuple(dict(each) for each in dict.fromkeys(each.setting for each in kept)),
        velocity[sound],
        _numbered([each.setting for each in kept]),
        block[sound],
        np.array([each.order for each in kept]),
        relative_sd,
    )
    return data, left_out


def _numbered(values: Sequence[Any]) -> NDArray[np.int64]:
    """Each value's place among the different ones, in the order in which they come."""
    places = {value: k for k, value in enumerate(dict.fromkeys(values))}
    return np.array([places[value] for value in values], dtype=np.int64)


def _sound_rows(
    path: Path,
    header: Sequence[str],
    rows: Sequence[tuple[int, list[str]]],
    scenario: Scenario,
    word: str,
) -> tuple[list[_Trial], list[str]]:
    """Rows that can be meant, and what was left out."""
    drive = [key.split(".", 1)[1] for key in known_keys() if key.startswith("drive.")]
    check_columns(path, header, ["velocity"])
    refuse_unknown(path, header, [*_OTHER, *drive])
    reasons: dict[str, list[int]] = {}
    wrong: list[tuple[int, str]] = []
    kept: list[_Trial] = []
    seen: set[tuple[str, ...]] = set()
    for line, row in rows:
        why, setting = _refused(row, header, seen, drive, scenario, word)
        other = "" if why else _in_other_unit(dict(setting))
        if other:
            wrong.append((line, other))
        if why or other:
            reasons.setdefault(why or other, []).append(line)
            continue
        seen.add(tuple(row))
        cells = dict(zip(header, row, strict=True))
        order = number(cells.get("order", ""))
        kept.append(_Trial(number(cells["velocity"]), setting, cells.get("block", ""), order, line))
    if len(wrong) > _SAME_MISTAKE * len(rows):
        line, other = wrong[0]
        raise ScenarioError(f"{path}: {word} {line}: {other}; {len(wrong)} rows are like this")
    left_out = [f"{path.name} {listed(lines, word)}: {reason}" for reason, lines in reasons.items()]
    lost = sum(len(lines) for lines in reasons.values())
    if lost > _MANY * len(rows):
        left_out.insert(0, f"{path.name}: {lost} of {len(rows)} rows were left out")
    if not kept:
        reason = next(iter(reasons), "it has none")
        raise NothingSound(f"{path}: no row is sound; the first: {reason}")
    return kept, left_out


def _refused(
    row: list[str],
    header: Sequence[str],
    seen: set[tuple[str, ...]],
    drive: list[str],
    scenario: Scenario,
    word: str,
) -> tuple[str, tuple[tuple[str, Any], ...]]:
    """Why a row cannot be used, empty if it can, and its drive settings."""
    if len(row) != len(header):
        return f"{len(row)} cells, not {len(header)}", ()
    cells = dict(zip(header, row, strict=True))
    if not math.isfinite(number(cells["velocity"])):
        return f"velocity {shown(cells['velocity'])} is no number", ()
    if tuple(row) in seen and ("trial" in cells or "order" in cells):
        return f"repeats an earlier {word}", ()
    try:
        return "", _setting(cells, drive, scenario)
    except ScenarioError as error:
        return str(error), ()


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
        value: Value = cells[name]
        if key.kind == "word":
            # An apparatus may write "ipp" and "+X".
            spelt = (cells[name], cells[name].upper(), cells[name].lower())
            value = next((each for each in spelt if f'"{each}"' in key.allowed), value)
        else:
            value = number(cells[name])
            if not math.isfinite(value):
                raise ScenarioError(f"{name} {shown(cells[name])} is no number")
            if key.kind == "whole" and value == int(value):
                value = int(value)
        changes[key.name] = value
    if changes.get("drive.mode") == "program":
        raise ScenarioError('mode "program" has no place in a table of velocities')
    full = scenario.replace(changes)
    return tuple((f"drive.{name}", full.get(f"drive.{name}")) for name in drive)


def _in_other_unit(setting: Mapping[str, Value]) -> str:
    """Why a setting can only be in mT or kHz; empty if it need not."""
    for name in ("peak", "base", "hold"):
        field = float(setting[f"drive.{name}"])
        if field > _STRONGEST:
            return f"{name} of {field:.3g} T is above {_STRONGEST} T; in mT, divide it by 1e3"
    frequency = float(setting["drive.frequency"])
    if frequency < _SLOWEST:
        return f"frequency of {frequency:.3g} Hz is below {_SLOWEST} Hz; in kHz, multiply it by 1e3"
    return ""


def _without_outliers(
    name: str, velocity: NDArray[np.float64], condition: NDArray[np.int64], left_out: list[str]
) -> NDArray[np.bool_]:
    """Leave out a trial that lies absurdly far from the others of its condition."""
    far, level = far_from_their_group(velocity, condition)
    for index in np.flatnonzero(far):
        ratio = velocity[index] / level[index] if level[index] else math.inf
        unit = " (a factor of 1000: a wrong unit?)" if 0.9e3 < abs(ratio) < 1.1e3 else ""
        unit = " (a factor of 1/1000: a wrong unit?)" if 0.9e-3 < abs(ratio) < 1.1e-3 else unit
        left_out.append(
            f"{name}: trial of {velocity[index]:.4g} m/s where the others of its condition are "
            f"near {level[index]:.4g} m/s{unit}"
        )
    return np.asarray(~far)
