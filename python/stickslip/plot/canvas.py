"""Axes to draw in, legends above them, and figures written to files."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from os import PathLike

import matplotlib
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.figure import Figure, SubFigure

from stickslip._util.files import check_suffix, replacing
from stickslip._util.picture import Picture
from stickslip.plot import style

DOTS_PER_INCH = 150  # legible in print at half the width of a page


@contextlib.contextmanager
def drawing(ax: Axes | None, size: tuple[float, float]) -> Iterator[Axes]:
    """The axes `ax`, or those of a new figure of a size in inches, to draw in with this style.

    A new figure is not bound to a window.
    """
    with matplotlib.rc_context(style.RC):
        yield ax or Picture(figsize=size, layout="constrained").subplots()


def root_figure(axes: Axes) -> Figure:
    """The figure that holds some axes, also where they are part of a subfigure."""
    figure = axes.figure
    if isinstance(figure, SubFigure):
        figure = figure.figure
    if not isinstance(figure, Figure):
        raise ValueError("the axes are in no figure")
    return figure


def legend_above(axes: Axes, handles: Sequence[Artist], columns: int | None = None) -> None:
    """Above the axes, where it covers no curve; in one row, or in rows of some columns."""
    axes.legend(
        handles=list(handles),
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=columns or len(handles),
        frameon=False,
        borderaxespad=0.1,
    )


def check_format(path: str | PathLike[str]) -> None:
    """Refuse a name whose suffix is no format of pictures.

    Raises
    ------
    ValueError
        Naming the suffixes that are.
    """
    formats = FigureCanvasBase.get_supported_filetypes()
    check_suffix(path, tuple(f".{each}" for each in sorted(formats)))


def save(figure: Figure, path: str | PathLike[str]) -> None:
    """Write a figure, whole or not at all, in the format that the path's suffix names.

    Raises
    ------
    ValueError
        If the suffix is no format of pictures.
    OSError
        If the file cannot be written; an older file of that name is then untouched.
    """
    check_format(path)
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=DOTS_PER_INCH)
