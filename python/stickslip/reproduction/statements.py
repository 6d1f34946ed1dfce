"""The paper's statements S1 to S17, each with its numbers and its verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.reproduction import curve_criteria as curves
from stickslip.reproduction import motion_criteria as motion
from stickslip.reproduction.field_checks import FieldChecks
from stickslip.reproduction.outcome import Flags, Outcome
from stickslip.reproduction.reference import reference_pair, working_pairs
from stickslip.reproduction.settings import FACTORS, MODES
from stickslip.reproduction.survey import Survey
from stickslip.reproduction.verdicts import Verdict, of_number, verdict

Criterion = Callable[[Survey], Outcome]

# What the paper's section IV-B states of the coils: N m, N, and parts of the field.
TORQUE, FORCE, FILAMENT, FRINGE = 10.5e-9, 240e-9, 0.022, 0.025
_SAME = 0.01  # part within which a number that is stated with two or three digits is met

CRITERIA: dict[str, tuple[str, str, Criterion]] = {
    "S1": (
        "IPP slips on the downstroke.",
        f"{motion.SLIP_SHARE:.0%} of the slip's path on the downstroke, forwards, at 30 Hz",
        motion.slip_on_the_downstroke,
    ),
    "S2": (
        "OPP slips on the upstroke.",
        f"{motion.SLIP_SHARE:.0%} of the slip's path on the upstroke, forwards, at 30 Hz",
        motion.slip_on_the_upstroke,
    ),
    "S3": (
        "The normal force is low on IPP's downstroke and high on OPP's upstroke.",
        "mean while slipping below, or above, weight and adhesion, at 30 Hz",
        motion.normal_force_in_the_strokes,
    ),
    "S4": (
        "The steady angle is much larger in IPP than in OPP.",
        f"{motion.MUCH_LARGER:g} times or more, before the pulses and in the mean at 30 Hz",
        motion.steady_angle,
    ),
    "S5": (
        "Velocity is proportional to a low frequency.",
        f"R² of a line through the origin to {curves.LOW_FREQUENCY_END:g} Hz at least "
        f"{curves.MIN_R_SQUARED:g}",
        curves.linear_in_frequency,
    ),
    "S6": (
        "Velocity rolls off at high frequency.",
        f"{curves.MAX_CHANGE:.0%} or more below that line at 100, 120 and 150 Hz",
        curves.roll_off,
    ),
    "S7": (
        "With little friction OPP is faster.",
        "means for static friction 0.02, 0.05 and 0.1",
        curves.low_friction,
    ),
    "S8": (
        "With static friction from 0.2 to 1.0 both modes are about as fast.",
        f"mean difference at most {curves.MAX_DIFFERENCE:.0%} of the mean velocity",
        curves.middle_friction,
    ),
    "S9": (
        "With static friction above 1 IPP is faster.",
        "means for static friction 1.2 to 2.4",
        curves.high_friction,
    ),
    "S10": (
        "With little adhesion OPP is faster, and more adhesion costs it more.",
        "means to 0.05 µN, and what is left of them at 0.4 to 0.6 µN",
        curves.adhesion,
    ),
    "S11": (
        "Linear damping slows both modes, between a range where it matters little and one where "
        "nothing moves.",
        f"within {curves.MAX_CHANGE:.0%} to 1e-6 N s/m, never rising by more than that, below "
        f"{curves.MAX_SUPPRESSED:.0%} at 1e-2 N s/m",
        curves.linear_damping,
    ),
    "S12": (
        "Rotational damping matters little when low; then both modes lose alike.",
        f"within {curves.MAX_CHANGE:.0%} to 3e-17 N m s², slower at 1e-13, and from 1e-15 on "
        f"the part left of the velocity equal within {0.5 * curves.MAX_DIFFERENCE:.0%}",
        curves.rotational_damping,
    ),
    "S13": (
        "Velocity grows about linearly with the field, in IPP with some roll-off.",
        f"R² of a line at least {curves.MIN_R_SQUARED:g} from 1.5 to 6.5 mT at 30 Hz, rising; in "
        f"IPP the upper half less steep by {curves.MAX_CHANGE:.0%} or more",
        curves.growth_with_field,
    ),
    "S14": (
        "Constant fields move nothing.",
        f"mean speed below {motion.MIN_SPEED * 1e6:g} µm/s for a second, at the sawtooth's bottom "
        "and at its top",
        motion.no_motion_in_constant_fields,
    ),
}
"""What each statement says in other words, what counts as that, and the criterion."""


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

    Returns
    -------
    statements : list of Statement
        S1 to S17.
    reference : tuple of int
        Indices of the reference settings of IPP and OPP.
    outcomes : dict of Outcome
        S1 to S14 by name.
    """
    outcomes = {name: criterion(found) for name, (_, _, criterion) in CRITERIA.items()}
    reference = reference_pair(found, [each.holds for each in outcomes.values()])
    works = working_pairs(found)
    factors = levels(found)
    statements = [
        Statement(
            name,
            *CRITERIA[name][:2],
            outcome.numbers(*reference),
            verdict(outcome.holds, works, factors, reference),
            {part: _share(flags, works) for part, flags in outcome.parts.items()},
        )
        for name, outcome in outcomes.items()
    ]
    return statements + _of_the_field(checks), reference, outcomes


def levels(found: Survey) -> dict[str, list[str]]:
    """Level of each factor in each setting, by mode and factor: ``{"IPP edge": ["rise", ...]}``."""
    return {
        f"{mode} {factor}": [_level(getattr(each, factor)) for each in found.settings[mode]]
        for mode in MODES
        for factor in FACTORS
    }


def _level(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value * 1e3:g} mT"


def _share(flags: Flags, works: Flags) -> float:
    return float(np.broadcast_to(flags, works.shape)[works].mean())


def _of_the_field(checks: FieldChecks) -> list[Statement]:
    torque = abs(checks.torque / TORQUE - 1.0) < _SAME
    force = abs(checks.force_at_centre / FORCE - 1.0) < _SAME
    of_force = of_number(torque and force)
    if torque and not force:
        words = "torque reproduced; force depends on the place, and is not met at the centre"
        of_force = Verdict("depends", words, None, False)
    return [
        Statement(
            "S15",
            "The greatest torque is 10.5 µN mm, the greatest force 240 nN.",
            "",
            f"torque {checks.torque * 1e9:.2f} µN mm at 6.5 mT; force "
            f"{checks.force_at_centre * 1e9:.0f} nN at the centre, "
            f"{checks.force_at_offset * 1e9:.0f} nN at {checks.full_gradient_offset * 1e3:.1f} mm "
            "from it towards the coil",
            of_force,
            {},
        ),
        Statement(
            "S16",
            "One filament stands for the winding within 2.2%.",
            "",
            f"greatest difference in the 25 mm cube {checks.winding_flat:.2%} from a flat winding, "
            f"{checks.winding_square:.2%} from one as deep as wide",
            of_number(max(checks.winding_flat, checks.winding_square) <= FILAMENT),
            {},
        ),
        Statement(
            "S17",
            "In a cube of 25 mm the fringe field stays below 2.5% of the main one.",
            "",
            f"{checks.fringe:.1%} in the cube of 25 mm, {checks.fringe_small:.2%} in one of 5 mm",
            of_number(checks.fringe < FRINGE, "" if checks.fringe < FRINGE else _FRINGE),
            {},
        ),
    ]


_FRINGE = "not reproduced; true within a cube of about 5 mm"
