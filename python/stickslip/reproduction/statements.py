"""The paper's statements S1 to S17, each with its numbers and its verdict, and the reference.

The reference is the pair of settings with which the figures are drawn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from stickslip.reproduction.criteria import CRITERIA, MOTION, all_margins
from stickslip.reproduction.field_checks import FieldChecks
from stickslip.reproduction.settings import FACTORS, MODES
from stickslip.reproduction.survey import (
    WORKING_FREQUENCIES,
    Behaviour,
    Flags,
    Survey,
    all_pairs,
    working_pairs,
)

Word = Literal["reproduced", "not reproduced", "depends"]

# The paper has no such thresholds: these are choices of this study, which its page names.
REPRODUCED_FROM = 0.9
"""Share of the settings from which on a statement counts as reproduced, whatever is chosen."""
NOT_REPRODUCED_TO = 0.1
"""Share up to which it counts as not reproduced."""
MIN_SHARE_DIFFERENCE = 0.25
"""Least difference of a factor's shares for the factor to be named."""

_NAMED = 2  # factors in one sentence; chosen: more are hard to read

TYPICAL_VELOCITY = 0.88e-3
"""m/s; what the paper's Reynolds number of 0.22 comes to, section VI-C."""

RULE = (
    "Of all pairs of a working IPP setting and a working OPP setting, those come first for which "
    "the statements on the motion itself (S1 to S4) all hold; of these, those for which the "
    "most of S5 to S14 hold; of these, the one whose velocities at 30 Hz and 100 Hz are nearest, "
    "in ratio, to the 0.88 mm/s of the paper's Reynolds number."
)
"""How the reference is chosen, in words."""

NO_PAIR = "no setting of the grid walks forwards in both modes"

# What the paper's section IV-B states of the coils: N m, N, and parts of the field.
TORQUE, FORCE, FILAMENT, FRINGE = 10.5e-9, 240e-9, 0.022, 0.025
_SAME = 0.01  # relative difference up to which a stated number is met; chosen: as its digits


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


@dataclass(frozen=True)
class Statement:
    """One statement of the paper, tested.

    Attributes
    ----------
    name : str
        ``"S1"`` to ``"S17"``.
    text : str
        The statement, in other words than the paper's.
    condition : str
        What counts as such; empty where the statement is one already.
    numbers : str
        What was measured, for the reference settings where settings enter.
    verdict : Verdict
    parts : dict of float
        Share of the working settings for each thing that the statement says.
    """

    name: str
    text: str
    condition: str
    numbers: str
    verdict: Verdict
    parts: dict[str, float]

    def as_dict(self) -> dict[str, Any]:
        """The statement of plain types."""
        return {
            "name": self.name,
            "statement": self.text,
            "condition": self.condition,
            "numbers": self.numbers,
            "verdict": self.verdict.word,
            "text": self.verdict.text,
            "share": self.verdict.share,
            "at_reference": self.verdict.at_reference,
            "parts": self.parts,
        }


def judge(found: Survey, checks: FieldChecks) -> tuple[list[Statement], tuple[int, int], Flags]:
    """Test all statements.

    Returns S1 to S17, the indices of the reference settings of IPP and OPP, and where S1 to S14
    hold, shape (14, settings of IPP, settings of OPP).
    """
    pairs = all_pairs(found)
    works = working_pairs(pairs)
    holds = all_margins(pairs) >= 0.0
    reference = reference_pair(pairs, holds)
    at_reference = pairs.at((slice(None), *reference))
    factors = {
        f"{mode} {factor}": [_level(getattr(each, factor)) for each in found[mode].settings]
        for mode in MODES
        for factor in FACTORS
    }
    statements = []
    for each, where in zip(CRITERIA, holds, strict=True):
        judged = verdict(where, works, factors, reference)
        shares = {
            part: float((margin >= 0.0)[works].mean())
            for part, margin in each.margins(pairs).items()
        }
        numbers = each.numbers(at_reference)
        statements.append(Statement(each.name, each.text, each.condition, numbers, judged, shares))
    return statements + _of_the_field(checks), reference, holds


def _level(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value * 1e3:g} mT"


def reference_pair(pairs: Behaviour, holds: Flags) -> tuple[int, int]:
    """Indices of the chosen settings of IPP and OPP among `all_pairs`.

    `holds` says where S1 to S14 do, shape (14, settings of IPP, settings of OPP). Without a pair of
    working settings there is a ValueError.
    """
    works = working_pairs(pairs)
    if not works.any():
        raise ValueError(NO_PAIR)
    # All four first, then the trends; where no pair has all four, the most of them.
    score = np.where(works, 100 * holds[:MOTION].sum(axis=0) + holds[MOTION:].sum(axis=0), -1)
    best = np.argwhere(score == score.max())
    velocity = pairs.velocity("frequency", WORKING_FREQUENCIES)[:, best[:, 0], best[:, 1]]
    distance = np.abs(np.log(velocity / TYPICAL_VELOCITY)).mean(axis=(0, -1))
    i, j = best[distance.argmin()].tolist()
    return i, j


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
    if not NOT_REPRODUCED_TO < share < REPRODUCED_FROM:
        word: Word = "reproduced" if share >= REPRODUCED_FROM else "not reproduced"
        return Verdict(word, word, share, at_reference)
    what = " and ".join(deciding_factors(holds, works, factors)) or "the settings together"
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


def _of_the_field(checks: FieldChecks) -> list[Statement]:
    """S15 to S17, which no setting enters."""
    torque = abs(checks.torque / TORQUE - 1.0) < _SAME
    force = abs(checks.force_at_centre / FORCE - 1.0) < _SAME
    of_force = of_number(torque and force)
    if torque and not force:
        words = "torque reproduced; force depends on the place, and is not met at the centre"
        of_force = Verdict("depends", words, None, False)
    fringe_is_low = checks.fringe < FRINGE
    of_fringe = "" if fringe_is_low else "not reproduced; true within a cube of about 5 mm"
    rows = {
        "The greatest torque is 10.5 µN mm, the greatest force 240 nN.": (
            f"torque {checks.torque * 1e9:.2f} µN mm at 6.5 mT; force "
            f"{checks.force_at_centre * 1e9:.0f} nN at the centre, "
            f"{checks.force_at_offset * 1e9:.0f} nN at {checks.full_gradient_offset * 1e3:.1f} mm "
            "from it towards the coil",
            of_force,
        ),
        "One filament stands for the winding within 2.2%.": (
            f"greatest difference in the 25 mm cube {checks.winding_flat:.2%} from a flat winding, "
            f"{checks.winding_square:.2%} from one as deep as wide",
            of_number(max(checks.winding_flat, checks.winding_square) <= FILAMENT),
        ),
        "In a cube of 25 mm the fringe field stays below 2.5% of the main one.": (
            f"{checks.fringe:.1%} in the cube of 25 mm, {checks.fringe_small:.2%} in one of 5 mm",
            of_number(fringe_is_low, of_fringe),
        ),
    }
    return [
        Statement(f"S{number}", text, "", numbers, judged, {})
        for number, (text, (numbers, judged)) in enumerate(rows.items(), start=len(CRITERIA) + 1)
    ]
