"""How hard the search over models and its descents look, and where they stop.

All are chosen; where it is known on what, the line of one says so.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Search:
    """Options of the search over models; lengths are in coordinates: 1 is a prior's sd."""

    # The recalibrated model.
    scan: int = 128  # points of a scan of the constants
    descents: tuple[int, ...] = (12, 5, 4, 2)  # most from a scan in each stage, then as stated
    followed: int = 4  # starts of the first scan at a time; later ones only beyond a hill
    between: int = 3  # places on the way at which a hill is looked for
    apart: float = 0.7  # distance of starts that lead elsewhere
    same: float = 0.05  # distance below which ends are one
    # First looks at single causes.
    views: int = 3  # ends and stated constants about which they are looked for, beside the null
    looked_at: int = 6  # starts of each whose cost is asked
    look: int = 3  # steps of a stage of a look
    longer_look: int = 10  # the same where predictions change over a small part of a shape's range
    margin: float = 30.0  # cost above the best one from which a model is given up
    places: int = 9  # of a scan of a relaxed constant
    widened: float = 8.0  # how far it goes, stated sds: a wrong estimate is rarely farther off
    # Rounds beside leaders.
    leaders: int = 3  # looked beside in a round: with fewer a near twin is missed
    rounds: int = 4  # most of them
    likeliest: int = 4  # probes of a cause beside a leader, of a long record
    most_fits: int = 250  # after which none is looked beside: a pair takes 160
    most_causes: int = 3  # of a model
    near: float = 6.0  # log posterior odds within which models are refined
    behind: float = 12.0  # log posterior odds of a promise below its leader that end a fit
    more: int = 6  # causes tried about a leader, of each kind of neighbour
    better: float = 1.0  # growth of a log-evidence, or fall of a cost, that counts as one
    rare: float = 0.05  # chance of noise as small as a further cause needs to lead


@dataclass(frozen=True)
class Effort:
    """Options that depend on what predictions cost, and on whether they jump; lengths as above."""

    # Amplitudes of responses about the recalibrated model, and about the further views: models that
    # are smooth in pieces have causes without a slope at zero, and the way to a limit that binds
    # may lead uphill. A factor of three to four apart, up to a size that surprises.
    amplitudes: tuple[float, ...] = (0.15, 0.6, 2.0, 6.0)
    elsewhere: tuple[float, ...] = amplitudes
    # Beside the best model, with the usual one, where precise readings leave little room.
    smaller: tuple[float, ...] = (0.002, 0.02, 0.15)
    worth: float = 2.0  # least fall of the cost that one more has to promise
    early: bool = False  # end fits of what is not near once slopes as they are promise no lead
    # A fall by this part of the cost ends a descent; of whole runs, of the cost beyond that of one
    # error in each row, as models that explain the data are compared by where they end.
    rough: float = 0.0


@dataclass(frozen=True)
class Descent:
    """Options of a descent; lengths as above."""

    # Factors of the errors and bounds of outliers of the stages before the stated errors, so that
    # no search is lost in a narrow minimum: half decades, and a bound at which two errors count for
    # half, where a row whose motion is still of another kind does not hold the others back.
    stages: tuple[tuple[float, float], ...] = ((10.0, math.inf), (3.0, math.inf), (1.0, 1.5))
    # Relative to the curvature: the full step, those that are tried where it gains little, and a
    # hundred times as much if none lowers the cost by exact slopes. The next ones are a tenth where
    # the smaller one gains what it promises: along a narrow valley that turns steps are short.
    dampings: tuple[float, ...] = (0.0, 0.3, 10.0)
    settled: float = 0.02  # fall of the cost that ends it: far below what a test or a lead counts
    wide: float = 0.03  # widest difference: a wider one has the model's curvature in its slope
    narrow: float = 1e-3  # narrowest one: below it the error of a simulation is no slope
    jump: float = 1.0  # change of a row, in its errors, that may be a jump and no slope
    stride: float = 0.3  # step over which a change of a row is a slope even if it jumps
    good: float = 0.3  # part of the promised fall of the cost below which slopes are taken anew
    step: float = 2.5  # longest one of amplitudes and logarithms, which are far from linear
    linear_step: float = 50.0  # of other constants, which may be stated many sds off
    # A crawl along a narrow valley goes on: after so many steps one counts for a part, if its fall
    # is at least so much, or such a part of the cost: ten times the steps at most.
    crawl: int = 4
    crawl_counts: float = 0.1
    crawl_fall: float = 1.0
    crawl_part: float = 2e-3
    walks: int = 4  # most of them after it
    # Moves of a walk, in the fineness of a coordinate: as far as the next places of a scan.
    moves: tuple[float, ...] = tuple(4.0 * 0.5**k for k in range(9))
    # Widths of differences by a coordinate that turns predictions, in its fineness.
    widths: tuple[float, ...] = tuple(4.0 * 0.25**k for k in range(7))


SEARCH, DESCENT, SMOOTH = Search(), Descent(), Effort()
JUMPING = Effort(elsewhere=(0.6, 2.0), smaller=(0.15,), worth=4.0, early=True, rough=0.02)
"""Of a simulation with events: a small gain may be a jump, and a fit follows jumps for long."""
