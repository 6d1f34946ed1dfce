"""Readings of a table as a report tells them: their title, units and settings in words."""

from __future__ import annotations

import statistics
from typing import Any

import numpy as np

from stickslip._util.numbers import Array
from stickslip._util.units import handy, unit_label
from stickslip.diagnosis.data.angle import AngleTable
from stickslip.diagnosis.data.field import FieldTable
from stickslip.diagnosis.data.film import FilmTable
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.data.velocity import VelocityTable
from stickslip.diagnosis.report.amounts import digits_for
from stickslip.scenario.keys import known_keys

Settings = dict[str, tuple[list[Any], str]]
"""Values of the conditions of a table, and their SI unit, by bare name."""

ROW = "row"
"""What stands for a setting where none is a number."""

_KINDS = (VelocityTable, "velocities"), (AngleTable, "angles"), (FieldTable, "fields")
_UNITS = {"Bx": "T", "Bz": "T", "x": "m", "y": "m", "z": "m"}  # of settings that are no keys


def title_of(table: Table, k: int) -> str:
    """What readings of a table are called."""
    for kind, words in _KINDS:
        if isinstance(table, kind):
            number = str(getattr(table, "title", "")).rpartition(" ")[2]
            return f"{words} {number}" if number.isdigit() else words
    return str(getattr(table, "title", "") or table.name or f"table {k + 1}")


def unit_of(table: Table, row: int) -> str:
    """The SI unit of a reading: a film has several."""
    if isinstance(table, FilmTable):
        column = str(table["column"][table.first[row]])
        return {"theta": "rad", "x": "m", "z": "m"}.get(column, "A")
    return table.unit


def shown_unit(table: Table, row: int) -> tuple[float, str]:
    """Factor from the SI unit to the one that is shown; readings of one's own keep theirs."""
    unit = unit_of(table, row)
    if isinstance(table, VelocityTable | AngleTable | FieldTable | FilmTable):
        return handy(unit)
    return 1.0, unit_label(unit)


def settings_of(table: Table) -> Settings:
    """The settings of a table; what only the simulator needs is left out.

    Of readings in time the time alone, as its inputs follow.
    """
    if isinstance(table, Series):
        return {"t": (table.t.tolist(), "s")}
    columns = table.settings
    if isinstance(columns, np.ndarray):
        array = columns.reshape(len(columns), -1)
        names = [f"setting {k + 1}" for k in range(array.shape[1])]
        columns = dict(zip(names if len(names) > 1 else ["setting"], array.T, strict=True))
    columns = {str(key): each for key, each in columns.items()}
    known = known_keys() if isinstance(table, VelocityTable) else {}
    columns = {key: columns[key] for key in known if key in columns} or columns
    own = _UNITS if isinstance(table, AngleTable | FieldTable) else {}
    return {
        name.removeprefix("drive."): (
            column[table.first].tolist(),
            known[name].unit if name in known else own.get(name, "A" if own else "-"),
        )
        for name, column in columns.items()
        if name != "solver.rtol"
    }


def varied(settings: Settings) -> list[str]:
    """Names of the settings that are not the same in all conditions."""
    return [name for name, (values, _) in settings.items() if len(set(values)) > 1]


def setting_text(settings: Settings, name: str, *values: Any) -> str:
    """A setting as in ``peak 3 mT``, or a range as in ``peak 2 to 3 mT``; words as they are.

    With the digits that tell all its values apart.
    """
    if isinstance(values[0], str):
        return f"{name} {values[0]}"
    every, unit = settings[name]
    factor, shown = handy(unit)
    texts = [f"{float(each) * factor:.{digits_for(every)}g}" for each in dict.fromkeys(values)]
    return f"{name} {' to '.join(texts)} {shown}".rstrip()


def usual_of(settings: Settings) -> dict[str, Any]:
    """Of the numbers that vary the value that more than half of the conditions have, by name.

    None where there is no such value: then each is told.
    """
    found: dict[str, Any] = {}
    for name in varied(settings):
        values = settings[name][0]
        if not isinstance(values[0], str):
            value = statistics.mode(values)
            found[name] = value if 2 * values.count(value) > len(values) else None
    return found


def in_words(settings: Settings) -> list[str]:
    """Each condition by its words, the number that varies most, and those that are unusual."""
    usual = usual_of(settings)
    most = max(usual, key=lambda name: len(set(settings[name][0])), default="")
    words = [each for each in varied(settings) if each not in usual]
    count = len(next(iter(settings.values()))[0]) if settings else 0
    found = []
    for i in range(count):
        said = [setting_text(settings, name, settings[name][0][i]) for name in words]
        said += [
            setting_text(settings, name, settings[name][0][i])
            for name, value in usual.items()
            if name == most or settings[name][0][i] != value
        ]
        found.append(", ".join(said))
    return found


def numeric(table: Table) -> list[str]:
    """Settings that are numbers: those that vary, or all."""
    settings = settings_of(table)
    numbers = [n for n in settings if not isinstance(settings[n][0][0], str | bool)]
    return [n for n in varied(settings) if n in numbers] or numbers


def most_varied(table: Table) -> str:
    """The number among the settings that has most values; the number of the row without any."""
    settings = settings_of(table)
    return max(numeric(table), key=lambda name: len(set(settings[name][0])), default=ROW)


def along(table: Table, over: str) -> tuple[Array, str]:
    """Places of the conditions along a setting, shape (m,), and its SI unit."""
    if over == ROW:
        return np.arange(1.0, len(table.mean) + 1.0), "-"
    values, unit = settings_of(table)[over]
    return np.asarray(values, dtype=float), unit
