"""Which causes these data can tell apart: the angles between their projected sensitivities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse.csgraph import connected_components

from stickslip.diagnosis.fit.sensitivity import Sensitivities, screen
from stickslip.diagnosis.model.problem import Array, Cause, Problem

SAME = 0.9
"""Causes whose projected sensitivities have a larger cosine are one distinguishability class.
Chosen: where one does 5 errors to the data, the other leaves at most 2.2 of them."""


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
    left = screen(sensitivities, residual).left
    chosen = np.zeros((len(problem.causes), sensitivities.raw.shape[1]))
    for index in range(len(problem.causes)):
        rows = sensitivities.seen_rows(index)
        if len(rows):
            row = rows[np.argmin(left[rows])]
            chosen[index] = sensitivities.projected[row] / sensitivities.size[row]
    return np.asarray(np.abs(chosen @ chosen.T))


def alike(problem: Problem, cosines: Array, some: Sequence[Cause], others: Sequence[Cause]) -> bool:
    """Whether data can hardly tell two candidates apart, which have as many causes.

    Each cause that only one of them has looks like one that only the other has. `cosines` are those
    of `distinguishability`.
    """
    number = {cause.name: k for k, cause in enumerate(problem.causes)}
    own, theirs = (
        [number[cause.name] for cause in these if cause not in those]
        for these, those in ((some, others), (others, some))
    )
    same = cosines[np.ix_(own, theirs)] > SAME
    return len(own) == len(theirs) and bool(same.any(axis=0).all() and same.any(axis=1).all())


def indistinguishable_causes(problem: Problem, cosines: Array) -> list[tuple[str, ...]]:
    """Groups of causes that these data can hardly tell apart, those of two and more."""
    number, group = connected_components(cosines > SAME, directed=False)
    members = [np.flatnonzero(group == k) for k in range(number)]
    return sorted(tuple(problem.causes[k].name for k in each) for each in members if len(each) > 1)
