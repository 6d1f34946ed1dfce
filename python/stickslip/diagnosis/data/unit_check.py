"""Whether numbers have a size that they can have in the unit that is wanted."""

from __future__ import annotations

from typing import Any

from stickslip.errors import ScenarioError

_MOST = 50.0
"""Ratio beyond which a size is far from the usual one."""


def magnitude_mismatch(measured: float, usual: float, unit: str) -> dict[str, Any] | None:
    """Whether a size is above 50 times the usual one, or below a 50th of it.

    Parameters
    ----------
    measured, usual : float
        In one unit, not below 0. Nothing is said where either is 0.
    unit : str
        That one.

    Returns
    -------
    dict, optional
        ``ratio``, ``measured``, ``usual``, ``unit``, the ``allowed`` ratios, and ``by_1000``,
        whether the unit may be wrong by a factor of 1000: fields of a `Fact`.
    """
    if measured == 0.0 or usual == 0.0 or 1.0 / _MOST < measured / usual < _MOST:
        return None
    ratio = measured / usual
    return {
        "ratio": ratio,
        "measured": measured,
        "usual": usual,
        "unit": unit,
        "allowed": [1.0 / _MOST, _MOST],
        "by_1000": 0.1 < ratio / 1e3 < 10.0 or 0.1 < ratio * 1e3 < 10.0,
    }


def refuse_larger(table: str, what: str, size: float, most: float, unit: str) -> None:
    """Refuse a table with a length or a field so large that its unit must be wrong.

    Raises
    ------
    ScenarioError
        Naming the table, the size and what is allowed.
    """
    if size > most:
        raise ScenarioError(
            f"{table}: a {what} of {size:.4g} {unit}; allowed is at most {most:g} {unit}. If "
            f"{what}s are in m{unit}, divide them by 1e3"
        )
