"""The points of a sweep: one scenario, and the keys that vary along its dimensions."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip._util.arrays import Array, Indices, columns_of
from stickslip._util.messages import MOST_VALUES, as_list, check_kind, shown
from stickslip.errors import ScenarioError
from stickslip.scenario.changes import Changes
from stickslip.scenario.held import OBJECTS, PATHS
from stickslip.scenario.keys import (
    COIL_MAP,
    COIL_NAMES,
    SAWTOOTH,
    Value,
    check_word,
    checked,
    is_of_one_coil,
    known_keys,
    refuse_sawtooth,
)
from stickslip.scenario.law import refuse_unknown_laws
from stickslip.scenario.scenario import Scenario

if TYPE_CHECKING:
    from pandas import DataFrame

Vary: TypeAlias = "Mapping[str, Iterable[Value]] | Sequence[Mapping[str, Value]] | DataFrame"
"""Values of each key for a grid, or changes of each point for a list, also as a table."""

Column = tuple[str, NDArray[Any]]
"""The dimension along which a key varies, and its value at each place."""

POINT, DRAW = "point", "draw"
"""Dimensions of a list, and of the draws of a prediction."""


@dataclass
class Points:
    """All combinations of the places along some dimensions; without dimensions a single point."""

    scenario: Scenario  # what the points have in common
    sizes: Mapping[str, int]  # of the dimensions by name, the last one fastest
    columns: Mapping[str, Column]  # by dotted key

    def __post_init__(self) -> None:
        check_count(self.count)
        names: dict[str, str] = {}
        for key in self.keys:
            if names.setdefault(name_of(key), key) != key:
                raise ScenarioError(f"{key}: a sweep cannot vary it beside {names[name_of(key)]}")
        self.scenario = self.scenario.without_record()

    @property
    def keys(self) -> tuple[str, ...]:
        """The dotted keys that vary."""
        return tuple(self.columns)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of places along each dimension."""
        return tuple(self.sizes.values())

    @property
    def count(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    def at_each(self, key: str) -> NDArray[Any]:
        """Value of a key at every point, `shape`; that of the scenario where nothing varies it."""
        if key not in self.columns:
            return np.full(self.shape, self.scenario.get(key))
        dimension, values = self.columns[key]
        along = [len(values) if name == dimension else 1 for name in self.sizes]
        return np.broadcast_to(values.reshape(along), self.shape)

    def rows(self, indices: Indices) -> Array:
        """Values of some points as the core takes them, shape (n, number of keys)."""
        places = dict(zip(self.sizes, np.unravel_index(indices, self.shape), strict=True))
        return np.column_stack(
            [encoded(key, values[places[along]]) for key, (along, values) in self.columns.items()]
        )

    def with_draws(self, keys: Sequence[str], values: Array) -> Points:
        """Each point with each of n draws of other keys, shape (n, number of `keys`)."""
        drawn = {key: (DRAW, column) for key, column in zip(keys, values.T, strict=True)}
        sizes = {**self.sizes, DRAW: len(values)}
        return Points(self.scenario, sizes, {**self.columns, **drawn})

    def identity(self) -> str:
        """Scenario, points and version as JSON: equal for equal sweeps alone."""
        scenario, field_map = self.scenario, self.scenario.coil.map
        if field_map is not None:  # whose file may have another name
            scenario = scenario.replace({COIL_MAP: replace(field_map, source="")})
        about = {"stickslip_version": _core.__version__, **scenario.document()}
        columns = {key: values.tolist() for key, (_, values) in self.columns.items()}
        return json.dumps({**about, "dimensions": dict(self.sizes), "vary": columns})


def check_count(count: int) -> None:
    """Refuse a sweep of more points than `MOST_VALUES`."""
    if count > MOST_VALUES:
        raise ScenarioError(f"{count} points: allowed are at most {MOST_VALUES} simulations")


def name_of(key: str) -> str:
    """The name of a key in a dataset, such as ``drive_frequency``."""
    return key.replace(".", "_")


def encoded(key: str, values: Sequence[Value] | NDArray[Any]) -> Array:
    """Values of a key as numbers, as the core reads them: of a word its index."""
    known = known_keys()[key]
    if known.kind == "word":
        words, places = np.unique(np.asarray(values), return_inverse=True)
        values = np.array([known.words.index(word) for word in words.tolist()])[places]
    return np.asarray(values, dtype=np.float64)


def points_of(scenario: Scenario, vary: Vary | None) -> Points:
    """The points that `sweep` simulates."""
    check_kind("scenario", scenario, Scenario)
    if isinstance(vary, Mapping):
        return grid(scenario, Changes(vary))
    table: Any = vary
    if hasattr(table, "to_dict"):  # a DataFrame
        columns_of("vary", table)  # refuses a column that is there twice
        table = table.to_dict("records")
    rows = as_list("vary", table, "values by key, or a list of changes by key")
    for number, row in enumerate(rows):
        if not isinstance(row, Mapping):
            raise ScenarioError(f"vary, point {number} = {shown(row)}: allowed is a mapping")
    return from_changes(scenario, [Changes(row) for row in rows])


def grid(scenario: Scenario, vary: Mapping[str, Iterable[Value]]) -> Points:
    """All combinations of the values of `vary`, with a dimension for each key.

    Refused are unknown keys, and values that are not allowed, given twice, or not there.
    """
    if not vary:
        raise ScenarioError("a sweep needs a key that varies, such as drive.frequency")
    if "drive.mode" not in vary:
        refuse_sawtooth(scenario.drive.mode, vary)
    columns = {}
    refuse_unknown_laws(scenario.to_core(), vary)
    for key, values in vary.items():
        _check_key(key)
        axis = [checked(key, value) for value in as_list(key, values, "a list of values")]
        _check_axis(key, axis)
        columns[key] = (name_of(key), np.array(axis))
    sizes = {along: len(values) for along, values in columns.values()}
    return Points(scenario, sizes, columns)


def from_changes(scenario: Scenario, rows: Sequence[Mapping[str, Value]]) -> Points:
    """One point for each of `rows`: the scenario with those values changed."""
    if not rows:
        raise ScenarioError("a sweep needs a point: the list is empty")
    given = {key: None for row in rows for key in row}
    refuse_unknown_laws(scenario.to_core(), given)
    for key in given:
        _check_key(key)
    if scenario.coil.own_values() or any(is_of_one_coil(key) for row in rows for key in row):
        rows = [_by_single_coils(row) for row in rows]
    for row in rows:
        idle = [key for key in SAWTOOTH if key in row and row[key] != known_keys()[key].default]
        refuse_sawtooth(row.get("drive.mode", scenario.drive.mode), idle)
    columns = {}
    # A list may change nothing, but the core needs a value for each point.
    for key in {key: None for row in rows for key in row} or ["drive.frequency"]:
        values = [checked(key, row[key]) if key in row else scenario.get(key) for row in rows]
        columns[key] = (POINT, np.array(values))
    return Points(scenario, {POINT: len(rows)}, columns)


def _by_single_coils(row: Mapping[str, Value]) -> dict[str, Value]:
    """The same without keys of all coils: where coils differ, none leaves the others alone."""
    of_all = [key for key in row if key.startswith("coil.") and not is_of_one_coil(key)]
    single = {
        key.replace("coil.", f"coil.{name}."): row[key] for key in of_all for name in COIL_NAMES
    }
    return single | {key: value for key, value in row.items() if key not in of_all}


def _check_key(key: str) -> None:
    check_word(key)
    key = str(key)
    if key in OBJECTS or key in PATHS:
        raise ScenarioError(f"{key}: a sweep varies numbers and words, not voltages or maps")
    if key.startswith("record."):
        raise ScenarioError(f"{key}: a sweep keeps summaries only, whatever is recorded")


def _check_axis(key: str, values: list[Value]) -> None:
    if not values:
        raise ScenarioError(f"{key}: there is no value")
    twice = next((value for value, count in Counter(values).items() if count > 1), None)
    if twice is not None:
        raise ScenarioError(f"{key} = {shown(twice)}: this value is given twice")
