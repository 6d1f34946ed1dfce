"""A square that is dropped on a plate, of which a camera sees height and angle.

The model, and what is known, are those of `real.impacts`; `tests/data` has the log and its licence.
Of a longer log of the same source, the sets are `sets(path)`.
"""

from functools import partial
from pathlib import Path

from real import impacts
from real.flights import read_drops
from real.sets import Measured

DROPS = Path(__file__).parents[4] / "tests" / "data" / "square_drops.csv.gz"


def sets(path: Path = DROPS) -> list[Measured]:
    """The heights and the velocities after the first impacts of a log of drops."""
    read = read_drops(path)
    first = impacts.first_impacts(read)
    return [
        Measured(f"{len(read)} drops, {what}", truth,
                 partial(impacts.diagnose_impacts, pose, first))
        for what, truth, pose in (
            ("heights", impacts.HEIGHTS, impacts.heights),
            ("velocities", impacts.VELOCITIES, impacts.velocities),
        )
    ]  # fmt: skip


SETS = sets()
