"""The result of an optimisation."""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from stickslip._util import palette, units
from stickslip._util.files import write_together
from stickslip._util.picture import RC, Picture, legend_above
from stickslip._util.text import OneLine
from stickslip.design.goal import DRAGGED, Goal
from stickslip.scenario.keys import COIL_NAMES, RECORD_RATE, Value, find_key
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.toml_file import files_of, scenario_writers
from stickslip.scenario.waveform import drive_waveform
from stickslip.simulation.notes import shown_lines
from stickslip.simulation.run import Run
from stickslip.simulation.seen_from_drive import ALONG, FROM_AXES
from stickslip.simulation.simulate import simulate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

BEST, FIGURE = "best.toml", "best.png"
VOLTAGES = "csv"
"""Ending of the file of its voltages, which is their result, after ``best.``."""

COMPARED = {
    "start": "the scenario's own",
    "search": "what the search found",
    "sawtooth": "the best of a grid of sawtooths",
    "best": "the drive that is written: the better of search and sawtooth, or a better neighbour",
}
"""The drives that are judged on fresh draws, and what they are."""

ABOUT = 32
"""Draws of the landscape; chosen: enough for differences, not for its level."""

_ACTIVE = 0.02  # part of a limit up to which its figure counts as at it; chosen
_FEW = 6  # names on a line; chosen
_PERIODS, _SAMPLES = 3, 400  # of the drive that is drawn, and a period; chosen
_COLUMNS, _MOST_SLICES = 4, 12  # of the landscape: in a row, and in all; chosen

_COIL_COLOURS = (palette.BLUE, palette.SKY, palette.PURPLE, palette.VERMILION, palette.ORANGE)
_WITHIN: Any = {
    "color": palette.BLUE, "linestyle": "", "marker": ".",
    "label": "within the limits in every draw",
}  # fmt: skip
_BEYOND: Any = {
    "color": palette.VERMILION, "linestyle": "", "marker": "x", "markersize": 4,
    "label": "beyond a limit in some draw",
}  # fmt: skip
_BEST: Any = {"color": palette.DARK_GREY, "linewidth": 0.8, "label": "the best drive"}


class SearchInterrupted(KeyboardInterrupt):
    """Ctrl-C in an optimisation.

    `best` is the best Optimum until then, or None where no drive within the limits was found.
    """

    def __init__(self, best: Optimum | None) -> None:
        super().__init__()
        self.best = best

    def __str__(self) -> str:
        if self.best is None:
            return "interrupted before a drive within the limits was found"
        return "interrupted; the attribute best has the best drive until then"


