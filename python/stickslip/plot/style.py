"""Colours and sizes that all figures share."""

from __future__ import annotations

from typing import Any

from stickslip._util import palette

# Faces behind or beside those: a shaded stretch, the body, a point without a value.
SHADE = "#F0F0F0"
BODY = "#E8EEF4"
NO_VALUE = "#BBBBBB"

CONTACT_COLOURS = {
    "flight": "#FFFFFF",
    "corner_stick": palette.BLUE,
    "corner_slip_forward": palette.ORANGE,
    "corner_slip_backward": palette.VERMILION,
    "face_stick": palette.SKY,
    "face_slip_forward": palette.YELLOW,
    "face_slip_backward": palette.PURPLE,
}

CONTACT_LABELS = {name: name.replace("_", " ") for name in CONTACT_COLOURS}

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

# White, which is flight's in a band of colours, is no line, and yellow next to none.
LINE_COLOURS = {**CONTACT_COLOURS, "flight": palette.GREY, "face_slip_forward": palette.GREEN}
