"""A motion as a moving picture: shown by notebooks, and written as GIF, WebP, MP4 or HTML."""

from __future__ import annotations

import base64
import math
import tempfile
from collections.abc import Callable
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.animation import (
    AbstractMovieWriter,
    FFMpegWriter,
    FuncAnimation,
    HTMLWriter,
    PillowWriter,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from PIL import Image

from stickslip._util import palette
from stickslip._util.files import check_suffix, replacing
from stickslip._util.messages import check_above_zero
from stickslip._util.picture import RC, Picture
from stickslip.plot import style
from stickslip.plot.above import frame_from_above, heading_arrows
from stickslip.plot.curves import draw_fields
from stickslip.plot.motion import Motion, check_times, corners, footprint, lowest_corner, motion
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.run import Run
from stickslip.simulation.simulate import Progress, check_progress

_MOST_FRAMES = 2000  # chosen: a hundred seconds of a picture at the default rate

# Chosen by eye.
_FRAMES_PER_SECOND = 20.0
_LONGEST = 10.0  # s, of a picture whose slowdown is not given
_PULSES = 5  # shown of a run with more
_DOTS_PER_INCH = 100  # of a screen
_COLOURS = 64  # of a GIF or WebP: chosen as the least that shows no difference
_WHITE = 244  # of a palette: darker than white, and lighter than all that is drawn
_MOST_MEGABYTES = 500.0  # of an HTML page: chosen above what the most frames take

_WIDTH, _ABOVE_WIDTH, _FIELD_HEIGHT = 6.4, 4.2, 1.4  # inches
_DIAGONALS = 2.1  # width of the side view over the diagonal of the body
_HEADROOM, _DEPTH = 14.0, 38.0  # µm, above the highest corner, and of the ground
_LEAST_HEIGHT = 0.8  # of the side view, in the same diagonals: the words stand above the body
_TRACE = -19.0  # µm, height of the trace
_TICKS = 0.12  # from one tick of the ground to the next, as part of the width
_LONGEST_BAR = 0.25  # of the length scale, as a part of the width

# Where it sticks a corner leaves a point, which is drawn as an upright bar.
_BAR: Any = {"marker": "|", "markersize": 13.0, "markeredgewidth": 2.5, "linestyle": "none"}
_LINE: Any = {"linewidth": 5.0, "solid_capstyle": "butt"}
_TRACE_ORDER = {"flight": 2.0, "slip": 2.1, "stick": 2.2}


def animation(
    run: Run,
    start: float | None = None,
    stop: float | None = None,
    slowdown: float | None = None,
    frames_per_second: float = _FRAMES_PER_SECOND,
) -> Animation:
    """A motion as a moving picture that repeats, which a notebook shows.

    The body from its right with its magnetic moment, to scale; a dot at its lowest corner, whose
    colour says whether it sticks, slips or is in flight; below the surface the trace of this corner
    in the same colours; and the field over time with a mark that moves. The camera goes with the
    robot. Of a run in the whole plane there is a view from above too. It is drawn when it is shown
    or saved, which takes a twentieth of a second a frame. What is not listed here is that of
    `fields`.

    Parameters
    ----------
    start, stop : float, optional
        Stretch of time to show, s. Without them the last whole pulses of the measuring window, at
        most five, so that the last frame leads to the first; all of a voltage program.
    slowdown : float, optional
        How many seconds of the picture are one second of the motion. Without it a round number that
        makes the picture last ten seconds at most.
    frames_per_second : float
        Hz.

    Raises
    ------
    ValueError
        If `slowdown` or `frames_per_second` is not finite and above zero, or there would be more
        than 2000 frames.

    Examples
    --------
    >>> from stickslip import Drive, Record, Scenario, plot, simulate
    >>> run = simulate(Scenario(drive=Drive(pulses=5), record=Record(rate=1e4)))
    >>> plot.animation(run)
    <Animation: 200 frames, 10 s>
    """
    shown = motion(run)
    check_times(start=start, stop=stop)
    ends = float(shown.t[0]), float(shown.t[-1])
    first, last = _stretch(run.scenario, *ends, start, stop)
    shown.between(first, last)  # refuses a stretch without samples
    frames, slowdown = _timing(last - first, slowdown, frames_per_second)
    # The instant at which the stretch ends is that of the first frame, in the next round.
    times = np.linspace(first, last, frames + 1)
    samples = [shown.sample(time) for time in times]
    return Animation(shown, samples, _pace(slowdown), frames_per_second)


def _stretch(
    scenario: Scenario, begin: float, end: float, start: float | None, stop: float | None
) -> tuple[float, float]:
    """First and last time of the picture of a record from `begin` to `end`, s."""
    rate = scenario.pulse_rate
    if start is None and stop is None and rate > 0.0:
        period = 1.0 / rate
        steady, stopped = scenario.window
        # A time that the record ends at has the rounding of its own sum.
        pulses = math.floor((min(stopped, end) - steady) / period + 1e-6)
        if pulses > 0:
            last = steady + pulses * period
            return max(begin, last - min(pulses, _PULSES) * period), last
    return (begin if start is None else start), (end if stop is None else stop)


def _timing(
    duration: float, slowdown: float | None, frames_per_second: float = _FRAMES_PER_SECOND
) -> tuple[int, float]:
    """Frames and slowdown of a picture of `duration`, s."""
    if slowdown is None:
        most = 1.001 * _LONGEST / duration  # the duration has the rounding of its ends
        slowdown = _round_below(most)
    check_above_zero("slowdown", slowdown, "seconds a second")
    check_above_zero("frames_per_second", frames_per_second, "Hz")
    # A float, as the product of two finite numbers may be infinite.
    count = max(2.0, float(np.rint(duration * slowdown * frames_per_second)))
    if count > _MOST_FRAMES:
        raise ValueError(
            f"{count:.15g} frames: allowed are at most {_MOST_FRAMES}; choose a shorter time or "
            "less slowdown"
        )
    return int(count), slowdown


def _round_below(most: float) -> float:
    """The largest number up to `most` that is 1, 2 or 5 times a power of ten."""
    decade = 10.0 ** math.floor(math.log10(most))
    return max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= most)


