"""The parts of the scene of a moving picture: the side view, the view from above, and the field."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon
from matplotlib.ticker import FuncFormatter

from stickslip._util import palette
from stickslip.plot import style
from stickslip.plot.above import frame_from_above, heading_arrows
from stickslip.plot.film import body_arrow, frame, thin_arrow
from stickslip.plot.motion import Array, Motion, corners, footprint, lowest_corner
from stickslip.plot.scales import length, length_bar

_MARGIN = 30.0  # µm; chosen by eye
# The least part of the width that the body's diagonal takes: a picture of a longer way moves with
# the body. Chosen by eye.
_LEAST_SHARE = 0.3


_START: Any = {"color": palette.VERMILION, "marker": "o", "markersize": 4.5, "linestyle": "none"}


def start_handle() -> Line2D:
    """What the point means at which the path begins."""
    return Line2D([], [], label="start", **_START)


class Part(Protocol):
    """What moves from sample to sample."""

    def show(self, sample: int) -> None:
        """Move all to where it is at one sample."""


class SideView:
    """The body on the surface, in the plane in which it rocks.

    Lengths are in µm; the numbers beside the surface are in mm where one is above 1000 µm.

    Attributes
    ----------
    shape : float
        Height of the view over its width.
    """

    def __init__(self, shown: Motion) -> None:
        self._motion = shown
        self._touch = lowest_corner(shown) * 1e6
        diagonal = float(np.hypot(shown.length, shown.height)) * 1e6
        along = shown.along * 1e6
        way = float(along.max() - along.min()) + diagonal + 2.0 * _MARGIN
        self._width = min(way, diagonal / _LEAST_SHARE)
        self._follows = self._width < way
        self._middle = 0.5 * float(along.max() + along.min())
        # A length scale stands above the highest body.
        self._top = float((shown.z * 1e6).max()) + 0.5 * diagonal + 2.0 * _MARGIN
        self.shape = (self._top + _MARGIN) / self._width

    def draw(self, axes: Axes) -> None:
        """Draw what `show` moves, and what stays."""
        self._axes = axes
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
        scale = length(self._motion.along)
        if scale.unit == "mm":
            axes.xaxis.set_major_formatter(FuncFormatter(lambda micron, _: f"{micron * 1e-3:g}"))
        axes.set_xlabel(f"{self._motion.along_name} ({scale.unit})")
        axes.set_ylabel("z (µm)")
        length_bar(axes, self._width)

    def show(self, sample: int) -> None:
        shown = self._motion
        outline = corners(shown, sample) * 1e6
        self._body.set_xy(outline)
        self._moment.set_positions(*body_arrow(outline))
        self._mark.set_data([self._touch[sample]], [-9.0])
        middle = float(shown.along[sample]) * 1e6 if self._follows else self._middle
        half = 0.5 * self._width
        frame(self._axes, (middle - half, middle + half), (-_MARGIN, self._top))
        self._axes.set_title(
            f"t = {shown.t[sample] * 1e3:.1f} ms, "
            f"tilt {np.degrees(shown.theta[sample]):.1f} degrees",
            loc="left",
        )


class ViewFromAbove:
    """The path so far, with arrows of the heading, and the body on it; in µm or mm."""

    def __init__(self, axes: Axes, shown: Motion) -> None:
        self._motion, self._axes = shown, axes
        scale = length(np.concatenate([shown.x, shown.y]))
        self._factor = scale.factor
        self._x, self._y = shown.x * scale.factor, shown.y * scale.factor
        (self._path,) = axes.plot([], [], color=palette.BLACK, linewidth=0.9)
        axes.plot(self._x[:1], self._y[:1], **_START)
        self._body = Polygon(
            np.zeros((4, 2)), facecolor=style.BODY, edgecolor=palette.BLACK, linewidth=1.2
        )
        axes.add_patch(self._body)
        self._arrows = {}
        for sample, (begin, tip) in heading_arrows(shown, scale.factor).items():
            arrow = self._arrows[sample] = thin_arrow(palette.BLUE, 1.4)
            arrow.set_positions(begin, tip)
            axes.add_patch(arrow)
        self._moment = thin_arrow(palette.BLUE, 1.4)
        axes.add_patch(self._moment)
        # The body stays in the view however it is turned.
        reach = 0.5 * float(np.linalg.norm([shown.length, shown.width, shown.height]))
        path = np.column_stack([self._x, self._y])
        around = reach * self._factor * np.array([[-1.0, -1.0], [1.0, 1.0]])
        places = np.concatenate([path.min(axis=0) + around[:1], path.max(axis=0) + around[1:]])
        frame_from_above(axes, places, scale.unit)

    def show(self, sample: int) -> None:
        outline = footprint(self._motion, sample) * self._factor
        self._path.set_data(self._x[: sample + 1], self._y[: sample + 1])
        self._body.set_xy(outline)
        self._moment.set_positions(*body_arrow(outline))
        for passed, arrow in self._arrows.items():
            arrow.set_visible(passed <= sample)
        heading = np.degrees(self._motion.heading[sample])
        self._axes.set_title(f"from above, heading {heading:.1f} degrees", loc="left")


class FieldPanel:
    """The arrow of a part of the field, in a circle for the strongest, and its strength.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    field : numpy.ndarray, shape (n, 2)
        Field towards the right and upwards in the picture, T.
    title : str
    """

    def __init__(self, axes: Axes, field: Array, title: str) -> None:
        self._field = field
        self._strongest = float(np.hypot(*field.T).max())
        edge: Any = {"facecolor": "none", "edgecolor": palette.GREY}
        axes.add_patch(Circle((0.0, 0.0), 1.0, linewidth=0.8, **edge))
        self._arrow = thin_arrow(palette.GREEN, 1.8)
        axes.add_patch(self._arrow)
        axes.set_xlim(-1.15, 1.15)
        axes.set_ylim(-1.15, 1.15)
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.set_title(title, color=palette.GREEN)
        size: Any = {"ha": "center", "va": "top", "fontsize": 9.0}
        self._strength = axes.text(0.0, -1.25, "", color=palette.GREEN, **size)
        largest = f"circle: {self._strongest * 1e3:.2f} mT"
        axes.text(0.0, -1.7, largest, color=palette.DARK_GREY, **size)

    def show(self, sample: int) -> None:
        field = self._field[sample]
        self._arrow.set_positions((0.0, 0.0), tuple(field / (self._strongest or 1.0)))
        self._strength.set_text(f"{np.hypot(*field) * 1e3:.2f} mT")
