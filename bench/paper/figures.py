"""The paper's figures: their data, and their pictures.

Figs. 2 (e) to (h) and 4 to 7 are single runs at 30 Hz, Figs. 8 to 15 mean velocities over one
quantity, as a band over small changes.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from paper.walks import (
    BASE,
    KINETIC_SHARE,
    MODES,
    SCANS,
    Scan,
    Setting,
    interval,
    small_changes,
    stroke_scenario,
)
from stickslip import Run, plot, simulate_batch, sweep
from stickslip._util import palette
from stickslip._util.arrays import Array
from stickslip._util.units import in_handy_units
from stickslip.plot.motion import corners, lowest_corner, motion
from stickslip.plot.style import drawing, root_figure
from stickslip.scenario.keys import known_keys
from stickslip.simulation.quantities import COLUMNS


class Curves(NamedTuple):
    """A figure of velocities: its modes, what is varied by its name in the figure, and where."""

    modes: tuple[str, ...]
    scans: Mapping[str, Scan]
    values: Array  # SI

    @property
    def scan(self) -> Scan:
        """The scan of the figure."""
        return next(iter(self.scans.values()))

    @property
    def column(self) -> str:
        """Name of the column of what is varied."""
        return self.scan.key.rpartition(".")[2]


_FREQUENCY = ({"frequency": SCANS["frequency"]}, np.linspace(5.0, 150.0, 30))
_FIELDS = (
    {
        "peak alone": SCANS["field"],
        "all fields in proportion": SCANS["field"]._replace(proportional=True),
    },
    np.linspace(1.5e-3, 6.5e-3, 26),
)
# Values span the axes of the paper's figures.
CURVES = {
    "fig8": Curves(MODES, {"friction": SCANS["friction"]}, np.linspace(0.02, 2.4, 35)),
    "fig9": Curves(MODES, {"adhesion": SCANS["adhesion"]}, np.linspace(0.0, 0.8e-6, 33)),
    "fig10": Curves(MODES, {"linear drag": SCANS["linear"]}, np.geomspace(1e-8, 1e-2, 31)),
    "fig11": Curves(
        MODES, {"rotational drag": SCANS["rotational"]}, np.geomspace(1e-18, 1e-12, 31)
    ),
    "fig12": Curves(("IPP",), *_FREQUENCY),
    "fig13": Curves(("OPP",), *_FREQUENCY),
    "fig14": Curves(("IPP",), *_FIELDS),
    "fig15": Curves(("OPP",), *_FIELDS),
}
"""The figures of velocities by name."""

_FIELD, _TILT = ("t", "bx", "bz"), ("t", "theta", "slip_velocity")
MOTIONS = {
    "fig2": ("OPP", ()),
    "fig4": ("IPP", _FIELD),
    "fig5": ("IPP", _TILT),
    "fig6": ("OPP", _FIELD),
    "fig7": ("OPP", _TILT),
}
"""The figures of single runs by name: mode, and what is drawn over time; Fig. 2 has outlines."""

FIGURES = (*MOTIONS, *CURVES)
"""Names of all figures, in the paper's order."""

_CSV_RATE = 5e3  # Hz; chosen: enough to draw the figure again
_SHOWN_PULSES = 4  # chosen: few enough to tell the strokes apart

_FRAMES = {
    "e": "steady angle",
    "f": "rocked down",
    "g": "slips forwards",
    "h": "steady angle again",
}
_FILM_PULSE = 8  # of twelve; chosen: the motion repeats itself by then

_STYLES = {"IPP": (palette.BLUE, "-", "o"), "OPP": (palette.VERMILION, "--", "s")}
_SECOND = (palette.GREEN, "-.")
# Beyond this a velocity would press all others to the axis, m/s; below the other, mm/s, the scale
# stays linear; both chosen by eye.
_SYMLOG_ABOVE, _LINEAR_UP_TO = 20e-3, 5.0
_TICKS = (-5.0, -2.0, 0.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)

