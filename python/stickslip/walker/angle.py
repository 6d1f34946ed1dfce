"""Static pitch against a held field: Eqs. (11) and (12) without motion."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array, Indices
from stickslip._util.note import Note
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.walker.instruments import of_angles
from stickslip.walker.outliers import far_from_their_neighbours, free_of_bends
from stickslip.walker.simulated import SimulatedTable, of_readings

READING = math.radians(0.5)
"""Smallest error of an angle that is read off a picture, rad. Chosen: a side of 250 um at one um a
pixel has ends that are known to a pixel or two."""

_ALONE_LEAST = math.radians(5.0)
"""Distance from the neighbours' line that is never far, rad. Chosen: ten errors of a reading."""

_FEWEST = 8
"""Rows from which on outliers are looked for. Chosen: six distances tell their scale to 50 %."""

_FEW = 0.2
"""Share of the rows that may be beyond half a turn. Chosen: more are no slips of a reader."""


class AngleTable(SimulatedTable):
    """A table of static pitch angles, with the core's balance of torques as its model.

    `table` has columns Bx, Bz (T) and theta (rad), of shape (n,). Fields are those of the coils at
    the robot, in the world's frame, held long enough, and reached from lying flat without a swing.
    `scenario` is what no parameter sets. Without repeats the error of a reading is what lines
    through every second condition leave over, in the order in which the field changes least. A
    ScenarioError is raised if many angles are beyond half a turn.
    """

    words, section = "angles", "Static pitch, [[angle]]"

    def __init__(self, table: Mapping[str, Array], scenario: Scenario, number: int = 0) -> None:
        self.number, self._base, self.left_out = number, scenario.to_core(), []
        rows = self._sound(np.stack([table["Bx"], table["Bz"], table["theta"]], axis=1))
        bx, bz, theta = self._without_outliers(rows).T
        super().__init__({"Bx": bx, "Bz": bz}, theta, sd=READING, name="angle", unit="rad")
        self.fields = np.stack([bx, bz], axis=1)[self.first]
        design = _lines(self.fields, self.mean)[self.condition]
        self.errors = of_readings(theta, design, self.condition, READING, "rad")
        self.instruments = of_angles(self.mean)

    def setting_unit(self, name: str) -> str:
        return "T"

    def physics(self, names: Sequence[str], values: Array) -> Array:
        """Angles, rad; NaN where values make no scenario."""
        return _core.static_tilts(self._base, list(names), values, self.fields)

    def _sound(self, rows: Array) -> Array:
        """Rows of Bx, Bz and theta within half a turn."""
        theta = rows[:, 2]
        beyond = np.abs(theta) > math.pi
        if np.mean(beyond) > _FEW:
            raise ScenarioError(
                f"{self.at}theta of {theta[np.argmax(np.abs(theta))]:.4g} rad; allowed is -pi "
                'to pi: subtract whole turns, or state the unit, as "theta (deg)"'
            )
        for angle in theta[beyond].tolist():
            text = f"theta = {angle:.4g} rad is not used, as it is more than half a turn."
            self.left_out.append(Note("angle-beyond-turn", text, angle))
        return rows[~beyond]

    def _without_outliers(self, rows: Array) -> Array:
        """Rows of a curve without repeats, less those far from two neighbours that agree."""
        if len(rows) < _FEWEST or len(np.unique(rows[:, :2], axis=0)) < len(rows):
            return rows
        order = _along(rows[:, :2])
        distance, slope = _bends(rows[order, :2], rows[order, 2])
        far = order[1:-1][far_from_their_neighbours(distance, slope, _ALONE_LEAST)]
        for bx, bz, theta in rows[far].tolist():
            text = (
                f"theta = {theta:.4g} rad at Bx = {bx:.4g} T, Bz = {bz:.4g} T is not used, as it "
                "is far from both its neighbours, which agree."
            )
            self.left_out.append(Note("lonely-angle", text, theta))
        return np.delete(rows, far, axis=0)


def _along(fields: Array) -> Indices:
    """Order of fields, shape (m, 2), in which they change in the smallest steps.

    By one component within the other, or by direction or size, whichever way is the shortest.
    """
    x, z = fields.T
    turn, size = np.arctan2(z, x), np.hypot(x, z)
    orders = [np.lexsort(keys) for keys in ((z, x), (x, z), (size, turn), (turn, size))]
    ways = [float(np.sum(np.hypot(*np.diff(fields[order], axis=0).T))) for order in orders]
    return np.asarray(orders[int(np.argmin(ways))], dtype=np.int64)


def _bends(fields: Array, theta: Array) -> tuple[Array, Array]:
    """Distance of each inner angle from the line through its neighbours, and their difference.

    Both have shape (m - 2,); the fields are in the order of `_along`, no two alike. A distance is
    scaled to the standard deviation of an angle, if the curve is straight.
    """
    steps = np.hypot(*np.diff(fields, axis=0).T)
    share = steps[:-1] / (steps[:-1] + steps[1:])
    line = (1.0 - share) * theta[:-2] + share * theta[2:]
    size = np.sqrt(1.0 + (1.0 - share) ** 2 + share**2)
    return (theta[1:-1] - line) / size, theta[2:] - theta[:-2]


def _lines(fields: Array, theta: Array) -> Array:
    """A basis of curves through the conditions without noise, shape (m, columns).

    It is linear between every second condition. A condition at a bend, and one at which the curve
    is exactly flat and says nothing of the noise elsewhere, is free.
    """
    order = _along(fields)
    fields, theta = fields[order], theta[order]
    place = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(fields, axis=0).T))])
    knots = np.unique(np.append(place[::2], place[-1]))
    design = np.stack([np.interp(place, knots, unit) for unit in np.eye(len(knots))], axis=1)
    if len(theta) > 2:
        distance, slope = _bends(fields, theta)
        flat = (distance == 0.0) & (slope == 0.0)
        bent = flat.copy()
        if not flat.all():
            bent[~flat] = ~free_of_bends(distance[~flat])
        design = np.hstack([design, np.eye(len(theta))[:, 1:-1][:, bent]])
    return np.asarray(design[np.argsort(order)])
