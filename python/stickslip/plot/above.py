"""The path of a robot as seen from above, and beside it what its side view does on the way."""

from __future__ import annotations

from typing import Any, Protocol

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike

from stickslip._util import palette
from stickslip._util.messages import refuse
from stickslip._util.picture import Picture
from stickslip.plot import style
from stickslip.plot.canvas import legend_above, root_figure
from stickslip.plot.film import Point, body_arrow, thin_arrow
from stickslip.plot.motion import Array, Data, Motion, footprint, motion
from stickslip.plot.scales import LEAST_TILT, Length, length, readable

# Parts of the larger side of what is shown; chosen by eye.
_ARROW = 0.09  # length of an arrow of the heading
_SPACING = 0.15  # from one arrow of the heading to the next
_MARGIN = 0.12  # around path and robot, in which the names of the coils stand

_COILS = {"xp": (0.975, 0.5), "xm": (0.025, 0.5), "yp": (0.5, 0.97), "ym": (0.5, 0.03)}
"""Where the coils lie, as parts of the axes."""


class Polyline(Protocol):
    """What a picture needs of a `stickslip.control.Path`."""

    points: Array


def path(
    data: Data,
    start: float | None = None,
    stop: float | None = None,
    ax: Axes | None = None,
    along: Polyline | ArrayLike | None = None,
) -> Figure:
    """Draw the path of the robot as seen from above, and its height and tilt on the way.

    Arrows at even distances show where the robot faces. Its outline is to scale, dashed at the
    first instant and filled at the last one; the arrow in it is its moment. The names at the edges
    say on which side the coils lie, which are far beyond. Beside it are the height of the centre of
    mass and the tilt over the way that it has gone along its heading, which goes back where the
    robot does. A robot that stays in its plane has a straight path along x.

    Parameters
    ----------
    data : Run or xarray.Dataset
        A run with a record on a uniform grid, or what its `to_xarray` gave.
    start, stop : float, optional
        Stretch of time to draw, s; all of it, if not given.
    ax : matplotlib.axes.Axes, optional
        Where to draw the view from above, without what is beside it; a new figure with both, if
        not given.
    along : stickslip.control.Path or array_like of shape (k, 2), optional
        The path that was to be walked, or its corners, x and y in m; drawn under the one that was.

    Returns
    -------
    matplotlib.figure.Figure
        The one that holds the axes. Lengths are in µm, or in mm where one is above 1000 µm.

    Raises
    ------
    AttributeError
        If a run has no record.
    ValueError
        If the record is one of events, or has less than two samples from `start` to `stop`, or if
        `along` is no path.
    """
    shown = motion(data).between(start, stop)
    wanted = np.empty((0, 2)) if along is None else _corners(along)
    with matplotlib.rc_context(style.RC):
        if ax is not None:
            scale = length(np.concatenate([shown.x, shown.y, wanted.ravel()]))
            _draw_above(ax, shown, scale, wanted)
            return root_figure(ax)
        figure = Picture(figsize=(8.6, 4.4), layout="constrained")
        panels = figure.subplot_mosaic(
            [["above", "height"], ["above", "tilt"]], width_ratios=[1.15, 1.0]
        )
        scale = length(np.concatenate([shown.x, shown.y, shown.way, wanted.ravel()]))
        _draw_above(panels["above"], shown, scale, wanted)
        _draw_side(panels["height"], panels["tilt"], shown, scale)
    return figure


def _corners(along: Polyline | ArrayLike) -> Array:
    """Corners of a path, m, shape (k, 2)."""
    points = getattr(along, "points", along)
    try:
        corners = np.array(points, dtype=np.float64)
    except (TypeError, ValueError):
        corners = np.empty(0)
    if corners.ndim != 2 or corners.shape[1] != 2 or not np.isfinite(corners).all():
        refuse("along", along, "a Path, or its corners, shape (k, 2) of finite x and y, m")
    return corners


