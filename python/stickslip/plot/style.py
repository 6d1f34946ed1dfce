"""Shared by all pictures: colours, new axes, readable numbers and files."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from os import PathLike
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon
from matplotlib.ticker import ScalarFormatter

from stickslip._util import palette
from stickslip._util.arrays import Array
from stickslip._util.files import check_suffix, replacing
from stickslip._util.messages import check_kind
from stickslip._util.picture import RC, Picture

# Faces behind or beside those: a shaded stretch, the body, a point without a value.
SHADE = "#F0F0F0"
BODY = "#E8EEF4"
NO_VALUE = "#BBBBBB"

FIELD = palette.GREEN

CONTACT_COLOURS = {
    "flight": palette.GREY,
    "corner_stick": palette.BLUE,
    "corner_slip_forward": palette.ORANGE,
    "corner_slip_backward": palette.VERMILION,
    "face_stick": palette.SKY,
    "face_slip_forward": palette.YELLOW,
    "face_slip_backward": palette.PURPLE,
}

KIND_COLOURS = {"stick": palette.BLUE, "slip": palette.ORANGE, "flight": palette.GREY}
"""Where the direction of a slip, and corner or face, are not told apart."""

_DOTS_PER_INCH = 150  # legible in print at half the width of a page
_LEAST_PLAIN = 1e-3  # smaller numbers are shown as powers of ten
_MOST_MICRONS = 1000.0  # a number of four digits is read sooner in mm

LEAST_SPAN = 0.01
"""Least range of an axis in the unit shown: rounding gives a robot at rest a smaller one."""


def length(*metres: Array) -> tuple[float, str]:
    """Factor and unit in which lengths are shown: µm, or mm where one is above 1000 µm."""
    farthest = max(float(np.abs(values).max(initial=0.0)) for values in metres)
    return (1e3, "mm") if farthest * 1e6 > _MOST_MICRONS else (1e6, "µm")


def readable(axes: Axes, *, x: float = 0.0, y: float = LEAST_SPAN) -> None:
    """Plain numbers beside the ticks, and a span of at least `x` and `y`."""
    for axis, least in ((axes.xaxis, x), (axes.yaxis, y)):
        low, high = axis.get_view_interval()
        missing = least - (high - low)
        if missing > 0.0:
            axis.set_view_interval(low - 0.5 * missing, high + 0.5 * missing, ignore=True)
        formatter = axis.get_major_formatter()
        if not isinstance(formatter, ScalarFormatter):
            continue
        if max(abs(low), abs(high)) < _LEAST_PLAIN:
            axis.set_major_formatter("{x:g}")
        else:
            formatter.set_useOffset(False)
            formatter.set_scientific(False)


@contextlib.contextmanager
def drawing(ax: Axes | None, size: tuple[float, float]) -> Iterator[Axes]:
    """The axes `ax`, or those of a new figure of a size in inches, to draw in with this style."""
    if ax is not None:
        check_kind("ax", ax, Axes)
    with matplotlib.rc_context(RC):
        yield ax or Picture(figsize=size, layout="constrained").subplots()


def root_figure(axes: Axes) -> Figure:
    """The figure that holds some axes, also where they are part of a subfigure."""
    root: Figure = axes.figure.figure
    return root


def arrow(
    axes: Axes, begin: Any, tip: Any, colour: str, width: float = 1.4, zorder: float = 2.5
) -> FancyArrowPatch:
    """Draw an arrow, above lines and below a body."""
    look: Any = {"arrowstyle": "->", "mutation_scale": 10.0, "shrinkA": 0.0, "shrinkB": 0.0}
    drawn = FancyArrowPatch(begin, tip, color=colour, linewidth=width, zorder=zorder, **look)
    axes.add_patch(drawn)
    return drawn


def body(axes: Axes, outline: Array, width: float = 1.2) -> tuple[Polygon, FancyArrowPatch]:
    """Draw a body with four corners, shape (4, 2), front first and last, and its moment."""
    face: Any = {"facecolor": BODY, "edgecolor": palette.BLACK, "linewidth": width}
    drawn = Polygon(outline, closed=True, zorder=3.0, **face)
    axes.add_patch(drawn)
    return drawn, arrow(axes, *_moment(outline), palette.BLACK, zorder=3.1)


def move_body(drawn: tuple[Polygon, FancyArrowPatch], outline: Array) -> None:
    """Give a drawn body another outline."""
    drawn[0].set_xy(outline)
    drawn[1].set_positions(*_moment(outline))


def _moment(outline: Array) -> tuple[Any, Any]:
    """Begin and tip of the arrow of the moment."""
    centre = outline.mean(axis=0)
    towards = 0.5 * (outline[0] + outline[3]) - centre
    return centre - 0.35 * towards, centre + 0.75 * towards


def check_format(path: str | PathLike[str]) -> None:
    """Raise a ValueError for a name whose suffix is no format of pictures; it names those."""
    formats = FigureCanvasBase.get_supported_filetypes()
    check_suffix(path, tuple(f".{ending}" for ending in sorted(formats)))


def save(figure: Figure, path: str | PathLike[str]) -> None:
    """Write a figure, whole or not at all, in the format that the path's suffix names.

    Raises
    ------
    ValueError
        If the suffix is no format of pictures.
    OSError
        If the file cannot be written; an older file of that name is then untouched.
    """
    check_kind("figure", figure, Figure)
    check_format(path)
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=_DOTS_PER_INCH)
