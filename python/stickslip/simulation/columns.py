"""The quantities of a run: names, units, and what their numbers stand for."""

from __future__ import annotations

from typing import NamedTuple

from stickslip import _core
from stickslip.scenario.keys import COIL_NAMES


class Column(NamedTuple):
    """A quantity: its SI unit, "1" for none, and what it is."""

    unit: str
    meaning: str


COLUMNS = {name: Column(*row) for name, row in _core.record_columns.items()}
"""The recorded quantities by name; each is an attribute of a `Run`."""

NUMBERS = {name: Column(*row) for name, row in _core.summary_numbers.items()}
"""The numbers of a summary that are no counts."""

PLANE_COLUMNS: tuple[str, ...] = _core.plane_columns
"""Those of a run in the whole plane alone, where friction and slip are along the heading."""

WORDS = {"contact": tuple(_core.contact_words)[1:], "event": tuple(_core.events)}
"""What the numbers of a quantity stand for, where they stand for words."""


def column_units(name: str) -> dict[str, str]:
    """The columns of a quantity in a table, with the SI unit of each; "" for words."""
    unit = "" if name in WORDS else COLUMNS[name].unit
    return {f"current_{coil}": unit for coil in COIL_NAMES} if name == "current" else {name: unit}
