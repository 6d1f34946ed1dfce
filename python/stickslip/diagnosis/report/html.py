"""The files of a diagnosis: report.html, report.json, and of a measurement extended.toml.

Beside extended.toml are the voltages and the map of a scenario that has them.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from stickslip._util.atomic_files import text_writer, write_together
from stickslip._util.strict_json import json_text
from stickslip.diagnosis.inference.experiment_design import Experiment
from stickslip.diagnosis.inference.extended_model import extended_scenario
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.observables import Comparison
from stickslip.diagnosis.observables.tracking.film import FilmComparison
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report import provenance
from stickslip.diagnosis.report.differences import LargeFigure
from stickslip.diagnosis.report.film_section import film_sections
from stickslip.diagnosis.report.json_keys import OwnData, report_numbers
from stickslip.diagnosis.report.page import page
from stickslip.diagnosis.report.section import ReportSection, table_section
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.toml_file import files_beside, scenario_writers

PAGE, JSON, EXTENDED = FILES = "report.html", "report.json", "extended.toml"
"""Names of what a report consists of."""


def report_files(scenario: Scenario) -> tuple[str, ...]:
    """Names of the files of a report of a measurement with this scenario."""
    voltages, field_map = files_beside(Path(EXTENDED))
    held = {voltages.name: scenario.drive.program, field_map.name: scenario.coil.map}
    return (*FILES, *(name for name, value in held.items() if value is not None))


def write_report(
    out: str | PathLike[str],
    found: Findings,
    posed: PosedProblem,
    source: Measurement | OwnData,
    experiments: Sequence[Experiment],
    sections: Sequence[ReportSection],
    unit: str,
    large: LargeFigure | None,
) -> None:
    """Write all files into the folder `out`, which is made, or none.

    `unit` is that of what is held out, and `large` the page's large figure.
    """
    numbers = report_numbers(found, posed, source, experiments, sections, unit)
    origin = provenance.origin(source, found.seed)
    text = page(found, posed, numbers, sections, experiments, large, origin)
    folder = Path(out)
    writers = {
        folder / JSON: text_writer(json_text(numbers) + "\n"),
        folder / PAGE: text_writer(text),
    }
    if isinstance(source, Measurement):
        extended = extended_scenario(found, source.scenario)
        lines = [*_origin(found, source, extended), *_drive(posed, source.scenario)]
        writers |= scenario_writers(extended, folder / EXTENDED, lines)[1]
    folder.mkdir(parents=True, exist_ok=True)
    write_together(writers)


def report_sections(comparisons: Sequence[Comparison | FilmComparison]) -> list[ReportSection]:
    """Sections for tables of angles and fields, and films, in the order of what was compared."""
    sections: list[ReportSection] = []
    films: list[FilmComparison] = []
    for each in comparisons:
        if isinstance(each, FilmComparison):
            sections += film_sections(each, films)
            films.append(each)
        else:
            sections.append(table_section(each))
    return sections


def _origin(found: Findings, measurement: Measurement, extended: Scenario) -> list[str]:
    """Where an extended scenario is from, and what it has changed."""
    lines = [f"stickslip diagnose {measurement.path.name}: {found.verdict.kind}"]
    if found.verdict.causes:
        lines[0] += " " + ", ".join(found.verdict.causes)
    if found.free_shape is not None:
        lines.append(f"here: {found.free_shape.term.name} as a curve of free shape")
    if found.verdict.fit is not None and found.verdict.kind == "ambiguous":
        lines.append(
            f"here: {found.verdict.fit.name}, which leads among those that explain the data"
        )
    changed = [
        f"{key}: {measurement.scenario.get(key):.6g} -> {extended.get(key):.6g}"
        for key, known in known_keys().items()
        if known.kind == "real" and extended.get(key) != measurement.scenario.get(key)
    ]
    return [*lines, *(changed or ["nothing is changed"])]


def _drive(posed: PosedProblem, scenario: Scenario) -> list[str]:
    """What the drive of an extended scenario is, which measurements do not change."""
    conditions = posed.conditions
    if not conditions:
        return ["[drive] is that of the scenario as it was given"]
    differs = [
        key.removeprefix("drive.")
        for key in conditions[0]
        if any(each[key] != scenario.get(key) for each in conditions)
    ]
    if not differs:
        return ["[drive] is that of the scenario as it was given, with which all was measured"]
    return [
        "[drive] is that of the scenario as it was given, and the measurements set "
        f"{', '.join(differs)}:",
        "change these lines to simulate one of the conditions that were measured",
    ]
