"""Writing figures to files."""

from __future__ import annotations

from os import PathLike

from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.figure import Figure

from stickslip._util.atomic_files import check_suffix, replacing

DOTS_PER_INCH = 150  # legible in print at half the width of a page


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
