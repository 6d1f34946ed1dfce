"""A run over time, whole or one thing of it as in the paper's Figs. 4 to 7, or as a path."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from stickslip._util import palette
from stickslip._util.arrays import Array
from stickslip._util.picture import RC, Picture, legend_above
from stickslip.plot import style
from stickslip.plot.motion import Motion, motion
from stickslip.simulation.notes import resting_force
from stickslip.simulation.run import Run

# More pulses than the first number cannot be told apart in the picture; then as many of the last
# ones as the second says are drawn, which show the steady motion. Both chosen by eye.
_MOST_PULSES, _SHOWN_PULSES = 12, 6

# Part of the picture's time that is as wide as a dot of the picture: 6.4 inches of 150 dots.
_VISIBLE = 1e-3


def run(run: Run, start: float | None = None, stop: float | None = None) -> Figure:
    """Draw one run: what the paper's Figs. 4-7 show, with place, normal force and contact mode.

    A panel for each: field, pitch, contact velocity, x and normal force over time, and a band of
    colours for the mode of the contact. A run in the whole plane shows y beside x, its heading, and
    its contact velocity along the heading and to its left. What is not listed here is that of
    `fields`.

    Parameters
    ----------
    start, stop : float, optional
        Stretch of time to draw, s. Without them all of a run of up to twelve pulses, or the last
        six pulses of a longer one, also where it failed. Where the picture shows more than the
        measuring window, the window is shaded.
    """
    whole = motion(run)
    last_pulses = start is None and stop is None and _last_pulses(run)
    shown = whole.between(*(last_pulses or (start, stop)))
    heights = {"field": 1.0, "pitch": 1.0, "slip": 1.0, "place": 0.8, "heading": 0.8, "force": 1.0}
    if not shown.scenario.whole_plane:
        del heights["heading"]
    with matplotlib.rc_context(RC):
        size = (6.4, 1.6 + 1.2 * len(heights))
        figure = Picture(figsize=size, layout="constrained")
        *panels, band = figure.subplots(
            len(heights) + 1, 1, sharex=True, height_ratios=[*heights.values(), 0.22]
        )
        curves = dict(zip(heights, panels, strict=True))
        draw_fields(curves["field"], shown)
        draw_pitch(curves["pitch"], shown)
        draw_contact_velocity(curves["slip"], shown)
        if shown.scenario.whole_plane:
            legend_above(curves["slip"], curves["slip"].get_lines())
            curves["heading"].plot(shown.t, np.degrees(shown.heading), color=palette.BLACK)
            curves["heading"].set_ylabel("heading (degrees)")
            style.readable(curves["heading"], y=1.0)  # it follows the field within a tenth
        _draw_place(curves["place"], shown)
        _draw_force(curves["force"], shown, _shade_window(panels, shown, run))
        _draw_contact(figure, band, shown)
        for axes in panels:
            axes.set_ylabel(axes.get_ylabel().replace(" (", "\n("))  # a panel is low
        figure.align_ylabels(panels)
        figure.suptitle(_title(run, bool(last_pulses)), fontsize=10.5)
    return figure


def fields(
    run: Run, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw the field at the robot over time, as the paper's Figs. 4 and 6 do.

    Parameters
    ----------
    run : Run
        With a record on a uniform grid (``record.rate`` in Hz).
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
        If the run has no record.
    ValueError
        If the record is one of events, or has less than two samples from `start` to `stop`.
    """
    shown = motion(run).between(start, stop)
    with style.drawing(ax, (5.4, 2.6)) as axes:
        draw_fields(axes, shown)
        axes.set_xlabel("time (s)")
    return style.root_figure(axes)


