"""The verdict, its reasons, and how sure it is."""

from __future__ import annotations

import math
from typing import TypedDict

from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.decision.verdict import LOOKS, Kind


class Numbers(TypedDict):
    verdict: Kind
    """One of <verdict>."""
    cause: str | list[str] | None
    """The name for `named` and `dominant`; a list for `pair` and `ambiguous`; else null."""
    reasons: list[str]
    """Sentences on what the verdict rests on."""
    looks: list[str]
    """Sentences on what nobody listed: what it looks like, or which scale is off."""
    data_problem: list[str]
    """For `data-problem`: what the check compares, how large the finding is, what to do."""
    probabilities: dict[str, float]
    """Probability of each cause that it is in the model, and of `none`. A pair counts for each."""
    tests: dict[str, float]
    """The two parts of `p_value`: `lack_of_fit` and `score`."""
    share: float | None
    """Part of the model's squared error that the cause takes, 0 to 1; null without a leader."""
    partial: bool
    """Whether a discrepancy is left beside the model of the verdict."""
    members: list[str]
    """Candidates of the set, of another verdict the most probable ones with 95 %."""
    common: list[str]
    """Causes in all members, in words."""
    beside: list[str]
    """Further causes of each member, in words."""
    unproven: bool
    """Whether held-out readings do not prove a second cause."""


def numbers(facts: Facts) -> Numbers:
    verdict, words = facts.verdict, facts.words
    test, part = facts.findings.test, verdict.share
    only = verdict.causes[0] if verdict.kind in ("named", "dominant") else None
    refused = not facts.fitted and bool(verdict.reasons)
    return {
        "verdict": verdict.kind,
        "cause": only or list(verdict.causes) or None,
        "reasons": list(map(words.note, verdict.reasons)),
        "looks": [words.note(note) for note in verdict.reasons if note.code in LOOKS],
        "data_problem": words.data_problem(verdict.reasons[0]) if refused else [],
        "probabilities": dict(verdict.probabilities),
        "tests": {"lack_of_fit": test.lack_of_fit, "score": test.score},
        "share": None if part is None or math.isnan(part) else part,
        "partial": verdict.partial, "members": [fit.name for fit in verdict.members],
        "common": [words.title(name) for name in verdict.common], "beside": _beside(facts),
        "unproven": any(note.code == "second-cause-predicts-nothing" for note in verdict.reasons),
    }  # fmt: skip


def _beside(facts: Facts) -> list[str]:
    """Causes of each member of a set beside those that all of them have."""
    common, members = frozenset(facts.verdict.common), facts.verdict.members
    nothing = "nothing else" if common else facts.words.title("none")
    texts = []
    for fit in members:
        names = sorted(fit.names - common)
        alone = not common and names and any(fit.names < other.names for other in members)
        text = " with ".join(map(facts.words.title, names)) or nothing
        texts.append(f"{text} alone" if alone else text)
    return texts
