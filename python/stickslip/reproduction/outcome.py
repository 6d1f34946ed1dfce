"""What a criterion says of every pair of settings, one of IPP and one of OPP."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Outcome:
    """Where a statement holds, and the numbers behind it.

    Attributes
    ----------
    parts : dict of numpy.ndarray of bool
        What the statement says one by one; each has the shape (settings of IPP, settings of OPP)
        or one that broadcasts to it. What is said of one mode alone has length 1 along the other.
    numbers : callable
        Words with the measured numbers for one pair, given its two indices.
    """

    parts: Mapping[str, Flags]
    numbers: Callable[[int, int], str]

    @property
    def holds(self) -> Flags:
        """Where all parts hold."""
        result: Flags = np.ones((1, 1), dtype=bool)
        for part in self.parts.values():
            result = result & part
        return result


def of_ipp(flags: Flags) -> Flags:
    """Flags of the settings of IPP, as a column."""
    return flags[:, np.newaxis]


def of_opp(flags: Flags) -> Flags:
    """Flags of the settings of OPP, as a row."""
    return flags[np.newaxis, :]
