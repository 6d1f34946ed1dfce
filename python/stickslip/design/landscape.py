"""The score about the best drive, along one free number at a time.

There it is on a peak, on a plateau, or on a slope at a limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stickslip._util.numbers import Array
from stickslip.design.design_space import Axis, DesignSpace
from stickslip.design.goal import Evaluate, Judged

OFFSETS = (-0.2, -0.1, -0.05, -0.02, 0.02, 0.05, 0.1, 0.2)
"""Steps from the best, in parts of a number's range; chosen: from a good setting to a bad one."""

NEAR = 0.05
"""Steps up to this decide between peak and plateau; chosen: as well as a lab repeats a setting."""

PLATEAU = 0.1
"""Part of the score that is lost within `NEAR` on a plateau at most; chosen."""


RISE = 0.01
"""Part of the score that is gained within `NEAR` on a slope at least; chosen."""

Kind = Literal["peak", "plateau", "slope at a limit"]

ABOUT = 32
"""Draws in which the landscape is judged; chosen: enough for differences, not for its level."""


@dataclass(frozen=True, eq=False)
class Slice:
    """The score along one free number, all others as in the best drive.

    Attributes
    ----------
    axis : Axis
        The number.
    best : float
        Its value in the best drive.
    values : numpy.ndarray, shape (n,)
        Values that were tried, and the best, in order.
    scores : numpy.ndarray, shape (n,)
        In draws of their own; NaN where one failed.
    feasible : numpy.ndarray of bool, shape (n,)
        Whether all limits hold.
    loss : float
        Greatest part of the best score that is lost within ``NEAR`` of the range; infinite where a
        simulation fails there.
    kind : {"peak", "plateau", "slope at a limit"}
        A slope at a limit, if more than ``RISE`` is gained within ``NEAR`` where a limit does not
        hold, or may be beyond the end of the range. Else a peak, if more than ``PLATEAU`` is lost.
    """

    axis: Axis
    best: float
    values: Array
    scores: Array
    feasible: NDArray[np.bool_]
    loss: float
    kind: Kind

    @property
    def at_end(self) -> Literal["low", "high", ""]:
        """The end of the range at which the best is, within a hundredth of it."""
        return _end(self.axis.coordinate(self.best))


def _end(place: float) -> Literal["low", "high", ""]:
    return "low" if place < 0.01 else "high" if place > 0.99 else ""


def neighbours(point: Array) -> list[tuple[int, Array]]:
    """Points about one, each with the axis along which it differs; all within the unit cube."""
    found = []
    for k in range(len(point)):
        for place in dict.fromkeys(np.clip(point[k] + np.array(OFFSETS), 0.0, 1.0).tolist()):
            if place != point[k]:
                other = point.copy()
                other[k] = place
                found.append((k, other))
    return found


def slices(
    space: DesignSpace, arm: int, best: Array, sign: float, evaluate: Evaluate
) -> tuple[list[Slice], Array | None]:
    """One slice for each free number, and the best neighbour if it is better within all limits.

    `evaluate` judges drives by their changes, in one batch.
    """
    about = neighbours(best)
    points = [best, *(other for _, other in about)]
    centre, *judged = evaluate([space.changes_or_error(arm, point) for point in points])
    found = []
    for k, axis in enumerate(space.axes):
        own = [(best[k], centre)]
        own += [(p[k], j) for (which, p), j in zip(about, judged, strict=True) if which == k]
        own.sort(key=lambda pair: float(pair[0]))
        found.append(_slice(axis, float(best[k]), centre, own, sign))
    within = [
        (sign * each.score, point)
        for (_, point), each in zip(about, judged, strict=True)
        if each.feasible and sign * (each.score - centre.score) > 0.0
    ]
    return found, max(within, key=lambda pair: pair[0])[1] if within else None


def _slice(
    axis: Axis, best: float, judged: Judged, own: Sequence[tuple[float, Judged]], sign: float
) -> Slice:
    places = np.array([place for place, _ in own])
    scores = np.array([each.score for _, each in own])
    near = np.abs(places - best) <= NEAR * (1.0 + 1e-9)  # but for rounding
    feasible = np.array([each.feasible for _, each in own])
    lost = sign * (judged.score - scores[near]) / (abs(judged.score) or 1.0)
    loss = float(np.where(np.isnan(lost), np.inf, lost).max())
    steep = loss > PLATEAU
    at_limit = np.any((lost < -RISE) & ~feasible[near]) or (steep and _end(best))
    return Slice(
        axis=axis,
        best=axis.value(best),
        values=np.array([axis.value(float(place)) for place in places]),
        scores=scores,
        feasible=feasible,
        loss=loss,
        kind="slope at a limit" if at_limit else "peak" if steep else "plateau",
    )
