"""The magnetic field of the five coils and its gradient."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _core
from stickslip._util.arrays import Array


class Coils:
    """Five equal square coils around the origin; the frame is right-handed with z up.

    Positive current in any coil gives a field along the positive axis (+x, +y or +z) at the
    origin. Each winding counts as one filament (equations (2)-(7) of Pawashe, Floyd and Sitti,
    RSS 2008), with mu_0 = 4 pi 1e-7 T m/A. Defaults are those of the paper's Table I.

    Parameters
    ----------
    side : float
        Effective side length of each coil, m.
    distance : float
        Distance from the origin to each coil's plane, m.
    turns : float
        Number of turns of each coil.

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

    def __init__(self, side: float = 0.1385, distance: float = 0.099, turns: float = 510.0) -> None:
        self._core = _core.CoilSet(float(side), float(distance), float(turns))

    def __repr__(self) -> str:
        return f"Coils(side={self.side}, distance={self.distance}, turns={self.turns})"

    @property
    def side(self) -> float:
        """Effective side length, m."""
        return self._core.side

    @property
    def distance(self) -> float:
        """Distance from the origin to each coil's plane, m."""
        return self._core.distance

    @property
    def turns(self) -> float:
        """Number of turns."""
        return self._core.turns

    @property
    def centre_field_per_ampere(self) -> float:
        """Field at the origin per ampere in one coil, T/A; the same for all five."""
        return self._core.centre_field_per_ampere

    def field(self, points: ArrayLike, currents: ArrayLike) -> Array:
        """Magnetic field of all coils, equations (3)-(7) superposed.

        Parameters
        ----------
        points : array_like, shape (..., 3)
            Positions, m.
        currents : array_like, shape (..., 5)
            Currents in the order of `COIL_NAMES`, A. Leading axes broadcast against those of
            `points`. A coil without current takes no part.

        Returns
        -------
        numpy.ndarray, shape (..., 3)
            Field, T.

        Raises
        ------
        ValueError
            If a shape does not fit, a value is not finite, or a point lies within 1 nm of the
            wire of a coil that has current, where the field of a filament is infinite.
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


def _flatten(points: ArrayLike, currents: ArrayLike) -> tuple[Array, Array, tuple[int, ...]]:
    """Points as (n, 3), currents as (n, 5) or (1, 5), and the common leading shape."""
    points = _checked("points", points, 3, "m")
    currents = _checked("currents", currents, 5, "A")
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


def _checked(name: str, values: ArrayLike, columns: int, unit: str) -> Array:
    array = np.asarray(values, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != columns:
        raise ValueError(f"{name} must have shape (..., {columns}), in {unit}; got {array.shape}")
    finite = np.isfinite(array)
    if not finite.all():
        where = tuple(int(i) for i in np.argwhere(~finite)[0])
        raise ValueError(f"{name} must be finite, in {unit}; {name}{list(where)} is {array[where]}")
    return array
