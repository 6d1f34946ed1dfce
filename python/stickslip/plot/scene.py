"""The scene of a moving picture: the body on the surface, and the field beside it as an arrow."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Circle, FancyArrowPatch, Polygon
from matplotlib.text import Text

from stickslip._util import palette
from stickslip.plot import style
from stickslip.plot.film import body_arrow, frame, mark_handles
from stickslip.plot.motion import Motion, corners, lowest_corner
from stickslip.plot.scales import length_bar

_WIDTH = 6.4  # inches
_FIELD_WIDTH = 1.3  # inches, of the panel of the field
_BESIDE, _BELOW = 0.8, 1.1  # inches, of the labels beside the surface, and above and below it
_MARGIN = 30.0  # µm; chosen by eye
# The least part of the width that the body's diagonal takes: a picture of a longer way moves with
# the body. Chosen by eye.
_LEAST_SHARE = 0.3


class Scene:
    """One figure, whose artists are moved from sample to sample.

    Attributes
    ----------
    figure : matplotlib.figure.Figure
    """

    def __init__(self, shown: Motion) -> None:
        self._motion = shown
        self._touch = lowest_corner(shown) * 1e6
        diagonal = float(np.hypot(shown.length, shown.height)) * 1e6
        x = shown.x * 1e6
        way = float(x.max() - x.min()) + diagonal + 2.0 * _MARGIN
        self._width = min(way, diagonal / _LEAST_SHARE)
        self._follows = self._width < way
        self._middle = 0.5 * float(x.max() + x.min())
        # A length scale stands above the highest body.
        self._top = float((shown.z * 1e6).max()) + 0.5 * diagonal + 2.0 * _MARGIN
        across = _WIDTH - _FIELD_WIDTH - _BESIDE
        height = across * (self._top + _MARGIN) / self._width + _BELOW
        # A title of axes of equal scales is else cut at its upper end.
        layout = ConstrainedLayoutEngine(rect=(0.0, 0.0, 1.0, 0.98))
        self.figure = Figure(figsize=(_WIDTH, max(height, 2.4)), layout=layout)
        self._axes, field = self.figure.subplots(
            1, 2, width_ratios=[_WIDTH - _FIELD_WIDTH, _FIELD_WIDTH]
        )
        self._draw_surface()
        self._strongest = float(np.hypot(shown.bx, shown.bz).max())
        self._field, self._strength = _field_panel(field, self._strongest)
        self.show(0)
        # Where it all stands is the same throughout, and found in two steps: axes of equal scales
        # get their shape in the first one.
        for _ in range(2):
            self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")

    def _draw_surface(self) -> None:
        axes = self._axes
        axes.axhline(0.0, color=palette.BLACK, linewidth=1.0)
        face: Any = {"facecolor": style.BODY, "edgecolor": palette.BLACK}
        self._body = Polygon(np.zeros((4, 2)), linewidth=1.2, **face)
        axes.add_patch(self._body)
        self._moment = thin_arrow(palette.BLUE, 1.4)
        axes.add_patch(self._moment)
        (self._mark,) = axes.plot(
            [], [], marker="^", markersize=7, color=palette.VERMILION, linestyle="none"
        )
        axes.axvline(float(self._touch[0]), color=palette.VERMILION, linestyle="--", linewidth=1.1)
        axes.set_xlabel("x (µm)")
        axes.set_ylabel("z (µm)")
        length_bar(axes, self._width)
        handles = mark_handles(before="contact at the start")
        self.figure.legend(
            handles=handles, loc="outside lower center", ncols=len(handles), frameon=False
        )

    def show(self, sample: int) -> None:
        """Move all to where it is at one sample."""
        shown = self._motion
        outline = corners(shown, sample) * 1e6
        self._body.set_xy(outline)
        self._moment.set_positions(*body_arrow(outline))
        self._mark.set_data([self._touch[sample]], [-9.0])
        middle = float(shown.x[sample]) * 1e6 if self._follows else self._middle
        half = 0.5 * self._width
        frame(self._axes, (middle - half, middle + half), (-_MARGIN, self._top))
        self._axes.set_title(
            f"t = {shown.t[sample] * 1e3:.1f} ms, "
            f"tilt {np.degrees(shown.theta[sample]):.1f} degrees",
            loc="left",
        )
        field = np.array([shown.bx[sample], shown.bz[sample]])
        self._field.set_positions((0.0, 0.0), tuple(field / (self._strongest or 1.0)))
        self._strength.set_text(f"{np.hypot(*field) * 1e3:.2f} mT")


def thin_arrow(colour: str, width: float) -> FancyArrowPatch:
    """An arrow from the origin to itself, to be given its ends."""
    return FancyArrowPatch(
        (0.0, 0.0),
        (0.0, 0.0),
        arrowstyle="->",
        mutation_scale=10.0,
        color=colour,
        linewidth=width,
        shrinkA=0.0,
        shrinkB=0.0,
    )


def _field_panel(axes: Axes, strongest: float) -> tuple[FancyArrowPatch, Text]:
    """The arrow of the field in the plane of motion, in a circle for the strongest, and its text.

    Lengths are parts of the strongest field, T.
    """
    axes.add_patch(Circle((0.0, 0.0), 1.0, facecolor="none", edgecolor=palette.GREY, linewidth=0.8))
    arrow = thin_arrow(palette.GREEN, 1.8)
    axes.add_patch(arrow)
    axes.set_xlim(-1.15, 1.15)
    axes.set_ylim(-1.15, 1.15)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title("field $B$", color=palette.GREEN)
    size: Any = {"ha": "center", "va": "top", "fontsize": 9.0}
    strength = axes.text(0.0, -1.25, "", color=palette.GREEN, **size)
    axes.text(0.0, -1.7, f"circle: {strongest * 1e3:.2f} mT", color=palette.DARK_GREY, **size)
    return arrow, strength