# Beyond it a uniform rectangle that slides can have no consistent force: docs/theory/contact.md.
_PAINLEVE_FRICTION = 4.0 / 3.0


def with_units(columns: Mapping[str, Any], units: dict[str, str]) -> pd.DataFrame:
    """A table whose attribute "units" has the SI units of its columns."""
    frame = pd.DataFrame(columns)
    frame.attrs["units"] = units
    return frame


def reference_runs(reference: Mapping[str, Setting], threads: int | None) -> dict[str, Run]:
    """Twelve pulses at 30 Hz and a ramp down of the in-plane coil, for each mode."""
    scenarios = [
        stroke_scenario(chosen).replace({"drive.ramp_down": 0.05}) for chosen in reference.values()
    ]
    return dict(zip(reference, simulate_batch(scenarios, threads), strict=True))


def motion_table(name: str, run: Run) -> pd.DataFrame:
    """The data of a figure of a run.

    Of Fig. 2 a row for each frame with position, pitch, contact point, the one before, and the four
    corners; of the others what is drawn over time, at 5 kHz.
    """
    _, drawn = MOTIONS[name]
    if not drawn:
        return _film_table(run)
    part = slice(None, None, max(1, round(1.0 / (_CSV_RATE * interval(run)))))
    columns: dict[str, Any] = {column: getattr(run, column)[part] for column in drawn}
    units = {column: COLUMNS[column].unit for column in columns}
    if "theta" in columns:
        columns["contact"] = [Run.contact_names[code] for code in run.contact[part]]
    return with_units(columns, units)


def _film_table(run: Run) -> pd.DataFrame:
    shown = motion(run)
    samples = [shown.sample(time) for time in film_times(run)]
    touch = lowest_corner(shown)[samples]
    columns: dict[str, Any] = {
        "frame": list(_FRAMES),
        **{column: getattr(shown, column)[samples] for column in ("t", "x", "z", "theta")},
        "contact_x": touch,
        "contact_x_before": [np.nan, *touch[:-1]],
    }
    outlines = np.array([corners(shown, k) for k in samples])
    for number in range(4):
        columns[f"corner{number + 1}_x"] = outlines[:, number, 0]
        columns[f"corner{number + 1}_z"] = outlines[:, number, 1]
    units = dict.fromkeys([*columns][1:], "m") | {"t": "s", "theta": "rad"}
    return with_units(columns, units)


