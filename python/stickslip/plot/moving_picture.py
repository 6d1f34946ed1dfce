"""A motion as a moving picture: GIF, or MP4 where ffmpeg is installed."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from stickslip._util import palette
from stickslip._util.atomic_files import check_suffix, replacing
from stickslip.plot import style
from stickslip.plot.film import draw_arrow, draw_body, frame, mark_contact
from stickslip.plot.motion import Data, Motion, corners, lowest_corner, motion

MOST_FRAMES = 2000
"""Frames of one picture; chosen: a hundred seconds of it at the default rate."""

_DOTS_PER_INCH = 100  # of a screen
_FIELD_ARROW = 60.0  # µm, length for the strongest field; chosen by eye
_MARGIN = 30.0  # µm; chosen by eye


def animation(
    data: Data,
    path: str | PathLike[str],
    start: float | None = None,
    stop: float | None = None,
    slowdown: float = 20.0,
    frames_per_second: float = 20.0,
) -> int:
    """Write a motion as a moving picture.

    The body with its moment (blue), the field as an arrow beside it (green), and a mark where it
    touches.

    Parameters
    ----------
    data : Run or xarray.Dataset
        A run with a record on a uniform grid, or what its `to_xarray` gave.
    path : path-like
        File to write: ``.gif``, or ``.mp4`` where the program ffmpeg is installed.
    start, stop : float, optional
        Stretch of time to show, s; all of it, if not given.
    slowdown : float
        How many seconds of the picture are one second of the motion.
    frames_per_second : float
        Hz.

    Returns
    -------
    int
        Number of frames.

    Raises
    ------
    AttributeError
        If a run has no record.
    ValueError
        If the suffix is neither, `slowdown` or `frames_per_second` not above zero, the stretch has
        less than two samples or gives more than 2000 frames, or the record is one of events.
    RuntimeError
        If ``.mp4`` is asked for and there is no ffmpeg.
    OSError
        If the file cannot be written; an older file of that name is then untouched.
    """
    writer = _writer(Path(path), frames_per_second)
    if not slowdown > 0.0:
        raise ValueError(f"slowdown = {slowdown!r}: allowed is a number above 0")
    shown = motion(data).between(start, stop)
    duration = float(shown.t[-1] - shown.t[0])
    count = max(2, round(duration * slowdown * frames_per_second))
    if count > MOST_FRAMES:
        raise ValueError(
            f"{count} frames: allowed are at most {MOST_FRAMES}; choose a shorter stretch or less "
            "slowdown"
        )
    samples = [shown.sample(t) for t in np.linspace(shown.t[0], shown.t[-1], count)]
    with matplotlib.rc_context(style.RC), replacing(path) as temporary:
        figure = Figure(figsize=(6.4, 3.2), dpi=_DOTS_PER_INCH, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots()
        view = _View(shown)
        with writer.saving(figure, str(temporary), _DOTS_PER_INCH):
            for sample in samples:
                view.draw(axes, sample)
                writer.grab_frame()
    return count


def _writer(path: Path, frames_per_second: float) -> AbstractMovieWriter:
    if not frames_per_second > 0.0:
        raise ValueError(f"frames_per_second = {frames_per_second!r}: allowed is a number above 0")
    check_suffix(path, (".gif", ".mp4"))
    if path.suffix.lower() == ".gif":
        return PillowWriter(fps=frames_per_second)  # type: ignore[arg-type]
    if not FFMpegWriter.isAvailable():
        raise RuntimeError(f"{path}: MP4 needs the program ffmpeg, which is not here; write a .gif")
    return FFMpegWriter(fps=frames_per_second)  # type: ignore[arg-type]


class _View:
    """What stays the same from frame to frame."""

    def __init__(self, shown: Motion) -> None:
        self._motion = shown
        self._touch = lowest_corner(shown) * 1e6
        reach = 0.5 * float(np.hypot(shown.length, shown.height)) * 1e6
        x = shown.x * 1e6
        self._left, self._right = x.min() - reach - _MARGIN, x.max() + reach + 2.0 * _FIELD_ARROW
        self._top = max(float((shown.z * 1e6).max()) + reach, 2.5 * _FIELD_ARROW) + _MARGIN
        strongest = float(np.hypot(shown.bx, shown.bz).max())
        self._arrow = _FIELD_ARROW / strongest if strongest > 0.0 else 0.0

    def draw(self, axes: Axes, sample: int) -> None:
        shown = self._motion
        axes.clear()
        draw_body(axes, shown, sample)
        mark_contact(axes, float(self._touch[sample]), float(self._touch[0]))
        right = float(corners(shown, sample)[:, 0].max()) * 1e6 + _MARGIN
        foot = (min(right, self._right - _FIELD_ARROW), self._top - 1.3 * _FIELD_ARROW)
        field = (shown.bx[sample] * self._arrow, shown.bz[sample] * self._arrow)
        draw_arrow(axes, foot, (foot[0] + field[0], foot[1] + field[1]), palette.GREEN, 1.8)
        frame(axes, (self._left, self._right), (-_MARGIN, self._top))
        axes.set_xlabel("x (µm)")
        axes.set_ylabel("z (µm)")
        axes.set_title(
            f"t = {shown.t[sample] * 1e3:.1f} ms, "
            f"tilt {np.degrees(shown.theta[sample]):.1f} degrees",
            loc="left",
        )