def angle_and_contact_velocity(
    run: Run, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw pitch and velocity of the contact point over time, as the paper's Figs. 5 and 7 do.

    Parameters, result and errors are those of `fields`.
    """
    shown = motion(run).between(start, stop)
    with style.drawing(ax, (5.4, 3.0)) as velocity:
        # The pitch is drawn in the upper axes, so that it lies on top of the velocity's spikes.
        pitch = velocity.twinx()
        draw_contact_velocity(velocity, shown)
        velocity.yaxis.set_label_position("right")
        velocity.yaxis.tick_right()
        velocity.grid(visible=False, axis="y")
        draw_pitch(pitch, shown)
        pitch.yaxis.set_label_position("left")
        pitch.yaxis.tick_left()
        pitch.grid(visible=False)
        legend_above(velocity, [*pitch.get_lines(), *velocity.get_lines()])
        velocity.set_xlabel("time (s)")
    return style.root_figure(velocity)


def trajectory(
    run: Run, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw height over the way along the heading, coloured by contact mode.

    Both are of the centre of mass; of a robot that faces +x the way is x. `path` shows a robot from
    above. Parameters, result and errors are those of `fields`.
    """
    shown = motion(run).between(start, stop)
    with style.drawing(ax, (5.8, 3.4)) as axes:
        (along, along_unit), (up, up_unit) = style.length(shown.way), style.length(shown.z)
        _draw_by_contact(axes, shown.way * along, shown.z * up, shown.contact)
        axes.set_xlabel(f"way along the heading ({along_unit})")
        axes.set_ylabel(f"height of the centre\nof mass ({up_unit})")
        style.readable(axes, x=style.LEAST_SPAN)
    return style.root_figure(axes)


def phase_portrait(
    run: Run, start: float | None = None, stop: float | None = None, ax: Axes | None = None
) -> Figure:
    """Draw pitch against its rate, coloured by contact mode.

    Parameters, result and errors are those of `fields`.
    """
    shown = motion(run).between(start, stop)
    with style.drawing(ax, (5.8, 4.2)) as axes:
        _draw_by_contact(axes, np.degrees(shown.theta), shown.omega, shown.contact)
        axes.set_xlabel(r"pitch $\theta$ (degrees)")
        axes.set_ylabel(r"pitch rate $\omega$ (rad/s)")
        style.readable(axes, x=style.LEAST_SPAN)
    return style.root_figure(axes)


def draw_fields(axes: Axes, shown: Motion) -> None:
    """The components of the field, mT; that along y where it is not zero."""
    t = shown.t
    lines = axes.plot(t, shown.bx * 1e3, color=style.FIELD, label="$B_x$")
    if shown.by.any():
        lines += axes.plot(t, shown.by * 1e3, color=style.FIELD, linestyle=":", label="$B_y$")
    lines += axes.plot(t, shown.bz * 1e3, color=style.FIELD, linestyle="--", label="$B_z$")
    axes.set_xlim(t[0], t[-1])
    axes.set_ylabel("field (mT)")
    style.readable(axes)
    legend_above(axes, lines)


def draw_pitch(axes: Axes, shown: Motion) -> None:
    """Pitch in degrees."""
    axes.plot(shown.t, np.degrees(shown.theta), color=palette.BLACK, label=r"$\theta$")
    axes.set_xlim(shown.t[0], shown.t[-1])
    axes.set_ylabel(r"pitch $\theta$ (degrees)")
    style.readable(axes)


def draw_contact_velocity(axes: Axes, shown: Motion) -> None:
    """Velocity of the contact point, mm/s: along the heading and, if it has one, to its left."""
    look: Any = {"linewidth": 0.9}
    label = "contact velocity, forward" if shown.scenario.whole_plane else "contact velocity"
    forward = shown.slip_velocity
    axes.plot(shown.t, forward * 1e3, color=palette.ORANGE, label=label, **look)
    if shown.scenario.whole_plane:
        across = shown.slip_across * 1e3
        axes.plot(shown.t, across, color=palette.PURPLE, label="to the left", **look)
    axes.set_xlim(shown.t[0], shown.t[-1])
    axes.set_ylabel("contact velocity (mm/s)")
    style.readable(axes)


def _draw_by_contact(axes: Axes, x: Array, y: Array, contact: NDArray[np.int8]) -> None:
    """A line whose colour says how the body touches."""
    points = np.column_stack([x, y])
    segments = np.stack([points[:-1], points[1:]], axis=1)
    modes = contact[:-1]
    handles = []
    for code in np.unique(modes):
        name = Run.contact_names[code]
        colour = style.CONTACT_COLOURS[name]
        axes.add_collection(LineCollection(list(segments[modes == code]), colors=colour))
        label = name.replace("_", " ")
        handles.append(Line2D([], [], color=colour, linewidth=2.5, label=label))
    axes.autoscale_view()
    legend_above(axes, handles, columns=min(3, len(handles)))  # three fit a narrow picture


def _last_pulses(run: Run) -> tuple[float, float] | None:
    """First and last time of the last pulses of a run of many, s."""
    scenario = run.scenario
    rate = scenario.pulse_rate
    if rate == 0.0 or scenario.drive.pulses <= _MOST_PULSES:
        return None
    end = min(scenario.window[1], float(run.t[-1]))
    first = end - _SHOWN_PULSES / rate
    # A run that failed in the ramp or soon after it has less to show.
    lead_in = scenario.drive.latency + scenario.drive.ramp
    return (first, end) if first >= lead_in else None


def _title(run: Run, last_pulses: bool) -> str:
    drive = run.scenario.drive
    program = drive.kind == "program"
    words = ["voltage program"] if program else [drive.mode, f"{run.scenario.pulse_rate:g} Hz"]
    if np.isfinite(run.mean_velocity):
        along, across = (f"{velocity * 1e3:.4g}" for velocity in run.velocity)
        text = f"{run.mean_velocity * 1e3:.4g} mm/s"
        if run.scenario.whole_plane:
            text = f"{along} mm/s along x, {across} along y"
            if not program:
                text = f"{along} mm/s along the drive, {across} to its left"
        words.append(f"mean velocity {text}")
    if last_pulses:
        missing = run.scenario.window[1] - run.t[-1]  # s, where a condition ended it
        all_played = run.ok and missing < 0.5 / run.scenario.pulse_rate
        whole = f"of {drive.pulses} pulses" if all_played else "pulses before its end"
        words.append(f"last {_SHOWN_PULSES} {whole}")
    if not run.ok:
        words.append(f"ended early: {run.status}")
    return ", ".join(words)


def _draw_place(axes: Axes, shown: Motion) -> None:
    """x and, of a run in the whole plane, y; in µm or mm."""
    factor, unit = style.length(shown.x, shown.y)
    lines = axes.plot(shown.t, shown.x * factor, color=palette.BLACK, label="x")
    axes.set_ylabel(f"x ({unit})")
    if shown.scenario.whole_plane:
        look: Any = {"color": palette.BLACK, "linestyle": "--"}
        lines += axes.plot(shown.t, shown.y * factor, label="y", **look)
        axes.set_ylabel(f"position ({unit})")
        legend_above(axes, lines)
    style.readable(axes)


def _shade_window(panels: list[Axes], shown: Motion, run: Run) -> list[Patch]:
    """Shade the measuring window where it is a part of the picture; a handle if there is one."""
    t = shown.t
    start, end = max(run.scenario.window[0], t[0]), min(run.scenario.window[1], t[-1])
    sample = 1.5 * (t[1] - t[0])
    whole = start - t[0] <= sample and t[-1] - end <= sample
    if not np.isfinite(run.mean_velocity) or start >= end or whole:
        return []
    for axes in panels:
        axes.axvspan(start, end, facecolor=style.SHADE, edgecolor="none", zorder=0)
    return [Patch(facecolor=style.SHADE, edgecolor=palette.GREY, label="measuring window")]


def _draw_force(axes: Axes, shown: Motion, shaded: list[Patch]) -> None:
    axes.plot(shown.t, shown.normal_force * 1e6, color=palette.BLACK, linewidth=0.9)
    # Above the force, which lies on it most of the time.
    look: Any = {"color": palette.DARK_GREY, "linestyle": ":", "linewidth": 1.2, "zorder": 3.0}
    at_rest = resting_force(shown.scenario) * 1e6
    resting = axes.axhline(at_rest, label="weight + adhesion", **look)
    axes.set_ylabel("normal force (µN)")
    style.readable(axes)
    legend_above(axes, [resting, *shaded])


def _draw_contact(figure: Figure, axes: Axes, shown: Motion) -> None:
    """A band that changes colour with the mode of the contact."""
    t, contact = shown.t, shown.contact
    changes = np.flatnonzero(np.diff(contact)) + 1
    begins = np.concatenate([[0], changes])
    ends = np.concatenate([changes, [len(t) - 1]])
    handles = []
    for code in np.unique(contact):
        name = Run.contact_names[code]
        colour = style.CONTACT_COLOURS[name]
        chosen = contact[begins] == code
        spans = np.column_stack([t[begins], t[ends] - t[begins]])[chosen]
        axes.broken_barh(spans.tolist(), (0.0, 1.0), facecolor=colour, edgecolor="none")
        if spans[:, 1].sum() >= _VISIBLE * (t[-1] - t[0]):
            label = name.replace("_", " ")
            handles.append(Patch(facecolor=colour, edgecolor=palette.GREY, label=label))
    axes.set(xlim=(t[0], t[-1]), ylim=(0.0, 1.0), yticks=[], xlabel="time (s)")
    axes.set_ylabel("contact", rotation=0, ha="right", va="center")
    axes.grid(visible=False)
    rows = -(-len(handles) // 4)  # as many as fit side by side, in rows of about the same length
    columns = -(-len(handles) // rows)
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, frameon=False)
