"""One thing of one motion: over time, as in the paper's Figs. 4 to 7, or as a path."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from stickslip._util import palette
from stickslip.plot import style
from stickslip.plot.canvas import drawing, legend_above, root_figure
from stickslip.plot.motion import Array, Data, Motion, motion
from stickslip.plot.scales import (
    LEAST_FIELD,
    LEAST_RATE,
    LEAST_TILT,
    LEAST_VELOCITY,
    length,
    readable,
)
from stickslip.simulation.run import Run


def fields(
    data: Data, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw the field at the robot over time, as the paper's Figs. 4 and 6 do.

    Parameters
    ----------
    data : Run or xarray.Dataset
        A run with a record on a uniform grid, or what its `to_xarray` gave.
    start, stop : float, optional
        Stretch of time to draw, s; all of it, if not given.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure, if not given.

    Returns
    -------
    matplotlib.figure.Figure
        The one that holds the axes.

    Raises
    ------
    AttributeError
        If a run has no record.
    ValueError
        If the record is one of events, or has less than two samples from `start` to `stop`.
    """
    shown = motion(data).between(start, stop)
    with drawing(ax, (5.4, 2.6)) as axes:
        draw_fields(axes, shown)
        axes.set_xlabel("time (s)")
    return root_figure(axes)


def angle_and_contact_velocity(
    data: Data, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw tilt and velocity of the contact point over time, as the paper's Figs. 5 and 7 do.

    Parameters, result and errors are those of `fields`.
    """
    shown = motion(data).between(start, stop)
    with drawing(ax, (5.4, 3.0)) as axes:
        _draw_both(axes, shown)
        axes.set_xlabel("time (s)")
    return root_figure(axes)


def trajectory(
    data: Data, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw the path of the centre of mass in the side view, coloured by contact mode.

    Of a robot that leaves its plane it is the height over the way along the heading; `path` shows
    it from above. Parameters, result and errors are those of `fields`.
    """
    shown = motion(data).between(start, stop)
    with drawing(ax, (5.8, 3.4)) as axes:
        along, up = length(shown.along), length(shown.z)
        _draw_path(axes, shown.along * along.factor, shown.z * up.factor, shown.contact)
        axes.set_xlabel(f"{shown.along_name} of the centre of mass ({along.unit})")
        axes.set_ylabel(f"height of the centre of mass ({up.unit})")
        readable(axes, x=along.least, y=up.least)
    return root_figure(axes)


def phase_portrait(
    data: Data, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw tilt against its rate, coloured by contact mode.

    Parameters, result and errors are those of `fields`.
    """
    shown = motion(data).between(start, stop)
    with drawing(ax, (5.8, 4.2)) as axes:
        _draw_path(axes, np.degrees(shown.theta), shown.omega, shown.contact)
        axes.set_xlabel(r"tilt $\theta$ (degrees)")
        axes.set_ylabel(r"rate of the tilt $\omega$ (rad/s)")
        readable(axes, x=LEAST_TILT, y=LEAST_RATE)
    return root_figure(axes)


def draw_fields(axes: Axes, shown: Motion) -> None:
    """Both components of the field, mT."""
    t = shown.t
    lines = axes.plot(t, shown.bx * 1e3, color=style.FIELD, label="$B_x$")
    if shown.by.any():
        lines += axes.plot(t, shown.by * 1e3, color=style.FIELD, linestyle=":", label="$B_y$")
    lines += axes.plot(t, shown.bz * 1e3, color=style.FIELD, linestyle="--", label="$B_z$")
    axes.set_xlim(t[0], t[-1])
    axes.set_ylabel("field (mT)")
    readable(axes, y=LEAST_FIELD)
    legend_above(axes, lines)


def draw_tilt(axes: Axes, shown: Motion) -> None:
    """Tilt in degrees."""
    axes.plot(shown.t, np.degrees(shown.theta), color=palette.BLACK, label=r"$\theta$")
    axes.set_xlim(shown.t[0], shown.t[-1])
    axes.set_ylabel(r"tilt $\theta$ (degrees)")
    readable(axes, y=LEAST_TILT)


def draw_contact_velocity(axes: Axes, shown: Motion) -> None:
    """Velocity of the contact point in mm/s, of a robot that turns in two parts; none in flight."""
    along = "along the heading" if shown.turns else "contact velocity"
    look: Any = {"linewidth": 0.9}
    axes.plot(shown.t, shown.slip_velocity * 1e3, color=style.SLIP, label=along, **look)
    if shown.turns:
        across = shown.slip_across * 1e3
        axes.plot(shown.t, across, color=palette.PURPLE, label="to its left", **look)
    axes.set_xlim(shown.t[0], shown.t[-1])
    axes.set_ylabel("contact velocity (mm/s)")
    readable(axes, y=LEAST_VELOCITY)


def _draw_both(axes: Axes, shown: Motion) -> None:
    """Tilt on the left, contact velocity on the right."""
    # The tilt is drawn in the upper axes, so that it lies on top of the velocity's spikes.
    velocity, tilt = axes, axes.twinx()
    draw_contact_velocity(velocity, shown)
    velocity.yaxis.set_label_position("right")
    velocity.yaxis.tick_right()
    velocity.grid(visible=False, axis="y")
    draw_tilt(tilt, shown)
    tilt.yaxis.set_label_position("left")
    tilt.yaxis.tick_left()
    tilt.grid(visible=False)
    legend_above(axes, [*tilt.get_lines(), *velocity.get_lines()])


def _draw_path(axes: Axes, x: Array, y: Array, contact: NDArray[np.int8]) -> None:
    """A line whose colour says how the body touches."""
    points = np.column_stack([x, y])
    segments = np.stack([points[:-1], points[1:]], axis=1)
    modes = contact[:-1]
    handles = []
    for code in sorted(set(modes.tolist())):
        name = Run.contact_names[code]
        colour = style.CONTACT_COLOURS[name]
        axes.add_collection(LineCollection(list(segments[modes == code]), colors=colour))
        label = style.CONTACT_LABELS[name]
        handles.append(Line2D([], [], color=colour, linewidth=2.5, label=label))
    axes.autoscale_view()
    legend_above(axes, handles, columns=min(3, len(handles)))  # three fit a narrow picture
