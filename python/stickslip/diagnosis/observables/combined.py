"""All observables as one forward model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from stickslip._util.arrays import Array
from stickslip.diagnosis.model.problem import AuxiliaryData, Cause, Predict, Uncertain
from stickslip.diagnosis.observables.observable import Observable
from stickslip.diagnosis.observables.reading_errors import read_by


class Combined:
    """Velocities at the conditions, if there are any, and then the rows of each observable.

    Parameters
    ----------
    simulator : callable
        ``simulator(conditions, parameters)`` gives velocities from the columns `shared` alone.
    names : sequence of str
        Names of all columns.
    shared : sequence of str
        Columns that are scenario keys.
    observables : sequence of Observable
    suspects : sequence of Cause, optional
        What may be wrong with the velocities.
    fixed : dict, optional
        Further scenario keys, with a value that all vectors of parameters have.
    """

    def __init__(
        self,
        simulator: Predict,
        names: Sequence[str],
        shared: Sequence[str],
        observables: Sequence[Observable],
        suspects: Sequence[Cause] = (),
        fixed: Mapping[str, float] | None = None,
    ) -> None:
        self._simulator, self._suspects = simulator, tuple(suspects)
        self.observables = tuple(observables)
        self._fixed = np.array(list((fixed or {}).values()))
        self._names = (*names, *(fixed or {}))
        self._shared = [self._names.index(name) for name in (*shared, *(fixed or {}))]

    def velocities(self, conditions: Any, parameters: Array) -> Array:
        """The first rows alone, shape (vectors, conditions), also where nothing was measured.

        For a user's own model these are all rows, at whatever conditions it takes.
        """
        names, values = self._columns(self._suspects, (), self._completed(parameters))
        return read_by(
            self._suspects, names, values, lambda _, true: self._simulator(conditions, true)
        )

    def __call__(self, conditions: Sequence[Any], parameters: Array) -> Array:
        """All rows, shape (vectors, m)."""
        blocks = [self.velocities(conditions, parameters)] if len(conditions) else []
        for observable in self.observables:
            blocks.append(observable.predict(*self.arguments(observable, parameters)))
        return np.hstack(blocks)

    def arguments(self, observable: Observable, parameters: Array) -> tuple[list[str], Array]:
        """Names and values, shape (..., names), of one observable, from values of all columns."""
        own = (observable.suspects, observable.nuisance)
        return self._columns(*own, self._completed(parameters))

    def _columns(
        self, suspects: Sequence[Cause], nuisance: Sequence[Uncertain], values: Array
    ) -> tuple[list[str], Array]:
        """Those of scenario keys, in the simulator's order, and what a table has of its own."""
        own = {parameter.name for each in suspects for parameter in each.parameters}
        own |= {each.name for each in nuisance}
        columns = [*self._shared, *(k for k, name in enumerate(self._names) if name in own)]
        return [self._names[k] for k in columns], values[..., columns]

    def _completed(self, parameters: Array) -> Array:
        """With the fixed values, shape (..., all names)."""
        fixed = np.broadcast_to(self._fixed, (*parameters.shape[:-1], len(self._fixed)))
        return np.concatenate([parameters, fixed], axis=-1)


def pooled_observables(observables: Sequence[Observable]) -> AuxiliaryData | None:
    """Rows of all observables one after another."""
    if not observables:
        return None
    counts = [int(observable.group.max()) + 1 for observable in observables]
    first = np.cumsum([0, *counts[:-1]])
    return AuxiliaryData(
        np.concatenate([observable.observed for observable in observables]),
        np.asarray(block_diag(*(observable.covariance for observable in observables)), dtype=float),
        np.concatenate([each.group + k for each, k in zip(observables, first, strict=True)]),
    )
