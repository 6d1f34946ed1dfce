"""Axes to draw in: the caller's, or those of a new figure."""

from __future__ import annotations

from collections.abc import Callable

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from stickslip.plot import style


def drawn(draw: Callable[[Axes], object], ax: Axes | None, size: tuple[float, float]) -> Figure:
    """The figure of `ax`, or a new one of a size in inches, with what `draw` adds to its axes.

    A new figure is not bound to a window.
    """
    with matplotlib.rc_context(style.RC):
        axes = ax or Figure(figsize=size, layout="constrained").subplots()
        draw(axes)
    return root_figure(axes)


def root_figure(axes: Axes) -> Figure:
    """The figure that holds some axes, also where they are part of a subfigure."""
    figure = axes.figure
    if isinstance(figure, SubFigure):
        figure = figure.figure
    if not isinstance(figure, Figure):
        raise ValueError("the axes are in no figure")
    return figure
