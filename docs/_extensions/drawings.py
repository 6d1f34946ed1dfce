"""The drawings of the coils and their drives, and all drawings by name.

Each is a function without arguments that gives the panels of one drawing, which
``docs/pictures.py`` writes to docs/images/drawings/.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2, degrees

from body_drawings import axis, clamp, contact_modes, corners, outline, robot
from svg import Point, Sheet

from stickslip import Coil, Drive

_COIL = Coil()


def _oblique(x: float, y: float, z: float) -> Point:
    """Seen from the front, a little from the left and above."""
    return x + 0.5 * y, z + 0.33 * y


def coil_set() -> list[Sheet]:
    """The five coils in perspective, and in the plane of motion with their distances."""
    distance, half = _COIL.distance * 1e3, _COIL.side * 0.5e3  # mm
    seen = Sheet(340, 330, origin=(165, 165), scale=0.93)
    signs = [(-half, -half), (half, -half), (half, half), (-half, half)]
    loops = {
        "yp": [_oblique(a, distance, b) for a, b in signs],
        "xm": [_oblique(-distance, a, b) for a, b in signs],
        "clamp": [_oblique(a, b, -distance) for a, b in signs],
        "xp": [_oblique(distance, a, b) for a, b in signs],
        "ym": [_oblique(a, -distance, b) for a, b in signs],
    }
    for name, loop in loops.items():
        colour = {"xp": "blue", "clamp": "orange"}.get(name, "ink")
        sheet_style = f"{colour} coil"
        seen.polygon(loop, sheet_style)
    axis(seen, (0, 0), _oblique(62, 0, 0), "x", (8, 6))
    axis(seen, (0, 0), _oblique(0, 62, 0), "y", (8, 6))
    axis(seen, (0, 0), _oblique(0, 0, 62), "z", (10, 0))
    seen.dot((0, 0), "red", 4)
    seen.text(_oblique(distance, half, half), "xp", shift=(0, 10), style="blue")
    seen.text(_oblique(-distance, half, half), "xm", shift=(-16, -2))
    seen.text(_oblique(half, distance, half), "yp", shift=(-12, 10))
    seen.text(_oblique(-half, -distance, -half), "ym", shift=(14, 10))
    seen.text(_oblique(0, -half, -distance), "clamp", shift=(0, -10), style="orange")

    cut = Sheet(340, 330, origin=(170, 165), scale=1.3)
    thick = 5.0  # mm; the coils count as filaments
    for side, name in ((1, "xp"), (-1, "xm")):
        x = side * distance
        colour = "blue" if side > 0 else "ink"
        edges = [(x - thick, -half), (x + thick, -half), (x + thick, half), (x - thick, half)]
        cut.polygon(edges, f"{colour} coil")
        cut.text((x, half), name, shift=(0, 12), style=colour)
    z = -distance
    edges = [(-half, z - thick), (half, z - thick), (half, z + thick), (-half, z + thick)]
    cut.polygon(edges, "orange coil")
    cut.text((0, z), "clamp", shift=(0, -20), style="orange")
    cut.line((-70, 0), (70, 0), style="faint")
    cut.text((12, 0), "surface z = 0", anchor="start", shift=(0, 9), style="muted")
    cut.polygon([(-5, 0), (5, 0), (5, 4), (-5, 4)], "red filled")
    cut.text((0, 0), "robot", anchor="end", shift=(-10, 10), style="red")
    cut.dimension((0, -26), (distance, -26), f"{distance:.0f} mm")
    cut.dimension((-26, 0), (-26, z + thick), f"{distance:.0f} mm", side=6)
    left = 16 - distance
    cut.arrow((left, -half), (left, half), style="thin", both=True)
    cut.text((left, 40), f"{2 * half:.1f} mm", anchor="start", shift=(6, 0))
    axis(cut, (-60, 78), (25, 0), "x", (8, 0))
    axis(cut, (-60, 78), (0, 25), "z", (0, 8))
    return [seen, cut]


_PEAK, _BASE = 2.5, 0.5  # mT; the default peak, and the base of most examples


def _voltage(
    sheet: Sheet, bottom: float, name: str, levels: tuple[float, float], style: str
) -> None:
    """One coil's field over time: a sawtooth between two levels (mT), or one that is held."""
    left, period, tall = 22.0, 46.0, 20.0  # px; px for 1 mT
    low, high = (bottom + tall * level for level in levels)
    sheet.arrow((left, bottom), (left + 182, bottom), style="thin")
    sheet.arrow((left, bottom), (left, bottom + 66), style="thin")
    points: list[Point] = [(left, bottom), (left + 28, low)]
    for k in range(3):
        start = left + 28 + k * period
        points += [(start, high), (start + period, low)]
    sheet.line(*points, style=style)
    sheet.text((left, bottom + 66), name, anchor="start", shift=(8, 2), style=style)
    sheet.text((left + 182, bottom), "t", shift=(4, -9))


