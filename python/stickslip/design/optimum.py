"""What an optimisation found."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from stickslip._util import units
from stickslip._util.files import text_writer, write_together
from stickslip._util.text import OneLine
from stickslip.design.design_space import DesignSpace
from stickslip.design.goal import Goal, Judged, judge
from stickslip.design.landscape import Kind, Slice
from stickslip.scenario.keys import RECORD_RATE, Value, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.toml_file import scenario_text
from stickslip.simulation.note import shown_lines
from stickslip.simulation.run import Run
from stickslip.simulation.simulate import simulate

BEST, VOLTAGES, MAP, PAGE = FILES = "best.toml", "best.csv", "best.map.json", "report.html"
"""Names of the files of `Optimum.save_report`; the voltages are there with a free waveform only."""

ACTIVE = 0.02
"""Part of a limit up to which its figure counts as at it; chosen."""


_FEW = 6  # names on a line; chosen

Origin = Literal["search", "sawtooth"]


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
        Words and numbers that were free, by name; knots are volts. Of a sawtooth that is taken
        beside a free waveform all its keys.
    space : DesignSpace
        What was free.
    goal : Goal
    origin : {"search", "sawtooth"}
        Whose drive is the best: that of the search, or the reference sawtooth, which was better.
    moves : int
        Neighbours that were better and taken, one after another.
    judged : Judged
        The best in the draws of the search, which favour it.
    fresh : dict of Judged
        ``"start"``, ``"search"``, ``"sawtooth"`` and ``"best"`` in fresh draws; without the search
        where its drive is the best, without the sawtooth where there is none, and empty after
        Ctrl-C twice.
    sawtooth : dict or None
        The reference sawtooth by its keys, the best of a grid; None where none satisfies the
        limits, the start is a program of voltages, or Ctrl-C came before.
    slices : list of Slice
        The landscape about the best; empty after Ctrl-C, or of a sawtooth beside a free waveform.
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
    origin: Origin
    moves: int
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

    @functools.cached_property
    def run(self) -> Run:
        """A run of the best drive at the middle of what is uncertain, without a record."""
        return simulate(self.scenario.replace({RECORD_RATE: "none"}))

    @property
    def findings(self) -> list[str]:
        """What a reader should know of how the drive was found, a line each."""
        lines = []
        if self.origin == "sawtooth":
            lines.append("the best sawtooth of the grid is better than the search")
        if self.moves:
            times = f", {self.moves} times" if self.moves > 1 else ""
            lines.append(f"a neighbour is better within the limits, and is taken{times}")
        return lines + ([self.beyond] if self.beyond else [])

    @property
    def beyond(self) -> str:
        """Where the best drive is beyond its limits, in one line; empty if nowhere."""
        found = {"the run at the middle": judge(self.goal, [self.run])}
        if "best" in self.fresh:
            best = self.fresh["best"]
            found[f"{best.exceeding} of {len(best.figures)} fresh draws"] = best
        found = {where: judged for where, judged in found.items() if judged.exceeding}
        if not found:
            return ""
        whole = [each for each in found.values() if not each.failed]
        worst = {
            name: max(each.worst[name] for each in whole) for name in self.goal.limits if whole
        }
        passed = self.goal.passed(worst) + ["a simulation fails"] * (len(whole) < len(found))
        return f"beyond the limits in {' and '.join(found)}: {', '.join(passed)}"

    @property
    def drive_lines(self) -> list[str]:
        """The values of the best drive, a line for each key and for the knots of each coil."""
        knots: dict[str, list[str]] = {}
        lines = []
        for name, value in self.values.items():
            coil, _, number = name.partition(" ")
            if number:
                knots.setdefault(coil, []).append(f"{value:.4g}")
            elif isinstance(value, str):
                lines.append(f"{name} = {value}")
            else:
                unit = units.unit_label(known_keys()[name].unit)
                lines.append(f"{name} = {value:.6g} {unit}".rstrip())
        return lines + [f"{coil} = {' '.join(each)} V" for coil, each in knots.items()]

    def summary(self) -> str:
        """What was found, in some lines."""
        goal, unit = self.goal, self.goal.unit
        best = "largest" if goal.sign > 0.0 else "least"
        lines = [f"{best} {goal.figure} found, {goal.score} of the draws, {unit}:"]
        lines.append(f"  {'best':<9} {self.judged.score:.6g} on {self.draws} draw(s) of the search")
        for name in ("start", "sawtooth", "search", "best"):
            if name in self.fresh:
                lines.append(f"  {name:<9} {self._on_fresh(self.fresh[name])}")
        if self.sawtooth is None:
            lines.append("  no sawtooth to compare with")
        lines += [f"  {line}" for line in self.findings]
        lines.append("the best drive:")
        flight = f"in flight {100.0 * self.run.numbers['airborne_fraction']:.3g} % of the time"
        shown = (*self.drive_lines, flight, *shown_lines(self.run.notes))
        if self.origin == "sawtooth" and self.space.periodic is not None:
            lines.append(f"  a sawtooth, written as voltages ({VOLTAGES})")
        lines += [f"  {line}" for line in shown]
        lines.append("its limits, in every draw of the search:")
        for name, worst in self.judged.worst.items():
            active = ", active" if name in self.active else ""
            lines.append(f"  {goal.beside_limit(name, worst)}{active}")
        for kind in get_args(Kind):
            names = [each.axis.name for each in self.slices if each.kind == kind]
            if names:  # plateaus ask for no care: many of them need no names
                many = kind == "plateau" and len(names) > _FEW
                told = f"{len(names)} numbers" if many else ", ".join(names)
                lines.append(f"  on a {kind}: {told}")
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
            "origin": self.origin,
            "moves": self.moves,
            "beyond_limits": self.beyond or None,
            **{name: self.run.summary()[name] for name in ("airborne_fraction", "notes")},
            "search": self._judged(self.judged),
            "fresh": {name: self._judged(each) for name, each in self.fresh.items()},
            "sawtooth": self.sawtooth,
            "limits": dict(self.goal.limits),
            "default_limits": list(self.goal.assumed),
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
        from stickslip.design.optimum_page import page_text
        from stickslip.field.map_files import map_text
        from stickslip.scenario.waveform_csv import write_rows

        folder = Path(out)
        writers = {
            folder / BEST: text_writer(
                (f"# {self.beyond}\n" if self.beyond else "")
                + scenario_text(self.scenario, VOLTAGES, MAP)
            ),
            folder / PAGE: text_writer(page_text(self)),
        }
        program = self.scenario.drive.program
        if program is not None:
            writers[folder / VOLTAGES] = functools.partial(write_rows, program)
        if self.scenario.coil.map is not None:
            writers[folder / MAP] = text_writer(map_text(self.scenario.coil.map))
        folder.mkdir(parents=True, exist_ok=True)
        write_together(writers)
