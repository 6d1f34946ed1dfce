"""Whether a measured field map has the field of its surroundings, or a turned probe."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array, Indices
from stickslip._util.note import Note
from stickslip.field.coils import AXES

if TYPE_CHECKING:
    from stickslip.field.field_map import FieldMap

_LEAST = 0.01
"""Part of the coils' field below which a background is not noted: 10 uT at 1 A in those of Table
I."""

_COMMON = 5.0
"""Ratio of a background, or a turn, to its scatter among coils from which on it is common. Chosen:
of coils turned each on its own by chance, 3 sets of five in 10 000 have that, and 3 sets of four in
1000."""


_TURNED = 3.0
"""Degrees below which a common turn is not noted. Chosen: a probe that is put up by hand."""


def map_notes(field_map: FieldMap) -> list[Note]:
    """Notes on what the fields of all coils at the centre have in common; mostly none."""
    made = _core.Scenario()
    made.set_map(field_map.to_core())
    fields = made.coils().field(np.zeros((len(AXES), 3)), np.eye(len(AXES)))
    sizes = np.linalg.norm(fields, axis=1)
    used = sizes > 0.0
    if np.sum(used) < len(AXES) - 1:
        return []
    # The error of a mean over all points.
    noise = np.array(field_map.residual)[used] / np.sqrt(np.array(field_map.points)[used])
    given = fields[used], np.array(AXES)[used], float(np.median(sizes[used])), float(noise.max())
    return [*_background(*given), *_turned(*given)]


def _background(fields: Array, axes: Indices, coil: float, noise: float) -> Iterator[Note]:
    """A note where the field of the surroundings is in that of each coil.

    At the centre a coil has no field across its axis, but by its mounting, which differs from coil
    to coil. A frame that is turned as a whole gives coils of two axes opposite fields.
    """
    across = np.ma.masked_array(fields, np.arange(3) == axes[:, None])
    common = across.mean(axis=0).data
    scatter = math.sqrt(np.sum((across - common) ** 2) / (across.count() - 3))
    size = float(np.linalg.norm(common))
    if size < max(_LEAST * coil, _COMMON * math.hypot(scatter, noise)):
        return
    vector = ", ".join(f"{1e6 * value:.1f}" for value in common)
    text = (
        f"coil.map: every coil has the field ({vector}) uT/A beside its own, "
        f"{size / coil:.2g} of it, as if the field without current, such as the Earth's, was not "
        "subtracted; subtract what the probe reads without current, then divide by the current"
    )
    yield Note("map-background", text, size)


def _turned(fields: Array, axes: Indices, coil: float, noise: float) -> Iterator[Note]:
    """A note where all fields are turned alike against their axes, by the rotation of Kabsch."""
    ways, along = fields / np.linalg.norm(fields, axis=1)[:, None], np.eye(3)[axes]
    left, _, right = np.linalg.svd(ways.T @ along)
    turn = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    axis = 0.5 * (turn - turn.T)[[2, 0, 1], [1, 2, 0]]
    sine = float(np.linalg.norm(axis))
    scatter = math.sqrt(np.sum((ways - along @ turn.T) ** 2) / (2 * len(axes) - 3))
    angle = math.degrees(math.asin(min(sine, 1.0)))
    if angle < _TURNED or sine < _COMMON * math.hypot(scatter, noise / coil):
        return
    axis *= angle / sine
    large = np.flatnonzero(np.abs(axis) > 0.1 * angle).tolist()
    about = " and ".join(f"{axis[k]:.2g} degrees about {'xyz'[k]}" for k in large)
    text = (
        f"coil.map: the fields of all coils at the centre are turned by {about} against their "
        "axes, as by a probe that is turned against the axes of its places; turn Bx, By, Bz back"
    )
    yield Note("map-turned", text, math.radians(angle))
