"""Outlines of the body at chosen times, as in the paper's Fig. 2 (e) to (h)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Polygon

from stickslip._util import palette
from stickslip._util.picture import Picture
from stickslip.plot import style
from stickslip.plot.canvas import root_figure
from stickslip.plot.motion import Array, Data, Motion, corners, lowest_corner, motion

_MARGIN = 25.0  # µm; chosen by eye
_SHEET = 5.8  # inches, width of the panels of a row; chosen by eye
_BESIDE, _ABOVE = 0.7, 0.3  # inches, of the labels beside a row and of the title above a panel
_BELOW, _LEGEND = 0.5, 0.3  # inches, of the labels below the last row, and of a legend there


Point: TypeAlias = "tuple[float, float]"
View: TypeAlias = "tuple[tuple[float, float], tuple[float, float]]"
"""Ends of the stretch of surface and of the height that are shown, µm."""


def filmstrip(
    data: Data,
    times: Sequence[float],
    labels: Sequence[str] | None = None,
    ax: Sequence[Axes] | None = None,
) -> Figure:
    """Draw the outline of the body at some times, one panel for each.

    A triangle marks where the body touches, or is lowest in flight; a dashed line where it was in
    the panel before. The arrow is the moment, which points to the front. The panels of a new figure
    share their scales and have the shape of what they show, so that they fill its sheet; its legend
    stands in a place that they leave free, or below them. A robot that leaves its plane is seen
    from its right, over the way that it has gone along its heading.

    Parameters
    ----------
    data : Run or xarray.Dataset
        A run with a record on a uniform grid, or what its `to_xarray` gave.
    times : sequence of float
        s; the nearest sample of each is drawn.
    labels : sequence of str, optional
        Title of each panel; the time, if not given.
    ax : sequence of matplotlib.axes.Axes, optional
        One for each time; those of a new figure, if not given.

    Returns
    -------
    matplotlib.figure.Figure
        The one that holds the axes.

    Raises
    ------
    AttributeError
        If a run has no record.
    ValueError
        If there is no time, one outside the record, or another number of `labels` or `ax`.
    """
    shown = motion(data)
    if not times:
        raise ValueError("times = []: allowed is a time or more")
    for time in times:
        if not shown.t[0] <= time <= shown.t[-1]:
            raise ValueError(
                f"times: {time} s is outside the record, {shown.t[0]:g} s to {shown.t[-1]:g} s"
            )
    for name, given in (("labels", labels), ("ax", ax)):
        if given is not None and len(given) != len(times):
            raise ValueError(f"{name} has {len(given)} entries: allowed are {len(times)}")

    samples = [shown.sample(time) for time in times]
    view = _common_view(shown, samples)
    with matplotlib.rc_context(style.RC):
        panels = _new_panels(len(times), view, shown.along_name) if ax is None else list(ax)
        touch = lowest_corner(shown)[samples] * 1e6
        titles = labels or [f"t = {shown.t[k]:.4f} s" for k in samples]
        for place, (axes, sample, title) in enumerate(zip(panels, samples, titles, strict=True)):
            draw_body(axes, shown, sample)
            mark_contact(axes, float(touch[place]), float(touch[place - 1]) if place else None)
            axes.set_title(title, loc="left")
            frame(axes, *view)
    return root_figure(panels[0])


def _common_view(motion: Motion, samples: Sequence[int]) -> View:
    """The stretch of surface and height that holds the body at all samples."""
    x, z = np.moveaxis(np.stack([corners(motion, k) for k in samples]) * 1e6, 2, 0)
    return (x.min() - _MARGIN, x.max() + _MARGIN), (-_MARGIN, z.max() + _MARGIN)


def _columns(count: int) -> int:
    """How many panels stand side by side: few places stay free, and the sheet is about square."""
    if count < 4:
        return count
    return min((2, 3, 4), key=lambda columns: (-count % columns, abs(columns - count**0.5)))


def _new_panels(count: int, view: View, along: str) -> list[Axes]:
    """Panels of the shape of a view, with the labels of a sheet and a legend."""
    columns = _columns(count)
    rows = -(-count // columns)
    (left, right), (low, high) = view
    width = _SHEET / max(columns, 2)
    height = width * (high - low) / (right - left) + _ABOVE
    full = columns * rows == count
    below = _BELOW + (_LEGEND if full else 0.0)
    size = (columns * width + _BESIDE, rows * height + below)
    figure = Picture(figsize=size, layout="compressed")
    panels = [figure.add_subplot(rows, columns, k + 1) for k in range(count)]
    for k, axes in enumerate(panels):
        # All panels have the same numbers, which stand beside the rows and below the last one.
        last, first = k >= columns * (rows - 1), k % columns == 0
        axes.tick_params(labelbottom=last, labelleft=first)
        axes.set_xlabel(f"{along} (µm)" if last else "")
        axes.set_ylabel("z (µm)" if first else "")
    handles = mark_handles("the same, one panel before" if count > 1 else None)
    if full:
        figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    else:
        free = figure.add_subplot(rows, columns, count + 1)
        free.set_axis_off()
        free.legend(handles=handles, loc="center", frameon=False)
    return panels


def mark_handles(before: str | None) -> list[Artist]:
    """What the marks of a panel mean; `before` says which contact the dashed line is, if any."""
    touch = Line2D([], [], marker="^", markersize=7, color=palette.VERMILION, linestyle="none")
    touch.set_label("contact, or lowest corner")
    dashed = Line2D([], [], color=palette.VERMILION, linestyle="--", linewidth=1.1)
    dashed.set_label(before or "")
    moment = Line2D([], [], color=palette.BLACK, linewidth=1.4, marker=">", markevery=[1])
    moment.set_label("magnetic moment")
    return [touch, dashed, moment] if before else [touch, moment]


def draw_body(axes: Axes, motion: Motion, sample: int) -> None:
    """The outline, the surface and the moment at one sample, in µm."""
    outline = corners(motion, sample) * 1e6
    axes.axhline(0.0, color=palette.BLACK, linewidth=1.0)
    axes.add_patch(
        Polygon(outline, closed=True, facecolor=style.BODY, edgecolor=palette.BLACK, linewidth=1.2)
    )
    start, tip = body_arrow(outline)
    look = {"arrowstyle": "->", "color": palette.BLACK, "linewidth": 1.4}
    axes.annotate("", xy=tip, xytext=start, arrowprops=look)


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


def body_arrow(outline: Array) -> tuple[Point, Point]:
    """Begin and tip of the arrow of the moment in a body with four corners, shape (4, 2)."""
    front = 0.5 * (outline[0] + outline[3])
    centre = outline.mean(axis=0)
    towards = front - centre
    (x0, z0), (x1, z1) = (centre - 0.35 * towards).tolist(), (centre + 0.75 * towards).tolist()
    return (x0, z0), (x1, z1)


def mark_contact(axes: Axes, here: float, before: float | None) -> None:
    """Where the body touches, and where it did before, in µm."""
    axes.plot([here], [-9.0], marker="^", markersize=7, color=palette.VERMILION, linestyle="none")
    if before is not None:
        axes.axvline(before, color=palette.VERMILION, linestyle="--", linewidth=1.1)


def frame(axes: Axes, x: tuple[float, float], z: tuple[float, float]) -> None:
    """The stretch of surface and height that is shown, in µm, at one scale."""
    axes.set_xlim(x)
    axes.set_ylim(z)
    axes.set_aspect("equal", adjustable="box")
    axes.grid(visible=False)
