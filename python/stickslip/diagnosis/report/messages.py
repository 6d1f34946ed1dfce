"""A diagnosis in lines of text, as the command and a summary print them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stickslip._util.number_text import alike
from stickslip._util.plain_text import printable
from stickslip.diagnosis.data.conditions import Conditions, changes
from stickslip.diagnosis.inference.experiment_design import Experiment, advice, undecided
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import runner_up, set_members
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.cause_words import interval_of
from stickslip.diagnosis.report.errors import gain_unit
from stickslip.diagnosis.report.headline import LISTED, headline
from stickslip.diagnosis.report.parameters import extended_parameters, short
from stickslip.facts import Fact

if TYPE_CHECKING:
    from pandas import DataFrame


def verdict_lines(found: Findings, posed: PosedProblem, left_out: Sequence[Fact]) -> list[str]:
    """The verdict and its reasons, what was left out, and the held-out improvement."""
    reasons = () if found.verdict.kind == "data-problem" else found.verdict.reasons
    second = runner_up(found)
    lines = [printable(f"{found.verdict.kind}: {headline(found, posed, gain_unit(posed))}")]
    lines += [f"  {fact}" for fact in (*reasons, *([second] if second else []), *found.notes)]
    lines += [f"  left out: {fact}" for fact in left_out]
    if found.open_set is not None:
        lines += [f"  {fact}" for fact in found.open_set.facts()]
    if found.gain is not None:
        low, high = found.gain.interval
        sure = "" if low > 0.0 or high < 0.0 else "; the interval of the gain includes 0"
        lines.append(
            f"  chi-square per condition, {len(found.gain.held_out)} held out: "
            f"{found.gain.chi2_before:.1f} recalibrated, {found.gain.chi2_after:.1f} extended{sure}"
        )
    return lines


def parameter_lines(found: Findings) -> list[str]:
    """What is claimed by the keys of files: the causes of a set, and what each of them needs."""
    if found.verdict.fit is None:
        return []
    lines = []
    if found.verdict.kind == "ambiguous":
        lines.append(f"  the set: {', '.join(found.verdict.causes)}")
    entries = extended_parameters(found)
    for name, each in list(entries.items())[:LISTED]:
        low, high = interval_of(found, name, each)
        unit = "" if each["unit"] == "-" else f" {each['unit']}"
        step = min(float(each["sd"]), (high - low) / 4.0)
        value, *ends = alike(step, float(each["value"]), low, high)
        lines.append(f"  {short(name)} = {value}{unit}, with 95 % from {' to '.join(ends)}")
    if len(entries) > LISTED:
        lines.append(f"  and {len(entries) - LISTED} parameters more")
    return [printable(line) for line in lines]


def set_lines(found: Findings) -> list[str]:
    """Of a set: which of its members the parameters and predictions are of, and the others."""
    first, *others = [fit.name for fit in set_members(found)] or [""]
    if not others:
        return []
    said = (
        f"The table, `extended` and `predict` are of {first}, the first of the set; the others "
        f"are {', '.join(others)}."
    )
    return [f"  {printable(said)}"]


def no_gain_lines(found: Findings) -> list[str]:
    """Why there is no held-out improvement, where there is none."""
    if found.gain is not None or found.free_shape is not None:
        return []  # that of a law of a free shape is said with the law
    why = "the conditions are too few to hold some out"
    if found.verdict.fit is None:
        why = "there is no extended model to compare"
    return [f"  no gain on held-out conditions: {why}"]


def experiment_lines(
    found: Findings, experiments: Sequence[Experiment], conditions: Conditions
) -> list[str]:
    """The best experiment, and what to look at beside the drive."""
    none = undecided(experiments)
    lines = [] if none is None else [f"  {none}"]
    lines += [
        f"  next experiment: {changes(each.drive, conditions)}. {each.why}"
        for each in experiments[:1]
    ]
    return lines + [f"  beside the drive: {fact}" for fact in advice(found)]


def four_digits(value: float) -> str:
    """A number as tables show it."""
    return f"{value:.4g}"


def table_lines(table: DataFrame, most: int) -> list[str]:
    """The first rows of a table, numbers to four digits."""
    shown = table.head(most).to_string(float_format=four_digits)
    more = len(table) - most
    return [*map(printable, shown.split("\n")), *([f"... and {more} more"] if more > 0 else [])]
