"""Errors of values that are not allowed and of unknown names."""

from __future__ import annotations

import difflib
import functools
import inspect
import itertools
import math
import numbers
from collections.abc import Iterable, Mapping
from os import PathLike
from typing import Any, NoReturn, TypeVar

from stickslip._util.text import is_number, quoted, shortened
from stickslip.errors import ScenarioError

_T = TypeVar("_T")

MOST_VALUES = 10_000_000
"""Values of the longest list, and points of the largest sweep, whose results take 1.5 GB."""

_SLIP = 0.8
"""Likeness of a misspelt word. Chosen: one letter of five; "time" and "edge_time" have 0.6."""


def shown(value: object) -> str:
    """A value as a file would have it, on one line and shortened."""
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, str):
        text = quoted(value)
    elif isinstance(value, numbers.Real) and not isinstance(value, numbers.Integral):
        text = repr(float(value))
    elif isinstance(value, Mapping):
        text = "{ " + ", ".join(f"{key} = {shown(part)}" for key, part in value.items()) + " }"
    else:
        try:
            text = " ".join(repr(value).split())
        except ValueError:  # an integer of thousands of digits
            text = "a number too long to print"
    return shortened(text)


def refuse(key: str, value: object, allowed: str) -> NoReturn:
    """Raise the one-line error of a value that is not allowed."""
    raise ScenarioError(f"{key} = {shown(value)}: allowed is {allowed}") from None


def check_whole(name: str, value: object, least: int = 0) -> None:
    """Refuse what is not a whole number from `least`."""
    if not is_number(value) or not isinstance(value, numbers.Integral) or value < least:
        refuse(name, value, f"a whole number from {least}")


def check_above_zero(name: str, value: object, unit: str) -> None:
    """Refuse what is not a finite number above 0."""
    if not (is_number(value) and 0.0 < value < math.inf):
        refuse(name, value, f"a finite number of {unit} above 0")


def check_kind(name: str, value: object, kind: type) -> None:
    """Refuse what is not of a class."""
    if not isinstance(value, kind):
        of_a_file = isinstance(value, str | PathLike) and kind.__name__ == "Scenario"
        hint = ", such as stickslip.load makes of a file" if of_a_file else ""
        hint += ", such as a dict" if kind is Mapping else ""
        article = "an" if kind.__name__[0] in "AEIO" else "a"
        refuse(name, value, f"{article} {kind.__name__}{hint}")


def as_list(name: str, values: object, allowed: str) -> list[Any]:
    """The values of an iterable that is neither text nor mapping; `allowed` names it in errors."""
    if isinstance(values, str | bytes | Mapping):
        refuse(name, values, allowed)
    try:
        first = list(itertools.islice(values, MOST_VALUES + 1))  # type: ignore[call-overload]
    except TypeError:  # not iterable, such as an array without dimensions
        refuse(name, values, allowed)
    if len(first) > MOST_VALUES:
        raise ScenarioError(f"{name}: allowed are at most {MOST_VALUES} values")
    return first


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The name of `known` most similar to a word, whatever its case; None if none is similar."""
    names = {name.casefold(): name for name in known}
    near = difflib.get_close_matches(word.casefold(), names, n=1, cutoff=0.6)
    return names[near[0]] if near else None


def misspelt(word: str, known: Iterable[str]) -> str | None:
    """The name of `known` that a word misspells or abbreviates, else None.

    Stricter than `nearest`: the word may be none of them.
    """
    whole = next((name for name in known if name.casefold().startswith(word.casefold())), None)
    near = nearest(word, known) or ""
    alike = difflib.SequenceMatcher(None, word.casefold(), near.casefold()).ratio()
    return whole or (near if alike >= _SLIP else None)


def suggestion(word: str, known: Iterable[str], listed: Iterable[str] | None = None) -> str:
    """The name of `known` that was probably meant, else all of `listed` (by default `known`)."""
    known = list(known)
    near = nearest(word, known)
    if near is not None:
        return f'did you mean "{near}"?'
    return "known are " + ", ".join(f'"{name}"' for name in (known if listed is None else listed))


def meant(word: object, known: Iterable[str]) -> str:
    """The probable name, for a sentence that lists all of `known`; "" if none is near."""
    near = nearest(word, known) if isinstance(word, str) else None
    return "" if near is None else f'; did you mean "{near}"?'


def known_arguments(kind: type[_T]) -> type[_T]:
    """Make a class refuse unknown arguments in one line, with the known ones."""
    made: Any = kind.__init__

    @functools.wraps(made)
    def checked(self: _T, *values: Any, **named: Any) -> None:
        try:
            made(self, *values, **named)
        except TypeError:  # looked at only here: what is right costs no time
            signature = inspect.signature(kind)
            wrong = next((name for name in named if name not in signature.parameters), "")
            hint = suggestion(wrong, signature.parameters)
            if wrong:
                refusal = f"{wrong} = {shown(named[wrong])}: there is no such argument; {hint}"
                raise ScenarioError(f"{kind.__name__}: {refusal}") from None
            try:
                signature.bind(*values, **named)
            except TypeError as error:
                raise ScenarioError(f"{kind.__name__}: {error}; {hint}") from None
            raise

    kind.__init__ = checked  # type: ignore[assignment]
    return kind
