"""Numbers and recorded quantities as attributes. Type checkers have them from the stub beside."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from stickslip.simulation.quantities import COLUMNS, NUMBERS


class Recorded(ABC):
    """Base of a `Run`: an attribute for each number and recorded quantity of the core's tables."""

    @abstractmethod
    def _number(self, name: str) -> float:
        """A number of the summary; raises AttributeError where the scenario asks for none."""

    @abstractmethod
    def _recorded(self, name: str) -> Any:
        """The recorded values of a quantity; raises AttributeError without any."""

    def __getattr__(self, name: str) -> Any:
        if name in NUMBERS:
            return self._number(name)
        if name in COLUMNS:
            return self._recorded(name)
        raise AttributeError(f"a Run has no attribute {name!r}")
