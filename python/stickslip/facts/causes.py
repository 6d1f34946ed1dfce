"""Causes in plain words: the tables of causes.toml."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_TABLES: Mapping[str, Mapping[str, Any]] = tomllib.loads(
    Path(__file__).with_name("causes.toml").read_text(encoding="utf-8")
)


@dataclass(frozen=True)
class SizeWords:
    """How a parameter is told.

    Attributes
    ----------
    unit : str
        For people, such as degrees or %; one of the table ``units``.
    up, down : str
        Words for a value above and below zero; with them the size is told without its sign.
    """

    unit: str
    up: str = ""
    down: str = ""

    @property
    def factor(self) -> float:
        """From the SI unit to `unit`."""
        return float(_TABLES["units"][self.unit])


@dataclass(frozen=True)
class CauseWords:
    """A named effect in plain words.

    Attributes
    ----------
    name : str
        With its article.
    finding : str
        Template of a full sentence, which names the parameters of `sizes`.
    remedy : str
        What to do, as the beginning of a sentence.
    drawing : str
        Name of the drawing of its group.
    sizes : dict of SizeWords
        By the short name of the parameter.
    """

    name: str
    finding: str
    remedy: str
    drawing: str
    sizes: Mapping[str, SizeWords] = field(default_factory=dict)


@dataclass(frozen=True)
class ConstantWords:
    """A constant of the model in plain words: its name, its unit for people, and its drawing."""

    name: str
    unit: str
    drawing: str

    @property
    def size(self) -> SizeWords:
        return SizeWords(self.unit)


def _cause(entry: Mapping[str, Any]) -> CauseWords:
    sizes = {name: SizeWords(**each) for name, each in entry["sizes"].items()}
    return CauseWords(**{**entry, "sizes": sizes})


CAUSES: Mapping[str, CauseWords] = {
    name: _cause(entry) for name, entry in _TABLES["effects"].items()
}
"""By the name of the effect."""

READINGS: Mapping[str, CauseWords] = {
    name: _cause(entry) for name, entry in _TABLES["readings"].items()
}
"""Of what may be wrong with the readings of a measurement, by its name."""

CONSTANTS: Mapping[str, ConstantWords] = {
    name: ConstantWords(**entry) for name, entry in _TABLES["constants"].items()
}
"""By dotted key."""
