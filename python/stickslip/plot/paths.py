"""Paths of a motion whose colour says how the body touches: trajectory and phase portrait."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from stickslip.plot import style
from stickslip.plot.canvas import drawn
from stickslip.plot.motion import Array, motion
from stickslip.plot.scales import LEAST_RATE, LEAST_TILT, length, readable
from stickslip.simulation.run import Run

if TYPE_CHECKING:
    from stickslip.plot.motion import Data


def trajectory(
    data: Data, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw the path of the centre of mass in the plane of motion, coloured by contact mode.

    Parameters, result and errors are those of `fields`.
    """
    shown = motion(data).between(start, stop)

    def draw(axes: Axes) -> None:
        along, up = length(shown.x), length(shown.z)
        _draw_path(axes, shown.x * along.factor, shown.z * up.factor, shown.contact)
        axes.set_xlabel(f"x of the centre of mass ({along.unit})")
        axes.set_ylabel(f"height of the centre of mass ({up.unit})")
        readable(axes, x=along.least, y=up.least)

    return drawn(draw, ax, (5.8, 3.4))


def phase_portrait(
    data: Data, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw tilt against its rate, coloured by contact mode.

    Parameters, result and errors are those of `fields`.
    """
    shown = motion(data).between(start, stop)

    def draw(axes: Axes) -> None:
        _draw_path(axes, np.degrees(shown.theta), shown.omega, shown.contact)
        axes.set_xlabel(r"tilt $\theta$ (degrees)")
        axes.set_ylabel(r"rate of the tilt $\omega$ (rad/s)")
        readable(axes, x=LEAST_TILT, y=LEAST_RATE)

    return drawn(draw, ax, (5.8, 4.2))


def _draw_path(axes: Axes, x: Array, y: Array, contact: NDArray[np.int8]) -> None:
    points = np.column_stack([x, y])
    segments = np.stack([points[:-1], points[1:]], axis=1)
    modes = contact[:-1]
    handles = []
    for code in sorted(set(modes.tolist())):
        name = Run.contact_names[code]
        colour = style.LINE_COLOURS[name]
        axes.add_collection(LineCollection(list(segments[modes == code]), colors=colour))
        handles.append(
            Line2D([], [], color=colour, linewidth=2.5, label=style.CONTACT_LABELS[name])
        )
    axes.autoscale_view()
    # Above the axes, where it covers no curve; in rows that a narrow picture can hold.
    axes.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=min(3, len(handles)),
        frameon=False,
        borderaxespad=0.1,
    )
