"""The parts of the report that show tables of angles and fields, and films."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.observables import Comparison
from stickslip.diagnosis.observables.tracking.comparison import FilmComparison
from stickslip.diagnosis.report.figures import against_model, png
from stickslip.diagnosis.report.film_section import film_sections
from stickslip.diagnosis.report.section import ReportSection
from stickslip.facts import Code, Fact

Array = NDArray[np.float64]

_WEAK = 0.05
"""Of the strongest field: a weaker one counts as none. Chosen: the robot hardly tilts in it."""

_ONE_CURVE = 1e-3
"""Of the varied component: where the other varies less the readings are one curve. Chosen."""


def report_sections(comparisons: Sequence[Comparison | FilmComparison]) -> list[ReportSection]:
    """Parts of the report, in the order of what was compared."""
    sections: list[ReportSection] = []
    films: list[FilmComparison] = []
    for each in comparisons:
        if isinstance(each, FilmComparison):
            sections += film_sections(each, films)
            films.append(each)
        else:
            sections.append({"angle": _angle_section, "field": _field_section}[each.kind](each))
    return sections


def _missed(found: Comparison) -> dict[str, float | None]:
    """What both models miss, as fields of a fact."""
    return dict(zip(("recalibrated", "extended"), found.errors, strict=True))


def _numbers(found: Comparison, reading: str) -> dict[str, object]:
    before, after = found.errors
    return {
        **{name: column.tolist() for name, column in found.settings.items()},
        reading: found.observed.tolist(),
        "sd": found.sd.tolist(),
        "recalibrated": found.recalibrated.tolist(),
        "extended": None if found.extended is None else found.extended.tolist(),
        "held_out": found.held_out.tolist(),
        "rms_recalibrated": before,
        "rms_extended": after,
    }


def _angle_section(found: Comparison) -> ReportSection:
    """Angles against the component of the field that was varied most."""
    fields = np.stack([found.settings["Bx"], found.settings["Bz"]], axis=1)
    component = int(np.argmax(np.ptp(fields, axis=0)))
    varied, other = fields[:, component], fields[:, 1 - component]
    order = np.argsort(varied, kind="stable")
    picture = against_model(
        varied[order] * 1e3,
        np.degrees(found.observed[order]),
        np.degrees(found.sd[order]),
        np.degrees(found.recalibrated[order]),
        None if found.extended is None else np.degrees(found.extended[order]),
        found.held_out[order],
        (f"{('Bx', 'Bz')[component]} (mT)", "theta (degrees)"),
        joined=bool(np.ptp(other) <= _ONE_CURVE * np.ptp(varied)),
    )
    lines = [Fact(Code.ANGLE_MISFIT, _missed(found)), Fact(Code.ANGLE_MODEL, {})]
    size = np.hypot(*fields.T)
    if np.all(size > _WEAK * np.max(size)):
        lines.append(Fact(Code.NO_ANGLE_WITHOUT_FIELD, {"percent": 100.0 * _WEAK}))
    return ReportSection(found.title, png(picture), tuple(lines), _numbers(found, "theta"))


def _field_section(found: Comparison) -> ReportSection:
    """All three components, row by row."""
    picture = against_model(
        np.arange(1, len(found.observed) + 1, dtype=float),
        found.observed * 1e3,
        found.sd * 1e3,
        found.recalibrated * 1e3,
        None if found.extended is None else found.extended * 1e3,
        found.held_out,
        ("row, by currents and place", "field (mT)"),
        ("Bx", "By", "Bz"),
        joined=False,
    )
    largest = float(np.max(np.abs(found.observed)))
    line = Fact(Code.FIELD_MISFIT, {**_missed(found), "largest": largest})
    return ReportSection(found.title, png(picture), (line,), _numbers(found, "field"))
