"""A doubtful cause, two causes at once, or one law of another shape: which of them is claimed."""

from __future__ import annotations

from dataclasses import replace

from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.verdict import MARGIN, Verdict
from stickslip.facts import Code, Fact


def looks_for_laws(found: Findings) -> bool:
    """Whether laws of a free shape have to be looked at: no single cause explains the data well.

    A single cause that leads and is withheld for what speaks against it may be the nearest to a law
    outside the list, and so may two causes together.
    """
    verdict = found.verdict
    doubtful = verdict.kind == "ambiguous" and len(verdict.causes) == 1
    return verdict.kind == "unexplained" or doubtful or _has_pair(verdict)


def judged_beside_laws(found: Findings) -> Findings:
    """The findings, whose causes are not claimed where one law explains the data as well.

    The law has to be one that would be accepted in the place of an unexplained verdict. It takes
    the place of a pair if it leads, of a doubtful single cause if it leads by the margin of a name;
    a pair that leads it by less than that margin is a set.
    """
    shapes, fit = found.open_set, found.verdict.fit
    if shapes is None or not shapes.accepted or fit is None or not looks_for_laws(found):
        return found
    pair = _has_pair(found.verdict)
    lead = fit.priced_evidence - found.null.log_evidence - shapes.first.lead
    if lead >= (MARGIN if pair else -MARGIN):
        return found
    fields = {"law": shapes.first.term.law, "argument": shapes.first.term.argument}
    reason = Fact(Code.LAW_BESIDE_CAUSES, {**fields, "name": fit.name, "lead": lead})
    if lead > 0.0:
        also = found.verdict.reasons if found.verdict.kind == "ambiguous" else ()
        kept = replace(found.verdict, kind="ambiguous", reasons=(reason, *also))
        return replace(found, verdict=kept)
    # What is thought of these causes is thought of something that is not on the list.
    chance = dict(found.verdict.probabilities)
    moved = [cause.name for cause in fit.candidate.causes]
    chance["unknown"] += sum(chance[name] for name in moved)
    chance |= dict.fromkeys(moved, 0.0)
    unexplained = Verdict("unexplained", (), None, (reason,), chance)
    return replace(found, verdict=unexplained, gain=None, profiles=())


def _has_pair(verdict: Verdict) -> bool:
    return verdict.fit is not None and len(verdict.fit.candidate.causes) > 1
