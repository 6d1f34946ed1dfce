"""Units of files and of display."""

from __future__ import annotations

import functools
import math
import re
import unicodedata
from collections.abc import Mapping
from typing import TYPE_CHECKING, TypeVar

from stickslip._util.messages import nearest

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Numbers = TypeVar("Numbers", float, "NDArray[np.float64]")

SI = "si"
Units = Mapping[str, str] | str | None
"""Units that a caller states: by column, or `SI` for all."""

_PREFIXES = {"k": 1e-3, "m": 1e3, "u": 1e6, "µ": 1e6, "μ": 1e6, "n": 1e9}
"""How many of the prefixed unit are one; both signs of micro."""

_CELSIUS, _TIMES = ("C", "degC", "°C"), ("time", "timestamp")
CLOCKS = ("hh:mm:ss", "hh:mm", "mm:ss")
"""Units in the heading of a column of clocks, which are read as seconds."""

_OTHERS = {
    "s": {"sec": 1.0, "min": 1.0 / 60.0, "h": 1.0 / 3600.0, **dict.fromkeys(CLOCKS, 1.0)},
    "m": {"cm": 1e2},
    "m/s": {"cm/s": 1e2, "m/min": 60.0, "km/h": 3.6},
    "rad": dict.fromkeys(("deg", "degree", "degrees", "°"), math.degrees(1.0)),
    "rad/s": {
        "rad/sec": 1.0,
        **dict.fromkeys(("deg/s", "°/s", "deg/sec"), math.degrees(1.0)),
        **dict.fromkeys(
            ("rpm", "RPM", "1/min", "min-1", "U/min", "rev/min", "r/min"), 30.0 / math.pi
        ),
        **dict.fromkeys(("rps", "rev/s"), 0.5 / math.pi),
    },
    "N m": {
        **dict.fromkeys(("Nm", "N·m", "N.m", "N*m", "N-m"), 1.0),
        **dict.fromkeys(("mNm", "mN·m"), 1e3),
        "kNm": 1e-3,
        **dict.fromkeys(("N cm", "Ncm"), 1e2),
        **dict.fromkeys(("N mm", "Nmm"), 1e3),
        **dict.fromkeys(("kgf cm", "kgcm"), 1e2 / 9.80665),
    },
    "K": dict.fromkeys(_CELSIUS, 1.0),
    "T": dict.fromkeys(("G", "gauss"), 1e4),
    "T/A": {"G/A": 1e4},
    "kg": {"g": 1e3, "mg": 1e6, "ug": 1e9, "µg": 1e9},
    "N m s^2": {"N m s²": 1.0},
    "m/s^2": {"m/s²": 1.0},
    "kg m^2": {"kg m²": 1.0},
    "ohm": {"Ω": 1.0},
}
"""How many of a unit that is no prefixed one are the SI unit; of temperatures, differences."""

