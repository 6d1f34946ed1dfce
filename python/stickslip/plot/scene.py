"""The scene of a moving picture: the body on the surface, its contact, and the field below it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from stickslip._util import palette
from stickslip._util.picture import Picture
from stickslip.plot import style
from stickslip.plot.above import frame_from_above, heading_arrows
from stickslip.plot.film import body_arrow, frame, thin_arrow
from stickslip.plot.motion import Motion, corners, footprint, lowest_corner
from stickslip.plot.one_motion import draw_fields
from stickslip.plot.scales import length, length_bar
from stickslip.simulation.run import Run

# Chosen by eye.
_WIDTH, _ABOVE_WIDTH = 6.4, 4.2  # inches, of the side view and of the view from above
_FIELD_HEIGHT = 1.4  # inches, of the strip of the field and its labels
_DIAGONALS = 2.1  # width of the side view over the diagonal of the body
_HEADROOM, _DEPTH = 14.0, 38.0  # µm, above the highest corner, and of the ground
_TRACE = -19.0  # µm, height of the trace
_TICKS = 0.12  # from one tick of the ground to the next, as part of the width

# Where it sticks a corner leaves a point, which is drawn as an upright bar.
_COLOURS = {"stick": style.STICK, "slip": style.SLIP, "flight": style.FLIGHT}
_BAR: Any = {"marker": "|", "markersize": 13.0, "markeredgewidth": 2.5, "linestyle": "none"}
_LINE: Any = {"linewidth": 5.0, "solid_capstyle": "butt"}


class Scene:
    """One figure whose artists move from sample to sample.

    Attributes
    ----------
    figure : matplotlib.figure.Figure
    """

    def __init__(self, motion: Motion, first: int, last: int, caption: str) -> None:
        """The trace also has what came before `first` in the record."""
        side = _SideView(motion, first, last)
        width, height = _WIDTH + _ABOVE_WIDTH * motion.turns, _WIDTH * side.shape + _FIELD_HEIGHT
        self.figure = Picture(figsize=(width, height))
        part, low = _WIDTH / width, _FIELD_HEIGHT / height
        side.draw(self.figure.add_axes((0.0, low, part, 1.0 - low)), caption)
        strip = self.figure.add_axes((0.09 * part, 0.33 * low, 0.88 * part, 0.48 * low))
        self._parts: list[Any] = [side, _FieldStrip(strip, motion, first, last)]
        if motion.turns:
            beside = self.figure.add_axes((part + 0.07, 0.12, 0.91 - part, 0.8))
            self._parts.append(_ViewFromAbove(beside, motion, first, last))

    def show(self, sample: int) -> None:
        """Move all to where it is at one sample."""
        for part in self._parts:
            part.show(sample)


class _SideView:
    """The body on the surface, in the plane in which it rocks; lengths are in µm.

    The camera goes at a constant speed, so that a stretch of steady pulses ends as it began, and
    leaves its course only where it would lose the body.
    """

    def __init__(self, motion: Motion, first: int, last: int) -> None:
        self._motion = motion
        self._touch = lowest_corner(motion) * 1e6
        names = np.array([style.contact_kind(name) for name in Run.contact_names])
        self._kind = names[motion.contact]
        diagonal = float(np.hypot(motion.length, motion.height)) * 1e6
        outlines = [corners(motion, k)[:, 1].max() for k in range(first, last + 1)]
        self._top = float(max(outlines)) * 1e6 + _HEADROOM
        self._width = max(_DIAGONALS * diagonal, self._top)
        self.shape = (self._top + _DEPTH) / self._width

        along, t = motion.along * 1e6, motion.t
        way = float(along[last] - along[first])
        course = along[first] + way * (t - t[first]) / (t[last] - t[first])
        beside = (along - course)[first : last + 1]
        course += 0.5 * (beside.min() + beside.max())
        slack = 0.5 * (self._width - diagonal)
        self._camera = np.clip(course, along - slack, along + slack)
        # A whole number of ticks passes, so that the last picture leads to the first.
        ticks = round(abs(way) / (_TICKS * self._width))
        self._apart = abs(way) / ticks if ticks else _TICKS * self._width

    def draw(self, axes: Axes, caption: str) -> None:
        """Draw what `show` moves, and what stays."""
        self._axes = axes
        axes.set_axis_off()
        axes.axhspan(-_DEPTH, 0.0, color=style.SHADE)
        axes.axhline(0.0, color=palette.BLACK, linewidth=1.2)
        (self._ticks,) = axes.plot([], [], color=palette.DARK_GREY, linewidth=0.9)
        self._trace = {
            kind: axes.plot([], [], color=colour, **(_BAR if kind == "stick" else _LINE))[0]
            for kind, colour in reversed(_COLOURS.items())
        }
        for (kind, colour), right in zip(_COLOURS.items(), (0.789, 0.868, 0.97), strict=True):
            look: Any = {"color": colour, "fontsize": 11.0, "fontweight": "bold"}
            axes.text(right, 0.96, kind, transform=axes.transAxes, ha="right", va="top", **look)
        face: Any = {"facecolor": style.BODY, "edgecolor": palette.BLACK, "linewidth": 1.4}
        self._body = Polygon(np.zeros((4, 2)), zorder=3.0, **face)
        axes.add_patch(self._body)
        self._moment = thin_arrow(palette.BLACK, 1.6)
        self._moment.set_zorder(3.1)
        axes.add_patch(self._moment)
        (self._contact,) = axes.plot([], [], "o", markersize=11.0, zorder=3.2, label="contact")
        axes.text(0.03, 0.96, caption, transform=axes.transAxes, va="top", fontsize=11.0)
        length_bar(axes, self._width, height=0.86)

    def show(self, sample: int) -> None:
        outline = corners(self._motion, sample) * 1e6
        self._body.set_xy(outline)
        self._moment.set_positions(*body_arrow(outline))
        lowest = outline[outline[:, 1].argmin()]
        self._contact.set_data([lowest[0]], [lowest[1]])
        self._contact.set_color(_COLOURS[self._kind[sample]])
        middle, half = float(self._camera[sample]), 0.5 * self._width
        frame(self._axes, (middle - half, middle + half), (-_DEPTH, self._top))
        touched, kinds = self._touch[: sample + 1], self._kind[: sample + 1]
        seen = np.abs(touched - middle) < 1.1 * half
        for kind, line in self._trace.items():
            # A slip goes on from where the body stuck, which is a sample before.
            here = seen & (kinds == kind)
            here[:-1] |= seen[:-1] & here[1:] & (kind != "stick")
            line.set_data(np.where(here, touched, np.nan), np.full(len(touched), _TRACE))
        numbers = np.arange(np.floor((middle - half) / self._apart), (middle + half) / self._apart)
        ticks = np.repeat(numbers, 3) * self._apart
        self._ticks.set_data(ticks, np.tile([0.0, -7.0, np.nan], len(numbers)))


class _FieldStrip:
    """The field over the stretch, and a mark that moves along it."""

    def __init__(self, axes: Axes, motion: Motion, first: int, last: int) -> None:
        self._t = (motion.t - motion.t[first]) * 1e3
        draw_fields(axes, replace(motion, t=self._t).samples(first, last))
        axes.set_xlabel("time (ms)", labelpad=1.0)
        axes.grid(visible=False)
        axes.margins(y=0.15)
        self._mark = axes.axvline(0.0, color=palette.BLACK, linewidth=1.6)

    def show(self, sample: int) -> None:
        self._mark.set_xdata([self._t[sample]])


class _ViewFromAbove:
    """The path so far, with arrows of the heading, and the body on it; in µm or mm."""

    def __init__(self, axes: Axes, motion: Motion, first: int, last: int) -> None:
        self._motion, self._axes, self._first = motion, axes, first
        shown = motion.samples(first, last)
        scale = length(np.concatenate([shown.x, shown.y]))
        self._factor = scale.factor
        self._x, self._y = motion.x * scale.factor, motion.y * scale.factor
        (self._path,) = axes.plot([], [], color=palette.BLACK, linewidth=0.9)
        face: Any = {"facecolor": style.BODY, "edgecolor": palette.BLACK, "linewidth": 1.2}
        self._body = Polygon(np.zeros((4, 2)), zorder=3.0, **face)
        axes.add_patch(self._body)
        self._arrows = {}
        for place, (begin, tip) in heading_arrows(shown, scale.factor).items():
            arrow = self._arrows[first + place] = thin_arrow(palette.DARK_GREY, 1.4)
            arrow.set_positions(begin, tip)
            axes.add_patch(arrow)
        self._moment = thin_arrow(palette.BLACK, 1.4)
        self._moment.set_zorder(3.1)
        axes.add_patch(self._moment)
        # The body stays in the view however it is turned.
        reach = 0.5 * float(np.linalg.norm([shown.length, shown.width, shown.height]))
        path = np.column_stack([shown.x, shown.y])
        places = np.concatenate([path.min(axis=0)[None] - reach, path.max(axis=0)[None] + reach])
        frame_from_above(axes, places * scale.factor, scale.unit)

    def show(self, sample: int) -> None:
        outline = footprint(self._motion, sample) * self._factor
        seen = slice(self._first, sample + 1)
        self._path.set_data(self._x[seen], self._y[seen])
        self._body.set_xy(outline)
        self._moment.set_positions(*body_arrow(outline))
        for passed, arrow in self._arrows.items():
            arrow.set_visible(passed <= sample)
        heading = np.degrees(self._motion.heading[sample])
        self._axes.set_title(f"from above, heading {heading:.1f} degrees", loc="left")
