"""The function `stickslip.reproduce`: settings, statements, reference, figures."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from stickslip import plot
from stickslip._util.arrays import worker_count
from stickslip._util.columns import write_frame
from stickslip._util.files import check_folder
from stickslip._util.messages import meant, shown
from stickslip.errors import ScenarioError
from stickslip.reproduction.figures import (
    CURVES,
    FIGURES,
    MOTIONS,
    curve_table,
    draw_curves,
    draw_motion,
    motion_table,
    reference_runs,
    with_units,
)
from stickslip.reproduction.settings import GRID, SCANS, Setting
from stickslip.reproduction.statements import judge
from stickslip.reproduction.walks import Walks, survey

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stickslip.simulation.simulate import Progress

_STATEMENTS, _SETTINGS = "statements.csv", "settings.csv"

# Simulations with small changes of frequency, friction and field for each point. Chosen.
_OF_SURVEY, _OF_FIGURES = 3, 20
_SURVEY = 0.6  # part of the time of a whole study, roughly


@dataclass(frozen=True, eq=False)
class Reproduction:
    """The result of the study. SI units.

    Attributes
    ----------
    statements : pandas.DataFrame
        A row for each of S1 to S17 with its verdict, the share of the working pairs of settings for
        which it holds, the settings on which it depends, and its numbers at the reference.
    reference : dict of Setting
        The settings of the figures, by mode.
    settings : pandas.DataFrame
        All settings that were tried, and what each does.
    tables : dict of pandas.DataFrame
        Data of the figures by name; their attribute "units" has the unit of each column.
    figures : dict of matplotlib.figure.Figure
        The figures by name.
    """

    statements: pd.DataFrame
    reference: dict[str, Setting]
    settings: pd.DataFrame
    tables: dict[str, pd.DataFrame]
    figures: dict[str, Figure]

    def summary(self) -> str:
        """The reference and the table of statements as text."""
        lines = [f"{mode}  {setting}" for mode, setting in self.reference.items()]
        for row in self.statements.itertuples():
            share = "" if math.isnan(row.share) else f"; holds for {row.share:.1%} of pairs"
            depends = row.settings and f", most often with {row.settings}"
            lines += ["", f"{row.statement:<4} {row.text}"]
            lines += [f"     {row.verdict}{share}{depends}", f"     {_in_words(row.numbers)}"]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Statements, reference and names of the figures, of plain types."""
        return {
            "statements": json.loads(self.statements.to_json(orient="records")),
            "reference": {mode: setting.keys() for mode, setting in self.reference.items()},
            "figures": list(self.figures),
        }

    def save(self, folder: str | PathLike[str]) -> None:
        """Write PNG and CSV of each figure, ``statements.csv`` and ``settings.csv``.

        The folder is made if need be; an OSError names what cannot be written.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        statements = self.statements.drop(columns="numbers")
        statements["numbers"] = [_in_words(numbers) for numbers in self.statements["numbers"]]
        write_frame(statements, folder / _STATEMENTS)
        write_frame(self.settings, folder / _SETTINGS)
        for name, figure in self.figures.items():
            write_frame(self.tables[name], folder / f"{name}.csv")
            plot.save(figure, folder / f"{name}.png")


def _in_words(numbers: dict[str, float]) -> str:
    """The numbers of a statement in one line."""
    return ", ".join(f"{name} {value:.3g}" for name, value in numbers.items())


def reproduce(
    out: str | PathLike[str] | None = None,
    *,
    only: Iterable[str] | None = None,
    points: pd.DataFrame | None = None,
    settings: Sequence[Setting] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Reproduction:
    """Redo the paper's simulations, and test its statements.

    The paper leaves open the sawtooth's edge and base, the field of the holding coil and the clamp
    coil's polarity. All settings of a grid of these are tried, to say for each statement for which
    share of them it holds. The figures are drawn with the pair of settings for which the statements
    on the motion (S1 to S4) hold and then the most of the others; where several do, with that whose
    velocities at 30 Hz and 100 Hz are nearest to the 0.88 mm/s of the paper's Reynolds number.

    Parameters
    ----------
    out : path-like, optional
        Folder for what `Reproduction.save` writes; made if need be.
    only : iterable of str, optional
        Names of the figures to make, such as ``"fig8"``; all, if not given. The statements are
        tested in any case.
    points : pandas.DataFrame, optional
        Digitised points to draw over Figs. 8 to 15: columns figure, mode, x (the SI unit of what is
        varied) and y (m/s).
    settings : sequence of Setting, optional
        Which settings are tried, of both modes; all of the grid, if not given.
    threads : int, optional
        How many simulations go on at a time; as many as there are processors, if not given.
    progress : callable, optional
        Called with the fraction that is done, 0 to 1, and what is being done.

    Returns
    -------
    Reproduction

    Raises
    ------
    ScenarioError
        If a figure is not known, or `points` has another column, figure or mode.
    ValueError
        If `threads` is not a whole number above zero, or no setting walks in both modes.
    OSError
        If something cannot be written.
    """
    names = _chosen(only)
    if points is not None:
        _check_points(points)
    threads = worker_count(threads, "threads")
    if out is not None:
        files = [f"{name}{suffix}" for name in names for suffix in (".png", ".csv")]
        check_folder(out, [_STATEMENTS, _SETTINGS, *files])
    report = progress or (lambda fraction, stage: None)

    def report_survey(done: float, stage: str) -> None:
        report(_SURVEY * done, "trying settings")

    walks = survey(settings or GRID, _OF_SURVEY, threads, report_survey)
    statements, reference = judge(walks)
    runs = reference_runs(reference, threads)
    tables, figures = {}, {}
    for done, name in enumerate(names):
        report(_SURVEY + (1.0 - _SURVEY) * done / len(names), "drawing figures")
        if name in MOTIONS:
            run = runs[MOTIONS[name][0]]
            tables[name], figures[name] = motion_table(name, run), draw_motion(name, run)
        else:
            tables[name] = curve_table(name, reference, _OF_FIGURES, threads)
            figures[name] = draw_curves(name, tables[name], points)
    result = Reproduction(statements, reference, settings_table(walks), tables, figures)
    if out is not None:
        result.save(out)
    report(1.0, "done")
    return result


def _chosen(only: Iterable[str] | None) -> list[str]:
    """The figures that are wanted, in the paper's order."""
    wanted = FIGURES if only is None else [only] if isinstance(only, str) else list(only)
    for name in wanted:
        if name not in FIGURES:
            allowed = f"one or more of {', '.join(FIGURES)}{meant(name, FIGURES)}"
            raise ScenarioError(f"figure {shown(name)}: allowed is {allowed}")
    return [name for name in FIGURES if name in wanted]


