"""The section of the report that shows a film: its advance, what drifts, and its motion."""

from __future__ import annotations

import math
from collections.abc import Sequence

from stickslip._util.html_page import svg
from stickslip.diagnosis.observables.tracking.film import FilmComparison
from stickslip.diagnosis.observables.tracking.smoothed_motion import SmoothedMotion
from stickslip.diagnosis.report.film_figure import film_figure
from stickslip.diagnosis.report.section import ReportSection
from stickslip.facts import Code, Fact

CLEAR = 3.5
"""A number differs from zero beyond so many standard deviations. Chosen: of three true zeros one in
700 films does."""


def film_sections(film: FilmComparison, earlier: Sequence[FilmComparison]) -> list[ReportSection]:
    """The section of one run; with the second of two directions, one of their difference."""
    title, seen = f"Tracking of {film.file}", film.recalibrated
    if seen is None:
        lines = (Fact(Code.NO_SMOOTHED_MOTION, {}),)
        return [ReportSection(title, "", lines, {"held_out": film.held_out})]
    told = drift_lines(seen)
    if film.advance is not None:
        told.insert(0, Fact(Code.ADVANCE, {"extended": None, **film.advance}))
    numbers = {
        "held_out": film.held_out,
        "advance": film.advance,
        "orders": seen.orders,
        "drift_theta": list(seen.drift_theta),
        "drift_advance": list(seen.drift_advance),
    }
    sections = [ReportSection(title, svg(film_figure(seen, film.extended)), tuple(told), numbers)]
    for other in earlier:
        if other.recalibrated is not None and _opposite(film, other):
            sections.append(_direction_section(other, film))
    return sections


def drift_lines(seen: SmoothedMotion) -> list[Fact]:
    """What changes from period to period beyond the simulation."""
    drifts = ((seen.drift_theta, Code.DRIFT_OF_TILT), (seen.drift_advance, Code.DRIFT_OF_ADVANCE))
    clear = [
        Fact(code, {"value": value, "sd": sd})
        for (value, sd), code in drifts
        if abs(value) > CLEAR * sd
    ]
    return clear or [Fact(Code.NO_DRIFT_OF_PERIODS, {})]


def _opposite(one: FilmComparison, other: FilmComparison) -> bool:
    """Whether two runs differ in their direction alone."""
    turned = "+x" if one.scenario.drive.direction == "-x" else "-x"
    return one.scenario.replace({"drive.direction": turned}) == other.scenario


def _direction_section(one: FilmComparison, other: FilmComparison) -> ReportSection:
    """The advances per pulse of two opposite runs, m, cancel if nothing is fixed to the world."""
    title = f"{one.file} and {other.file}: forward and reversed"
    if one.advance is None or other.advance is None:
        return ReportSection(title, "", (Fact(Code.DIRECTIONS_TOO_SHORT, {}),), {})
    forward, reverse = one.advance["measured"], other.advance["measured"]
    total, sd = forward + reverse, math.hypot(one.advance["sd"], other.advance["sd"])
    t = total / sd
    code = Code.DIRECTIONS_CANCEL if abs(t) < CLEAR else Code.DIRECTIONS_DIFFER
    line = Fact(code, {"forward": forward, "reverse": reverse, "total": total, "t": t})
    return ReportSection(title, "", (line,), {"advance_sum": total, "advance_sum_sd": sd})