def film_times(run: Run) -> list[float]:
    """Times of the four frames, s.

    Greatest pitch after one edge, least before the next, greatest contact velocity as it rises
    again, and the greatest pitch after that; all within two pulses.
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


def draw_motion(name: str, run: Run) -> Figure:
    """Draw a figure of a run."""
    _, drawn = MOTIONS[name]
    if not drawn:
        times = film_times(run)
        frames = zip(_FRAMES.items(), times, strict=True)
        return plot.filmstrip(run, times, [f"({k}) {word}, {t:.4f} s" for (k, word), t in frames])
    if drawn == _FIELD:
        return plot.fields(run)
    # All twelve pulses and the ramps would be a smear, and are in the figure's data.
    start = run.scenario.window[0]
    stop = start + _SHOWN_PULSES / run.scenario.drive.frequency
    return plot.angle_and_contact_velocity(run, start, stop)


def curve_table(
    name: str, reference: Mapping[str, Setting], count: int, threads: int | None
) -> pd.DataFrame:
    """The data of a figure of velocities, with `count` small changes for each point.

    Columns are what is varied, `mode`, `varied` (words), `velocity` (m/s, without changes),
    `velocity_p10`, `velocity_median`, `velocity_p90` (m/s, over the small changes),
    `painleve_events` and `failed` (counts, over all changes).
    """
    curves, factors = CURVES[name], small_changes(count)
    lines = itertools.product(curves.modes, curves.scans, curves.values)
    at = [(value, mode, words) for mode, words, value in lines]
    rows = [
        curves.scans[words].changes(reference[mode], value, factor)
        for value, mode, words in at
        for factor in factors
    ]
    data = sweep(BASE, rows, threads=threads)
    velocity, events, status = (
        data[quantity].values.reshape(-1, count)
        for quantity in ("mean_velocity", "painleve_events", "status")
    )
    low, median, high = np.nanpercentile(velocity, [10.0, 50.0, 90.0], axis=1)
    frame = pd.DataFrame(at, columns=[curves.column, "mode", "varied"]).assign(
        velocity=velocity[:, 0],
        velocity_p10=low,
        velocity_median=median,
        velocity_p90=high,
        painleve_events=events.sum(axis=1),
        failed=(status != 0).sum(axis=1),
    )
    unit = known_keys()[curves.scan.key].unit
    units = {name: "m/s" for name in frame if name.startswith("velocity")}
    return with_units(frame, {curves.column: unit, **units})


def draw_curves(name: str, table: pd.DataFrame, points: pd.DataFrame | None = None) -> Figure:
    """Draw a figure of velocities: medians, and bands from the 10th to the 90th percentile.

    `table` is that of `curve_table`. Of the `points`, with the columns figure, mode, x (the SI
    unit of the figure's key) and y (m/s), those of this figure are drawn on top.
    """
    curves = CURVES[name]
    factor, label = in_handy_units(curves.scan.axis, table.attrs["units"][curves.column])
    with drawing(None, (5.4, 3.4)) as axes:
        for (mode, words), rows in table.groupby(["mode", "varied"], sort=False):
            is_first = curves.scans[words] == curves.scan
            colour, dashes = _STYLES[mode][:2] if is_first else _SECOND
            x, low, high = rows[curves.column] * factor, rows.velocity_p10, rows.velocity_p90
            axes.fill_between(x, low * 1e3, high * 1e3, color=colour, alpha=0.22, linewidth=0.0)
            words = f"{mode}, {words}" if len(curves.scans) > 1 else mode
            axes.plot(x, rows.velocity_median * 1e3, color=colour, linestyle=dashes, label=words)
        if points is not None:
            for mode, rows in points[points["figure"] == name].groupby("mode"):
                look: Any = {"color": palette.BLACK, "markerfacecolor": "none", "linestyle": "none"}
                marker, words = _STYLES[mode][2], f"{mode}, measured"
                axes.plot(rows["x"] * factor, rows["y"] * 1e3, marker=marker, label=words, **look)
        if name in ("fig10", "fig11"):
            axes.set_xscale("log")
        if table["velocity_p90"].max() > _SYMLOG_ABOVE:
            _scale_symmetrically(axes, table)
        if name == "fig8":
            first, words = _PAINLEVE_FRICTION / KINETIC_SHARE, r"$\mu_k$ = 4/3: Painlevé beyond"
            axes.axvline(first, color=palette.GREY, linestyle=":", label=words)
        axes.margins(x=0.02)
        axes.set_xlabel(label)
        axes.set_ylabel("mean velocity (mm/s)")
        figure = root_figure(axes)
        figure.legend(loc="outside upper center", ncols=2, frameon=False)
    return figure


def _scale_symmetrically(axes: Axes, table: pd.DataFrame) -> None:
    """A scale that is linear near zero and logarithmic beyond."""
    low = min(float(table["velocity_p10"].min()) * 1e3, 0.0)
    high = float(table["velocity_p90"].max()) * 1e3
    axes.set_yscale("symlog", linthresh=_LINEAR_UP_TO)
    ticks = [tick for tick in _TICKS if low <= tick <= high]
    axes.set_yticks(ticks, labels=[f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.set_ylim(low - 0.1 * _LINEAR_UP_TO, 1.3 * high)
