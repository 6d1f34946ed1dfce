"""Which setting of each mode the figures are drawn with."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.reproduction.settings import MODES
from stickslip.reproduction.survey import WORKING_FREQUENCIES, Flags, Survey

TYPICAL_VELOCITY = 0.88e-3
"""m/s; what the paper's Reynolds number of 0.22 comes to, section VI-C."""

RULE = (
    "Of all pairs of a working IPP setting and a working OPP setting, those come first for which "
    "the statements on the motion itself (S1 to S4) all hold; of these, those for which the "
    "most of S5 to S14 hold; of these, the one whose velocities at 30 Hz and 100 Hz are nearest, "
    "in ratio, to the 0.88 mm/s of the paper's Reynolds number."
)
"""How the reference is chosen, in words."""

MOTION = 4
"""Number of the statements on the motion itself, S1 to S4."""


def reference_pair(found: Survey, holds: Sequence[Flags]) -> tuple[int, int]:
    """Indices of the chosen settings of IPP and OPP; `holds` says where S1 to S14 do, in order.

    Without a pair of working settings there is a ValueError.
    """
    works = found.working_pairs()
    if not works.any():
        raise ValueError("no setting of the grid walks forwards in both modes")
    motion = count_of(holds[:MOTION], works)
    trends = count_of(holds[MOTION:], works)
    # All four first, then the trends; where no pair has all four, the most of them.
    score = np.where(works, 100 * motion + trends, -1)

    def distance(pair: tuple[int, int]) -> float:
        velocities = [
            found.at(mode, "frequency", WORKING_FREQUENCIES)[k]
            for mode, k in zip(MODES, pair, strict=True)
        ]
        return float(np.abs(np.log(np.array(velocities) / TYPICAL_VELOCITY)).mean())

    return min(((int(i), int(j)) for i, j in np.argwhere(score == score.max())), key=distance)


def count_of(holds: Iterable[Flags], works: Flags) -> NDArray[np.int64]:
    """How many of the flags each pair has."""
    flags = [np.broadcast_to(each, works.shape) for each in holds]
    return np.asarray(np.sum(flags, axis=0, dtype=np.int64))
