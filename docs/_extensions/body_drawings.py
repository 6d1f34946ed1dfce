"""The drawings of the body: its angles and forces, its tilt, and what touches.

The sizes are those of the package's defaults, so that a drawing cannot contradict them.
"""

from __future__ import annotations

from math import atan2, cos, pi, radians, sin

from svg import Point, Sheet

from stickslip import Robot

_ROBOT = Robot()


def axis(sheet: Sheet, at: Point, along: Point, words: str, shift: Point) -> None:
    end = (at[0] + along[0], at[1] + along[1])
    sheet.arrow(at, end, style="thin")
    sheet.text(end, words, shift=shift)


def corners(place: Point, theta: float, corner: str = "front") -> dict[str, Point]:
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


def outline(sheet: Sheet, points: dict[str, Point], style: str = "body") -> None:
    sheet.polygon(
        [points[name] for name in ("front bottom", "front top", "rear top", "rear bottom")],
        style,
    )


def moment(sheet: Sheet, points: dict[str, Point], theta: float, length: float = 75.0) -> None:
    x, z = points["middle"]
    start = (x - 0.5 * length * cos(theta), z + 0.5 * length * sin(theta))
    end = (x + 0.5 * length * cos(theta), z - 0.5 * length * sin(theta))
    sheet.arrow(start, end, style="blue")


def ground(sheet: Sheet, left: float, right: float, spacing: float) -> None:
    sheet.line((left, 0.0), (right, 0.0))
    count = int((right - left) / spacing)
    for k in range(count):
        x = left + (k + 0.7) * spacing
        sheet.line((x, 0.0), (x - 0.6 * spacing, -0.6 * spacing), style="faint")


def robot() -> list[Sheet]:
    """Angles and corners of the body, and the forces on it."""
    theta = radians(28.0)
    phi = atan2(_ROBOT.height, _ROBOT.length)
    named = Sheet(340, 270, origin=(258, 52), scale=0.8)
    points = corners((0.0, 0.0), theta)
    ground(named, -295, 95, 18)
    outline(named, points)
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
    axis(named, (-290, 190), (40, 0), "x", (9, 0))
    axis(named, (-290, 190), (0, 40), "z", (0, 9))

    pushed = Sheet(340, 270, origin=(225, 90), scale=0.72)
    ground(pushed, -290, 130, 22)
    outline(pushed, points)
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
        ground(sheet, -150, 330, 22)
        points = corners((0.0, 0.0), 0.0)
        corner = "front" if sign > 0 else "rear"
        tilted = corners(points[f"{corner} bottom"], theta, corner)
        shift = -tilted["middle"][0]
        tilted = {name: (x + shift, z) for name, (x, z) in tilted.items()}
        outline(sheet, tilted)
        moment(sheet, tilted, theta, 130)
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


def contact_modes() -> list[Sheet]:
    """What touches, what of friction acts and what is free, mode by mode."""
    theta = radians(24.0)
    lying, standing = corners((110.0, 0.0), 0.0), corners((100.0, 0.0), theta)
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
        ground(sheet, -185, 185, 23)
        outline(sheet, points)
        sheet.text((0, 0), title, shift=(0, 142))
        sheet.text((0, 0), free, shift=(0, -52), style="muted")
        touching = ["front bottom"] if points is not lying else ["front bottom", "rear bottom"]
        for name in touching if kind != "flight" else []:
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
