"""Headings of a log's columns: a name, and a unit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from stickslip._util.text import plain
from stickslip._util.units import ended, is_of, is_unit, split_unit


class Heading(NamedTuple):
    """A heading, its name, and its unit if it states one."""

    text: str
    name: str
    unit: str | None

    @staticmethod
    def of(text: str) -> Heading:
        """A heading by its text; ``_time`` or ``%time`` is a time, and ``rpm`` alone is a unit."""
        name, unit = split_unit(text)
        bare = unit is None and len(name) > 2 and is_unit(name)
        return Heading(text, name.strip("_%"), name if bare else unit)

    @property
    def words(self) -> set[str]:
        """The words of its name."""
        return {*plain(self.name).split()}

    @property
    def bare(self) -> str:
        """Its name without a unit behind an underscore or a blank."""
        return next((name for name, _ in ended(self.name)), self.name)

    @property
    def is_open(self) -> bool:
        """Whether it may be of any quantity, as it states no known unit."""
        return not ended(self.text) if self.unit is None else not is_unit(self.unit)

    def find_unit(self, units: Sequence[str]) -> Heading | None:
        """Return itself with the unit behind its name, if that is of some units."""
        made = (Heading(self.text, *parts) for parts in ended(self.text))
        return next((each for each in made if each.fits(units)), None)

    def si(self, units: Sequence[str]) -> str:
        """The one of the units that its own is of; the first of them, if of none."""
        return next((each for each in units if self.unit and is_of(self.unit, each)), units[0])

    def written(self, units: Sequence[str]) -> str:
        """The unit to write in it as one of some quantities: its own, or of counts an example."""
        counts = {"count", "counts", "tick", "ticks"} & {*self.words, self.unit}
        return "rev/4096" if counts and "rad" in units else self.unit or units[0]

    def fits(self, units: Sequence[str]) -> bool:
        """Whether it states one of the units, or one of the same quantity."""
        return any(self.unit and is_of(self.unit, each) for each in units if each != "-")
