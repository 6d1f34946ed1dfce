"""Readings of a table as a report tells them: their title, units and settings in words."""

from __future__ import annotations

import statistics
from typing import Any

import numpy as np

from stickslip._util.amounts import digits_for
from stickslip._util.numbers import Array
from stickslip._util.units import handy
from stickslip.diagnosis.data.table import Settings, Table

ROW = "row"
"""What stands for a setting where none is a number."""


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
    settings = table.named_settings
    numbers = [n for n in settings if not isinstance(settings[n][0][0], str | bool)]
    return [n for n in varied(settings) if n in numbers] or numbers


def most_varied(table: Table) -> str:
    """The number among the settings that has most values; the number of the row without any."""
    settings = table.named_settings
    return max(numeric(table), key=lambda name: len(set(settings[name][0])), default=ROW)


def along(table: Table, over: str) -> tuple[Array, str]:
    """Places of the conditions along a setting, shape (m,), and its SI unit."""
    if over == ROW:
        return np.arange(1.0, len(table.mean) + 1.0), "-"
    values, unit = table.named_settings[over]
    return np.asarray(values, dtype=float), unit
