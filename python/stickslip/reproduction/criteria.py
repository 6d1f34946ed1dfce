"""A statement of the paper as a criterion on the survey, and what it says of all pairs."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip.reproduction.settings import MODES
from stickslip.reproduction.survey import Flags, Survey


class Outcome(NamedTuple):
    """Where the parts of a statement hold, and the values behind them, both by name.

    Arrays broadcast to all pairs of settings, shape (settings of IPP, settings of OPP); they have
    length 1 along a mode that is not spoken of.
    """

    parts: Mapping[str, Flags]
    values: Mapping[str, NDArray[Any]]

    @property
    def holds(self) -> Flags:
        """Where all parts hold."""
        return functools.reduce(np.logical_and, self.parts.values())


@dataclass(frozen=True)
class Criterion:
    """A statement of the paper, and how it is tested."""

    name: str  # "S1" to "S14"
    text: str  # the statement, in other words than the paper's
    condition: str  # what counts as such
    numbers: str  # a format string with a field for each of the outcome's values
    evaluate: Callable[[Survey], Outcome]

    def words(self, outcome: Outcome, pair: tuple[int, int]) -> str:
        """The numbers of one pair of settings, given by its two indices."""
        i, j = pair
        at_pair = {  # the remainder is 0 along an axis of length 1
            name: each[i % each.shape[0], j % each.shape[1]]
            for name, each in outcome.values.items()
        }
        return self.numbers.format(**at_pair)


def criterion(
    name: str, text: str, condition: str, numbers: str
) -> Callable[[Callable[[Survey], Outcome]], Criterion]:
    """Make a criterion of a function of the survey."""
    return lambda function: Criterion(name, text, condition, numbers, function)


def by_mode(words: str) -> str:
    """A format string that says the same of both modes, whose name replaces MODE."""
    return "; ".join(words.replace("MODE", mode) for mode in MODES)
