"""The paper's statements S1 to S17, each with its numbers and its verdict."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.reproduction import curve_criteria as curves
from stickslip.reproduction import motion_criteria as motion
from stickslip.reproduction.criteria import Outcome
from stickslip.reproduction.field_checks import FieldChecks
from stickslip.reproduction.reference import reference_pair
from stickslip.reproduction.settings import FACTORS, MODES
from stickslip.reproduction.survey import Survey
from stickslip.reproduction.verdicts import Verdict, of_number, verdict

# What the paper's section IV-B states of the coils: N m, N, and parts of the field.
TORQUE, FORCE, FILAMENT, FRINGE = 10.5e-9, 240e-9, 0.022, 0.025
_SAME = 0.01  # relative difference up to which a stated number is met; chosen: as its digits

CRITERIA = (
    motion.slip_on_the_downstroke,
    motion.slip_on_the_upstroke,
    motion.normal_force_in_the_strokes,
    motion.steady_angle,
    curves.linear_in_frequency,
    curves.roll_off,
    curves.low_friction,
    curves.middle_friction,
    curves.high_friction,
    curves.adhesion,
    curves.linear_damping,
    curves.rotational_damping,
    curves.growth_with_field,
    motion.no_motion_in_constant_fields,
)
"""The statements that depend on settings, S1 to S14."""


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


def judge(
    found: Survey, checks: FieldChecks
) -> tuple[list[Statement], tuple[int, int], dict[str, Outcome]]:
    """Test all statements.

    Returns S1 to S17, the indices of the reference settings of IPP and OPP, and the outcomes of
    S1 to S14 by name.
    """
    outcomes = {each.name: each.evaluate(found) for each in CRITERIA}
    reference = reference_pair(found, [outcome.holds for outcome in outcomes.values()])
    works = found.working_pairs()
    factors = {
        f"{mode} {factor}": [_level(getattr(each, factor)) for each in found.settings[mode]]
        for mode in MODES
        for factor in FACTORS
    }
    statements = []
    for each in CRITERIA:
        outcome = outcomes[each.name]
        numbers = each.words(outcome, reference)
        judged = verdict(outcome.holds, works, factors, reference)
        shares = {
            part: float(np.broadcast_to(flags, works.shape)[works].mean())
            for part, flags in outcome.parts.items()
        }
        statements.append(Statement(each.name, each.text, each.condition, numbers, judged, shares))
    return statements + _of_the_field(checks), reference, outcomes


def _level(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value * 1e3:g} mT"


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
