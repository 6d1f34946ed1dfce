"""Tables of mean velocities: one row a trial, grouped into conditions."""

from __future__ import annotations

import functools
import itertools
import math
from collections import Counter, defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from stickslip._util.arrays import RELATIVE, Array, Indices, Mask, representatives
from stickslip._util.cells import STAMP
from stickslip._util.clocks import seconds
from stickslip._util.columns import MANY_GAPS, Column, NothingSound, SourceTable
from stickslip._util.messages import shown
from stickslip._util.note import Note
from stickslip._util.recipes import Entry, Match, Recipe
from stickslip._util.text import OneLine, counted, plain
from stickslip._util.units import is_of, quantity_of, split_unit
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Key, Value, full_name, in_allowed_case, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.sweeping.points import name_of
from stickslip.walker.outliers import far_from_their_group

_LONGEST_DAY = 12 * 3600.0
"""Time between clocks of one day, s. Chosen: as long as people measure."""

_DRIVE, _EFFECTS = "drive.", "effects_"
"""Prefixes of keys of settings; a column's name may leave out those of effects."""

NOT_SETTINGS: Mapping[str, str | None] = {
    "velocity": "m/s", "trial": None, "block": None, "order": "-",
}  # fmt: skip
"""Columns that say nothing of the drive, with the units of their numbers."""

_CALLED = {
    "mode": ("coil", "plane"), "frequency": ("f", "freq", "rate", "pulse rate"),
    "peak": ("amplitude", "ampl", "amp", "field", "peak field", "drive field", "b", "bmax", "b0",
             "bpeak", "ac field", "intensity"),
    "base": ("offset", "bias", "dc field", "baseline", "bmin"),
    "hold": ("clamp field", "holding field", "hold field", "bz", "bclamp"),
    "edge_time": ("rise time", "fall time"), "edge": ("slope", "shape", "waveform"),
    "direction": ("dir", "sense", "heading"), "pulses": ("cycles", "n pulses", "steps"),
    "": ("duty", "duty cycle", "phase", "gain", "voltage", "current", "power"),
}  # fmt: skip
"""Further names of settings in laboratories; the last ones are of no key."""

_BESIDE = {
    "index", "no", "nr", "number", "n", "id", "run", "repeat", "repetition", "rep", "film", "file",
    "video", "sample", "day", "week", "date", "time", "temperature", "temp", "humidity", "pressure",
    "sd", "error", "std", "stderr", "velocity", "speed", "v", "distance", "quality", "frames",
    "row", "measurement", "test", "series", "set", "operator", "comment", "weight", "r2", "p",
}  # fmt: skip
"""Words in the names of columns whose numbers differ between repeats of one setting."""


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
    """A sound row, and its number."""

    velocity: float
    setting: tuple[tuple[str, Any], ...]
    block: str
    label: str
    order: float
    row: int


class _Velocities(Recipe):
    """The recipe of a table of velocities, whose other columns may be settings by other names."""

    def check(self, columns: Sequence[Match]) -> None:
        """Refuse keys of the scenario, and settings by another name or by their unit, too."""
        written = {name_of(key).removeprefix(start)
                   for key in known_keys() for start in ("", _EFFECTS)}  # fmt: skip
        others = [match.heading for match in columns if not match.known]
        for heading in others:
            key = split_unit(heading)[0]
            if full_name(key) in known_keys() or key in written:
                raise ScenarioError(
                    f"column {shown(heading)} is a key of the scenario: allowed are those of "
                    f"[drive], {', '.join(settings())}; write it into the scenario"
                )
        super().check(columns)
        there = {match.name for match in columns}
        for heading in others:
            self._check_setting(heading, there)

    def _check_setting(self, heading: str, there: Collection[str]) -> None:
        name, unit = split_unit(heading)
        meant = next((key for key, also in _CALLED.items() if plain(name) in also), None)
        if unit and not {*plain(name).split()} & _BESIDE:
            si = quantity_of(unit)
            of = [key for key in settings() if self.entries[key].unit == si not in ("-", "m/s")]
            if of and meant not in of:
                meant = " or ".join(key for key in of if key not in there) or of[0]
        if meant:
            said = meant.split(" or ")[0]
            in_unit = f" ({unit})" if unit and is_of(unit, self.entries[said].unit or "") else ""
            raise ScenarioError(
                f"column {shown(heading)} may be the setting {meant}, which would be lost: call it "
                f'"{said}{in_unit}", or give it as information a name that is less like a setting'
            )
        if meant == "":
            raise ScenarioError(
                f"column {shown(heading)} may be a setting of the drive, and [drive] has no such "
                f"key: allowed are {', '.join(settings())}; write what it means as one of these, "
                "or leave it out"
            )


@functools.cache
def settings() -> dict[str, Key]:
    """The keys of ``[drive]`` by their bare names."""
    return {name.removeprefix(_DRIVE): key for name, key in known_keys().items()
            if name.startswith(_DRIVE)}  # fmt: skip


