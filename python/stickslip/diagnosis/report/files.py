"""The files of a report: report.html, report.json, and of a measurement extended.toml.

Beside extended.toml are the voltages and the map of a scenario that has them.
"""

from __future__ import annotations

import platform
import re
import shlex
import sys
from collections.abc import Mapping, Sequence
from datetime import datetime
from os import PathLike
from pathlib import Path
from typing import Any

import numpy
import scipy
from markupsafe import Markup
from matplotlib.figure import Figure

from stickslip import _core
from stickslip._util.files import check_folder, sha256_of, text_writer, write_together
from stickslip._util.html import page_text, svg
from stickslip._util.palette import BLUE, DARK_GREY, VERMILION
from stickslip._util.text import json_text
from stickslip.diagnosis.decision.experiments import changed_settings
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.decision.posterior import SURE
from stickslip.diagnosis.decision.test import ADEQUATE
from stickslip.diagnosis.decision.verdict import DOMINANT
from stickslip.diagnosis.report.numbers import numbers_of
from stickslip.diagnosis.report.pictures import Plots, drawing
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.words import Words
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import is_of_one_coil, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.toml_file import (
    files_beside,
    held_writers,
    scenario_writers,
)

PAGE, JSON, EXTENDED = "report.html", "report.json", "extended.toml"


def report_files(scenario: Scenario | None) -> tuple[str, ...]:
    """Names of the files of a report; of a model of one's own there is no scenario."""
    if scenario is None:
        return PAGE, JSON
    held = held_writers(scenario.content, files_beside(Path(EXTENDED)))
    return (PAGE, JSON, EXTENDED, *(path.name for path in held))


def save(facts: Facts, out: str | PathLike[str], title: str | None) -> None:
    """Write all files into the folder `out`, which is made, or none; see `save_report`."""
    source, folder = facts.measurement, Path(out)
    check_folder(out, report_files(None if source is None else source.scenario))
    numbers = numbers_of(facts, title)
    numbers["origin"] = _origin(facts)
    writers = {
        folder / JSON: text_writer(json_text(numbers) + "\n"),
        folder / PAGE: text_writer(page(numbers, figures_of(facts))),
    }
    if source is not None:
        extended = facts.extended
        assert isinstance(extended, Scenario)
        lines = _comments(facts, source, extended)
        writers |= scenario_writers(extended.content, folder / EXTENDED, lines)[1]
    folder.mkdir(parents=True, exist_ok=True)
    write_together(writers)


def figures_of(facts: Facts) -> dict[str, Any]:
    """What a page shows beside its numbers: `change`, a `fit` of each channel, and a `law`."""
    plots, problem = Plots(facts), facts.problem
    drawable = facts.fitted and any(table.drawable for table in problem.tables)
    return {
        "change": _svg(plots.residuals() if drawable else None),
        "fit": {name: _svg(plots.fit(k)) for k, name in enumerate(problem.table_names)},
        "law": _svg(plots.law()),
    }


def page(numbers: Mapping[str, Any], figures: Mapping[str, Any]) -> str:
    """The report of a `numbers_of` as one page that needs no other file."""
    text = page_text(
        "diagnosis/report/report.html.j2",
        report=numbers,
        figures=figures,
        a=amounts,
        w=Words(not numbers["of_measurement"]),
        sure=SURE,
        adequate=ADEQUATE,
        dominant=DOMINANT,
        drawing=lambda name, way: Markup(drawing(name, way)),
    )
    # No line ends between a number and its sign or unit.
    units = r"(?<=\d) (?=(?:Hz|mT|mm/s|V|ms|s|N)\b)"
    inside = rf"{units}| (?=[%±])|(?<=\bp) (?=[=&])|(?<=\bp =) |(?<=\bp &lt;) "
    return re.sub(r"(?<= )-(?=[xyz]\b)", "-&NoBreak;", re.sub(inside, "&nbsp;", text))


def save_figures(facts: Facts, folder: Path, formats: Sequence[str]) -> list[Path]:
    """Write all figures; see `Diagnosis.save_figures`."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, figure in Plots(facts).of_tables().items():
        if figure is not None:
            paths = [folder / f"{name.replace(' ', '-')}.{form}" for form in formats]
            for path in paths:
                figure.savefig(path)
            written += paths
    return written


def notebook(numbers: Mapping[str, Any]) -> str:
    """The verdict with its tables as a cell of a notebook shows it."""
    words = Words(not numbers["of_measurement"])
    return page_text("diagnosis/report/notebook.html.j2", report=numbers, a=amounts, w=words)


def _svg(figure: Figure | None) -> Markup:
    """A figure in the colours of the page, which may be dark."""
    text = svg(figure)
    names = {BLUE: "accent", VERMILION: "cause", DARK_GREY: "soft"}
    for colour, name in names.items():
        text = text.replace(colour.lower(), f"var(--{name})")
    return text


def _comments(facts: Facts, measurement: Measurement, extended: Scenario) -> list[str]:
    """Where an extended scenario is from, and what it has changed."""
    verdict = facts.verdict
    head = f"stickslip diagnose {measurement.path.name}: {verdict.kind} {', '.join(verdict.causes)}"
    lines = [head.rstrip()]
    if verdict.kind == "ambiguous" and verdict.fit is not None:
        lines.append(f"here: {verdict.fit.name}, the first of the set")
    changed = [
        f"{key}: {measurement.scenario.get(key):.6g} -> {extended.get(key):.6g}"
        for key, known in known_keys().items()
        if known.kind == "real"
        and not (is_of_one_coil(key) and key not in extended.coil.own_values())
        and extended.get(key) != measurement.scenario.get(key)
    ]
    drive = "[drive] is that of the scenario as it was given"
    differs = [key.removeprefix("drive.") for key in sorted(changed_settings(measurement))]
    if differs:
        drive += f"; the measurements set {', '.join(differs)}"
    return [*lines, *(changed or ["nothing is changed"]), drive]


def _origin(facts: Facts) -> list[list[str]]:
    """How a report was made: date, command, seed, versions, and checksums of the files."""
    program = Path(sys.argv[0]) if sys.argv else Path()
    is_command = program.stem == "stickslip" or program.parent.name == "stickslip"
    python = platform.python_version()
    rows = [
        ["date", datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")],
        ["made by", shlex.join(["stickslip", *sys.argv[1:]]) if is_command else "save_report"],
        ["seed", str(facts.findings.seed)],
        ["stickslip", _core.__version__],
        ["Python", f"{python}, numpy {numpy.__version__}, scipy {scipy.__version__}"],
    ]
    if facts.measurement is not None:
        rows += [[f"file {path.name}", _checksum(path)] for path in facts.measurement.files]
    return rows


def _checksum(path: Path) -> str:
    """SHA-256 of an ordinary file; a pipe can be read only once."""
    try:
        if not path.is_file():
            return "no ordinary file, so without a checksum"
        with path.open("rb") as file:
            return f"SHA-256 {sha256_of(file)}"
    except OSError:
        return "cannot be read any more"
