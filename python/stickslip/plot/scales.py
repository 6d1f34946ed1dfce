"""Axes whose numbers can be read: no offsets, no empty spans, lengths in µm or mm; a bar of one."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import ScalarFormatter
from numpy.typing import NDArray

from stickslip._util import palette

_MOST_MICRONS = 1000.0  # a number of four digits is read sooner in mm

# Smaller spans are those of a robot that stands still, or of rounding; in the units shown. Chosen:
# far below what any motion shows.
LEAST_FIELD = 1e-2  # mT
LEAST_TILT = 0.1  # degrees
LEAST_HEADING = 1.0  # degrees; the heading is that of the field within a tenth
LEAST_VELOCITY = 1e-3  # mm/s
LEAST_LENGTH = 0.1  # µm
LEAST_FORCE = 1e-2  # µN
LEAST_RATE = 0.1  # rad/s


# Longest bar of a length scale, as a part of the width that is drawn; chosen by eye.
_LONGEST_BAR = 0.25


class Length(NamedTuple):
    """How lengths are shown: the factor from m, the unit, and the least span of an axis."""

    factor: float
    unit: str
    least: float


def length(metres: NDArray[np.float64]) -> Length:
    """µm, or mm where one of the lengths is above 1000 µm."""
    farthest = float(np.abs(metres).max()) * 1e6
    if farthest > _MOST_MICRONS:
        return Length(1e3, "mm", LEAST_LENGTH * 1e-3)
    return Length(1e6, "µm", LEAST_LENGTH)


def readable(axes: Axes, *, x: float | None = None, y: float | None = None) -> None:
    """Plain numbers beside the ticks, and a span of at least `x` and `y` where they are given."""
    for axis in (axes.xaxis, axes.yaxis):
        formatter = axis.get_major_formatter()
        if isinstance(formatter, ScalarFormatter):
            formatter.set_useOffset(False)
            formatter.set_scientific(False)
    if x is not None:
        axes.set_xlim(_widened(*axes.get_xlim(), x))
    if y is not None:
        axes.set_ylim(_widened(*axes.get_ylim(), y))


def _widened(low: float, high: float, least: float) -> tuple[float, float]:
    missing = least - (high - low)
    return (low, high) if missing <= 0.0 else (low - 0.5 * missing, high + 0.5 * missing)


def length_bar(axes: Axes, width: float, height: float = 0.93) -> None:
    """A bar of a round length at the upper left of axes whose width is `width`, µm.

    `height` is a part of that of the axes.
    """
    longest = _LONGEST_BAR * width
    decade = 10.0 ** np.floor(np.log10(longest))
    bar = max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= longest)
    part = bar / width
    left = 0.03
    look: Any = {"transform": axes.transAxes, "color": palette.BLACK}
    axes.add_line(Line2D([left, left + part], [height, height], linewidth=2.5, **look))
    axes.annotate(
        f"{bar:g} µm",
        (left + part, height),
        xycoords="axes fraction",
        xytext=(5.0, 0.0),
        textcoords="offset points",
        va="center",
        fontsize=8.5,
    )
