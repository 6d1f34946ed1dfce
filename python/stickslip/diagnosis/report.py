"""The files that a diagnosis leaves behind: report.html, report.json and extended.toml."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.cli.json_text import json_text
from stickslip.diagnosis.channels import Sketch
from stickslip.diagnosis.engine import Diagnosis
from stickslip.diagnosis.experiments import Experiment
from stickslip.diagnosis.simulator import Examination
from stickslip.diagnosis.summary import details, further, gain_unit, summary
from stickslip.errors import ScenarioError
from stickslip.files import replacing
from stickslip.keys import Value, known_keys
from stickslip.measurement.reading import Measurement
from stickslip.scenario import Scenario
from stickslip.scenario_file import write_scenario


def extended_scenario(found: Diagnosis, scenario: Scenario) -> Scenario:
    """The scenario with recalibrated constants and, where there is one, the cause.

    Of data that allows no diagnosis nothing is learnt, so the scenario stays as it is.
    """
    if found.verdict.word == "data-problem":
        return scenario
    fit = found.verdict.fit or found.null
    values = found.problem.physical(fit.x[None, :])[0]
    problem = found.problem
    keys = known_keys()
    changes = {
        each.name: float(values[k]) for k, each in enumerate(problem.uncertain) if each.name in keys
    }
    for k in fit.rival.free[problem.base_count :]:
        changes[problem.parameters[k - problem.base_count].name] = float(values[k])
    try:
        return scenario.replace(changes)
    except ScenarioError as error:
        raise ScenarioError(f"the extended model makes no scenario: {error}") from None


def write_report(
    out: Path,
    examination: Examination,
    measurement: Measurement,
    experiments: Sequence[Experiment],
) -> None:
    """Write report.html, report.json and extended.toml into the folder `out`, which is made.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    out.mkdir(parents=True, exist_ok=True)
    found, conditions = examination.found, examination.conditions
    sketches = examination.sketches()
    short = summary(found, measurement, experiments)
    full = {**short, **details(found, measurement, conditions)}
    full["channels"] = {each.title: each.numbers for each in sketches}
    full["gain_unit"] = gain_unit(examination)
    full |= further(examination)
    with replacing(out / "report.json") as temporary:
        temporary.write_text(json_text(full) + "\n", encoding="utf-8")
    with replacing(out / "report.html") as temporary:
        temporary.write_text(page_text(found, full, sketches, conditions), encoding="utf-8")
    write_scenario(extended_scenario(found, measurement.scenario), out / "extended.toml")


def _varied(conditions: Sequence[Mapping[str, Value]]) -> list[str]:
    """Bare names of the settings that are not the same in all conditions."""
    if not conditions:
        return []
    return [
        key.split(".")[1]
        for key in conditions[0]
        if len({each.get(key) for each in conditions}) > 1
    ]


def changes(drive: Mapping[str, Value], conditions: Sequence[Mapping[str, Value]]) -> str:
    """The settings of a proposed experiment that not all conditions have."""
    first = conditions[0]
    varied = _varied(conditions)
    said = [
        f"{key} = {value}"
        for key, value in drive.items()
        if key in varied or first.get(f"drive.{key}") != value
    ]
    return ", ".join(said)


def _typical_error(found: Diagnosis) -> str:
    """Noise of one trial at the median velocity."""
    if found.noise.dof == 0.0:
        return "not known"
    level = float(np.median(np.abs(found.noise.mean)))
    sd = float(np.hypot(found.noise.floor, found.noise.relative * level))
    return f"{sd * 1e3:.3g} mm/s at {level * 1e3:.3g} mm/s"


def page_text(
    found: Diagnosis,
    full: Mapping[str, Any],
    sketches: Sequence[Sketch],
    conditions: Sequence[Mapping[str, Value]],
) -> str:
    """The report as one page that needs no other file."""
    import jinja2

    from stickslip.diagnosis import figures

    source = resources.files("stickslip.diagnosis").joinpath("page.html").read_text("utf-8")
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    keys, varied = known_keys(), _varied(conditions)
    return environment.from_string(source).render(
        report=full,
        meanings={each.name: each.meaning for each in found.problem.causes},
        units={name: keys[name].unit for name in keys},
        shown={"m/s": ("mm/s", 1e3), "rad": ("degrees", math.degrees(1.0)), "T": ("mT", 1e3)}.get(
            full["gain_unit"], ("SI units", 1.0)
        ),
        curves=figures.velocities(found, conditions),
        profiles=[figures.profile(each) for each in found.profiles],
        varied=varied,
        drive_keys=[key.split(".")[1] for key in conditions[0]] if conditions else [],
        changes=[changes(each["drive"], conditions) for each in full["next_experiments"]],
        typical=_typical_error(found),
        sketches=sketches,
        ranking=figures.ranking(found),
        isolability=figures.isolability(found),
    )
