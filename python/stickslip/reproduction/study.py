"""The whole study: survey, statements, reference settings, figures, page."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from stickslip import plot
from stickslip._util.files import check_folder, text_writer, write_together
from stickslip._util.numbers import worker_count
from stickslip.errors import ScenarioError
from stickslip.reproduction.curves import (
    CURVES,
    MeasuredPoint,
    curve_tables,
    draw_curves,
    read_measured,
)
from stickslip.reproduction.field_checks import field_checks
from stickslip.reproduction.findings import Flaw, findings, flaws, settings_table
from stickslip.reproduction.motions import MOTIONS, draw_motion, motion_table, reference_runs
from stickslip.reproduction.page import page_text
from stickslip.reproduction.settings import MODES, Grid, Mode, Setting
from stickslip.reproduction.statements import RULE, Statement, judge
from stickslip.reproduction.survey import survey
from stickslip.reproduction.tables import write_table
from stickslip.scenario.keys import meant, shown

if TYPE_CHECKING:
    from stickslip.simulation.run import Run
    from stickslip.simulation.simulate import Progress

FIGURES = (*MOTIONS, *CURVES)
"""Names of the figures, in the paper's order."""

PAGE = "index.html"

SETTINGS = "settings.csv"

# Shares of the time of a whole study, roughly: the survey, the figures' simulations; the rest is
# drawing.
_SURVEY, _CURVES = 0.62, 0.86


@dataclass(frozen=True)
class Effort:
    """How much is simulated.

    Parameters
    ----------
    grid : Grid
        The settings that are tried.
    survey_variations, band_variations : int
        Small changes of frequency, friction and field for each point of the survey and of the
        figures; the first is no change.
    """

    grid: Grid = Grid()  # noqa: RUF009 - immutable
    survey_variations: int = 3
    band_variations: int = 20


@dataclass(frozen=True, eq=False)
class Reproduction:
    """What the study found. SI units.

    Attributes
    ----------
    statements : list of Statement
        S1 to S17 with numbers and verdict.
    reference : dict of Setting
        The settings of the figures, by mode.
    rule : str
        How they were chosen.
    findings : list of str
        What else the survey says.
    settings : pandas.DataFrame
        All settings that were tried, and what each does.
    flaws : list of Flaw
        What is wrong or open in the paper.
    tables : dict of pandas.DataFrame
        Data of the figures by name; their attribute "units" has the SI unit of each column.
    figures : dict of Path
        Pictures by name; empty if nothing was written.
    page : Path or None
    seconds : float
        What the study took, s.
    """

    statements: list[Statement]
    reference: dict[Mode, Setting]
    rule: str
    findings: list[str]
    settings: pd.DataFrame
    flaws: list[Flaw]
    tables: dict[str, pd.DataFrame]
    figures: dict[str, Path]
    page: Path | None
    seconds: float

    def as_dict(self) -> dict[str, Any]:
        """The result without data and pictures, of plain types."""
        return {
            "statements": [each.as_dict() for each in self.statements],
            "reference": {mode: setting.keys() for mode, setting in self.reference.items()},
            "rule": self.rule,
            "findings": self.findings,
            "flaws": [vars(each) for each in self.flaws],
            "figures": {name: str(path) for name, path in self.figures.items()},
            "page": None if self.page is None else str(self.page),
            "seconds": self.seconds,
        }


def reproduce(
    out: str | PathLike[str] | None = None,
    *,
    only: Iterable[str] | None = None,
    measured: str | PathLike[str] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    effort: Effort | None = None,
) -> Reproduction:
    """Redo the paper's simulations, and test its statements.

    The paper leaves open the sawtooth's edge and base, the field of the holding coil and the clamp
    coil's polarity. A grid of these is tried first, to say for each statement with which of them it
    holds; the figures are then drawn with the settings for which the most statements do.

    Parameters
    ----------
    out : path-like, optional
        Folder for pictures, data and the page ``index.html``; made if need be. Nothing is written
        without it.
    only : iterable of str, optional
        Names of the figures to make, such as ``"fig8"``; all, if not given. The statements are
        tested in any case.
    measured : path-like, optional
        CSV file with digitised points, columns figure, mode, x, y (SI), drawn over the curves.
    threads : int, optional
        How many simulations go on at a time; as many as there are processors, if not given.
    progress : callable, optional
        Called with the fraction that is done, 0 to 1, and what is being done.
    effort : Effort, optional
        How much is simulated.

    Returns
    -------
    Reproduction

    Raises
    ------
    ScenarioError
        If a figure is not known, or the file of points is not sound.
    ValueError
        If `threads` is not a whole number above zero, or no setting walks in both modes.
    OSError
        If something cannot be written.
    """
    begin = time.perf_counter()
    names = _chosen(only)
    points = [] if measured is None else read_measured(measured)
    threads = worker_count(threads, "threads")
    folder = None if out is None else Path(out)
    if folder is not None:
        check_folder(folder)
    effort = effort or Effort()
    report = progress or (lambda fraction, stage: None)

    found = survey(
        effort.grid.settings(),
        effort.survey_variations,
        threads,
        lambda done, _: report(_SURVEY * done, "trying settings"),
    )
    checks = field_checks()
    statements, chosen, holds = judge(found, checks)
    reference = {mode: found[mode].settings[k] for mode, k in zip(MODES, chosen, strict=True)}
    runs = reference_runs(reference, threads)
    tables = {
        name: motion_table(name, runs[MOTIONS[name].mode]) for name in names if name in MOTIONS
    }
    tables |= curve_tables(
        [name for name in names if name in CURVES],
        reference,
        effort.band_variations,
        threads,
        lambda done, _: report(_SURVEY + (_CURVES - _SURVEY) * done, "simulating figures"),
    )
    result = Reproduction(
        statements=statements,
        reference=reference,
        rule=RULE,
        findings=findings(found, holds),
        settings=settings_table(found),
        flaws=flaws(found, runs, reference, checks, threads),
        tables=tables,
        figures={},
        page=None,
        seconds=time.perf_counter() - begin,
    )
    return result if folder is None else _written(result, folder, runs, points, report, begin)


def _chosen(only: Iterable[str] | None) -> list[str]:
    if only is None:
        return list(FIGURES)
    wanted = [only] if isinstance(only, str) else list(only)
    for name in wanted:
        if name not in FIGURES:
            allowed = f"one or more of {', '.join(FIGURES)}{meant(name, FIGURES)}"
            raise ScenarioError(f"figure {shown(name)}: allowed is {allowed}")
    return [name for name in FIGURES if name in wanted]


def _written(
    result: Reproduction,
    folder: Path,
    runs: dict[Mode, Run],
    points: Sequence[MeasuredPoint],
    report: Progress,
    begin: float,
) -> Reproduction:
    folder.mkdir(parents=True, exist_ok=True)
    figures = {}
    for place, (name, table) in enumerate(result.tables.items()):
        report(_CURVES + (1.0 - _CURVES) * place / len(result.tables), "drawing")
        figures[name] = folder / f"{name}.png"
        write_table(table, folder / f"{name}.csv")
        if name in MOTIONS:
            figure = draw_motion(name, runs[MOTIONS[name].mode])
        else:
            figure = draw_curves(name, table, points)
        plot.save(figure, figures[name])
    write_table(result.settings, folder / SETTINGS)
    page = folder / PAGE
    seconds = time.perf_counter() - begin
    result = dataclasses.replace(result, figures=figures, page=page, seconds=seconds)
    write_together({page: text_writer(page_text(result, points))})
    report(1.0, "done")
    return result
