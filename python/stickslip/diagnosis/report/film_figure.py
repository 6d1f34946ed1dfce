"""The figure of a tracked run: the folded motion, and force residuals against four variables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.palette import BLUE, DARK_GREY, PALE_BLUE, VERMILION
from stickslip._util.picture import Picture
from stickslip.diagnosis.observables.tracking.force_residuals import ForceView, Residual

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trace:
    """One quantity of the folded motion as it is drawn, in the label's unit, shape (g,) each."""

    label: str
    measured: Array
    recalibrated: Array
    extended: Array | None


def traces(view: ForceView, after: ForceView | None) -> tuple[Trace, Trace]:
    """Tilt and place over the phase of the drive; `after` is the extended model's view."""
    degree, um = np.degrees(1.0), 1e6
    extended: tuple[Array | None, Array | None] = (None, None)
    if after is not None:
        # Each model has a camera of its own; the readings are drawn as the recalibrated one has
        # them.
        extended = (
            (view.theta + after.theta_model - after.theta) * degree,
            (view.place + after.place_model - after.place) * um,
        )
    tilt = Trace("tilt (degrees)", view.theta * degree, view.theta_model * degree, extended[0])
    place = Trace("x less its drift (um)", view.place * um, view.place_model * um, extended[1])
    return tilt, place


def film_figure(view: ForceView, after: ForceView | None) -> Figure:
    """Folded motion above, and below it the residuals of torque and force that can be judged."""

    rows = [
        (name, found, unit, f"{label}\n{name}")
        for name, found, unit, label in (
            ("sticking", view.sticking, 1e12, "torque residual (pN m)"),
            ("slipping", view.slipping, 1e9, "force residual (nN)"),
        )
        if found is not None
    ]
    figure = Picture(figsize=(10.0, 2.9 + 2.35 * len(rows)), layout="constrained")
    layout = [["tilt", "tilt", "place", "place"]]
    layout += [[f"{name}{k}" for k in range(4)] for name, *_ in rows]
    frames: dict[str, Any] = figure.subplot_mosaic(layout)  # type: ignore[arg-type]
    for each, trace in zip((frames["tilt"], frames["place"]), traces(view, after), strict=True):
        lines = {
            "measured, smoothed": (trace.measured, "k", 1.6, "-"),
            "recalibrated": (trace.recalibrated, BLUE, 1.4, "--"),
            "extended": (trace.extended, VERMILION, 1.4, ":"),
        }
        for label, (values, colour, width, style) in lines.items():
            if values is not None:
                each.plot(view.phase, values, color=colour, lw=width, ls=style, label=label)
        each.set_xlabel("phase of the drive")
        each.set_ylabel(trace.label)
    frames["tilt"].legend(fontsize=8, frameon=False)
    for name, found, unit, label in rows:
        later = None if after is None else getattr(after, name)
        _residuals([frames[f"{name}{k}"] for k in range(4)], view, found, later, unit)
        frames[f"{name}0"].set_ylabel(label)
    return figure


def _residuals(
    frames: list[Any], view: ForceView, found: Residual, after: Residual | None, unit: float
) -> None:
    """One residual against theta, its rate, contact velocity and phase."""
    variables = (
        (np.degrees(view.theta), "tilt (degrees)"),
        (view.rate, "its rate (rad/s)"),
        (view.contact_velocity * 1e3, "contact velocity (mm/s)"),
        (view.phase, "phase of the drive"),
    )
    for each, (variable, name) in zip(frames, variables, strict=True):
        each.axhline(0.0, color=DARK_GREY, lw=0.8)
        each.set_xlabel(name)
        each.tick_params(labelsize=8)
        each.locator_params(axis="x", nbins=4)
        if each is not frames[0]:
            each.sharey(frames[0])
            each.tick_params(labelleft=False)
        at, value, sd = _well_separated(view, found)
        each.errorbar(variable[at], value * unit, sd * unit, fmt="o", color=BLUE,
                      ecolor=PALE_BLUE, ms=3.5, lw=1.0, label="recalibrated")  # fmt: skip
        if after is not None:
            at, value, _ = _well_separated(view, after)
            each.plot(variable[at], value * unit, "D", color=VERMILION, mfc="none", ms=4,
                      label="extended")  # fmt: skip
    if after is not None:
        frames[3].legend(fontsize=7, frameon=False)


def _well_separated(view: ForceView, found: Residual) -> tuple[NDArray[np.int64], Array, Array]:
    """Places, values and errors at half the distance that the smoothing resolves."""
    step = max(1, len(view.phase) // (4 * view.orders))
    kept = slice(step // 2 % max(len(found.where), 1), None, step)
    return found.where[kept], found.value[kept], found.sd[kept]
