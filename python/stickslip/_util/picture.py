"""A matplotlib figure that a notebook shows, its style, and legends."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import matplotlib
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from stickslip._util import palette

# What a style of the user, such as dark_background or text in TeX, would make unreadable. Fonts
# stay, which may be those with the letters of a cause's name, and the formats of files.
_LOOK = (
    *("axes.", "contour.", "errorbar.", "figure.", "font.size", "grid.", "hatch.", "image."),
    *("legend.", "lines.", "markers.", "patch.", "path.", "pcolor", "savefig.edgecolor"),
    *("savefig.facecolor", "scatter.", "text.", "xaxis.", "xtick.", "yaxis.", "ytick."),
)

PLAIN: Any = {
    key: value for key, value in matplotlib.rcParamsDefault.items() if key.startswith(_LOOK)
}
"""The look of matplotlib, whatever the user's settings are."""

RC: Any = {
    **PLAIN,
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 10.0,
    "legend.fontsize": 8.0,
    "lines.linewidth": 1.2,
    "axes.grid": True,
    "grid.color": palette.LIGHT_GREY,
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
}


class Picture(Figure):
    """A figure that a cell shows if it is the cell's last value, and that is in no window.

    A plain `matplotlib.figure.Figure` is shown by notebooks only after pyplot was imported, which
    nothing here does. It is shown once where pyplot was imported too: what is not made by pyplot
    is not shown by it at the end of a cell. Ticks and colours of a file are made when it is drawn.
    """

    @matplotlib.rc_context(PLAIN)
    def draw(self, renderer: Any) -> None:
        super().draw(renderer)

    @matplotlib.rc_context(PLAIN)
    def savefig(self, fname: Any, **options: Any) -> None:
        super().savefig(fname, **options)

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=100)  # of a screen
        return buffer.getvalue()


def legend_above(
    axes: Axes, handles: Sequence[Artist], columns: int | None = None, title: str = ""
) -> None:
    """Above the axes, where it covers no curve; in one row, or in rows of some columns."""
    axes.legend(handles=list(handles), title=title, ncols=columns or len(handles),
                loc="lower left", bbox_to_anchor=(0.0, 1.0), alignment="left",
                frameon=False, borderaxespad=0.1)  # fmt: skip
