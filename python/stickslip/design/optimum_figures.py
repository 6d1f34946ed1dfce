"""Figures of an optimised drive."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip._util.palette import BLACK, BLUE, DARK_GREY, GREEN, ORANGE, PURPLE, VERMILION
from stickslip._util.picture import Picture
from stickslip._util.units import handy, in_handy_units
from stickslip.design.design_space import drive_waveform
from stickslip.design.landscape import Slice
from stickslip.design.optimum import Optimum
from stickslip.plot import style
from stickslip.plot.canvas import drawing, legend_above, root_figure
from stickslip.plot.motion import motion
from stickslip.plot.one_motion import draw_fields
from stickslip.plot.scales import readable
from stickslip.scenario.keys import RECORD_RATE
from stickslip.scenario.sections import COIL_NAMES
from stickslip.simulation.simulate import simulate

_PERIODS = 3  # shown; chosen: one and what it repeats
_SAMPLES = 400  # a period; chosen: an edge is a dot of the picture wide
_COLUMNS = 4  # slices in a row of the landscape
_COLOURS = dict(zip(COIL_NAMES, (BLUE, GREEN, ORANGE, PURPLE, VERMILION), strict=True))
COMPARED = {"start": DARK_GREY, "search": GREEN, "sawtooth": ORANGE, "best": BLUE}
"""Colours of the drives that are compared."""


def waveform(found: Optimum) -> Figure | None:
    """Voltages asked for, currents and field of the best drive, over its last periods.

    None where its simulation fails with the values of the scenario, which were none of the draws.
    """
    frequency = found.frequency
    begin = max(found.scenario.window[1] - _PERIODS / frequency, 0.0)
    record = {RECORD_RATE: _SAMPLES * frequency, "record.from": begin}
    played = found.scenario.replace(record)
    run = simulate(played)
    if not run.ok:
        return None
    t = run.t
    asked = drive_waveform(played).voltages(np.minimum(t, drive_waveform(played).duration))
    with matplotlib.rc_context(style.RC):
        figure = Picture(figsize=(8.0, 6.2), layout="constrained")
        above, middle, below = figure.subplots(3, 1, sharex=True)
        _coils(above, t, asked, "voltage asked for (V)")
        legend_above(above, above.get_lines())
        _coils(middle, t, run.current, "current (A)")
        draw_fields(below, motion(run))
        below.set_xlabel("time (s)")
        below.set_xlim(t[0], t[-1])
    return figure


def _coils(axes: Axes, t: Any, values: Any, label: str) -> None:
    for place, name in enumerate(COIL_NAMES):
        if values[:, place].any():
            axes.plot(t, values[:, place], color=_COLOURS[name], label=name)
    axes.set_ylabel(label)
    readable(axes)


def scores(found: Optimum) -> Figure:
    """The figure of every fresh draw, for each drive that is compared; the score is marked."""
    factor, label = in_handy_units(found.goal.figure, found.goal.unit)
    with drawing(None, (7.0, 2.4)) as axes:
        names = [name for name in COMPARED if name in found.fresh]
        for place, name in enumerate(names):
            judged = found.fresh[name]
            values = np.sort(judged.figures) * factor
            spread = place + 0.28 * np.sin(2.4 * np.arange(len(values)))  # not on one another
            axes.plot(values, spread, ".", color=COMPARED[name], markersize=4, alpha=0.7)
            axes.plot([judged.score * factor] * 2, [place - 0.42, place + 0.42], color=BLACK)
        axes.set_yticks(range(len(names)), names)
        axes.set_xlabel(f"{label}; the line is the score, {found.goal.score}")
        readable(axes)
    return root_figure(axes)


def landscape(found: Optimum) -> Figure:
    """A slice for each free number: the score in draws that chose nothing."""
    factor, label = in_handy_units(f"{found.goal.score} of {found.goal.figure}", found.goal.unit)
    rows = -(-len(found.slices) // _COLUMNS)
    with matplotlib.rc_context(style.RC):
        figure = Picture(figsize=(8.4, 1.5 * rows + 0.6), layout="constrained")
        grid = figure.subplots(rows, _COLUMNS, sharey=True, squeeze=False)
        for axes, each in zip(grid.flat, found.slices, strict=False):
            _slice(axes, each, factor)
        for axes in grid.flat[len(found.slices) :]:
            axes.set_visible(False)
        figure.supylabel(label, fontsize=9.0)
    return figure


def _slice(axes: Axes, each: Slice, factor: float) -> None:
    scale, unit = handy(each.axis.unit)
    x, y = each.values * scale, each.scores * factor
    axes.plot(x, y, color=BLUE)
    axes.plot(x[each.feasible], y[each.feasible], ".", color=BLUE)
    axes.plot(x[~each.feasible], y[~each.feasible], "x", color=VERMILION, markersize=4)
    axes.axvline(each.best * scale, color=DARK_GREY, linewidth=0.8)
    axes.set_title(f"{each.axis.name} ({unit})" if unit else each.axis.name, fontsize=8.0)
    axes.tick_params(labelsize=7.0)
