"""The drives that ``stickslip diagnose --next`` proposes, in a table that is filled in and read."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pandas import DataFrame

from stickslip._util.cells import text_lines
from stickslip._util.columns import Source, read_table
from stickslip._util.files import text_writer, write_together
from stickslip._util.messages import shown
from stickslip._util.text import counted
from stickslip._util.units import handy
from stickslip.diagnosis.decision.experiments import Experiment
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.report.files import JSON
from stickslip.diagnosis.terms.amounts import amount
from stickslip.errors import ScenarioError
from stickslip.walker.experiments import advice, prediction_table, setting_columns
from stickslip.walker.read_velocity import unmeasured, velocities
from stickslip.walker.reading import Measurement

TABLES = TABLE, PREDICTIONS = "next.csv", "next-predictions.csv"


@dataclass(frozen=True)
class Rounds:
    """How far the experiments of a folder have come.

    One round proposes `most` experiments at most; `budget` is how many may be measured in all.
    `measured` is how many of the table have been, `trials` how many of their trials are used.
    """

    folder: Path
    most: int
    budget: int
    measured: int = 0
    trials: int = 0

    def proposed(self, facts: Facts) -> list[Experiment]:
        """The next conditions to measure, within the budget."""
        return facts.worth_measuring(max(min(self.most, self.budget - self.measured), 0))

    def write(self, facts: Facts) -> None:
        """Write both tables, if something is proposed; what was filled in stays as it is."""
        experiments = self.proposed(facts)
        if not experiments or not isinstance(facts.measurement, Measurement):
            return
        path = self.folder / TABLE
        predictions = prediction_table(facts.measurement, experiments)
        texts = {
            path: _below_what_was_measured(path, facts.trial_table(experiments)),
            self.folder / PREDICTIONS: predictions.to_csv(index=False, float_format="%.6g"),
        }
        write_together({path: text_writer(text) for path, text in texts.items()})

    def lines(self, facts: Facts) -> list[str]:
        """Lines on what was read, whether the name is safe, and else what to measure and why."""
        path, experiments, lines = self.folder / TABLE, self.proposed(facts), []
        read, wanted, budget = (
            counted(n, "experiment") for n in (self.measured, len(experiments), self.budget)
        )
        if self.measured:
            lines.append(f"  read from {path}: {self.trials} trials of {read}")
        lines.append(f"  {facts.next_step}")
        if experiments:
            lines += [
                f"  to measure: {wanted}, in {path}; {self.measured} of at most {self.budget} "
                "measured",
                "    Fill in its column velocity (m/s), and run this command again.",
            ]
        elif facts.next_step.code == "no-safe-name":
            why = "none that was tried would decide anything."
            if self.measured >= self.budget:
                more = self.measured + self.most
                why = f"the budget of {budget} is used up; --budget {more} allows more."
            lines.append(f"  no drive is in {path}: {why}")
        factor, unit = handy("m/s")
        for number, experiment in enumerate(experiments, start=1):
            expected = "; ".join(
                f"{amount(factor * row['velocity'], factor * row['sd'], unit)} with "
                f"{facts.words.title(name)}"
                for name, row in experiment.predictions.items()
            )
            lines += [f"  {number}. {experiment}", f"     expected: {expected}"]
        causes = facts.verdict.causes if facts.verdict.kind == "ambiguous" else ()
        notes = advice({name: facts.words.title(name) for name in causes}, experiments)
        return lines + [f"  beside the drive: {note}" for note in notes]

    def as_dict(self, facts: Facts) -> dict[str, Any]:
        """The key `next` of ``--json``."""
        experiments = self.proposed(facts)
        return {
            "safe": facts.next_step.code == "name-safe",
            "why": str(facts.next_step),
            "proposed": len(experiments),
            "measured": self.measured,
            "budget": self.budget,
            "table": str(self.folder / TABLE) if experiments else None,
        }


def with_measured(
    data: Measurement, folder: Path, most: int, budget: int
) -> tuple[Measurement, Rounds]:
    """The measurement with what was filled in since the last round, and how far this has come.

    A ScenarioError if the table is of another measurement, or lacks a column.
    """
    path = folder / TABLE
    if not path.exists():
        return data, Rounds(folder, most, budget)
    try:
        name = json.loads((folder / JSON).read_bytes())["name"]
    except (OSError, ValueError, KeyError, TypeError):  # no report, or none that says
        name = data.name
    if name != data.name:
        raise ScenarioError(
            f"{path} is of another measurement, {shown(name)}, by the report beside it: "
            "allowed is a folder --out for each measurement"
        )
    table = read_table(path, velocities().requiring(setting_columns(data)))
    if len(unmeasured(table)) == len(table):
        return data, Rounds(folder, most, budget)
    data = data.with_velocities(table)
    new = data.velocity[-1]
    return data, Rounds(folder, most, budget, len(new.conditions), len(new.velocity))


def _below_what_was_measured(path: Path, trials: DataFrame) -> str:
    """The text of the table: its lines without those that were not measured, and new ones below.

    Comments stay, and so do lines in SI units between commas.
    """
    if not path.exists():
        return str(trials.to_csv(index=False))
    source, recipe = Source(path), velocities()
    table, file = source.read(recipe), source.csv(recipe.names)
    columns = table.columns
    empty, rows = {*unmeasured(table)}, {line: k for k, line in enumerate(table.lines)}
    as_it_is = len(file.header) == len(columns) and file.separator == "," and all(
        column.what.per == 1.0 for column in columns.values())  # fmt: skip
    kept = [_csv([[*columns]])]
    for number, line in enumerate(text_lines(source.data), start=1):
        k = rows.get(number, -1)
        if k >= 0 and k not in empty:
            cells = [column.written(k) for column in columns.values()]
            kept.append(line if as_it_is else _csv([cells]))
        elif line.lstrip().startswith("#") and number != file.line:
            # Between commas it must not look like a row.
            alike = line.count(",") + 1 == len(columns)
            kept.append(line.replace(",", ";") if alike else line)
    return "\n".join([*kept, _csv(trials.reindex(columns=[*columns])), ""])


def _csv(rows: Any) -> str:
    text = DataFrame(rows).to_csv(index=False, header=False, lineterminator="\n")
    return str(text).rstrip("\n")
