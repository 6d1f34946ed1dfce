"""How the candidates stand to one another, as the verdict weighs them."""

from __future__ import annotations

from stickslip.diagnosis.fit.fit_result import Fit, ranked
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.runner_up import describe_runner_up, rivals
from stickslip.facts import Code, Fact

# How many single causes and pairs are listed. Chosen: they fit on a screen.
_SINGLES, _PAIRS = 7, 5


def set_members(found: Findings) -> list[Fit]:
    """The verdict's own fit, and the others of its set where it cannot choose.

    Empty without an extended model.
    """
    chosen = found.verdict.fit
    if chosen is None:
        return []
    if found.verdict.kind != "ambiguous":
        return [chosen]
    among = set(found.verdict.causes)
    if len(chosen.candidate.causes) == 1:
        return [
            chosen,
            *(fit for fit in found.ranking.singles if fit.name in among - {chosen.name}),
        ]
    # Of the causes of two close pairs other pairs can be made too, so that the reasons tell.
    names: set[object] = set()
    for each in found.verdict.reasons:
        if each.code is Code.SEVERAL_PAIRS:
            names.update(each.fields["pairs"])
        if each.code is Code.TRAINING_SUBSET and each.fields["joins"]:
            names.add(each.fields["name"])
    return [chosen, *(fit for fit in found.ranking.pairs if fit.name in names - {chosen.name})]


def leading(found: Findings) -> list[Fit]:
    """The best single causes and the best pairs, by evidence after the price of a second cause."""
    both = [*ranked(found.ranking.singles)[:_SINGLES], *ranked(found.ranking.pairs)[:_PAIRS]]
    return list(ranked(both, priced=True))


def runner_up(found: Findings) -> Fact | None:
    """What comes next after what is claimed; for `unexplained`, what comes nearest.

    None where nothing was fitted, and where it is the reason of a name already.
    """
    verdict, null = found.verdict, found.null
    fits = [*found.ranking.singles, *found.ranking.pairs]
    if not found.detection.found or verdict.kind in ("named", "data-problem") or not fits:
        return None
    if verdict.fit is None:
        nearest = min(fits, key=lambda fit: fit.chi2)
        left = {"chi2": nearest.chi2, "recalibrated": null.chi2}
        count = len(found.problem.observed)
        return Fact(Code.NEAREST, {"name": nearest.name, **left, "observables": count})
    for member in set_members(found):
        fits = rivals(member, fits)
    return describe_runner_up(found.problem, verdict.fit, null, fits)
