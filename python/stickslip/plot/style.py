"""Colours and sizes that all figures share."""

from __future__ import annotations

from typing import Any

from stickslip._util import palette

# Faces behind or beside those: a shaded stretch, the body, a point without a value.
SHADE = "#F0F0F0"
BODY = "#E8EEF4"
NO_VALUE = "#BBBBBB"

FIELD = palette.GREEN

STICK, SLIP, FLIGHT = palette.BLUE, palette.ORANGE, palette.GREY
"""What the contact does; nothing else in a figure of a motion has these colours."""

CONTACT_COLOURS = {
    "flight": FLIGHT,
    "corner_stick": STICK,
    "corner_slip_forward": SLIP,
    "corner_slip_backward": palette.VERMILION,
    "face_stick": palette.SKY,
    "face_slip_forward": palette.YELLOW,
    "face_slip_backward": palette.PURPLE,
}

CONTACT_LABELS = {name: name.replace("_", " ") for name in CONTACT_COLOURS}


def contact_kind(mode: str) -> str:
    """Of a contact mode only whether it is stick, slip or flight."""
    return next(kind for kind in ("stick", "slip", "flight") if kind in mode)


RC: Any = {
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 10.0,
    "legend.fontsize": 8.0,
    "lines.linewidth": 1.2,
    "axes.grid": True,
    "grid.color": palette.LIGHT_GREY,
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
}
