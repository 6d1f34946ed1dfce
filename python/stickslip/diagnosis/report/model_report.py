"""The report of a diagnosis with a model of the user's own."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.diagnosis.api import Examination
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.observables import ReportSection
from stickslip.diagnosis.observables.combined import Combined
from stickslip.diagnosis.report import figures
from stickslip.diagnosis.report.html import report_texts, write_files
from stickslip.errors import ScenarioError
from stickslip.facts import Fact

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Own:
    name: str
    left_out: tuple[Fact, ...] = ()


def write_model_report(
    out: str | PathLike[str],
    found: Findings,
    title: str,
    *,
    place: ArrayLike | None = None,
    labels: tuple[str, str] = ("condition", "observable"),
    unit: str = "SI",
) -> None:
    """Write report.html and report.json of a `diagnose_model` into the folder `out`, which is made.

    Parameters
    ----------
    out : str or path-like
    found : Findings
    title : str
    place : array_like, shape (m,), optional
        Abscissa of each condition in the figure; its number, if not given.
    labels : tuple of str
        Of abscissa and ordinate, with units.
    unit : str
        Of the observable, for its mean error.

    Raises
    ------
    ScenarioError
        If `place` has another length or is not finite.
    OSError
        If a file cannot be written.
    """
    m = len(found.noise.mean)
    at = np.arange(1.0, m + 1.0) if place is None else np.asarray(place, dtype=float)
    if at.shape != (m,) or not np.all(np.isfinite(at)):
        raise ScenarioError(f"place: allowed is a finite number for each of {m} conditions")
    problem = found.problem
    names = [each.name for each in problem.uncertain] + [each.name for each in problem.parameters]
    model = Combined(problem.predict, names, names, ())
    examination = Examination(found, None, [], model, (), np.zeros(0))
    write_files(
        out, report_texts(examination, _Own(title), [], [_report_section(found, at, labels)], unit)
    )


def _report_section(found: Findings, place: Array, labels: tuple[str, str]) -> ReportSection:
    """Data and models; no model where nothing was learnt, and no error where none is known."""
    problem, fit, m = found.problem, found.verdict.fit, len(place)
    observed = problem.observed[:m]
    sd = problem.sd[:m] if found.noise.dof > 0.0 else None
    points = {} if found.verdict.word == "data-problem" else {"recalibrated": found.null.x}
    if fit is not None:
        points["extended"] = fit.x
    models = {name: problem.predicted(x[None, :])[0, :m] for name, x in points.items()}
    order = np.argsort(place, kind="stable")
    if sd is None or not models:
        picture = figures.readings(
            place[order], observed[order], None if sd is None else sd[order], labels
        )
    else:
        extended = models.get("extended")
        picture = figures.against_model(
            place[order],
            observed[order],
            sd[order],
            models["recalibrated"][order],
            None if extended is None else extended[order],
            found.held_out[:m][order],
            labels,
            joined=False,
        )
    numbers: dict[str, object] = {
        "place": place.tolist(),
        "observed": observed.tolist(),
        "sd": None if sd is None else sd.tolist(),
        **{name: row.tolist() for name, row in models.items()},
        "held_out": [] if found.gain is None else found.gain.held_out.tolist(),
    }
    return ReportSection("Data and models", picture, (), numbers)
