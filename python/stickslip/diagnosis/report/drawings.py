"""Small drawings of causes on the robot, as SVG; one for each group of causes."""

from __future__ import annotations

_SURFACE = '<line class="ground" x1="8" y1="92" x2="152" y2="92"/>'
_HATCH = "".join(
    f'<line class="thin" x1="{x}" y1="92" x2="{x - 7}" y2="100"/>' for x in range(18, 152, 12)
)
_GROUND = _SURFACE + _HATCH

# The robot stands on its front edge, nose-down to the right, as while it walks.
_ROBOT = (
    '<g transform="rotate(18 106 92)">'
    '<rect class="body" x="42" y="74" width="64" height="18"/>{}</g>'
)
_MOMENT = '<path class="moment" d="M54 83 H92 M86 78 L93 83 L86 88"/>'
_PLAIN = _ROBOT.format(_MOMENT)


def _arrow(x: float, y: float, dx: float, dy: float) -> str:
    """An arrow in the colour of the cause."""
    length = (dx * dx + dy * dy) ** 0.5
    ux, uy = dx / length, dy / length
    tip = (x + dx, y + dy)
    left = (tip[0] - 8 * ux - 4 * uy, tip[1] - 8 * uy + 4 * ux)
    right = (tip[0] - 8 * ux + 4 * uy, tip[1] - 8 * uy - 4 * ux)
    return (
        f'<path class="cause" d="M{x:.1f} {y:.1f} L{tip[0]:.1f} {tip[1]:.1f} '
        f"M{left[0]:.1f} {left[1]:.1f} L{tip[0]:.1f} {tip[1]:.1f} "
        f'L{right[0]:.1f} {right[1]:.1f}"/>'
    )


def _note(x: float, y: float, text: str) -> str:
    return f'<text x="{x}" y="{y}">{text}</text>'


def _tilt(degrees: float, level: str, arrow: str, x: float) -> str:
    """The robot on a tilted surface, a level line, and an arrow downhill with its word at x."""
    tilted = f'<g transform="rotate({degrees:g} 80 80)">{_GROUND}{_PLAIN}</g>'
    return f'{tilted}<path class="thin" d="{level}"/>{arrow}{_note(x, 26, "downhill")}'


_TILT = _tilt(12, "M14 96 H100", _arrow(44, 34, 44, 9), 52)
_TILT_BACK = _tilt(-12, "M60 96 H146", _arrow(116, 34, -44, 9), 62)


def _ambient(arrows: str, x: float, y: float) -> str:
    return _GROUND + _PLAIN + arrows + _note(x, y, "B")


_AMBIENT = _ambient("".join(_arrow(20, y, 118, 0) for y in (24, 44)), 145, 38)
_AMBIENT_BACK = _ambient("".join(_arrow(138, y, -118, 0) for y in (24, 44)), 6, 38)
_AMBIENT_UP = _ambient("".join(_arrow(x, 84, 0, -68) for x in (22, 134)), 118, 20)
_AMBIENT_DOWN = _ambient("".join(_arrow(x, 16, 0, 68) for x in (22, 134)), 118, 20)


def _turned(moment: str) -> str:
    axis = '<path class="thin" d="M44 83 H118"/>'
    return _GROUND + _ROBOT.format(axis + moment) + _note(66, 40, "moment")


_TURNED = _turned(_arrow(50, 88, 50, -18))
_TURNED_DOWN = _turned(_arrow(48, 76, 44, 15))
_FRICTION = _GROUND + _PLAIN + _arrow(128, 86, -40, 0) + _note(112, 78, "F")
_PATCHES = (
    _SURFACE
    + "".join(
        f'<rect class="patch" x="{x}" y="93" width="18" height="7"/>' for x in range(10, 150, 36)
    )
    + _PLAIN
)
_ADHESION = _GROUND + _PLAIN + "".join(_arrow(x, 62, 0, 26) for x in (104, 114, 124))
_REBOUND = (
    _GROUND
    + '<g transform="translate(0 -14)">'
    + _PLAIN
    + "</g>"
    + '<path class="cause" d="M40 88 Q54 20 84 88 Q96 52 112 88 Q118 72 126 88"/>'
)
_DRAG = (
    _GROUND
    + _PLAIN
    + "".join(
        f'<path class="cause" d="M150 {y} q-8 -6 -16 0 t-16 0 t-16 0 M110 {y - 5} l-8 5 l8 5"/>'
        for y in (36, 52, 68)
    )
)
_COIL = (
    _GROUND
    + _PLAIN
    + "".join(f'<ellipse class="cause" cx="{x}" cy="60" rx="6" ry="34"/>' for x in (14, 21, 28))
    + _note(38, 30, "I")
)
_VOLTAGE = (
    '<path class="thin" d="M14 14 V90 H150"/>'
    '<path class="moment" d="M18 84 L62 28 V84 L106 28 V84 L148 30"/>'
    '<path class="cause" d="M18 84 L48 46 H66 L72 84 L92 46 H110 L116 84 L140 46"/>'
    + _note(4, 12, "U")
    + _note(142, 104, "t")
)
_LENS = (
    '<g transform="translate(112 4)"><rect class="body" x="0" y="0" width="34" height="22"/>'
    '<circle class="moment" cx="17" cy="11" r="7"/></g>'
)
_SCALE = (
    _GROUND
    + _PLAIN
    + _LENS
    + '<path class="cause" d="M26 48 H106 M26 42 V54 M46 45 V51 M66 45 V51 M86 45 V51"/>'
    + '<path class="cause" d="M106 42 V54"/>'
)
_CLOCK = (
    _GROUND
    + _PLAIN
    + _LENS
    + '<circle class="cause" cx="42" cy="34" r="22"/><path class="cause" d="M42 18 V34 L54 42"/>'
)


