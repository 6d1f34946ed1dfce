"""Units of display that suit small quantities better than SI units, and labels of axes."""

from __future__ import annotations

import math

# SI unit: factor and unit to show.
_HANDY = {
    "T": (1e3, "mT"),
    "T/m": (1e3, "mT/m"),
    "N": (1e6, "µN"),
    "m": (1e6, "µm"),
    "m/s": (1e3, "mm/s"),
    "rad": (math.degrees(1.0), "degrees"),
    "kg": (1e9, "µg"),
    "H": (1e3, "mH"),
    "N m s^2": (1.0, "N m s²"),
    "m/s^2": (1.0, "m/s²"),
    "kg m^2": (1.0, "kg m²"),
    "ohm": (1.0, "Ω"),
}


def handy(unit: str) -> tuple[float, str]:
    """Factor from an SI unit to a handier one, and its name; "" for a pure number."""
    return _HANDY.get(unit, (1.0, "" if unit in ("1", "-") else unit))


def in_handy_units(words: str, unit: str) -> tuple[float, str]:
    """Factor from an SI unit to the unit of display, and the label of an axis with that unit."""
    factor, shown = handy(unit)
    return factor, f"{words} ({shown})" if shown else words
