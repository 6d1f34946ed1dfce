"""Which unit a number was given in, from how far it is from what is expected in SI units."""

from __future__ import annotations

import math
from collections.abc import Iterable

from stickslip._util.units import per_si

FACTORS = (10.0, 100.0, 1e3, 1e6)
"""Mistakes of a unit, and their inverses."""

NEAR = math.sqrt(10.0)
"""Ratio to one of `FACTORS` within which a number is near it. Chosen: what is expected is seldom
known to better than a factor of three, and beyond it another power of ten is nearer."""

_MOST = 50.0
"""Ratio beyond which a size is far from the usual one. Chosen: below 57 (degrees for rad) and 1000
(mm for m), the commonest mistakes of units."""

_SMALLER = {
    "m": ("cm", "mm", "um"),
    "m/s": ("mm/s", "um/s"),
    "kg": ("g", "mg", "ug"),
    "s": ("ms", "us"),
    "T": ("mT", "uT"),
    "H": ("mH", "uH"),
}
"""Units that a laboratory uses in place of an SI unit."""


def unit_factor(
    ratio: float, within: float = NEAR, among: Iterable[float] = FACTORS
) -> float | None:
    """The factor that a ratio of sizes is nearest to, or its inverse.

    None for a ratio that is farther from all of them than the factor `within`.
    """
    if not 0.0 < ratio < math.inf:
        return None
    size = abs(math.log(ratio))
    factor = min(among, key=lambda each: abs(size - math.log(each)))
    # What makes 1000 of 999.9999 must not decide.
    if abs(size - math.log(factor)) > math.log(within) * (1.0 + 1e-12):
        return None
    return factor if ratio > 1.0 else 1.0 / factor


def unit_meant(
    unit: str, ratio: float, within: float = NEAR, least: float = 1.0
) -> tuple[str, float] | None:
    """The unit that a number may be in whose size is `ratio` times that expected in an SI unit.

    With the factor of numbers in it, which is `least` or more; None where no such unit is near.
    """
    names = {per_si(name, unit): name for name in _SMALLER.get(unit, ())}
    units = {factor: name for factor, name in names.items() if factor >= least}
    factor = unit_factor(ratio, within, units) if units and ratio > 1.0 else None
    return None if factor is None else (units[factor], factor)


def factor_text(factor: float) -> str:
    """``1000`` or ``1/1000``."""
    return f"{factor:.7g}" if factor >= 1.0 else f"1/{1.0 / factor:.7g}"


def far_size(measured: float, usual: float, unit: str, whose: str) -> str | None:
    """How a size differs from `whose`, which is usual, by more than a factor of 50; else None.

    Both sizes are in `unit` and not below 0; of a size of 0 nothing is said.
    """
    if measured == 0.0 or usual == 0.0 or 1.0 / _MOST < measured / usual < _MOST:
        return None
    text = (
        f"about {measured / usual:.3g} times {whose} ({measured:.3g} against {usual:.3g} {unit}; "
        f"allowed is {1.0 / _MOST:g} to {_MOST:g} times)"
    )
    factor = unit_factor(measured / usual)
    if factor is None:
        return text
    size = factor_text(max(factor, 1.0 / factor))
    return f"{text}, so a column may be in a unit that is wrong by {size}"
