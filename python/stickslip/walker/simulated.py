"""What all tables have in common whose model is the simulator."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from stickslip._util.arrays import Array
from stickslip._util.note import Note
from stickslip._util.units import handy
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.instruments import read_by
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.scenario.keys import known_keys


class SimulatedTable(Table):
    """Readings that the simulator predicts, and what reads them.

    `instruments` may read it wrongly; `nuisance` is what is uncertain of its own instrument.
    """

    words = ""
    """What its readings are called."""
    section = ""
    """Its section in a measurement file, as messages begin with it."""
    side = ""
    """Of which state of a walker it is, where two are compared."""
    number = 0
    """Its number among several of its kind; 0 for a single one."""
    instruments: tuple[Cause, ...]
    nuisance: tuple[Parameter, ...] = ()
    left_out: list[Note]

    @property
    def predicted(self) -> int:
        return len(self.mean)

    def of_conditions(self, predict: Callable[[Table], Array]) -> Array:
        return predict(self)

    def predict(self, names: Sequence[str], values: Array) -> Array:
        """Readings of all conditions, shape (vectors, m); NaN where there is none.

        `names` are scenario keys and parameters of `nuisance` and `instruments`; `values` have the
        shape (vectors, names).
        """
        return read_by(self.instruments, names, values, self.physics, self)

    def physics(self, names: Sequence[str], values: Array) -> Array:
        """What a perfect instrument reads, for values of scenario keys."""
        raise NotImplementedError

    def low_fidelity(self, names: Sequence[str], values: Array) -> Array:
        """The same at a lower cost, where there is a way."""
        return self.predict(names, values)

    def own_columns(self, names: Sequence[str]) -> list[int]:
        """Places of the names that count for this table: scenario keys, and its own parameters."""
        counted = {p.name for p in self.nuisance}
        counted |= {p.name for cause in self.instruments for p in cause.parameters}
        known = known_keys()
        return [k for k, name in enumerate(names) if name in known or name in counted]

    def elsewhere(self, condition: int, over: str, places: Array) -> Any:
        return None

    def remarks(self) -> list[Note]:
        """What a reader should know of readings that can be used."""
        return []

    @property
    def at(self) -> str:
        return f"{self._numbered(self.section)}: "

    @property
    def title(self) -> str:
        return f"{self._numbered(self.words)} {self.side}".rstrip()

    def _numbered(self, text: str) -> str:
        return f"{text} {self.number}" if self.number else text

    def shown_unit(self, condition: int) -> tuple[float, str]:
        return handy(self.unit_of(condition))
