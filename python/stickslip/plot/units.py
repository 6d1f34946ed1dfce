"""Units that a reader of micro-robots would rather see than SI's, and the words of an axis."""

from __future__ import annotations

import math
from dataclasses import dataclass

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


@dataclass(frozen=True)
class Quantity:
    """How a quantity is shown.

    Attributes
    ----------
    factor : float
        From SI to what is shown.
    label : str
        Words and unit for an axis.
    """

    factor: float
    label: str


def quantity(words: str, unit: str) -> Quantity:
    """How a quantity of an SI unit is shown; "1", "-" and no unit are those of a pure number."""
    if unit in ("", "1", "-"):
        return Quantity(1.0, words)
    factor, shown = _HANDY.get(unit, (1.0, unit))
    return Quantity(factor, f"{words} ({shown})")
