"""The section of the report that shows a tracked run: what it says of forces, in facts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from stickslip._util.html_page import svg
from stickslip.diagnosis.observables.tracking.film import FilmComparison
from stickslip.diagnosis.observables.tracking.force_residuals import (
    CLEAR,
    FEWEST_ORDERS,
    ForceView,
    Residual,
    Slope,
)
from stickslip.diagnosis.report.film_figure import film_figure
from stickslip.diagnosis.report.section import ReportSection
from stickslip.facts import Code, Fact

_NEARLY = 0.7
"""Share of the clearest t that a constant needs to be named instead, as it is simpler. Chosen: two
t values so near differ by less than their own errors of 1."""


def film_sections(film: FilmComparison, earlier: Sequence[FilmComparison]) -> list[ReportSection]:
    """The section of one run; with the second of two directions, one of their difference."""
    title = f"Tracking of {film.file}"
    view, after = film.view, film.after
    if view is None:
        lines = (Fact(Code.NO_FORCE_VIEW, {}),)
        return [ReportSection(title, "", lines, {"held_out": film.held_out})]
    told = view_lines(view, after)
    if film.advance is not None:
        told.insert(0, Fact(Code.ADVANCE, {"extended": None, **film.advance}))
    numbers = {"held_out": film.held_out, "advance": film.advance, **_numbers(view, after)}
    sections = [ReportSection(title, svg(film_figure(view, after)), tuple(told), numbers)]
    for other in earlier:
        if other.view is not None and _opposite(film, other):
            sections.append(_direction_section(other, film))
    return sections


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


def view_lines(view: ForceView, after: ForceView | None) -> list[Fact]:
    """What one run says of torques, forces and slow changes."""
    lines = []
    if view.orders < FEWEST_ORDERS:
        shown = {"phases": view.distinct, "orders": view.orders, "needed": FEWEST_ORDERS}
        lines.append(Fact(Code.TOO_FEW_PHASES, shown))
    else:
        torque = (Code.TORQUE_NOT_JUDGED, Code.TORQUE_CLEAN, Code.TORQUE_RESIDUAL)
        force = (Code.FORCE_NOT_JUDGED, Code.FORCE_CLEAN, Code.FORCE_RESIDUAL)
        lines.append(_residual(view.sticking, torque, "N m"))
        lines.append(_residual(view.slipping, force, "N"))
        if view.onset is not None:
            measured, sd, model = view.onset
            same = abs(measured - model) < CLEAR * sd
            code = Code.ONSET_SAME if same else Code.ONSET_DIFFERS
            lines.append(Fact(code, {"difference": measured - model, "sd": sd}))
    drifts = ((view.drift_theta, Code.DRIFT_OF_TILT), (view.drift_advance, Code.DRIFT_OF_ADVANCE))
    clear = [
        Fact(code, {"value": value, "sd": sd})
        for (value, sd), code in drifts
        if abs(value) > CLEAR * sd
    ]
    lines += clear or [Fact(Code.NO_DRIFT_OF_PERIODS, {})]
    if after is not None and view.slipping is not None and after.slipping is not None:
        before, now = view.slipping.slopes[0], after.slipping.slopes[0]
        if abs(before.t) > CLEAR or abs(now.t) > CLEAR:
            lines.append(Fact(Code.FORCE_WITH_CAUSE, {"before": before.t, "after": now.t}))
    return lines


def _residual(found: Residual | None, codes: tuple[Code, Code, Code], unit: str) -> Fact:
    """A residual in one of three codes: not judged, none that is clear, or the clearest one."""
    not_judged, clean, clear = codes
    if found is None:
        return Fact(not_judged, {})
    worst, mean = _clearest(found), found.slopes[0]
    size: Mapping[str, object]
    if worst is None:
        # A residual of two standard deviations could be hidden in the noise.
        size = {"value": mean.value, "sd": mean.sd, "hidden": 2.0 * mean.sd / found.scale}
        return Fact(clean, {**size, "unit": unit})
    size = {"value": worst.value, "sd": worst.sd, "t": worst.t}
    return Fact(clear, {"variable": worst.variable, **size, "unit": unit})


def _clearest(found: Residual) -> Slope | None:
    """The clearest departure from zero; a constant, if it is nearly as clear as any."""
    clear = [each for each in found.slopes if abs(each.t) > CLEAR]
    if not clear:
        return None
    best = max(clear, key=lambda each: abs(each.t))
    constant = found.slopes[0]
    return constant if abs(constant.t) > max(CLEAR, _NEARLY * abs(best.t)) else best


def _opposite(one: FilmComparison, other: FilmComparison) -> bool:
    """Whether two runs differ in their direction alone."""
    turned = "+x" if one.scenario.drive.direction == "-x" else "-x"
    return one.scenario.replace({"drive.direction": turned}) == other.scenario


def _direction_section(one: FilmComparison, other: FilmComparison) -> ReportSection:
    """What two opposite runs share, in the world, and what changes its sign with the robot.

    The advances per pulse, m, cancel if nothing is fixed to the world. The mean force residuals
    while slipping, N, are told apart in the same way.
    """
    title = f"{one.file} and {other.file}: forward and reversed"
    if one.advance is None or other.advance is None:
        return ReportSection(title, "", (Fact(Code.DIRECTIONS_TOO_SHORT, {}),), {})
    forward, reverse = one.advance["measured"], other.advance["measured"]
    total, sd = forward + reverse, math.hypot(one.advance["sd"], other.advance["sd"])
    t = total / sd
    code = Code.DIRECTIONS_CANCEL if abs(t) < CLEAR else Code.DIRECTIONS_DIFFER
    lines = [Fact(code, {"forward": forward, "reverse": reverse, "total": total, "t": t})]
    numbers: dict[str, object] = {"advance_sum": total, "advance_sum_sd": sd}
    means = [
        each.view.slipping.slopes[0]
        for each in (one, other)
        if each.view is not None and each.view.slipping is not None
    ]
    if len(means) == 2:
        signs = [each.scenario.drive.facing for each in (one, other)]
        forces = {
            "world": 0.5 * sum(sign * each.value for sign, each in zip(signs, means, strict=True)),
            "robot": 0.5 * sum(each.value for each in means),
            "sd": 0.5 * math.hypot(means[0].sd, means[1].sd),
        }
        lines.append(Fact(Code.FORCES_OF_DIRECTIONS, forces))
        numbers |= {f"force_{name}": value for name, value in forces.items()}
    return ReportSection(title, "", tuple(lines), numbers)