def heading_arrows(shown: Motion, factor: float) -> dict[int, tuple[Point, Point]]:
    """Arrows of the heading, m times a factor: sample, place at it, and tip.

    They stand at even distances, none on another one, and none near the last sample, where the
    robot is drawn with an arrow of its own.
    """
    x, y = shown.x, shown.y
    ends = [footprint(shown, k) for k in (0, -1)]
    span = float(np.ptp(np.concatenate([np.column_stack([x, y]), *ends]), axis=0).max())
    arrows: dict[int, tuple[Point, Point]] = {}
    nearest = np.hypot(x - x[-1], y - y[-1])
    from_last = np.full_like(nearest, np.inf)
    k = 0
    while True:
        free = (from_last[k:] >= _SPACING * span) & (nearest[k:] >= 0.5 * _SPACING * span)
        if not free.any():
            return arrows
        k += int(free.argmax())
        begin, heading = np.array([x[k], y[k]]), shown.heading[k]
        tip = begin + _ARROW * span * np.array([np.cos(heading), np.sin(heading)])
        (x0, y0), (x1, y1) = (factor * begin).tolist(), (factor * tip).tolist()
        arrows[k] = (x0, y0), (x1, y1)
        from_last = np.hypot(x - x[k], y - y[k])
        nearest = np.minimum(nearest, from_last)


def _heading_handle() -> Line2D:
    """What the arrows mean."""
    look: Any = {"color": palette.DARK_GREY, "linewidth": 1.4, "marker": ">", "markevery": [1]}
    return Line2D([], [], label="heading", **look)


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
    readable(axes)
    look: Any = {"color": palette.DARK_GREY, "fontsize": 7.5, "ha": "center", "va": "center"}
    for name, place in _COILS.items():
        rotation = 90.0 if name.startswith("x") else 0.0
        axes.text(*place, f"coil {name}", transform=axes.transAxes, rotation=rotation, **look)


def _draw_above(axes: Axes, shown: Motion, scale: Length, wanted: Array) -> None:
    x, y = shown.x * scale.factor, shown.y * scale.factor
    look: Any = {"closed": True, "edgecolor": palette.BLACK}
    first, last = (footprint(shown, k) * scale.factor for k in (0, -1))
    axes.add_patch(Polygon(first, fill=False, linestyle="--", linewidth=0.9, **look))
    axes.add_patch(Polygon(last, facecolor=style.BODY, linewidth=1.2, **look))
    begins: Any = {"marker": "o", "markersize": 4.5, "linestyle": "none"}
    (line,) = axes.plot(x, y, color=palette.BLACK, linewidth=0.9, label="centre of mass")
    (dot,) = axes.plot(x[:1], y[:1], color=palette.VERMILION, label="start", **begins)
    handles = [dot, line, _heading_handle()]
    if wanted.size:
        look = {"color": palette.PURPLE, "linewidth": 2.6, "zorder": 0.8, "label": "wanted"}
        handles += axes.plot(*(wanted * scale.factor).T, **look)
    for begin, tip in [*heading_arrows(shown, scale.factor).values(), body_arrow(last)]:
        arrow = thin_arrow(palette.DARK_GREY, 1.4)
        arrow.set_positions(begin, tip)
        axes.add_patch(arrow)
    places = [first, last, np.column_stack([x, y]), wanted * scale.factor]
    frame_from_above(axes, np.concatenate(places), scale.unit)
    legend_above(axes, handles, columns=2 if wanted.size else 3)


def _draw_side(above: Axes, below: Axes, shown: Motion, scale: Length) -> None:
    """Height and tilt over the way along the heading."""
    way, up = shown.way * scale.factor, length(shown.z)
    above.plot(way, shown.z * up.factor, color=palette.BLACK, linewidth=0.9)
    above.set_ylabel(f"height ({up.unit})")
    above.tick_params(labelbottom=False)
    readable(above, x=scale.least, y=up.least)
    below.plot(way, np.degrees(shown.theta), color=palette.BLACK, linewidth=0.9)
    below.set_ylabel(r"tilt $\theta$ (degrees)")
    below.set_xlabel(f"way along the heading ({scale.unit})")
    readable(below, x=scale.least, y=LEAST_TILT)
