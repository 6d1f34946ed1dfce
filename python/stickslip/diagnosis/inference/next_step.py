"""Whether what is claimed is safe, or which experiments would make it so."""

from __future__ import annotations

from collections.abc import Sequence

from stickslip.diagnosis.fit.distinguishability import alike
from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.inference.experiment_design import DECISIVE, PROPOSED, Experiment
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.runner_up import rivals
from stickslip.diagnosis.inference.verdict import ALIKE_MARGIN, MARGIN
from stickslip.facts import Code, Fact

LEAST_WORTH = DECISIVE / PROPOSED
"""Expected chi-square of an experiment that is worth its time. Chosen: as many as are proposed in a
row tell two candidates apart together."""


def next_step(found: Findings) -> Fact:
    """Whether another experiment is needed, and why.

    A named cause or pair is safe if it leads, in log-evidence, all candidates that lack it: those
    whose effects on these data are alike, which are of one distinguishability class with it, by
    ``ALIKE_MARGIN``, all others by ``MARGIN``.

    Returns
    -------
    Fact
        With the code ``name-safe``; ``near-rival``, of the candidate that is nearest to being led
        by too little; ``no-safe-name`` of the verdict ambiguous; or ``nothing-to-separate``.
    """
    verdict = found.verdict
    if verdict.kind == "ambiguous":
        return Fact(Code.NO_SAFE_NAME, {"causes": list(verdict.causes)})
    if verdict.fit is None:
        return Fact(Code.NOTHING_TO_SEPARATE, {"verdict": verdict.kind})
    said = verdict.fit
    others = rivals(said, [*found.ranking.singles, *found.ranking.pairs])
    leads = [(said.priced_evidence - fit.priced_evidence, _needed(found, fit)) for fit in others]
    lacking = [lead - needed for lead, needed in leads]
    if lacking and min(lacking) < 0.0:
        nearest = lacking.index(min(lacking))
        lead, needed = leads[nearest]
        rival = {"rival": others[nearest].name, "lead": lead, "needed": needed}
        return Fact(Code.NEAR_RIVAL, {"name": said.name, **rival})
    margins = {"margin": MARGIN, "alike_margin": ALIKE_MARGIN}
    return Fact(Code.NAME_SAFE, {"name": said.name, **margins})


def worth_measuring(step: Fact, experiments: Sequence[Experiment]) -> list[Experiment]:
    """Of proposed experiments those that the next step needs, and that can decide something."""
    if step.code not in (Code.NEAR_RIVAL, Code.NO_SAFE_NAME):
        return []
    return [each for each in experiments if each.separation >= LEAST_WORTH]


def _needed(found: Findings, rival: Fit) -> float:
    """By how much a rival of what is claimed has to be behind."""
    said = found.verdict.fit
    assert said is not None
    own, theirs = said.candidate.causes, rival.candidate.causes
    same = alike(found.problem, found.cosines, own, theirs)
    return ALIKE_MARGIN if same else MARGIN
