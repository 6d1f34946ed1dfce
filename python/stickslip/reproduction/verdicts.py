"""From where a statement holds to a verdict in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from stickslip.reproduction.survey import Flags

Word = Literal["reproduced", "not reproduced", "depends"]

# The paper has no such thresholds: these are choices of this study, which its page names.
REPRODUCED_FROM = 0.9
"""Share of the settings from which on a statement counts as reproduced, whatever is chosen."""
NOT_REPRODUCED_TO = 0.1
"""Share up to which it counts as not reproduced."""
MIN_SHARE_DIFFERENCE = 0.25
"""Least difference of a factor's shares for the factor to be named."""

_NAMED = 2  # factors in one sentence; chosen: more are hard to read


@dataclass(frozen=True)
class Verdict:
    """What the settings say of one statement.

    Attributes
    ----------
    word : {"reproduced", "not reproduced", "depends"}
    text : str
        The verdict, with what it depends on.
    share : float or None
        Part of the working settings, or of their pairs, for which the statement holds; None for
        one that no setting enters.
    at_reference : bool
        Whether it holds for the reference settings.
    """

    word: Word
    text: str
    share: float | None
    at_reference: bool


def verdict(
    holds: Flags,
    works: Flags,
    factors: Mapping[str, Sequence[object]],
    reference: tuple[int, int],
) -> Verdict:
    """Judge a statement by the share of working pairs for which it holds.

    Flags have the shape (settings of IPP, settings of OPP); `reference` has the indices of the
    reference pair. `factors` has for each factor its level in every setting: of IPP where the name
    begins with it, else of OPP.
    """
    holds = np.broadcast_to(holds, works.shape)
    share = float(holds[works].mean()) if works.any() else 0.0
    at_reference = bool(holds[reference])
    if share >= REPRODUCED_FROM:
        return Verdict("reproduced", "reproduced", share, at_reference)
    if share <= NOT_REPRODUCED_TO:
        return Verdict("not reproduced", "not reproduced", share, at_reference)
    named = deciding_factors(holds, works, factors)
    what = " and ".join(named) if named else "the settings together"
    return Verdict("depends", f"depends on {what}", share, at_reference)


def deciding_factors(
    holds: Flags, works: Flags, factors: Mapping[str, Sequence[object]]
) -> list[str]:
    """The factors whose levels differ most in their share, most first, each with its best level."""
    found = []
    for name, levels in factors.items():
        shares = {}
        for level in dict.fromkeys(levels):
            chosen = np.array([each == level for each in levels])
            pairs = works & (chosen[:, np.newaxis] if name.startswith("IPP") else chosen)
            if pairs.any():
                shares[level] = float(holds[pairs].mean())
        if len(shares) > 1:
            best = max(shares, key=lambda level: shares[level])
            apart = shares[best] - min(shares.values())
            if apart >= MIN_SHARE_DIFFERENCE:
                found.append((apart, f"{name} (most often with {best}: {shares[best]:.0%})"))
    return [text for _, text in sorted(found, reverse=True)[:_NAMED]]


def of_number(holds: bool, text: str = "") -> Verdict:
    """The verdict on a statement that no setting enters."""
    word: Word = "reproduced" if holds else "not reproduced"
    return Verdict(word, text or word, None, holds)
