"""Numbers as a reader sees them: rounded to their errors, in handy units."""

from __future__ import annotations

import math
from collections.abc import Iterable

from stickslip._util.units import handy, unit_label

_PLAIN = 1e-3, 1e5  # sizes between which a number needs no power of ten
_DIGITS = 4  # of a setting
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def in_unit(value: float, unit: str, digits: int = 2, kept: bool = False) -> str:
    """A number in the handy unit of an SI unit: ``0.095 mm/s``; the unit itself if `kept`."""
    factor, shown = (1.0, unit_label(unit)) if kept else handy(unit)
    return f"{number(value * factor, digits)} {shown}".rstrip()


def times(ratio: float) -> str:
    """How many times as probable: ``2400 times``."""
    return "more than a million times" if ratio > 1e6 else f"{number(ratio, 2)} times"


def odds(ratio: float, short: bool = False) -> str:
    """Odds of one model against another: ``2400 to 1``."""
    if ratio > 1e6:
        return f"> {power(6)} to 1" if short else "more than a million to 1"
    return f"{number(ratio, 2)} to 1" if ratio >= 1.0 else f"1 to {number(1.0 / ratio, 2)}"


def joined_ends(low: float, high: float, unit: str = "") -> str:
    """``0.13 to 0.16``."""
    return joined([low, high], (high - low) / 4.0, " to ", unit)


def amount(value: float, sd: float, unit: str = "") -> str:
    """``14.9 ± 0.8 %``: a value with its error, both to the error's second digit."""
    return joined([value, sd], sd, " ± ", unit)


def joined(values: list[float], step: float, by: str, unit: str) -> str:
    """Numbers to the second digit of a step, with one power of ten."""
    if not (all(map(math.isfinite, values)) and math.isfinite(step) and step > 0.0):
        return f"{number(values[0])} {unit}".rstrip()
    size = max(map(abs, (*values, step)))
    # Seconds since 1970 have more digits than a power of ten would save.
    plain = _PLAIN[0] <= size and (size < _PLAIN[1] or step < size / _PLAIN[1])
    ten = 0 if plain else math.floor(math.log10(size))
    values, step = [value / 10.0**ten for value in values], step / 10.0**ten
    places = 1 - math.floor(math.log10(step))
    if round(step, places) >= 9.5 * 10.0 ** (1 - places):
        places -= 1  # two digits just below a power of ten are one
    text = by.join(f"{round(value, places) + 0.0:.{max(places, 0)}f}" for value in values)
    return f"{text} {unit}".rstrip() if ten == 0 else f"({text})·{power(ten)} {unit}".rstrip()


def digits_for(values: Iterable[float]) -> int:
    """Digits that tell these numbers apart: four of their spread, and at least four."""
    known = [value for value in values if math.isfinite(value)]
    spread = max(known, default=0.0) - min(known, default=0.0)
    if not 0.0 < spread < math.inf:
        return _DIGITS
    size = max(map(abs, known))
    return _DIGITS + max(math.floor(math.log10(size)) - math.floor(math.log10(spread)), 0)


def number(value: float, digits: int = 3) -> str:
    """A number to some digits, with a power of ten where it is very large or small."""
    if not math.isfinite(value):
        return "not known" if math.isnan(value) else "∞"
    if value == 0.0 or _PLAIN[0] <= abs(value) < max(_PLAIN[1], 10.0**digits):
        return f"{float(f'{value:.{digits}g}'):.{max(digits, 12)}g}"
    first, _, ten = f"{value:.{digits - 1}e}".partition("e")
    return f"{first}·{power(int(ten))}"


def power(ten: int) -> str:
    """``10⁻⁵``."""
    return f"10{str(ten).translate(_SUPERSCRIPT)}"


def percent(share: float, short: bool = False) -> str:
    """A probability or a share: ``86 %``, ``more than 99.9 %``, ``less than 0.1 %``."""
    if share > 0.999:
        return "> 99.9 %" if short else "more than 99.9 %"
    if share < 0.001:
        return "< 0.1 %" if short else "less than 0.1 %"
    value = 100.0 * share
    return f"{value:.1f} %" if value < 1.0 or value > 99.0 else f"{value:.0f} %"


def p_text(p_value: float) -> str:
    """``p = 0.03``, or that it is below what can be told."""
    if p_value <= 1e-12:
        return f"p < {power(-12)}"
    return f"p = {number(p_value, 2).replace('.0·', '·')}"
