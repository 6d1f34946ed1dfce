"""Units of files and of display."""

from __future__ import annotations

import functools
import math
import re
import unicodedata
from collections.abc import Mapping

from stickslip._util.messages import meant

SI = "si"
Units = Mapping[str, str] | str | None
"""Units that a caller states: by column, or `SI` for all."""

_PREFIXES = {"k": 1e-3, "m": 1e3, "u": 1e6, "µ": 1e6, "μ": 1e6, "n": 1e9, "c": 1e2, "M": 1e-6}
"""How many of the prefixed unit are one; both signs of micro."""
_LONG = {"nano": 1e9, "micro": 1e6, "milli": 1e3, "centi": 1e2, "kilo": 1e-3, "mega": 1e-6}
_PREFIXED = (*"msAKNVWTHJgGΩ", "ohm", "Hz", "rad", "sec", "Nm")

CLOCKS = ("hh:mm:ss", "hh:mm", "mm:ss")
"""Units in the heading of a column of clocks, which are read as seconds."""

_Size = tuple[float, tuple[int, ...]]
_BASES = ("m", "g", "s", "A", "K", "rad")
"""Units of which all others are made. An angle is a quantity of its own: Hz, which does not say
what it counts, is neither rad/s nor rpm."""

_MADE = {
    "%": (1e2, "1"), "inch": (1.0 / 0.0254, "m"), "foot": (1.0 / 0.3048, "m"),
    "sec": (1.0, "s"), "min": (1.0 / 60.0, "s"), "h": (1.0 / 3600.0, "s"),
    "d": (1.0 / 86400.0, "s"), **dict.fromkeys(CLOCKS, (1.0, "s")),
    "degC": (1.0, "K"), "degF": (1.8, "K"), "deg": (math.degrees(1.0), "rad"),
    "rev": (0.5 / math.pi, "rad"), "rpm": (30.0 / math.pi, "rad/s"), "rps": (1.0, "rev/s"),
    "Hz": (1.0, "1/s"), "N": (1.0, "kg m/s^2"), "kgf": (1.0 / 9.80665, "N"), "J": (1.0, "N m"),
    "Nm": (1.0, "N m"), "N-m": (1.0, "N m"), "Ncm": (1.0, "N cm"), "Nmm": (1.0, "N mm"),
    "kgcm": (1.0, "kgf cm"), "W": (1.0, "J/s"), "V": (1.0, "W/A"), "ohm": (1.0, "V/A"),
    "Ω": (1.0, "V/A"), "H": (1.0, "V s/A"), "T": (1.0, "V s/m^2"), "G": (1e4, "T"),
}  # fmt: skip
"""How many of a unit are one of others; of temperatures, differences."""

_WORDS = {
    "meter": "m", "metre": "m", "gram": "g", "gramme": "g", "second": "s", "sec": "s",
    "minute": "min", "hour": "h", "hr": "h", "day": "d", "ampere": "A", "amp": "A", "kelvin": "K",
    "celsius": "degC", "c": "degC", "fahrenheit": "degF", "radian": "rad", "degree": "deg",
    "°": "deg", "turn": "rev", "revolution": "rev", "cycle": "rev", "newton": "N", "joule": "J",
    "watt": "W", "volt": "V", "henry": "H", "tesla": "T", "gauss": "G", "hertz": "Hz",
    "revolutions_per_minute": "rpm", "percent": "%", "pct": "%", "dimensionless": "1",
    **{name.casefold(): name for name in ("Hz", "rpm", "min", "deg", "rad", "rev", "ohm", "degC",
                                          "degF")},
}  # fmt: skip
"""Names of units in whatever case, also with an s at their end."""

_FACTOR = re.compile(r"(?:([^\d\s^*/.·]+?)|1)(?:\^?([+-]?\d+))?")

_TURNS = ("1/min", "min-1", "U/min", "r/min")
"""Of an angular velocity they count turns."""
_LISTED = (
    *("min", "h", *CLOCKS, "cm", "cm/s", "km/h", "deg", "°", "deg/s", "°/s", "rpm", *_TURNS),
    *("rev/s", "Nm", "mNm", "N cm", "N mm", "degC", "°C", "G", "G/A", "g", "mg", "ug", "µg"),
)
"""Units that messages name, beside those with a prefix."""

_SHOWN = {
    "T": "mT", "T/m": "mT/m", "N": "µN", "m": "µm", "m/s": "mm/s", "rad": "degrees", "kg": "µg",
    "H": "mH", "N m s^2": "N m s²", "m/s^2": "m/s²", "kg m^2": "kg m²", "ohm": "Ω",
}  # fmt: skip
"""SI unit: the one to show."""

_HEADING = re.compile(r"(.*\S)\s*[(\[]\s*([^()\[\]]*?)\s*[)\]]")

_SI = dict.fromkeys(("s", "m", "m/s", "rad", "rad/s", "N m", "K", "T", "T/A", "kg", *_SHOWN,
                     "A", "Hz", "V", "W"))  # fmt: skip
"""SI units."""


def handy(unit: str) -> tuple[float, str]:
    """Factor from an SI unit to a handier one, and its name; "" for a pure number."""
    if unit in _SHOWN:
        return per_si(_SHOWN[unit], unit), _SHOWN[unit]
    return 1.0, unit_label(unit)


def unit_label(unit: str) -> str:
    """An SI unit as it is shown; "" for a pure number."""
    return "" if unit in ("-", "1") else unit


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
    word = len(name) > 3 and (name.casefold() in ("time", "timestamp") or not is_of(unit, "s"))
    parted = (symbol or word or " / " in heading) and is_unit(unit) and not is_unit(heading)
    return (name, unit) if parted else (heading, None)


