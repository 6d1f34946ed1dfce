"""Which seeds were used, by what: the ranges of seeds.toml beside."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from stickslip._util.toml import parse_toml

TABLE = Path(__file__).with_suffix(".toml")


class Range(NamedTuple):
    """Seeds of a study, and what they were used for; see the head of the file."""

    study: str
    first: int
    count: int
    purpose: str
    commit: str = ""

    @property
    def seeds(self) -> range:
        return range(self.first, self.first + self.count)

    @property
    def closed(self) -> bool:
        """Whether a new count of it would be no rate: its sets were judged before."""
        return self.purpose == "judged" and bool(self.commit)


def ranges(study: str = "") -> list[Range]:
    """All ranges, or those of a study, in the order of the file."""
    every = [Range(**row) for row in parse_toml(TABLE.read_text())["range"]]
    return [each for each in every if study in ("", each.study)]


def of(study: str, seed: int) -> Range | None:
    """The range of a seed."""
    return next((each for each in ranges(study) if seed in each.seeds), None)


def used(study: str, seeds: Iterable[int]) -> list[str]:
    """Reasons against judging these seeds, a line for each range that is closed or unknown."""
    found = {}
    for seed in seeds:
        one = of(study, seed)
        if one is None or one.closed:
            found.setdefault(one, seed)
    return [
        f"{study}: seed {seed} is in no range of {TABLE.name}; state it there first" if one is None
        else f"{study}: seeds from {one.first} were judged at {one.commit}; allowed are an open "
        f"range of {TABLE.name}, or one by which rules are chosen"
        for one, seed in found.items()
    ]  # fmt: skip
