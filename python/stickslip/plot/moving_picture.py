"""A motion as a moving picture: shown by notebooks, and written as GIF, WebP or MP4."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.figure import Figure
from PIL import Image

from stickslip._util.files import check_suffix, replacing
from stickslip._util.html import in_base64
from stickslip.plot import style
from stickslip.plot.motion import Data, Motion, motion
from stickslip.plot.scene import Scene

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

STAGE = "drawing frames"
"""What `Animation.save` tells of its progress."""

MOST_FRAMES = 2000
"""Frames of one picture; chosen: a hundred seconds of it at the default rate."""

# Chosen by eye.
FRAMES_PER_SECOND = 20.0
_LONGEST = 10.0  # s, of a picture whose slowdown is not given
_PULSES = 5  # shown of a run with more
_DOTS_PER_INCH = 100  # of a screen
_COLOURS = 32  # of a GIF or WebP: chosen as the least that shows no difference


def animation(
    data: Data,
    start: float | None = None,
    stop: float | None = None,
    slowdown: float | None = None,
    frames_per_second: float = FRAMES_PER_SECOND,
) -> Animation:
    """A motion as a moving picture that repeats, which a notebook shows.

    The body with its magnetic moment, to scale; a dot at its lowest corner, whose colour says
    whether it sticks, slips or is in flight; below the surface the trace of this corner in the same
    colours; and the field over time with a mark that moves. The camera goes with the robot. A
    robot that leaves its plane is seen from its right, over the way along its heading, and beside
    that from above.

    Parameters
    ----------
    data : Run or xarray.Dataset
        A run with a record on a uniform grid, or what its `to_xarray` gave.
    start, stop : float, optional
        Stretch of time to show, s. Without them the last whole pulses of the measuring window, at
        most five, so that the last frame leads to the first; all of a voltage program.
    slowdown : float, optional
        How many seconds of the picture are one second of the motion. Without it a round number that
        makes the picture last ten seconds at most.
    frames_per_second : float
        Hz.

    Returns
    -------
    Animation
        Drawn when it is shown or saved, which takes a twentieth of a second a frame.

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
    >>> run = simulate(Scenario(drive=Drive(pulses=5), record=Record(rate=1e4)))
    >>> plot.animation(run)
    <Animation: 200 frames, 10 s>
    """
    return Animation(motion(data), start, stop, slowdown, frames_per_second)


def stretch(
    drive: Mapping[str, Any], begin: float, end: float, start: float | None, stop: float | None
) -> tuple[float, float]:
    """First and last time of the picture of a record from `begin` to `end`, s.

    `drive` has the keys of the scenario's drive; for `start` and `stop` see `animation`.
    """
    if start is None and stop is None and drive["mode"] != "program":
        period = 1.0 / drive["frequency"]
        steady = drive["ramp"] + 3.0 * period  # as in the measuring window
        # A time that the record ends at has the rounding of its own sum.
        pulses = min(drive["pulses"] - 3, math.floor((end - steady) / period + 1e-6))
        if pulses > 0:
            last = steady + pulses * period
            return max(begin, last - min(pulses, _PULSES) * period), last
    return (begin if start is None else start), (end if stop is None else stop)


def timing(
    duration: float, slowdown: float | None, frames_per_second: float = FRAMES_PER_SECOND
) -> tuple[int, float]:
    """Frames and slowdown of a picture of `duration` (s); a ValueError if there are too many."""
    if slowdown is None:
        most = 1.001 * _LONGEST / duration  # the duration has the rounding of its ends
        decade = 10.0 ** math.floor(math.log10(most))
        slowdown = max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= most)
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
    return int(count), slowdown


class Animation:
    """A moving picture that repeats. A notebook shows it; `save` writes it.

    Attributes
    ----------
    frames : int
        Number of frames.
    frames_per_second : float
        Hz.
    """

    def __init__(
        self,
        shown: Motion,
        start: float | None,
        stop: float | None,
        slowdown: float | None,
        frames_per_second: float,
    ) -> None:
        ends = float(shown.t[0]), float(shown.t[-1])
        first, last = stretch(shown.drive, *ends, start, stop)
        shown.between(first, last)  # refuses a stretch without samples
        self.frames, slowdown = timing(last - first, slowdown, frames_per_second)
        self.frames_per_second = frames_per_second
        self._motion, self._caption = shown, _pace(slowdown)
        # The instant at which the stretch ends is that of the first frame, in the next round.
        times = np.linspace(first, last, self.frames, endpoint=False)
        self._samples = [shown.sample(time) for time in (*times, last)]

    def __repr__(self) -> str:
        return f"<Animation: {self.frames} frames, {self.frames / self.frames_per_second:.3g} s>"

    def _repr_html_(self) -> str:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "shown.webp")
            self.save(path)
            content = in_base64(path.read_bytes())
        return f'<img alt="Moving picture of the robot" src="data:image/webp;base64,{content}">'

    def frame(self, number: int) -> Figure:
        """One frame as a figure; `number` is 0 for the first, and negative from the end."""
        with matplotlib.rc_context(style.RC):
            scene = self._scene()
            scene.show(self._samples[:-1][number])
        return scene.figure

    def save(self, path: str | PathLike[str], progress: Progress | None = None) -> None:
        """Write the moving picture, whole or not at all, in the format that the suffix names.

        Parameters
        ----------
        path : path-like
            ``.gif``, ``.webp``, or ``.mp4`` where the program ffmpeg is installed.
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
        kind = FFMpegWriter if Path(path).suffix.lower() == ".mp4" else _ImageWriter
        writer: AbstractMovieWriter = kind(fps=self.frames_per_second)  # type: ignore[arg-type]

        def report(number: int, _: int | None) -> None:
            if progress is not None:
                progress((number + 1) / self.frames, STAGE)

        with replacing(path) as temporary, matplotlib.rc_context(style.RC):
            scene = self._scene()
            drawn = FuncAnimation(scene.figure, scene.show, frames=self._samples[:-1])
            drawn.save(temporary, writer=writer, dpi=_DOTS_PER_INCH, progress_callback=report)

    def _scene(self) -> Scene:
        return Scene(self._motion, self._samples[0], self._samples[-1], self._caption)