def ended(heading: str) -> list[tuple[str, str]]:
    """A heading as name and unit, where blanks or an underscore may be between: ``speed_rpm``."""
    pairs = [heading.rpartition(sign)[::2] for sign in ("_", " in ", " ")]
    return [(name.rstrip(", "), unit.strip()) for name, unit in pairs
            if name and "(" not in unit and is_unit(unit)]  # fmt: skip


def per_si(unit: str, si: str) -> float:
    """How many of a unit are one of an SI unit; a ValueError lists those of the same quantity."""
    if si in ("-", "1"):
        if unit in ("-", "1", ""):
            return 1.0
        si = "1"
    known = units_of(si)
    if unit in known:
        return known[unit]
    given, of = _size(unit), _size(si)
    if given is not None and of is not None and given[1] == of[1]:
        return given[0] / of[0]
    if si == "1":
        raise ValueError("allowed is no unit, or %")
    hint = meant(unit, known)
    if given and of and given[1][:-1] == of[1][:-1] == (0, 0, -1, 0, 0):  # but for an angle
        hint = "; Hz does not say whether it counts turns: a turn is 2 pi rad"
    if unit.partition("/")[0].rstrip("s") in ("tick", "count") and si == "rad":
        hint = "; of an encoder with 4096 ticks a turn, rev/4096"
    listed = ", ".join(unit for unit in known if "μ" not in unit)  # the twin of µ looks alike
    raise ValueError(f"allowed are {listed}{hint}")


@functools.lru_cache(256)
def _size(unit: str) -> _Size | None:
    """How many of a product of units are one in SI, and its exponents of `_BASES`; None of none."""
    over, *under = _plain(unit).split("/")
    per, exponents = 1.0, len(_BASES) * [0]
    for sign, part in ((1, over), *((-1, each) for each in under)):
        if sign < 0 and len(part) > 1 and part.isdecimal():  # rev/4096, a tick of an encoder
            per *= int(part)
            continue
        for factor in re.split(r"[\s*·.]+", part.strip(" ()")):
            match = _FACTOR.fullmatch(factor)
            n, name = _symbol(match[1] or "1") if match else (0.0, None)
            if match is None or name is None:
                return None
            made, of = _MADE.get(name, (1e3 if name == "g" else 1.0, None))
            own = tuple(int(name == base) for base in _BASES)
            size, powers = (of and _size(of)) or (1.0, own)
            power = sign * int(match[2] or 1)
            per *= (n * made * size) ** power
            exponents = [k + power * m for k, m in zip(exponents, powers, strict=True)]
    return per, tuple(exponents)


def _plain(unit: str) -> str:
    """A unit with one sign for each thing, and one word for each factor."""
    text = unicodedata.normalize("NFKC", unit.strip().replace("º", "°")).replace("**", "^")
    text = re.sub(r"\s*([*^/])\s*", r"\1", text)
    return re.sub(r"(?:\bdeg(?:rees?)?|°)[ _]*([cf])(?:elsius|ahrenheit)?\b",
                  lambda match: f"deg{match[1].upper()}", text, flags=re.IGNORECASE)  # fmt: skip


def _symbol(text: str) -> tuple[float, str | None]:
    """A prefix's number and the symbol of a unit, also by its name in whatever case."""
    if text in (*_BASES, *_MADE, "1"):
        return 1.0, text
    for prefix, n in _PREFIXES.items():
        rest = text.removeprefix(prefix)
        # Nobody means Mm or Ms: there it is a slip of the shift key.
        if text != rest and rest in _PREFIXED and (prefix != "M" or rest not in ("m", "s", "g")):
            return n, rest
    word = text.casefold()
    prefix = next((each for each in _LONG if word.startswith(each)), "")
    rest = word.removeprefix(prefix)
    plural = rest[:-1] if rest.endswith("s") and len(rest) > 3 else rest
    # A temperature is C in capitals only.
    known = None if text == "c" else _WORDS.get(rest, _WORDS.get(plural))
    return _LONG.get(prefix, 1.0), known


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
    return text in _TURNS or (not number and _size(text) is not None)


def si_of(unit: str) -> str:
    """The SI unit of the same quantity; the unit itself if it is SI or unknown."""
    return unit if unit in _SI else quantity_of(unit) or unit


def same_unit(unit: str, si: str) -> bool:
    """Whether a unit is an SI unit under any of its names."""
    return is_of(unit, si) and math.isclose(per_si(unit, si), 1.0)


def zero_of(unit: str | None) -> float:
    """Temperature of a unit's zero, K."""
    _, name = _symbol(_plain(unit or ""))
    return {"degC": 273.15, "degF": 459.67 / 1.8}.get(str(name), 0.0)


@functools.lru_cache(64)
def units_of(si: str) -> dict[str, float]:
    """Units of the quantity of an SI unit that messages name, with how many are one of it."""
    prefixed = {} if si == "kg" else {f"{sign}{si}": _PREFIXES[sign] for sign in "kmuµμn"}
    size, sizes = _size(si), {name: _size(name) for name in _LISTED}
    if si == "rad/s":
        sizes |= dict.fromkeys(_TURNS, _size("rpm"))
    return {si: 1.0, **prefixed, **{name: each[0] / size[0] for name, each in sizes.items()
                                    if size and each and each[1] == size[1]}}  # fmt: skip
