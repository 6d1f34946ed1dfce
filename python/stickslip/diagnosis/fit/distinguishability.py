"""Which causes these data can tell apart: the angles between their projected sensitivities."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.fit.sensitivity import UNSEEN, Sensitivities, screen
from stickslip.diagnosis.model.problem import Problem

Array = NDArray[np.float64]

SAME = 0.9
"""Causes whose projected sensitivities have a larger cosine are one distinguishability class."""


def distinguishability(problem: Problem, sensitivities: Sensitivities, residual: Array) -> Array:
    """Cosine between the projected sensitivities of all pairs of causes, shape (causes, causes).

    Each cause is taken at the amplitude that fits best; 0 for one that cannot be seen.

    Parameters
    ----------
    problem : Problem
    sensitivities : Sensitivities
        About the recalibrated model.
    residual : ndarray, shape (m + p,)
        Whitened misfit of that one, the rows of its p constants last.
    """
    chosen = np.zeros((len(problem.causes), sensitivities.raw.shape[1]))
    for index in range(len(problem.causes)):
        row = best_row(sensitivities, residual, index)
        if row is not None:
            chosen[index] = sensitivities.projected[row] / sensitivities.size[row]
    return np.asarray(np.abs(chosen @ chosen.T))


def best_row(sensitivities: Sensitivities, residual: Array, cause: int) -> int | None:
    """Row of a cause that takes most from the residual, None if none can be seen."""
    rows = np.flatnonzero((sensitivities.cause == cause) & (sensitivities.size > UNSEEN))
    if not len(rows):
        return None
    return int(rows[np.argmin(screen(sensitivities, residual).left[rows])])


def indistinguishable_causes(problem: Problem, cosines: Array) -> list[tuple[str, ...]]:
    """Groups of causes that these data can hardly tell apart, those of two and more."""
    unseen = set(range(len(cosines)))
    groups = []
    while unseen:
        group, frontier = set(), {unseen.pop()}
        while frontier:
            each = frontier.pop()
            group.add(each)
            near = {k for k in unseen if cosines[each, k] > SAME}
            unseen -= near
            frontier |= near
        if len(group) > 1:
            groups.append(tuple(problem.causes[k].name for k in sorted(group)))
    return sorted(groups)
