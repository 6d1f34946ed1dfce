"""The paper's statements on strokes, forces and angles, S1 to S4 and S14.

All angles are magnitudes: the upstroke is where |theta| rises, whatever the clamp coil's sign. The
paper gives no thresholds: those here are choices of this study, which its table names.
"""

from __future__ import annotations

import numpy as np

from stickslip.reproduction.criteria import Criterion, Outcome, above, criterion, if_also
from stickslip.reproduction.points import Array
from stickslip.reproduction.settings import MODES, Mode
from stickslip.reproduction.survey import Survey, pairwise

SLIP_SHARE = 0.8
"""Part of the slip's path that counts as "slips on this stroke"."""

MUCH_LARGER = 1.25
"""Least ratio of two angles of which one is "much larger"."""

MIN_SPEED = 1e-6
"""Least speed that counts as motion, m/s."""


def _of_strokes(found: Survey, mode: Mode, name: str) -> Array:
    values = [getattr(each, name) if each else np.nan for each in found.strokes[mode]]
    return pairwise(mode, np.array(values, dtype=np.float64))


def _slips_on(name: str, mode: Mode, stroke: str) -> Criterion:
    """The contact slips forwards on one stroke, "up" or "down", and hardly at all on the other."""

    def evaluate(found: Survey) -> Outcome:
        up = _of_strokes(found, mode, "share_up")
        share = up if stroke == "up" else 1.0 - up
        forwards = _of_strokes(found, mode, f"slip_{stroke}") > 0.0
        margin = if_also(share - SLIP_SHARE, forwards)
        return Outcome({f"{mode} slips on the {stroke}stroke": margin}, {"share": share})

    return Criterion(
        name,
        f"{mode} slips on the {stroke}stroke.",
        f"{SLIP_SHARE:.0%} of the slip's path on the {stroke}stroke, forwards, at 30 Hz",
        f"{{share:.1%}} of the slip's path is on the {stroke}stroke",
        evaluate,
    )


slip_on_the_downstroke = _slips_on("S1", "IPP", "down")
slip_on_the_upstroke = _slips_on("S2", "OPP", "up")


@criterion(
    "S3",
    "The normal force is low on IPP's downstroke and high on OPP's upstroke.",
    "mean while slipping below, or above, weight and adhesion, at 30 Hz",
    "mean N while slipping, over that at rest: IPP on the downstroke {ipp:.2f}, OPP on the "
    "upstroke {opp:.2f}",
)
def normal_force_in_the_strokes(found: Survey) -> Outcome:
    ipp, opp = _of_strokes(found, "IPP", "normal_down"), _of_strokes(found, "OPP", "normal_up")
    margins = {"IPP less than at rest": above(1.0, ipp), "OPP more": above(opp, 1.0)}
    return Outcome(margins, {"ipp": ipp, "opp": opp})


@criterion(
    "S4",
    "The steady angle is much larger in IPP than in OPP.",
    f"{MUCH_LARGER:g} times or more, before the pulses and in the mean at 30 Hz",
    "IPP {still_ipp:.0f}°, OPP {still_opp:.0f}° before the pulses; mean at 30 Hz IPP {ipp:.0f}°, "
    "OPP {opp:.0f}°",
)
def steady_angle(found: Survey) -> Outcome:
    ipp, opp = (_of_strokes(found, mode, "tilt") for mode in MODES)
    still_ipp, still_opp = (pairwise(mode, found.still_tilt[mode]) for mode in MODES)
    margins = {
        "larger before the pulses": above(still_ipp, MUCH_LARGER * still_opp),
        "larger in the mean": above(ipp, MUCH_LARGER * opp),
    }
    angles = {"still_ipp": still_ipp, "still_opp": still_opp, "ipp": ipp, "opp": opp}
    return Outcome(margins, {name: np.degrees(each) for name, each in angles.items()})


@criterion(
    "S14",
    "Constant fields move nothing.",
    f"mean speed below {MIN_SPEED * 1e6:g} µm/s for a second, at the sawtooth's bottom and at its "
    "top",
    "greatest mean speed: IPP {IPP:.1g} nm/s, OPP {OPP:.1g} nm/s",
)
def no_motion_in_constant_fields(found: Survey) -> Outcome:
    speed = {mode: pairwise(mode, found.still_velocity[mode]) for mode in MODES}
    return Outcome(
        {mode: 1.0 - each / MIN_SPEED for mode, each in speed.items()},
        {mode: each * 1e9 for mode, each in speed.items()},
    )
