"""One run over time: fields, tilt, contact velocity, path, force and contact."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from stickslip._util import palette
from stickslip._util.picture import Picture
from stickslip.plot import style
from stickslip.plot.canvas import legend_above
from stickslip.plot.motion import Array, Motion, motion
from stickslip.plot.one_motion import draw_contact_velocity, draw_fields, draw_tilt
from stickslip.plot.scales import LEAST_FORCE, LEAST_HEADING, length, readable
from stickslip.scenario.keys import refuse
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.run import Run, resting_force

# More pulses than the first number cannot be told apart in the picture; then as many of the last
# ones as the second says are drawn, which show the steady motion. Both chosen by eye.
_MOST_PULSES, _SHOWN_PULSES = 12, 6

# Part of the picture's time that is as wide as a dot of the picture: 6.4 inches of 150 dots.
_VISIBLE = 1e-3


def run(run: Run, start: float | None = None, stop: float | None = None) -> Figure:
    """Draw one run: what the paper's Figs. 4-7 show, with path, normal force and contact mode.

    A panel for each: field, tilt, contact velocity, position and normal force over time, and a band
    of colours for the mode of the contact. A robot that leaves its plane has a panel for its
    heading too, its position is x and y, and its contact velocity that along the heading and to its
    left.

    Parameters
    ----------
    run : Run
        A run with a record on a uniform grid (``record.rate`` in Hz).
    start, stop : float, optional
        Stretch of time to draw, s. Without them all of a run of up to twelve pulses, or the last
        six pulses of a longer one, also where it failed. Where the picture shows more than the
        measuring window, the window is shaded.

    Returns
    -------
    matplotlib.figure.Figure
        Not bound to a window; `stickslip.plot.save` writes it.

    Raises
    ------
    AttributeError
        If the run has no record.
    ValueError
        If `run` is no Run, the record is one of events, or has less than two samples from `start`
        to `stop`.
    """
    if not isinstance(run, Run):
        refuse("run", run, "a Run, as simulate(scenario) makes it")
    whole = motion(run)
    first, last, last_pulses = _stretch(run.scenario, float(run.t[-1]), start, stop)
    shown = whole.between(first, last)
    with matplotlib.rc_context(style.RC):
        figure, curves, contact = _panels(shown.turns)
        fields, tilt, slip, path, *turning, force = curves
        t = shown.t
        draw_fields(fields, shown)
        draw_tilt(tilt, shown)
        draw_contact_velocity(slip, shown)
        _draw_position(path, shown)
        if shown.turns:
            legend_above(slip, slip.get_lines())
            _draw_heading(turning[0], shown)
        shaded = _shade_window(curves, t, run)
        _draw_force(force, t, shown.normal_force, run, shaded)
        _draw_contact(figure, contact, t, shown.contact)
        contact.set_xlim(t[0], t[-1])
        contact.set_xlabel("time (s)")
        for axes in curves:
            axes.set_ylabel(axes.get_ylabel().replace(" (", "\n("))  # a panel is low
        figure.align_ylabels(curves)
        figure.suptitle(_title(run, last_pulses), fontsize=10.5)
    return figure


def _panels(turns: bool) -> tuple[Picture, list[Axes], Axes]:
    """A new figure, its panels of curves from above, and the band of the contact below them."""
    heights = [1.0, 1.0, 1.0, 0.8, 1.0, 0.22]
    if turns:
        heights.insert(4, 0.8)
    figure = Picture(figsize=(6.4, 8.8 if turns else 7.6), layout="constrained")
    *curves, contact = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    return figure, curves, contact


def _stretch(
    scenario: Scenario, end: float, start: float | None, stop: float | None
) -> tuple[float, float, bool]:
    """First and last time to draw, s, and whether these are the last pulses of many.

    `end` is the time at which the run ends; for `start` and `stop` see `run`.
    """
    drive = scenario.drive
    if start is None and stop is None and drive.mode != "program" and drive.pulses > _MOST_PULSES:
        pulses_end = min(scenario.window[1], end)
        first = pulses_end - _SHOWN_PULSES / drive.frequency
        # A run that failed in the ramp or soon after it has less to show.
        if first >= drive.ramp:
            return first, pulses_end, True
    return (0.0 if start is None else start), (end if stop is None else stop), False


def _title(run: Run, last_pulses: bool) -> str:
    drive = run.scenario.drive
    words = ["voltage program"]
    if drive.mode != "program":
        words = [drive.mode, f"{drive.frequency:g} Hz"]
    if np.isfinite(run.mean_velocity):
        words.append(_mean_velocity(run))
    if last_pulses:
        whole = f"of {drive.pulses} pulses" if run.ok else "pulses before its end"
        words.append(f"last {_SHOWN_PULSES} {whole}")
    if not run.ok:
        words.append(f"ended early: {run.status}")
    return ", ".join(words)


def _mean_velocity(run: Run) -> str:
    if not run.scenario.turns:
        return f"mean velocity {run.mean_velocity * 1e3:.4g} mm/s"
    along, across = (f"{each * 1e3:.4g}" for each in run.velocity)
    if run.scenario.drive.mode == "program":
        return f"mean velocity {along} mm/s along x, {across} along y"
    return f"mean velocity {along} mm/s along the drive, {across} to its left"


def _draw_position(axes: Axes, shown: Motion) -> None:
    """x, and of a robot that leaves its plane y, in µm or mm."""
    scale = length(np.concatenate([shown.x, shown.y]))
    lines = axes.plot(shown.t, shown.x * scale.factor, color=palette.BLACK, label="x")
    axes.set_ylabel(f"x ({scale.unit})")
    if shown.turns:
        look: Any = {"color": palette.BLACK, "linestyle": "--"}
        lines += axes.plot(shown.t, shown.y * scale.factor, label="y", **look)
        axes.set_ylabel(f"position ({scale.unit})")
        legend_above(axes, lines)
    readable(axes, y=scale.least)


def _draw_heading(axes: Axes, shown: Motion) -> None:
    """Heading in degrees."""
    axes.plot(shown.t, np.degrees(shown.heading), color=palette.BLACK)
    axes.set_ylabel("heading (degrees)")
    readable(axes, y=LEAST_HEADING)


def _shade_window(panels: list[Axes], t: Array, run: Run) -> list[Artist]:
    """Shade the measuring window where it is a part of the picture; a handle if there is one."""
    start, end = max(run.scenario.window[0], t[0]), min(run.scenario.window[1], t[-1])
    sample = 1.5 * (t[1] - t[0])
    if (
        not np.isfinite(run.mean_velocity)
        or start >= end
        or (start - t[0] <= sample and t[-1] - end <= sample)
    ):
        return []
    for axes in panels:
        axes.axvspan(start, end, facecolor=style.SHADE, edgecolor="none", zorder=0)
    return [Patch(facecolor=style.SHADE, edgecolor=palette.GREY, label="measuring window")]


def _draw_force(axes: Axes, t: Array, force: Array, run: Run, shaded: list[Artist]) -> None:
    axes.plot(t, force * 1e6, color=palette.BLACK, linewidth=0.9)
    at_rest = resting_force(run.scenario) * 1e6
    # Above the force, which lies on it most of the time.
    resting = axes.axhline(
        at_rest,
        color=palette.DARK_GREY,
        linestyle=":",
        linewidth=1.2,
        zorder=3.0,
        label="weight + adhesion",
    )
    axes.set_ylabel("normal force (µN)")
    readable(axes, y=LEAST_FORCE)
    legend_above(axes, [resting, *shaded])


def _draw_contact(figure: Figure, axes: Axes, t: Array, contact: NDArray[np.int8]) -> None:
    """A band that changes colour with the mode of the contact."""
    changes = np.flatnonzero(np.diff(contact)) + 1
    begins = np.concatenate([[0], changes])
    ends = np.concatenate([changes, [len(t) - 1]])
    handles = []
    for code in sorted(set(contact.tolist())):
        name = Run.contact_names[code]
        colour = style.CONTACT_COLOURS[name]
        spans = [
            (t[begin], t[end] - t[begin])
            for begin, end in zip(begins, ends, strict=True)
            if contact[begin] == code
        ]
        axes.broken_barh(spans, (0.0, 1.0), facecolor=colour, edgecolor="none")
        if sum(width for _, width in spans) >= _VISIBLE * (t[-1] - t[0]):
            label = style.CONTACT_LABELS[name]
            handles.append(Patch(facecolor=colour, edgecolor=palette.GREY, label=label))
    axes.set_ylim(0.0, 1.0)
    axes.set_yticks([])
    axes.set_ylabel("contact", rotation=0, ha="right", va="center")
    axes.grid(visible=False)
    rows = -(-len(handles) // 4)  # as many as fit side by side, in rows of about the same length
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=-(-len(handles) // rows),
        frameon=False,
    )
