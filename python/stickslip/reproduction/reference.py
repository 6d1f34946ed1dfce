"""Which setting of each mode the figures are drawn with."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.reproduction.outcome import Flags
from stickslip.reproduction.settings import MODES
from stickslip.reproduction.survey import Survey

TYPICAL_VELOCITY = 0.88e-3
"""m/s; what the paper's Reynolds number of 0.22 comes to, section VI-C."""

RULE = (
    "Of all pairs of a working IPP setting and a working OPP setting, those come first for which "
    "the statements on the motion itself (S1 to S4) all hold; of these, those for which the "
    "most of S5 to S14 hold; of these, the one whose velocities at 30 Hz and 100 Hz are nearest, "
    "in ratio, to the 0.88 mm/s of the paper's Reynolds number."
)
"""How the reference is chosen, in words."""

_MOTION = 4


def reference_pair(found: Survey, holds: Sequence[Flags]) -> tuple[int, int]:
    """Indices of the chosen settings of IPP and OPP.

    Parameters
    ----------
    found : Survey
    holds : sequence of numpy.ndarray of bool
        Where S1 to S14 hold, in that order.

    Raises
    ------
    ValueError
        If there is no pair of working settings.
    """
    works = working_pairs(found)
    if not works.any():
        raise ValueError("no setting of the grid walks forwards in both modes")
    motion = _count(holds[:_MOTION], works)
    trends = _count(holds[_MOTION:], works)
    # All four first, then the trends; where no pair has all four, the most of them.
    score = np.where(works, 100 * motion + trends, -1)
    best = np.argwhere(score == score.max())
    distance = [_distance(found, i, j) for i, j in best]
    i, j = best[int(np.argmin(distance))]
    return int(i), int(j)


def working_pairs(found: Survey) -> Flags:
    """Which pairs consist of working settings."""
    return found.works("IPP")[:, np.newaxis] & found.works("OPP")[np.newaxis, :]


def _count(holds: Sequence[Flags], works: Flags) -> NDArray[np.int64]:
    total = np.zeros(works.shape, dtype=np.int64)
    for each in holds:
        total += np.broadcast_to(each, works.shape)
    return total


def _distance(found: Survey, i: int, j: int) -> float:
    velocities = [
        found.at(mode, "frequency", (30.0, 100.0))[k] for mode, k in zip(MODES, (i, j), strict=True)
    ]
    return float(np.abs(np.log(np.array(velocities) / TYPICAL_VELOCITY)).mean())
