"""The keys of a scenario: what the core knows of each, and the check of a single value.

The compiled core decides what a number or a word may be. Here stands only what it cannot see: the
type that a value had before it became a number.
"""

from __future__ import annotations

import difflib
import functools
import json
import keyword
import math
import numbers
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Literal, NoReturn, ParamSpec, TypeVar, cast

from stickslip import _core
from stickslip._util.text import quoted
from stickslip._util.units import unit_meant
from stickslip.errors import ScenarioError
from stickslip.scenario.path_keys import PATHS

Value = float | int | str
"""What a scalar key of a scenario can hold."""

RECORD_RATE = "record.rate"
RECORD_WORDS = ("none", "events")
RECORD_FIELDS = "record.fields"
ALL_FIELDS = "all"
"""The value of `RECORD_FIELDS` that keeps all."""

DTYPES = ("float64", "float32")

_MOST_DEGREES = 360.0  # a larger number is hardly an angle

_USUAL = {"T": 1e-3}
"""Size that numbers of a unit have where a key is 0 by default."""

_LONGEST_SHOWN = 60  # characters of a value in an error; chosen: the error stays one line

_P = ParamSpec("_P")
_R = TypeVar("_R")
_forgetting: list[Callable[[], None]] = []


def until_registration(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Cache what depends on the keys until the user registers an effect, which adds keys."""
    cached = functools.cache(function)
    _forgetting.append(cached.cache_clear)
    return cast("Callable[_P, _R]", cached)


def forget_keys() -> None:
    """Clear all that `until_registration` keeps."""
    for forget in _forgetting:
        forget()


@dataclass(frozen=True)
class Key:
    """One scalar key of a scenario.

    Attributes
    ----------
    name : str
        Dotted key, such as ``"drive.frequency"``.
    kind : {"real", "whole", "word", "rate", "fields"}
        What it holds; ``"rate"`` is a number or a word, ``"fields"`` names of recorded quantities.
    allowed : str
        The range or the words, for a reader.
    default : float, int or str
        Value that a scenario has where none is given.
    meaning : str
        What it is, in a phrase.
    unit : str
        SI unit; ``"-"`` for none.
    low, high : float
        Range of a number; NaN for a word.
    words : tuple of str
        The words that it takes; of ``"fields"``, one or more of them.
    """

    name: str
    kind: Literal["real", "whole", "word", "rate", "fields"]
    allowed: str
    default: Value
    meaning: str
    unit: str = "-"
    low: float = math.nan
    high: float = math.nan
    words: tuple[str, ...] = ()

    @property
    def section(self) -> str:
        """Everything before the last dot."""
        return self.name.rpartition(".")[0]


def _one_of(words: Iterable[str]) -> str:
    return "one of " + ", ".join(map(json.dumps, words))


_RECORD_KEYS = (
    Key(
        RECORD_RATE,
        "rate",
        'a number above 0 Hz, "events" or "none"',
        "none",
        "rate of the uniform output grid, or one record an event, or no record",
        *("Hz", 0.0, math.inf),
        RECORD_WORDS,
    ),
    Key(
        "record.from",
        "real",
        "a number from 0 s to the run's duration",
        0.0,
        "simulated time before which nothing is recorded",
        *("s", 0.0, math.inf),
    ),
    Key(
        RECORD_FIELDS,
        "fields",
        '"all", or some of ' + ", ".join(_core.record_columns),
        ALL_FIELDS,
        "recorded quantities, with commas between them; t is always there",
        words=(ALL_FIELDS, *_core.record_columns),
    ),
    Key(
        "record.dtype",
        "word",
        _one_of(DTYPES),
        DTYPES[0],
        "precision of the recorded numbers; t always has float64",
        words=DTYPES,
    ),
)
"""Keys that the core has no table of."""


def field_of(key: str) -> str:
    """The field of a section's class that holds a key: ``from`` is a word of Python."""
    name = key.rpartition(".")[2]
    return f"{name}_" if keyword.iskeyword(name) else name


@until_registration
def known_keys() -> dict[str, Key]:
    """All scalar keys by name, section by section."""
    words = [
        Key(
            *(row["key"], "word", _one_of(row["allowed"]), row["default"], row["meaning"]),
            words=tuple(row["allowed"]),
        )
        for row in _core.choices()
    ]
    numbers = [
        Key(
            row["key"],
            "whole" if row["integer"] else "real",
            row["allowed"],
            int(row["default"]) if row["integer"] else row["default"],
            *(row["meaning"], row["unit"], row["low"], row["high"]),
        )
        for row in _core.parameters()
    ]
    sections = list(dict.fromkeys(key.section for key in numbers))
    sections.insert(sections.index("solver") + 1, "record")
    keys = sorted([*words, *numbers, *_RECORD_KEYS], key=lambda key: sections.index(key.section))
    return {key.name: key for key in keys}


def shown(value: object) -> str:
    """A value as it would stand in a file, on one line and not too long."""
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, str):
        text = quoted(value)
    elif isinstance(value, numbers.Real) and not isinstance(value, numbers.Integral):
        text = repr(float(value))
    elif isinstance(value, Mapping):
        text = "{ " + ", ".join(f"{key} = {shown(each)}" for key, each in value.items()) + " }"
    else:
        try:
            text = " ".join(repr(value).split())
        except ValueError:  # an integer of thousands of digits
            text = "a number too long to print"
    return text if len(text) <= _LONGEST_SHOWN else text[: _LONGEST_SHOWN - 3] + "..."


