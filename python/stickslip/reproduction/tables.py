"""Tables: columns of numbers and words with their units, and their CSV files."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.atomic_files import replacing


@dataclass(frozen=True)
class Table:
    """Columns of one length.

    Attributes
    ----------
    columns : mapping
        Values by name.
    units : mapping of str
        SI unit by name; "1" for a pure number, "" for words.
    """

    columns: Mapping[str, Sequence[Any] | NDArray[Any]]
    units: Mapping[str, str]

    def __post_init__(self) -> None:
        if set(self.columns) != set(self.units):
            raise ValueError(f"columns {set(self.columns)} and units {set(self.units)} differ")
        if len({len(values) for values in self.columns.values()}) > 1:
            raise ValueError("the columns differ in length")

    def __getitem__(self, name: str) -> NDArray[Any]:
        return np.asarray(self.columns[name])

    def where(self, name: str, value: object) -> Table:
        """The rows that have a value in one column."""
        chosen = self[name] == value
        return Table({key: self[key][chosen] for key in self.columns}, self.units)

    def write(self, path: str | PathLike[str]) -> None:
        """Write a CSV file, whole or not at all; what is not known is an empty cell."""
        rows = zip(*(map(_cell, values) for values in self.columns.values()), strict=True)
        with (
            replacing(path) as temporary,
            temporary.open("w", newline="", encoding="utf-8") as file,
        ):
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(self.columns)
            writer.writerows(rows)


def _cell(value: Any) -> str:
    if isinstance(value, float | np.floating):
        return "" if np.isnan(value) else repr(float(value))
    return str(value)
