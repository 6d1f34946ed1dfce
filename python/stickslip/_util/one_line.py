"""One-line descriptions of objects that hold arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

# Chosen: a field of so many characters, and so few entries, still fit on a line beside others.
_LONGEST, _FEW = 60, 3


class OneLine:
    """Base of a dataclass, made with ``repr=False``, whose representation is one line.

    Arrays are given by their shape and long collections by their length, so that printing one never
    fills the screen.
    """

    def __repr__(self) -> str:
        if not is_dataclass(self):
            return f"{type(self).__name__}()"
        shown = [
            f"{each.name}={brief(getattr(self, each.name))}"
            for each in fields(self)
            if each.repr and hasattr(self, each.name)
        ]
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
        few = len(value) <= _FEW and all(isinstance(each, str | int | float) for each in value)
        if not few:
            kinds = {type(each).__name__ for each in value}
            return f"<{len(value)} {kinds.pop() if len(kinds) == 1 else 'items'}>"
    text = " ".join(repr(value).split())
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