_SLIP = 0.8
"""Likeness of a misspelt word. Chosen: one letter of five; "time" and "edge_time" have 0.6."""


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The name of `known` that is most like a word, in whatever case; None if none is like it."""
    names = {name.casefold(): name for name in known}
    near = difflib.get_close_matches(word.casefold(), names, n=1, cutoff=0.6)
    return names[near[0]] if near else None


def misspelt(word: str, known: Iterable[str]) -> str | None:
    """The name of `known` that a word is with a slip or two, or cut short; None if it is another.

    Stricter than `nearest`, as the word may well be none of them.
    """
    whole = next((name for name in known if name.casefold().startswith(word.casefold())), None)
    near = whole or nearest(word, known)
    if near is None or whole:
        return near
    alike = difflib.SequenceMatcher(None, word.casefold(), near.casefold()).ratio()
    return near if alike >= _SLIP else None


def suggestion(word: str, known: Iterable[str], listed: Iterable[str] | None = None) -> str:
    """What was probably meant of `known`, or all of `listed`, which is `known` if not given."""
    known = list(known)
    near = nearest(word, known)
    if near is not None:
        return f'did you mean "{near}"?'
    return "known are " + ", ".join(f'"{each}"' for each in (known if listed is None else listed))


def meant(word: object, known: Iterable[str]) -> str:
    """What was probably meant, after a sentence that lists all of `known`; "" for nothing."""
    near = nearest(word, known) if isinstance(word, str) else None
    return "" if near is None else f'; did you mean "{near}"?'


def in_allowed_case(key: Key, word: str) -> str:
    """A word as the key allows it: an apparatus may write "ipp", "+X", "x" or another minus."""
    word = word.replace("\N{MINUS SIGN}", "-")
    spelt = (word, word.upper(), word.lower(), f"+{word.lower()}")
    return next((each for each in spelt if each in key.words), word)


def refuse(key: str, value: object, allowed: str) -> NoReturn:
    """Raise the one-line error of a value that is not allowed."""
    raise ScenarioError(f"{key} = {shown(value)}: allowed is {allowed}")


def check_whole(name: str, value: object, least: int = 0) -> None:
    """Refuse what is not a whole number from `least`."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral) or value < least:
        refuse(name, value, f"a whole number from {least}")


def check_kind(name: str, value: object, kind: type) -> None:
    """Refuse what is not of a class of this package."""
    if not isinstance(value, kind):
        of_a_file = isinstance(value, str | PathLike) and kind.__name__ == "Scenario"
        hint = ", such as stickslip.load makes of a file" if of_a_file else ""
        refuse(name, value, f"a {kind.__name__}{hint}")


def section_hint(section: str) -> str:
    """The section that was probably meant, or all of them, with the extensions as one."""
    sections = dict.fromkeys(key.section for key in known_keys().values())
    listed = dict.fromkeys(each.partition(".")[0] for each in sections)
    return suggestion(section, sections, listed)


def key_hint(name: str, others: Iterable[str] = ()) -> str:
    """The key that was probably meant, by its whole name or its last word, or what there is.

    `others` are names of another kind that may be meant too.
    """
    keys = known_keys()
    section = name.rpartition(".")[0]
    siblings = [key.name for key in keys.values() if key.section == section]
    if siblings:
        return suggestion(name, siblings)
    last = {} if section else {key.rpartition(".")[2]: key for key in reversed(keys)}
    near = nearest(name, [*keys, *last, *others])
    return section_hint(section) if near is None else f'did you mean "{last.get(near, near)}"?'


