"""Charts of the report's page as SVG, which is sharp at any size and says its values on hover."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from stickslip._util.plain_text import printable, shortened

WIDTH, WIDE, HEIGHT = 460, 620, 300
"""Of a panel, and of one that stands alone, in units of the drawing."""

_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 12, 30, 44
_TICKS = 6
_LARGE, _SMALL, _MANY = 4.5, 2.5, 60  # radius of a point; smaller where so many would overlap
_DIGITS = 4  # of values that are said on hover

UPWARDS = 44
"""Characters of a label that runs upwards. Chosen: the height of a panel holds them."""

MARKERS = {"circle": "o", "square": "s", "triangle": "^", "diamond": "D", "pointing down": "v"}
"""Shapes of points, which stand for kinds of settings, and matplotlib's letters for them."""


@dataclass(frozen=True)
class Point:
    """A reading: its place, its value, one standard deviation where it is known.

    `hollow` says that it was held out, `marker` is a place in `MARKERS`, and `title` is said on
    hover.
    """

    x: float
    y: float
    sd: float | None
    title: str
    hollow: bool = False
    marker: int = 0


@dataclass(frozen=True)
class Line:
    """A curve, or dashes at single places where `joined` is not set.

    `kind` is a class of the page's style, ``cause`` or ``given``, and curves of one kind differ by
    their `series`.
    """

    x: Sequence[float]
    y: Sequence[float]
    kind: str
    title: str
    joined: bool = True
    series: int = 0


