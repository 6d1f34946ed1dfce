"""The drawings of the pages, which the directive ``drawing`` puts there.

Each is a function without arguments that gives the panels of one drawing; the sizes are those of
the package's defaults, so that a drawing cannot contradict them.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import groupby
from math import atan2, cos, degrees, pi, radians, sin

from svg import Point, Sheet

from stickslip import Coil, Drive, Record, Robot, Scenario, simulate

_COIL, _ROBOT = Coil(), Robot()


def _axis(sheet: Sheet, at: Point, along: Point, words: str, shift: Point) -> None:
    end = (at[0] + along[0], at[1] + along[1])
    sheet.arrow(at, end, style="thin")
    sheet.text(end, words, shift=shift)


def _body(place: Point, theta: float, corner: str = "front") -> dict[str, Point]:
    """Corners, middle and front (um) of a robot that stands on one corner or lies at `place`."""
    half = {"x": _ROBOT.length / 2 * 1e6, "z": _ROBOT.height / 2 * 1e6}
    local = {
        "front bottom": (half["x"], -half["z"]),
        "front top": (half["x"], half["z"]),
        "rear top": (-half["x"], half["z"]),
        "rear bottom": (-half["x"], -half["z"]),
        "middle": (0.0, 0.0),
    }
    # theta is nose-down: body x is (cos, -sin), body z is (sin, cos).
    turned = {
        name: (x * cos(theta) + z * sin(theta), -x * sin(theta) + z * cos(theta))
        for name, (x, z) in local.items()
    }
    x, z = turned[f"{corner} bottom"]
    return {name: (place[0] + a - x, place[1] + b - z) for name, (a, b) in turned.items()}


def _outline(sheet: Sheet, points: dict[str, Point], style: str = "body") -> None:
    sheet.polygon(
        [points[name] for name in ("front bottom", "front top", "rear top", "rear bottom")],
        style,
    )


def _moment(sheet: Sheet, points: dict[str, Point], theta: float, length: float = 75.0) -> None:
    x, z = points["middle"]
    start = (x - 0.5 * length * cos(theta), z + 0.5 * length * sin(theta))
    end = (x + 0.5 * length * cos(theta), z - 0.5 * length * sin(theta))
    sheet.arrow(start, end, style="blue")


def _ground(sheet: Sheet, left: float, right: float, spacing: float) -> None:
    sheet.line((left, 0.0), (right, 0.0))
    count = int((right - left) / spacing)
    for k in range(count):
        x = left + (k + 0.7) * spacing
        sheet.line((x, 0.0), (x - 0.6 * spacing, -0.6 * spacing), style="faint")


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
    _axis(seen, (0, 0), _oblique(62, 0, 0), "x", (8, 6))
    _axis(seen, (0, 0), _oblique(0, 62, 0), "y", (8, 6))
    _axis(seen, (0, 0), _oblique(0, 0, 62), "z", (10, 0))
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
    _axis(cut, (-60, 78), (25, 0), "x", (8, 0))
    _axis(cut, (-60, 78), (0, 25), "z", (0, 8))
    return [seen, cut]


def robot() -> list[Sheet]:
    """Angles and corners of the body, and the forces on it."""
    theta = radians(28.0)
    phi = atan2(_ROBOT.height, _ROBOT.length)
    named = Sheet(340, 270, origin=(258, 52), scale=0.8)
    points = _body((0.0, 0.0), theta)
    _ground(named, -295, 95, 18)
    _outline(named, points)
    middle, corner = points["middle"], points["front bottom"]
    named.line(corner, middle, style="thin")
    named.arc(corner, 118, pi - theta, pi, "orange")
    named.text((-118 * cos(theta / 2), 118 * sin(theta / 2)), "θ", shift=(-10, -3), style="orange")
    named.arc(corner, 78, pi - theta - phi, pi - theta, "green")
    angle = pi - theta - phi / 2
    named.text((78 * cos(angle), 78 * sin(angle)), "φ", shift=(-9, 5), style="green")
    named.text((0.45 * middle[0], 0.45 * middle[1]), "r", shift=(10, 8))
    x, z = middle
    tip = (x + 95 * cos(theta), z - 95 * sin(theta))
    named.arrow(middle, tip, style="blue")
    named.text(tip, "V M", anchor="start", shift=(36, 0), style="blue")
    named.dot(middle)
    named.text(middle, "(x, z)", shift=(-12, 15))
    named.dot(corner, "red")
    named.text(corner, "P, front bottom", shift=(0, -26), style="red")
    named.text(points["front top"], "front top", shift=(4, 16))
    named.text(points["rear top"], "rear top", shift=(0, 12))
    named.text(points["rear bottom"], "rear bottom", anchor="end", shift=(4, -14))
    _axis(named, (-290, 190), (40, 0), "x", (9, 0))
    _axis(named, (-290, 190), (0, 40), "z", (0, 9))

    pushed = Sheet(340, 270, origin=(225, 90), scale=0.72)
    _ground(pushed, -290, 130, 22)
    _outline(pushed, points)
    forces = [
        (middle, (0, -88), "m g", "ink", (18, 8)),
        (middle, (84, 0), "F_x", "blue", (13, 6)),
        (middle, (0, 92), "F_z", "blue", (0, 10)),
        ((0, 0), (0, 74), "N", "red", (12, 0)),
        ((0, 0), (-78, 0), "F_f", "red", (0, -15)),
        ((0, 0), (0, -62), "F_adh", "orange", (26, 0)),
        (middle, (-96, -30), "drag L", "green", (-18, -11)),
    ]
    for start, along, words, style, shift in forces:
        end = (start[0] + along[0], start[1] + along[1])
        pushed.arrow(start, end, style=style)
        pushed.text(end, words, shift=shift, style=style)
    pushed.turn(middle, 62, radians(75), radians(20), "blue")
    pushed.text(middle, "T_y", shift=(62, 42), style="blue")
    pushed.dot(middle)
    pushed.dot(corner, "red")
    return [named, pushed]


def clamp() -> list[Sheet]:
    """Which way the field of the clamp coil tilts the body."""
    panels = []
    for words, sign in (('clamp = "down"', 1), ('clamp = "up"', -1)):
        theta = sign * atan2(1.0, 2.0)
        sheet = Sheet(340, 220, origin=(120, 58), scale=0.62)
        _ground(sheet, -150, 330, 22)
        points = _body((0.0, 0.0), 0.0)
        corner = "front" if sign > 0 else "rear"
        tilted = _body(points[f"{corner} bottom"], theta, corner)
        shift = -tilted["middle"][0]
        tilted = {name: (x + shift, z) for name, (x, z) in tilted.items()}
        _outline(sheet, tilted)
        _moment(sheet, tilted, theta, 130)
        sheet.dot(tilted[f"{corner} bottom"], "red")
        sheet.text((0, 0), f"{words}: θ {'>' if sign > 0 else '<'} 0", shift=(0, -34))
        x, z = 200.0, 125.0 if sign > 0 else 75.0
        along, down = 110.0, -sign * 55.0
        sheet.arrow((x, z), (x + along, z), "ink")
        sheet.text((x + 0.5 * along, z), "B_x", shift=(0, 10 * sign))
        sheet.arrow((x + along, z), (x + along, z + down), "orange")
        sheet.text((x + along, z + 0.5 * down), "B_z", anchor="start", shift=(8, 0), style="orange")
        sheet.arrow((x, z), (x + along, z + down), "blue")
        sheet.text((x + 0.4 * along, z + 0.5 * down), "B", shift=(-6, -9 * sign), style="blue")
        panels.append(sheet)
    return panels


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
            for name, (x, z) in _body((0.0, 0.0), theta).items()
        }
        _outline(sheet, points, style)
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


def contact_modes() -> list[Sheet]:
    """What touches, what of friction acts and what is free, mode by mode."""
    theta = radians(24.0)
    lying, standing = _body((110.0, 0.0), 0.0), _body((100.0, 0.0), theta)
    flying = {name: (x, z + 32.0) for name, (x, z) in standing.items()}
    shown: list[tuple[str, str, dict[str, Point], str]] = [
        ("a face rests", "nothing is free", lying, "rest"),
        ("a face slides", "free: x", lying, "slide"),
        ("a corner sticks", "free: θ", standing, "stick"),
        ("a corner slips", "free: P_x, θ", standing, "slip"),
        ("flight", "free: x, z, θ", flying, "flight"),
    ]
    panels = []
    for title, free, points, kind in shown:
        sheet = Sheet(218, 222, origin=(109, 68), scale=0.55)
        _ground(sheet, -185, 185, 23)
        _outline(sheet, points)
        sheet.text((0, 0), title, shift=(0, 142))
        sheet.text((0, 0), free, shift=(0, -52), style="muted")
        corners = ["front bottom"] if points is not lying else ["front bottom", "rear bottom"]
        for name in corners if kind != "flight" else []:
            sheet.dot(points[name], "red")
        if kind in ("stick", "slip"):
            x, z = points["front bottom"]
            sheet.turn((x, z), 62, pi - theta - 0.75, pi - theta - 1.25, "green")
        if kind in ("slide", "slip"):
            x = points["front bottom"][0]
            sheet.arrow((x + 10, 12), (x + 58, 12), style="green")
            sheet.arrow((x, -13), (x - 74, -13), style="red")
            sheet.text((x - 74, -13), "μ_k N", anchor="end", shift=(-5, -5), style="red")
        if kind in ("rest", "stick"):
            x = points["front bottom"][0]
            sheet.arrow((x - 60, -13), (x + 4, -13), style="red", both=True)
            sheet.text((x - 60, -13), "up to μ_s N", "end", (-5, -5), style="red")
        if kind == "flight":
            x, z = points["middle"]
            sheet.arrow((x, z), (x + 70, z + 18), style="green")
            sheet.turn((x, z), 60, radians(150), radians(100), "green")
            sheet.text((0, 0), "no contact force", shift=(0, -25), style="red")
        panels.append(sheet)
    return panels


def walk() -> list[Sheet]:
    """A simulated walk to scale: outlines, the path of the middle, and where the contact slips."""
    run = simulate(
        Scenario(drive=Drive(frequency=30, base=0.5e-3, pulses=10), record=Record(rate=6e3))
    )
    sheet = Sheet(680, 250, origin=(150, 40), scale=0.82)
    x, z = 1e6 * run.x, 1e6 * run.z
    _ground(sheet, -170, 630, 23)
    begin = int(0.05 * 6e3) + 200  # after the ramp and one pulse
    outlines = range(begin, begin + 1801, 600)  # every third pulse
    for shade, k in zip(("ghost", "ghost", "ghost", "body"), outlines, strict=True):
        points = _body((0.0, 0.0), float(run.theta[k]))
        right, up = x[k] - points["middle"][0], z[k] - points["middle"][1]
        moved = {name: (a + right, b + up) for name, (a, b) in points.items()}
        _outline(sheet, moved, shade)
    sheet.line(*zip(x[begin:], z[begin:], strict=True), style="blue")
    _moment(sheet, moved, float(run.theta[k]))
    slips = ["slip" in run.contact_names[mode] for mode in run.contact]
    for slipping, samples in groupby(range(begin, len(x)), key=lambda k: slips[k]):
        if slipping:
            places = [1e6 * run.contact_x[k] for k in samples]
            sheet.line((min(places), -26.0), (max(places), -26.0), style="orange thick")
    return [sheet]


DRAWINGS: dict[str, Callable[[], list[Sheet]]] = {
    "coil-set": coil_set,
    "robot": robot,
    "clamp": clamp,
    "drives": drives,
    "sawtooth": sawtooth,
    "contact-modes": contact_modes,
    "walk": walk,
}
