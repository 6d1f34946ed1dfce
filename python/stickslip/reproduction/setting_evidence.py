"""Which of the paper's statements cannot hold together, with the pairs of settings as evidence."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.reproduction.reference import MOTION
from stickslip.reproduction.statements import CRITERIA

Array = NDArray[np.float64]

NAMES = tuple(each.name for each in CRITERIA)
"""The statements that depend on settings, S1 to S14."""


class StatementScore(NamedTuple):
    """One statement among all pairs for which S1 to S4 hold."""

    name: str
    pairs: int  # for which it holds
    margin: float  # the greatest; below zero where it never holds
    most: int  # statements that hold together with it, itself included; 0 where it never holds


class Conflict(NamedTuple):
    """Two statements that hold with S1 to S4, but not both."""

    first: str
    second: str
    first_margin: float  # the greatest of the first where the second holds
    second_margin: float  # and the other way round


class Evidence(NamedTuple):
    """What all pairs say that were simulated and keep S1 to S4."""

    kept: int  # such pairs
    most: int  # statements that hold together
    failing: dict[tuple[str, ...], int]  # what fails where the most hold, and for how many pairs
    scores: list[StatementScore]
    conflicts: list[Conflict]


def evidence(margins: Array) -> Evidence:
    """From the margins of all statements, shape (pairs, 14)."""
    kept = margins[(margins[:, :MOTION] >= 0.0).all(axis=1)]
    holds = kept >= 0.0
    counts = holds.sum(axis=1)
    most = int(counts.max(initial=0))
    failing: dict[tuple[str, ...], int] = {}
    for row in holds[counts == most]:
        names = tuple(name for name, held in zip(NAMES, row, strict=True) if not held)
        failing[names] = failing.get(names, 0) + 1
    trends = range(MOTION, len(NAMES))
    scores = [
        StatementScore(
            NAMES[k],
            int(holds[:, k].sum()),
            float(kept[:, k].max(initial=-np.inf)),
            int(counts[holds[:, k]].max(initial=0)),
        )
        for k in trends
    ]
    conflicts = [
        Conflict(
            NAMES[a], NAMES[b], float(kept[holds[:, b], a].max()), float(kept[holds[:, a], b].max())
        )
        for a, b in itertools.combinations(trends, 2)
        if holds[:, a].any() and holds[:, b].any() and not (holds[:, a] & holds[:, b]).any()
    ]
    return Evidence(len(kept), most, failing, scores, conflicts)