@functools.cache
def velocities() -> Recipe:
    """The columns that a table of velocities may have."""
    entries = {name: Entry(unit, required=name == "velocity", clock=name == "order")
               for name, unit in NOT_SETTINGS.items()}  # fmt: skip
    for name, key in settings().items():
        unit = None if key.kind == "word" else key.unit
        entries[name] = Entry(unit, (key.name, name_of(key.name)))
    return _Velocities(entries)


def with_index_columns(table: Any) -> Any:
    """A table in memory whose index levels that are columns of velocities have become columns.

    They are what ``set_index`` and ``groupby`` leave there; other levels stay what rows are called.
    """
    names = getattr(getattr(table, "index", None), "names", ())
    known = [name for name in names if name in velocities().names and name not in table]
    return table.reset_index(known) if known else table


def read_velocity(
    table: SourceTable,
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
    table = table.valid()
    _check_clocks(table)
    trials, left_out = _sound_rows(table, scenario, strict)
    _check_repeats(table, trials)
    left_out += [*table.notes, *table.not_used()]
    known = [condition for data in earlier for condition in data.conditions]
    trials = _with_equal_settings(table.name, trials, scenario, known, left_out)
    velocity = np.array([trial.velocity for trial in trials])
    condition = _numbered([trial.setting for trial in trials])
    sound = _without_outliers(table.name, velocity, condition, left_out)
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
    table: SourceTable, scenario: Scenario, earlier: Sequence[VelocityData]
) -> tuple[VelocityData, list[Note]]:
    """The trials of a table of proposed drives, and which of them are left out as outliers.

    Rows without a velocity were not measured. All others have to be sound, as whoever has just
    filled them in can correct them: where a long table of old data is used as far as it goes, this
    one is refused. What `earlier` tables state of the error of a trial counts for all. A
    ScenarioError is raised with the first row that is not sound, or if no row has a velocity or all
    trials are among the `earlier` ones.
    """
    path = table.path
    column = table.columns["velocity"]
    filled = [k for k in range(len(table)) if column.cell(k) or k in table.ragged]
    if not filled:
        raise ScenarioError(f"{path}: no row has a velocity; allowed is one or more")
    # Whoever filled it in has to find it, so notes name its whole path.
    whole = replace(table.kept(filled), name=str(path))
    data, left_out = read_velocity(whole, scenario, math.nan, earlier, strict=True)
    known = {trial for old in earlier for trial in _trials(old)}
    if known.issuperset(_trials(data)):
        twice = "all its trials are in the measurement already"
        raise ScenarioError(f"{path}: {twice}: allowed is once, or they would count twice")
    return data, left_out


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


def _sound_rows(
    table: SourceTable, scenario: Scenario, strict: bool
) -> tuple[list[_Trial], list[Note]]:
    """Rows that can be used, at least one, and why the others cannot."""
    columns, count = table.columns, len(table)
    # A number is the same whatever its spelling.
    cells = ([column.cell(k) if math.isnan(value) else value
              for k, value in enumerate(column.numbers.tolist())]
             for column in columns.values())  # fmt: skip
    compared = list(zip(*cells, strict=True))
    times = {*Counter(compared).values()}
    pasted = len(times) == 1 and times != {1}  # all rows equally often: a table put in again
    counts_once = "trial" in columns or "order" in columns or pasted
    wrong: dict[tuple[str, str], list[int]] = {}  # in the order of the file
    kept: list[_Trial] = []
    seen: set[tuple[object, ...]] = set()
    settings = _Settings(table, scenario)
    labels = [columns[name].texts if name in columns else [""] * count
              for name in ("block", "trial")]  # fmt: skip
    for row, same in enumerate(compared):
        try:
            if row in table.ragged:
                raise _Unsound("cell-count", f"{table.ragged[row]}: not used.")
            if counts_once and same in seen:
                raise _Unsound("repeated-row", "the row repeats an earlier one.")
            velocity = _number(columns["velocity"], row)
            setting = settings.of(row)
            order = _order(columns["order"], row) if "order" in columns else math.nan
            kept.append(_Trial(velocity, setting, labels[0][row], labels[1][row], order, row))
            seen.add(same)
        except _Unsound as error:
            wrong.setdefault(error.args, []).append(row)
    left_out = [
        Note(code, f"{table.at(rows)}: {text}", len(rows)) for (code, text), rows in wrong.items()
    ]
    if left_out and strict:
        hint = " Allowed are numbers; a velocity that was not measured stays empty."
        raise ScenarioError(f"{left_out[0]}{hint if left_out[0].code == 'not-a-number' else ''}")
    if not kept:
        raise NothingSound(table.path, left_out[0])
    lost = count - len(kept)
    if lost > MANY_GAPS * count:
        text = f"{table.name}: {lost} of {count} rows were left out."
        left_out.insert(0, Note("rows-left-out", text, lost))
    return kept, left_out


