"""The report of a diagnosis with a model of the user's own."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report import figures
from stickslip.diagnosis.report.html import report_texts, write_files
from stickslip.diagnosis.report.section import ReportSection
from stickslip.facts import Fact

Array = NDArray[np.float64]


@dataclass(frozen=True)
class OwnData:
    """Where data of a model of the user's own are from, as far as a report says it."""

    name: str
    left_out: tuple[Fact, ...] = ()


def write_model_report(
    out: str | PathLike[str],
    found: Findings,
    posed: PosedProblem,
    title: str,
    place: Array,
    labels: tuple[str, str],
    unit: str,
) -> None:
    """Write report.html and report.json of a `diagnose_model` into the folder `out`, which is made.

    Parameters
    ----------
    out : str or path-like
    found : Findings
    posed : PosedProblem
    title : str
    place : ndarray, shape (m,)
        Abscissa of each condition in the figure.
    labels : tuple of str
        Of abscissa and ordinate, with units.
    unit : str
        Of the observable, for its mean error.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    section = _report_section(found, place, labels)
    write_files(out, report_texts(found, posed, OwnData(title), [], [section], unit))


def _report_section(found: Findings, place: Array, labels: tuple[str, str]) -> ReportSection:
    m = len(place)
    sd = found.problem.sd[:m] if found.noise.dof > 0.0 else None
    numbers: dict[str, object] = {
        "place": place.tolist(),
        "observed": found.problem.observed[:m].tolist(),
        "sd": None if sd is None else sd.tolist(),
        **{name: row.tolist() for name, row in figures.own_models(found, m).items()},
        "held_out": [] if found.gain is None else found.gain.held_out.tolist(),
    }
    picture = figures.png(figures.own_model(found, place, labels))
    return ReportSection("Data and models", picture, (), numbers)
