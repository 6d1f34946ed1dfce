"""Outlines of the body at chosen times, as in the paper's Fig. 2 (e) to (h)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from stickslip._util import palette
from stickslip._util.arrays import Array
from stickslip._util.messages import as_list, check_kind
from stickslip._util.picture import RC, Picture
from stickslip.plot import style
from stickslip.plot.motion import check_times, corners, lowest_corner, motion
from stickslip.simulation.run import Run

# Chosen by eye.
_MARGIN = 25.0  # µm, around the body
_SHEET = 5.8  # inches, width of the panels of a row
_TITLE = 0.3  # inches, of the title of a panel
_LABELS = (0.7, 0.8)  # inches, beside and below the panels, with the legend
_TRIANGLE = -9.0  # µm, height of the mark of the contact

_TOUCH: Any = {"marker": "^", "markersize": 7, "color": palette.VERMILION, "linestyle": "none"}
_BEFORE: Any = {"color": palette.VERMILION, "linestyle": "--", "linewidth": 1.1}
_MOMENT: Any = {"color": palette.BLACK, "linewidth": 1.4, "marker": ">", "markevery": [1]}


def filmstrip(
    run: Run,
    times: Sequence[float],
    labels: Sequence[str] | None = None,
    ax: Sequence[Axes] | None = None,
) -> Figure:
    """Draw the outline of the body at some times, one panel for each.

    The body is seen from its right, over the way along its heading. A triangle marks where it
    touches, or is lowest in flight; a dashed line where it did in the panel before. The arrow is
    the magnetic moment, which points to the front. All panels have the same scales. What is not
    listed here is that of `fields`.

    Parameters
    ----------
    times : sequence of float
        s; the nearest sample of each is drawn.
    labels : sequence of str, optional
        Title of each panel; the time, if not given.
    ax : sequence of matplotlib.axes.Axes, optional
        One for each time; those of a new figure, if not given.

    Raises
    ------
    ValueError
        If there is no time, one outside the record, or another number of `labels` or `ax`.
    """
    shown = motion(run)
    times = as_list("times", times, "a list of times, s")
    if not times:
        raise ValueError("times = []: allowed is a time or more")
    for time in times:
        check_times(times=time)
        if not shown.t[0] <= time <= shown.t[-1]:
            raise ValueError(
                f"times: {time} s is outside the record, {shown.t[0]:g} s to {shown.t[-1]:g} s"
            )
    for name, given in (("labels", labels), ("ax", ax)):
        if given is not None and len(as_list(name, given, "one for each time")) != len(times):
            raise ValueError(f"{name} has {len(given)} entries: allowed are {len(times)}")

    for axes in [] if ax is None else ax:
        check_kind("ax", axes, Axes)

    samples = [shown.sample(time) for time in times]
    titles = labels or [f"t = {shown.t[k]:.4f} s" for k in samples]
    outlines, touches = corners(shown)[samples] * 1e6, lowest_corner(shown)[samples] * 1e6
    low, high = outlines.min(axis=(0, 1)) - _MARGIN, outlines.max(axis=(0, 1)) + _MARGIN
    low[1] = -_MARGIN
    with matplotlib.rc_context(RC):
        panels = _new_panels(len(times), high - low) if ax is None else list(ax)
        for k, (axes, outline, title) in enumerate(zip(panels, outlines, titles, strict=True)):
            axes.axhline(0.0, color=palette.BLACK, linewidth=1.0)
            style.body(axes, outline)
            axes.plot(touches[k], _TRIANGLE, **_TOUCH)
            if k:
                axes.axvline(touches[k - 1], **_BEFORE)
            axes.set_title(title, loc="left")
            axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
            axes.grid(visible=False)
    return style.root_figure(panels[0])


def _new_panels(count: int, view: Array) -> list[Axes]:
    """Panels of the shape of a view, µm, with labels and a legend."""
    # Few places stay free, and the sheet is about square.
    columns = (
        count if count < 4 else min((2, 3, 4), key=lambda n: (-count % n, abs(n - count**0.5)))
    )
    rows = -(-count // columns)
    width = _SHEET / max(columns, 2)
    height = width * view[1] / view[0] + _TITLE
    figure = Picture(
        figsize=(columns * width + _LABELS[0], rows * height + _LABELS[1]), layout="compressed"
    )
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for free in grid.flat[count:]:
        free.remove()
    for k, column in enumerate(grid.T):  # the lowest panel of a column has the numbers
        lowest = column[(count - 1 - k) // columns]
        lowest.set_xlabel("way along the heading (µm)" if columns < 3 else "way (µm)")
        lowest.tick_params(labelbottom=True)
    for first in grid[:, 0]:
        first.set_ylabel("z (µm)")
    handles = [
        Line2D([], [], label="contact, or lowest corner", **_TOUCH),
        Line2D([], [], label="the same, one panel before", **_BEFORE),
        Line2D([], [], label="magnetic moment", **_MOMENT),
    ]
    if count == 1:
        del handles[1]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    return list(grid.flat[:count])
