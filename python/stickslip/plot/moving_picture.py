"""A motion as a moving picture: shown by notebooks, and written as GIF, HTML or MP4."""

from __future__ import annotations

import io
import math
import uuid
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter

from stickslip._util.atomic_files import check_suffix, replacing
from stickslip._util.html_page import in_base64, page_text
from stickslip.plot import style
from stickslip.plot.motion import Data, Motion, motion
from stickslip.plot.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Iterator

    from stickslip.simulation.simulate import Progress

STAGE = "drawing frames"
"""What `Animation.save` tells of its progress."""

MOST_FRAMES = 2000
"""Frames of one picture; chosen: a hundred seconds of it at the default rate."""

SLOWDOWN, FRAMES_PER_SECOND = 20.0, 20.0  # chosen: a pulse at 100 Hz takes a fifth of a second

_DOTS_PER_INCH = 100  # of a screen
_COLOURS = 128  # of a frame of HTML: a third of the bytes, and no difference that is seen


def animation(
    data: Data,
    start: float | None = None,
    stop: float | None = None,
    slowdown: float = SLOWDOWN,
    frames_per_second: float = FRAMES_PER_SECOND,
) -> Animation:
    """A motion as a moving picture, which a notebook shows.

    The body with its magnetic moment (blue), a mark where it touches, a bar as length scale, and
    beside them the field in the plane of motion as an arrow (green), whose length is that of the
    circle around it where the field is strongest. A picture of a long way moves with the body.

    A robot that leaves its plane is seen from its right, over the way that it has gone along its
    heading, and beside that from above on its path so far, with arrows of the heading. The field
    has an arrow for each of the two views.

    Parameters
    ----------
    data : Run or xarray.Dataset
        A run with a record on a uniform grid, or what its `to_xarray` gave.
    start, stop : float, optional
        Stretch of time to show, s; all of it, if not given.
    slowdown : float
        How many seconds of the picture are one second of the motion.
    frames_per_second : float
        Hz.

    Returns
    -------
    Animation
        Drawn when it is shown or saved, which takes a tenth of a second a frame. In a notebook and
        in HTML a frame has some 20 kB; with two views it is twice that.

    Raises
    ------
    AttributeError
        If a run has no record.
    ValueError
        If `slowdown` or `frames_per_second` is not finite and above zero, the stretch has less than
        two samples or gives more than 2000 frames, or the record is one of events.

    Examples
    --------
    >>> from stickslip import Drive, Record, Scenario, plot, simulate
    >>> run = simulate(Scenario(drive=Drive(pulses=3), record=Record(rate=1e4)))
    >>> plot.animation(run, start=0.05)
    <Animation: 12 frames, 0.6 s>
    """
    shown = motion(data).between(start, stop)
    count = frame_count(float(shown.t[-1] - shown.t[0]), slowdown, frames_per_second)
    return Animation(shown, count, frames_per_second)


def frame_count(
    duration: float, slowdown: float = SLOWDOWN, frames_per_second: float = FRAMES_PER_SECOND
) -> int:
    """How many frames a moving picture of `duration` (s) has; a ValueError if too many."""
    for name, value in (("slowdown", slowdown), ("frames_per_second", frames_per_second)):
        if not 0.0 < value < math.inf:
            raise ValueError(f"{name} = {value!r}: allowed is a finite number above 0")
    # A float, as the product of two finite numbers may be infinite.
    count = max(2.0, float(np.rint(duration * slowdown * frames_per_second)))
    if count > MOST_FRAMES:
        raise ValueError(
            f"{count:.15g} frames: allowed are at most {MOST_FRAMES}; choose a shorter stretch or "
            "less slowdown"
        )
    return int(count)


