"""Which scenarios a sweep simulates: a grid over keys, or a list.

Every point is one row of numbers, one for each swept key; of a word the number is its index among
the words that its key takes. That is what the compiled core reads.
"""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip._util.numbers import ABSOLUTE, RELATIVE, Array, representatives
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import (
    Value,
    checked,
    is_of_one_coil,
    known_keys,
    shown,
    until_registration,
)
from stickslip.scenario.named_effects import PREFIX
from stickslip.scenario.path_keys import COIL_MAP, PROGRAM
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.section_table import SECTIONS
from stickslip.scenario.sections import (
    COIL_NAMES,
    SAWTOOTH,
    refuse_sawtooth,
    refuse_sawtooth_values,
)
from stickslip.simulation.columns import NUMBERS
from stickslip.simulation.seen_from_drive import VELOCITIES

MOST_POINTS = 10_000_000
"""Points of the largest sweep; their results take some 1.5 GB of memory."""

LIST_DIMENSION = "point"

_RESULTS = (
    *NUMBERS,
    *VELOCITIES,
    "events",
    "painleve_events",
    "status",
    "message",
    "event",
    LIST_DIMENSION,
)


class Points:
    """The points of a sweep: a scenario, and dotted keys with the values that differ from it.

    In a grid the points are all combinations of the keys' values, and each of the `columns` has the
    values of one axis; in a list it has one value a point.
    """

    def __init__(
        self,
        scenario: Scenario,
        arrangement: Literal["grid", "list"],
        columns: Mapping[str, Sequence[Value]],
    ) -> None:
        self.scenario = scenario.replace(
            {key: known_keys()[key].default for key in _keys_of("record")}
        )
        self.arrangement = arrangement
        self.keys = tuple(columns)
        self.columns = tuple(encoded(key, values) for key, values in columns.items())
        if self.count > MOST_POINTS:
            raise ScenarioError(f"{self.count} points: allowed are at most {MOST_POINTS}")

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points along each dimension."""
        if self.arrangement == "list":
            return (len(self.columns[0]),)
        return tuple(len(values) for values in self.columns)

    @property
    def count(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        if self.arrangement == "list":
            return (LIST_DIMENSION,)
        return tuple(short_name(key) for key in self.keys)

    def rows(self, indices: NDArray[np.int64]) -> Array:
        """Values of some points, shape (n, number of keys); the last key of a grid runs fastest."""
        if self.arrangement == "list":
            places: Sequence[NDArray[np.int64]] = [indices] * len(self.keys)
        else:
            places = np.unravel_index(indices, self.shape)
        return np.column_stack(
            [values[place] for values, place in zip(self.columns, places, strict=True)]
        )

    def with_draws(self, keys: Sequence[str], values: Array) -> Points:
        """A list of these points with the values of each of n draws, shape (n, number of `keys`).

        The draws of a point follow each other.
        """
        made = copy.copy(self)
        made.arrangement = "list"
        made.keys = (*self.keys, *keys)
        rows = np.repeat(self.rows(np.arange(self.count)), len(values), axis=0)
        made.columns = (*rows.T, *np.tile(values.T, self.count))
        return made

    def labels(self, key: str) -> NDArray[Any]:
        """Values of a key as they stand in a scenario: numbers, whole numbers or words."""
        values = self.columns[self.keys.index(key)]
        kind = known_keys()[key].kind
        if kind == "word":
            words = known_keys()[key].words
            return np.array([words[place] for place in values.astype(int)])
        return values.astype(np.int64) if kind == "whole" else values

    def at_each(self, key: str) -> NDArray[Any]:
        """Value of a key at every point, shape (n,); that of the scenario where none varies it."""
        if key not in self.keys:
            return np.full(self.count, self.scenario.get(key))
        if self.arrangement == "list":
            return self.labels(key)
        axis = self.keys.index(key)
        return self.labels(key)[np.unravel_index(np.arange(self.count), self.shape)[axis]]

    def vary(self) -> str:
        """The keys and their values as JSON, columns as in the attribute `columns`."""
        return json.dumps({key: self.labels(key).tolist() for key in self.keys})


def grid(scenario: Scenario, vary: Mapping[str, Iterable[Value]]) -> Points:
    """All combinations of the values of `vary`.

    Refused are unknown keys, and values that are not allowed, given twice, or not there.
    """
    if not vary:
        raise ScenarioError("a sweep needs a key that varies, such as drive.frequency")
    columns: dict[str, list[Value]] = {}
    if "drive.mode" not in vary:
        refuse_sawtooth(scenario.drive.mode, vary)
    for key, values in vary.items():
        _check_key(key)
        columns[key] = [checked(key, value) for value in as_list(key, values, "a list of values")]
        _check_axis(key, columns[key])
    return Points(scenario, "grid", columns)


def from_changes(scenario: Scenario, rows: Sequence[Mapping[str, Value]]) -> Points:
    """One point for each of `rows`: the scenario with those values changed."""
    if not rows:
        raise ScenarioError("a sweep needs a point: the list is empty")
    for key in {key: None for row in rows for key in row}:
        _check_key(key)
    if scenario.coil.own_values() or any(is_of_one_coil(key) for row in rows for key in row):
        rows = [_by_single_coils(row) for row in rows]
    keys = list(dict.fromkeys(key for row in rows for key in row))
    for row in rows:
        sawtooth = {key: row[key] for key in SAWTOOTH if key in row}
        refuse_sawtooth_values(row.get("drive.mode", scenario.drive.mode), sawtooth)
    columns: dict[str, list[Value]] = {}
    # A list may change nothing, but its points need a coordinate.
    for key in keys or ["drive.frequency"]:
        own = scenario.get(key)
        columns[key] = [checked(key, row[key]) if key in row else own for row in rows]
    return Points(scenario, "list", columns)


def _by_single_coils(row: Mapping[str, Value]) -> dict[str, Value]:
    """The same without keys of all coils: where coils differ, none leaves the others alone."""
    of_all = {key for key in row if key.startswith("coil.") and not is_of_one_coil(key)}
    single = {
        key.replace("coil.", f"coil.{name}."): row[key] for key in of_all for name in COIL_NAMES
    }
    return single | {key: value for key, value in row.items() if key not in of_all}


def from_scenarios(scenarios: Sequence[Scenario]) -> Points:
    """One point for each scenario, by the keys in which they differ; all with one program."""
    if not scenarios:
        raise ScenarioError("a sweep needs a point: the list is empty")
    programs = {each.drive.program for each in scenarios} - {None}
    if len(programs) > 1:
        raise ScenarioError(
            f"{PROGRAM}: the scenarios of a sweep can have one program of voltages, not "
            f"{len(programs)}"
        )
    if len({each.coil.map for each in scenarios}) > 1:
        raise ScenarioError(f"{COIL_MAP}: the scenarios of a sweep have one map, or none has one")
    base = next((each for each in scenarios if each.drive.program is not None), scenarios[0])
    rows = [_changed_keys(base, each) for each in scenarios]
    return from_changes(base, rows)


@until_registration
def _short_names() -> dict[str, str]:
    registered = tuple(f"{PREFIX}{name}." for name in _core.registered_effects())
    own = [key for key in known_keys() if key.startswith(registered)]
    keys = [key for key in known_keys() if key not in own]
    last = [key.rpartition(".")[2] for key in keys]
    names = {}
    for key in keys:
        section, _, name = key.removeprefix(PREFIX).rpartition(".")
        names[key] = name if last.count(name) == 1 else f"{section.replace('.', '_')}_{name}"
    # What the user registers must neither change those names nor take the place of a result.
    taken = {*names.values(), *_RESULTS}
    for key in own:
        name = key.removeprefix(PREFIX).replace(".", "_")
        names[key] = key if name in taken else name
        taken.add(name)
    return names


def short_name(key: str) -> str:
    """What a key is called in a dataset: its last word, with its section where others have it."""
    return _short_names()[key]


def _changed_keys(base: Scenario, scenario: Scenario) -> dict[str, Value]:
    changed: dict[str, Value] = {}
    for section in (*SECTIONS, "effects"):
        if section == "record" or getattr(base, section) == getattr(scenario, section):
            continue
        for key in _keys_of(section):
            value = scenario.get(key)
            # A change of all coils is none of single ones.
            before = base.replace(changed) if is_of_one_coil(key) else base
            if value != before.get(key):
                changed[key] = value
    return changed


@until_registration
def _keys_of(section: str) -> tuple[str, ...]:
    return tuple(key for key in known_keys() if key.startswith(f"{section}."))


def _check_key(key: object) -> None:
    if not isinstance(key, str):
        raise ScenarioError(f"key {shown(key)}: allowed is a word such as drive.frequency")
    if key in (PROGRAM, "drive.file"):
        raise ScenarioError(f"{key}: a sweep varies numbers and words, not voltages")
    if key == COIL_MAP:
        raise ScenarioError(f"{key}: a sweep varies numbers and words, not maps of the field")
    if isinstance(key, str) and key.startswith("record."):
        raise ScenarioError(f"{key}: a sweep keeps summaries only, whatever is recorded")


def as_list(name: str, values: object, allowed: str) -> list[Any]:
    """The values of an iterable that is neither text nor mapping; `allowed` names it in errors."""
    try:
        if not isinstance(values, str | bytes | Mapping):
            return list(values)  # type: ignore[call-overload, no-any-return]
    except TypeError:  # not iterable, such as an array without dimensions
        pass
    raise ScenarioError(f"{name} = {shown(values)}: allowed is {allowed}")


def _check_axis(key: str, values: list[Value]) -> None:
    if not values:
        raise ScenarioError(f"{key}: there is no value")
    # No setting of a drive is as small as 1e-12; a mass or a drag may be.
    absolute = ABSOLUTE if key.startswith("drive.") else 0.0
    numbers = [value for value in values if isinstance(value, float)]
    same = representatives(numbers, absolute=absolute)
    seen: dict[Value, Value] = {}
    for value in values:
        one = same[value] if isinstance(value, float) else value
        if one in seen:
            near = f", as {shown(seen[one])}: numbers within {RELATIVE:g} are the same setting"
            said = "this value is given twice" + ("" if value == seen[one] else near)
            raise ScenarioError(f"{key} = {shown(value)}: {said}")
        seen[one] = value


def encoded(key: str, values: Sequence[Value]) -> Array:
    """Values of a key as numbers, as the core reads them: of a word its index."""
    if known_keys()[key].kind == "word":
        places = {word: place for place, word in enumerate(known_keys()[key].words)}
        values = [places[str(value)] for value in values]
    return np.array(values, dtype=np.float64)