def drives() -> list[Sheet]:
    """IPP and OPP: which coil plays the sawtooth, and how the body rocks."""
    drive = Drive()
    assert drive.peak == _PEAK * 1e-3
    panels = []
    for mode, hold in (("IPP", 1.0), ("OPP", 2.5)):
        sheet = Sheet(340, 346)
        pulse, still = (_BASE, _PEAK), (hold, hold)
        first, second = (pulse, still) if mode == "IPP" else (still, pulse)
        _voltage(sheet, 238, "coil in front, B_x", first, "blue")
        _voltage(sheet, 146, "clamp coil, |B_z|", second, "orange")
        for bottom, (low, high) in ((238, first), (146, second)):
            if low == high:
                sheet.text((202, bottom + 20 * low), "hold", anchor="start", shift=(12, 0))
            else:
                sheet.text((202, bottom + 20 * low), "base", anchor="start", shift=(12, 0))
                sheet.text((202, bottom + 20 * high), "peak", anchor="start", shift=(12, 0))
        said = "in-plane pulsing" if mode == "IPP" else "out-of-plane pulsing"
        sheet.text((22, 334), f"{mode}, {said}", anchor="start")
        _two_tilts(sheet, mode, hold)
        panels.append(sheet)
    return panels


def _two_tilts(sheet: Sheet, mode: str, hold: float) -> None:
    """The body along the field at the base (dashed) and at the peak of the sawtooth."""
    scale, foot = 0.36, 30.0
    for level, style in ((_BASE, "body dashed"), (_PEAK, "body")):
        along, down = (level, hold) if mode == "IPP" else (hold, level)
        theta = atan2(down, along)
        points = {
            name: (190.0 + scale * x, foot + scale * z)
            for name, (x, z) in corners((0.0, 0.0), theta).items()
        }
        outline(sheet, points, style)
        words = f"{'peak' if level == _PEAK else 'base'}: θ → {degrees(theta):.0f}°"
        sheet.text((232, foot + (28 if level == _PEAK else 50)), words, anchor="start")
    sheet.line((22, foot), (318, foot))
    sheet.dot((190.0, foot), "red")
    sheet.text((22, foot), "surface", anchor="start", shift=(0, -12), style="muted")


def sawtooth() -> list[Sheet]:
    """The parts of the sawtooth: ramp, base, peak, period, and both edges."""
    panels = []
    for edge in ("rise", "fall"):
        sheet = Sheet(340, 200)
        left, bottom, ramp, period = 34.0, 42.0, 60.0, 84.0
        low, high = bottom + 20, bottom + 100
        sheet.arrow((left, bottom), (left + 280, bottom), style="thin")
        sheet.arrow((left, bottom), (left, bottom + 138), style="thin")
        sheet.text((left + 280, bottom), "t", shift=(10, 0))
        sheet.text((left, bottom + 138), f'V of the pulsing coil, edge = "{edge}"', "start", (8, 0))
        points: list[Point] = [(left, bottom), (left + ramp, low)]
        for k in range(2):
            start = left + ramp + k * period
            top = (start, high) if edge == "rise" else (start + period, high)
            points += [top, (start + period, low)]
        for level, words in ((low, "base"), (high, "peak")):
            sheet.line((left, level), (left + 236, level), style="faint dashed")
            sheet.text((left + 238, level), words, anchor="start")
        sheet.line(*points, style="blue")
        sheet.dimension((left, bottom - 12), (left + ramp, bottom - 12), "ramp", side=-22)
        sheet.dimension(
            (left + ramp, bottom - 12), (left + ramp + period, bottom - 12), "1/frequency", -22
        )
        panels.append(sheet)
    return panels


