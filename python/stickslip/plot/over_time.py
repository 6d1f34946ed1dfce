"""Fields, and tilt with contact velocity, over time: the paper's Figs. 4 to 7."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip.plot.canvas import drawn
from stickslip.plot.motion import motion
from stickslip.plot.time_axes import draw_fields, draw_tilt

if TYPE_CHECKING:
    from stickslip.plot.motion import Data


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

    def draw(axes: Axes) -> None:
        draw_fields(axes, shown)
        axes.set_xlabel("time (s)")

    return drawn(draw, ax, (5.4, 2.6))


def angle_and_contact_velocity(
    data: Data, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw tilt and velocity of the contact point over time, as the paper's Figs. 5 and 7 do.

    Parameters, result and errors are those of `fields`.
    """
    shown = motion(data).between(start, stop)

    def draw(axes: Axes) -> None:
        draw_tilt(axes, shown)
        axes.set_xlabel("time (s)")

    return drawn(draw, ax, (5.4, 3.0))
