"""The magnetic field of the five coils and its gradient."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _core
from stickslip._util.arrays import Array, in_columns, numbers
from stickslip._util.messages import known_arguments, refuse

AXES = (0, 0, 1, 1, 2)
"""Axis along which the field of each coil points at the origin, in the order of `COIL_NAMES`."""


@known_arguments
class Coils:
    """Five square coils around the origin; the frame is right-handed with z up.

    Positive current in any coil gives a field along the positive axis (+x, +y or +z) at the
    origin. Each winding counts as one filament (equations (2)-(7) of Pawashe, Floyd and Sitti,
    RSS 2008), with mu_0 = 4 pi 1e-7 T m/A. Defaults are those of the paper's Table I.

    Parameters
    ----------
    side : float or array_like of shape (5,)
        Effective side length of all coils, or of each in the order of `COIL_NAMES`, m.
    distance : float or array_like of shape (5,)
        Distance from the origin to a coil's plane, m.
    turns : float or array_like of shape (5,)
        Number of turns.

    Raises
    ------
    ValueError
        If a parameter is not positive and finite.

    Examples
    --------
    >>> coils = Coils()
    >>> coils.field([0, 0, 0], [1, 0, 0, 0, 0]).round(8)  # 1 A in the +x coil; T
    array([0.00096258, 0.        , 0.        ])
    """

    def __init__(
        self, side: ArrayLike = 0.1385, distance: ArrayLike = 0.099, turns: ArrayLike = 510.0
    ) -> None:
        self._core = _core.CoilSet(*map(_five, (side, distance, turns)))

    @classmethod
    def of(cls, scenario: Any) -> Coils:
        """The coils of a scenario, with the own values of single ones (``[coil.xp]`` ...).

        With ``coil.map`` the field is that of the map, and known in its `box` only; side, distance
        and turns then have no part in it.
        """
        core = scenario.to_core() if hasattr(scenario, "to_core") else None
        if not isinstance(core, _core.Scenario):
            refuse("scenario", scenario, "a Scenario")
        made = cls()
        made._core = core.coils()
        return made

    def __repr__(self) -> str:
        if self.box is not None:
            return f"<Coils of a field map from {self.box[0]} to {self.box[1]} m>"
        return f"Coils(side={self.side}, distance={self.distance}, turns={self.turns})"

    @property
    def side(self) -> float | Array:
        """Effective side length, m; shape (5,) where it differs."""
        return _one_or_five(self._core.side)

    @property
    def distance(self) -> float | Array:
        """Distance from the origin to a coil's plane, m; shape (5,) where it differs."""
        return _one_or_five(self._core.distance)

    @property
    def turns(self) -> float | Array:
        """Number of turns; shape (5,) where it differs."""
        return _one_or_five(self._core.turns)

    @property
    def centre_field_per_ampere(self) -> float | Array:
        """Field at the origin, along a coil's positive axis, per ampere in it alone, T/A.

        One number, or shape (5,) where the coils differ.
        """
        return _one_or_five(self._core.centre_field_per_ampere)

    @property
    def box(self) -> tuple[list[float], list[float]] | None:
        """Low and high corner of the field map, x, y and z, m; None for coils without one."""
        corners = self._core.box
        return None if corners is None else (corners[0].tolist(), corners[1].tolist())

    def field(self, points: ArrayLike, currents: ArrayLike) -> Array:
        """Magnetic field of all coils, equations (3)-(7) superposed.

        Parameters
        ----------
        points : array_like, shape (..., 3)
            Positions, m; or columns x, y, z.
        currents : array_like, shape (..., 5)
            Currents in the order of `COIL_NAMES`, or by these names, A. Leading axes broadcast
            against those of `points`. A coil without current takes no part.

        Returns
        -------
        numpy.ndarray, shape (..., 3)
            Field, T.

        Raises
        ------
        ValueError
            If a shape does not fit, a value is not finite, or a point lies within 1 nm of the
            wire of a coil that has current, where the field of a filament is infinite, or outside
            of the box of a map.
        """
        flat_points, flat_currents, shape = _flatten(points, currents)
        return self._core.field(flat_points, flat_currents).reshape(*shape, 3)

    def gradient(self, points: ArrayLike, currents: ArrayLike) -> Array:
        """Gradient of the field of all coils, by the analytic derivatives of (4)-(6).

        Parameters
        ----------
        points, currents : array_like, shapes (..., 3) and (..., 5)
            As for `field`.

        Returns
        -------
        numpy.ndarray, shape (..., 3, 3)
            Element [..., i, j] is dB_i / dx_j, T/m. Symmetric and without trace.

        Raises
        ------
        ValueError
            As for `field`.
        """
        flat_points, flat_currents, shape = _flatten(points, currents)
        return self._core.gradient(flat_points, flat_currents).reshape(*shape, 3, 3)


def _five(values: ArrayLike) -> list[float]:
    """One value a coil, of one for all or of five; other shapes are a ValueError."""
    what, names = "a value of the coils", _core.coil_names
    if not hasattr(values, "__iter__") or getattr(values, "ndim", None) == 0:
        values = np.repeat(numbers(what, values, gaps=True, finite=False), len(names))
    made = in_columns(what, values, names, axes=1, gaps=True, finite=False)
    return [float(value) for value in made]


def _one_or_five(values: list[float]) -> float | Array:
    return values[0] if len(set(values)) == 1 else np.array(values)


def _flatten(points: ArrayLike, currents: ArrayLike) -> tuple[Array, Array, tuple[int, ...]]:
    """Points as (n, 3), currents as (n, 5) or (1, 5), and the common leading shape."""
    points = in_columns("points", points, ("x", "y", "z"), "finite numbers of m", unit="m")
    currents = in_columns("currents", currents, _core.coil_names, "finite numbers of A", unit="A")
    try:
        shape = np.broadcast_shapes(points.shape[:-1], currents.shape[:-1])
    except ValueError:
        raise ValueError(
            f"points of shape {points.shape} and currents of shape {currents.shape} do not "
            "broadcast: all axes but the last must match"
        ) from None
    flat_points = np.broadcast_to(points, (*shape, 3)).reshape(-1, 3)
    if currents.ndim == 1:
        return flat_points, currents[np.newaxis], shape
    return flat_points, np.broadcast_to(currents, (*shape, 5)).reshape(-1, 5), shape
