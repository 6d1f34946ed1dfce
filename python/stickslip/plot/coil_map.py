"""The five coils: their field in the plane y = 0 with the robot in it, and what single ones do."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import ArrayLike

from stickslip._util import palette
from stickslip._util.arrays import Array, in_columns
from stickslip._util.messages import check_kind
from stickslip._util.picture import RC, Picture
from stickslip.field.coils import AXES, Coils
from stickslip.plot import style
from stickslip.scenario.keys import COIL_NAMES
from stickslip.scenario.scenario import Scenario

_REACH = 1.3  # half of the width that is drawn, in distances of the farthest wire; chosen by eye
_CELLS = 160  # along each side of the map; chosen: finer than the dots of half a page
_SCALE = 0.01, 0.98  # parts of the map below the ends of the scale: near wires is the rest; by eye
_ARROW = 0.14  # length of the arrow of the moment, as a part of the width; chosen by eye

_ALONG = 10e-3  # m, to both sides of the centre; chosen: ten lengths of a large robot
_TIMES = 5.0  # of the time constant: 99 % of a step

_WORDS: Any = {"fontsize": 8.0, "ha": "center", "va": "center"}
_WORDS["bbox"] = {"facecolor": "white", "alpha": 0.85, "edgecolor": "none", "pad": 1.5}


def coils(scenario: Scenario, currents: ArrayLike | None = None, ax: Axes | None = None) -> Figure:
    """Draw the five coils with their field in the plane y = 0, and the robot as a mark.

    Colours show abs(B) of the coils by Eqs. (2)-(7) on a logarithmic scale, without other effects;
    field lines are white. Circles are the wires of the coils at +x and
    -x and of the one below; a dot in one is a current towards the reader, a cross one away. A
    dashed line is the outline of the coils at +y and -y. A field map (``coil.map``) is drawn in its
    box and without wires, as it does not say where they are. The arrow is the moment of the robot
    where the scenario begins, and beside it stands the strength of the field there.

    Parameters
    ----------
    scenario : Scenario
        Its coils and initial state are drawn.
    currents : array_like, shape (5,), optional
        Of the coils in the order of `COIL_NAMES`, A. If not given, those that the highest voltages
        of the drive would drive if they were held for ever: of a sawtooth, those of its top.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure, if not given.

    Raises
    ------
    ScenarioError
        If `scenario` is none.
    ValueError
        If the currents are not five finite numbers, or make no field.
    """
    check_kind("scenario", scenario, Scenario)
    if currents is None:
        amperes = _highest_currents(scenario)
    else:
        allowed = "a list of five finite numbers, A"
        amperes = in_columns("currents", currents, COIL_NAMES, allowed, axes=1, unit="A")
    made = Coils.of(scenario)
    labels = [f"{name}: {value:.3g} A" for name, value in zip(COIL_NAMES, amperes, strict=True)]
    halves, distances = (np.broadcast_to(lengths, 5) for lengths in (made.side, made.distance))
    halves = 0.5 * halves
    reach = _REACH * max(halves.max(), distances.max())
    box = made.box or ([-reach] * 3, [reach] * 3)
    low, high = (np.array(corner)[[0, 2]] for corner in box)
    height = min(1.0, (high[1] - low[1]) / (high[0] - low[0]))
    with style.drawing(ax, (6.4, 1.0 + 4.4 * height)) as axes:
        _draw_field(axes, made, amperes, low, high)
        if made.box is None:
            _draw_wires(axes, halves, distances, amperes, labels)
        else:
            axes.set_title(", ".join(labels), fontsize=8.0)
        _draw_robot(axes, made, amperes, scenario)
        axes.set(xlabel="x (mm)", ylabel="z (mm)", aspect="equal")
        axes.grid(visible=False)
    return style.root_figure(axes)


def _highest_currents(scenario: Scenario) -> Array:
    """Currents of the highest voltages of the drive in a steady state, A.

    Highest is the greatest sum of the magnitudes of all five.
    """
    core = scenario.to_core()
    voltages = np.concatenate([values for _, values, _ in core.program().blocks])
    highest = voltages[np.abs(voltages).sum(axis=1).argmax()]
    return np.asarray(highest / np.array(core.resistances()) + 0.0)  # no negative zeros


def _draw_field(axes: Axes, made: Coils, currents: Array, low: Array, high: Array) -> None:
    """Colours and field lines from one corner to another, x and z in m."""
    parts = (np.arange(_CELLS) + 0.5) / _CELLS
    x, z = (start + (stop - start) * parts for start, stop in zip(low, high, strict=True))
    across, up = np.meshgrid(x, z)
    field = made.field(np.stack([across, np.zeros_like(up), up], axis=-1), currents) * 1e3
    strength = np.linalg.norm(field, axis=-1)
    if strength.max() == 0.0:
        raise ValueError(
            "no coil has a current that makes a field, so that there is no field to draw: "
            "give currents"
        )
    look: Any = {"norm": LogNorm(*np.quantile(strength, _SCALE)), "rasterized": True}
    mesh = axes.pcolormesh(x * 1e3, z * 1e3, strength, cmap="viridis", **look)
    look = {"color": "white", "linewidth": 0.6, "arrowsize": 0.7, "density": 1.1}
    axes.streamplot(x * 1e3, z * 1e3, field[..., 0], field[..., 2], **look)
    axes.margins(0.0)
    ticks = LogLocator(subs=(1.0, 2.0, 5.0))
    bar = style.root_figure(axes).colorbar(mesh, ax=axes, extend="both", ticks=ticks, format="%g")
    bar.minorticks_off()
    bar.set_label(r"$|B|$ (mT)")


def _draw_wires(
    axes: Axes, halves: Array, distances: Array, currents: Array, labels: list[str]
) -> None:
    half = dict(zip(COIL_NAMES, halves * 1e3, strict=True))
    far = dict(zip(COIL_NAMES, distances * 1e3, strict=True))
    # A positive current turns right-handed about the axis of its coil: towards the reader, who
    # looks along +y, at the first of two places.
    crossed = {
        "xp": [(far["xp"], half["xp"]), (far["xp"], -half["xp"])],
        "xm": [(-far["xm"], half["xm"]), (-far["xm"], -half["xm"])],
        "clamp": [(-half["clamp"], -far["clamp"]), (half["clamp"], -far["clamp"])],
    }
    for name, places in crossed.items():
        coil = COIL_NAMES.index(name)
        for place, towards in zip(places, (currents[coil], -currents[coil]), strict=True):
            axes.plot(*place, "o", color="white", markeredgecolor=palette.BLACK, markersize=9)
            if towards:
                axes.plot(*place, "." if towards > 0.0 else "x", color=palette.BLACK, markersize=5)
        x, z = np.mean(places, axis=0)
        axes.text(x, z, labels[coil], rotation=0.0 if name == "clamp" else 90.0, **_WORDS)
    for name in ("yp", "ym"):
        side = half[name] * np.array([-1.0, 1.0, 1.0, -1.0, -1.0])
        axes.plot(side, np.roll(side, 1), "--", color=palette.LIGHT_GREY, linewidth=1.0)
    axes.text(0.0, -half["yp"], ", ".join(labels[2:4]), **_WORDS)


def _draw_robot(axes: Axes, made: Coils, currents: Array, scenario: Scenario) -> None:
    """A mark where the scenario begins, with the moment, and in words the field there."""
    begin, drive = scenario.initial, scenario.drive
    heading = (0.0 if drive.direction == "+x" else np.pi) + float(drive.heading)
    if scenario.whole_plane and (drive.kind == "program" or begin.heading != 0.0):
        heading = float(begin.heading)
    place = np.array([begin.x, begin.y, max(begin.z, 0.5 * scenario.robot.height)])
    words = "robot"
    if made.box is None or np.all((made.box[0] <= place) & (place <= made.box[1])):
        strength = float(np.linalg.norm(made.field(place, currents)))
        words += f", B = {strength * 1e3:.3g} mT"
    x, _, z = place * 1e3
    axes.plot(x, z, "o", color="white", markeredgecolor=palette.BLACK, markersize=6, zorder=3.2)
    towards = np.array([np.cos(begin.theta) * np.cos(heading), -np.sin(begin.theta)])
    tip = np.array([x, z]) + _ARROW * np.ptp(axes.get_xlim()) * towards
    style.arrow(axes, (x, z), tip, palette.BLACK, 1.8)
    look = _WORDS | {"va": "bottom", "xytext": (0.0, 9.0), "textcoords": "offset points"}
    axes.annotate(words, (x, z), zorder=3.2, **look)


def coil_lines(scenario: Scenario) -> Figure:
    """Draw the field of each coil along its axis per ampere, and its current after a step.

    A coil that is as one before it is not drawn again. A field map is drawn within its box.

    Parameters
    ----------
    scenario : Scenario
        Its coils are drawn.

    Raises
    ------
    ScenarioError
        If `scenario` is none.
    """
    check_kind("scenario", scenario, Scenario)
    made = Coils.of(scenario)
    drawn: dict[tuple[Any, str], int] = {}
    for number, name in enumerate(COIL_NAMES):
        of_axis = ("x", "z")[name == "clamp"] if made.box is None else name
        drawn.setdefault((getattr(scenario.coil, name), of_axis), number)
    with matplotlib.rc_context(RC):
        figure = Picture(figsize=(6.4, 2.8), layout="constrained")
        field, current = figure.subplots(1, 2)
        for (coil, _), number in drawn.items():
            axis = AXES[number]
            low, high = (made.box[0][axis], made.box[1][axis]) if made.box else (-1.0, 1.0)
            place = np.linspace(max(low, -_ALONG), min(high, _ALONG), 101)
            along = made.field(place[:, np.newaxis] * np.eye(3)[axis], np.eye(5)[number])[:, axis]
            field.plot(1e3 * place, 1e3 * along, label=COIL_NAMES[number])
            passed = np.linspace(0.0, _TIMES, 101)
            rise_time = coil.inductance / coil.resistance
            current.plot(1e3 * rise_time * passed, -100.0 * np.expm1(-passed))
        field.set(xlabel="place on its axis (mm)", ylabel="field (mT/A)")
        current.set(xlabel="time after a step (ms)", ylabel="current (% of steady)")
        field.legend()
    return figure
