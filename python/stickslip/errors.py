"""The exceptions of this package."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from stickslip._util.text import printable


class ScenarioError(ValueError):
    """A scenario, or a file that belongs to one, that cannot be simulated.

    The message is one line that names the file (if there is one), the key or row, the value and
    what is allowed. Characters of a file that a terminal would obey are escaped in it.
    """

    def __init__(self, message: object) -> None:
        super().__init__(printable(message))


class NotWritten(OSError):
    """A file that could not be written; the message names it."""


@contextlib.contextmanager
def prefixed(where: object, kind: type[Exception] = ScenarioError) -> Iterator[None]:
    """Raise errors of one kind as a ScenarioError whose message begins with `where` and a colon."""
    try:
        yield
    except kind as error:
        raise ScenarioError(f"{where}: {error}") from None


class SimulationError(RuntimeError):
    """A stepped run cannot go on; the message says why and what to do."""
