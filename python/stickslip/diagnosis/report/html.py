"""The files that a diagnosis of a measurement leaves: report.html, report.json, extended.toml."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from stickslip._util.atomic_files import text_writer, write_together
from stickslip._util.plain_text import printable_lines
from stickslip._util.strict_json import json_text
from stickslip.diagnosis.data.conditions import changes, heading, in_words, shown_value, varied
from stickslip.diagnosis.fit.goodness import ADEQUATE
from stickslip.diagnosis.inference.cross_validation import INTERVAL
from stickslip.diagnosis.inference.detection import ALPHA
from stickslip.diagnosis.inference.experiment_design import Experiment, undecided
from stickslip.diagnosis.inference.extended_model import extended_scenario
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.probabilities import PRIOR_NONE, PRIOR_UNKNOWN
from stickslip.diagnosis.inference.ranking import runner_up, set_members
from stickslip.diagnosis.inference.upper_bounds import BOUND, POWER
from stickslip.diagnosis.inference.verdict import LEAST_SHARE, MARGIN
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.json_keys import Source, details, facts, further, gain_unit, summary
from stickslip.diagnosis.report.observable_sections import report_sections
from stickslip.diagnosis.report.parameters import short
from stickslip.diagnosis.report.section import ReportSection
from stickslip.facts import Fact
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
    measurement: Measurement,
    experiments: Sequence[Experiment],
) -> None:
    """Write report.html, report.json and extended.toml into the folder `out`, which is made.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    sections = report_sections(posed.comparisons(found))
    # All three are made before the first is written.
    texts = report_texts(found, posed, measurement, experiments, sections, gain_unit(posed))
    extended = extended_scenario(found, measurement.scenario)
    origin = _origin(found, measurement, extended)
    write_files(out, texts, scenario_writers(extended, Path(out) / EXTENDED, origin)[1])


def report_texts(
    found: Findings,
    posed: PosedProblem,
    source: Source,
    experiments: Sequence[Experiment],
    sections: Sequence[ReportSection],
    unit: str,
) -> dict[str, str]:
    """Contents of report.json and report.html; `unit` is that of the held-out observables."""
    full = {**summary(found, posed, source, experiments), **details(found, posed, source, unit)}
    full["channels"] = {each.title: each.numbers for each in sections}
    full["gain_unit"] = unit
    more = further(found, posed)
    told = facts(found, [*source.left_out, *posed.left_out], experiments, sections)
    full |= {**more, "facts": {**told, **more["facts"]}}
    page = page_text(found, posed, full, sections, experiments)
    return {JSON: json_text(full) + "\n", PAGE: page}


def write_files(
    out: str | PathLike[str],
    texts: Mapping[str, str],
    others: Mapping[Path, Callable[[Path], object]] | None = None,
) -> None:
    """Write files of one age into the folder `out`, which is made: texts by name, and others."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    texts_by_path = {folder / name: text_writer(text) for name, text in texts.items()}
    write_together({**texts_by_path, **(others or {})})


def _origin(found: Findings, measurement: Measurement, extended: Scenario) -> list[str]:
    """Where an extended scenario is from, and what it has changed."""
    lines = [f"stickslip diagnose {measurement.path.name}: {found.verdict.kind}"]
    if found.verdict.causes:
        lines[0] += " " + ", ".join(found.verdict.causes)
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


def _leading(ranking: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Rows of the leading candidates and of no cause, as the verdict weighs them."""
    rows = [row for row in ranking if row["leading"]]
    return sorted(rows, key=lambda row: -row["priced_evidence"]) if len(ranking) > 1 else []


def _weighed(found: Findings) -> list[Fact]:
    second = runner_up(found)
    return [*found.verdict.reasons, *([] if second is None else [second])]


def _typical_error(found: Findings) -> str:
    """Noise of one trial at the median velocity."""
    if found.noise.dof == 0.0:
        return "not known"
    level = float(np.median(np.abs(found.noise.mean)))
    sd = float(np.hypot(found.noise.floor, found.noise.relative * level))
    return f"{sd * 1e3:.3g} mm/s at {level * 1e3:.3g} mm/s"


def page_text(
    found: Findings,
    posed: PosedProblem,
    full: Mapping[str, Any],
    sections: Sequence[ReportSection],
    experiments: Sequence[Experiment],
) -> str:
    """The report as one page that needs no other file."""
    import jinja2

    from stickslip.diagnosis.report import figures

    source = resources.files("stickslip.diagnosis.report").joinpath("page.html").read_text("utf-8")
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=lambda each: printable_lines(each) if isinstance(each, str) else each,
    )
    conditions = posed.conditions
    nothing = found.verdict.kind == "data-problem"
    keys, among = known_keys(), varied(conditions)
    return environment.from_string(source).render(
        report=full,
        meanings={each.name: each.meaning for each in found.problem.causes},
        units={short(each.name): each.unit for each in found.problem.parameters},
        downward={short(each.name) for each in found.problem.parameters if each.downward},
        shown=_SHOWN.get(full["gain_unit"], (full["gain_unit"], 1.0)),
        simulated=posed.simulator is not None,
        held="readings" if posed.model.observables and not conditions else "conditions",
        curves=figures.png(figures.velocities(found, conditions, posed.given)),
        profiles=[figures.png(figures.profile(each)) for each in found.profiles],
        columns=[heading(key) for key in among],
        settings=[[shown_value(key, each[key]) for key in among] for each in conditions],
        common=in_words(
            conditions[0], [key for key in keys if key in conditions[0] and key not in among]
        )
        if conditions
        else "",
        candidates=_leading(full["ranking"]),
        members=set_members(found),
        changes=[changes(each["drive"], conditions) for each in full["next_experiments"]],
        undecided=undecided(experiments),
        by_evidence=any("lead" in each.fields for each in _weighed(found)),
        limits=_LIMITS,
        observables=len(found.problem.observed),
        models=["velocity", "sd", "given", *([] if nothing else ["recalibrated", "extended"])],
        typical=_typical_error(found),
        report_sections=sections,
        ranking=figures.png(figures.ranking(found)),
        distinguishability=figures.png(figures.distinguishability(found))
        if found.problem.causes
        else "",
    )