def _check_repeats(table: SourceTable, trials: Sequence[_Trial]) -> None:
    """Refuse a column with words of a setting, or numbers that tell apart what would be repeats."""
    groups: dict[object, list[int]] = defaultdict(list)
    for trial in trials:
        groups[trial.setting].append(trial.row)
    several = [rows for rows in groups.values() if len(rows) > 1]
    for name in table.others:
        column = table.columns[name]
        for key, of in settings().items():
            words = {in_allowed_case(of, text) for text in column.texts} - {"", "none"}
            if key not in table.columns and words and words <= {*of.words}:
                raise ScenarioError(
                    f"{table.path}: column {shown(name)} has words of the setting {key}, which "
                    f'would be lost: call it "{key}", or leave it out'
                )
        bare, unit = split_unit(name)
        if {*plain(bare).replace(".", " ").split()} & _BESIDE or (unit and is_of(unit, "K")):
            continue
        told = {tuple(sorted({*column.numbers[rows].tolist()})) for rows in several}
        differ = [values for values in told if len(values) > 1 and not any(map(math.isnan, values))]
        different, count = {*column.numbers.tolist()}, sum(map(len, several))
        # What is measured beside hardly comes twice, and has its unit.
        if differ and (not unit or 2 * len(different) <= count):
            values = " and ".join(f"{value:g}" for value in differ[0][:2])
            raise ScenarioError(
                f"{table.path}: column {shown(name)} has {values} in rows that would be repeats "
                f"without it: if it is a setting, call it by its key of [drive] "
                f"({', '.join(settings())}); if it numbers them, call it "
                '"trial" or "block"; else leave it out'
            )


def _check_clocks(table: SourceTable) -> None:
    """Refuse an order by clocks without dates that may go on after midnight."""
    if "order" not in table.columns:
        return
    column = table.columns["order"]
    written = [column.odd[k] for k in sorted(column.odd) if column.odd[k]]
    stamps = [stamp for stamp in map(STAMP.fullmatch, written) if stamp]
    kinds = {bool(stamp["date"]) for stamp in stamps}
    numbers = bool(np.isfinite(column.values).any()) or len(stamps) < len(written)
    if stamps and len(kinds) + numbers > 1:
        raise ScenarioError(
            f"{table.path}: column order mixes dates, clocks and numbers: allowed is one of these"
        )
    clocks = [seconds(stamp[0]) for stamp in stamps if not stamp["date"]]
    if clocks and max(clocks) - min(clocks) > _LONGEST_DAY:
        raise ScenarioError(
            f"{table.path}: clocks in column order are more than {_LONGEST_DAY / 3600:g} h apart: "
            "write dates, such as 2026-05-01 12:00, as the day may have changed"
        )


def _number(column: Column, row: int) -> float:
    value, cell = float(column.values[row]), column.cell(row)
    if math.isnan(value):
        name = column.what.name
        text = f"{name} {shown(cell)} is not a number." if cell else ""
        raise _Unsound("not-a-number", text or f"{name} is empty.")
    return value


def _order(column: Column, row: int) -> float:
    """A place in the order: a number, a date or a clock; NaN where none is stated."""
    value, cell = float(column.values[row]), column.cell(row)
    if math.isnan(value) and cell:
        value = seconds(cell)
        return _number(column, row) if math.isnan(value) else value
    return value


class _Settings:
    """The drive settings of rows, in the order of the keys; each is checked once as a scenario."""

    def __init__(self, table: SourceTable, scenario: Scenario) -> None:
        self.scenario = scenario
        self.columns = {name: table.columns[name] for name in settings() if name in table.columns}
        self.made: dict[tuple[Value, ...], tuple[tuple[str, Any], ...] | _Unsound] = {}

    def of(self, row: int) -> tuple[tuple[str, Any], ...]:
        """The settings of a row."""
        changes: dict[str, Value] = {}
        for name, column in self.columns.items():
            key = settings()[name]
            if key.kind == "word":
                changes[key.name] = in_allowed_case(key, column.texts[row])
            else:
                value = _number(column, row)
                whole = key.kind == "whole" and value == int(value)
                changes[key.name] = int(value) if whole else value
        same = tuple(changes.values())
        if same not in self.made:
            try:
                self.made[same] = self._checked(changes)
            except _Unsound as error:
                self.made[same] = error
        made = self.made[same]
        if isinstance(made, _Unsound):
            raise made
        return made

    def _checked(self, changes: Mapping[str, Value]) -> tuple[tuple[str, Any], ...]:
        if changes.get("drive.mode") == "program":
            text = 'mode "program" has no place in a table of velocities.'
            raise _Unsound("setting-refused", text)
        try:
            full = self.scenario.replace(changes)
        except ScenarioError as error:
            raise _Unsound("setting-refused", f"{error}.") from None
        return tuple((key.name, full.get(key.name)) for key in settings().values())


def _without_outliers(name: str, velocity: Array, condition: Indices, left_out: list[Note]) -> Mask:
    """Leave out trials that are outliers among the others of their condition."""
    far, level = far_from_their_group(velocity, condition)
    for k in np.flatnonzero(far):
        text = f"{name}: a trial of {velocity[k]:.4g} m/s is far from the others of its condition, "
        text += f"which are near {level[k]:.4g} m/s"
        left_out.append(Note("outlier", f"{text}.", float(velocity[k])))
    return np.asarray(~far)
