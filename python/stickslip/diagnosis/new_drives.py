"""Drives that were not measured, as a person writes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.errors import ScenarioError, prefixed
from stickslip.measurement.tables import Line, index_labels
from stickslip.measurement.velocity import NOT_SETTINGS, with_index_columns
from stickslip.scenario.keys import Value, in_allowed_case, known_keys, shown, suggestion
from stickslip.scenario.scenario import Scenario

_IGNORED = (*NOT_SETTINGS, "velocity_sd")
"""Columns that a table of measured drives has beside its settings."""


def drive_settings(
    given: Any, scenario: Scenario
) -> tuple[list[dict[str, Value]], list[dict[str, Value]]]:
    """Drive settings by dotted key and by bare name, one of each for every row, in SI units.

    Names may be dotted keys or bare, such as ``frequency``, and words in any case. Every row is
    checked as a change of `scenario`. Rows of a DataFrame are called by their index label, others
    by their number from 0.

    Raises
    ------
    ScenarioError
        With the row and the name, if a name is no key of ``[drive]`` or a value is not allowed.
    """
    found = []
    for label, row in _rows(given):
        with prefixed(f"conditions: row {label}"):
            settings = _settings(row)
            scenario.replace(settings)
        found.append(settings)
    bare = [{key.removeprefix("drive."): value for key, value in row.items()} for row in found]
    return found, bare


def _rows(given: Any) -> list[tuple[Line, Mapping[Any, Any]]]:
    """The rows, at least one, and what they are called."""
    import pandas as pd

    labels: Sequence[Line] = range(len(given)) if isinstance(given, Sequence) else ()
    rows = given
    if isinstance(given, pd.DataFrame):
        table = with_index_columns(given)
        labels, rows = index_labels(table), table.to_dict("records")
    if not isinstance(rows, Sequence) or not all(isinstance(row, Mapping) for row in rows):
        said = "allowed is a DataFrame or a list of dicts of settings"
        raise ScenarioError(f"conditions = {shown(given)}: {said}")
    if not rows:
        raise ScenarioError("conditions: there is no row; allowed is one or more")
    return list(zip(labels, rows, strict=True))


def _settings(row: Mapping[Any, Any]) -> dict[str, Value]:
    """The settings of a row by dotted key, in the words and numbers of a scenario."""
    known = [key for key in known_keys() if key.startswith("drive.")]
    settings: dict[str, Value] = {}
    for name, value in row.items():
        if name in _IGNORED:
            continue
        key = f"drive.{str(name).removeprefix('drive.')}"
        if key not in known:
            hint = suggestion(str(name), [each.removeprefix("drive.") for each in known])
            raise ScenarioError(f"{shown(str(name))} is not known; {hint}")
        if value is None or value != value:
            raise ScenarioError(f"{name} is empty")
        if isinstance(value, str):
            settings[key] = in_allowed_case(known_keys()[key], value.strip())
        else:
            # A column of a table has numpy's numbers.
            settings[key] = value.item() if hasattr(value, "item") else value
    return settings
