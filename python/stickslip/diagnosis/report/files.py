"""The files of a report: report.html, report.json, and those that state the extended model."""

from __future__ import annotations

import hashlib
import platform
import re
import shlex
import sys
from collections.abc import Mapping
from datetime import datetime
from os import PathLike
from pathlib import Path
from typing import Any

import numpy
import scipy
from markupsafe import Markup
from matplotlib.figure import Figure

from stickslip._util.files import check_folder, text_writer, write_together
from stickslip._util.html import VERSION, page_text, svg
from stickslip._util.palette import BLUE, DARK_GREY, VERMILION
from stickslip._util.text import json_text
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.decision.misfit_test import GOF_LEVEL
from stickslip.diagnosis.decision.posterior import SURE
from stickslip.diagnosis.decision.verdict import DOMINANT
from stickslip.diagnosis.report.numbers import numbers_of
from stickslip.diagnosis.report.pictures import Plots
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.words import Vocabulary, Words

FILES = PAGE, JSON = "report.html", "report.json"


def save(facts: Facts, out: str | PathLike[str], title: str | None) -> None:
    """Write all files into the folder `out`, which is made, or none; see `save_report`."""
    folder, verdict = Path(out), facts.verdict
    told = f"{verdict.kind} {', '.join(verdict.causes)}"
    first = verdict.fit.name if verdict.kind == "ambiguous" and verdict.fit is not None else ""
    beside = facts.rivals.writers(folder, told, first, facts.extended)
    check_folder(out, [*FILES, *(path.name for path in beside)])
    numbers = numbers_of(facts, title)
    numbers["origin"] = _origin(facts)
    writers = {
        folder / JSON: text_writer(json_text(numbers) + "\n"),
        folder / PAGE: text_writer(page(numbers, figures_of(facts), facts.problem.words)),
    }
    folder.mkdir(parents=True, exist_ok=True)
    write_together(writers | beside)


def figures_of(facts: Facts) -> dict[str, Any]:
    """The figures of a page beside its numbers: see `Plots.of_page`."""
    figures = Plots(facts).of_page()
    fits = {name: list(map(_svg, each)) for name, each in figures.pop("fit").items()}
    return {"fit": fits, **{name: list(map(_svg, each)) for name, each in figures.items()}}


def page(numbers: Mapping[str, Any], figures: Mapping[str, Any], vocabulary: Vocabulary) -> str:
    """The report of a `numbers_of` as one page that needs no other file."""
    text = page_text(
        "diagnosis/report/report.html.j2", r=numbers, figures=figures, folds=[], a=amounts,
        w=Words(vocabulary), sure=SURE, adequate=GOF_LEVEL, dominant=DOMINANT,
        drawing=lambda name, way: Markup(vocabulary.drawing(name, way)),
    )  # fmt: skip
    # No line ends between a number and its sign or unit.
    units = r"(?<=\d) (?=(?:Hz|mT|mm/s|V|ms|s|N)\b)"
    inside = rf"{units}| (?=[%±])|(?<=\bp) (?=[=&])|(?<=\bp =) |(?<=\bp &lt;) "
    return re.sub(r"(?<= )-(?=[xyz]\b)", "-&NoBreak;", re.sub(inside, "&nbsp;", text))


def _svg(figure: Figure | None) -> Markup:
    """A figure in the colours of the page, which may be dark."""
    text = svg(figure)
    names = {BLUE: "accent", VERMILION: "cause", DARK_GREY: "soft"}
    for colour, name in names.items():
        text = text.replace(colour.lower(), f"var(--{name})")
    return text


def _origin(facts: Facts) -> list[list[str]]:
    """How a report was made: date, command, seed, versions, and checksums of the files."""
    program = Path(sys.argv[0]) if sys.argv else Path()
    is_command = program.stem == "stickslip" or program.parent.name == "stickslip"
    python = platform.python_version()
    rows = [
        ["date", datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")],
        ["made by", shlex.join(["stickslip", *sys.argv[1:]]) if is_command else "save_report"],
        ["seed", str(facts.findings.seed)],
        ["stickslip", VERSION],
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
        return f"SHA-256 {hashlib.sha256(path.read_bytes()).hexdigest()}"
    except OSError:
        return "cannot be read any more"