class Animation:
    """A moving picture. A notebook shows it with controls, without a network; `save` writes it.

    Attributes
    ----------
    frames : int
        Number of frames.
    frames_per_second : float
        Hz.
    """

    def __init__(self, shown: Motion, frames: int, frames_per_second: float) -> None:
        self.frames = frames
        self.frames_per_second = frames_per_second
        self._motion = shown
        self._drawn: list[str] | None = None  # frames of HTML, kept from the first time

    def __repr__(self) -> str:
        return f"<Animation: {self.frames} frames, {self.frames / self.frames_per_second:.3g} s>"

    def _repr_html_(self) -> str:
        return self._html("player.html")

    def save(self, path: str | PathLike[str], progress: Progress | None = None) -> None:
        """Write the moving picture, whole or not at all, in the format that the suffix names.

        Parameters
        ----------
        path : path-like
            ``.gif``; ``.html``, a page with controls that needs no network; or ``.mp4`` where the
            program ffmpeg is installed.
        progress : callable, optional
            Called as ``progress(fraction, stage)`` after every frame that is drawn.

        Raises
        ------
        ValueError
            If the suffix is another one.
        RuntimeError
            If ``.mp4`` is asked for and there is no ffmpeg.
        OSError
            If the file cannot be written; an older file of that name is then untouched.
        """
        check_moving_format(path)
        with replacing(path) as temporary:
            if Path(path).suffix.lower() == ".html":
                page = self._html("moving_picture.html", progress)
                temporary.write_text(page, encoding="utf-8")
                return
            writer = _writer(Path(path), self.frames_per_second)
            scenes = self._scenes(progress)
            scene = next(scenes)
            with writer.saving(scene.figure, str(temporary), _DOTS_PER_INCH):
                writer.grab_frame()
                for _ in scenes:
                    writer.grab_frame()

    def _scenes(self, progress: Progress | None) -> Iterator[Scene]:
        """The one scene, at one frame after the other."""
        t = self._motion.t
        with matplotlib.rc_context(style.RC):
            scene = Scene(self._motion)
            for done, time in enumerate(np.linspace(t[0], t[-1], self.frames), start=1):
                scene.show(self._motion.sample(time))
                yield scene
                if progress is not None:
                    progress(done / self.frames, STAGE)

    def _pictures(self, progress: Progress | None) -> list[str]:
        """Every frame as PNG in base64."""
        from PIL import Image

        pictures = []
        for scene in self._scenes(progress):
            raw, coded = io.BytesIO(), io.BytesIO()
            scene.figure.savefig(raw, format="png", dpi=_DOTS_PER_INCH)
            image = Image.open(raw).convert("RGB").quantize(_COLOURS)
            image.save(coded, "png")
            pictures.append(in_base64(coded.getvalue()))
        return pictures

    def _html(self, template: str, progress: Progress | None = None) -> str:
        if self._drawn is None:
            self._drawn = self._pictures(progress)
        return page_text(
            f"plot/{template}",
            pictures=self._drawn,
            # Two pictures of one page, or one that is shown twice, have controls of their own.
            name=f"stickslip-{uuid.uuid4().hex}",
            milliseconds=1000.0 / self.frames_per_second,
        )


def check_moving_format(path: str | PathLike[str]) -> None:
    """Refuse a name of a moving picture that cannot be written here.

    Raises
    ------
    ValueError
        If the suffix is none of ``.gif``, ``.html`` and ``.mp4``.
    RuntimeError
        If it is ``.mp4`` and there is no ffmpeg.
    """
    check_suffix(path, (".gif", ".html", ".mp4"))
    if Path(path).suffix.lower() == ".mp4" and not FFMpegWriter.isAvailable():
        raise RuntimeError(
            f"{path}: MP4 needs the program ffmpeg, which is not here; write a .gif or .html"
        )


def _writer(path: Path, frames_per_second: float) -> AbstractMovieWriter:
    kind = PillowWriter if path.suffix.lower() == ".gif" else FFMpegWriter
    return kind(fps=frames_per_second)  # type: ignore[arg-type]
