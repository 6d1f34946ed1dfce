"""Predictions that are not made twice."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

import numpy as np

from stickslip.diagnosis.model.problem import Array, Predict
from stickslip.errors import ScenarioError

# How many numbers a cache keeps, 256 MiB. A diagnosis of 30 conditions needs a tenth at most.
_MOST_VALUES = 1 << 25


class PredictionCache:
    """A forward model whose predictions are kept: fits begin where others have ended.

    A prediction is found again by its parameters and by the object of conditions that it was made
    for, which must not change. `count` is the number of observables that `predict` returns for each
    vector. Beyond `most_values` parameters and observables together, the prediction whose last use
    is longest ago is dropped first.
    """

    def __init__(self, predict: Predict, count: int, most_values: int = _MOST_VALUES) -> None:
        self._predict = predict
        self._count = count
        self._most = most_values
        # Each row holds on to its conditions, so that no other object can take their identity.
        self._rows: OrderedDict[tuple[int, bytes], tuple[Any, Array]] = OrderedDict()

    def __call__(self, conditions: Any, parameters: Array) -> Array:
        """Observables of shape (vectors, m).

        Raises
        ------
        ScenarioError
            If `predict` returns another shape.
        """
        keys = [(id(conditions), row.tobytes()) for row in np.ascontiguousarray(parameters)]
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
            self._rows[key] = (conditions, found[key])
            self._rows.move_to_end(key)
        while len(self._rows) * (parameters.shape[1] + self._count) > self._most:
            self._rows.popitem(last=False)
        return np.stack([found[key] for key in keys])