@dataclass(frozen=True, eq=False, repr=False)
class Optimum(OneLine):
    """The result of an optimisation. SI units.

    Attributes
    ----------
    scenario, start : Scenario
        The best drive, and what the search began with.
    run : Run
        The best drive at the middle of the priors, or where these make no scenario together at its
        own values; without a record.
    table : pandas.DataFrame
        Fresh draws of "start", "search" and "sawtooth", where these are not the best, and "best":
        score, mean and worst of the figure, draws, draws that exceed a limit or fail, those that
        fail, the relative excess, and the greatest value of each figure with a limit, the least of
        one with a least value as "mean_velocity_least".
    fresh : pandas.DataFrame
        The figure of these drives, a column each, in every fresh draw.
    search : pandas.Series
        The best drive in the draws of the search, which favour it; as a row of `table`.
    values : dict
        Words and numbers of the best drive that were free, by name, knots in V; of a sawtooth
        beside a free waveform all its keys.
    sawtooth : dict or None
        The best sawtooth by its keys; None where none is within the limits, or the drive is none.
    no_sawtooth : str
        Why there is none; "" where there is one.
    landscape : pandas.DataFrame
        A row for each free number: name, unit, best, kind ("at a limit", "peak", "plateau"),
        loss (part of the score that is lost nearby), at_end ("low", "high" or ""), and lists of
        values, scores and whether they are feasible. Empty of a sawtooth beside a free waveform.
    goal : Goal
    other_way : float
        Where the figure is a velocity, the greatest mean of a drive of the search that is within
        the limits and goes against what is asked; 0 without one, or once it was turned round.
    origin : {"search", "sawtooth"}
        Whose drive is the best.
    moves : int
        Moves to better neighbours.
    ended, agreeing : int
        Ends of the search, the centres of all strategies of the restarts that were not given up,
        and those of them that are within the limits and 1 % of its best score.
    runs, seed : int
        Simulations of the search, and the seed of all draws.
    interrupted : bool
    seconds : float
        Duration of the search, s.
    """

    scenario: Scenario
    start: Scenario
    run: Run
    table: pd.DataFrame
    fresh: pd.DataFrame
    search: pd.Series[Any]
    values: dict[str, Value]
    sawtooth: dict[str, Value] | None
    no_sawtooth: str
    landscape: pd.DataFrame
    goal: Goal
    other_way: float
    origin: str
    moves: int
    ended: int
    agreeing: int
    runs: int
    seed: int
    interrupted: bool
    seconds: float

    @property
    def active(self) -> list[str]:
        """Columns of `table` with a limit whose worst value in the draws of the search is at it."""
        return [
            column
            for column, (_, sign, limit) in self.goal.bounds.items()
            if sign * (limit - self.search[column]) <= _ACTIVE * abs(limit)
        ]

    @property
    def beyond(self) -> str:
        """Where the best drive is beyond its limits, in one line; empty if nowhere."""
        one = self.goal.table(np.array([[self.goal.numbers(self.run)]]))
        rows = pd.concat([one, self.table.query("index == 'best'")])
        rows = rows[rows["exceeding"] > 0]
        if rows.empty:
            return ""
        uncertain, ran = self.start.uncertain, self.run.scenario
        priors = {} if uncertain is None else uncertain.priors
        is_middle = all(ran.get(key) == prior.value(0.0) for key, prior in priors.items())
        own = "scenario's own values (the middles together make no scenario)"
        where = [
            f"the run at the {'middle' if is_middle else own}"
            if name == 0
            else f"{over} of {draws} fresh draws"
            for name, over, draws in rows[["exceeding", "draws"]].itertuples()
        ]
        bounds = self.goal.bounds.items()
        passed = self.goal.passed(
            {name: sign * (sign * rows[name]).max() for name, (_, sign, _) in bounds}
        )
        passed += ["a simulation fails"] * bool(rows["failed"].any())
        return f"beyond the limits in {' and '.join(where)}: {', '.join(passed)}"

    def summary(self) -> str:
        """The result in some lines."""
        goal = self.goal
        rows = pd.concat([self.search.to_frame("best, in the search").T, self.table])
        shown = rows[["score", "mean", "worst", "draws", "exceeding"]].astype(object)
        if "pull_share" in rows:
            most = DRAGGED["pull_share"]
            shares = rows["pull_share"].astype(float)
            shown["pull_share"] = [f"{s:.3g}" + ", dragged" * (s > most) for s in shares]
        others = rows[1:].drop("best", errors="ignore").query("exceeding == 0")["score"].items()
        held = ", ".join(f"{name} ({score:.6g})" for name, score in others) or "none"
        broken = f"the best breaks a limit: {self.beyond}; others within all in all fresh draws: "
        lines = [
            *[broken + held] * (self.beyond != ""),
            f"{'largest' if goal.sign > 0.0 else 'least'} {goal.figure} found, {goal.unit}; the "
            f"score is the {goal.score} of the draws:",
            *shown.to_string(float_format="{:.6g}".format).splitlines(),
            *["; ".join(f"{name}: {COMPARED[name]}" for name in self.table.index)]
            * (not self.table.empty),
            *[f"no sawtooth to compare with: {self.no_sawtooth}"] * (self.sawtooth is None),
            *["the best sawtooth is better than the search"] * (self.origin == "sawtooth"),
            *[f"better neighbours that were taken: {self.moves}"] * (self.moves > 0),
            *self._other_way_lines,
            "the best drive:",
            *(f"  {line}" for line in self._drive_lines()),
            f"  in flight {100.0 * self.run.numbers['airborne_fraction']:.3g} % of the time",
            *["  backward, against drive.direction"] * self._is_backward,
            *(f"  {line}" for line in shown_lines(self.run.notes)),
            "its limits, in every draw of the search:",
        ]
        for name in goal.bounds:
            active = ", active" if name in self.active else ""
            lines.append(f"  {goal.beside_limit(name, self.search[name])}{active}")
        if not self.landscape.empty:
            for kind, names in self.landscape.groupby("kind")["name"]:  # limits come first
                many = kind != "peak" and len(names) > _FEW  # they ask for no care
                text = f"{len(names)} numbers" if many else ", ".join(names)
                lines.append(f"  {'on a ' * (kind != 'at a limit')}{kind}: {text}")
        is_of_search = self.origin == "search" and not self.moves
        if is_of_search and self.agreeing < 2 <= self.ended:  # no other end confirms it
            lines.append(
                f"{self.agreeing} of {self.ended} ends of the search are within 1 % of its best: "
                "another --seed may find a better drive"
            )
        lines.append(f"{self.runs} runs of the search, seed {self.seed}, {self.seconds:.0f} s")
        return "\n".join(lines)

    @property
    def _is_backward(self) -> bool:
        directed = self.run.scenario.drive.kind != "program"
        return directed and self.goal.figure in FROM_AXES and bool(self.run.velocity[0] < 0.0)

    @property
    def _other_way_lines(self) -> list[str]:
        """Where a drive is faster the other way, what to ask for."""
        figure, sign = self.goal.figure, self.goal.sign
        if not self.other_way > abs(self.search["mean"]):
            return []
        asked, exchanged = ("maximise", "minimise")[:: int(sign)]
        text = (
            f"a drive within the limits is faster the other way, mean {self.other_way:.6g} "
            f"{self.goal.unit}: --{exchanged} {figure} searches there"
        )
        if figure == "mean_velocity" and self.values.get("drive.direction") == "-x":
            text += f"; so does --{asked} {ALONG} with drive.direction = -x"
        return [text]

    @property
    def _pulses(self) -> list[str]:
        """A line on the pulses where the search set others than the start has."""
        drive, start = self.scenario.drive, self.start.drive
        if drive.kind == "program" or drive.pulses == start.pulses:
            return []
        return [f"drive.pulses = {drive.pulses}, not {start.pulses}: they follow the frequency"]

    def _drive_lines(self) -> list[str]:
        """A line for each key, and for the knots of each coil."""
        lines, knots = [], dict[str, list[str]]()
        for name, value in self.values.items():
            if isinstance(value, str):
                lines.append(f"{name} = {value}")
            elif " " in name:
                knots.setdefault(name.partition(" ")[0], []).append(f"{value:.4g}")
            else:
                unit = units.unit_label(find_key(name).unit)
                lines.append(f"{name} = {value:.6g} {unit}".rstrip())
        lines += self._pulses
        return lines + [f"{coil} = {' '.join(values)} V" for coil, values in knots.items()]

    def as_dict(self) -> dict[str, Any]:
        """The result of plain types, as ``stickslip optimise --json`` prints it."""
        goal = self.goal

        def judged(row: pd.Series[Any]) -> dict[str, Any]:
            names = ("score", "mean", "worst")
            return {
                **{name: float(row[name]) for name in names},
                **{name: int(row[name]) for name in ("draws", "exceeding")},
                "limited": {name: float(row[name]) for name in goal.bounds},
            }

        return {
            "figure": goal.figure,
            "unit": goal.unit,
            "maximise": goal.sign > 0.0,
            "score": goal.score,
            "beyond_limits": self.beyond or None,
            **{name: self.run.summary()[name] for name in ("airborne_fraction", "notes")},
            "search": judged(self.search),
            "fresh": {name: judged(row) for name, row in self.table.iterrows()},
            "limits": dict(goal.limits),
            "at_least": dict(goal.at_least),
            "default_limits": list(goal.assumed),
            "active": self.active,
            "landscape": self.landscape.to_dict("records"),
            "draws": int(self.search["draws"]),
            **{name: getattr(self, name) for name in ("values", "origin", "moves", "sawtooth")},
            **{name: getattr(self, name) for name in ("no_sawtooth", "ended", "agreeing")},
            "other_way": self.other_way,
            **{name: getattr(self, name) for name in ("runs", "seed", "interrupted", "seconds")},
        }

    @property
    def files(self) -> tuple[str, ...]:
        """Names of the files that `save_report` writes."""
        held = files_of(self.scenario, Path(BEST), VOLTAGES)
        return (BEST, *held.values(), FIGURE)

    def save_report(self, out: str | PathLike[str]) -> None:
        """Write the best drive and its figure into the folder `out`, which is made: all or none.

        ``best.toml`` is an ordinary scenario, ``best.csv`` the voltages of a free waveform,
        ``best.map.json`` the field of ``coil.map``, ``best.accelerations.csv`` those of a shake,
        ``best.forces.csv`` those on an inner mass, and ``best.png`` is `figure`. An OSError says
        that one cannot be written.
        """
        folder = Path(out)
        comments = [*filter(None, [self.beyond]), *self._pulses]
        writers = scenario_writers(self.scenario, folder / BEST, comments, VOLTAGES)
        writers[folder / FIGURE] = functools.partial(self.figure().savefig, dpi=150)
        folder.mkdir(parents=True, exist_ok=True)
        write_together(writers)

    def figure(self) -> Figure:
        """Voltages and field of the best drive, the scores of all fresh draws, the landscape.

        Of the landscape the numbers that change the score most.
        """
        shown = self._most_influential()
        rows = -(-len(shown) // _COLUMNS)
        heights = [6.0, 0.7 + 1.5 * rows] if rows else [6.0]
        with matplotlib.rc_context(RC):
            figure = Picture(figsize=(8.4, sum(heights)), layout="constrained")
            parts = figure.subfigures(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
            volts, field, scores = parts[0].subplots(3, 1)
            self._draw_drive(volts, field)
            self._draw_scores(scores)
            parts[0].align_ylabels([volts, field])
            if rows:
                self._draw_landscape(parts[1], shown)
        return figure

    def _draw_drive(self, volts: Axes, field: Axes) -> None:
        frequency = float(self.values.get("drive.frequency", self.start.drive.frequency))
        begin = max(self.scenario.window[1] - _PERIODS / frequency, 0.0)
        record: dict[str, Value] = {"record.fields": "all", "record.from": begin}
        record[RECORD_RATE] = _SAMPLES * frequency
        run = simulate(self.scenario.replace(record))
        if run.ok:  # it may fail at the middle, which was none of the draws
            asked = drive_waveform(self.scenario)
            voltages = asked.voltages(np.minimum(run.t, asked.duration))
            for name, volts_of, colour in zip(COIL_NAMES, voltages.T, _COIL_COLOURS, strict=True):
                if volts_of.any():
                    volts.plot(run.t, volts_of, color=colour, label=f"coil {name}")
            for axis, dashes in (("x", "-"), ("y", ":"), ("z", "--")):
                component = 1e3 * getattr(run, f"b{axis}")
                if axis != "y" or component.any():
                    look: Any = {"color": palette.GREEN, "linestyle": dashes}
                    field.plot(run.t, component, label=f"$B_{axis}$", **look)
        for axes, label in ((volts, "voltage\nasked for (V)"), (field, "field (mT)")):
            axes.set_ylabel(label)
            axes.set_xlabel("time (s)")
            if run.ok:
                axes.set_xlim(run.t[0], run.t[-1])
                legend_above(axes, axes.get_lines())

    def _draw_scores(self, axes: Axes) -> None:
        factor, label = units.in_handy_units(self.goal.figure, self.goal.unit)
        for rank, (name, scores) in enumerate(self.fresh.items()):
            values = np.sort(scores) * factor
            spread = rank + 0.28 * np.sin(2.4 * np.arange(len(values)))  # not on one another
            axes.plot(values, spread, ".", color=palette.BLUE, markersize=4, alpha=0.7)
            score = self.table["score"][name] * factor
            axes.vlines(score, rank - 0.42, rank + 0.42, palette.BLACK)
        axes.set_yticks(range(len(self.table)), list(self.table.index))
        axes.grid(visible=False, axis="y")
        axes.set_xlabel(label)
        draw = Line2D([], [], color=palette.BLUE, linestyle="", marker=".", label="a fresh draw")
        score = Line2D([], [], color=palette.BLACK, label=f"score, {self.goal.score} of the draws")
        legend_above(axes, [draw, score])

    def _most_influential(self) -> list[dict[str, Any]]:
        """At most `_MOST_SLICES` rows of the landscape, in its order."""
        if self.landscape.empty:
            return []
        span = self.landscape["scores"].map(np.ptp).fillna(np.inf)  # where simulations fail
        chosen = span.nlargest(_MOST_SLICES).index
        rows: list[dict[str, Any]] = self.landscape.loc[chosen.sort_values()].to_dict("records")
        return rows

    def _draw_landscape(self, part: SubFigure, shown: list[dict[str, Any]]) -> None:
        factor, label = units.in_handy_units(self.goal.score, self.goal.unit)
        rows = -(-len(shown) // _COLUMNS)
        grid = part.subplots(rows, _COLUMNS, sharey=True, squeeze=False).flat
        for axes, row in itertools.zip_longest(grid, shown):
            if row is None:
                axes.set_visible(False)
                continue
            scale, unit = units.handy(row["unit"])
            x, y = np.array(row["values"]) * scale, np.array(row["scores"]) * factor
            good = np.array(row["feasible"])
            axes.plot(x, y, color=palette.BLUE)
            axes.plot(x[good], y[good], **_WITHIN)
            axes.plot(x[~good], y[~good], **_BEYOND)
            axes.axvline(row["best"] * scale, **_BEST)
            axes.set_title(f"{row['name']} ({unit})".replace(" ()", ""), fontsize=8.0)
            axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
            axes.tick_params(labelsize=7.0)
        part.supylabel(label, fontsize=9.0)
        count = len(self.landscape)
        title = "score along each free number"
        if count > len(shown):
            title += f" ({len(shown)} of {count}, which change it most)"
        if self.scenario.uncertain is not None:
            title += f", on {ABOUT} other draws: see its shape, not its level"
        handles = [Line2D([], [], **look) for look in (_WITHIN, _BEYOND, _BEST)]
        legend: Any = {"loc": "outside upper center", "ncols": len(handles), "frameon": False}
        part.legend(handles=handles, title=title, title_fontsize=9.0, **legend)
