"""The refusal of an argument that a class does not have, in one line as that of a key."""

from __future__ import annotations

import functools
import inspect
from typing import Any, TypeVar

from stickslip._util.messages import shown, suggestion
from stickslip.errors import ScenarioError

_T = TypeVar("_T")


def known_arguments(kind: type[_T]) -> type[_T]:
    """A class whose construction refuses a name that it does not have, with those that it has."""
    made: Any = kind.__init__
    _, *known = inspect.signature(made).parameters

    @functools.wraps(made)
    def checked(self: _T, *values: Any, **named: Any) -> None:
        for name, value in named.items():
            if name not in known:
                raise ScenarioError(
                    f"{kind.__name__}: {name} = {shown(value)}: there is no such argument; "
                    f"{suggestion(name, known)}"
                )
        made(self, *values, **named)

    kind.__init__ = checked  # type: ignore[assignment]
    return kind
