"""The field of the coils at given places for measured currents, with the effects that change it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import COIL_NAMES

Array = NDArray[np.float64]

_GEOMETRY = ("coil.side", "coil.distance", "coil.turns")
_GAINS = ("effects.field_gain.in_plane", "effects.field_gain.clamp")
_AMBIENT = ("effects.ambient_field.Bx", "effects.ambient_field.Bz")
_CLAMP = COIL_NAMES.index("clamp")


def shares(points: Array, currents: Array, geometry: Sequence[float]) -> Array:
    """Field of each coil, T, shape (n, 5, 3), Eqs. (2)-(7).

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        m.
    currents : ndarray, shape (n, 5)
        A.
    geometry : sequence of float
        Side and distance in m, and turns.

    Raises
    ------
    ValueError
        If a point lies on the wire of a coil that has current.
    """
    side, distance, turns = geometry
    coils = _core.CoilSet(side, distance, turns)
    found = np.zeros((len(points), len(COIL_NAMES), 3))
    for k in range(len(COIL_NAMES)):
        alone = np.zeros_like(currents)
        alone[:, k] = currents[:, k]
        found[:, k] = coils.field(points, alone)
    return found


class CoilField:
    """Fields at all rows of a table, for vectors of parameters.

    As in the core, `field_gain` multiplies each coil's field and `ambient_field` is added;
    `gradient_scale` is a factor on the magnetic force and leaves the field as it is, and what lies
    between voltage and current has no effect at given currents.

    Parameters
    ----------
    points, currents : ndarray, shapes (n, 3) and (n, 5)
        m and A.
    scenario : Scenario
        Values of the keys that are no parameters.

    Attributes
    ----------
    nominal : ndarray, shape (n, 5, 3)
        Field of each coil with the scenario's geometry and gains of 1, T.

    Raises
    ------
    ValueError
        If a point lies on the wire of a coil that has current.
    """

    def __init__(self, points: Array, currents: Array, scenario: Scenario) -> None:
        self.points, self.currents = points, currents
        self.base = {key: float(scenario.get(key)) for key in (*_GEOMETRY, *_GAINS, *_AMBIENT)}
        self._shares: dict[tuple[float, ...], Array] = {}
        self.nominal = self.shares_of(self.base)

    def shares_of(self, values: Mapping[str, float]) -> Array:
        """Field of each coil with the geometry among `values`, T, shape (n, 5, 3)."""
        geometry = tuple(values[key] for key in _GEOMETRY)
        if geometry not in self._shares:
            if len(self._shares) > 64:
                self._shares.clear()
            self._shares[geometry] = shares(self.points, self.currents, geometry)
        return self._shares[geometry]

    def __call__(self, names: Sequence[str], parameters: Array) -> Array:
        """Bx, By, Bz, T, shape (vectors, n, 3); NaN for a geometry that puts a wire on a point."""
        columns = {name: k for k, name in enumerate(names) if name in self.base}
        result = np.full((len(parameters), len(self.points), 3), np.nan)
        for row, vector in zip(result, parameters, strict=True):
            values = {**self.base, **{name: float(vector[k]) for name, k in columns.items()}}
            gain = np.full(len(COIL_NAMES), 1.0 + values[_GAINS[0]])
            gain[_CLAMP] = 1.0 + values[_GAINS[1]]
            try:
                row[:] = np.einsum("nkc,k->nc", self.shares_of(values), gain)
            except ValueError:
                continue
            row[:, 0] += values[_AMBIENT[0]]
            row[:, 2] += values[_AMBIENT[1]]
        return result
