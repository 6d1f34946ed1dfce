"""The report of a diagnosis with a model of the user's own."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike

from stickslip.diagnosis.channels import Sketch
from stickslip.diagnosis.channels.combined import Combined
from stickslip.diagnosis.engine import Diagnosis
from stickslip.diagnosis.examination import Examination
from stickslip.diagnosis.report import report_texts, write_texts
from stickslip.errors import ScenarioError


@dataclass(frozen=True)
class _Own:
    name: str
    left_out: tuple[str, ...] = ()


def write_model_report(
    out: str | PathLike[str],
    found: Diagnosis,
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
    found : Diagnosis
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
    problem = found.problem
    m = len(problem.observed)
    at = np.arange(1.0, m + 1.0) if place is None else np.asarray(place, dtype=float)
    if at.shape != (m,) or not np.all(np.isfinite(at)):
        raise ScenarioError(f"place: allowed is a finite number for each of {m} conditions")
    names = [
        *(each.name for each in problem.uncertain),
        *(each.name for each in problem.parameters),
    ]
    model = Combined(problem.predict, names, names, ())
    examination = Examination(found, None, [], model, (), np.zeros(0))
    sketch = Sketch("Data and models", _figure(found, at, labels), (), {})
    write_texts(out, report_texts(examination, _Own(title), [], [sketch], unit))


def _figure(found: Diagnosis, place: np.ndarray, labels: tuple[str, str]) -> str:
    from stickslip.diagnosis import figures

    problem, fit = found.problem, found.verdict.fit
    points = [found.null.x] if fit is None else [found.null.x, fit.x]
    predicted = problem.predicted(np.stack(points))
    order = np.argsort(place, kind="stable")
    return figures.against_model(
        place[order],
        problem.observed[order],
        problem.sd[order],
        predicted[0][order],
        predicted[1][order] if len(predicted) > 1 else None,
        labels,
        joined=False,
    )
