"""A note: a sentence about a result that a reader could misread."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from stickslip._util.messages import known_arguments
from stickslip._util.text import printable


@known_arguments
@dataclass(frozen=True)
class Note:
    """One note; ``str()`` gives its text.

    Attributes
    ----------
    code : str
        It stays the same where the words change.
    text : str
        One line: the observation and the remedy. Control characters are escaped.
    value : float or None
        The number concerned, SI units; None without one.
    """

    code: str
    text: str
    value: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "text", printable(self.text))

    def __str__(self) -> str:
        return self.text

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)
