"""A diagnosis in sentences: the headline, and the lines that the command prints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stickslip._util.plain_text import printable
from stickslip.diagnosis.data.conditions import Conditions, changes
from stickslip.diagnosis.inference.experiment_design import Experiment, advice, undecided
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import runner_up, set_members
from stickslip.diagnosis.report.cause_words import against, rounded
from stickslip.diagnosis.report.parameters import extended_parameters, short
from stickslip.facts import Fact

if TYPE_CHECKING:
    from pandas import DataFrame

_LISTED = 6
"""Candidates that the headline names. Chosen: more are not read."""


def headline(found: Findings) -> str:
    """The verdict in one sentence, and in a second one if there is no certain gain."""
    text, gain = _verdict(found), found.gain
    if gain is not None and gain.interval[1] < 0.0:
        text += f" But it predicts {len(gain.held_out)} held-out conditions worse: chi-square per "
        text += f"condition is {gain.chi2_before:.1f} before and {gain.chi2_after:.1f} after."
    elif gain is not None and gain.interval[0] <= 0.0:
        text += f" On {len(gain.held_out)} held-out conditions the gain is not certain: its "
        text += "interval includes 0."
    return text


def _verdict(found: Findings) -> str:
    verdict = found.verdict
    if verdict.kind == "none":
        return "Nothing beyond the recalibrated model can be seen in these data."
    if verdict.kind == "unexplained":
        text = "Something is there that no cause that was tried and no pair of them explains."
        shape = found.free_shape
        return text + (f" A law of another shape does: {shape.hook.name}." if shape else "")
    if verdict.kind == "data-problem":
        return f"The data do not allow a diagnosis. {verdict.reasons[0]}"
    both = " and ".join(verdict.causes)
    if verdict.kind == "named":
        return f"The data point to {both}: {_sizes(found)}."
    if verdict.kind == "pair":
        return f"The data point to two causes together, {both}: {_sizes(found)}."
    count = 1 if verdict.fit is None else len(verdict.fit.candidate.causes)
    if verdict.fit is not None and len(verdict.causes) == count:
        best = "is the best candidate" if count == 1 else "are the best pair"
        return f"{both} {best}, but this is not certain. {verdict.reasons[0]}"
    first, more = ", ".join(verdict.causes[:_LISTED]), len(verdict.causes) - _LISTED
    which = "Two of these together" if count > 1 else "One of these"
    end = f" and {more} more." if more > 0 else "."
    return f"{which}, and these data cannot say which: {first}{end}"


def _sizes(found: Findings) -> str:
    """The fitted parameters with their errors; of a constant, how far it is from the stated."""
    stated = {each.name: float(each.prior.value(0.0)) for each in found.problem.uncertain}
    said = []
    for name, each in extended_parameters(found).items():
        value, unit = float(each["value"]), str(each["unit"])
        text = f"{short(name)} = {rounded(value, float(each['sd']))}"
        text += "" if unit == "-" else f" {unit}"
        if name in stated:
            text += f", {against(value, stated[name])}"
        said.append(text)
    return ", ".join(said)


def verdict_lines(found: Findings, left_out: Sequence[Fact]) -> list[str]:
    """The verdict and its reasons, what was left out, and the held-out improvement."""
    reasons = () if found.verdict.kind == "data-problem" else found.verdict.reasons
    second = runner_up(found)
    lines = [printable(f"{found.verdict.kind}: {headline(found)}")]
    lines += [f"  {fact}" for fact in (*reasons, *([second] if second else []), *found.notes)]
    lines += [f"  left out: {fact}" for fact in left_out]
    if found.open_set is not None:
        lines += [f"  {fact}" for fact in found.open_set.facts()]
    if found.gain is not None:
        lines.append(
            f"  chi-square per condition, {len(found.gain.held_out)} held out: "
            f"{found.gain.chi2_before:.1f} recalibrated, {found.gain.chi2_after:.1f} extended"
        )
    return lines


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
