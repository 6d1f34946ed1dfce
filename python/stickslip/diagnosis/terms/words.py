"""Words for causes, their parameters and sizes."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from stickslip._util.note import Note
from stickslip._util.text import OneLine
from stickslip._util.toml import own_table
from stickslip._util.units import handy, unit_label
from stickslip.diagnosis.terms.amounts import amount, joined, joined_ends, number, percent
from stickslip.diagnosis.terms.cause import Cause, CauseNote
from stickslip.diagnosis.terms.parameter import Parameter

_PROBLEMS: Mapping[str, list[str]] = own_table("diagnosis/terms/problems.toml")

_NEW_WORDS = 3  # of a meaning that says more than the title


@dataclass(frozen=True, repr=False, eq=False)
class Vocabulary(OneLine):
    """The words of a model; those of a model of one's own are its user's names and meanings.

    Attributes
    ----------
    causes, constants : mapping
        By name a row with its words: `name`, `finding`, `remedy`, `drawing`, and of a cause
        `sizes`, of a constant `unit`.
    units : dict of float
        What a value in SI units is multiplied by to be told in a unit of these rows.
    problems : mapping
        Of a check that only this model's data can fail, what `data_problem` returns.
    drawing : callable
        ``drawing(name, way)`` is the drawing of a row as SVG, `way` the word for a sign.
    is_handy : callable
        Whether a parameter of this name is told in the handiest unit, such as mm for m.
    nouns : bool
        Whether the meanings of causes follow ``of``; else those that begin with an article do.
    files : dict of str
        What the files beside a report are for, by the kind of its verdict.
    """

    causes: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    constants: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    units: Mapping[str, float] = field(default_factory=dict)
    problems: Mapping[str, list[str]] = field(default_factory=dict)
    drawing: Callable[[str, str], str] = "".format
    is_handy: Callable[[str], bool] = frozenset[str]().__contains__
    nouns: bool = True
    files: Mapping[str, str] = field(default_factory=dict)


def of_side(name: str) -> tuple[str, str]:
    """A name, and of which of two sides or records of a machine it is: ``load[after]``."""
    base, _, side = name.partition("[")
    return base, side.removesuffix("]")


class Words:
    """Words of a vocabulary for causes, parameters and their sizes.

    A model of one's own has the words of its user, whatever names it shares with others. `causes`
    are those of a problem.
    """

    def __init__(self, vocabulary: Vocabulary, causes: Sequence[Cause] = ()) -> None:
        self._words, self._known = vocabulary, {cause.name: cause for cause in causes}
        self._causes, self._constants = vocabulary.causes, vocabulary.constants
        self.files = vocabulary.files

    def title(self, name: str) -> str:
        """A model in plain words that follow ``of``.

        A cause of one's own is its meaning, or its name in quotes where it has none; so is an
        effect of one's own whose meaning has an article.
        """
        if name == "none":
            return "no cause"
        return " and ".join(map(self._title, name.split(" + ")))

    def _title(self, name: str) -> str:
        cause = self._known.get(name)
        if name in self._causes:
            return str(self._causes[name]["name"])
        if cause is not None and cause.curve is not None:
            return f"a dependence of {cause.curve.law} on {cause.curve.argument}"
        constant = self._constants.get(name)
        if constant or (cause is not None and cause.frees == name):
            return f"another {constant['name'] if constant else name} than stated"
        meaning = "" if cause is None else cause.meaning.strip().rstrip(".")
        # A meaning of another cause may be a sentence.
        noun = meaning and (self._words.nouns or re.match(r"an? ", meaning))
        return meaning if noun else f"“{name}”"

    def parameter(self, name: str) -> str:
        """A constant, or a parameter of a cause, in plain words; else its key."""
        if name in self._constants:
            return str(self._constants[name]["name"])
        base, side = of_side(name)
        if side and base in self._constants:
            return f"change of {self.parameter(base)}"
        cause, _, short = name.removeprefix("effects.").rpartition(".")
        return f"{self._title(cause)}: {short.replace('_', ' ')}" if cause in self._causes else name

    def note(self, note: Note) -> str:
        """A note with causes in plain words."""
        return note.titled(self.title) if isinstance(note, CauseNote) else str(note)

    def shown_in(self, name: str, unit: str) -> tuple[float, str]:
        """Factor from the SI unit of a parameter to the one in which it is told, and its name."""
        name = of_side(name)[0]
        cause, _, parameter = name.removeprefix("effects.").rpartition(".")
        size = self._causes.get(cause, {}).get("sizes", {}).get(parameter)
        if size is None and name in self._constants:
            size = self._constants[name]
        if size is None:
            return handy(unit) if self._words.is_handy(name) else (1.0, unit_label(unit))
        return float(self._words.units[size["unit"]]), str(size["unit"])

    def description(self, cause: Cause, sizes: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
        """A cause in words: `title`, `meaning`, `finding`, `interval`, `remedy`, `drawing`, `way`.

        `sizes` are its parameters, or the constant that it frees, by full name, with `value`,
        `sd`, `low`, `high`, `unit`, whether the data show it (`shown`), the `step` of their times,
        s, and, of a constant, what was `stated`. `way` is the word for the sign of the largest;
        `meaning` is empty where the title says as much.
        """
        name, meaning = cause.name, cause.meaning
        base, side = of_side(name)
        sizes = {of_side(full)[0]: entry for full, entry in sizes.items()}
        known = self._causes.get(base)
        row = {"name": name, "title": self.title(name), "remedy": "", "way": ""}
        new = set(re.findall(r"\w+", meaning)) - set(re.findall(r"\w+", row["title"]))
        row["meaning"] = meaning if len(new) >= _NEW_WORDS else ""
        row["drawing"] = known["drawing"] if known else ""
        amounts: dict[str, str] = {}
        largest, intervals = -math.inf, []
        for full, entry in sizes.items():
            factor, unit = self.shown_in(full, entry["unit"])
            value, sd = entry["value"] * factor, entry["sd"] * factor
            short = full.rpartition(".")[2]
            words = known["sizes"].get(short, {}) if known else {}
            way = words.get("up" if value >= 0.0 else "down", "")
            amounts[short] = amount(abs(value) if way else value, sd, unit)
            amounts[f"{short}_way"] = way
            ends = entry["low"], entry["high"]
            if way and min(ends) * max(ends) > 0.0:
                ends = abs(ends[0]), abs(ends[1])
            intervals.append(self.between(full, *ends, entry["unit"]))
            if abs(value) > largest:
                largest, row["way"] = abs(value), way
        row["interval"] = " and ".join(intervals)
        constant = self._constants.get(name)
        if known is not None:
            row |= {"finding": known["finding"].format(**amounts), "remedy": known["remedy"]}
        elif cause.is_constant:
            what, size = constant["name"] if constant else f"constant {name}", sizes[name]
            stated = self.limit(name, size["stated"], size["unit"], 6)
            amount_of = amounts[name.rpartition(".")[2]]
            row["finding"] = f"The {what} is {amount_of}, and was stated as {stated}."
            row["remedy"] = "Measure it again"
            row["drawing"] = constant["drawing"] if constant else ""
        elif cause.told is not None:
            full = next(iter(sizes))
            first = sizes[full]
            text = self.size(full, abs(first["value"]), first["sd"], first["unit"])
            row["finding"] = cause.told(first["value"], text, first["step"])
        else:
            shorts = [full.rpartition(".")[2] for full, size in sizes.items() if size["shown"]]
            values = ", ".join(f"{short} = {amounts[short]}" for short in shorts)
            row["finding"] = f"{row['title'][:1].upper()}{row['title'][1:]}: {values}."
            side = ""  # which the title says
        if side:
            row["finding"] = f"Only {side}: {row['finding']}"
        return row

    def between(self, name: str, low: float, high: float, unit: str) -> str:
        """The ends of an interval of a parameter, with its unit: ``13.5 to 16.4 %``."""
        factor, shown = self.shown_in(name, unit)
        low, high = sorted((low * factor, high * factor))
        return joined_ends(low, high, shown)

    def limit(self, name: str, value: float, unit: str, digits: int = 2) -> str:
        """A value in the unit of its parameter: ``2.1 degrees``."""
        factor, shown = self.shown_in(name, unit)
        return f"{number(value * factor, digits)} {shown}".rstrip()

    def near(self, name: str, value: float, sd: float, unit: str) -> str:
        """A value to the second digit of an error: ``9.810 m/s²``."""
        factor, shown = self.shown_in(name, unit)
        return joined([value * factor], sd * factor, "", shown)

    def before(self, known: Parameter) -> str:
        """The prior of a parameter by its name, in the unit in which it is told."""
        name, unit, prior = known.name, known.unit, known.prior
        if prior is None:
            assert known.size is not None
            within = self.limit(name, known.size, unit)
            about = known.high if known.falls else known.absent
            shown = self.limit(name, about, unit) if about else "0"
            if known.falls or known.one_sided:
                way = "down" if known.falls else "on"
                return f"half-normal from {shown} {way}, 68 % within {within}"
            return f"normal about {shown}, 68 % within {within}"
        if prior.kind == "normal":
            return f"normal, {self.size(name, prior.first, prior.second, unit)}"
        if prior.kind == "log-normal":
            middle = self.limit(name, prior.first, unit, 4)
            return f"log-normal, {middle} to a factor of {prior.second:.3g}"
        low, high = (self.limit(name, end, unit) for end in (prior.first, prior.second))
        return f"{prior.kind}, {low} to {high}"

    def size(self, name: str, value: float, sd: float, unit: str) -> str:
        """A parameter with its error, in the unit in which it is told."""
        factor, shown = self.shown_in(name, unit)
        return amount(value * factor, sd * factor, shown)

    def data_problem(self, note: Note) -> list[str]:
        """Text of a failed check of the data: what it compares, how far off, what to do."""
        unknown = ["the data with what they can be", "", ""]
        what, large, do = {**_PROBLEMS, **self._words.problems}.get(note.code, unknown)
        value = note.value
        size = "" if value is None else percent(value) if note.code == "drift" else number(value, 2)
        return [what, large.format(size), do]
