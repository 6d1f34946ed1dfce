"""The result of an optimisation."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
import pandas as pd

from stickslip._util import palette, units
from stickslip._util.files import write_together
from stickslip._util.picture import RC, Picture, legend_above
from stickslip._util.text import OneLine
from stickslip.design.goal import Goal
from stickslip.scenario.keys import COIL_NAMES, RECORD_RATE, Value, find_key
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.toml_file import scenario_writers
from stickslip.scenario.waveform import drive_waveform
from stickslip.simulation.notes import shown_lines
from stickslip.simulation.run import Run
from stickslip.simulation.simulate import simulate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ACTIVE = 0.02  # part of a limit up to which its figure counts as at it; chosen
_PERIODS, _SAMPLES = 3, 400  # of the drive that is drawn, and a period; chosen
_COIL_COLOURS = (palette.BLUE, palette.SKY, palette.PURPLE, palette.VERMILION, palette.ORANGE)


class SearchInterrupted(KeyboardInterrupt):
    """Ctrl-C in an optimisation.

    `best` is the best Optimum until then, or None where no drive within the limits was found.
    """

    def __init__(self, best: Optimum | None) -> None:
        super().__init__()
        self.best = best


@dataclass(frozen=True, eq=False, repr=False)
class Optimum(OneLine):
    """The result of an optimisation. SI units.

    Attributes
    ----------
    scenario, start : Scenario
        The best drive, and the start of the search.
    run : Run
        The best drive at the scenario's own values, without a record.
    table : pandas.DataFrame
        Rows: "search", the best drive in the draws of the search, which favour it; "start" and
        "best" in fresh draws, unless it was interrupted. Columns: score, mean and worst of the
        figure, draws, those that exceed a limit or fail, that fail, the relative excess, and the
        worst value of each figure with a limit, with a least value as "mean_velocity_least".
    values : dict
        Words and numbers of the best drive that were free, by name, knots in V.
    goal : Goal
    runs, seed : int
        Simulations of the search, and the seed of all draws.
    """

    scenario: Scenario
    start: Scenario
    run: Run
    table: pd.DataFrame
    values: dict[str, Value]
    goal: Goal
    runs: int
    seed: int

    @property
    def active(self) -> list[str]:
        """Columns of `table` with a limit whose worst value in the draws of the search is at it."""
        worst = self.table.loc["search"]
        return [
            column
            for column, (_, sign, limit) in self.goal.bounds.items()
            if sign * (limit - worst[column]) <= _ACTIVE * abs(limit)
        ]

    @property
    def beyond(self) -> str:
        """Where the best drive is beyond its limits, in one line; empty if nowhere."""
        row = self.table.loc[self.table.index[-1]]
        if not row["exceeding"]:
            return ""
        exceeded = self.goal.exceeded(row) + ["a simulation fails"] * bool(row["failed"])
        where = f"{row['exceeding']:.0f} of {row['draws']:.0f} fresh draws"
        return f"beyond the limits in {where}: {', '.join(exceeded)}"

    def summary(self) -> str:
        """The result in some lines."""
        goal = self.goal
        shown = self.table.drop(columns=["failed", "excess", *goal.bounds]).astype(object)
        lines = [
            *[f"the best breaks a limit: {self.beyond}"] * (self.beyond != ""),
            f"{'largest' if goal.sign > 0.0 else 'least'} {goal.figure} found, {goal.unit}; the "
            f"score is the {goal.score} of the draws:",
            *shown.to_string(float_format="{:.6g}".format).splitlines(),
            "search: the best in the draws of the search, which favour it; others: in fresh draws",
            "the best drive:",
            *(f"  {line}" for line in self._drive_lines() or ["that of the start"]),
            f"  in flight {100.0 * self.run.numbers['airborne_fraction']:.3g} % of the time",
            *(f"  {line}" for line in shown_lines(self.run.notes)),
            "its limits, in every draw of the search:",
        ]
        for name in goal.bounds:
            active = ", active" if name in self.active else ""
            lines.append(f"  {goal.next_to_limit(name, self.table[name]['search'])}{active}")
        lines.append(f"{self.runs} runs of the search, seed {self.seed}")
        return "\n".join(lines)

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
        return lines + [f"{coil} = {' '.join(values)} V" for coil, values in knots.items()]

    def as_dict(self) -> dict[str, Any]:
        """The result of plain types, as ``stickslip optimise --json`` prints it."""
        goal = self.goal
        return {
            **{name: getattr(goal, name) for name in ("figure", "unit", "score")},
            "maximise": goal.sign > 0.0,
            "limits": dict(goal.limits),
            "at_least": dict(goal.at_least),
            "default_limits": list(goal.assumed),
            "table": self.table.to_dict("index"),
            "beyond_limits": self.beyond or None,
            **{name: self.run.summary()[name] for name in ("airborne_fraction", "notes")},
            **{name: getattr(self, name) for name in ("active", "values", "runs", "seed")},
        }

    def save(self, out: str | PathLike[str]) -> list[str]:
        """Write the best drive and its figure into a folder, which is made: all or none.

        ``best.toml`` is an ordinary scenario, with the files that it names: ``best.csv`` has the
        voltages of a free waveform. ``best.png`` is `figure`. Return the names of all. An OSError
        says that one cannot be written.
        """
        folder = Path(out)
        comments = [*filter(None, [self.beyond])]
        writers = scenario_writers(self.scenario, folder / "best.toml", comments, "csv")
        writers[folder / "best.png"] = functools.partial(self.figure().savefig, dpi=150)
        folder.mkdir(parents=True, exist_ok=True)
        write_together(writers)
        return [path.name for path in writers]

    def figure(self) -> Figure:
        """Draw voltages and field of the best drive in its last periods, with their limits."""
        limits = self.goal.limits
        frequency = float(self.values.get("drive.frequency", self.start.drive.frequency))
        begin = max(self.scenario.window[1] - _PERIODS / frequency, 0.0)
        record: dict[str, Value] = {"record.fields": "all", "record.from": begin}
        run = simulate(self.scenario.replace({**record, RECORD_RATE: _SAMPLES * frequency}))
        asked = drive_waveform(self.scenario)
        voltages = asked.voltages(np.minimum(run.t, asked.duration))
        fields = 1e3 * np.array([run.bx, run.by, run.bz])
        with matplotlib.rc_context(RC):
            figure = Picture(figsize=(8.4, 4.4), layout="constrained")
            volts, field = figure.subplots(2, 1, sharex=True)
            for name, values, colour in zip(COIL_NAMES, voltages.T, _COIL_COLOURS, strict=True):
                if values.any():
                    volts.plot(run.t, values, color=colour, label=f"coil {name}")
            for axis, values, dashes in zip("xyz", fields, ("-", ":", "--"), strict=True):
                if axis != "y" or values.any():
                    field.plot(run.t, values, dashes, color=palette.GREEN, label=f"$B_{axis}$")
            size: Any = {"color": palette.BLACK, "linewidth": 0.8, "label": "$|B|$"}
            field.plot(run.t, np.linalg.norm(fields, axis=0), **size)
            _finish(volts, "voltage\nasked for (V)", [-1.0, 1.0], limits.get("voltage_max"))
            _finish(field, "field (mT)", [1e3], limits.get("field_max"))
            field.set_xlabel("time (s)")
            figure.align_ylabels([volts, field])
        return figure


def _finish(axes: Axes, label: str, factors: Sequence[float], limit: float | None) -> None:
    """Label axes, and draw a limit, if there is one, times some factors."""
    handles = list(axes.get_lines())
    for factor in factors if limit is not None else ():
        look: Any = {"color": palette.VERMILION, "linestyle": ":", "label": "limit"}
        line = axes.axhline(factor * (limit or 0.0), **look)
    axes.set_ylabel(label)
    legend_above(axes, handles if limit is None else [*handles, line])
