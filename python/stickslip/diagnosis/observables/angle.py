"""Static tilt against a held field: Eqs. (11) and (12) without motion."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array
from stickslip.diagnosis.data.plausibility import refuse_larger
from stickslip.diagnosis.observables.observable import TableObservable
from stickslip.diagnosis.observables.reading_errors import of_angles
from stickslip.diagnosis.observables.reading_noise import (
    curvature,
    merge,
    noise_of_curve,
    order_along,
    reading_noise,
)
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.measurement.outliers import far_from_their_neighbours
from stickslip.scenario.scenario import Scenario

READING = math.radians(0.5)
"""Error of reading an angle off a picture, rad; no noise is taken as smaller. Chosen: a side of
250 um at one um a pixel has ends that are known to a pixel or two."""

_STRONGEST = 1.0
"""Largest field that is accepted, T. Chosen: coils of this kind make millitesla, so beyond it a
unit is wrong."""

_ALONE_LEAST = math.radians(5.0)
"""Distance from the neighbours' line that is never far, rad. Chosen: ten errors of a reading."""

_FEWEST = 8
"""Rows; of fewer none is left out as an outlier. Chosen: six distances determine their scale to
50 %."""

_FEW = 0.2
"""Part of the rows; where more are beyond half a turn the unit is wrong. Chosen: so many are no
slips of a reader."""


class AngleObservable(TableObservable):
    """A table of static tilts, with the core's balance of torques as its model.

    The columns are Bx, Bz (T) and theta (rad). Fields are those of the coils at the robot, in the
    world's frame; they are taken as held long enough, and as reached from lying flat without a
    swing (`_core.static_tilts`). `scenario` has what no parameter sets. Angles or fields in another
    unit are refused.
    """

    name = "angle"

    def __init__(self, table: Mapping[str, Array], scenario: Scenario, title: str) -> None:
        self._base = scenario.to_core()
        fields, theta, beyond = _possible_readings(table, title)
        order = order_along(fields)
        fields, theta, singles = _without_outliers(fields[order], theta[order], title)
        merged = merge(fields, theta[:, None])
        order = order_along(merged.settings)
        self.fields, theta = merged.settings[order], merged.mean[order]
        estimate = noise_of_curve(self.fields, theta[:, 0])
        noise = reading_noise(merged, "smoothness", *estimate, READING, "rad")
        self._set_readings(title, theta, merged.count[order], noise, [*beyond, *singles])
        self.suspects = of_angles(self.observed)
        self.settings = {"Bx": self.fields[:, 0], "Bz": self.fields[:, 1]}

    def physics(self, names: Sequence[str], parameters: Array) -> Array:
        """Angles as they are read, rad, shape (vectors, m); NaN where values make no scenario."""
        return _core.static_tilts(self._base, list(names), parameters, self.fields)


def _possible_readings(table: Mapping[str, Array], title: str) -> tuple[Array, Array, list[Fact]]:
    """Fields, shape (n, 2), and angles within half a turn, and facts of those left out."""
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


def _without_outliers(fields: Array, theta: Array, title: str) -> tuple[Array, Array, list[Fact]]:
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
