"""Colours and sizes that all figures share."""

from __future__ import annotations

from typing import Any

from stickslip._util.palette import (
    BLUE,
    GREEN,
    GREY,
    LIGHT_GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    YELLOW,
)

# Faces behind or beside those: a shaded stretch, the body, a point without a value.
SHADE = "#F0F0F0"
BODY = "#E8EEF4"
NO_VALUE = "#BBBBBB"

CONTACT_COLOURS = {
    "flight": "#FFFFFF",
    "corner_stick": BLUE,
    "corner_slip_forward": ORANGE,
    "corner_slip_backward": VERMILION,
    "face_stick": SKY,
    "face_slip_forward": YELLOW,
    "face_slip_backward": PURPLE,
}

CONTACT_LABELS = {name: name.replace("_", " ") for name in CONTACT_COLOURS}

RC: Any = {
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 10.0,
    "legend.fontsize": 8.0,
    "lines.linewidth": 1.2,
    "axes.grid": True,
    "grid.color": LIGHT_GREY,
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
}

# White, which is flight's in a band of colours, is no line, and yellow next to none.
LINE_COLOURS = {**CONTACT_COLOURS, "flight": GREY, "face_slip_forward": GREEN}
