"""What is drawn against time in more than one picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from stickslip._util import palette
from stickslip.plot.motion import Motion
from stickslip.plot.scales import LEAST_FIELD, LEAST_TILT, LEAST_VELOCITY, readable


def draw_fields(axes: Axes, shown: Motion) -> None:
    """Both components of the field, mT."""
    t = shown.t
    lines = axes.plot(t, shown.bx * 1e3, color=palette.BLUE, label="$B_x$")
    lines += axes.plot(t, shown.bz * 1e3, color=palette.VERMILION, linestyle="--", label="$B_z$")
    axes.set_xlim(t[0], t[-1])
    axes.set_ylabel("field (mT)")
    readable(axes, y=LEAST_FIELD)
    legend_above(axes, lines)


def draw_tilt(axes: Axes, shown: Motion) -> None:
    """Tilt in degrees on the left, contact velocity in mm/s on the right."""
    # The upper of the two, the tilt lies on top of the velocity's spikes.
    velocity, tilt = axes, axes.twinx()
    t, slip = shown.t, shown.slip_velocity
    velocity.plot(t, slip * 1e3, color=palette.ORANGE, linewidth=0.9, label="contact velocity")
    velocity.set_ylabel("contact velocity (mm/s)")
    velocity.yaxis.set_label_position("right")
    velocity.yaxis.tick_right()
    velocity.grid(visible=False, axis="y")
    tilt.plot(t, np.degrees(shown.theta), color=palette.BLUE, label=r"$\theta$")
    tilt.set_ylabel(r"tilt $\theta$ (degrees)")
    tilt.yaxis.set_label_position("left")
    tilt.yaxis.tick_left()
    tilt.grid(visible=False)
    readable(velocity, y=LEAST_VELOCITY)
    readable(tilt, y=LEAST_TILT)
    axes.set_xlim(t[0], t[-1])
    legend_above(axes, [*tilt.get_lines(), *velocity.get_lines()])


def legend_above(axes: Axes, handles: Sequence[Artist]) -> None:
    """Above the axes, where it covers no curve."""
    axes.legend(
        handles=list(handles),
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=len(handles),
        frameon=False,
        borderaxespad=0.1,
    )
