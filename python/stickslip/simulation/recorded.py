"""The recorded quantities as attributes. A type checker has them from the stub beside this file."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from stickslip.simulation.quantities import COLUMNS


class Recorded(ABC):
    """Base of a `Run`: an attribute for each quantity of the core's table."""

    @abstractmethod
    def _recorded(self, name: str) -> Any:
        """The recorded values of a quantity; raises AttributeError without any."""

    def __getattr__(self, name: str) -> Any:
        if name not in COLUMNS:
            raise AttributeError(f"a Run has no attribute {name!r}")
        return self._recorded(name)
