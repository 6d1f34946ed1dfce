"""A sheet on which drawings are made: SVG with text as text.

Lengths are in pixels of the sheet; y points up, as in the formulas.
"""

from __future__ import annotations

import html
import re
from collections.abc import Sequence
from math import atan2, cos, hypot, pi, sin

Point = tuple[float, float]

FONT_SIZE = 13.0  # px; a panel is never shown wider than it is, and hardly narrower
_HEAD = 7.0  # px, length of the head of an arrow

# Colours by Okabe and Ito, darkened where they have to be read as text.
_COLOURS = {"blue": "#0072b2", "orange": "#b87800", "green": "#007a59", "red": "#c44e00"}
_STYLE = (
    "svg { background: white; color: #1a1a1a; }"
    "path, circle { fill: none; stroke: currentColor; stroke-width: 1.5; stroke-linejoin: round; }"
    f"text {{ fill: currentColor; font: {FONT_SIZE:g}px sans-serif; }}"
    ".thin, .faint { stroke-width: 1; }"
    ".faint, .muted { color: #767676; }"
    ".dashed { stroke-dasharray: 5 4; }"
    ".body { fill: #0072b21f; }"
    ".coil { stroke-width: 2.5; }"
    ".filled { fill: currentColor; stroke: none; }"
) + "".join(f".{name} {{ color: {colour}; }}" for name, colour in _COLOURS.items())

_SUBSCRIPT = re.compile(r"_(\w+)")


class Sheet:
    """One panel of a drawing.

    Parameters
    ----------
    width, height : float
        px.
    origin : (float, float)
        Where the point (0, 0) lies, px from the left and from the bottom.
    scale : float
        px for a unit of the coordinates that the methods take.
    """

    def __init__(
        self, width: float, height: float, origin: Point = (0.0, 0.0), scale: float = 1.0
    ) -> None:
        self.width, self.height = width, height
        self._origin, self._scale = origin, scale
        self._parts: list[str] = []
        self.words: list[tuple[str, float, float, float, float]] = []
        """Text, left, top, right and bottom (px) of each label, by the usual width of letters."""

    def place(self, point: Point) -> Point:
        """Pixels from the top left corner."""
        x = self._origin[0] + self._scale * point[0]
        return x, self.height - self._origin[1] - self._scale * point[1]

    def _path(self, points: Sequence[Point], close: bool, style: str) -> None:
        places = " L".join(f"{x:.1f} {y:.1f}" for x, y in map(self.place, points))
        self._parts.append(f'<path class="{style}" d="M{places}{" Z" if close else ""}"/>')

    def line(self, *points: Point, style: str = "ink") -> None:
        """A line through points."""
        self._path(points, False, style)

    def polygon(self, points: Sequence[Point], style: str = "body") -> None:
        """A closed shape, filled as its style says."""
        self._path(points, True, style)

    def dot(self, point: Point, style: str = "ink", radius: float = 3.0) -> None:
        """A filled disc; `radius` in px."""
        x, y = self.place(point)
        self._parts.append(
            f'<circle class="{style} filled" cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}"/>'
        )

    def arrow(self, start: Point, end: Point, style: str = "ink", both: bool = False) -> None:
        """A line with a head at its end, or at both ends."""
        self.line(start, end, style=style)
        self._head(start, end, style)
        if both:
            self._head(end, start, style)

    def _head(self, start: Point, end: Point, style: str) -> None:
        (x0, y0), (x, y) = self.place(start), self.place(end)
        length = hypot(x - x0, y - y0)
        ux, uy = (x - x0) / length, (y - y0) / length
        back, half = _HEAD, 0.45 * _HEAD
        left = (x - back * ux - half * uy, y - back * uy + half * ux)
        right = (x - back * ux + half * uy, y - back * uy - half * ux)
        corners = " L".join(f"{a:.1f} {b:.1f}" for a, b in ((x, y), left, right))
        self._parts.append(f'<path class="{style} filled" d="M{corners} Z"/>')

    def arc(self, centre: Point, radius: float, begin: float, end: float, style: str) -> None:
        """A part of a circle; the angles in rad, from +x towards +y."""
        angles = [begin + (end - begin) * k / 24 for k in range(25)]
        self.line(
            *((centre[0] + radius * cos(a), centre[1] + radius * sin(a)) for a in angles),
            style=style,
        )

    def turn(self, centre: Point, radius: float, begin: float, end: float, style: str) -> None:
        """An arc with a head at its end."""
        self.arc(centre, radius, begin, end, style)
        near = end - 0.3 * (1 if end > begin else -1)
        tip = (centre[0] + radius * cos(end), centre[1] + radius * sin(end))
        back = (centre[0] + radius * cos(near), centre[1] + radius * sin(near))
        self._head(back, tip, style)

    def text(
        self,
        point: Point,
        words: str,
        anchor: str = "middle",
        shift: Point = (0.0, 0.0),
        style: str = "ink",
    ) -> None:
        """A label; `_` begins a subscript of one word, `shift` is in px, y up."""
        x, y = self.place(point)
        x, y = x + shift[0], y - shift[1] + 0.35 * FONT_SIZE
        self._parts.append(
            f'<text class="{style}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">'
            f"{_with_subscripts(words)}</text>"
        )
        width = 0.56 * FONT_SIZE * len(words.replace("_", ""))
        left = x - {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * width
        self.words.append((words, left, y - 0.8 * FONT_SIZE, left + width, y + 0.2 * FONT_SIZE))

    def dimension(self, start: Point, end: Point, words: str, side: float = 10.0) -> None:
        """A distance: an arrow with two heads, its text `side` px to its left."""
        self.arrow(start, end, style="thin", both=True)
        angle = atan2(end[1] - start[1], end[0] - start[0]) + pi / 2
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        across = abs(cos(angle)) > 0.7
        anchor = "middle" if not across else ("end" if cos(angle) < 0 else "start")
        gap = 0.6 * side if across else side
        self.text(middle, words, anchor, (gap * cos(angle), gap * sin(angle)))

    def svg(self) -> str:
        """The panel as a file."""
        size = f"{self.width:g} {self.height:g}"
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width:g}" '
            f'height="{self.height:g}" viewBox="0 0 {size}"><style>{_STYLE}</style>\n'
            + "\n".join(self._parts)
            + "\n</svg>\n"
        )


def _with_subscripts(words: str) -> str:
    small = f'<tspan dy="3.5" font-size="{0.75 * FONT_SIZE:.1f}">'
    back = '<tspan dy="-3.5">&#8203;</tspan>'
    return _SUBSCRIPT.sub(lambda found: f"{small}{found[1]}</tspan>{back}", html.escape(words))
