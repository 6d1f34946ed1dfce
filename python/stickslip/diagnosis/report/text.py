"""A diagnosis as lines of text: what the command prints, and what `Diagnosis.summary` adds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stickslip.diagnosis.data.conditions import Conditions, changes
from stickslip.diagnosis.inference.experiment_design import Experiment, advice, undecided
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import runner_up
from stickslip.diagnosis.report.messages import headline
from stickslip.facts import Fact

if TYPE_CHECKING:
    from pandas import DataFrame


def verdict_lines(found: Findings, left_out: Sequence[Fact]) -> list[str]:
    """The verdict and why it is no bolder one, what was left out, and the held-out improvement."""
    reasons = () if found.verdict.kind == "data-problem" else found.verdict.reasons
    second = runner_up(found)
    lines = [f"{found.verdict.kind}: {headline(found)}"]
    lines += [f"  {fact}" for fact in (*reasons, *([second] if second else []), *found.notes)]
    lines += [f"  left out: {fact}" for fact in left_out]
    if found.gain is not None:
        lines.append(
            f"  chi-square per condition, {len(found.gain.held_out)} held out: "
            f"{found.gain.chi2_before:.1f} recalibrated, {found.gain.chi2_after:.1f} extended"
        )
    return lines


def experiment_lines(
    found: Findings, experiments: Sequence[Experiment], conditions: Conditions
) -> list[str]:
    """The best experiment, and what to look at beside the drive."""
    lines = []
    for each in experiments[:1]:
        none = undecided(experiments)
        if none is not None:
            lines.append(f"  {none}")
        lines.append(f"  next experiment: {changes(each.drive, conditions)}. {each.why}")
    return lines + [f"  beside the drive: {fact}" for fact in advice(found)]


def table_lines(table: DataFrame, most: int) -> list[str]:
    """The first rows of a table, numbers to four digits."""
    shown = table.head(most).to_string(float_format=lambda value: f"{value:.4g}")
    more = len(table) - most
    return [*shown.splitlines(), *([f"... and {more} more"] if more > 0 else [])]
