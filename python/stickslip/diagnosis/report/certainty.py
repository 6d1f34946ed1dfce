"""How sure a verdict is: probabilities, odds, and what noise would do."""

from __future__ import annotations

import math

from stickslip.diagnosis.fit.goodness import ADEQUATE, adequacy
from stickslip.diagnosis.inference.cross_validation import Gain
from stickslip.diagnosis.inference.detection import ALPHA
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.open_set import BAND, OpenSet
from stickslip.diagnosis.inference.probabilities import prior_probabilities
from stickslip.diagnosis.inference.ranking import runner_up
from stickslip.diagnosis.inference.verdict import MARGIN
from stickslip.diagnosis.report.cause_words import in_plain_words, meanings_of, plain_name
from stickslip.facts import Code, Fact

_REASONS = 2
"""Reasons of a set that are told beside its probabilities. Chosen: the others are folded."""


def sure_of(found: Findings, listed: int) -> tuple[Fact, ...]:
    """Facts about how sure the verdict is; of a set the first `listed` causes are told."""
    verdict = found.verdict
    if verdict.kind == "data-problem":
        return (Fact(Code.SURE_OF_REFUSAL, {}),)
    chance = {"p_value": found.detection.p_value}
    if verdict.kind == "none":
        before = prior_probabilities(found.problem)["none"]
        none = {"probability": verdict.probabilities["none"], "before": before, "level": ALPHA}
        return (Fact(Code.SURE_OF_NOTHING, {**chance, **none}),)
    misfit = Fact(Code.SURE_OF_MISFIT, chance)
    if verdict.fit is None:
        if found.free_shape is None:
            return (misfit, *(in_plain_words(found, each) for each in verdict.reasons[:1]))
        law = {"lead": found.free_shape.lead, "band": 100.0 * BAND}
        return (misfit, Fact(Code.SURE_OF_LAW, law), *_next_law(found.open_set), *_rest(found))
    meanings = meanings_of(found)
    fields = {
        "names": [plain_name(each, meanings) for each in verdict.causes[:listed]],
        "probabilities": [verdict.probabilities[each] for each in verdict.causes[:listed]],
        "count": len(found.problem.causes),
    }
    if verdict.kind == "pair":
        # Of a pair, half the probability is counted for each.
        both = sum(verdict.probabilities[each] for each in verdict.causes)
        fields |= {"names": [verdict.fit.name], "probabilities": [min(both, 1.0)]}
    said = [Fact(Code.SURE_OF_CAUSE, fields)]
    if verdict.kind == "ambiguous":
        said += [_why_open(in_plain_words(found, each)) for each in verdict.reasons[:_REASONS]]
    facts = [runner_up(found), *verdict.reasons]
    second = next((each for each in facts if each and each.code is Code.RUNNER_UP), None)
    if second is not None:
        name = plain_name(str(second.fields["name"]), meanings)
        if verdict.kind == "pair" and second.fields["name"] in verdict.causes:
            name += " alone"
        said.append(Fact(Code.SURE_OF_RUNNER_UP, {"name": name, "lead": second.fields["lead"]}))
    return (*said, misfit, *_rest(found))


def _next_law(laws: OpenSet | None) -> tuple[Fact, ...]:
    """How far the next law that explains the data is behind; close ones are told elsewhere."""
    if laws is None or laws.rivals:
        return ()
    others = [each for each in laws.shapes[1:] if each.p_value >= ADEQUATE]
    return tuple(
        Fact(
            Code.SURE_OF_RUNNER_UP,
            {"name": f"a law of {each.term.name}", "lead": laws.first.lead - each.lead},
        )
        for each in others[:1]
    )


def _why_open(reason: Fact) -> Fact:
    """Why nothing is named; the sentence before it has the names of the set, and its numbers."""
    if reason.code is Code.ALIKE:
        return Fact(Code.SURE_OF_ALIKE, {})
    if reason.code is Code.NOT_SEPARATED:
        return Fact(Code.SURE_OF_CLOSE, {"odds_needed": math.exp(MARGIN)})
    return reason


def gain_of(found: Findings) -> Gain | None:
    """What was gained on held-out conditions, by a cause or by a law of another shape."""
    if found.free_shape is not None and found.open_set is not None:
        return found.open_set.gain
    return found.gain


def _rest(found: Findings) -> tuple[Fact, ...]:
    """That the extended model leaves more than noise explains, where it does."""
    gain, said = gain_of(found), []
    if gain is not None and gain.p_value < ALPHA:
        held_out = {"where": "on what the fit has not seen", "p_value": gain.p_value}
        said.append(Fact(Code.SURE_OF_REST, {**held_out, "level": ALPHA}))
    if found.extended is not None:
        p_value = adequacy(*found.extended)
        if p_value < ADEQUATE:
            fitted = {"where": "after the fit", "p_value": p_value, "level": ADEQUATE}
            said.append(Fact(Code.SURE_OF_REST, fitted))
    return tuple(said)
