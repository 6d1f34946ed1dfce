"""The files of a diagnosis: report.html, report.json, and of a measurement extended.toml."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from stickslip._util.atomic_files import text_writer, write_together
from stickslip._util.html_page import page_text, png
from stickslip._util.strict_json import json_text
from stickslip.diagnosis.data.conditions import changes, heading, in_words, shown_value, varied
from stickslip.diagnosis.fit.goodness import ADEQUATE
from stickslip.diagnosis.inference.cross_validation import INTERVAL
from stickslip.diagnosis.inference.detection import ALPHA
from stickslip.diagnosis.inference.evidence import unseen_causes
from stickslip.diagnosis.inference.experiment_design import Experiment, undecided
from stickslip.diagnosis.inference.extended_model import extended_scenario
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.probabilities import PRIOR_NONE, PRIOR_UNKNOWN
from stickslip.diagnosis.inference.ranking import runner_up, set_members
from stickslip.diagnosis.inference.upper_bounds import BOUND, POWER
from stickslip.diagnosis.inference.verdict import LEAST_SHARE, MARGIN
from stickslip.diagnosis.observables import Comparison
from stickslip.diagnosis.observables.tracking.film import FilmComparison, FilmObservable
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report import figures
from stickslip.diagnosis.report.film_section import film_sections
from stickslip.diagnosis.report.json_keys import OwnData, report_numbers
from stickslip.diagnosis.report.parameters import short
from stickslip.diagnosis.report.section import ReportSection, table_section
from stickslip.diagnosis.report.words import used_in
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.toml_file import scenario_writers

PAGE, JSON, EXTENDED = FILES = "report.html", "report.json", "extended.toml"
"""Names of what a report consists of."""

_SHOWN = {
    "m/s": ("mm/s", 1e3),
    "rad": ("degrees", math.degrees(1.0)),
    "T": ("mT", 1e3),
    # Readings of several units have no mean error.
    "SI": None,
}

_LIMITS = {
    "adequate": ADEQUATE,
    "alpha": ALPHA,
    "bound": BOUND,
    "interval": INTERVAL,
    "margin": MARGIN,
    "odds": math.exp(MARGIN),
    "power": POWER,
    "prior_none": PRIOR_NONE,
    "prior_unknown": PRIOR_UNKNOWN,
    "share": LEAST_SHARE,
}
"""Limits that the page explains."""


def write_report(
    out: str | PathLike[str],
    found: Findings,
    posed: PosedProblem,
    source: Measurement | OwnData,
    experiments: Sequence[Experiment],
    sections: Sequence[ReportSection],
    unit: str,
) -> None:
    """Write all files into the folder `out`, which is made, or none.

    `unit` is that of what is held out.
    """
    numbers = report_numbers(found, posed, source, experiments, sections, unit)
    page = _page(found, posed, numbers, sections, experiments)
    folder = Path(out)
    writers = {
        folder / JSON: text_writer(json_text(numbers) + "\n"),
        folder / PAGE: text_writer(page),
    }
    if isinstance(source, Measurement):
        extended = extended_scenario(found, source.scenario)
        origin = _origin(found, source, extended)
        writers |= scenario_writers(extended, folder / EXTENDED, origin)[1]
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
        lines.append(f"here: {found.free_shape.hook.name} as a curve of free shape")
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


def _page(
    found: Findings,
    posed: PosedProblem,
    full: Mapping[str, Any],
    sections: Sequence[ReportSection],
    experiments: Sequence[Experiment],
) -> str:
    """The report as one page that needs no other file."""
    conditions, causes = posed.conditions, found.problem.causes
    first, among = conditions[0] if conditions else {}, varied(conditions)
    reasons = [*found.verdict.reasons, runner_up(found)]
    known = known_keys() if posed.simulator is not None else {}
    films = any(isinstance(each, FilmObservable) for each in posed.model.observables)
    page = partial(
        page_text,
        "diagnosis/report/page.html",
        report=full,
        meanings={each.name: each.meaning for each in causes},
        key_meanings={short(name): each.meaning for name, each in known.items()},
        unseen=unseen_causes(found),
        films_held_out=films and not conditions,
        units={short(each.name): each.unit for each in found.problem.parameters},
        downward={short(each.name) for each in found.problem.parameters if each.downward},
        shown=_SHOWN.get(full["gain_unit"], (full["gain_unit"], 1.0)),
        simulated=posed.simulator is not None,
        held="readings" if posed.model.observables and not conditions else "conditions",
        curves=png(figures.velocities(found, conditions, posed.given)),
        profiles=[png(figures.profile(each)) for each in found.profiles],
        columns=[heading(key) for key in among],
        settings=[[shown_value(key, each[key]) for key in among] for each in conditions],
        common=in_words(first, [key for key in known_keys() if key in first and key not in among]),
        members=set_members(found),
        changes=[changes(each["drive"], conditions) for each in full["next_experiments"]],
        undecided=undecided(experiments),
        by_evidence=any(each is not None and "lead" in each.fields for each in reasons),
        limits=_LIMITS,
        observables=len(found.problem.observed),
        extended=found.extended is not None,
        typical=_typical_error(found),
        report_sections=sections,
        ranking=png(figures.ranking(found)),
        distinguishability=png(figures.distinguishability(found)) if causes else "",
    )
    # What is used can only be seen on the page; a page without a model explains nothing.
    return page(words=used_in(page(words=())) if found.verdict.kind != "data-problem" else ())


def _typical_error(found: Findings) -> str:
    """Noise of one trial at the median velocity."""
    if found.noise.dof == 0.0:
        return "not known"
    level = float(np.median(np.abs(found.noise.mean)))
    sd = float(np.hypot(found.noise.floor, found.noise.relative * level))
    return f"{sd * 1e3:.3g} mm/s at {level * 1e3:.3g} mm/s"
