"""What a claim has to stand beside the data that the verdict's rules have used."""

from __future__ import annotations

from dataclasses import dataclass, replace

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.distinguishability import alike
from stickslip.diagnosis.fit.fit_result import PAIR_PRICE, Ranking
from stickslip.diagnosis.fit.goodness import ADEQUATE, adequacy
from stickslip.diagnosis.inference.verdict import MARGIN, Verdict
from stickslip.diagnosis.model.problem import Array, Problem
from stickslip.facts import Code, Fact


def checked_on_training_subset(
    problem: Problem, verdict: Verdict, ranking: Ranking, cosines: Array, choice: str, lead: float
) -> Verdict:
    """The verdict beside the candidate that ranks first on the training subset of the conditions.

    It is the first of the fit's rivals there, with as many causes. A cause is not named that is led
    by `MARGIN`, or at all if the two are alike: a smaller lead says that the subset tells nothing
    of the cause, which may act in the others alone. The other candidate joins the set if it
    explains all the data.
    """
    fit = verdict.fit
    fits = [*ranking.singles, *ranking.pairs]
    other = next((each for each in fits if each.name == choice), fit)
    if fit is None or other is None or other.name == fit.name:
        return verdict
    if lead < MARGIN and not alike(problem, cosines, fit.candidate.causes, other.candidate.causes):
        return verdict
    joins = adequacy(problem, other) >= ADEQUATE
    said = Fact(Code.TRAINING_SUBSET, {"name": choice, "joins": joins})
    reasons = (said,) if verdict.kind in ("named", "pair") else (*verdict.reasons, said)
    others = {cause.name for cause in other.candidate.causes} if joins else set()
    also = sorted(others - set(verdict.causes))
    return replace(verdict, kind="ambiguous", causes=(*verdict.causes, *also), reasons=reasons)


@dataclass(frozen=True, repr=False)
class CorrelatedLead(OneLine):
    """Log-evidence of what is claimed above its rival, with the largest correlation of errors.

    The rival of a cause is no cause, that of a pair the best single cause.
    """

    correlation: float
    lead: float


def checked_with_correlation(verdict: Verdict, led: CorrelatedLead | None) -> Verdict:
    """A claim stands if it leads too where errors are as correlated as the interval allows."""
    needed = MARGIN if verdict.kind == "named" else PAIR_PRICE
    if led is None or verdict.fit is None or led.lead >= needed:
        return verdict
    said = {"name": verdict.fit.name, "correlation": led.correlation, "lead": led.lead}
    reason = Fact(Code.MAY_BE_CORRELATED, {**said, "margin": needed})
    return replace(verdict, kind="ambiguous", reasons=(reason,))