def _camera(degrees: float) -> str:
    """The camera's frame, turned clockwise; what is in it then looks turned the other way."""
    frame = '<rect class="cause" x="14" y="26" width="132" height="72"/>'
    return f'{_GROUND}{_PLAIN}<g transform="rotate({degrees:g} 80 60)">{frame}</g>{_LENS}'


_CAMERA, _CAMERA_BACK = _camera(-9), _camera(9)
_AXES = '<path class="ground" d="M24 12 V94 H146"/>'
_READ_OFF = (
    _AXES
    + '<path class="thin" d="M24 94 L112 24"/><path class="cause" d="M24 76 L112 6"/>'
    + _note(112, 106, "true")
    + _note(2, 10, "read")
)
_READ_LIMIT = (
    _AXES
    + '<path class="thin" d="M24 94 L128 14"/><path class="cause" d="M24 94 L84 48 H138"/>'
    + _note(112, 106, "true")
    + _note(2, 10, "read")
)
_PROBE = (
    '<path class="ground" d="M60 90 V24 M60 90 H136"/>'
    '<g transform="rotate(-14 60 90)"><path class="cause" d="M60 90 V24 M60 90 H136"/>'
    '<rect class="body" x="48" y="78" width="24" height="24"/></g>'
    + _note(140, 94, "x")
    + _note(56, 18, "z")
)
_WEIGHT = _GROUND + _PLAIN + _arrow(72, 40, 0, 44) + _note(60, 34, "m g")
_FIELD = (
    _GROUND
    + _PLAIN
    + "".join(f'<path class="cause" d="M10 {y} Q80 {y - 26} 150 {y}"/>' for y in (40, 56))
    + _note(76, 20, "B")
)

_DRAWINGS = {
    "tilt": (_TILT, "The robot on a tilted surface"),
    "ambient": (_AMBIENT, "A uniform field across the robot"),
    "moment": (_TURNED, "The robot's magnetic moment beside its long axis"),
    "friction": (_FRICTION, "Friction at the robot's edge"),
    "patches": (_PATCHES, "Patches of other friction on the surface"),
    "adhesion": (_ADHESION, "Adhesion that pulls the robot's edge down"),
    "rebound": (_REBOUND, "The robot rebounds from the surface"),
    "drag": (_DRAG, "Drag of the fluid about the robot"),
    "coil": (_COIL, "A coil beside the robot and its current"),
    "voltage": (_VOLTAGE, "The stated voltage over time, and the one that is there"),
    "field": (_FIELD, "Field lines at the robot"),
    "scale": (_SCALE, "A scale beside the robot in the camera's picture"),
    "clock": (_CLOCK, "The camera and its clock"),
    "camera": (_CAMERA, "The camera's picture, turned against the surface"),
    "reading": (_READ_OFF, "What is read over what is true"),
    "limit": (_READ_LIMIT, "What is read over what is true, up to a limit"),
    "probe": (_PROBE, "A probe whose axes are turned against those of the coils"),
    "weight": (_WEIGHT, "The robot's weight"),
}

_POINTING = {
    ("tilt", "downhill to -x"): _TILT_BACK,
    ("ambient", "along -x"): _AMBIENT_BACK,
    ("ambient", "along +z"): _AMBIENT_UP,
    ("ambient", "along -z"): _AMBIENT_DOWN,
    ("moment", "nose-down"): _TURNED_DOWN,
    ("camera", "nose-up"): _CAMERA_BACK,
}
"""Drawings whose arrow points another way than the first, by the word for the sign."""

DRAWN = frozenset(_DRAWINGS)
"""Names of all drawings."""


def drawing(name: str, way: str = "") -> str:
    """The drawing of that name as SVG; its parts have classes of the page's style.

    `way` is the word for the sign of what was found, by which an arrow points.
    """
    shapes, title = _DRAWINGS[name]
    shapes = _POINTING.get((name, way), shapes)
    return (
        f'<svg class="drawing" viewBox="0 0 160 110" role="img" aria-label="{title}">'
        f"<title>{title}</title>{shapes}</svg>"
    )
