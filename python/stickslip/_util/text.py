"""Texts: made safe for a terminal, numbers in messages, JSON, one-line descriptions."""

from __future__ import annotations

import json
import math
import numbers
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any, TypeGuard


def printable(text: object) -> str:
    """The text with escapes for invisible characters: controls, line ends, directions."""
    text = str(text)
    if text.isprintable():
        return text
    return "".join(
        char if char.isprintable() else char.encode("unicode_escape").decode() for char in text
    )


def printable_lines(text: str) -> str:
    """The same, except for line ends."""
    return "\n".join(map(printable, text.split("\n")))


def shortened(text: object, most: int = 60) -> str:
    """The printable text, cut to `most` characters.

    Chosen: the line of an error stays one, and a pair of the library's causes fits on an axis.
    """
    text = printable(text)
    return text if len(text) <= most else f"{text[: most - 3]}..."


def quoted(text: str) -> str:
    """The text as a TOML string in double quotes.

    It has what JSON escapes, and the other control characters too: TOML has no bare DEL.
    """
    return "".join(
        char if char.isprintable() else f"\\U{ord(char):08x}"
        for char in json.dumps(text, ensure_ascii=False)
    )


def literal(value: object) -> str:
    """A text, a number, or a list of these, as TOML and Python have it."""
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(literal, value))}]"
    return quoted(value) if isinstance(value, str) else repr(value)


def counted(count: int, thing: str) -> str:
    """``1 frame`` or ``3 frames``."""
    return f"{count} {thing}{'' if count == 1 else 's'}"


def plain(name: str) -> str:
    """A name as it is compared: in lower case, with blanks."""
    return name.casefold().replace("_", " ")


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a real number; True, False and durations of NumPy are none."""
    duration = getattr(getattr(value, "dtype", None), "kind", "") == "m"  # an integer to NumPy
    return isinstance(value, numbers.Real) and not isinstance(value, bool) and not duration


def highest(limit: float) -> str:
    """A computed limit, rounded down to six digits: the printed number is allowed."""
    text = f"{limit:.6g}"
    if float(text) > limit:
        text = f"{float(text) - 10.0 ** (math.floor(math.log10(abs(limit))) - 5):.6g}"
    return text


def alike(step: float, *values: float) -> list[str]:
    """Numbers to the second digit of a step, all to the same place, so that they keep their order.

    So a value that lies in an interval is printed within it.
    """
    if not (math.isfinite(step) and step > 0.0):
        return [f"{value:.6g}" for value in values]
    places = 1 - math.floor(math.log10(step))
    return [f"{round(value, places) + 0.0:.12g}" for value in values]


def json_text(value: Any) -> str:
    """One JSON text; a number that is not finite is null.

    All characters that cannot be printed are escaped. JSON itself requires that of only half of the
    control characters, and the others, such as DEL, act on a terminal.
    """
    text = json.dumps(_finite(value), indent=2, allow_nan=False, ensure_ascii=False)
    return "".join(
        char if char == "\n" or char.isprintable() else json.dumps(char)[1:-1] for char in text
    )


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _finite(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


# Chosen: a field of so many characters, and so few entries, still fit on a line beside others.
_LONGEST, _FEW = 60, 3


class OneLine:
    """Base of a dataclass, made with ``repr=False``, whose representation is one line.

    Arrays are given by their shape and long collections by their length, so that printing one never
    fills the screen.
    """

    def __repr__(self) -> str:
        shown = [f"{field.name}={brief(getattr(self, field.name))}" for field in fields(self)  # type: ignore[arg-type]
                 if field.repr and hasattr(self, field.name)]  # fmt: skip
        return f"{type(self).__name__}({', '.join(shown)})"


def brief(value: Any) -> str:
    """A value in a few characters: an array by its shape, a long collection by its length."""
    if getattr(value, "shape", None):
        return f"array{list(value.shape)}"
    if isinstance(value, OneLine) or (is_dataclass(value) and len(repr(value)) > _LONGEST):
        return f"<{type(value).__name__}>"
    if callable(value):
        return f"<{getattr(value, '__name__', type(value).__name__)}>"
    if isinstance(value, Mapping) and len(value) > _FEW:
        return f"<{len(value)} entries>"
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        few = len(value) <= _FEW and all(isinstance(part, str | int | float) for part in value)
        if not few:
            kinds = {type(part).__name__ for part in value}
            return f"<{len(value)} {kinds.pop() if len(kinds) == 1 else 'items'}>"
    return shortened(" ".join(repr(value).split()), _LONGEST)
