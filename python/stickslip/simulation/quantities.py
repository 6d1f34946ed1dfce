"""The quantities of a run: names, units and meanings as the core's tables have them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from stickslip import _core
from stickslip._util.messages import refuse

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario


class Column(NamedTuple):
    """A quantity: its SI unit, "1" for none, and what it is."""

    unit: str
    meaning: str


COLUMNS = {name: Column(*row) for name, row in _core.record_columns.items()}
"""The recorded quantities by name; each is an attribute of a `Run`."""

NUMBERS = {name: Column(*row) for name, row in _core.summary_numbers.items()}
"""The numbers of a summary that are no counts."""

ASKED = {"pull_share": "record.pull_share"}
"""Those that a scenario has to ask for, by the key that does so."""

PLANE_COLUMNS: tuple[str, ...] = _core.plane_columns
"""Those of a run in the whole plane alone, where friction and slip are along the heading."""

INNER_COLUMNS: tuple[str, ...] = _core.inner_columns
"""Those of a robot with an inner mass alone."""

WORDS = {"contact": tuple(_core.contact_words)[1:], "event": tuple(_core.events)}
"""Words of the numbers of a quantity, where they stand for words."""


def recorded_names(scenario: Scenario) -> tuple[str, ...]:
    """The quantities that a run of a scenario keeps; none without a record."""
    record = scenario.record
    if record.rate == "none":
        return ()
    left_out = {*_absent(scenario)}
    if record.fields != "all":
        left_out |= {*COLUMNS} - {"t", *record.fields.split(", ")}
    return tuple(name for name in COLUMNS if name not in left_out)


def check_fields(scenario: Scenario) -> None:
    """Refuse a quantity that is asked for by its name, and that the record cannot have."""
    record, absent = scenario.record, _absent(scenario)
    for name in record.fields.split(", ") if record.rate != "none" else ():
        if name in absent:
            refuse("record.fields", record.fields, f"{name} only {absent[name]}")


def _absent(scenario: Scenario) -> dict[str, str]:
    """The quantities that no record of a scenario has, and what would have them."""
    absent = {} if scenario.record.rate == "events" else {"event": 'with record.rate = "events"'}
    if not scenario.whole_plane:
        absent |= dict.fromkeys(
            PLANE_COLUMNS, "of a robot that is turned or pushed across, as by drive.heading = 0.3"
        )
    if scenario.inner.mass == 0.0:
        absent |= dict.fromkeys(INNER_COLUMNS, "of a robot with inner.mass above 0")
    return absent


def column_units(name: str) -> dict[str, str]:
    """The columns of a quantity in a table, with the SI unit of each; "" for words."""
    unit = "" if name in WORDS else COLUMNS[name].unit
    if name != "current":
        return {name: unit}
    return {f"current_{coil}": unit for coil in _core.coil_names}


def headings(name: str) -> list[str]:
    """The headings of a quantity in a CSV file, such as ``current xp (A)``."""
    return [
        f"{column.replace('current_', 'current ')} ({unit})" if unit else column
        for column, unit in column_units(name).items()
    ]