def _check_points(points: pd.DataFrame) -> None:
    missing = {"figure", "mode", "x", "y"}.difference(points)
    if missing:
        raise ScenarioError(f"points: column {shown(min(missing))} is missing")
    for figure, mode in zip(points["figure"], points["mode"], strict=True):
        if figure not in CURVES:
            allowed = f"one of {', '.join(CURVES)}{meant(figure, CURVES)}"
            raise ScenarioError(f"points: figure {shown(figure)}: allowed is {allowed}")
        if mode not in CURVES[figure].modes:
            allowed = " or ".join(CURVES[figure].modes)
            raise ScenarioError(f"points: mode {shown(mode)}: allowed in {figure} is {allowed}")


def settings_table(walks: Walks) -> pd.DataFrame:
    """A row for every setting: what it is, and what it does."""
    parts = [walk.drop_dims(SCANS).to_dataframe() for walk in walks.values()]
    names = ("base", "hold", "velocity_30_hz", "velocity_100_hz", "still_tilt", "mean_tilt")
    units = dict(zip(names, ("T", "T", "m/s", "m/s", "rad", "rad"), strict=True))
    units |= {"still_velocity": "m/s", "slip_up": "m", "slip_down": "m"}
    return with_units(pd.concat(parts, ignore_index=True), units)
