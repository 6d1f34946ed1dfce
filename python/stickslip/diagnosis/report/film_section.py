"""The part of the report that shows a tracked run: folded motion, force residuals, and words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.palette import BLUE, DARK_GREY, PALE_BLUE, VERMILION
from stickslip.diagnosis.observables.tracking.comparison import (
    Directions,
    FilmComparison,
    compare_directions,
    opposite,
)
from stickslip.diagnosis.observables.tracking.force_residuals import (
    FEWEST_ORDERS,
    ForceView,
    Residual,
)
from stickslip.diagnosis.report.figures import png
from stickslip.diagnosis.report.film_messages import advance_lines, direction_lines, view_lines
from stickslip.diagnosis.report.section import ReportSection
from stickslip.facts import Code, Fact

Array = NDArray[np.float64]


def film_sections(film: FilmComparison, earlier: Sequence[FilmComparison]) -> list[ReportSection]:
    """The section of one run; with the second of two directions, one of their difference."""
    title = f"Tracking of {film.file}"
    if film.view is None:
        lines = (Fact(Code.NO_FORCE_VIEW, {}),)
        return [ReportSection(title, "", lines, {"held_out": film.held_out})]
    told = [*advance_lines(film.advance), *view_lines(film.view, film.after)]
    numbers = {
        "held_out": film.held_out, "advance": film.advance, **_numbers(film.view, film.after)
    }  # fmt: skip
    sections = [ReportSection(title, _figure(film.view, film.after), tuple(told), numbers)]
    for other in earlier:
        if other.view is not None and opposite(film, other):
            found = compare_directions(other, film)
            title = f"{other.file} and {film.file}: forward and reversed"
            numbers = _direction_numbers(found)
            sections.append(ReportSection(title, "", tuple(direction_lines(found)), numbers))
    return sections


def _direction_numbers(found: Directions | None) -> dict[str, object]:
    if found is None:
        return {}
    numbers: dict[str, object] = {"advance_sum": found.total, "advance_sum_sd": found.sd}
    if found.world is not None:
        numbers |= {
            "force_world": found.world, "force_robot": found.robot, "force_sd": found.force_sd
        }  # fmt: skip
    return numbers


@dataclass(frozen=True)
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


def _figure(view: ForceView, after: ForceView | None) -> str:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    later = (None, None) if after is None else (after.sticking, after.slipping)
    rows = [
        (found, found_later, unit, label)
        for found, found_later, unit, label in (
            (view.sticking, later[0], 1e12, "torque residual (pN m)\nsticking"),
            (view.slipping, later[1], 1e9, "force residual (nN)\nslipping"),
        )
        if found is not None
    ]
    figure = Figure(figsize=(10.0, 2.9 + 2.35 * len(rows)), layout="constrained")
    FigureCanvasAgg(figure)
    axes: Any = figure.subplots(1 + len(rows), 4 if rows else 2, squeeze=False)
    if rows:
        grid = axes[0, 0].get_gridspec()
        for each in axes[0]:
            each.remove()
        motion = [figure.add_subplot(grid[0, :2]), figure.add_subplot(grid[0, 2:])]
    else:
        motion = list(axes[0])
    for each, trace in zip(motion, traces(view, after), strict=True):
        each.plot(view.phase, trace.measured, color="k", lw=1.6, label="measured, smoothed")
        each.plot(view.phase, trace.recalibrated, color=BLUE, lw=1.4, ls="--",
                  label="recalibrated")  # fmt: skip
        if trace.extended is not None:
            each.plot(view.phase, trace.extended, color=VERMILION, lw=1.4, ls=":",
                      label="with the cause")  # fmt: skip
        each.set_xlabel("phase of the drive")
        each.set_ylabel(trace.label)
    motion[0].legend(fontsize=8, frameon=False)
    for frames, (found, found_later, unit, label) in zip(axes[1:], rows, strict=True):
        _row(frames, view, found, found_later, unit, label)
    return png(figure)


def _row(
    axes: Any,
    view: ForceView,
    found: Residual,
    after: Residual | None,
    unit: float,
    label: str,
) -> None:
    """One residual against theta, its rate, contact velocity and phase."""
    variables = (
        (np.degrees(view.theta), "tilt (degrees)"),
        (view.rate, "its rate (rad/s)"),
        (view.contact_velocity * 1e3, "contact velocity (mm/s)"),
        (view.phase, "phase of the drive"),
    )
    for k, (each, (variable, name)) in enumerate(zip(axes, variables, strict=True)):
        each.axhline(0.0, color=DARK_GREY, lw=0.8)
        each.set_xlabel(name)
        each.tick_params(labelsize=8)
        each.locator_params(axis="x", nbins=4)
        if k:
            each.sharey(axes[0])
            each.tick_params(labelleft=False)
        at, value, sd = _well_separated(view, found)
        each.errorbar(variable[at], value * unit, sd * unit, fmt="o", color=BLUE,
                      ecolor=PALE_BLUE, ms=3.5, lw=1.0, label="recalibrated")  # fmt: skip
        if after is not None:
            at, value, _ = _well_separated(view, after)
            each.plot(variable[at], value * unit, "D", color=VERMILION, mfc="none", ms=4,
                      label="with the cause")  # fmt: skip
    axes[0].set_ylabel(label)
    if after is not None:
        axes[3].legend(fontsize=7, frameon=False)


def _well_separated(view: ForceView, found: Residual) -> tuple[NDArray[np.int64], Array, Array]:
    """Places, values and errors, half as far apart as the smoothing tells them apart."""
    step = max(1, len(view.phase) // (4 * view.orders))
    kept = slice(step // 2 % max(len(found.where), 1), None, step)
    return found.where[kept], found.value[kept], found.sd[kept]


def _numbers(view: ForceView, after: ForceView | None) -> dict[str, object]:
    numbers: dict[str, object] = {
        "phases": view.distinct,
        "orders": view.orders,
        "orders_needed": FEWEST_ORDERS,
        "drift_theta": list(view.drift_theta),
        "drift_advance": list(view.drift_advance),
        "onset_ratio": None if view.onset is None else list(view.onset),
    }
    for stage, each in (("recalibrated", view), ("extended", after)):
        if each is None:
            continue
        for name, found in (("sticking", each.sticking), ("slipping", each.slipping)):
            numbers[f"{name}_{stage}"] = (
                None
                if found is None
                else {s.variable: {"value": s.value, "sd": s.sd, "t": s.t} for s in found.slopes}
            )
    return numbers
