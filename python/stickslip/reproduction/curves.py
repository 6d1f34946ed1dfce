"""The paper's Figs. 8 to 15: mean velocity over one quantity, as a band over small changes.

Their data, and their pictures, over which points can be laid that a reader has digitised from the
paper's plots: its text holds none of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip._util import palette
from stickslip._util.text import number
from stickslip._util.units import in_handy_units
from stickslip.errors import ScenarioError
from stickslip.measurement.tables import check_columns, read_rows
from stickslip.plot.canvas import drawing, root_figure
from stickslip.reproduction.points import (
    KINETIC_SHARE,
    PAINLEVE_FRICTION,
    SCANS,
    Array,
    Scan,
    evaluate,
    varied,
)
from stickslip.reproduction.settings import MODES, Mode, Setting
from stickslip.reproduction.tables import table
from stickslip.scenario.keys import known_keys, meant, shown

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

_UNITS = {
    "mode": "", "varied": "", "velocity": "m/s", "velocity_p10": "m/s", "velocity_median": "m/s",
    "velocity_p90": "m/s", "painleve_events": "1", "failed": "1",
}  # fmt: skip
"""Columns of a table beside what is varied."""

LOW, HIGH = 10.0, 90.0
"""Percentiles of the band: a choice of this study, which its page names."""


_STYLES = {
    "IPP": (palette.BLUE, "-", "o"),
    "OPP": (palette.VERMILION, "--", "s"),
}
_SECOND = (palette.GREEN, "-.")
# Beyond this a velocity would press all others to the axis, m/s; below the other, mm/s, the scale
# stays linear; both chosen by eye.
_SYMLOG_ABOVE, _LINEAR_UP_TO = 20e-3, 5.0
_TICKS = (-5.0, -2.0, 0.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)

MEASURED_COLUMNS = {"figure": None, "mode": None, "x": "-", "y": "m/s"}

_MAX_VELOCITY = 1.0  # m/s; far above any robot's, and a velocity that is given in mm/s is above it


@dataclass(frozen=True, eq=False)
class Curves:
    """One figure of velocities."""

    modes: tuple[Mode, ...]
    scans: tuple[Scan, ...]  # the first is that of the figure
    values: Array  # where it is evaluated, SI
    caption: str
    log: bool = False  # whether the values are spread evenly in their logarithm

    @property
    def scan(self) -> Scan:
        """The scan of the figure."""
        return self.scans[0]

    @property
    def column(self) -> str:
        """Name of the column that holds what is varied."""
        return self.scan.key.rpartition(".")[2]


_FREQUENCY = ((SCANS["frequency"],), np.linspace(5.0, 150.0, 30))
_FIELDS = ((SCANS["field"], SCANS["fields"]), np.linspace(1.5e-3, 6.5e-3, 26))
_OVER_FIELDS = (
    "velocity over the sawtooth's top at 30 Hz, alone and with base and hold in proportion."
)

# Values span the axes of the paper's figures.
CURVES: dict[str, Curves] = {
    "fig8": Curves(
        MODES,
        (SCANS["friction"],),
        np.linspace(0.02, 2.4, 35),
        "Velocity over static friction at 100 Hz and 2.5 mT; kinetic friction is 0.7 of it.",
    ),
    "fig9": Curves(
        MODES,
        (SCANS["adhesion"],),
        np.linspace(0.0, 0.8e-6, 33),
        "Velocity over adhesion at 100 Hz and 2.5 mT.",
    ),
    "fig10": Curves(
        MODES,
        (SCANS["linear"],),
        np.geomspace(1e-8, 1e-2, 31),
        "Velocity over the linear drag coefficient at 100 Hz and 2.5 mT.",
        log=True,
    ),
    "fig11": Curves(
        MODES,
        (SCANS["rotational"],),
        np.geomspace(1e-18, 1e-12, 31),
        "Velocity over the rotational drag coefficient at 100 Hz and 2.5 mT.",
        log=True,
    ),
    "fig12": Curves(("IPP",), *_FREQUENCY, "IPP: velocity over frequency at 2.5 mT."),
    "fig13": Curves(("OPP",), *_FREQUENCY, "OPP: velocity over frequency at 2.5 mT."),
    "fig14": Curves(("IPP",), *_FIELDS, f"IPP: {_OVER_FIELDS}"),
    "fig15": Curves(("OPP",), *_FIELDS, f"OPP: {_OVER_FIELDS}"),
}
"""The figures of velocities by name."""


def curve_tables(
    names: Sequence[str],
    reference: Mapping[Mode, Setting],
    count: int,
    threads: int,
    progress: Progress | None = None,
) -> dict[str, pd.DataFrame]:
    """The data of some figures, keys of `CURVES`, with `count` small changes for each point.

    Columns are what is varied, `mode`, `varied` (words), `velocity` (m/s, without changes),
    `velocity_p10`, `velocity_median`, `velocity_p90` (m/s, over the small changes),
    `painleve_events` and `failed` (counts, over all changes).
    """
    lines = [
        (name, mode, scan)
        for name in names
        for mode in CURVES[name].modes
        for scan in CURVES[name].scans
    ]
    if not lines:
        return {}
    batches = [
        varied(scan.points([reference[mode]], CURVES[name].values)[0], count)
        for name, mode, scan in lines
    ]
    parts: dict[str, list[pd.DataFrame]] = {name: [] for name in names}
    for (name, mode, scan), result in zip(lines, evaluate(batches, threads, progress), strict=True):
        curves, velocity = CURVES[name], result["mean_velocity"]
        low, median, high = np.nanpercentile(velocity, [LOW, 50.0, HIGH], axis=1)
        columns = {
            curves.column: curves.values,
            "mode": mode,
            "varied": scan.words,
            "velocity": velocity[:, 0],
            "velocity_p10": low,
            "velocity_median": median,
            "velocity_p90": high,
            "painleve_events": result["painleve"].sum(axis=1),
            "failed": (result["status"] != 0).sum(axis=1),
        }
        parts[name].append(pd.DataFrame(columns))
    tables = {}
    for name, each in parts.items():
        unit = known_keys()[CURVES[name].scan.key].unit
        units = {CURVES[name].column: "1" if unit == "-" else unit, **_UNITS}
        tables[name] = table(pd.concat(each, ignore_index=True), units)
    return tables


class MeasuredPoint(NamedTuple):
    """One point: its figure and mode, x in the SI unit of the figure's key, y in m/s."""

    figure: str
    mode: str
    x: float
    y: float


