"""Whether numbers have a size that they can have in the unit that is wanted."""

from __future__ import annotations

_MOST = 50.0


def magnitude_mismatch(
    measured: float, usual: float, unit: str, whose: str = "what the stated model gives"
) -> str | None:
    """What to say of a size above 50 times the usual one, or below a 50th of it.

    Parameters
    ----------
    measured, usual : float
        In one unit, not below 0. Nothing is said where either is 0.
    unit : str
        That one.
    whose : str
        The usual one, in words.

    Returns
    -------
    str, optional
        Goes on after "the velocities are", or the like.
    """
    if measured == 0.0 or usual == 0.0 or 1.0 / _MOST < measured / usual < _MOST:
        return None
    ratio, wrong = measured / usual, ""
    if 0.1 < ratio / 1e3 < 10.0 or 0.1 < ratio * 1e3 < 10.0:
        wrong = ", so a column may be in a unit that is wrong by 1000"
    return (
        f"about {ratio:.3g} times {whose} ({measured:.3g} against {usual:.3g} {unit}; allowed is "
        f"{1.0 / _MOST:g} to {_MOST:g} times){wrong}"
    )
