"""A diagnosis in sentences."""

from __future__ import annotations

import math

from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.report.parameters import extended_parameters, short

_NAMELESS = {
    "none": "Nothing beyond the recalibrated model can be seen in these data.",
    "unexplained": "Something is there that no cause that was tried and no pair of them explains.",
}

_LISTED = 6


def rounded(value: float, sd: float) -> str:
    """A value and its error, both to the error's second digit."""
    if not (math.isfinite(value) and math.isfinite(sd) and sd > 0.0):
        return f"{value:.3g} +- {sd:.2g}"
    ten = math.floor(math.log10(max(abs(value), sd)))
    ten = 0 if -3 <= ten <= 3 else ten
    places = max(1 - math.floor(math.log10(sd / 10.0**ten)), 0)
    number = f"{value / 10.0**ten:.{places}f} +- {sd / 10.0**ten:.{places}f}"
    return number if ten == 0 else f"({number})e{ten}"


def headline(found: Findings) -> str:
    """The verdict in one sentence, and in a second one if there is no certain gain."""
    verdict = found.verdict
    if verdict.kind in _NAMELESS:
        text = _NAMELESS[verdict.kind]
    elif verdict.kind == "data-problem":
        text = f"The data do not allow a diagnosis. {verdict.reasons[0]}"
    elif verdict.kind == "named":
        text = f"The data point to {verdict.causes[0]}: {_sizes(found)}."
    elif verdict.kind == "pair":
        both = " and ".join(verdict.causes)
        text = f"The data point to two causes together, {both}: {_sizes(found)}."
    elif verdict.fit is not None and len(verdict.causes) == len(verdict.fit.candidate.causes):
        members = " and ".join(verdict.causes)
        best = "is the best candidate" if len(verdict.causes) == 1 else "are the best pair"
        text = f"{members} {best}, but this is not certain. {verdict.reasons[0]}"
    else:
        first, more = verdict.causes[:_LISTED], len(verdict.causes) - _LISTED
        pair = verdict.fit is not None and len(verdict.fit.candidate.causes) > 1
        text = "Two of these together" if pair else "One of these"
        text += f", and these data cannot say which: {', '.join(first)}"
        text += f" and {more} more." if more > 0 else "."
    gain = found.gain
    if gain is not None and gain.interval[1] < 0.0:
        text += f" But it predicts {len(gain.held_out)} held-out conditions worse: chi-square per "
        text += f"condition is {gain.chi2_before:.1f} before and {gain.chi2_after:.1f} after."
    elif gain is not None and gain.interval[0] <= 0.0:
        text += f" On {len(gain.held_out)} held-out conditions the gain is not certain: its "
        text += "interval includes 0."
    return text


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


def against(value: float, stated: float) -> str:
    """A constant compared with what was stated for it."""
    if stated <= 0.0:
        return f"stated as {stated:.3g}"
    ratio = value / stated
    if 0.5 <= ratio <= 2.0:
        way = "above" if ratio >= 1.0 else "below"
        return f"{abs(ratio - 1.0):.0%} {way} the stated {stated:.3g}"
    return f"{ratio:.3g} times the stated {stated:.3g}"
