"""The drawings of the coils and their drives, and all drawings by name.

Each is a function without arguments that gives the panels of one drawing, which
``docs/pictures.py`` writes to docs/images/drawings/.
"""

from __future__ import annotations

from collections.abc import Callable
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


def diagnosis() -> list[Sheet]:
    """The way of a velocity from its cell to the verdict; develop.md names the functions."""
    pitch, height, left, right = 38.0, 26.0, 8.0, 222.0
    sheet = Sheet(340, pitch * len(_WAY) + 6, origin=(0, 0))
    tops = [sheet.height - 6 - pitch * k for k in range(len(_WAY))]
    for words, top in zip(_WAY, tops, strict=True):
        box = [(left, top), (right, top), (right, top - height), (left, top - height)]
        sheet.polygon(box, "blue body")
        sheet.text((left, top - height / 2), words, "start", shift=(8, 0))
    for top in tops[:-1]:
        middle = (left + right) / 2
        sheet.arrow((middle, top - height), (middle, top - pitch))
    near, far = 252.0, 332.0
    high, low = tops[_SIMULATED[0]], tops[_SIMULATED[-1]] - height
    sheet.polygon([(near, high), (far, high), (far, low), (near, low)], "orange")
    centre = ((near + far) / 2, (high + low) / 2)
    sheet.text(centre, "12", shift=(0, 24), style="orange")
    sheet.text(centre, "simulated", shift=(0, 6), style="orange")
    sheet.text(centre, "velocities", shift=(0, -12), style="orange")
    for k in _SIMULATED:
        at = tops[k] - height / 2
        sheet.arrow((right, at), (near, at), style="orange", both=True)
    return [sheet]


DRAWINGS: dict[str, Callable[[], list[Sheet]]] = {
    "coil-set": coil_set,
    "robot": robot,
    "clamp": clamp,
    "drives": drives,
    "sawtooth": sawtooth,
    "contact-modes": contact_modes,
    "diagnosis": diagnosis,
}
