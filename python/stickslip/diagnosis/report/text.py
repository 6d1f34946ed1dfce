"""A diagnosis as lines of text: what the command prints, and what `Diagnosis.summary` adds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stickslip.diagnosis.data.conditions import Conditions, changes
from stickslip.diagnosis.inference.experiment_design import Experiment, advice
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import runner_up
from stickslip.diagnosis.report.messages import headline

if TYPE_CHECKING:
    from pandas import DataFrame


def verdict_lines(found: Findings, left_out: Sequence[str]) -> list[str]:
    """The verdict and why it is no bolder one, what was left out, and the held-out improvement."""
    reasons = () if found.verdict.kind == "data-problem" else found.verdict.reasons
    second = runner_up(found)
    lines = [f"{found.verdict.kind}: {headline(found)}"]
    lines += [f"  {line}" for line in (*reasons, *([second] if second else []), *found.notes)]
    lines += [f"  left out: {line}" for line in left_out]
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
        what = f"{changes(each.drive, conditions)}; {each.why}"
        if not each.decides:
            what = f"none that was tried tells the leading rivals apart; the best: {what}"
        lines.append(f"  next experiment: {what}")
    return lines + [f"  beside the drive: {line}" for line in advice(found)]


def table_lines(table: DataFrame, most: int) -> list[str]:
    """The first rows of a table, numbers to four digits."""
    shown = table.head(most).to_string(float_format=lambda value: f"{value:.4g}")
    more = len(table) - most
    return [*shown.splitlines(), *([f"... and {more} more"] if more > 0 else [])]
