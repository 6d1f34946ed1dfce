"""An input of a record as it acts: held between readings or a line, slow, and late."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import lapack

from stickslip._util.arrays import Array
from stickslip._util.text import OneLine


@dataclass(frozen=True, repr=False, eq=False)
class Signal(OneLine):
    """An input of a record for each of a batch of parameter vectors, and its delay.

    Attributes
    ----------
    t : ndarray, shape (rows,)
        Times of the readings, s.
    values : ndarray, shape (vectors, rows)
        What it was from each time on, if it is held; else at each time, with lines between them.
    held : bool
    first : ndarray, shape (vectors,)
        What it was before the first time.
    late : ndarray, shape (vectors,)
        By how much it acts later, s.
    """

    t: Array
    values: Array
    held: bool
    first: Array
    late: Array

    @classmethod
    def of(cls, t: Array, values: Array, held: bool) -> Signal:
        """An input as it was recorded, shape (vectors, rows)."""
        return cls(t, values, held, values[:, 0], np.zeros(len(values)))

    def delayed(self, time: Array, before: Array) -> Signal:
        """The same later by a time, s, and at first a part of its first value, (vectors,)."""
        return replace(self, first=self.values[:, 0] * before, late=self.late + time)

    def lagged(self, time: Array, first: Array) -> Signal:
        """Behind a first-order lag that is at a value at the first time, (vectors,).

        v' = (u - v) / time is solved exactly. A held input becomes the mean of v from each reading
        to the next, so that its momentum is right.
        """
        gap, result = np.diff(self.t), self.values.copy()
        for vector in np.flatnonzero(time > 0.0):
            tau, u = time[vector], self.values[vector]
            kept = np.exp(-gap / tau)
            slope = 0.0 if self.held else np.diff(u) / gap
            band = np.ones((2, len(gap) + 1))
            band[1, :-1] = -kept
            rest = (1.0 - kept) * (u[:-1] - tau * slope) + slope * gap
            v = lapack.dtbtrs(band, np.r_[first[vector], rest][:, None], uplo="L")[0][:, 0]
            result[vector] = np.r_[u[:-1] - tau * np.diff(v) / gap, v[-1]] if self.held else v
        return replace(self, values=result, first=np.where(time > 0.0, first, self.first))

    def sampled(self) -> Array:
        """Values at the readings, (vectors, rows); of a held input its mean until the next one."""
        result, gap = self.values.copy(), np.diff(self.t)
        # A delay of zero leaves the very numbers.
        for k in np.flatnonzero(self.late):
            u, first, at = self.values[k], self.first[k], self.t - self.late[k]
            if not self.held:
                result[k] = np.interp(at, self.t, u, left=first)
                continue
            piece = np.clip(np.searchsorted(self.t, at, side="right") - 1, 0, None)
            since = at - self.t[piece]
            before, acts = since < 0.0, u[piece]
            acts[before] = first
            whole = np.r_[0.0, np.cumsum(gap * u[:-1])][piece] + acts * since
            result[k] = np.r_[np.diff(whole) / gap, acts[-1]]
        return result
