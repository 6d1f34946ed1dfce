"""Orientation, corners and inertia of a cuboid in space.

Unit quaternions (w, x, y, z) turn from the body's frame into the world's. A turn is a rotation
vector in the world's frame: axis times angle in rad.
"""

import numpy as np
from numba import njit

# A function that only compiled ones call needs no entry from Python. With `njit` and named tuples
# of arrays the kernel takes twice as long to compile, and five times as long to run.
inner = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


def record(floats: dict, integers: dict | None = None) -> np.void:
    """Arrays of zeros, by name with their shapes, that are one argument to a compiled function."""
    kinds = ((floats, np.float64), (integers or {}, np.int64))
    dtype = [(name, kind, shape) for shapes, kind in kinds for name, shape in shapes.items()]
    return np.zeros(1, np.dtype(dtype))[0]


CORNERS = 8

# Signs of the corners' places in the body's frame, (8, 3). Corners i and i + 4 are mirror images in
# the plane of symmetry that holds the moment: the first four are the left side, y > 0.
CORNER_SIGNS = np.array(
    [
        [1.0, 1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0], [-1.0, -1.0, -1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, 1.0],
    ]
)  # fmt: skip


@inner
def turned(quaternion, turn_x, turn_y, turn_z, result):
    """The orientation (4,) after a turn in rad about the world's axes, into result (4,)."""
    angle = np.sqrt(turn_x * turn_x + turn_y * turn_y + turn_z * turn_z)
    # sin(a/2) / a; its series where the quotient has no digits.
    share = 0.5 - angle * angle / 48.0 if angle < 1e-4 else np.sin(0.5 * angle) / angle
    a, b, c, d = np.cos(0.5 * angle), share * turn_x, share * turn_y, share * turn_z
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    result[0] = a * w - b * x - c * y - d * z
    result[1] = a * x + b * w + c * z - d * y
    result[2] = a * y - b * z + c * w + d * x
    result[3] = a * z + b * y - c * x + d * w
    norm = np.sqrt(
        result[0] * result[0] + result[1] * result[1] + result[2] * result[2]
        + result[3] * result[3]
    )  # fmt: skip
    for i in range(4):
        result[i] /= norm


@inner
def rotation(quaternion, matrix):
    """Rotation matrix from the body's frame to the world's, into matrix (3, 3)."""
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    matrix[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    matrix[0, 1] = 2.0 * (x * y - w * z)
    matrix[0, 2] = 2.0 * (x * z + w * y)
    matrix[1, 0] = 2.0 * (x * y + w * z)
    matrix[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    matrix[1, 2] = 2.0 * (y * z - w * x)
    matrix[2, 0] = 2.0 * (x * z - w * y)
    matrix[2, 1] = 2.0 * (y * z + w * x)
    matrix[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@inner
def corner_places(matrix, half_sizes, places):
    """Places of the corners from the centre of mass in the world's frame in m, into (8, 3).

    matrix: rotation (3, 3); half_sizes (3,): half of length, width and height, m.
    """
    for i in range(CORNERS):
        for row in range(3):
            places[i, row] = (
                matrix[row, 0] * CORNER_SIGNS[i, 0] * half_sizes[0]
                + matrix[row, 1] * CORNER_SIGNS[i, 1] * half_sizes[1]
                + matrix[row, 2] * CORNER_SIGNS[i, 2] * half_sizes[2]
            )


@inner
def in_world(matrix, diagonal, result):
    """A tensor that is diagonal (3,) in the body's frame, in the world's frame, into (3, 3)."""
    for i in range(3):
        for j in range(3):
            result[i, j] = (
                matrix[i, 0] * diagonal[0] * matrix[j, 0]
                + matrix[i, 1] * diagonal[1] * matrix[j, 1]
                + matrix[i, 2] * diagonal[2] * matrix[j, 2]
            )


@inner
def applied(tensor, vector, result):
    """tensor (3, 3) times vector (3,), into result (3,)."""
    for i in range(3):
        result[i] = tensor[i, 0] * vector[0] + tensor[i, 1] * vector[1] + tensor[i, 2] * vector[2]