def _pace(slowdown: float) -> str:
    """The caption of a picture's time scale."""
    if slowdown == 1.0:
        return "real time"
    if slowdown < 1.0:
        return f"{1.0 / slowdown:.3g} times faster"
    return f"{slowdown:.3g} times slower"


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
        self, shown: Motion, samples: list[int], caption: str, frames_per_second: float
    ) -> None:
        self.frames, self.frames_per_second = len(samples) - 1, frames_per_second
        self._motion, self._samples, self._caption = shown, samples, caption

    def __repr__(self) -> str:
        return f"<Animation: {self.frames} frames, {self.frames / self.frames_per_second:.3g} s>"

    def _repr_html_(self) -> str:
        # An image, and no player: GitHub shows no scripts of notebooks.
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "shown.webp")
            self.save(path)
            content = base64.b64encode(path.read_bytes()).decode("ascii")
        return f'<img alt="Moving picture of the robot" src="data:image/webp;base64,{content}">'

    def frame(self, number: int) -> Figure:
        """One frame as a figure; `number` is 0 for the first, and negative from the end."""
        with matplotlib.rc_context(RC):
            figure, show = self._scene()
            show(self._samples[:-1][number])
        return figure

    def save(self, path: str | PathLike[str], progress: Progress | None = None) -> None:
        """Write the moving picture, whole or not at all, in the format that the suffix names.

        Parameters
        ----------
        path : path-like
            ``.gif``, ``.webp``, ``.html`` (a page with a player), or ``.mp4`` where the program
            ffmpeg is installed.
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
        check_progress(progress)
        check_moving_format(path)
        rate: Any = {"fps": self.frames_per_second}
        writer: AbstractMovieWriter
        match Path(path).suffix.lower():
            case ".mp4":
                writer = FFMpegWriter(**rate)
            case ".html":
                page: Any = {"embed_frames": True, "embed_limit": _MOST_MEGABYTES}
                writer = HTMLWriter(**rate, **page)
            case _:
                writer = _ImageWriter(**rate)

        def report(number: int, _: int | None) -> None:
            if progress is not None:
                progress((number + 1) / self.frames, "drawing frames")

        with replacing(path) as temporary, matplotlib.rc_context(RC):
            figure, show = self._scene()
            drawn = FuncAnimation(figure, show, frames=self._samples[:-1])
            drawn.save(temporary, writer=writer, dpi=_DOTS_PER_INCH, progress_callback=report)

    def _scene(self) -> tuple[Figure, Callable[[int], None]]:
        """A figure, and what moves all in it to where it is at one sample."""
        shown, first, last = self._motion, self._samples[0], self._samples[-1]
        robot = shown.scenario.robot
        diagonal = math.hypot(robot.length, robot.height) * 1e6
        highest = float(corners(shown, slice(first, last + 1))[..., 1].max()) * 1e6
        top = max(highest + _HEADROOM, _LEAST_HEIGHT * diagonal)
        width = max(_DIAGONALS * diagonal, top)
        heights = _WIDTH * (top + _DEPTH) / width, _FIELD_HEIGHT
        widths = [_WIDTH, _ABOVE_WIDTH] if shown.scenario.whole_plane else [_WIDTH]
        exact = ConstrainedLayoutEngine(hspace=0.0, wspace=0.0)  # lengths have one scale
        figure = Picture(figsize=(sum(widths), sum(heights)), layout=exact)
        left, *right = figure.subfigures(1, len(widths), width_ratios=widths, squeeze=False)[0]
        upper, lower = left.subfigures(2, 1, height_ratios=heights)
        side = upper.add_axes((0.0, 0.0, 1.0, 1.0))
        side.set(xlim=(0.0, width), ylim=(-_DEPTH, top))
        moved = [
            _side_view(side, shown, first, last, self._caption),
            _field_strip(lower.subplots(), shown, first, last),
        ]
        if right:
            moved.append(_view_from_above(right[0].subplots(), shown, first, last))

        def show(sample: int) -> None:
            for move in moved:
                move(sample)

        show(first)
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # panels stay where they are in the first frame
        return figure, show


def _side_view(
    axes: Axes, shown: Motion, first: int, last: int, caption: str
) -> Callable[[int], None]:
    """Draw the body on the surface, seen from its right, in µm; what moves it and the camera.

    The camera goes at a constant speed, so that a stretch of steady pulses ends as it began, and
    leaves its course only where it would lose the body.
    """
    outlines, touch = corners(shown) * 1e6, lowest_corner(shown) * 1e6
    along, t, width = shown.way * 1e6, shown.t, float(np.ptp(axes.get_xlim()))
    gone = float(along[last] - along[first])
    course = along[first] + gone * (t - t[first]) / (t[last] - t[first])
    course += np.mean(np.percentile((along - course)[first : last + 1], [0.0, 100.0]))
    slack = 0.5 * (width - float(np.linalg.norm(outlines[0, 0] - outlines[0, 2])))
    camera = np.clip(course, along - slack, along + slack)

    axes.set_axis_off()
    axes.axhspan(-_DEPTH, 0.0, color=style.SHADE)
    axes.axhline(0.0, color=palette.BLACK, linewidth=1.2)
    # A whole number of ticks passes, so that the last picture leads to the first.
    passed = round(abs(gone) / (_TICKS * width))
    apart = abs(gone) / passed if passed else _TICKS * width
    ticks = apart * np.arange((camera.min() - width) // apart, (camera.max() + width) // apart)
    axes.vlines(ticks, -7.0, 0.0, color=palette.DARK_GREY, linewidth=0.9)
    words: Any = {"transform": axes.transAxes, "va": "top", "fontsize": 11.0}
    axes.text(0.03, 0.96, caption, **words)
    lines, words["fontweight"] = {}, "bold"
    for name, right in (("stick", 0.789), ("slip", 0.868), ("flight", 0.97)):
        colour = style.KIND_COLOURS[name]
        axes.text(right, 0.96, name, color=colour, ha="right", **words)
        look = _BAR if name == "stick" else _LINE
        (lines[name],) = axes.plot([], [], color=colour, zorder=_TRACE_ORDER[name], **look)
    _draw_scale(axes, width)
    body = style.body(axes, outlines[first], 1.4)
    (contact,) = axes.plot([], [], "o", markersize=11.0, zorder=3.2, label="contact")
    kinds = [next(kind for kind in lines if kind in mode) for mode in Run.contact_names]
    kind = np.array(kinds)[shown.contact]

    def show(sample: int) -> None:
        style.move_body(body, outlines[sample])
        contact.set_data(*outlines[sample][[outlines[sample][:, 1].argmin()]].T)
        contact.set_color(style.KIND_COLOURS[kind[sample]])
        middle = camera[sample]
        axes.set_xlim(middle - 0.5 * width, middle + 0.5 * width)
        # The trace also has what came before the stretch.
        seen = np.abs(touch[: sample + 1] - middle) < 0.55 * width
        for name, line in lines.items():
            here = seen & (kind[: sample + 1] == name)
            if name != "stick":  # a slip goes on from where the body stuck, a sample before
                here[:-1] |= seen[:-1] & here[1:]
            line.set_data(np.where(here, touch[: sample + 1], np.nan), np.full(len(here), _TRACE))

    return show


def _draw_scale(axes: Axes, width: float) -> None:
    """A bar of a round length at the upper left of axes that show some width, µm."""
    bar = _round_below(_LONGEST_BAR * width)
    ends, height = (0.03, 0.03 + bar / width), 0.86
    look: Any = {"transform": axes.transAxes, "color": palette.BLACK}
    axes.add_line(Line2D(ends, (height, height), linewidth=2.5, **look))
    axes.text(ends[1] + 0.012, height, f"{bar:g} µm", va="center", fontsize=8.5, **look)


def _field_strip(axes: Axes, shown: Motion, first: int, last: int) -> Callable[[int], None]:
    """Draw the field over the stretch; what moves a mark along it."""
    t = (shown.t - shown.t[first]) * 1e3
    draw_fields(axes, replace(shown, t=t).samples(first, last))
    axes.set_xlabel("time (ms)", labelpad=1.0)
    axes.grid(visible=False)
    axes.margins(y=0.15)
    mark = axes.axvline(0.0, color=palette.BLACK, linewidth=1.6)
    return lambda sample: mark.set_xdata([t[sample]])


def _view_from_above(axes: Axes, shown: Motion, first: int, last: int) -> Callable[[int], None]:
    """Draw the path with arrows of the heading, in µm or mm; what moves the body on it."""
    part = shown.samples(first, last)
    factor, unit = style.length(part.x, part.y)
    path = np.column_stack([shown.x, shown.y]) * factor
    (line,) = axes.plot([], [], color=palette.BLACK, linewidth=0.9)
    arrows = {
        first + k: style.arrow(axes, *ends, palette.DARK_GREY)
        for k, ends in heading_arrows(part, factor).items()
    }
    body = style.body(axes, footprint(shown, first) * factor)
    # The body stays in the view however it is turned.
    robot = shown.scenario.robot
    reach = 0.5 * factor * math.hypot(robot.length, robot.width, robot.height)
    walked = path[first : last + 1]
    corner = walked.min(axis=0) - reach, walked.max(axis=0) + reach
    frame_from_above(axes, np.array(corner), unit)

    def show(sample: int) -> None:
        line.set_data(*path[first : sample + 1].T)
        style.move_body(body, footprint(shown, sample) * factor)
        for passed, arrow in arrows.items():
            arrow.set_visible(passed <= sample)
        heading = np.degrees(shown.heading[sample])
        axes.set_title(f"from above, heading {heading:.1f} degrees", loc="left")

    return show


class _ImageWriter(PillowWriter):
    """Frames of one palette: small files, whose still parts have the same bits in all frames."""

    _frames: list[Image.Image]

    def finish(self) -> None:
        if not self._frames:  # an error ended the first one
            return
        palette = self._frames[0].convert("RGB").quantize(_COLOURS, kmeans=1)
        colours = np.array(palette.getpalette()).reshape(-1, 3)
        # White stays white: Pillow takes colours that are as near as these for each other.
        colours[(colours > _WHITE).all(axis=1)] = 255
        palette.putpalette(colours.ravel().tolist())
        plain = Image.Dither.NONE
        first, *rest = (
            frame.convert("RGB").quantize(palette=palette, dither=plain) for frame in self._frames
        )
        webp: Any = {"lossless": True, "method": 6}  # half the bytes of the default
        # GIF has whole hundredths of a second, WebP whole ms: together they are right.
        step = 10 if str(self.outfile).lower().endswith(".gif") else 1
        ends = np.round(np.arange(len(self._frames) + 1) * (1000.0 / self.fps / step))
        duration = (step * np.diff(ends)).astype(int).tolist()  # ms, of each frame
        first.save(
            self.outfile, save_all=True, append_images=rest, duration=duration, loop=0, **webp
        )


def check_moving_format(path: str | PathLike[str]) -> None:
    """Refuse a name of a moving picture that cannot be written here."""
    check_suffix(path, (".gif", ".webp", ".mp4", ".html"))
    if Path(path).suffix.lower() == ".mp4" and not FFMpegWriter.isAvailable():
        raise RuntimeError(
            f"{path}: MP4 needs the program ffmpeg, which is not installed; write a .gif or .webp"
        )
