"""Field of the five square coils as a sum of finite straight wires.

Source: Biot-Savart law for one straight segment, in the vector form that stays finite on the
segment's own extension, B = mu0 I / (4 pi) (a + b) / (a b (a b + ra.rb)) ra x rb, with ra and rb
the vectors from the segment's two ends to the field point. This is deliberately not the coordinate
form of the paper's Eqs. (4)-(6). ON a wire the result is not finite.
"""

import numpy as np
from numba import njit

VACUUM_PERMEABILITY = 4e-7 * np.pi  # T m / A, the value of the paper's Eq. (2)
TURNS = 510  # Table I
SIDE = 0.1385  # m, "effective length" of Table I
DISTANCE = 0.099  # m, Table I
RESISTANCE = 10.0  # ohm, Table I
INDUCTANCE = 70e-3  # H, Table I

# Half the offset of the central difference would have to reach 1 cm before its truncation error
# (offset / 0.1 m)^2 / 6 mattered; rounding (1e-16 B / offset) is as harmless at this size.
GRADIENT_OFFSET = 2e-5  # m

COIL_NAMES = ("xp", "xm", "yp", "ym", "clamp")
_AXIS = {"xp": 0, "xm": 0, "yp": 1, "ym": 1, "clamp": 2}
_SIDE_OF_CENTRE = {"xp": 1.0, "xm": -1.0, "yp": 1.0, "ym": -1.0, "clamp": -1.0}


def coil_wires(name: str, side: float = SIDE) -> np.ndarray:
    """Corners of a coil in the order in which positive current visits them.

    Shape (5, 3), metres; the last corner repeats the first. Positive current turns right-handed
    about the coil's positive coordinate axis, so it gives a field along +x, +y or +z at the centre.
    """
    axis = _AXIS[name]
    first, second = (axis + 1) % 3, (axis + 2) % 3
    corners = np.zeros((5, 3))
    corners[:, axis] = _SIDE_OF_CENTRE[name] * DISTANCE
    corners[:, first] = np.array([1, -1, -1, 1, 1]) * side / 2
    corners[:, second] = np.array([1, 1, -1, -1, 1]) * side / 2
    return corners


@njit
def wire_loop_field(corners, px, py, pz):
    """(Bx, By, Bz) in T per ampere at (px, py, pz) in m, all turns of one closed loop."""
    bx = by = bz = 0.0
    for i in range(corners.shape[0] - 1):
        ax = px - corners[i, 0]
        ay = py - corners[i, 1]
        az = pz - corners[i, 2]
        ex = px - corners[i + 1, 0]
        ey = py - corners[i + 1, 1]
        ez = pz - corners[i + 1, 2]
        a = np.sqrt(ax * ax + ay * ay + az * az)
        e = np.sqrt(ex * ex + ey * ey + ez * ez)
        factor = (a + e) / (a * e * (a * e + ax * ex + ay * ey + az * ez))
        bx += factor * (ay * ez - az * ey)
        by += factor * (az * ex - ax * ez)
        bz += factor * (ax * ey - ay * ex)
    scale = VACUUM_PERMEABILITY * TURNS / (4 * np.pi)
    return scale * bx, scale * by, scale * bz


@njit
def wire_loop_planar(corners, px, pz):
    """Field and derivatives per ampere in the plane y = 0, as motion in it needs them.

    Returns (Bx, Bz, dBx/dx, dBx/dz, dBz/dx, dBz/dz) in T/A and T/(m A).
    """
    d = GRADIENT_OFFSET
    bx, _, bz = wire_loop_field(corners, px, 0.0, pz)
    xp = wire_loop_field(corners, px + d, 0.0, pz)
    xm = wire_loop_field(corners, px - d, 0.0, pz)
    zp = wire_loop_field(corners, px, 0.0, pz + d)
    zm = wire_loop_field(corners, px, 0.0, pz - d)
    half = 0.5 / d
    return (
        bx,
        bz,
        (xp[0] - xm[0]) * half,
        (zp[0] - zm[0]) * half,
        (xp[2] - xm[2]) * half,
        (zp[2] - zm[2]) * half,
    )


def coil_field(name: str, point, side: float = SIDE) -> np.ndarray:
    """Field of one ampere in one coil at one point (3,) in m; shape (3,), T/A. side: m."""
    px, py, pz = (float(c) for c in point)
    return np.array(wire_loop_field(coil_wires(name, side), px, py, pz))


def _centre_field_per_ampere() -> float:
    """On the axis of a square loop each side, 2a at sqrt(c^2 + a^2), contributes equally; T/A."""
    a, c = SIDE / 2, DISTANCE
    loop = 2 * VACUUM_PERMEABILITY * TURNS / np.pi
    return loop * a**2 / ((a**2 + c**2) * np.sqrt(2 * a**2 + c**2))


CENTRE_FIELD_PER_AMPERE = _centre_field_per_ampere()  # T/A; the fields of [drive] convert by it