_Size = tuple[float, tuple[int, ...]]
_BASES: dict[str, _Size] = {
    "1": (1.0, (0, 0, 0, 0, 0, 0)), "%": (0.01, (0, 0, 0, 0, 0, 0)),
    "m": (1.0, (1, 0, 0, 0, 0, 0)), "inch": (0.0254, (1, 0, 0, 0, 0, 0)),
    "foot": (0.3048, (1, 0, 0, 0, 0, 0)), "g": (1e-3, (0, 1, 0, 0, 0, 0)),
    "s": (1.0, (0, 0, 1, 0, 0, 0)), "min": (60.0, (0, 0, 1, 0, 0, 0)),
    "h": (3600.0, (0, 0, 1, 0, 0, 0)), "d": (86400.0, (0, 0, 1, 0, 0, 0)),
    "A": (1.0, (0, 0, 0, 1, 0, 0)), "K": (1.0, (0, 0, 0, 0, 1, 0)),
    "degC": (1.0, (0, 0, 0, 0, 1, 0)), "degF": (1.0 / 1.8, (0, 0, 0, 0, 1, 0)),
    "rad": (1.0, (0, 0, 0, 0, 0, 1)), "deg": (math.pi / 180.0, (0, 0, 0, 0, 0, 1)),
    "rev": (2.0 * math.pi, (0, 0, 0, 0, 0, 1)), "rpm": (math.pi / 30.0, (0, 0, -1, 0, 0, 1)),
    "rps": (2.0 * math.pi, (0, 0, -1, 0, 0, 1)), "Hz": (1.0, (0, 0, -1, 0, 0, 0)),
    "N": (1.0, (1, 1, -2, 0, 0, 0)), "kgf": (9.80665, (1, 1, -2, 0, 0, 0)),
    "J": (1.0, (2, 1, -2, 0, 0, 0)), "W": (1.0, (2, 1, -3, 0, 0, 0)),
    "V": (1.0, (2, 1, -3, -1, 0, 0)), "ohm": (1.0, (2, 1, -3, -2, 0, 0)),
    "sec": (1.0, (0, 0, 1, 0, 0, 0)), "Ω": (1.0, (2, 1, -3, -2, 0, 0)),
    "H": (1.0, (2, 1, -2, -2, 0, 0)),
    "T": (1.0, (0, 1, -2, -1, 0, 0)), "G": (1e-4, (0, 1, -2, -1, 0, 0)),
}  # fmt: skip
"""SI size and the exponents of m, kg, s, A, K and rad. An angle is a quantity of its own: Hz, which
does not say what it counts, is neither rad/s nor rpm."""

_TURNS = _BASES["rpm"][1]

_WORDS = {
    "meter": "m", "metre": "m", "gram": "g", "gramme": "g", "second": "s", "sec": "s",
    "minute": "min", "hour": "h", "hr": "h", "day": "d", "ampere": "A", "amp": "A", "kelvin": "K",
    "celsius": "degC", "deg_celsius": "degC", "deg_c": "degC", "degc": "degC", "°c": "degC",
    "c": "degC", "°celsius": "degC", "fahrenheit": "degF", "deg_fahrenheit": "degF",
    "deg_f": "degF", "degf": "degF", "°f": "degF", "radian": "rad", "degree": "deg", "°": "deg",
    "turn": "rev", "revolution": "rev", "cycle": "rev", "newton": "N",
    "joule": "J", "watt": "W", "volt": "V", "henry": "H", "tesla": "T", "gauss": "G",
    "hertz": "Hz", "hz": "Hz", "rpm": "rpm", "revolutions_per_minute": "rpm", "min": "min",
    "deg": "deg", "rad": "rad", "rev": "rev", "percent": "%", "pct": "%", "dimensionless": "1",
    "ohm": "ohm",
}  # fmt: skip
"""Names of units in whatever case, also with an s at their end."""

_LONG = {"nano": 1e-9, "micro": 1e-6, "milli": 1e-3, "centi": 1e-2, "kilo": 1e3, "mega": 1e6}
_SHORT = {**{name: 1.0 / n for name, n in _PREFIXES.items()}, "c": 1e-2, "M": 1e6}
_PREFIXED = (*"msAKNVWTHJgGΩ", "ohm", "Hz", "rad", "sec")
_FACTOR = re.compile(r"(?:([^\d\s^*/.·]+?)|1)(?:\^?([+-]?\d+))?")
_DIFFERENCE = re.compile(r"(?:delta_|delta |Δ|∆)")

_SHOWN = {
    "T": "mT", "T/m": "mT/m", "N": "µN", "m": "µm", "m/s": "mm/s", "rad": "degrees", "kg": "µg",
    "H": "mH", "N m s^2": "N m s²", "m/s^2": "m/s²", "kg m^2": "kg m²", "ohm": "Ω",
}  # fmt: skip
"""SI unit: the one to show."""

_HEADING = re.compile(r"(.*\S)\s*[(\[]\s*([^()\[\]]*?)\s*[)\]]")

_SI = dict.fromkeys((*_OTHERS, *_SHOWN, "A", "Hz", "V", "W"))
"""SI units."""


