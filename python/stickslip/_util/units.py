"""Units: those that files may have, and those of display that suit small quantities."""

from __future__ import annotations

import math
import re

_PREFIXES = {"k": 1e-3, "m": 1e3, "u": 1e6, "µ": 1e6, "μ": 1e6, "n": 1e9}
"""How many of the prefixed unit are one; both signs of micro."""

_OTHERS = {
    "m": {"cm": 1e2},
    "m/s": {"cm/s": 1e2},
    "rad": dict.fromkeys(("deg", "degree", "degrees", "°"), math.degrees(1.0)),
    "T": dict.fromkeys(("G", "gauss"), 1e4),
    "T/A": {"G/A": 1e4},
    "kg": {"g": 1e3, "mg": 1e6, "ug": 1e9, "µg": 1e9},
    "N m s^2": {"N m s²": 1.0},
    "m/s^2": {"m/s²": 1.0},
    "kg m^2": {"kg m²": 1.0},
    "ohm": {"Ω": 1.0},
}
"""How many of a unit that is no prefixed one are the SI unit."""

_SHOWN = {
    "T": "mT",
    "T/m": "mT/m",
    "N": "µN",
    "m": "µm",
    "m/s": "mm/s",
    "rad": "degrees",
    "kg": "µg",
    "H": "mH",
    "N m s^2": "N m s²",
    "m/s^2": "m/s²",
    "kg m^2": "kg m²",
    "ohm": "Ω",
}
"""SI unit: the one to show."""

_HEADING = re.compile(r"(.*\S)\s*[(\[]\s*([^()\[\]]*?)\s*[)\]]")


def handy(unit: str) -> tuple[float, str]:
    """Factor from an SI unit to a handier one, and its name; "" for a pure number."""
    if unit in _SHOWN:
        return _known(unit)[_SHOWN[unit]], _SHOWN[unit]
    return 1.0, unit_label(unit)


def unit_label(unit: str) -> str:
    """An SI unit as it is shown; "" for a pure number."""
    return "" if _is_pure(unit) else unit


def in_handy_units(words: str, unit: str) -> tuple[float, str]:
    """Factor from an SI unit to the unit of display, and the label of an axis with that unit."""
    factor, shown = handy(unit)
    return factor, f"{words} ({shown})" if shown else words


def split_unit(heading: str) -> tuple[str, str | None]:
    """``x (mm)`` or ``x [mm]`` of a heading as its name and unit; None where it states none."""
    found = _HEADING.fullmatch(heading)
    return (found[1], found[2]) if found else (heading, None)


def per_si(unit: str, si: str) -> float:
    """How many of a unit are one of an SI unit; a ValueError lists those of the same quantity."""
    known = dict.fromkeys(("-", "1", ""), 1.0) if _is_pure(si) else _known(si)
    if unit not in known:
        raise ValueError("allowed is no unit" if _is_pure(si) else f"allowed are {_listed(known)}")
    return known[unit]


def to_si(value: float, per: float) -> float:
    """A number in SI units; by an exact power of ten where there is one, so rounded once."""
    return value / per if per >= 1.0 else value * (1.0 / per)


def _is_pure(unit: str) -> bool:
    return unit in ("1", "-")


def _known(si: str) -> dict[str, float]:
    """All units of the quantity of an SI unit, with how many of each are one of it."""
    prefixed = {} if si == "kg" else {f"{prefix}{si}": n for prefix, n in _PREFIXES.items()}
    return {si: 1.0, **prefixed, **_OTHERS.get(si, {})}


def _listed(known: dict[str, float]) -> str:
    return ", ".join(unit for unit in known if "μ" not in unit)  # the twin of µ looks alike
