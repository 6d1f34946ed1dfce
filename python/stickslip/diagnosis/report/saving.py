"""The report of a measurement, and that of a model of one's own: what each is made of."""

from __future__ import annotations

from os import PathLike

from numpy.typing import ArrayLike

from stickslip._util.atomic_files import check_folder
from stickslip.diagnosis.inference.experiment_design import Experiment
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.errors import gain_unit
from stickslip.diagnosis.report.html import (
    FILES,
    report_files,
    report_sections,
    write_report,
)
from stickslip.diagnosis.report.json_keys import OwnData
from stickslip.diagnosis.report.plots import abscissa
from stickslip.diagnosis.report.residual_figure import large_figure, own_figure
from stickslip.diagnosis.report.section import (
    ReportSection,
    free_shape_section,
    model_section,
)
from stickslip.measurement.reading import Measurement

Folder = str | PathLike[str]


def save_of_measurement(
    folder: Folder,
    found: Findings,
    posed: PosedProblem,
    measurement: Measurement,
    experiments: list[Experiment],
) -> None:
    """Write the report of a measurement, with a section for each kind of its data."""
    check_folder(folder, report_files(measurement.scenario))  # before what takes long
    comparisons = posed.comparisons(found)
    sections = [*report_sections(comparisons), *_free_shapes(found)]
    large, unit = large_figure(found, posed, comparisons), gain_unit(posed)
    write_report(folder, found, posed, measurement, experiments, sections, unit, large)


def save_of_own_model(
    folder: Folder,
    found: Findings,
    posed: PosedProblem,
    title: str | None,
    place: ArrayLike | None,
    labels: tuple[str, str],
    unit: str,
) -> None:
    """Write the report of a model of one's own; see `Diagnosis.save_report`."""
    check_folder(folder, FILES)
    source = OwnData("Diagnosis" if title is None else title)
    at = abscissa(place, len(found.noise.mean))
    sections = [model_section(found, at, labels), *_free_shapes(found)]
    large = own_figure(found, at, labels)
    write_report(folder, found, posed, source, [], sections, unit, large)


def _free_shapes(found: Findings) -> list[ReportSection]:
    """The section of laws of another shape, where they were looked at."""
    if found.open_set is None:
        return []
    return [free_shape_section(found.open_set, shown=found.free_shape is not None)]