def handy(unit: str) -> tuple[float, str]:
    """Factor from an SI unit to a handier one, and its name; "" for a pure number."""
    if unit in _SHOWN:
        return _known(unit)[_SHOWN[unit]], _SHOWN[unit]
    return 1.0, unit_label(unit)


def unit_label(unit: str) -> str:
    """An SI unit as it is shown; "" for a pure number."""
    return "" if _is_pure(unit) else unit


def with_unit(value: float, unit: str) -> str:
    """A number to two digits with its unit, if it has one."""
    return f"{value:.2g} {unit_label(unit)}".rstrip()


def in_handy_units(words: str, unit: str) -> tuple[float, str]:
    """Factor from an SI unit to the unit of display, and the label of an axis with that unit."""
    factor, shown = handy(unit)
    return factor, f"{words} ({shown})" if shown else words


def split_unit(heading: str) -> tuple[str, str | None]:
    """``x (mm)``, ``x [mm]``, ``x / mm`` or ``x/mm`` of a heading as its name and unit.

    The unit is None if there is none. Without blanks ``rev/min`` and ``counts/s`` are units.
    """
    match = _HEADING.fullmatch(heading)
    if match:
        return match[1], match[2]
    name, _, unit = (part.strip() for part in heading.partition("/"))
    symbol = len(name) == 1 or (len(name) == 2 and not is_unit(name))
    # A word over a time is a unit, as counts/s.
    word = len(name) > 3 and (name.casefold() in _TIMES or not is_of(unit, "s"))
    parted = (symbol or word or " / " in heading) and is_unit(unit) and not is_unit(heading)
    return (name, unit) if parted else (heading, None)


def ended(heading: str) -> list[tuple[str, str]]:
    """A heading as name and unit, where blanks or an underscore may be between: ``speed_rpm``."""
    pairs = [heading.rpartition(sign)[::2] for sign in ("_", " in ", " ")]
    return [(name.rstrip(", "), unit.strip()) for name, unit in pairs
            if name and "(" not in unit and is_unit(unit)]  # fmt: skip


def per_si(unit: str, si: str) -> float:
    """How many of a unit are one of an SI unit; a ValueError lists those of the same quantity."""
    known = dict.fromkeys(("-", "1", ""), 1.0) | {"%": 100.0} if _is_pure(si) else _known(si)
    if unit in known:
        return known[unit]
    meant, of = _size(unit), _size("1" if _is_pure(si) else si)
    if meant is not None and of is not None and meant[1] == of[1]:
        return of[0] / meant[0]
    near = nearest(unit, known)
    hint = f'; did you mean "{near}"?' if near else ""
    if _is_pure(si):
        raise ValueError("allowed is no unit, or %")
    if meant is not None and of is not None and {meant[1], of[1]} == {_BASES["Hz"][1], _TURNS}:
        hint = "; Hz does not say whether it counts turns: a turn is 2 pi rad"
    if unit.rstrip("s") in ("tick", "count") and si == "rad":
        hint = "; of an encoder with 4096 ticks a turn, rev/4096"
    listed = ", ".join(unit for unit in known if "μ" not in unit)  # the twin of µ looks alike
    raise ValueError(f"allowed are {listed}{hint}")


def ratio(unit: str, other: str) -> float:
    """How many of a unit are one of another; a ValueError if they are of different quantities."""
    si = quantity_of(other)
    if si is None:
        raise ValueError(f"{other} is not known")
    return per_si(unit, si) / per_si(other, si)


@functools.lru_cache(256)
def _size(unit: str) -> _Size | None:
    """SI size and dimensions of a product of units as people and programs write it; else None."""
    over, *under = _plain(unit).split("/")
    size, dimensions = 1.0, 6 * [0]
    for sign, part in ((1, over), *((-1, each) for each in under)):
        if sign < 0 and len(part) > 1 and part.isdecimal():  # rev/4096, a tick of an encoder
            size /= int(part)
            continue
        for factor in re.split(r"[\s*·.]+", part.strip(" ()")):
            match = _FACTOR.fullmatch(factor)
            base = match and (_base(match[1]) if match[1] else _BASES["1"])
            if not match or not base:
                return None
            power = sign * int(match[2] or 1)
            size *= base[0] ** power
            dimensions = [n + power * m for n, m in zip(dimensions, base[1], strict=True)]
    return size, tuple(dimensions)


