"""The paper's statements on strokes, forces and angles, S1 to S4 and S14, as criteria.

All angles are magnitudes: the upstroke is where |theta| rises, whatever the clamp coil's sign. The
paper gives no thresholds: those here are choices of this study, which its table names.
"""

from __future__ import annotations

import numpy as np

from stickslip.reproduction.outcome import Outcome, of_each, of_ipp, of_opp
from stickslip.reproduction.points import Array
from stickslip.reproduction.settings import MODES, Mode
from stickslip.reproduction.survey import Survey

SLIP_SHARE = 0.8
"""Part of the slip's path that counts as "slips on this stroke"."""

MUCH_LARGER = 1.25
"""Least ratio of two angles of which one is "much larger"."""

MIN_SPEED = 1e-6
"""Least speed that counts as motion, m/s."""


def _values(found: Survey, mode: Mode, name: str) -> Array:
    values = [getattr(each, name) if each else np.nan for each in found.strokes[mode]]
    return np.array(values, dtype=np.float64)


def slip_on_the_downstroke(found: Survey) -> Outcome:
    """S1: in IPP the contact slips forwards while |theta| falls, and hardly at all else."""
    share = 1.0 - _values(found, "IPP", "share_up")
    forwards = _values(found, "IPP", "slip_down") > 0.0
    return Outcome(
        {"IPP slips on the downstroke": of_ipp((share >= SLIP_SHARE) & forwards)},
        lambda i, j: f"{share[i]:.1%} of the slip's path is on the downstroke",
    )


def slip_on_the_upstroke(found: Survey) -> Outcome:
    """S2: in OPP the contact slips forwards while |theta| rises, and hardly at all else."""
    share = _values(found, "OPP", "share_up")
    forwards = _values(found, "OPP", "slip_up") > 0.0
    return Outcome(
        {"OPP slips on the upstroke": of_opp((share >= SLIP_SHARE) & forwards)},
        lambda i, j: f"{share[j]:.1%} of the slip's path is on the upstroke",
    )


def normal_force_in_the_strokes(found: Survey) -> Outcome:
    """S3: while it slips, N is less than at rest on IPP's downstroke, more on OPP's upstroke."""
    ipp, opp = _values(found, "IPP", "normal_down"), _values(found, "OPP", "normal_up")
    return Outcome(
        {"IPP less than at rest": of_ipp(ipp < 1.0), "OPP more": of_opp(opp > 1.0)},
        lambda i, j: (
            f"mean N while slipping, over that at rest: IPP on the downstroke {ipp[i]:.2f}, "
            f"OPP on the upstroke {opp[j]:.2f}"
        ),
    )


def steady_angle(found: Survey) -> Outcome:
    """S4: the tilt is much larger in IPP, both before the pulses and in the mean of the rocking."""
    ipp, opp = (_values(found, mode, "tilt") for mode in MODES)
    still_ipp, still_opp = (found.still_tilt[mode] for mode in MODES)

    def numbers(i: int, j: int) -> str:
        before = np.degrees([still_ipp[i], still_opp[j]])
        mean = np.degrees([ipp[i], opp[j]])
        return (
            f"IPP {before[0]:.0f}°, OPP {before[1]:.0f}° before the pulses; "
            f"mean at 30 Hz IPP {mean[0]:.0f}°, OPP {mean[1]:.0f}°"
        )

    parts = {
        "larger before the pulses": still_ipp[:, np.newaxis] >= MUCH_LARGER * still_opp[np.newaxis],
        "larger in the mean": ipp[:, np.newaxis] >= MUCH_LARGER * opp[np.newaxis],
    }
    return Outcome(parts, numbers)


def no_motion_in_constant_fields(found: Survey) -> Outcome:
    """S14: constant fields, at the sawtooth's bottom or at its top, move nothing."""
    ipp, opp = (found.still_velocity[mode] for mode in MODES)
    return Outcome(
        of_each({mode: found.still_velocity[mode] < MIN_SPEED for mode in MODES}),
        lambda i, j: (
            f"greatest mean speed: IPP {ipp[i] * 1e9:.1g} nm/s, OPP {opp[j] * 1e9:.1g} nm/s"
        ),
    )
