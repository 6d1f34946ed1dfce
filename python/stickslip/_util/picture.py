"""A matplotlib figure that a notebook shows."""

from __future__ import annotations

import io

from matplotlib.figure import Figure

_DOTS_PER_INCH = 100  # of a screen


class Picture(Figure):
    """A figure that a cell shows if it is the cell's last value, and that is in no window.

    A plain `matplotlib.figure.Figure` is shown by notebooks only after pyplot was imported, which
    nothing here does. It is shown once where pyplot was imported too: what is not made by pyplot
    is not shown by it at the end of a cell.
    """

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=_DOTS_PER_INCH)
        return buffer.getvalue()