def _plain(unit: str) -> str:
    """A unit with one sign for each thing, and one word for each factor."""
    text = unicodedata.normalize("NFKC", unit.strip().replace("º", "°")).replace("**", "^")
    text = re.sub(r"\s*([*^/])\s*", r"\1", text)
    return re.sub(r"(?:\bdeg(?:rees?)?|°)[ _]+(?=(?:c|f|celsius|fahrenheit)\b)", "deg_",
                  text, flags=re.IGNORECASE)  # fmt: skip


def _base(text: str) -> _Size | None:
    """A unit with its prefix, by its symbol or in whatever case by its name."""
    if text in _BASES:
        return _BASES[text]
    for prefix, factor in _SHORT.items():
        rest = text.removeprefix(prefix)
        # Nobody means Mm or Ms: there it is a slip of the shift key.
        if text != rest and rest in _PREFIXED and (prefix != "M" or rest not in ("m", "s", "g")):
            return factor * _BASES[rest][0], _BASES[rest][1]
    name, factor = _word(text)
    return None if name is None else (factor * _BASES[name][0], _BASES[name][1])


def _word(text: str) -> tuple[str | None, float]:
    """The unit that a word names, and its prefix's factor."""
    word = text.casefold()
    prefix = next((each for each in _LONG if word.startswith(each)), "")
    rest = word.removeprefix(prefix)
    plural = rest[:-1] if rest.endswith("s") and len(rest) > 3 else rest
    if text == "c":  # only in capitals
        return None, 1.0
    return _WORDS.get(rest, _WORDS.get(plural)), _LONG.get(prefix, 1.0)


def without_delta(unit: str) -> str | None:
    """The unit of a unit of differences, such as ``delta_degC``; None of any other."""
    match = _DIFFERENCE.match(unit)
    return unit[match.end() :] if match else None


def quantity_of(unit: str) -> str | None:
    """The SI unit, of those that are known, of the same quantity as a unit; None of no unit."""
    return next((si for si in (*_SI, "-") if is_of(unit, si)), None)


def is_of(unit: str, si: str) -> bool:
    """Whether a unit is one of the quantity of an SI unit."""
    try:
        per_si(unit, si)
    except ValueError:
        return False
    return True


def is_unit(text: str) -> bool:
    """Whether a text is a unit of a file."""
    number = text[:1] in "+-.0123456789" and not text.startswith("1/")
    return any(text in _known(si) for si in _SI) or (not number and _size(text) is not None)


def si_of(unit: str) -> str:
    """The SI unit of the same quantity; the unit itself if it is SI or unknown."""
    return unit if unit in _SI else quantity_of(unit) or unit


def same_unit(unit: str, si: str) -> bool:
    """Whether a unit is an SI unit under any of its names."""
    return is_of(unit, si) and math.isclose(per_si(unit, si), 1.0)


def zero_of(unit: str | None) -> float:
    """Temperature of a unit's zero, K."""
    name, _ = _word(_plain(unit or ""))
    return {"degC": 273.15, "degF": 459.67 / 1.8}.get(str(name), 0.0)


def to_si(values: Numbers, per: float) -> Numbers:
    """Numbers in SI units; by an exact power of ten where there is one, so rounded once."""
    return values if per == 1.0 else values / per if per >= 1.0 else values * (1.0 / per)


def _is_pure(unit: str) -> bool:
    return unit in ("1", "-")


@functools.lru_cache(64)
def _known(si: str) -> dict[str, float]:
    """All units of the quantity of an SI unit, with how many of each are one of it."""
    prefixed = {} if si == "kg" else {f"{prefix}{si}": n for prefix, n in _PREFIXES.items()}
    return {si: 1.0, **prefixed, **_OTHERS.get(si, {})}