_WAY = (
    "1  read the cells",
    "2  mean and error of a condition",
    "3  constants, causes, model",
    "4  checks of the data",
    "5  recalibrate",
    "6  response of each cause",
    "7  test: is anything left?",
    "8  search for models",
    "9  probability of each model",
    "10  gain on held-out readings",
    "11  verdict",
)
_SIMULATED = (4, 5, 7)  # steps that ask for predictions, from 0
_PITCH, _TALL, _LEFT, _RIGHT = 38.0, 26.0, 8.0, 222.0  # px, of a column of steps


def _column(steps: Sequence[str], styles: Sequence[str]) -> tuple[Sheet, list[float]]:
    """Steps one below the other, and the height of each box's upper side."""
    sheet = Sheet(340, _PITCH * len(steps) + 6)
    tops = [sheet.height - 6 - _PITCH * k for k in range(len(steps))]
    for words, style, top in zip(steps, styles, tops, strict=True):
        low = top - _TALL
        sheet.polygon([(_LEFT, top), (_RIGHT, top), (_RIGHT, low), (_LEFT, low)], f"{style} body")
        sheet.text((_LEFT, top - _TALL / 2), words, "start", shift=(8, 0))
    for top in tops[:-1]:
        middle = (_LEFT + _RIGHT) / 2
        sheet.arrow((middle, top - _TALL), (middle, top - _PITCH))
    return sheet, tops


def diagnosis() -> list[Sheet]:
    """The way of a velocity from its cell to the verdict; develop.md names the functions."""
    sheet, tops = _column(_WAY, ["blue"] * len(_WAY))
    near, far = 252.0, 332.0
    high, low = tops[_SIMULATED[0]], tops[_SIMULATED[-1]] - _TALL
    sheet.polygon([(near, high), (far, high), (far, low), (near, low)], "orange")
    centre = ((near + far) / 2, (high + low) / 2)
    sheet.text(centre, "12", shift=(0, 24), style="orange")
    sheet.text(centre, "simulated", shift=(0, 6), style="orange")
    sheet.text(centre, "velocities", shift=(0, -12), style="orange")
    for k in _SIMULATED:
        at = tops[k] - _TALL / 2
        sheet.arrow((_RIGHT, at), (near, at), style="orange", both=True)
    return [sheet]


_STEP = (
    ("1  a scenario is given", "green"),
    ("2  runs go to threads", "blue"),
    ("3  one run, to its end", "blue"),
    ("4  next stretch of voltage", "blue"),
    ("5  the phase of the state", "blue"),
    ("6  steps, one after another", "blue"),
    ("7  an attempt at a step", "orange"),
    ("8  rates, event functions", "orange"),
    ("9  accepted? an event in it?", "orange"),
    ("10  record, extremes, stop", "orange"),
    ("11  the phase has ended", "blue"),
    ("12  what its event changes", "blue"),
    ("13  the summary", "green"),
)
_BACK = (  # from and to (from 0), how far to the right (px), to the next what
    (9, 6, 262.0, "step"),
    (11, 4, 290.0, "phase"),
    (11, 3, 318.0, "stretch"),
)
_FRICTION = (
    ("1  key and value to the core", "green"),
    ("2  in range: in the scenario", "blue"),
    ("3  a constant of the model", "blue"),
    ("4  coefficient of a contact", "orange"),
    ("5  its sign, by the slip", "orange"),
    ("6  forces and accelerations", "orange"),
    ("7  six of them make a step", "orange"),
    ("8  accepted, cut at an event", "orange"),
    ("9  where the phase ends", "blue"),
    ("10  mean velocity", "green"),
)


def step() -> list[Sheet]:
    """The way of a step, and of a coefficient; develop.md names the functions."""
    way, tops = _column(*zip(*_STEP, strict=True))
    for number, (begin, end, far, words) in enumerate(_BACK):
        low, high = tops[begin] - _TALL / 2 + 5 - 5 * number, tops[end] - _TALL / 2
        way.line((_RIGHT, low), (far, low), (far, high), style="thin")
        way.arrow((far, high), (_RIGHT, high), style="thin")
        way.text((_RIGHT, high), words, "start", shift=(6, 10))
    return [way, _column(*zip(*_FRICTION, strict=True))[0]]


DRAWINGS: dict[str, Callable[[], list[Sheet]]] = {
    "coil-set": coil_set,
    "robot": robot,
    "clamp": clamp,
    "drives": drives,
    "sawtooth": sawtooth,
    "contact-modes": contact_modes,
    "diagnosis": diagnosis,
    "step": step,
}
