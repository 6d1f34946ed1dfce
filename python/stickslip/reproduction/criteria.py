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
    """By how much the parts of a statement hold, and the values behind them, both by name.

    A margin is a pure number, from zero where the part holds, and below zero where it does not.
    Arrays broadcast to all pairs of settings, shape (settings of IPP, settings of OPP); they have
    length 1 along a mode that is not spoken of.
    """

    margins: Mapping[str, NDArray[Any]]
    values: Mapping[str, NDArray[Any]]

    @property
    def parts(self) -> dict[str, Flags]:
        """Where each part holds; not where its margin is NaN."""
        return {name: np.asarray(margin >= 0.0) for name, margin in self.margins.items()}

    @property
    def holds(self) -> Flags:
        """Where all parts hold."""
        return functools.reduce(np.logical_and, self.parts.values())

    @property
    def margin(self) -> NDArray[Any]:
        """The least of all parts."""
        return functools.reduce(np.minimum, self.margins.values())


def above(value: Any, limit: Any) -> Any:
    """The margin of a value that is to be above a limit: their difference over their sum."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return (value - limit) / (np.abs(value) + np.abs(limit))


def if_also(margin: Any, condition: Any) -> Any:
    """A margin where a condition is met, and -1 at most where it is not."""
    return np.minimum(margin, np.where(condition, np.inf, -1.0))


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
