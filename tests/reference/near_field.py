"""Field and gradient of all coils near a place, from an expansion that moves with the body."""

import numpy as np

from .field import GRADIENT_OFFSET, wire_loop_field
from .rigid_body import inner, record

# The field is taken anew when the body has moved this far; between, its first-order expansion errs
# by 1e-8 of it.
REFRESH = 1e-6  # m


def new_field(coils: int):
    """Room for the field of some coils, taken nowhere yet.

    place (3,) m where field (n, 3) T/A and gradient (n, 3, 3) T/(m A), dB_i / dx_j, were taken;
    total (3,) T and slope (3, 3) T/m are those of all coils with their currents.
    """
    near = record(
        {
            "place": (3,), "field": (coils, 3), "gradient": (coils, 3, 3), "total": (3,),
            "slope": (3, 3),
        }
    )  # fmt: skip
    near["place"] = np.inf
    return near


@inner
def _take(wires, x, y, z, near):
    """Field and gradient per ampere of the coils, wires (n, 5, 3), at a place, into `near`."""
    near.place[0], near.place[1], near.place[2] = x, y, z
    d = GRADIENT_OFFSET
    for coil in range(wires.shape[0]):
        bx, by, bz = wire_loop_field(wires[coil], x, y, z)
        near.field[coil, 0], near.field[coil, 1], near.field[coil, 2] = bx, by, bz
        for j in range(3):
            dx, dy, dz = d * (j == 0), d * (j == 1), d * (j == 2)
            ahead = wire_loop_field(wires[coil], x + dx, y + dy, z + dz)
            behind = wire_loop_field(wires[coil], x - dx, y - dy, z - dz)
            for i in range(3):
                near.gradient[coil, i, j] = (ahead[i] - behind[i]) / (2.0 * d)


@inner
def field_at(wires, place, amperes, near):
    """Fill near.total in T and near.slope in T/m at a place (3,) in m; amperes (n,)."""
    far = 0.0
    for j in range(3):
        far = max(far, abs(place[j] - near.place[j]))
    if not far <= REFRESH:
        _take(wires, place[0], place[1], place[2], near)
    for i in range(3):
        near.total[i] = near.slope[i, 0] = near.slope[i, 1] = near.slope[i, 2] = 0.0
    for coil in range(amperes.shape[0]):
        for i in range(3):
            near.total[i] += amperes[coil] * near.field[coil, i]
            for j in range(3):
                near.slope[i, j] += amperes[coil] * near.gradient[coil, i, j]
    for i in range(3):
        for j in range(3):
            near.total[i] += near.slope[i, j] * (place[j] - near.place[j])