def _pace(slowdown: float) -> str:
    """What a picture says of its time."""
    if slowdown == 1.0:
        return "real time"
    if slowdown < 1.0:
        return f"{1.0 / slowdown:.3g} times faster"
    return f"{slowdown:.3g} times slower"


class _ImageWriter(PillowWriter):
    """Frames of one palette: small files, whose still parts have the same bits in all frames."""

    _frames: list[Image.Image]

    def finish(self) -> None:
        palette = self._frames[0].quantize(_COLOURS)
        plain = Image.Dither.NONE
        first, *rest = (each.quantize(palette=palette, dither=plain) for each in self._frames)
        webp: Any = {"lossless": True, "method": 6}  # half the bytes of the default
        duration = round(1000.0 / self.fps)  # ms
        first.save(
            self.outfile, save_all=True, append_images=rest, duration=duration, loop=0, **webp
        )


def check_moving_format(path: str | PathLike[str]) -> None:
    """Refuse a name of a moving picture that cannot be written here.

    Raises
    ------
    ValueError
        If the suffix is none of ``.gif``, ``.webp`` and ``.mp4``.
    RuntimeError
        If it is ``.mp4`` and there is no ffmpeg.
    """
    check_suffix(path, (".gif", ".webp", ".mp4"))
    if Path(path).suffix.lower() == ".mp4" and not FFMpegWriter.isAvailable():
        raise RuntimeError(
            f"{path}: MP4 needs the program ffmpeg, which is not here; write a .gif or .webp"
        )
