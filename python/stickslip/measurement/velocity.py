"""Tables of mean velocities: one row a trial, grouped into conditions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.one_line import OneLine
from stickslip.errors import ScenarioError
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

_OUTLIER, _ENOUGH = 8.0, 2000
_MANY = 0.1
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
    drive = [key.split(".", 1)[1] for key in known_keys() if key.startswith("drive.")]
    check_columns(path, header, ["velocity"])
    refuse_unknown(path, header, [*_OTHER, *drive])
    reasons: dict[str, list[int]] = {}
    groups: dict[tuple[tuple[str, Any], ...], int] = {}
    blocks: dict[str, int] = {}
    kept: list[tuple[float, int, int, float, int]] = []
    seen: set[tuple[str, ...]] = set()
    wrong: list[tuple[int, str]] = []
    for line, row in rows:
        if len(row) != len(header):
            reasons.setdefault(f"{len(row)} cells, not {len(header)}", []).append(line)
            continue
        cells = dict(zip(header, row, strict=True))
        velocity = number(cells["velocity"])
        if not math.isfinite(velocity):
            said = f"velocity {shown(cells['velocity'])} is no number"
            reasons.setdefault(said, []).append(line)
            continue
        if tuple(row) in seen and ("trial" in cells or "order" in cells):
            reasons.setdefault(f"repeats an earlier {word}", []).append(line)
            continue
        try:
            setting = _setting(cells, drive, scenario)
        except ScenarioError as error:
            reasons.setdefault(str(error), []).append(line)
            continue
        other = _in_other_unit(dict(setting))
        if other:
            wrong.append((line, other))
            reasons.setdefault(other, []).append(line)
            continue
        seen.add(tuple(row))
        group = groups.setdefault(setting, len(groups))
        block = blocks.setdefault(cells["block"], len(blocks)) if cells.get("block") else -1
        kept.append((velocity, group, block, number(cells.get("order", "")), line))
    if len(wrong) > 0.5 * len(rows):
        line, other = wrong[0]
        raise ScenarioError(f"{path}: {word} {line}: {other}; {len(wrong)} rows are like this")
    left_out = [f"{path.name} {listed(lines, word)}: {reason}" for reason, lines in reasons.items()]
    lost = sum(len(lines) for lines in reasons.values())
    if lost > _MANY * len(rows):
        left_out.insert(0, f"{path.name}: {lost} of {len(rows)} rows were left out")
    if not kept:
        reason = next(iter(reasons), "it has none")
        raise NothingSound(f"{path}: no row is sound; the first: {reason}")
    velocity_all = np.array([each[0] for each in kept])
    condition = np.array([each[1] for each in kept])
    size = float(np.median(np.abs(velocity_all)))
    if size > FASTEST:
        raise ScenarioError(
            f"{path}: velocities of {size:.3g} m/s; allowed is at most {FASTEST} m/s. "
            "If they are in mm/s or um/s, divide them by 1e3 or 1e6"
        )
    sound = _without_outliers(path.name, velocity_all, condition, left_out)
    fast = sound & (np.abs(velocity_all) > FASTEST)
    if fast.any():
        lines = [each[4] for each, out in zip(kept, fast, strict=True) if out]
        left_out.append(
            f"{path.name} {listed(lines, word)}: a velocity above {FASTEST} m/s; "
            "if it is in mm/s or um/s, divide it by 1e3 or 1e6"
        )
        sound &= ~fast
    numbers = {old: new for new, old in enumerate(dict.fromkeys(condition[sound].tolist()))}
    settings = list(groups)
    data = VelocityData(
        tuple(dict(settings[old]) for old in numbers),
        velocity_all[sound],
        np.array([numbers[old] for old in condition[sound].tolist()], dtype=np.int64),
        np.array([each[2] for each in kept], dtype=np.int64)[sound],
        np.array([each[3] for each in kept])[sound],
        relative_sd,
    )
    return data, left_out


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
    """Leave out a trial that lies absurdly far from the others of its condition.

    Three trials have no scale of their own, so all conditions share one, which has a part that does
    not fall with the velocity: slow conditions scatter by more than their share.
    """
    deviation = np.zeros(velocity.shape)
    level = np.zeros(velocity.shape)
    for each in np.unique(condition):
        inside = condition == each
        level[inside] = np.median(velocity[inside])
        if inside.sum() >= 3:
            deviation[inside] = np.abs(velocity[inside] - level[inside])
    # The median of three leaves one deviation at zero, so the rest are the scale.
    positive = deviation > 0.0
    if not positive.any():
        return np.ones(velocity.shape, dtype=bool)
    far = deviation > _OUTLIER * _usual(deviation[positive], level[positive])(level)
    for index in np.flatnonzero(far):
        ratio = velocity[index] / level[index] if level[index] else math.inf
        unit = " (a factor of 1000: a wrong unit?)" if 0.9e3 < abs(ratio) < 1.1e3 else ""
        unit = " (a factor of 1/1000: a wrong unit?)" if 0.9e-3 < abs(ratio) < 1.1e-3 else unit
        left_out.append(
            f"{name}: trial of {velocity[index]:.4g} m/s where the others of its condition are "
            f"near {level[index]:.4g} m/s{unit}"
        )
    return np.asarray(~far)


def _usual(
    deviation: NDArray[np.float64], level: NDArray[np.float64]
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Standard deviation of a trial at a level, sqrt(a^2 + (b level)^2), whatever a few trials do.

    The likeliest of a grid under Student's law with two degrees of freedom, which wild trials do
    not move, made to agree with the median. Of a long table some trials tell enough.
    """
    if len(deviation) > _ENOUGH:
        some = np.random.default_rng(0).choice(len(deviation), _ENOUGH, replace=False)
        deviation, level = deviation[some], level[some]
    moving = np.abs(level[level != 0.0])
    size = float(np.median(moving)) if len(moving) else 1.0
    middle = float(np.median(deviation))
    parts = middle * np.geomspace(0.02, 50.0, 40)
    floor, slope = (each.ravel() for each in np.meshgrid(parts, parts / size))
    scale = np.hypot(floor[:, None], slope[:, None] * level)
    loss = np.sum(np.log(scale) + 1.5 * np.log1p(0.5 * (deviation / scale) ** 2), axis=1)
    best = int(np.argmin(loss))
    unit = 1.48 * float(np.median(deviation / scale[best]))
    return lambda at: np.asarray(unit * np.hypot(floor[best], slope[best] * at))
