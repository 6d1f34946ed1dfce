"""The five coils, their field in the plane of motion, and the robot between them."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from matplotlib.ticker import LogLocator
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull

from stickslip._util import palette
from stickslip._util.numbers import Array
from stickslip.field.coils import Coils
from stickslip.plot import style
from stickslip.plot.canvas import drawing, root_figure
from stickslip.plot.film import body_arrow, thin_arrow
from stickslip.plot.motion import rectangle
from stickslip.plot.scales import length_bar
from stickslip.scenario.keys import check_kind
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import COIL_NAMES

_REACH = 1.3  # half of the width that is drawn, in distances of the farthest wire; chosen by eye
_CELLS = 160  # along each side of the map; chosen: finer than the dots of half a page
_NEAR = 0.1  # in the same distances: nearer to a wire, |B| is beyond the scale of colours
_DARKEST = 0.01  # part of the map whose |B| is below the scale of colours; chosen by eye
_INSET = (0.27, 0.6, 0.46, 0.37)  # left, bottom, width, height; above the robot, where no coil is
_ROBOT_VIEW = 3.0  # width of the inset in lengths of the body; chosen by eye
_ARROW = 0.75  # length of the arrow of the field in lengths of the body; chosen by eye

_NO_FIELD = (
    "no coil has a current that makes a field, so that there is no field to draw: give currents"
)


def coils(scenario: Scenario, currents: ArrayLike | None = None, ax: Axes | None = None) -> Figure:
    """Draw the five coils with their field in the plane y = 0, and the robot to scale.

    Coloured is abs(B) on a logarithmic scale, with field lines in white: that of the coils, also of
    coils of one's own, by Eqs. (2)-(7), without what other named effects add. With ``coil.map`` the
    drawing ends where the map does, and no wires are drawn, as it does not say where they are. The
    wires of the
    coils at +x and -x and of the one below cross the plane at the circles; a dot in one is a
    current towards the reader, a cross one away. The coils at +y and -y lie behind and before the
    plane, and a dashed line is their outline.
    The inset is an enlarged view of the robot where the scenario begins, with its moment (blue) and
    the field there (green, as long as its part in the plane); no field outside of a map. A robot
    at a heading is drawn as it is seen along +y, and its heading is written below it.

    Parameters
    ----------
    scenario : Scenario
        Of which coils, robot and initial state are drawn, and the currents taken.
    currents : array_like, shape (5,), optional
        Of the coils in the order of `COIL_NAMES`, A. If not given, those that the highest voltages
        of the drive would drive if they were held for ever: of a sawtooth, those of its top.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure, if not given.

    Returns
    -------
    matplotlib.figure.Figure
        The one that holds the axes.

    Raises
    ------
    ScenarioError
        If `scenario` is none.
    ValueError
        If the currents are not five finite numbers, or make no field.
    """
    check_kind("scenario", scenario, Scenario)
    amperes = _highest_currents(scenario) if currents is None else np.asarray(currents, np.float64)
    if amperes.shape != (len(COIL_NAMES),) or not np.isfinite(amperes).all():
        raise ValueError(f"currents = {currents!r}: allowed are five finite numbers, A")
    if not amperes.any():
        raise ValueError(_NO_FIELD)
    made = Coils.of(scenario)
    with drawing(ax, (6.4, 5.4)) as axes:
        if made.box is None:
            _draw_field(axes, made, amperes)
            _draw_wires(axes, made, amperes)
        else:
            _draw_measured_field(axes, made, amperes)
        _draw_robot(axes, made, amperes, scenario)
        axes.set_xlabel("x (mm)")
        axes.set_ylabel("z (mm)")
        axes.grid(visible=False)
    return root_figure(axes)


def _highest_currents(scenario: Scenario) -> Array:
    """Currents of the highest voltages of the drive in a steady state, A.

    Highest is the greatest sum of the magnitudes of all five.
    """
    core = scenario.to_core()
    voltages = np.concatenate([values for _, values, _ in core.program()])
    highest = voltages[np.abs(voltages).sum(axis=1).argmax()]
    return np.asarray(highest / np.array(core.resistances()) + 0.0)  # no negative zeros


def _sizes(coils: Coils) -> dict[str, tuple[float, float]]:
    """Half of the side of each coil, and the distance of its plane, m."""
    halves, distances = 0.5 * np.broadcast_to(coils.side, 5), np.broadcast_to(coils.distance, 5)
    pairs = zip(halves.tolist(), distances.tolist(), strict=True)
    return dict(zip(COIL_NAMES, pairs, strict=True))


def _farthest(coils: Coils) -> float:
    """Distance of the farthest plane or side of a coil from the origin, m."""
    return max(max(each) for each in _sizes(coils).values())


def _wires(coils: Coils) -> dict[str, tuple[Array, float]]:
    """Where each coil crosses the plane of motion, m, shape (2, 2); the coils at y do not.

    The number is the sign of the current along y, away from the reader, at the first place, for a
    positive current: it turns right-handed about the axis of its coil.
    """
    places = {}
    sizes = _sizes(coils)
    for name, side in (("xp", 1.0), ("xm", -1.0)):
        half, far = sizes[name]
        places[name] = (np.array([[side * far, half], [side * far, -half]]), -1.0)
    half, far = sizes["clamp"]
    places["clamp"] = (np.array([[half, -far], [-half, -far]]), 1.0)
    return places


def _draw_field(axes: Axes, coils: Coils, currents: Array) -> None:
    far = _farthest(coils)
    reach = _REACH * far
    places = reach * _centres()
    x, z = np.meshgrid(places, places)
    field = coils.field(np.stack([x, np.zeros_like(x), z], axis=-1), currents) * 1e3
    strength = np.linalg.norm(field, axis=-1)
    wires = np.concatenate([where for where, _ in _wires(coils).values()])
    distances = np.hypot(x[..., None] - wires[:, 0], z[..., None] - wires[:, 1]).min(axis=-1)
    # Places near to a wire are beyond the scale, and so are small ones where the fields cancel.
    shown = strength[distances > _NEAR * far]
    _paint(axes, places * 1e3, places * 1e3, field, shown)
    axes.set_xlim(-reach * 1e3, reach * 1e3)
    axes.set_ylim(-reach * 1e3, reach * 1e3)


def _draw_measured_field(axes: Axes, coils: Coils, currents: Array) -> None:
    """The field in the box of a map, with the currents above it."""
    low, high = (np.array(corner)[[0, 2]] for corner in coils.box or ())
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    x_places, z_places = middle[:, None] + half[:, None] * _centres()
    x, z = np.meshgrid(x_places, z_places)
    field = coils.field(np.stack([x, np.zeros_like(x), z], axis=-1), currents) * 1e3
    _paint(axes, x_places * 1e3, z_places * 1e3, field, np.linalg.norm(field, axis=-1))
    # As wide as high, as the inset of the robot expects it.
    first, last = (middle - half.max()) * 1e3, (middle + half.max()) * 1e3
    axes.set_xlim(first[0], last[0])
    axes.set_ylim(first[1], last[1])
    pairs = zip(COIL_NAMES, currents.tolist(), strict=True)
    axes.set_title(", ".join(f"{name}: {value:.3g} A" for name, value in pairs), fontsize=8.0)


def _centres() -> Array:
    """Of cells from -1 to 1."""
    return (2.0 * np.arange(_CELLS) + 1.0) / _CELLS - 1.0


def _paint(axes: Axes, x: Array, z: Array, field: Array, shown: Array) -> None:
    """Colours and field lines of a field (mT) at places (mm), in the scale of some strengths."""
    if shown.max() == 0.0:
        raise ValueError(_NO_FIELD)
    mesh = axes.pcolormesh(
        x,
        z,
        np.linalg.norm(field, axis=-1),
        norm=LogNorm(float(np.quantile(shown, _DARKEST)), shown.max()),
        cmap="viridis",
        rasterized=True,
    )
    axes.streamplot(
        x,
        z,
        field[..., 0],
        field[..., 2],
        color="white",
        linewidth=0.6,
        arrowsize=0.7,
        density=1.1,
    )
    axes.set_aspect("equal")
    ticks = LogLocator(subs=(1.0, 2.0, 5.0))
    bar = root_figure(axes).colorbar(mesh, ax=axes, extend="both", ticks=ticks, format="%g")
    bar.set_label(r"$|B|$ (mT)")


def _draw_wires(axes: Axes, coils: Coils, currents: Array) -> None:
    amperes = dict(zip(COIL_NAMES, currents.tolist(), strict=True))
    words: Any = {"fontsize": 8.0, "ha": "center", "va": "center"}
    words["bbox"] = {"facecolor": "white", "alpha": 0.85, "edgecolor": "none", "pad": 1.5}
    for name, (places, sign) in _wires(coils).items():
        first = sign * np.sign(amperes[name])
        for (x, z), away in zip(places * 1e3, (first, -first), strict=True):
            axes.plot(x, z, "o", color="white", markeredgecolor=palette.BLACK, markersize=9)
            if away:
                inside = "x" if away > 0.0 else "."
                axes.plot(x, z, inside, color=palette.BLACK, markersize=5)
        x, z = places.mean(axis=0) * 1e3
        rotation = 0.0 if name == "clamp" else 90.0
        axes.text(x, z, f"{name}: {amperes[name]:.3g} A", rotation=rotation, **words)
    sizes = _sizes(coils)
    for half in {sizes[name][0] * 1e3 for name in ("yp", "ym")}:
        outline = Rectangle((-half, -half), 2.0 * half, 2.0 * half, fill=False, linestyle="--")
        outline.set_edgecolor(palette.LIGHT_GREY)
        axes.add_patch(outline)
    lower = -sizes["yp"][0] * 1e3
    axes.text(0.0, lower, f"yp: {amperes['yp']:.3g} A, ym: {amperes['ym']:.3g} A", **words)


def _draw_robot(axes: Axes, coils: Coils, currents: Array, scenario: Scenario) -> None:
    """The robot where it begins, in an inset whose arrows of moment and field are named."""
    robot, begin = scenario.robot, scenario.initial
    heading = _heading(scenario)
    along, z = rectangle(robot.length, robot.height, 1.0, 0.0, begin.z, begin.theta)
    if begin.z == 0.0:  # its lowest corner lies on the surface
        z = z - z.min()
    middle = np.column_stack([begin.x + along * np.cos(heading), z]) * 1e6
    outline = _seen_from_the_side(middle, 0.5e6 * robot.width * np.sin(heading))
    centre = middle.mean(axis=0)

    inset = axes.inset_axes(_INSET)
    inset.axhline(0.0, color=palette.BLACK, linewidth=1.0)
    inset.add_patch(Polygon(outline, facecolor=style.BODY, edgecolor=palette.BLACK, linewidth=1.2))
    moment = thin_arrow(palette.BLACK, 1.4)
    moment.set_positions(*body_arrow(middle))
    inset.add_patch(moment)
    if scenario.turns:
        words = f"heading {np.degrees(heading):.3g} degrees"
        inset.text(0.5, 0.07, words, transform=inset.transAxes, fontsize=8.0, ha="center")
    size = robot.length * 1e6
    place = np.array([centre[0], 0.0, centre[1]]) * 1e-6
    if _is_known(coils, place):
        _draw_field_arrow(inset, coils.field(place, currents), centre, size)
    width = _ROBOT_VIEW * size
    inset.set_xlim(centre[0] - 0.5 * width, centre[0] + 0.5 * width)
    inset.set_ylim(-0.15 * width, (_INSET[3] / _INSET[2] - 0.15) * width)
    inset.set_aspect("equal", adjustable="datalim")
    inset.set_xticks([])
    inset.set_yticks([])
    inset.grid(visible=False)
    length_bar(inset, width)
    axes.annotate(
        "",
        xy=tuple(centre * 1e-3),
        xytext=(0.5, _INSET[1]),
        textcoords="axes fraction",
        arrowprops={"arrowstyle": "-", "color": palette.BLACK, "linewidth": 0.8},
    )
    axes.plot(*(centre * 1e-3), "+", color=palette.BLACK, markersize=7)


def _heading(scenario: Scenario) -> float:
    """Where the robot faces as the scenario begins, rad from +x to the left."""
    drive, told = scenario.drive, scenario.initial.heading
    if scenario.turns and (drive.mode == "program" or told != 0.0):
        return float(told)
    return (0.0 if drive.direction == "+x" else np.pi) + float(drive.heading)


def _seen_from_the_side(middle: Array, beside: float) -> Array:
    """Outline along +y of a body whose middle is seen as `middle`, shape (4, 2), and whose sides
    are seen by `beside` to the left and right of it, in a unit of length."""
    if abs(beside) < 1e-6 * np.ptp(middle):  # the rounding of a heading of pi
        return middle
    step = np.array([beside, 0.0])
    seen = np.concatenate([middle - step, middle + step])
    return np.asarray(seen[ConvexHull(seen).vertices])


def _is_known(coils: Coils, place: Array) -> bool:
    """Whether the coils have a field at a place (m): beyond a map there is none."""
    if coils.box is None:
        return True
    low, high = (np.array(corner) for corner in coils.box)
    return bool(np.all((low <= place) & (place <= high)))


def _draw_field_arrow(inset: Axes, field: Array, centre: Array, size: float) -> None:
    """The field (T) over a robot of a size and with a centre in um."""
    strength = float(np.linalg.norm(field))
    arrow = thin_arrow(palette.GREEN, 1.8)
    towards = _ARROW * size * field[[0, 2]] / strength if strength > 0.0 else np.zeros(2)
    foot = centre + np.array([0.0, 0.9 * size])
    arrow.set_positions(tuple(foot - 0.5 * towards), tuple(foot + 0.5 * towards))
    if np.hypot(*towards) > 0.1 * size:  # a shorter one has a head only
        inset.add_patch(arrow)
    inset.text(
        0.97,
        0.93,
        f"B = {strength * 1e3:.3g} mT",
        transform=inset.transAxes,
        color=palette.GREEN,
        fontsize=8.5,
        ha="right",
        va="center",
    )
