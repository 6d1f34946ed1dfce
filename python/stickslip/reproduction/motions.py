"""The paper's Figs. 2 (e) to (h) and 4 to 7: single runs of the reference settings at 30 Hz."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from stickslip import plot
from stickslip.plot.motion import corners, lowest_corner, motion
from stickslip.reproduction.settings import Mode, Setting
from stickslip.reproduction.strokes import interval
from stickslip.reproduction.survey import stroke_scenario
from stickslip.reproduction.tables import table
from stickslip.simulation.columns import COLUMNS
from stickslip.simulation.run import Run
from stickslip.simulation.simulate import simulate_batch

_RAMP_DOWN = 0.05  # s; as the ramp up
_CSV_RATE = 5e3  # Hz; chosen: enough to draw the figure again
_FILM_PULSE = 8  # of twelve; chosen: the motion repeats itself by then
_SHOWN_PULSES = 4  # chosen: few enough to tell the strokes apart

_FRAMES = {
    "e": "steady angle",
    "f": "rocked down",
    "g": "slips forwards",
    "h": "steady angle again",
}


_FIELD = ("t", "bx", "bz")
_TILT = ("t", "theta", "slip_velocity")


class MotionFigure(NamedTuple):
    """One figure of a run."""

    mode: Mode
    caption: str
    columns: tuple[str, ...] = ()  # of the run, over time; none for the outlines of Fig. 2


MOTIONS = {
    "fig2": MotionFigure(
        "OPP",
        "Outline of the body over one pulse of OPP. The triangle is where it touches, the dashed "
        "line where it touched in the frame before; the arrow is its moment.",
    ),
    "fig4": MotionFigure("IPP", "Field at the robot under IPP at 30 Hz.", _FIELD),
    "fig5": MotionFigure(
        "IPP", "Tilt and contact velocity over four pulses of IPP at 30 Hz.", _TILT
    ),
    "fig6": MotionFigure("OPP", "Field at the robot under OPP at 30 Hz.", _FIELD),
    "fig7": MotionFigure(
        "OPP", "Tilt and contact velocity over four pulses of OPP at 30 Hz.", _TILT
    ),
}
"""The figures of single runs by name."""


def reference_runs(reference: Mapping[Mode, Setting], threads: int) -> dict[Mode, Run]:
    """Twelve pulses at 30 Hz and the ramp down of the in-plane coil, for each mode."""
    scenarios = [
        stroke_scenario(setting).replace({"drive.ramp_down": _RAMP_DOWN})
        for setting in reference.values()
    ]
    return dict(zip(reference, simulate_batch(scenarios, threads), strict=True))


def motion_table(name: str, run: Run) -> pd.DataFrame:
    """The data of one figure.

    Fig. 2: a row for each frame with position, tilt, contact point, the one before, and the four
    corners. The others: time with what is drawn, at 5 kHz.
    """
    drawn = MOTIONS[name].columns
    if not drawn:
        return _film_table(run)
    part = slice(None, None, max(1, round(1.0 / (_CSV_RATE * interval(run)))))
    columns: dict[str, Any] = {each: getattr(run, each)[part] for each in drawn}
    units = {each: COLUMNS[each].unit for each in drawn}
    if drawn == _TILT:
        columns["contact"] = [Run.contact_names[code] for code in run.contact[part]]
        units["contact"] = ""
    return table(columns, units)


def draw_motion(name: str, run: Run) -> Figure:
    """Draw one figure."""
    if not MOTIONS[name].columns:
        times = film_times(run)
        frames = zip(_FRAMES.items(), times, strict=True)
        return plot.filmstrip(run, times, [f"({k}) {word}, {t:.4f} s" for (k, word), t in frames])
    if MOTIONS[name].columns == _FIELD:
        return plot.fields(run)
    # All twelve pulses and the ramps would be a smear, and are in the figure's data.
    start = run.scenario.window[0]
    return plot.angle_and_contact_velocity(
        run, start, start + _SHOWN_PULSES / run.scenario.drive.frequency
    )


def film_times(run: Run) -> list[float]:
    """Times of the four frames, s.

    Greatest tilt after one edge, least tilt before the next, greatest contact velocity as the tilt
    rises again, and the greatest tilt after that; all within two pulses.
    """
    drive = run.scenario.drive
    period = 1.0 / drive.frequency
    tilt = np.abs(run.theta)

    def period_after(start: float) -> np.ndarray:
        return np.flatnonzero((run.t >= start) & (run.t <= start + period))

    first = period_after(drive.ramp + (_FILM_PULSE - 1) * period)
    steady = first[tilt[first].argmax()]
    second = period_after(run.t[steady])
    low = second[tilt[second].argmin()]
    third = period_after(run.t[low])
    high = third[tilt[third].argmax()]
    rising = np.arange(low, high + 1)
    fastest = rising[np.nan_to_num(run.slip_velocity[rising]).argmax()]
    return [float(run.t[k]) for k in (steady, low, fastest, high)]


def _film_table(run: Run) -> pd.DataFrame:
    shown = motion(run)
    samples = [shown.sample(time) for time in film_times(run)]
    touch = lowest_corner(shown)[samples]
    columns: dict[str, Any] = {
        "frame": list(_FRAMES),
        **{each: getattr(shown, each)[samples] for each in ("t", "x", "z", "theta")},
        "contact_x": touch,
        "contact_x_before": [np.nan, *touch[:-1]],
    }
    outlines = np.array([corners(shown, k) for k in samples])
    for number in range(4):
        columns[f"corner{number + 1}_x"] = outlines[:, number, 0]
        columns[f"corner{number + 1}_z"] = outlines[:, number, 1]
    return table(columns, dict.fromkeys(columns, "m") | {"frame": "", "t": "s", "theta": "rad"})
