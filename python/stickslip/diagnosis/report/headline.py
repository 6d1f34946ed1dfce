"""The first sentence of a report, which the command prints too: the verdict and what to do."""

from __future__ import annotations

from collections.abc import Sequence

from stickslip.diagnosis.inference.cross_validation import Gain
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.cause_words import (
    Told,
    in_plain_words,
    meanings_of,
    plain_name,
    told,
)
from stickslip.diagnosis.report.certainty import gain_of
from stickslip.diagnosis.report.constants import moved
from stickslip.diagnosis.report.errors import errors_of_gain
from stickslip.facts import Code, Fact

LISTED = 6
"""Candidates that are named. Chosen: more are not read."""

_SURE_P, _SURE_NONE = 0.1, 0.6
"""p-value and probability of no cause from which on nothing is said to be wrong. Chosen: twice the
level at which something is found, and somewhat more than before any data."""

_LIKELIER = 0.5
"""Probability of a set below which it is likelier that nothing of it acts."""


def claimed_by(found: Findings) -> tuple[tuple[Told, ...], ...]:
    """The causes of each candidate that is claimed, or that is in the set."""
    return tuple(told(found, fit) for fit in set_members(found))


def headline(found: Findings, posed: PosedProblem, unit: str) -> Fact:
    """The verdict and what to do in a sentence or two; `unit` is that of what is held out."""
    kind, reasons, claimed = found.verdict.kind, found.verdict.reasons, claimed_by(found)
    if kind == "none":
        return _none(found, posed)
    if kind == "data-problem":
        return Fact(Code.HEADLINE_REFUSED, {"reason": reasons[0]})
    gain = gain_of(found)
    fit = found.verdict.fit
    if fit is not None and all(each.relaxes_prior for each in fit.candidate.causes):
        gain = None  # recalibration has moved a constant most of the way, so it gains little
    gained = improvement(found, posed, gain, unit)
    if kind == "unexplained":
        shape = found.free_shape
        if shape is None:
            count = len(found.problem.causes)
            code = Code.HEADLINE_UNEXPLAINED if count else Code.HEADLINE_NO_CAUSE
            return Fact(code, {"count": count} if count else {})
        law = {"law": shape.term.law, "argument": shape.term.argument}
        return Fact(Code.HEADLINE_LAW, {**law, **gained})
    finding = " ".join(each.finding for each in claimed[0])
    if kind == "ambiguous":
        if len(claimed) == 1 and len(found.verdict.causes) == len(claimed[0]):
            reason = in_plain_words(found, reasons[0])
            return Fact(Code.HEADLINE_PERHAPS, {"finding": finding, "reason": reason})
        return _set(found, claimed)
    remedies = [each.remedy for each in claimed[0] if each.remedy]
    remedy = " and ".join([*remedies[:1], *(_lower(each) for each in remedies[1:])])
    causes = {"causes": len(claimed[0]), "readings": all(each.reading for each in claimed[0])}
    fields = {"finding": finding, "remedy": remedy, **causes, **gained}
    if kind == "pair":
        return Fact(Code.HEADLINE_PAIR, fields)
    return Fact(Code.HEADLINE_NAMED, fields)


def _none(found: Findings, posed: PosedProblem) -> Fact:
    """Nothing was found; it is told softly where the tests or the probability are near a cause."""
    p_value, probability = found.detection.p_value, found.verdict.probabilities["none"]
    is_sure = p_value >= _SURE_P and probability >= _SURE_NONE
    fields = {"p_value": p_value, "probability": probability, "moved": moved(found, posed)}
    return Fact(Code.HEADLINE_NONE if is_sure else Code.HEADLINE_NONE_OPEN, fields)


def _set(found: Findings, claimed: Sequence[Sequence[Told]]) -> Fact:
    """Several candidates, or one and the names that were added to it."""
    names = [" with ".join(each.title for each in causes) for causes in claimed]
    mentioned = {each.name for causes in claimed for each in causes}
    names += [
        plain_name(each, meanings_of(found))
        for each in found.verdict.causes
        if each not in mentioned
    ]
    things = "pairs of causes" if len(claimed[0]) > 1 else "causes"
    more = [f"{len(names) - LISTED} more"] if len(names) > LISTED else []
    listed = [*names[:LISTED], *more]
    # Of a pair, half the probability is counted for each.
    probability = min(sum(found.verdict.probabilities[each] for each in found.verdict.causes), 1.0)
    fields = {"count": len(names), "things": things, "names": listed}
    if probability < _LIKELIER:
        return Fact(Code.HEADLINE_NEAREST, {**fields, "other": 1.0 - probability})
    return Fact(Code.HEADLINE_SET, {**fields, "probability": probability})


def _lower(text: str) -> str:
    return text[:1].lower() + text[1:]


def held_out_thing(posed: PosedProblem) -> str:
    """What one of those is called that are held out."""
    return "reading" if posed.model.observables and not posed.conditions else "condition"


def improvement(
    found: Findings, posed: PosedProblem, gain: Gain | None, unit: str
) -> dict[str, object]:
    """Fields that say what was gained; `count` is None where that was not tested."""
    if gain is None:
        return {"count": None}
    low, high = gain.interval
    change = "falls" if low > 0.0 else "grows" if high < 0.0 else "not sure"
    error = errors_of_gain(found, gain, unit)
    return {
        "count": len(gain.held_out),
        "thing": held_out_thing(posed),
        **error.in_short,
        "change": change,
    }
