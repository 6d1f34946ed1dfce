"""Drives that were not measured, as a person writes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Value, known_keys, suggestion
from stickslip.scenario.scenario import Scenario


def drive_settings(
    given: Any, scenario: Scenario
) -> tuple[list[dict[str, Value]], list[dict[str, Value]]]:
    """Drive settings by dotted key and by bare name, one of each for every row, in SI units.

    Names may be dotted keys or bare, such as ``frequency``. Every row is checked as a change of
    `scenario`.

    Raises
    ------
    ScenarioError
        With the row and the name, if a name is no key of ``[drive]`` or a value is not allowed.
    """
    rows = given.to_dict("records") if hasattr(given, "to_dict") else given
    if isinstance(rows, Mapping) or not isinstance(rows, Sequence):
        raise ScenarioError("conditions: allowed is a DataFrame or a list of dicts of settings")
    known = [key for key in known_keys() if key.startswith("drive.") and key != "drive.program"]
    found = []
    for number, row in enumerate(rows, start=1):
        settings: dict[str, Value] = {}
        for name, value in row.items():
            key = f"drive.{str(name).removeprefix('drive.')}"
            if key not in known:
                hint = suggestion(str(name), [each.removeprefix("drive.") for each in known])
                raise ScenarioError(f"conditions: row {number}: {name}: {hint}")
            # A column of a table has numpy's numbers.
            settings[key] = value.item() if hasattr(value, "item") else value
        try:
            scenario.replace(settings)
        except ScenarioError as error:
            raise ScenarioError(f"conditions: row {number}: {error}") from None
        found.append(settings)
    bare = [{key.removeprefix("drive."): value for key, value in row.items()} for row in found]
    return found, bare
