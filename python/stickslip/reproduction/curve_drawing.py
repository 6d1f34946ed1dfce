"""Pictures of the figures of velocities, drawn from their tables."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip._util import palette
from stickslip.plot import style
from stickslip.plot.units import Quantity, quantity
from stickslip.reproduction.curves import CURVES, Curves
from stickslip.reproduction.measured import MeasuredPoint
from stickslip.reproduction.scans import KINETIC_SHARE
from stickslip.reproduction.tables import Table

_WORDS = {
    "static_friction": "static friction coefficient",
    "adhesion": "adhesion",
    "linear": "linear drag coefficient",
    "rotational": "rotational drag coefficient",
    "frequency": "pulsing frequency",
    "peak": "greatest pulsing field",
}
_STYLES = {
    "IPP": (palette.BLUE, "-", "o"),
    "OPP": (palette.VERMILION, "--", "s"),
}
_SECOND = (palette.GREEN, "-.")
_PAINLEVE_FRICTION = 4.0 / 3.0
# Beyond this a velocity would press all others to the axis, m/s; below the other, mm/s, the scale
# stays linear.
_FAST, _LINEAR = 20e-3, 5.0
_TICKS = (-5.0, -2.0, 0.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)


def draw_curves(name: str, table: Table, measured: Sequence[MeasuredPoint]) -> Figure:
    """Draw one figure: medians as lines, the band from the 10th to the 90th percentile.

    Parameters
    ----------
    name : str
        Key of `CURVES`.
    table : Table
        From `curve_tables`.
    measured : sequence of MeasuredPoint
        Those of this figure are drawn on top.
    """
    curves = CURVES[name]
    across = quantity(_WORDS[curves.column], table.units[curves.column])
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=(5.4, 3.4), layout="constrained")
        axes = figure.subplots()
        for mode in curves.modes:
            for place, word in enumerate(curves.scans):
                rows = table.where("mode", mode).where("varied", word)
                colour, dashes, _ = _STYLES[mode]
                if place:
                    colour, dashes = _SECOND
                label = f"{mode}, {word}" if len(curves.scans) > 1 else mode
                _draw_band(axes, curves, rows, across, (colour, dashes, label))
        for mode in curves.modes:
            _draw_points(axes, [p for p in measured if (p.figure, p.mode) == (name, mode)], across)
        if curves.log:
            axes.set_xscale("log")
        if float(table["velocity_p90"].max()) > _FAST:
            _press_together(axes, table)
        if name == "fig8":
            _mark_painleve(axes)
        axes.margins(x=0.02)
        axes.set_xlabel(across.label)
        axes.set_ylabel("mean velocity (mm/s)")
        figure.legend(loc="outside upper center", ncols=2, frameon=False)
    return figure


def _draw_band(
    axes: Axes, curves: Curves, rows: Table, across: Quantity, look: tuple[str, str, str]
) -> None:
    colour, dashes, label = look
    x = rows[curves.column].astype(float) * across.factor
    axes.fill_between(
        x,
        rows["velocity_p10"] * 1e3,
        rows["velocity_p90"] * 1e3,
        color=colour,
        alpha=0.22,
        linewidth=0.0,
    )
    axes.plot(x, rows["velocity_median"] * 1e3, color=colour, linestyle=dashes, label=label)


def _draw_points(axes: Axes, points: Sequence[MeasuredPoint], across: Quantity) -> None:
    if points:
        _, _, marker = _STYLES[points[0].mode]
        axes.plot(
            [p.x * across.factor for p in points],
            [p.y * 1e3 for p in points],
            color=palette.BLACK,
            marker=marker,
            markerfacecolor="none",
            linestyle="none",
            label=f"{points[0].mode}, measured",
        )


def _press_together(axes: Axes, table: Table) -> None:
    """A scale that is linear near zero and logarithmic beyond."""
    low = min(float(table["velocity_p10"].min()) * 1e3, 0.0)
    high = float(table["velocity_p90"].max()) * 1e3
    axes.set_yscale("symlog", linthresh=_LINEAR)
    ticks = [tick for tick in _TICKS if low <= tick <= high]
    axes.set_yticks(ticks, labels=[f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.set_ylim(low - 0.1 * _LINEAR, 1.3 * high)


def _mark_painleve(axes: Axes) -> None:
    """From here on a sliding contact can have no consistent force."""
    first = _PAINLEVE_FRICTION / KINETIC_SHARE
    axes.axvline(first, color=palette.GREY, linestyle=":", label=r"$\mu_k$ = 4/3: Painlevé beyond")
