"""The common part of all tables whose model is the simulator."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from stickslip._util.arrays import Array, Indices, root_mean_square
from stickslip._util.note import Note
from stickslip._util.units import handy, with_unit
from stickslip.diagnosis.data.errors import FEWEST, Errors, are_copies
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.instruments import read_by
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.scenario.keys import known_keys

_ENOUGH = 12
"""Degrees of freedom from which on repeats need no comparison. Chosen: they tell an error to 20 %.
"""


class SimulatedTable(Table):
    """Readings that the simulator predicts, and what reads them.

    `instruments` may read it wrongly; `nuisance` is what is uncertain of its own instrument.
    """

    words = ""
    """The name of its readings."""
    section = ""
    """Its section in a measurement file, as messages begin with it."""
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
        """Readings of a perfect instrument, for values of scenario keys."""
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
        """Notes on readings that can be used."""
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


def of_readings(y: Array, design: Array, condition: Indices, smallest: float, unit: str) -> Errors:
    """Errors of the means of conditions whose readings share one standard deviation.

    From repeats, if they have at least 12 degrees of freedom, or 4 and no fewer than a free fit;
    else from what that fit leaves. Free in it are the columns of `design`, shape (n, k), such as
    gains of axes or local lines. `smallest`, an error of a reading in its `unit`, is used where an
    estimate is below it, or has fewer than 4 degrees of freedom; it counts as stated. The readings
    `y` and `condition` have the shape (n,); conditions are 0 to m - 1, none missing.
    """
    count, notes = np.bincount(condition), list[Note]()
    left = y - (np.bincount(condition, y) / count)[condition]
    if are_copies(left, root_mean_square(y), len(count), notes):
        first = np.unique(condition, return_index=True)[1]
        y, design, left, count = y[first], design[first], left[first], np.ones_like(count)
    text = "A reading scatters by {}, from repeats ({} degrees of freedom)."
    dof, code = len(y) - len(count), "noise-repeats"
    if dof < _ENOUGH:
        fitted, _, rank, _ = np.linalg.lstsq(design, y, rcond=None)
        free = len(y) - int(rank)
        if dof < max(free, FEWEST):
            dof, left, code = free, y - design @ fitted, "noise-free-fit"
            text = "A reading scatters by {} about a free fit ({} degrees of freedom)."
    sd = math.sqrt(float(np.sum(left**2)) / max(dof, 1))
    known = float(dof)
    if dof < FEWEST:
        sd, known, code = smallest, math.inf, "noise-unknown"
        text = "The error of a reading is not known; {} is used ({} degrees of freedom)."
    elif sd <= smallest:
        sd, known, code = smallest, math.inf, "noise-smallest"
        text = "Readings scatter by less than {}, which is used ({} degrees of freedom)."
    size = with_unit(math.degrees(sd), "degrees") if unit == "rad" else with_unit(sd, unit)
    notes.append(Note(code, text.format(size, dof), sd))
    return Errors.alike(sd, count, known, *notes)
