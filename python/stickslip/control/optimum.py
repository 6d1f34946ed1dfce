"""What an optimisation found."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from stickslip._util.atomic_files import text_writer, write_together
from stickslip._util.one_line import OneLine
from stickslip.control.design_space import DesignSpace
from stickslip.control.goal import FIGURES, Goal, Judged
from stickslip.control.landscape import NEAR, PLATEAU, Slice
from stickslip.scenario.keys import Value
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.toml_file import scenario_text

BEST, VOLTAGES, MAP, PAGE = FILES = "best.toml", "best.csv", "best.map.json", "report.html"
"""Names of the files of `Optimum.save_report`; the voltages are there with a free waveform only."""

ACTIVE = 0.02
"""Part of a limit up to which its figure counts as at it; chosen."""


class SearchInterrupted(KeyboardInterrupt):
    """Ctrl-C in an optimisation.

    Attributes
    ----------
    best : Optimum or None
        The best that was found until then; None where no drive within the limits was.
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
    """What an optimisation found. SI units.

    Attributes
    ----------
    scenario : Scenario
        The best drive.
    start : Scenario
        What the search began with.
    values : dict
        Words and numbers that were free, by name; knots are volts.
    space : DesignSpace
        What was free.
    goal : Goal
    judged : Judged
        The best in the draws of the search, which favour it.
    fresh : dict of Judged
        ``"start"``, ``"sawtooth"`` and ``"best"`` in fresh draws; without the sawtooth where there
        is none, and empty after Ctrl-C twice.
    sawtooth : dict or None
        The reference sawtooth by its keys, the best of a grid; None where none satisfies the
        limits, the start is a program of voltages, or Ctrl-C came before.
    slices : list of Slice
        The landscape about the best, in draws that chose nothing; empty after Ctrl-C.
    draws, runs : int
        Draws in the search, and its simulations.
    seed : int
    interrupted : bool
        Whether Ctrl-C ended it.
    seconds : float
        What it took, s.
    """

    scenario: Scenario
    start: Scenario
    values: dict[str, Value]
    space: DesignSpace
    goal: Goal
    judged: Judged
    fresh: dict[str, Judged]
    sawtooth: dict[str, Value] | None
    slices: list[Slice]
    draws: int
    runs: int
    seed: int
    interrupted: bool
    seconds: float

    @property
    def frequency(self) -> float:
        """Periods a second of the best drive, Hz; of a program that was given it is not known."""
        return float(self.values.get("drive.frequency", self.start.drive.frequency))

    @property
    def active(self) -> list[str]:
        """Figures whose greatest value in the search's draws is within `ACTIVE` of its limit."""
        return [
            name
            for name, limit in self.goal.limits.items()
            if limit - self.judged.worst[name] <= ACTIVE * abs(limit)
        ]

    @property
    def at_ends(self) -> list[Slice]:
        """Free numbers that are best at an end of their range."""
        return [each for each in self.slices if each.at_end]

    @property
    def beaten(self) -> bool:
        """Whether the reference sawtooth is better on fresh draws than the best of the search."""
        if "sawtooth" not in self.fresh:
            return False
        ahead = self.fresh["sawtooth"].score - self.fresh["best"].score
        return self.goal.sign * ahead > 0.0

    def summary(self) -> str:
        """What was found, in some lines."""
        goal, unit = self.goal, self.goal.unit
        best = "largest" if goal.sign > 0.0 else "least"
        lines = [f"{best} {goal.figure} found, {goal.score} of {self.draws} draw(s), {unit}:"]
        lines.append(f"  search    {self.judged.score:.6g}")
        for name in ("start", "sawtooth", "best"):
            if name in self.fresh:
                lines.append(f"  {name:<9} {self._on_fresh(self.fresh[name])}")
        if self.sawtooth is None:
            lines.append("  no sawtooth to compare with")
        if self.beaten:
            lines.append("  the sawtooth is better than the best that the search found")
        for name, limit in goal.limits.items():
            worst = self.judged.worst[name]
            active = ", active" if name in self.active else ""
            lines.append(f"  {name} {worst:.6g} of {limit:.6g} {FIGURES[name].unit}{active}")
        if self.slices:
            peaks = [each.axis.name for each in self.slices if each.kind == "peak"]
            shown = ", ".join(peaks) or "none"
            step, cost = 100.0 * NEAR, 100.0 * PLATEAU
            lines.append(f"  a change of {step:g} % of its range costs over {cost:g} %: {shown}")
        lines.append(f"  {self.runs} runs of the search, seed {self.seed}, {self.seconds:.0f} s")
        return "\n".join(lines)

    def _on_fresh(self, judged: Judged) -> str:
        count = len(judged.figures)
        passed = f", {judged.exceeding} of them exceed a limit or fail" if judged.exceeding else ""
        return f"{judged.score:.6g} on {count} fresh draw(s){passed}"

    def as_dict(self) -> dict[str, Any]:
        """The result of plain types, as ``stickslip optimise --json`` prints it."""
        return {
            "figure": self.goal.figure,
            "unit": self.goal.unit,
            "maximise": self.goal.sign > 0.0,
            "score": self.goal.score,
            "values": self.values,
            "search": self._judged(self.judged),
            "fresh": {name: self._judged(each) for name, each in self.fresh.items()},
            "sawtooth": self.sawtooth,
            "limits": dict(self.goal.limits),
            "active": self.active,
            "landscape": [
                {
                    "name": each.axis.name,
                    "unit": each.axis.unit,
                    "best": each.best,
                    "kind": each.kind,
                    "loss": each.loss,
                    "at_end": each.at_end,
                    "values": each.values.tolist(),
                    "scores": each.scores.tolist(),
                    "feasible": each.feasible.tolist(),
                }
                for each in self.slices
            ],
            "draws": self.draws,
            "runs": self.runs,
            "seed": self.seed,
            "interrupted": self.interrupted,
            "seconds": self.seconds,
        }

    def _judged(self, judged: Judged) -> dict[str, Any]:
        return {
            "score": judged.score,
            "mean": float(np.mean(judged.figures)),
            "worst": float(np.min(self.goal.sign * judged.figures) * self.goal.sign),
            "draws": len(judged.figures),
            "exceeding": judged.exceeding,
            "limited": judged.worst,
        }

    @property
    def files(self) -> tuple[str, ...]:
        """Names of the files that `save_report` writes."""
        parts = {VOLTAGES: self.scenario.drive.program, MAP: self.scenario.coil.map}
        return tuple(name for name in FILES if parts.get(name, name) is not None)

    def save_report(self, out: str | PathLike[str]) -> None:
        """Write the best drive and one HTML page into the folder `out`, which is made: all or none.

        ``best.toml`` is an ordinary scenario, ``best.csv`` the voltages of a free waveform,
        ``best.map.json`` the field of ``coil.map``, if there is one, and ``report.html`` needs no
        other file.

        Raises
        ------
        OSError
            If a file cannot be written.
        """
        from stickslip.control.optimum_page import page_text
        from stickslip.scenario.map_files import map_text
        from stickslip.scenario.waveform_csv import write_rows

        folder = Path(out)
        writers = {
            folder / BEST: text_writer(scenario_text(self.scenario, VOLTAGES, MAP)),
            folder / PAGE: text_writer(page_text(self)),
        }
        program = self.scenario.drive.program
        if program is not None:
            writers[folder / VOLTAGES] = functools.partial(write_rows, program)
        if self.scenario.coil.map is not None:
            writers[folder / MAP] = text_writer(map_text(self.scenario.coil.map))
        folder.mkdir(parents=True, exist_ok=True)
        write_together(writers)
