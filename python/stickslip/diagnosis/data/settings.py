"""Settings of conditions as a reader sees them, and in words."""

from __future__ import annotations

import statistics
from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.units import handy
from stickslip.diagnosis.terms.amounts import digits_for

ROW = "row"
"""The setting of tables in which none is a number."""


class Settings(dict[str, tuple[list[Any], str]]):
    """Values of some conditions, `count` in all, and their SI unit, by bare name."""

    def __init__(self, columns: Mapping[str, tuple[list[Any], str]], count: int) -> None:
        super().__init__(columns)
        self.count = count
        self._digits = dict[str, int]()  # of `text`, as they are asked for

    @property
    def varied(self) -> list[str]:
        """Names of the settings that are not the same in all conditions."""
        return [name for name, (values, _) in self.items() if len(set(values)) > 1]

    @property
    def numeric(self) -> list[str]:
        """Settings that are numbers: those that vary, or all."""
        numbers = [name for name in self if not self.is_word(name)]
        return [name for name in self.varied if name in numbers] or numbers

    @property
    def most_varied(self) -> str:
        """The number that has most values; `ROW` without any."""
        return max(self.numeric, key=lambda name: len(set(self[name][0])), default=ROW)

    def is_word(self, name: str) -> bool:
        """Whether the values of a setting are words."""
        return isinstance(self[name][0][0], str | bool)

    def along(self, name: str) -> tuple[Array, str]:
        """Places of the conditions along a setting, shape (count,), and its SI unit."""
        if name == ROW:
            return np.arange(1.0, self.count + 1.0), "-"
        values, unit = self[name]
        return np.asarray(values, dtype=float), unit

    def text(self, name: str, *values: Any) -> str:
        """A setting as in ``peak 3 mT``, or a range as in ``peak 2 to 3 mT``; words as they are.

        With the digits that tell all its values apart.
        """
        if isinstance(values[0], str):
            return f"{name} {values[0]}"
        every, unit = self[name]
        factor, shown = handy(unit)
        if name not in self._digits:
            self._digits[name] = digits_for(every)
        digits = self._digits[name]
        texts = [f"{float(one) * factor:.{digits}g}" for one in dict.fromkeys(values)]
        return f"{name} {' to '.join(texts)} {shown}".rstrip()

    @property
    def usual(self) -> dict[str, Any]:
        """The value that more than half of the conditions have, by name of a number that varies.

        None where there is no such value: then each is told.
        """
        result: dict[str, Any] = {}
        for name in self.varied:
            values = self[name][0]
            if not isinstance(values[0], str):
                value = statistics.mode(values)
                result[name] = value if 2 * values.count(value) > len(values) else None
        return result

    @cached_property
    def words(self) -> list[str]:
        """Each condition by its words, the number that varies most, and those that are unusual."""
        usual = self.usual
        most = max(usual, key=lambda name: len(set(self[name][0])), default="")
        names = [*(name for name in self.varied if name not in usual), *usual]
        return [", ".join(self.text(name, self[name][0][i]) for name in names
                          if name not in usual or name == most or self[name][0][i] != usual[name])
                for i in range(self.count)]  # fmt: skip
