"""What a person is told of a fitted cause: its name, its size in a person's units, what to do."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from stickslip._util.number_text import alike
from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.model.problem import Cause
from stickslip.diagnosis.report.parameters import describe, short, with_profiles
from stickslip.facts import Fact
from stickslip.facts.causes import CAUSES, CONSTANTS, READINGS, CauseWords, SizeWords
from stickslip.scenario.keys import known_keys
from stickslip.scenario.named_effects import PREFIX

Entry = Mapping[str, float | str]

_TWICE = 1.96  # standard deviations on both sides that hold 95 % of a normal law

_NAMES = ("name", "other", "explaining", "causes", "pairs", "first", "second", "seen", "unseen")
"""Fields of facts that hold names of causes."""


@dataclass(frozen=True)
class Size:
    """One fitted parameter in a person's unit.

    Attributes
    ----------
    name : str
        Of the parameter, as files have it, without ``effects.``.
    amount : str
        The value with its unit and its error, or with the interval where the error does not fit it.
    interval : str
        Both ends that hold 95 %.
    way : str
        The word for the sign of the value; empty where there is none.
    magnitude : float
        Of the value, in the person's unit.
    error_fits : bool
        Whether one standard deviation about the value stays within the interval. Beside a lopsided
        profile it may not, as the larger side of that counts for the error.
    best : str
        The value with its unit alone.
    """

    name: str
    amount: str
    interval: str
    way: str = ""
    magnitude: float = 0.0
    error_fits: bool = True
    best: str = ""

    @property
    def text(self) -> str:
        """The amount, and the word for its sign."""
        return f"{self.amount}, {self.way}" if self.way else self.amount

    @property
    def parameter(self) -> str:
        """The last part of the name."""
        return self.name.rpartition(".")[2].replace("_", " ")


@dataclass(frozen=True)
class Told:
    """One cause of a fit in words.

    Attributes
    ----------
    name, title : str
        As files have it, and in plain words.
    finding : str
        A full sentence with the sizes.
    remedy : str
        What to do, as the beginning of a sentence; empty where nothing is known.
    drawing : str
        Name of its drawing; empty where there is none.
    sizes : tuple of Size
    meaning : str
        What the cause is, of an effect; else empty.
    listed : bool
        Whether causes.toml has words of it.
    reading : bool
        Whether it is wrong with the readings alone, so that the extended scenario is without it.
    """

    name: str
    title: str
    finding: str
    remedy: str
    drawing: str
    sizes: tuple[Size, ...]
    meaning: str = ""
    listed: bool = True
    reading: bool = False

    @property
    def way(self) -> str:
        """The word for the sign of its leading size, the largest of those in one unit."""
        return max(self.sizes, key=lambda each: each.magnitude).way if self.sizes else ""


def rounded(value: float, sd: float) -> str:
    """A value and its error, both to the error's second digit."""
    if not (math.isfinite(value) and math.isfinite(sd) and sd > 0.0):
        return f"{value:.3g} +- {sd:.2g}"
    ten = math.floor(math.log10(max(abs(value), sd)))
    ten = 0 if -3 <= ten <= 3 else ten
    places = max(1 - math.floor(math.log10(sd / 10.0**ten)), 0)
    number = f"{value / 10.0**ten:.{places}f} +- {sd / 10.0**ten:.{places}f}"
    return number if ten == 0 else f"({number})e{ten}"


def against(value: float, stated: float) -> str:
    """A constant compared with what was stated for it."""
    if stated <= 0.0:
        return f"stated as {stated:.3g}"
    ratio = value / stated
    if 0.5 <= ratio <= 2.0:
        way = "above" if ratio >= 1.0 else "below"
        return f"{abs(ratio - 1.0):.0%} {way} the stated {stated:.3g}"
    return f"{ratio:.3g} times the stated {stated:.3g}"


def plain_name(name: str, meanings: Mapping[str, str]) -> str:
    """A candidate in plain words; of a cause without any, its name, and what it means.

    `meanings` are those of the causes that may be in it.
    """
    if name == "none":
        return "no cause at all"
    if name in CAUSES or name in READINGS:
        return {**CAUSES, **READINGS}[name].name
    if name in CONSTANTS:
        return f"another {CONSTANTS[name].name} than stated"
    if " + " in name:
        return " together with ".join(plain_name(each, meanings) for each in name.split(" + "))
    meaning = meanings.get(name, "")
    return f"{name} ({meaning})" if meaning else name


def words_of(cause: Cause) -> CauseWords | None:
    """Words of an effect of the simulator, or of what may be wrong with readings; else None.

    A model of one's own may have a cause of the same name with other parameters.
    """
    for known, prefix in ((CAUSES, PREFIX), (READINGS, "")):
        words = known.get(cause.name)
        if words is not None:
            own = {f"{prefix}{cause.name}.{end}" for end in words.sizes}
            return words if {each.name for each in cause.parameters} <= own else None
    return None


def meanings_of(found: Findings) -> dict[str, str]:
    """What each cause means, by its name."""
    return {each.name: each.meaning for each in found.problem.causes}


def in_plain_words(found: Findings, fact: Fact) -> Fact:
    """The fact with the plain names of causes in place of those that files have."""
    meanings = meanings_of(found)

    def plain(value: object) -> object:
        if isinstance(value, list):
            return [plain_name(str(each), meanings) for each in value]
        return plain_name(str(value), meanings)

    plainly = {name: plain(fact.fields[name]) for name in _NAMES if name in fact.fields}
    return Fact(fact.code, {**fact.fields, **plainly})


