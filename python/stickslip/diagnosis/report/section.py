"""Sections of the report: tables of angles and fields, and data of a model of the user's own."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stickslip._util.html_page import svg
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.open_set import OpenSet
from stickslip.diagnosis.observables import Comparison
from stickslip.diagnosis.report import figures
from stickslip.facts import Code, Fact

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

_WEAK = 0.05
"""Share of the strongest field below which a field counts as none. Chosen: the robot hardly tilts
in it."""

_ONE_CURVE = 1e-3
"""Share of the varied component's span: where the other component varies less, the readings are one
curve. Chosen: a component that is held constant is set to a part in a thousand."""


@dataclass(frozen=True)
class ReportSection:
    """A figure, and what there is to say of it.

    Attributes
    ----------
    title : str
    picture : str
        SVG, may be empty.
    lines : tuple of Fact
        What is said below it.
    numbers : dict
        For report.json.
    """

    title: str
    picture: str
    lines: tuple[Fact, ...]
    numbers: Mapping[str, object]


def table_section(found: Comparison) -> ReportSection:
    """The section of a table of angles or of fields."""
    before, after = found.errors
    misfit: dict[str, object] = {"recalibrated": before, "extended": after}
    models = {"recalibrated": found.recalibrated, "extended": found.extended}
    known = {name: row for name, row in models.items() if row is not None}
    if found.kind == "angle":
        picture, reading = _angles(found, known), "theta"
        lines = [Fact(Code.ANGLE_MISFIT, misfit), Fact(Code.ANGLE_MODEL, {})]
        size = np.hypot(found.settings["Bx"], found.settings["Bz"])
        if np.all(size > _WEAK * np.max(size)):
            lines.append(Fact(Code.NO_ANGLE_WITHOUT_FIELD, {"percent": 100.0 * _WEAK}))
    else:
        picture, reading = _fields(found, known), "field"
        misfit["largest"] = float(np.max(np.abs(found.observed)))
        lines = [Fact(Code.FIELD_MISFIT, misfit)]
    numbers: dict[str, object] = {
        **{name: column.tolist() for name, column in found.settings.items()},
        reading: found.observed.tolist(),
        "sd": found.sd.tolist(),
        **{name: None if row is None else row.tolist() for name, row in models.items()},
        "held_out": found.held_out.tolist(),
        "rms_recalibrated": before,
        "rms_extended": after,
    }
    return ReportSection(found.title, svg(picture), tuple(lines), numbers)


def _angles(found: Comparison, models: Mapping[str, Array]) -> Figure:
    """Angles against the component of the field that was varied most."""
    fields = np.stack([found.settings["Bx"], found.settings["Bz"]], axis=1)
    component = int(np.argmax(np.ptp(fields, axis=0)))
    varied, other = fields[:, component], fields[:, 1 - component]
    labels = (f"{('Bx', 'Bz')[component]} (mT)", "theta (degrees)")
    joined = bool(np.ptp(other) <= _ONE_CURVE * np.ptp(varied))
    return figures.against_model(varied * 1e3, found.observed, found.sd, models, found.held_out,
                                 labels, factor=math.degrees(1.0), joined=joined)  # fmt: skip


def _fields(found: Comparison, models: Mapping[str, Array]) -> Figure:
    """All three components, row by row."""
    rows = np.arange(1.0, len(found.observed) + 1)
    labels = ("row, by currents and place", "field (mT)")
    return figures.against_model(rows, found.observed, found.sd, models, found.held_out, labels,
                                 factor=1e3, names=("Bx", "By", "Bz"), joined=False)  # fmt: skip


def free_shape_section(found: OpenSet, shown: bool) -> ReportSection:
    """The section of a law of another shape; its numbers have a key of their own.

    `shown`: the curve stands on the first screen.
    """
    pictures = [figures.law_places(found), *([] if shown else [figures.law_curve(found)])]
    return ReportSection("A law of another shape", "".join(map(svg, pictures)), found.facts(), {})


def model_section(found: Findings, place: Array, labels: tuple[str, str]) -> ReportSection:
    """Data and fitted models of a model of the user's own against the abscissa `place`."""
    m = len(place)
    sd = found.problem.sd[:m].tolist() if found.noise.dof > 0.0 else None
    numbers: dict[str, object] = {
        "place": place.tolist(),
        "observed": found.problem.observed[:m].tolist(),
        "sd": sd,
        **{name: row.tolist() for name, row in figures.fitted_models(found, m).items()},
        "held_out": [] if found.gain is None else found.gain.held_out.tolist(),
    }
    picture = svg(figures.own_model(found, place, labels))
    return ReportSection("Data and models", picture, (), numbers)
