"""Whether what is claimed is safe, or which experiments would make it so."""

from __future__ import annotations

from collections.abc import Sequence

from stickslip.diagnosis.inference.experiment_design import DECISIVE, PROPOSED, Experiment
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.runner_up import rivals
from stickslip.diagnosis.inference.verdict import MARGIN
from stickslip.facts import Code, Fact

LEAST_WORTH = DECISIVE / PROPOSED
"""Expected chi-square of an experiment that is worth its time. Chosen: as many as are proposed in a
row tell two candidates apart together."""


def next_step(found: Findings) -> Fact:
    """Whether another experiment is needed, and why.

    A named cause or pair is safe if it leads all candidates that lack it by ``MARGIN`` in
    log-evidence. Of those whose effects on these data are alike the verdict asks more already.

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
    nearest = max(others, key=lambda fit: fit.priced_evidence, default=None)
    if nearest is not None:
        lead = said.priced_evidence - nearest.priced_evidence
        if lead < MARGIN:
            rival = {"rival": nearest.name, "lead": lead, "needed": MARGIN}
            return Fact(Code.NEAR_RIVAL, {"name": said.name, **rival})
    return Fact(Code.NAME_SAFE, {"name": said.name, "margin": MARGIN})


def worth_measuring(step: Fact, experiments: Sequence[Experiment]) -> list[Experiment]:
    """Of proposed experiments those that the next step needs, and that can decide something."""
    if step.code not in (Code.NEAR_RIVAL, Code.NO_SAFE_NAME):
        return []
    return [each for each in experiments if each.separation >= LEAST_WORTH]
