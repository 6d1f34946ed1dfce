"""Whether numbers have a size that they can have in the unit that is wanted."""

from __future__ import annotations

_MOST = 50.0


def far_off(measured: float, usual: float, unit: str, whose: str) -> str | None:
    """What to say of a size above 50 times the usual one or below a 50th of it; both above 0."""
    ratio = measured / usual
    if 1.0 / _MOST < ratio < _MOST:
        return None
    wrong = ""
    if 0.1 < ratio / 1e3 < 10.0 or 0.1 < ratio * 1e3 < 10.0:
        wrong = ", so a column may be in a unit that is wrong by 1000"
    return (
        f"about {ratio:.3g} times {whose} ({measured:.3g} against {usual:.3g} {unit}; allowed is "
        f"{1.0 / _MOST:g} to {_MOST:g} times){wrong}"
    )
