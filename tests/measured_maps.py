"""Maps of the field as a user would have measured them: on a grid, with noise."""

import csv

import numpy as np

from reference import coil_wires
from reference.field import wire_loop_field
from stickslip import COIL_NAMES, Coil, Coils, FieldMap, Scenario

HALF = (8e-3, 3e-3, 3e-3)  # m, of the box, more than a robot walks in these tests
COUNT = (9, 5, 5)
UNIT_FIELD = 9.6258e-4  # T/A, of a coil of Table I at the centre


def grid(half=HALF, count=COUNT):
    """Points of a grid about the centre, shape (n, 3), m."""
    axes = [
        np.linspace(-h, h, n) if n > 1 else np.zeros(1) for h, n in zip(half, count, strict=True)
    ]
    return np.stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")], axis=1)


def formula_fields(points):
    """Fields of Table I's coils, shape (n, 5, 3), T/A."""
    return np.stack([Coils().field(points, one) for one in np.eye(5)], axis=1)


def by(*offset):
    """Function that moves the corners of a coil by an offset, m."""
    return lambda corners: corners + np.array(offset)


def wire_fields(points, **moved):
    """The same fields by straight wires; `moved` maps the corners (5, 3) of coils by name."""
    loops = [moved.get(name, lambda each: each)(coil_wires(name)) for name in COIL_NAMES]
    return np.array([[wire_loop_field(loop, *point) for loop in loops] for point in points])


def formula_map(noise=0.0, seed=0, half=HALF, count=COUNT):
    """The map of Table I's coils, with noise relative to the field at the centre."""
    points = grid(half, count)
    fields = formula_fields(points)
    random = np.random.default_rng(seed)
    fields += noise * UNIT_FIELD * random.standard_normal(fields.shape)
    return FieldMap.from_points(points, fields)


def with_map(field_map, **changes):
    """A scenario with a map, `base` above zero, and values by dotted key."""
    keys = {"drive.base": 0.5e-3, "drive.pulses": 20} | {
        key.replace("__", "."): value for key, value in changes.items()
    }
    if keys.get("drive.mode") == "program":
        del keys["drive.base"], keys["drive.pulses"]
    return Scenario(coil=Coil(map=field_map)).replace(keys)


def write_csv(
    path, points, fields, coils=COIL_NAMES, columns=("x", "y", "z", "coil", "Bx", "By", "Bz")
):
    """A file of some coils' fields, shape (n, 5, 3), T/A."""
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(columns)
        for name in coils:
            own = fields[:, COIL_NAMES.index(name)]
            for place, field in zip(points.tolist(), own.tolist(), strict=True):
                rows.writerow([*place, name, *field])
    return path