@dataclass(frozen=True)
class Panel:
    """One pair of axes; `levels` are drawn across it."""

    title: str
    xlabel: str
    ylabel: str
    points: tuple[Point, ...] = ()
    lines: tuple[Line, ...] = ()
    levels: tuple[float, ...] = (0.0,)

    def svg(self, wide: bool = False) -> str:
        """The panel; text of a user's is escaped, and without control characters."""
        return _Drawing(self, WIDE if wide else WIDTH).svg()


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers between two ends, about as many as fit."""
    step = 10.0 ** math.floor(math.log10((high - low) / _TICKS))
    step *= next(each for each in (1.0, 2.0, 5.0, 10.0) if (high - low) / (each * step) <= _TICKS)
    return [k * step for k in range(math.ceil(low / step), math.floor(high / step) + 1)]


def _labels(ticks: Sequence[float]) -> tuple[list[str], int]:
    """The ticks in as few digits as tell them apart, and the power of ten that they are over."""
    largest = max(map(abs, ticks), default=1.0) or 1.0
    power = 0 if 1e-2 <= largest < 1e5 else 3 * math.floor(math.log10(largest) / 3)
    over = [each / 10.0**power for each in ticks]
    step = min((b - a for a, b in itertools.pairwise(over)), default=largest / 10.0**power)
    places = max(0, -math.floor(math.log10(step) + 1e-9))
    return [f"{each + 0.0:.{places}f}" for each in over], power


def raised(power: int) -> str:
    """An exponent in raised digits."""
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _over(label: str, power: int) -> str:
    """The label of an axis whose numbers are over a power of ten."""
    if power == 0:
        return label
    ten = f"10{raised(power)}"
    name, opened, unit = label.rpartition("(")
    return f"{name}({ten} {unit}" if opened and unit.endswith(")") else f"{label} ({ten})"


def _range(values: Sequence[float]) -> tuple[float, float]:
    """Ends that leave a margin about all finite values."""
    finite = [each for each in values if math.isfinite(each)] or [0.0]
    low, high = min(finite), max(finite)
    margin = 0.06 * (high - low) or 0.5 * abs(high) or 1.0
    return low - margin, high + margin


class _Drawing:
    """A panel with its scales."""

    def __init__(self, panel: Panel, width: float) -> None:
        self.panel, self.width = panel, width
        across = [each.x for each in panel.points] + [x for line in panel.lines for x in line.x]
        up = [y for line in panel.lines for y in line.y] + list(panel.levels)
        for each in panel.points:
            reach = 2.0 * each.sd if each.sd is not None else 0.0
            up += [each.y - reach, each.y + reach]
        self.x_range, self.y_range = _range(across), _range(up)

    def x(self, value: float) -> float:
        low, high = self.x_range
        return _LEFT + (value - low) / (high - low) * (self.width - _LEFT - _RIGHT)

    def y(self, value: float) -> float:
        low, high = self.y_range
        return HEIGHT - _BOTTOM - (value - low) / (high - low) * (HEIGHT - _TOP - _BOTTOM)

    def svg(self) -> str:
        panel = self.panel
        label = _text(f"{panel.title}: {panel.ylabel} over {panel.xlabel}")
        parts = [
            f'<svg class="chart" viewBox="0 0 {self.width} {HEIGHT}" role="img" '
            f'aria-label="{label}">',
            *self._axes(),
            *(
                f'<line class="level" x1="{_LEFT}" x2="{self.width - _RIGHT}" '
                f'y1="{self.y(each):.1f}" y2="{self.y(each):.1f}"/>'
                for each in panel.levels
            ),
            *(self._line(each) for each in panel.lines),
            *(self._point(each) for each in panel.points if math.isfinite(each.y)),
            "</svg>",
        ]
        return "".join(parts)

    def _axes(self) -> list[str]:
        panel, middle = self.panel, (_TOP + HEIGHT - _BOTTOM) / 2
        center, right, low = (
            (_LEFT + self.width - _RIGHT) / 2,
            self.width - _RIGHT,
            HEIGHT - _BOTTOM,
        )
        parts = []
        ticks = _ticks(*self.x_range)
        labels, over_x = _labels(ticks)
        for value, label in zip(ticks, labels, strict=True):
            at = f"{self.x(value):.1f}"
            parts.append(f'<line class="grid" x1="{at}" x2="{at}" y1="{_TOP}" y2="{low}"/>')
            parts.append(f'<text x="{at}" y="{low + 16}" text-anchor="middle">{label}</text>')
        ticks = _ticks(*self.y_range)
        labels, over_y = _labels(ticks)
        for value, label in zip(ticks, labels, strict=True):
            at = f"{self.y(value):.1f}"
            parts.append(f'<line class="grid" x1="{_LEFT}" x2="{right}" y1="{at}" y2="{at}"/>')
            place = f'x="{_LEFT - 5}" y="{self.y(value) + 4:.1f}"'
            parts.append(f'<text {place} text-anchor="end">{label}</text>')
        upwards = shortened(_over(panel.ylabel, over_y), UPWARDS)
        names = (
            (f'class="title" x="{center}" y="18"', panel.title),
            (f'x="{center}" y="{HEIGHT - 8}"', _over(panel.xlabel, over_x)),
            (f'transform="translate(14 {middle}) rotate(-90)"', upwards),
        )
        return parts + [
            f'<text {place} text-anchor="middle">{_text(shortened(name))}</text>'
            for place, name in names
        ]

    def _places(self, places: Sequence[tuple[float, float]]) -> str:
        return " ".join(f"{self.x(a):.1f},{self.y(b):.1f}" for a, b in places)

    def _line(self, line: Line) -> str:
        sound = [(a, b) for a, b in zip(line.x, line.y, strict=True) if math.isfinite(b)]
        title = f"<title>{_text(line.title)}</title>"
        if line.joined and len(sound) > 1:
            shape = f'<polyline points="{self._places(sound)}"/>'
            return f'<g class="line {line.kind} series-{line.series}">{title}{shape}</g>'
        dashes = "".join(
            f'<line x1="{self.x(a) - 7:.1f}" x2="{self.x(a) + 7:.1f}" '
            f'y1="{self.y(b):.1f}" y2="{self.y(b):.1f}"/>'
            for a, b in sound
        )
        return f'<g class="line {line.kind} dashes">{title}{dashes}</g>'

    def _point(self, point: Point) -> str:
        x, y = self.x(point.x), self.y(point.y)
        bar = ""
        if point.sd is not None and math.isfinite(point.sd):
            low, high = self.y(point.y - 2 * point.sd), self.y(point.y + 2 * point.sd)
            bar = f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{low:.1f}" y2="{high:.1f}"/>'
        kind = "point hollow" if point.hollow else "point"
        near = f'<circle class="near" cx="{x:.1f}" cy="{y:.1f}" r="10"/>'
        title = f"<title>{_text(point.title)}</title>"
        size = _SMALL if len(self.panel.points) > _MANY else _LARGE
        return f'<g class="{kind}">{title}{bar}{marker(point.marker, x, y, size)}{near}</g>'


def marker(kind: int, x: float, y: float, r: float = _LARGE) -> str:
    """The shape of a point."""
    shape = list(MARKERS)[kind % len(MARKERS)]
    if shape == "circle":
        return f'<circle class="mark" cx="{x:.1f}" cy="{y:.1f}" r="{r}"/>'
    if shape == "square":
        return (
            f'<rect class="mark" x="{x - r:.1f}" y="{y - r:.1f}" width="{2 * r}" height="{2 * r}"/>'
        )
    corners = {
        "triangle": ((0, -1.3), (1.2, 0.9), (-1.2, 0.9)),
        "diamond": ((0, -1.35), (1.35, 0), (0, 1.35), (-1.35, 0)),
        "pointing down": ((0, 1.3), (1.2, -0.9), (-1.2, -0.9)),
    }[shape]
    places = " ".join(f"{x + r * a:.1f},{y + r * b:.1f}" for a, b in corners)
    return f'<polygon class="mark" points="{places}"/>'


def said(value: float) -> str:
    """A value as hovering shows it."""
    return f"{value:.{_DIGITS}g}"


def _text(text: str) -> str:
    return escape(printable(text), quote=True)
