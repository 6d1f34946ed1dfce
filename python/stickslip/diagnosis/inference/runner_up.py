"""What comes next after what is claimed: the best other explanation, and the best second cause."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from stickslip.diagnosis.fit.fit_result import PAIR_PRICE, Fit, ranked
from stickslip.diagnosis.fit.goodness import ADEQUATE, adequacy
from stickslip.diagnosis.model.problem import Problem
from stickslip.facts import Code, Fact


def rivals(said: Fit, fits: Iterable[Fit]) -> list[Fit]:
    """Candidates without some cause of what is said: what has all and one more says the same."""
    own = set(said.candidate.causes)
    return [fit for fit in fits if not own <= set(fit.candidate.causes)]


def describe_runner_up(problem: Problem, said: Fit, null: Fit, fits: Iterable[Fit]) -> Fact:
    """How the best rival, or the null, compares with what is said.

    By log-evidence after the price of a second cause.
    """
    second = ranked([null, *rivals(said, fits)], priced=True)[0]
    lead = said.priced_evidence - second.priced_evidence
    if lead >= 0.0:
        return Fact(Code.RUNNER_UP, {"name": second.name, "lead": lead})
    return _ahead(problem, second, -lead)


def _ahead(problem: Problem, other: Fit, lead: float) -> Fact:
    if adequacy(problem, other) >= ADEQUATE:
        return Fact(Code.OTHER_LEADS, {"name": other.name, "lead": lead})
    unexplained = {"name": other.name, "lead": lead, "level": ADEQUATE}
    return Fact(Code.OTHER_LEADS_UNEXPLAINED, unexplained)


def second_look(problem: Problem, said: Fit, pairs: Sequence[Fit]) -> tuple[Fact, ...]:
    """What a second cause beside a named one would add at best."""
    beside = [pair for pair in pairs if set(said.candidate.causes) <= set(pair.candidate.causes)]
    if not beside:
        return ()
    (other,) = set(beside[0].candidate.causes) - set(said.candidate.causes)
    lead = beside[0].log_evidence - said.log_evidence
    if lead >= PAIR_PRICE:
        return (_ahead(problem, beside[0], lead - PAIR_PRICE),)
    fields = {"name": said.name, "other": other.name, "lead": lead, "needed": PAIR_PRICE}
    return (Fact(Code.NOTHING_LEFT, fields),)
