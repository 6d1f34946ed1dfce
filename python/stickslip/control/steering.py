"""Voltages that drive a robot along a heading."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _core
from stickslip._util.arrays import Array, numbers
from stickslip._util.messages import refuse
from stickslip.errors import ScenarioError
from stickslip.field.coils import Coils
from stickslip.scenario.scenario import Scenario


def heading_voltages(heading: ArrayLike, along: ArrayLike, clamp: ArrayLike) -> Array:
    """Voltages of the coils xp, xm, yp, ym and clamp, V, shape (..., 5).

    Of each axis the coil that lies ahead makes its part of the field along the surface, as a drive
    with ``coils = "single"`` does, so that the robot is pulled the way it faces. The coils are
    taken as equal.

    Parameters
    ----------
    heading : array_like
        From +x to the left, rad.
    along : array_like
        Of a coil on the axis, if the robot headed along it, V.
    clamp : array_like
        V.

    Raises
    ------
    ScenarioError
        If one of these is not finite, or if their shapes do not broadcast.

    Examples
    --------
    >>> from stickslip.control import heading_voltages
    >>> heading_voltages(0.0, 26.0, -10.0).tolist()
    [26.0, 0.0, 0.0, 0.0, -10.0]
    """
    given = [
        numbers("heading", heading, "finite numbers of rad"),
        numbers("along", along, "finite numbers of V"),
        numbers("clamp", clamp, "finite numbers of V"),
    ]
    try:
        ahead, strength, held = np.broadcast_arrays(*given)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in given)
        raise ScenarioError(
            f"heading, along and clamp of shapes {shapes}: allowed are shapes that broadcast"
        ) from None
    # Exact along the axes, where the coils across are to stay off.
    towards_x, towards_y = _core.surface_directions(ahead)
    x, y = strength * towards_x, strength * towards_y
    parts = [np.maximum(x, 0.0), np.minimum(x, 0.0), np.maximum(y, 0.0), np.minimum(y, 0.0), held]
    return np.stack(parts, axis=-1)


def field_voltages(
    scenario: Scenario, heading: ArrayLike, along: ArrayLike, clamp: ArrayLike
) -> Array:
    """Voltages of a scenario's own coils for steady fields at the centre, V, shape (..., 5).

    Of each axis the coil that lies ahead makes its part, or with ``drive.coils = "pairs"`` both
    alike.

    Parameters
    ----------
    scenario : Scenario
        Its coils, and the choice of `drive`.
    heading : array_like
        From +x to the left, rad.
    along : array_like
        Field along the surface, T.
    clamp : array_like
        Field of the clamp coil, T, along +z.

    Raises
    ------
    ScenarioError
        As of `heading_voltages`.
    """
    fields = heading_voltages(heading, along, clamp)
    if scenario.drive.coils == "pairs":
        fields[..., [0, 1]] = 0.5 * fields[..., [0, 1]].sum(axis=-1, keepdims=True)
        fields[..., [2, 3]] = 0.5 * fields[..., [2, 3]].sum(axis=-1, keepdims=True)
    ohms = scenario.to_core().resistances()
    return np.asarray(fields * ohms / Coils.of(scenario).centre_field_per_ampere)


def check_within_coils(name: str, points: Array, scenario: Scenario) -> None:
    """Refuse places (k, 2), m, of which one lies where no field of the coils is known."""
    coils = Coils.of(scenario)
    far = float(np.min(coils.distance))
    low, high = np.array([[-far, -far], [far, far]])
    if coils.box is not None:
        low, high = (np.array(corner[:2]) for corner in coils.box)
    beyond = ((points < low) | (points > high)).any(axis=-1)
    if beyond.any():
        (x, y), (x0, y0), (x1, y1) = points[np.argmax(beyond)], low, high
        raise ScenarioError(
            f"{name}: ({x:g}, {y:g}) m lies beyond the coils' field: allowed are x from {x0:g} to "
            f"{x1:g} m and y from {y0:g} to {y1:g} m"
        )


def pulse_fields(scenario: Scenario) -> tuple[float, float]:
    """Peak and clamp field of the drive of a scenario, T, with which a controller gives pulses."""
    drive = scenario.drive
    if drive.mode != "IPP":
        refuse("drive.mode", drive.mode, '"IPP", whose pulses lie along the heading')
    if drive.peak == 0.0 or drive.hold == 0.0:
        refuse("drive.peak" if drive.peak == 0.0 else "drive.hold", 0.0, "a field to pitch it")
    return drive.peak, -drive.hold if drive.clamp == "down" else drive.hold
