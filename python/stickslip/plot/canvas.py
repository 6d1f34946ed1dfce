"""Axes to draw in: the caller's, or those of a new figure."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure


def own_axes(ax: Axes | None, size: tuple[float, float]) -> Axes:
    """`ax`, or the axes of a new figure of a size in inches that is not bound to a window."""
    if ax is not None:
        return ax
    return Figure(figsize=size, layout="constrained").subplots()


def root_figure(axes: Axes) -> Figure:
    """The figure that holds some axes, also where they are part of a subfigure.

    Raises
    ------
    ValueError
        If the axes are in no figure any more.
    """
    figure = axes.figure
    if isinstance(figure, SubFigure):
        figure = figure.figure
    if not isinstance(figure, Figure):
        raise ValueError("the axes are in no figure")
    return figure
