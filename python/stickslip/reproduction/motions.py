"""The paper's Figs. 2 (e) to (h) and 4 to 7: single runs of the reference settings at 30 Hz."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from stickslip import plot
from stickslip.plot.motion import corners, lowest_corner, motion
from stickslip.reproduction.settings import Mode, Setting
from stickslip.reproduction.survey import stroke_scenario
from stickslip.reproduction.tables import Table
from stickslip.simulation.run import Run
from stickslip.simulation.simulate import simulate_batch

FRAMES = ("e", "f", "g", "h")

_RAMP_DOWN = 0.05  # s
_CSV_RATE = 5e3  # Hz
_FILM_PULSE = 8
_SHOWN_PULSES = 4

_FRAME_WORDS = {
    "e": "steady angle",
    "f": "rocked down",
    "g": "slips forwards",
    "h": "steady angle again",
}


@dataclass(frozen=True)
class MotionFigure:
    """One figure of a run: its mode and caption."""

    mode: Mode
    caption: str


MOTIONS = {
    "fig2": MotionFigure(
        "OPP",
        "Outline of the body over one pulse of OPP. The triangle is where it touches, the dashed "
        "line where it touched in the frame before; the arrow is its moment.",
    ),
    "fig4": MotionFigure("IPP", "Field at the robot under IPP at 30 Hz."),
    "fig5": MotionFigure("IPP", "Tilt and contact velocity over four pulses of IPP at 30 Hz."),
    "fig6": MotionFigure("OPP", "Field at the robot under OPP at 30 Hz."),
    "fig7": MotionFigure("OPP", "Tilt and contact velocity over four pulses of OPP at 30 Hz."),
}
"""The figures of single runs by name."""


def reference_runs(reference: Mapping[Mode, Setting], threads: int) -> dict[Mode, Run]:
    """Twelve pulses at 30 Hz and the ramp down of the in-plane coil, for each mode."""
    scenarios = [
        stroke_scenario(setting).replace({"drive.ramp_down": _RAMP_DOWN})
        for setting in reference.values()
    ]
    return dict(zip(reference, simulate_batch(scenarios, threads), strict=True))


def motion_table(name: str, run: Run) -> Table:
    """The data of one figure.

    Fig. 2: a row for each frame with position, tilt, contact point, the one before, and the four
    corners. The others: time with what is drawn, at 5 kHz.
    """
    if name == "fig2":
        return _film_table(run)
    every = max(1, round(1.0 / (_CSV_RATE * (run.t[1] - run.t[0]))))
    part = slice(None, None, every)
    if name in ("fig4", "fig6"):
        columns = {"t": run.t[part], "bx": run.bx[part], "bz": run.bz[part]}
        return Table(columns, {"t": "s", "bx": "T", "bz": "T"})
    words = [Run.contact_names[code] for code in run.contact[part]]
    return Table(
        {
            "t": run.t[part],
            "theta": run.theta[part],
            "slip_velocity": run.slip_velocity[part],
            "contact": words,
        },
        {"t": "s", "theta": "rad", "slip_velocity": "m/s", "contact": ""},
    )


def draw_motion(name: str, run: Run) -> Figure:
    """Draw one figure."""
    if name == "fig2":
        times = film_times(run)
        labels = [f"({k}) {_FRAME_WORDS[k]}, {t:.4f} s" for k, t in zip(FRAMES, times, strict=True)]
        return plot.filmstrip(run, times, labels)
    if name in ("fig4", "fig6"):
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
    begin = drive.ramp + (_FILM_PULSE - 1) * period
    tilt = np.abs(run.theta)

    def within(start: float, stop: float) -> np.ndarray:
        return np.flatnonzero((run.t >= start) & (run.t <= stop))

    first = within(begin, begin + period)
    steady = first[tilt[first].argmax()]
    second = within(run.t[steady], run.t[steady] + period)
    low = second[tilt[second].argmin()]
    third = within(run.t[low], run.t[low] + period)
    high = third[tilt[third].argmax()]
    rising = np.arange(low, high + 1)
    slips = np.nan_to_num(run.slip_velocity[rising])
    fastest = rising[slips.argmax()]
    return [float(run.t[k]) for k in (steady, low, fastest, high)]


def _film_table(run: Run) -> Table:
    shown = motion(run)
    samples = [shown.sample(time) for time in film_times(run)]
    touch = lowest_corner(shown)[samples]
    columns: dict[str, list[float] | list[str]] = {
        "frame": list(FRAMES),
        "t": shown.t[samples].tolist(),
        "x": shown.x[samples].tolist(),
        "z": shown.z[samples].tolist(),
        "theta": shown.theta[samples].tolist(),
        "contact_x": touch.tolist(),
        "contact_x_before": [np.nan, *touch[:-1].tolist()],
    }
    units = dict.fromkeys(columns, "m") | {"frame": "", "t": "s", "theta": "rad"}
    outlines = np.array([corners(shown, k) for k in samples])
    for number in range(4):
        for axis, letter in enumerate("xz"):
            columns[f"corner{number + 1}_{letter}"] = outlines[:, number, axis].tolist()
            units[f"corner{number + 1}_{letter}"] = "m"
    return Table(columns, units)
