"""The recorded quantities of a run: names, units, and what their numbers stand for."""

from __future__ import annotations

from typing import NamedTuple

from stickslip import _core
from stickslip.scenario.sections import COIL_NAMES


class Column(NamedTuple):
    """A recorded quantity: its SI unit, and what it is."""

    unit: str
    meaning: str


COLUMNS = {
    "t": Column("s", "time"),
    "x": Column("m", "position of the centre of mass along the surface"),
    "z": Column("m", "height of the centre of mass above the surface"),
    "theta": Column("rad", "tilt angle, nose-down positive in the robot's own frame"),
    "vx": Column("m/s", "velocity of the centre of mass along the surface"),
    "vz": Column("m/s", "velocity of the centre of mass away from the surface"),
    "omega": Column("rad/s", "rate of the tilt angle"),
    "normal_force": Column("N", "normal force of the surface, adhesion not subtracted"),
    "friction_force": Column("N", "friction force of the surface, along +x"),
    "contact_x": Column("m", "position of the contact point, nothing in flight"),
    "slip_velocity": Column("m/s", "velocity of the contact point, nothing in flight"),
    "bx": Column("T", "field along x at the centre of mass"),
    "by": Column("T", "field along y at the centre of mass, across the plane of motion"),
    "bz": Column("T", "field along z at the centre of mass"),
    "current": Column("A", "current of each coil"),
    "contact": Column("1", "mode of the contact"),
    "event": Column("1", "event of the contact"),
    "y": Column("m", "position of the centre of mass across the x axis"),
    "vy": Column("m/s", "velocity of the centre of mass across the x axis"),
    "heading": Column("rad", "where the robot faces, from +x to the left"),
    "friction_across": Column("N", "friction force of the surface, to the left of the heading"),
    "contact_y": Column("m", "position of the contact point across, nothing in flight"),
    "slip_across": Column("m/s", "velocity of the contact point to the left of the heading"),
}
"""The recorded quantities by name; each is an attribute of a `Run`."""

PLANE_COLUMNS: tuple[str, ...] = _core.plane_columns
"""Those of a run in the whole plane alone, where friction and slip are along the heading."""


WORDS = {"contact": _core.contact_names, "event": _core.event_names}
"""What the numbers of a quantity stand for, where they stand for words."""


def column_units(name: str) -> dict[str, str]:
    """The columns of a quantity in a table, with the SI unit of each; "" for words."""
    unit = "" if name in WORDS else COLUMNS[name].unit
    return {f"current_{coil}": unit for coil in COIL_NAMES} if name == "current" else {name: unit}
