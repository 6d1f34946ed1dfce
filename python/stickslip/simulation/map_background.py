"""Whether a measured field map has the field of its surroundings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from stickslip import _core
from stickslip._util.note import Note
from stickslip.field.coils import AXES

if TYPE_CHECKING:
    from stickslip.field.field_map import FieldMap

_LEAST = 0.01
"""Part of the coils' field below which a background is not noted: 10 uT at 1 A in those of Table
I."""

_COMMON = 5.0
"""Ratio of a background to its scatter among coils from which on it is common. Chosen: of coils
turned each on its own by chance, 3 sets of five in 10 000 have that, and 3 sets of four in 1000."""


def background(field_map: FieldMap) -> list[Note]:
    """A note where the field of the surroundings is in that of each coil.

    At the centre a coil has no field across its axis, but by its mounting, which differs from coil
    to coil. A frame that is turned as a whole gives coils of two axes opposite fields.
    """
    made = _core.Scenario()
    made.set_map(field_map.to_core())
    fields = made.coils().field(np.zeros((len(AXES), 3)), np.eye(len(AXES)))
    sizes = np.linalg.norm(fields, axis=1)
    used = sizes > 0.0
    if np.sum(used) < len(AXES) - 1:
        return []
    along = np.arange(3) == np.array(AXES)[:, None]
    across = np.ma.masked_array(fields, along | ~used[:, None])
    common = across.mean(axis=0).data
    scatter = math.sqrt(np.sum((across - common) ** 2) / (across.count() - 3))
    # The error of a mean over all points.
    noise = np.max(np.array(field_map.residual)[used] / np.sqrt(np.array(field_map.points)[used]))
    size, coil = float(np.linalg.norm(common)), float(np.median(sizes[used]))
    if size < max(_LEAST * coil, _COMMON * math.hypot(scatter, noise)):
        return []
    vector = ", ".join(f"{1e6 * value:.1f}" for value in common)
    text = (
        f"coil.map: every coil has the field ({vector}) uT/A beside its own, "
        f"{size / coil:.2g} of it, as if the field without current, such as the Earth's, was not "
        "subtracted; subtract what the probe reads without current, then divide by the current"
    )
    return [Note("map-background", text, size)]
