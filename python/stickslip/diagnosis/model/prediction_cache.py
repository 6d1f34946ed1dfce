"""Predictions that are not made twice."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.model.problem import Predict
from stickslip.errors import ScenarioError

Array = NDArray[np.float64]

MOST_VALUES = 1 << 25
"""How many numbers a cache keeps, 256 MiB; a diagnosis of 30 conditions needs a tenth at most."""


class PredictionCache:
    """A forward model whose predictions are kept: fits begin where others have ended.

    A prediction is found again by its parameters and by the object of conditions that it was made
    for, which must not change. Beyond `most_values`, what was not asked for longest is forgotten.

    Parameters
    ----------
    predict : callable
    count : int
        How many observables it returns for each vector.
    most_values : int
        How many parameters and observables, together, are kept.
    """

    def __init__(self, predict: Predict, count: int, most_values: int = MOST_VALUES) -> None:
        self._predict = predict
        self._count = count
        self._most = most_values
        self._size = 0
        # Each row holds on to its conditions, so that no other object can take their identity.
        self._rows: OrderedDict[tuple[int, bytes], tuple[Any, Array]] = OrderedDict()

    def __call__(self, conditions: Any, parameters: Array) -> Array:
        """Observables of shape (vectors, m).

        Raises
        ------
        ScenarioError
            If that is not the shape that comes.
        """
        at = id(conditions)
        keys = [(at, row.tobytes()) for row in np.ascontiguousarray(parameters)]
        new = {key: row for key, row in zip(keys, parameters, strict=True) if key not in self._rows}
        found = {key: self._rows[key][1] for key in keys if key not in new}
        if new:
            predicted = np.asarray(self._predict(conditions, np.stack(list(new.values()))))
            if predicted.shape != (len(new), self._count):
                raise ScenarioError(
                    f"predict: of {len(new)} vectors of parameters it returned shape "
                    f"{predicted.shape}; allowed is (vectors, observables), here "
                    f"{(len(new), self._count)}"
                )
            # A row by itself, as a view would keep all rows of its call.
            found |= {
                key: row.copy() for key, row in zip(new, predicted.astype(float), strict=True)
            }
        for key in dict.fromkeys(keys):
            self._keep(key, conditions, found[key])
        return np.stack([found[key] for key in keys])

    def _keep(self, key: tuple[int, bytes], conditions: Any, row: Array) -> None:
        if key in self._rows:
            self._rows.move_to_end(key)
            return
        self._rows[key] = (conditions, row)
        self._size += _values(key, row)
        while self._size > self._most and self._rows:
            oldest, (_, lost) = self._rows.popitem(last=False)
            self._size -= _values(oldest, lost)


def _values(key: tuple[int, bytes], row: Array) -> int:
    return len(key[1]) // 8 + row.size
