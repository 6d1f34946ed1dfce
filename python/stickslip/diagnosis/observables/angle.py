"""Static tilt against a held field: Eqs. (11) and (12) without motion."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.diagnosis.data.unit_check import refuse_larger
from stickslip.diagnosis.observables.angle_noise import Noise, estimate
from stickslip.diagnosis.observables.curve_noise import curvature, order_along
from stickslip.diagnosis.observables.observable import TableObservable
from stickslip.diagnosis.observables.repeats import merge
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.measurement.outliers import far_from_their_neighbours
from stickslip.scenario.scenario import Scenario

Array = NDArray[np.float64]

_STRONGEST = 1.0
"""Field that no table of this kind has, T; beyond it a unit is wrong."""

_ALONE_LEAST = math.radians(5.0)
"""Distance from the neighbours' line that is never far, rad. Chosen: ten errors of a reading."""

_FEWEST = 8
"""Rows; of fewer none is taken for a slip. Chosen: six distances tell their scale to 50 %."""

_FEW = 0.2
"""Part of the rows; where more are beyond half a turn the unit is wrong. Chosen."""


class AngleObservable(TableObservable):
    """A table of static tilts, with the core's balance of torques as its model.

    Fields are those of the coils at the robot, in the world's frame; they are taken as held long
    enough, and as reached from lying flat without a swing (`_core.static_tilts`).

    Parameters
    ----------
    table : mapping of ndarray, shape (n,)
        Columns Bx, Bz (T) and theta (rad).
    scenario : Scenario
        What no parameter sets.
    title : str
        Of the table, in messages and in the report.

    Raises
    ------
    ScenarioError
        If angles or fields are in another unit.
    """

    name = "angle"

    def __init__(self, table: Mapping[str, Array], scenario: Scenario, title: str) -> None:
        self.title = title
        self._base = scenario.to_core()
        fields, theta, beyond = _sound(table, title)
        order = order_along(fields)
        fields, theta, spikes = _without_spikes(fields[order], theta[order], title)
        merged = merge(fields, theta[:, None])
        order = order_along(merged.settings)
        self.fields = merged.settings[order]
        self.settings = {"Bx": self.fields[:, 0], "Bz": self.fields[:, 1]}
        self.observed = merged.mean[order, 0]
        self.noise: Noise = estimate(self.fields, self.observed, merged)
        self.sd = self.noise.sd / np.sqrt(merged.count[order])
        self.covariance = np.diag(self.sd**2)
        self.group = np.arange(len(self.observed), dtype=np.int64)
        self.notes: tuple[Fact, ...] = (self.noise.note.of(table=title),)
        self.left_out = (*beyond, *spikes)

    def predict(self, names: Sequence[str], parameters: Array) -> Array:
        """Angles as they are read, rad, shape (vectors, m); NaN where values make no scenario."""
        return _core.static_tilts(self._base, list(names), parameters, self.fields)


def _sound(table: Mapping[str, Array], title: str) -> tuple[Array, Array, list[Fact]]:
    """Fields and angles that can be meant, and what was left out."""
    fields = np.stack([table["Bx"], table["Bz"]], axis=1)
    theta = table["theta"]
    refuse_larger(title, "field", float(np.max(np.abs(fields))), _STRONGEST, "T")
    beyond = np.abs(theta) > math.pi
    if np.mean(beyond) > _FEW:
        raise ScenarioError(
            f"{title}: theta of {theta[np.argmax(np.abs(theta))]:.4g} rad; allowed is -pi to pi. "
            "If angles are in degrees, multiply them by pi/180"
        )
    left_out = [
        Fact(Code.ANGLE_BEYOND_TURN, {"table": title, "theta": value})
        for value in theta[beyond].tolist()
    ]
    return fields[~beyond], theta[~beyond], left_out


def _without_spikes(fields: Array, theta: Array, title: str) -> tuple[Array, Array, list[Fact]]:
    """Leave out a row that lies far from two neighbours which agree with each other."""
    if len(theta) < _FEWEST or len(np.unique(fields, axis=0)) < len(theta):
        return fields, theta, []
    kept = np.ones(len(theta), dtype=bool)
    kept[1:-1] = ~far_from_their_neighbours(*curvature(fields, theta), _ALONE_LEAST)
    left_out = [
        Fact(Code.LONELY_ANGLE, {"table": title, "theta": value, "Bx": bx, "Bz": bz})
        for value, (bx, bz) in zip(theta[~kept].tolist(), fields[~kept].tolist(), strict=True)
    ]
    return fields[kept], theta[kept], left_out
