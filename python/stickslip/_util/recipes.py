"""Recipes: the columns of a kind of table, with their units."""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from stickslip._util.messages import misspelt, nearest, shown
from stickslip._util.text import plain
from stickslip._util.units import ended, per_si, split_unit
from stickslip.errors import ScenarioError

VALID = "valid", "ok"
"""Columns that say which rows are valid."""


class Entry(NamedTuple):
    """A column of a recipe: its SI unit, None of words, its other names, whether dates may be."""

    unit: str | None
    also: tuple[str, ...] = ()
    required: bool = False
    clock: bool = False


class Match(NamedTuple):
    """A column of a source as a recipe knows it.

    Attributes
    ----------
    heading : str
        As it stands in the source.
    name : str
        That of the recipe; of a column that it does not know the heading.
    si, unit : str, optional
        The SI unit of its numbers, None of words; and the unit that the source states.
    per : float
        How many of the stated unit are one SI unit.
    known : bool
        Whether the recipe has it; it is information otherwise.
    clock : bool
        Whether its cells may be dates and clocks.
    """

    heading: str
    name: str
    si: str | None = None
    unit: str | None = None
    per: float = 1.0
    known: bool = True
    clock: bool = False


@dataclass(frozen=True)
class Recipe:
    """The columns of a kind of table.

    Attributes
    ----------
    entries : dict
        What each column is, by name. Headings may state other units, as ``x (mm)``.
    exact : bool
        Whether these columns and no others have to be there, and each cell has to be a number. A
        gap is NaN otherwise, and other columns are information.
    information : collection of str
        Names of others that are not taken for slips of known ones.
    lenient : bool
        Whether cells that are no numbers stay, as `Column.odd`.
    """

    entries: Mapping[str, Entry]
    exact: bool = False
    information: Collection[str] = ()
    lenient: bool = False

    @staticmethod
    def of(units: Mapping[str, str | None], required: Collection[str] = (), **more: Any) -> Recipe:
        """The recipe of columns by name and SI unit."""
        entries = {name: Entry(unit, (), name in required) for name, unit in units.items()}
        return Recipe(entries, **more)

    @property
    def names(self) -> dict[str, str]:
        """The name of a column by each of its names."""
        return {other: name for name, entry in self.entries.items()
                for other in (name, *entry.also)}  # fmt: skip

    def matched(self, headings: Sequence[str]) -> list[Match]:
        """Meanings of the columns; a ScenarioError names a unit that is not one of its column."""
        names, made = self.names, []
        for heading in headings:
            name, unit = split_unit(heading)
            if name not in names:
                parts = (each for each in ended(heading) if each[0] in names
                         and self.entries[names[each[0]]].unit not in (None, "-"))  # fmt: skip
                name, unit = next(parts, (name, unit))
            if name not in names:
                made.append(Match(heading, heading, known=False))
                continue
            entry = self.entries[names[name]]
            per = 1.0 if unit is None else per_heading(heading, unit, entry.unit or "-")
            made.append(Match(heading, names[name], entry.unit, unit, per, clock=entry.clock))
        refuse_twice([match.name for match in made])
        return made

    def check(self, columns: Sequence[Match]) -> None:
        """Refuse a table without a required column, or with one that may be meant as a known one.

        With an exact recipe every column is required, and no other one is allowed.
        """
        there = {match.name for match in columns if match.known}
        listed = ", ".join(match.heading for match in columns)
        bare = {match.name: split_unit(match.heading)[0] for match in columns if not match.known}
        for name, entry in self.entries.items():
            if (entry.required or self.exact) and name not in there:
                near = nearest(name, bare.values())
                meant = "" if near is None else f", and {shown(near)} may be meant as it"
                listed = textwrap.shorten(listed, 300, placeholder=" ...")
                raise ScenarioError(f'column "{name}" is missing; there are {listed}{meant}')
        for heading, name in bare.items():
            if self.exact:
                raise ScenarioError(
                    f"column {shown(heading)}: there is no such column; allowed are "
                    f"{', '.join(self.entries)} alone (pandas: to_csv with index=False)"
                )
            near = None if {plain(name)} & {*VALID} or name in self.information else misspelt(
                name, self.entries)  # fmt: skip
            if near and (near not in there or near.casefold() == name.casefold()):
                raise ScenarioError(
                    f'column {shown(heading)} is not known; did you mean "{near}"? '
                    "Give a column of information a name that is less like it"
                )


def per_heading(heading: str, unit: str, si: str) -> float:
    """How many of a heading's unit are one SI unit; a ScenarioError lists what is allowed."""
    try:
        return per_si(unit, si)
    except ValueError as error:
        text = f"column {shown(heading)}: {shown(unit)} is no unit of it; {error}"
        raise ScenarioError(text) from None


def refuse_twice(names: Sequence[str]) -> None:
    """Refuse columns of which two have one name."""
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ScenarioError(f"column {shown(twice[0])} is there twice")
