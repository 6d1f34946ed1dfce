"""What a criterion says of every pair of settings, one of IPP and one of OPP."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.reproduction.settings import Mode

Flags = NDArray[np.bool_]

Numbers = Callable[[int, int], str]
"""Words with the measured numbers for one pair, given its two indices."""


@dataclass(frozen=True)
class Outcome:
    """Where a statement holds, and the numbers behind it.

    `parts` has what the statement says one by one: flags of the shape (settings of IPP, settings of
    OPP), with length 1 along a mode that is not spoken of.
    """

    parts: Mapping[str, Flags]
    numbers: Numbers

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


def of_each(flags: Mapping[Mode, Flags]) -> dict[str, Flags]:
    """One part for each mode."""
    return {"IPP": of_ipp(flags["IPP"]), "OPP": of_opp(flags["OPP"])}


def of_both(flags: Mapping[Mode, Flags]) -> Flags:
    """One part that says the same of both modes."""
    return of_ipp(flags["IPP"]) & of_opp(flags["OPP"])


def mode_by_mode(words: Callable[[Mode, int], str]) -> Numbers:
    """Numbers that are said in the same words of both modes."""
    return lambda i, j: f"{words('IPP', i)}; {words('OPP', j)}"