def told(found: Findings, fit: Fit) -> tuple[Told, ...]:
    """The causes of a fit in words; errors of the verdict's own fit are those of its profiles."""
    entries = describe(found.problem, fit)
    if fit is found.verdict.fit:
        entries = with_profiles(found, entries)
    return tuple(
        _constant(found, each, entries) if each.relaxes_prior else _effect(found, each, entries)
        for each in fit.candidate.causes
    )


def _constant(found: Findings, cause: Cause, entries: Mapping[str, Entry]) -> Told:
    """A constant that is other than stated."""
    name = str(cause.relaxes_prior)
    entry = entries[name]
    key = known_keys().get(name)
    # A model of one's own may have a constant of the same name in a unit of its own.
    known = CONSTANTS.get(name) if key is not None and key.unit == entry["unit"] else None
    words = known.size if known is not None else _as_it_is(str(entry["unit"]))
    size = size_in_words(found, name, entry, words)
    stated = next(each for each in found.problem.uncertain if each.name == name)
    compared = against(
        float(entry["value"]) * _factor(words, entry),
        float(stated.prior.value(0.0)) * _factor(words, entry),
    )
    remedy = "Measure this constant again"
    if known is None:
        finding = f"The constant {size.name} is {size.text}, {compared}."
        meaning = "it is other than stated"
        return Told(cause.name, cause.name, finding, remedy, "", (size,), meaning, listed=False)
    finding = f"The {known.name} is {size.text}, {compared}."
    title = plain_name(cause.name, {})
    return Told(cause.name, title, finding, remedy, known.drawing, (size,))


def _effect(found: Findings, cause: Cause, entries: Mapping[str, Entry]) -> Told:
    """An effect of the simulator, of a user, or of a model of one's own."""
    words = words_of(cause)
    names = [each.name for each in cause.parameters if each.name in entries]
    if words is None:
        sizes = tuple(
            size_in_words(found, name, entries[name], _as_it_is(str(entries[name]["unit"])))
            for name in names
        )
        return _unlisted(cause, sizes)
    ends = {name.rpartition(".")[2]: name for name in names}
    sizes = tuple(
        size_in_words(found, name, entries[name], words.sizes[end]) for end, name in ends.items()
    )
    finding = _sentence(words, ends, entries, sizes)
    said = cause.name, words.name, finding, words.remedy, words.drawing, sizes
    # The name of what is wrong with readings says all.
    reading = cause.name in READINGS
    return Told(*said, "" if reading else cause.meaning, reading=reading)


def _sentence(
    words: CauseWords,
    ends: Mapping[str, str],
    entries: Mapping[str, Entry],
    sizes: Sequence[Size],
) -> str:
    """The sentence of a listed effect; `ends` are full names by short ones, as `sizes` has them."""
    fields = {}
    for (end, name), size in zip(ends.items(), sizes, strict=True):
        known = words.sizes[end]
        fields[end] = size.amount
        fields[f"{end}_way"] = known.up if float(entries[name]["value"]) >= 0.0 else known.down
    return words.finding.format_map(fields)


def _unlisted(cause: Cause, sizes: tuple[Size, ...]) -> Told:
    """A cause that has no words of ours: those of its meaning, with the names of its parameters."""
    said = ", ".join(f"{each.name} = {each.text}" for each in sizes)
    head = f"The data show {cause.name}"
    if cause.meaning:
        head += f" ({cause.meaning})"
    finding = f"{head}: {said}."
    return Told(cause.name, cause.name, finding, "", "", sizes, cause.meaning, listed=False)


def _as_it_is(unit: str) -> SizeWords:
    return SizeWords("" if unit == "-" else unit)


def _factor(words: SizeWords, entry: Entry) -> float:
    """From the parameter's unit to that of its words."""
    return 1.0 if words.unit == entry["unit"] else words.factor


def _with_unit(value: float, entry: Entry, words: SizeWords) -> str:
    factor = _factor(words, entry)
    text = rounded(value * factor, float(entry["sd"]) * factor)
    return f"{text} {words.unit}".rstrip()


def size_in_words(found: Findings, name: str, entry: Entry, words: SizeWords) -> Size:
    """A parameter with its error and its interval."""
    value, factor = float(entry["value"]), _factor(words, entry)
    sd = float(entry["sd"]) * factor
    low, high = (end * factor for end in interval_of(found, name, entry))
    way = words.up if value >= 0.0 else words.down
    fits = not (value * factor - sd < low or value * factor + sd > high)
    told_apart = words.up != words.down
    step = min(sd, (high - low) / 4.0)
    unit = f" {words.unit}".rstrip()
    ends = f"{' to '.join(alike(step, low, high))}{unit}"
    if told_apart and low < 0.0 < high:
        down, up = alike(step, -low, high)
        ends = f"{down}{unit} {words.down} to {up}{unit} {words.up}"
    elif words.up:
        # A size whose sign has no word begins at 0 where both signs are possible.
        least = 0.0 if low < 0.0 < high else min(abs(low), abs(high))
        low, high = least, max(abs(low), abs(high))
        ends = f"{' to '.join(alike(step, low, high))}{unit}"
    shown = abs(value) if words.up else value
    alone = f"{alike(step, shown * factor)[0]}{unit}"
    if fits:
        amount = _with_unit(shown, entry, words)
    else:
        amount = f"{alone} ({ends} with a probability of 95 %)"
    return Size(
        short(name), amount, ends, way if told_apart else "", abs(value * factor), fits, alone
    )


def interval_of(found: Findings, name: str, entry: Entry) -> tuple[float, float]:
    """Ends that hold 95 %: of the profile, where there is one, else by the standard deviation."""
    for each in found.profiles:
        if each.name == name:
            return each.interval(_TWICE**2)
    value, reach = float(entry["value"]), _TWICE * float(entry["sd"])
    return value - reach, value + reach
