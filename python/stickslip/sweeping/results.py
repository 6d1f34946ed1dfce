"""The results of a sweep's points, which come in any order."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.simulation.columns import NUMBERS
from stickslip.sweeping.worker import ChunkResult

NOT_RUN = -2
REFUSED = -1
OK = 0

STATUSES = {
    NOT_RUN: "not_run",
    REFUSED: "refused",
    **dict(enumerate(_core.statuses)),
}
"""Names of all statuses by number; `refused` is a point whose values make no scenario."""

PAINLEVE = "painleve"
EVENTS = tuple(name for name in _core.events if name != PAINLEVE)
"""Kinds of event that are counted in `events`."""


class Results:
    """What is known of each of n points so far; arrays have an entry, or a row, for each."""

    def __init__(self, count: int) -> None:
        self.status = np.full(count, NOT_RUN, dtype=np.int8)  # keys of `STATUSES`
        # By name as in `NUMBERS`; NaN where the point failed or was not run.
        self.numbers = {name: np.full(count, np.nan) for name in NUMBERS}
        self.events = np.zeros((count, len(EVENTS)), dtype=np.int64)  # counts
        self.painleve_events = np.zeros(count, dtype=np.int64)  # counts
        self.messages: dict[int, str] = {}  # by point, of those that failed
        self.finished = 0

    @property
    def complete(self) -> bool:
        """Whether every point was run."""
        return self.finished == len(self.status)

    def pending(self) -> NDArray[np.int64]:
        """Indices of the points that were not run."""
        return np.flatnonzero(self.status == NOT_RUN)

    def put(self, indices: NDArray[np.int64], part: ChunkResult) -> None:
        """Take the results of the points `indices`; of one that failed, its simulated time only."""
        columns: dict[str, NDArray[Any]] = part.columns
        self.status[indices] = columns["status"]
        failed = columns["status"] != OK
        for name, values in self.numbers.items():
            lost = failed & (name != "simulated_time")
            values[indices] = np.where(lost, np.nan, columns[name])
        self.events[indices] = np.column_stack([columns[kind] for kind in EVENTS])
        self.painleve_events[indices] = columns[PAINLEVE]
        for place, text in part.messages.items():
            self.messages[int(indices[place])] = text
        self.finished += len(indices)

    def counts(self) -> dict[str, int]:
        """Number of points by status, of those statuses that occur."""
        codes, counts = np.unique(self.status, return_counts=True)
        return {STATUSES[code]: n for code, n in zip(codes.tolist(), counts.tolist(), strict=True)}
