"""Which experiments would tell the candidates of a diagnosis apart, and whether any is needed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.note import Note
from stickslip.diagnosis.decision.verdict import Verdict
from stickslip.diagnosis.terms.cause import CauseNote

PROPOSED, TRIALS = 3, 3
"""Experiments that are proposed if nothing else is asked for, and trials of each. Chosen."""

DECISIVE = 4.0
"""Expected chi-square that tells two candidates apart: two standard errors."""

LEFT = 0.1
"""Probability of a cause from which on ``none`` asks for readings. Chosen: few readings leave more.
"""


@dataclass(frozen=True)
class Experiment:
    """Settings that were not measured yet; ``str()`` gives them in words, and what they are for.

    Attributes
    ----------
    drive : dict
        Settings by bare name.
    words : str
        The settings in words.
    why : Note
    separation : float
        Expected chi-square between the two candidates that it separates best, beyond that of the
        experiments before it in the same list.
    predictions : dict
        What each candidate predicts, and its ``sd`` without the noise of a trial.
    """

    drive: Mapping[str, Any]
    words: str
    why: Note
    separation: float
    predictions: Mapping[str, Mapping[str, float]]

    def __str__(self) -> str:
        return f"{self.words}. {self.why}"

    @property
    def decides(self) -> bool:
        """Whether it is expected to tell these two apart."""
        return self.separation > DECISIVE


def expected_chi2(
    level: Array, covariance: Array, noise_variance: Array, beside: Sequence[int] = ()
) -> Array:
    """Separation of any two candidates at each proposal, in squared standard errors.

    A reading is of one candidate's world, so its error is the noise and that candidate's own
    uncertainty: of the two candidates the one that expects the larger error counts. What is
    uncertain in both, such as the constants, moves all readings alike: together with those
    that are measured anyway (`beside`) a proposal tells more than its own reading.

    `level` has the shape (candidates, proposals); `covariance` is that of the predictions over the
    draws of a candidate, (candidates, proposals, proposals); `noise_variance` is that of the mean
    of the trials of a proposal, (proposals,). The answer has the shape (candidates, candidates,
    proposals), of each proposal together with those of `beside`; 0 where a candidate predicts
    nothing.
    """
    known = list(beside)
    shared, gap = covariance[:, known], level - level[:, None]  # [a, b]: b in the world of a
    errors, there = shared[..., known] + np.diag(noise_variance[known]), gap[..., known]
    # By what is measured anyway, and by what a proposal adds to it.
    before = np.einsum("abk,akb->ab", there, np.linalg.solve(errors, there.swapaxes(1, 2)))
    weights = np.linalg.solve(errors, shared)
    explained = np.einsum("ckp,ckp->cp", shared, weights)
    variance = np.einsum("cpp->cp", covariance) + noise_variance - explained
    chi2 = before[..., None] + (gap - there @ weights) ** 2 / variance[:, None]
    sound = np.all(np.isfinite(chi2), axis=(0, 1))
    return np.where(sound, np.minimum(chi2, chi2.swapaxes(0, 1)), 0.0)


def separates(first: str, second: str, chi2: float, trials: int, beside: str) -> Note:
    """Say how far a proposal separates two candidates, `beside` others in words."""
    decides, apart = chi2 > DECISIVE, math.sqrt(chi2)
    little, needed = ("", "would be enough") if decides else (" too little", "would be needed")
    text = (
        f"It separates {{}} from {{}}{little}: with {trials} trials their predictions lie "
        f"{apart:.1f} standard errors apart{beside}; {math.sqrt(DECISIVE):g} {needed}."
    )
    code = "separates" if decides else "separates-too-little"
    return CauseNote(code, text, (first, second), apart)


def next_step(
    verdict: Verdict, names: Sequence[str], probability: float, same: Sequence[str] = ()
) -> Note:
    """Whether another experiment is needed after a verdict, with its causes as they are said.

    After ``none`` they are the likeliest one, the probability is that of any cause, and `same` are
    settings that were not varied.
    """
    head, kind = f"{' and '.join(names)}, with a probability of {probability:.3g}", verdict.kind
    if verdict.claims and verdict.partial:
        return Note("name-safe", (
            f"Among the listed causes the name is safe: {head}. A cause that is not listed, with a "
            "similar effect, would get the same name."
        ), probability)  # fmt: skip
    if verdict.claims:
        return Note("name-safe", f"The name is safe: {head}. Nothing more has to be measured.",
                    probability)  # fmt: skip
    if kind == "ambiguous":
        return Note("no-safe-name", "No name is safe, as the verdict is ambiguous.")
    if kind == "none" and probability >= LEFT:
        return Note("cause-left", (
            f"With a probability of {100.0 * probability:.0f} % a cause is there all the same"
            f"{', such as ' * bool(names)}{' and '.join(names)}: repeat readings, and vary "
            f"{' and '.join(same) or 'the settings more'}."
        ), probability)  # fmt: skip
    text = f"Nothing is proposed: the verdict {kind} leaves no candidates to tell apart."
    return Note("nothing-to-separate", text)
