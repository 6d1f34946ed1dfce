"""Next steps: whether the name is safe, and what to measure."""

from __future__ import annotations

from typing import Any, TypedDict

from stickslip.diagnosis.decision.experiments import Experiment
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.terms import amounts


class Numbers(TypedDict):
    next: str
    """A sentence: whether the name is safe."""
    left: float | None
    """For `none`: the probability that a cause is there all the same, from 0.1 on; else null."""
    next_experiments: list[dict[str, Any]]
    """For `ambiguous`: up to three `{drive, words, why, separation, predictions, predicted}`, the
    best first, `words` and `predicted` for readers."""
    advice: list[str]
    """Further measurements, in sentences."""


def numbers(facts: Facts) -> Numbers:
    step, verdict, rivals = facts.next_step, facts.verdict, facts.rivals
    proposes = verdict.kind == "ambiguous" and rivals.proposes
    experiments = facts.propose_experiments() if proposes else []
    names = {name: facts.words.title(name) for name in verdict.causes}
    return {
        "next": str(step),
        "left": step.value if step.code == "cause-left" else None,
        "next_experiments": [_row(facts, experiment) for experiment in experiments],
        "advice": list(map(str, rivals.advice(names, experiments) if proposes else [])),
    }


def _row(facts: Facts, experiment: Experiment) -> dict[str, Any]:
    factor, unit = facts.problem.tables[facts.rivals.table].shown_unit(0)
    predicted = []
    for name, row in experiment.predictions.items():
        value, sd = (factor * one for one in row.values())
        predicted.append(f"{facts.words.title(name)} {amounts.amount(value, sd, unit)}")
    return {
        "drive": dict(experiment.drive), "why": facts.words.note(experiment.why),
        "separation": experiment.separation, "words": experiment.words,
        "predictions": {name: dict(row) for name, row in experiment.predictions.items()},
        "predicted": predicted,
    }  # fmt: skip
