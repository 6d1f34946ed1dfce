"""The path of a robot as seen from above, and beside it what its side view does on the way."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from stickslip._util import palette
from stickslip._util.arrays import Array, in_columns
from stickslip._util.messages import check_kind
from stickslip._util.picture import RC, Picture, legend_above
from stickslip.plot import style
from stickslip.plot.motion import Motion, footprint, motion
from stickslip.simulation.run import Run

# Parts of the larger side of what is shown; chosen by eye.
_ARROW = 0.09  # length of an arrow of the heading
_SPACING = 0.15  # from one arrow of the heading to the next
_MARGIN = 0.12  # around path and robot, in which the names of the coils stand

_COILS = {"xp": (0.975, 0.5), "xm": (0.025, 0.5), "yp": (0.5, 0.97), "ym": (0.5, 0.03)}
"""Where the coils lie, as parts of the axes."""


def path(
    run: Run,
    start: float | None = None,
    stop: float | None = None,
    ax: Axes | None = None,
    along: ArrayLike | None = None,
) -> Figure:
    """Draw the path of the robot as seen from above.

    Arrows at even distances show where the robot faces. Its outline is to scale, dashed at the
    first instant and filled at the last one; the arrow in it is its moment. The names at the edges
    say on which side the coils lie, which are far beyond. Beside it are the height of the centre of
    mass and the pitch over the way that it has gone along its heading. Lengths are in µm, or in mm
    where one is above 1000 µm. What is not listed here is that of `fields`.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw the view from above, without what is beside it; a new figure with both, if
        not given.
    along : array_like of shape (k, 2), optional
        Corners x and y of the path that was to be walked, m; drawn under the one that was.

    Raises
    ------
    ScenarioError
        If `along` is no path.
    """
    shown = motion(run).between(start, stop)
    wanted = np.empty((0, 2))
    if along is not None:
        wanted = in_columns("along", along, ("x", "y"), "shape (k, 2) of corners, m", axes=2)
    factor, unit = style.length(shown.x, shown.y, shown.way, wanted)
    with matplotlib.rc_context(RC):
        if ax is not None:
            check_kind("ax", ax, Axes)
            _draw_above(ax, shown, wanted, factor, unit)
            return style.root_figure(ax)
        figure = Picture(figsize=(8.6, 4.4), layout="constrained")
        panels = figure.subplot_mosaic(
            [["above", "height"], ["above", "pitch"]], width_ratios=[1.15, 1.0]
        )
        _draw_above(panels["above"], shown, wanted, factor, unit)
        height, pitch = panels["height"], panels["pitch"]
        look: Any = {"color": palette.BLACK, "linewidth": 0.9}
        up, up_unit = style.length(shown.z)
        height.plot(shown.way * factor, shown.z * up, **look)
        height.set_ylabel(f"height ({up_unit})")
        height.tick_params(labelbottom=False)
        pitch.plot(shown.way * factor, np.degrees(shown.theta), **look)
        pitch.set_ylabel(r"pitch $\theta$ (degrees)")
        pitch.set_xlabel(f"way along the heading ({unit})")
        for axes in (height, pitch):
            style.readable(axes, x=style.LEAST_SPAN)
    return figure


def heading_arrows(shown: Motion, factor: float) -> dict[int, tuple[Array, Array]]:
    """Arrows of the heading, m times a factor: sample, place at it, and tip.

    They stand at even distances, none on another one, and none near the last sample, where the
    robot is drawn with an arrow of its own.
    """
    places = np.column_stack([shown.x, shown.y])
    ends = [footprint(shown, k) for k in (0, -1)]
    span = float(np.ptp(np.concatenate([places, *ends]), axis=0).max())
    ahead = _ARROW * span * np.column_stack([np.cos(shown.heading), np.sin(shown.heading)])
    nearest = np.hypot(*(places - places[-1]).T)  # distance to the next arrow
    from_last = np.full_like(nearest, np.inf)
    arrows: dict[int, tuple[Array, Array]] = {}
    k = 0
    while True:
        free = (from_last[k:] >= _SPACING * span) & (nearest[k:] >= 0.5 * _SPACING * span)
        if not free.any():
            return arrows
        k += int(free.argmax())
        arrows[k] = factor * places[k], factor * (places[k] + ahead[k])
        from_last = np.hypot(*(places - places[k]).T)
        nearest = np.minimum(nearest, from_last)


def frame_from_above(axes: Axes, places: Array, unit: str) -> None:
    """Show places, shape (n, 2), at one scale, and at the edges what coils lie beyond them."""
    # The margin is part of the data: axes of equal scales would else take it for the other axis.
    margin = _MARGIN * np.ptp(places, axis=0).max()
    axes.update_datalim([places.min(axis=0) - margin, places.max(axis=0) + margin])
    axes.margins(0.0)
    axes.set_aspect("equal", adjustable="datalim")
    axes.autoscale_view()
    axes.set_xlabel(f"x ({unit})")
    axes.set_ylabel(f"y ({unit})")
    style.readable(axes, y=0.0)
    look: Any = {"color": palette.DARK_GREY, "fontsize": 7.5, "ha": "center", "va": "center"}
    for name, place in _COILS.items():
        rotation = 90.0 if name.startswith("x") else 0.0
        axes.text(*place, f"coil {name}", transform=axes.transAxes, rotation=rotation, **look)


def _draw_above(axes: Axes, shown: Motion, wanted: Array, factor: float, unit: str) -> None:
    places = np.column_stack([shown.x, shown.y]) * factor
    first, last = (footprint(shown, k) * factor for k in (0, -1))
    look: Any = {"linewidth": 0.9, "label": "centre of mass"}
    handles = axes.plot(*places.T, color=palette.BLACK, **look)
    look = {"marker": "o", "markersize": 4.5, "linestyle": "none", "label": "start"}
    handles = axes.plot(*places[:1].T, color=palette.VERMILION, **look) + handles
    axes.fill(*first.T, fill=False, linestyle="--", linewidth=0.9, edgecolor=palette.BLACK)
    style.body(axes, last)[0].set_zorder(1.0)  # the path is seen in it
    for begin, tip in heading_arrows(shown, factor).values():
        style.arrow(axes, begin, tip, palette.DARK_GREY)
    look = {"color": palette.DARK_GREY, "linewidth": 1.4, "marker": ">", "markevery": [1]}
    handles.append(Line2D([], [], label="heading", **look))
    if wanted.size:
        look = {"color": palette.PURPLE, "linewidth": 2.6, "zorder": 0.8, "label": "wanted"}
        handles += axes.plot(*(wanted * factor).T, **look)
    frame_from_above(axes, np.concatenate([first, last, places, wanted * factor]), unit)
    legend_above(axes, handles, columns=2 if wanted.size else 3)
