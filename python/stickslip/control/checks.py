"""Checks of what a person gives to environments, paths and cameras; an error has one line."""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence

import numpy as np

from stickslip._util.numbers import Array
from stickslip.errors import ScenarioError
from stickslip.field.coils import Coils
from stickslip.scenario.keys import meant, refuse, shown
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import COIL_NAMES

_NUMBERS = "iuf"  # kinds of numpy's types: no text, no truth values, nothing complex


def check_above_zero(name: str, value: object, unit: str) -> None:
    """Refuse what is not a finite number above 0."""
    is_real = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not (is_real and 0.0 < float(value) < math.inf):  # type: ignore[arg-type]
        refuse(name, value, f"a finite number of {unit} above 0")


def numbers_of(name: str, values: object, allowed: str) -> Array:
    """The finite numbers that the values are, in whatever shape; else refuse them."""
    given = _array_of(name, values, allowed)
    if given.dtype.kind not in _NUMBERS or not np.isfinite(given).all():
        refuse(name, values, allowed)
    return given.astype(float)


def checked_actions(name: str, actions: object, shape: tuple[int, ...]) -> Array:
    """Actions of that shape, (values,) or (robots, values), clipped to -1 to 1; else refuse them.

    Those of one robot have to be finite. Of many, a row that is not comes out as NaN: it is for its
    robot alone to fail.
    """
    allowed = f"shape {shape} of finite numbers, which are clipped to -1 to 1"
    given = _array_of(name, actions, allowed)
    if given.dtype.kind not in _NUMBERS or given.shape != shape:
        told = f"{name} = {shown(given.tolist())} of shape {given.shape}"
        raise ScenarioError(f"{told}: allowed is {allowed}")
    finite = np.isfinite(given).all(axis=-1)
    if given.ndim == 1 and not finite:
        raise ScenarioError(f"{name} = {shown(given.tolist())}: allowed is {allowed}")
    clipped = np.clip(given.astype(float), -1.0, 1.0)
    clipped[~finite] = np.nan
    return np.asarray(clipped)


def coils_named(coils: object, steered: bool) -> list[int]:
    """Where in `COIL_NAMES` coils stand, each once; those of a steered robot make it walk."""
    listed = isinstance(coils, Sequence) and not isinstance(coils, str)
    names = list(coils) if listed else []  # type: ignore[call-overload]
    unknown = [name for name in names if name not in COIL_NAMES]
    if unknown or not names or len(set(names)) < len(names):
        hint = meant(unknown[0], COIL_NAMES) if unknown else ""
        refuse("coils", coils, f"a list of some of {list(COIL_NAMES)}, each once{hint}")
    if steered and ("clamp" not in names or len(names) < 2):
        reason = "without both a robot that is steered does not walk"
        refuse("coils", coils, f'"clamp" and one or more of the others; {reason}')
    return [COIL_NAMES.index(name) for name in names]


def check_within_coils(name: str, points: Array, scenario: Scenario) -> None:
    """Refuse places (k, 2), m, of which one lies where no field of the coils is known."""
    coils = Coils.of(scenario)
    if coils.box is None:
        far = np.min(coils.distance)
        low, high = np.array([-far, -far]), np.array([far, far])
    else:
        low, high = (np.array(corner[:2]) for corner in coils.box)
    beyond = ((points < low) | (points > high)).any(axis=-1)
    if beyond.any():
        (x, y), (x0, y0), (x1, y1) = points[np.argmax(beyond)], low, high
        raise ScenarioError(
            f"{name}: ({x:g}, {y:g}) m lies beyond the coils' field: allowed are x from {x0:g} to "
            f"{x1:g} m and y from {y0:g} to {y1:g} m"
        )


def _array_of(name: str, values: object, allowed: str) -> Array:
    try:
        return np.asarray(values)
    except ValueError:  # rows of several lengths
        refuse(name, values, allowed)