def full_name(name: str) -> str:
    """The dotted key of a parameter of an effect that is named without ``effects.``."""
    keys = known_keys()
    return f"effects.{name}" if name not in keys and f"effects.{name}" in keys else name


def is_of_one_coil(key: str) -> bool:
    """Whether a key is of a single coil, such as ``coil.xp.turns``."""
    return key.startswith("coil.") and key.count(".") > 1


def find_key(name: str, *value: object) -> Key:
    """The key of that name, or an error that names the nearest one, and the value if there is."""
    keys = known_keys()
    if name in keys:
        return keys[name]
    given = " = ".join([name, *map(shown, value)])
    if name in PATHS:
        raise ScenarioError(f"{given}: there is no such key here; {PATHS[name]}")
    raise ScenarioError(f"{given}: there is no such key; {key_hint(name)}")


def checked(name: str, value: object, core: _core.Scenario | None = None) -> Value:
    """The value of a key, converted to float, int or str, if the core allows it.

    `core`, if given, gets it too, but for those of the record.
    """
    core = _core.Scenario() if core is None else core
    key = find_key(name, value)
    if key.section == "record":  # the core takes them together
        return _checked_record(key, value)
    if key.kind == "word":
        if not isinstance(value, str):
            refuse(name, value, key.allowed)
        converted: float | str = str(value)
    else:
        converted = _as_number(key, value)
    try:
        core.set(name, converted)
    except (ValueError, TypeError):  # the latter of a word that is not UTF-8
        refuse(name, value, key.allowed + meant(value, key.words) + _unit_meant(key, value))
    return int(converted) if key.kind == "whole" else converted


def in_radians(degrees: float) -> str:
    """A sentence that says what an angle in degrees is in the unit of all keys."""
    return f"{degrees:g} degrees are {math.radians(degrees):.4g} rad"


def _unit_meant(key: Key, value: object) -> str:
    """What a number beyond its range is in degrees, mT, um or ug; "" where that is no help."""
    if not isinstance(value, numbers.Real) or isinstance(key.default, str):
        return ""
    given = float(value)
    if key.unit == "rad":
        within = key.low <= math.radians(given) <= key.high and abs(given) <= _MOST_DEGREES
        return f"; {in_radians(given)}" if within else ""
    usual = abs(key.default) or _USUAL.get(key.unit, math.inf)
    unit, factor = unit_meant(key.unit, abs(given) / usual, math.inf) or ("", math.nan)
    within = key.low <= given / factor <= key.high
    return f"; {given:g} {unit} are {given / factor:g} {key.unit}" if within else ""


def recorded_fields(fields: str) -> tuple[str, ...]:
    """The quantities that a checked value of `RECORD_FIELDS` keeps, t first."""
    if fields == ALL_FIELDS:
        return tuple(_core.record_columns)
    kept = {"t", *fields.split(", ")}
    return tuple(name for name in _core.record_columns if name in kept)


def _as_number(key: Key, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        refuse(key.name, value, key.allowed)
    try:
        return float(value)
    except OverflowError:
        refuse(key.name, value, key.allowed)


def _checked_record(key: Key, value: object) -> Value:
    if key.kind == "fields":
        return _checked_fields(key, value)
    if key.words and isinstance(value, str):
        if value not in key.words:
            refuse(key.name, value, key.allowed + meant(value, key.words))
        return str(value)
    if key.kind == "word":
        refuse(key.name, value, key.allowed)
    number = _as_number(key, value)
    is_allowed = number > 0.0 if key.kind == "rate" else number >= 0.0
    if not (math.isfinite(number) and is_allowed):
        refuse(key.name, value, key.allowed)
    return number


def _checked_fields(key: Key, value: object) -> str:
    """Names with commas between them, each once and in the order of the columns."""
    names = value.split(",") if isinstance(value, str) else value
    if not isinstance(names, list | tuple) or not all(isinstance(each, str) for each in names):
        refuse(key.name, value, key.allowed)
    names = {each.strip() for each in names}
    if names == {ALL_FIELDS}:
        return ALL_FIELDS
    unknown = sorted(names - {*_core.record_columns})
    if unknown or not names:
        hint = "it names nothing"
        if unknown:
            near = meant(unknown[0], _core.record_columns)
            hint = f"{shown(unknown[0])} is none of them{near}"
        refuse(key.name, value, f"{key.allowed}; {hint}")
    return ", ".join(name for name in _core.record_columns if name in names)
