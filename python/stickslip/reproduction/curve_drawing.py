"""Pictures of the figures of velocities, drawn from their tables."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip._util import palette
from stickslip._util.handy_units import in_handy_units
from stickslip.plot import style
from stickslip.reproduction.curves import CURVES
from stickslip.reproduction.measured import MeasuredPoint
from stickslip.reproduction.points import KINETIC_SHARE, PAINLEVE_FRICTION

_STYLES = {
    "IPP": (palette.BLUE, "-", "o"),
    "OPP": (palette.VERMILION, "--", "s"),
}
_SECOND = (palette.GREEN, "-.")
# Beyond this a velocity would press all others to the axis, m/s; below the other, mm/s, the scale
# stays linear; both chosen by eye.
_SYMLOG_ABOVE, _LINEAR_UP_TO = 20e-3, 5.0
_TICKS = (-5.0, -2.0, 0.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)


def draw_curves(name: str, table: pd.DataFrame, measured: Sequence[MeasuredPoint]) -> Figure:
    """Draw one figure of `CURVES`: medians as lines, the band from the 10th to the 90th percentile.

    `table` is one of `curve_tables`; those of the `measured` points that are of this figure are
    drawn on top.
    """
    curves = CURVES[name]
    factor, label = in_handy_units(curves.scan.axis, table.attrs["units"][curves.column])
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=(5.4, 3.4), layout="constrained")
        axes = figure.subplots()
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