def read_measured(path: str | PathLike[str]) -> list[MeasuredPoint]:
    """Read a CSV file with the columns figure, mode, x and y, in any order."""
    path = Path(path)
    table = read_rows(path, MEASURED_COLUMNS)
    header, rows = table.header, table.rows
    check_columns(path, header, MEASURED_COLUMNS)
    points = []
    for line, cells in rows:
        where = f"{path}: line {line}"
        if len(cells) != len(header):
            raise ScenarioError(f"{where}: {len(cells)} cells; allowed are {len(header)}")
        points.append(_point(where, dict(zip(header, cells, strict=True))))
    return points


def _point(where: str, row: dict[str, str]) -> MeasuredPoint:
    figure, mode = row["figure"], row["mode"]

    def refuse_unless(allowed: bool, name: str, what: str) -> None:
        if not allowed:
            raise ScenarioError(f"{where}: {name} = {shown(row[name])}: allowed {what}")

    hint = meant(figure, CURVES)
    refuse_unless(figure in CURVES, "figure", f"is one of {', '.join(CURVES)}{hint}")
    modes = CURVES[figure].modes
    refuse_unless(mode in modes, "mode", f"in {figure} is {' or '.join(modes)}")
    key = known_keys()[CURVES[figure].scan.key]
    x, y = number(row["x"]), number(row["y"])
    refuse_unless(key.low <= x <= key.high, "x", f"is {key.name}, {key.allowed}")
    refuse_unless(abs(y) <= _MAX_VELOCITY, "y", "is a velocity in m/s from -1 to 1")
    return MeasuredPoint(figure, mode, x, y)


def draw_curves(name: str, table: pd.DataFrame, measured: Sequence[MeasuredPoint]) -> Figure:
    """Draw one figure of `CURVES`: medians as lines, the band from the 10th to the 90th percentile.

    `table` is one of `curve_tables`; those of the `measured` points that are of this figure are
    drawn on top.
    """
    curves = CURVES[name]
    factor, label = in_handy_units(curves.scan.axis, table.attrs["units"][curves.column])
    with drawing(None, (5.4, 3.4)) as axes:
        for mode in curves.modes:
            for place, scan in enumerate(curves.scans):
                rows = table[(table["mode"] == mode) & (table["varied"] == scan.words)]
                colour, dashes = _SECOND if place else _STYLES[mode][:2]
                x = rows[curves.column].to_numpy() * factor
                low, high = rows["velocity_p10"] * 1e3, rows["velocity_p90"] * 1e3
                axes.fill_between(x, low, high, color=colour, alpha=0.22, linewidth=0.0)
                words = f"{mode}, {scan.words}" if len(curves.scans) > 1 else mode
                median = rows["velocity_median"] * 1e3
                axes.plot(x, median, color=colour, linestyle=dashes, label=words)
        for mode in curves.modes:
            points = [p for p in measured if (p.figure, p.mode) == (name, mode)]
            if points:
                axes.plot(
                    [p.x * factor for p in points],
                    [p.y * 1e3 for p in points],
                    color=palette.BLACK,
                    marker=_STYLES[mode][2],
                    markerfacecolor="none",
                    linestyle="none",
                    label=f"{mode}, measured",
                )
        if curves.log:
            axes.set_xscale("log")
        if table["velocity_p90"].max() > _SYMLOG_ABOVE:
            _scale_symmetrically(axes, table)
        if name == "fig8":
            # From here on a sliding contact can have no consistent force.
            first = PAINLEVE_FRICTION / KINETIC_SHARE
            beyond = r"$\mu_k$ = 4/3: Painlevé beyond"
            axes.axvline(first, color=palette.GREY, linestyle=":", label=beyond)
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
