"""Which experiments would tell the candidates of a diagnosis apart, and whether any is needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.note import Note
from stickslip.diagnosis.decision.verdict import Verdict

PROPOSED, TRIALS = 3, 3
"""Experiments that are proposed if nothing else is asked for, and trials of each. Chosen."""

DECISIVE = 4.0
"""Expected chi-square that tells two candidates apart: two standard errors."""

LEAST_WORTH = DECISIVE / PROPOSED
"""Expected chi-square of an experiment that is worth its time: all that are proposed in a row tell
two candidates apart together."""

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
    level: Array, covariance: Array, noise_variance: Array, pairs: Sequence[tuple[int, int]],
    beside: Sequence[int] = (),
) -> Array:  # fmt: skip
    """How far the predictions of two candidates lie apart, in squared standard errors.

    A reading is of one candidate's world, so its error is the noise and that candidate's own
    uncertainty: of the two candidates the one that expects the larger error counts. What is
    uncertain in both, such as the constants, moves all readings alike: together with those
    that are measured anyway (`beside`) a proposal tells more than its own reading.

    `level` has the shape (candidates, proposals); `covariance` is that of the predictions over the
    draws of a candidate, (candidates, proposals, proposals); `noise_variance` is that of the mean
    of the trials of a proposal, (proposals,). The answer has the shape (pairs, proposals), of each
    proposal together with those of `beside`; 0 where a candidate predicts nothing.
    """
    sound = np.all(np.isfinite(level) & np.isfinite(np.einsum("cpp->cp", covariance)), axis=0)
    chi2 = np.zeros((len(pairs), level.shape[1]))
    for p in np.flatnonzero(sound):
        rows = np.unique([*beside, p])
        errors = covariance[:, rows[:, None], rows] + np.diag(noise_variance[rows])
        for k, (a, b) in enumerate(pairs):
            gap = level[a, rows] - level[b, rows]
            chi2[k, p] = min(float(gap @ np.linalg.solve(errors[c], gap)) for c in (a, b))
    return chi2


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


def worth_measuring(step: Note, experiments: Sequence[Experiment]) -> list[Experiment]:
    """The proposed experiments that the next step needs, up to the last that tells enough."""
    if step.code != "no-safe-name":
        return []
    enough = [k for k, experiment in enumerate(experiments) if experiment.separation >= LEAST_WORTH]
    return list(experiments[: max(enough, default=-1) + 1])
