"""Predictions that are not made twice."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.model.problem import Predict
from stickslip.errors import ScenarioError

Array = NDArray[np.float64]


class PredictionCache:
    """A prediction that is not made twice: fits begin where others have ended.

    Parameters
    ----------
    predict : callable
        Of one object of conditions, always the same.
    count : int
        How many observables it returns for each vector.
    """

    def __init__(self, predict: Predict, count: int) -> None:
        self._predict = predict
        self._count = count
        self._rows: dict[bytes, Array] = {}

    def __call__(self, conditions: Any, parameters: Array) -> Array:
        """Observables of shape (vectors, m).

        Raises
        ------
        ScenarioError
            If that is not the shape that comes.
        """
        keys = [row.tobytes() for row in np.ascontiguousarray(parameters)]
        new = {key: row for key, row in zip(keys, parameters, strict=True) if key not in self._rows}
        if new:
            predicted = np.asarray(self._predict(conditions, np.stack(list(new.values()))))
            if predicted.shape != (len(new), self._count):
                raise ScenarioError(
                    f"predict: of {len(new)} vectors of parameters it returned shape "
                    f"{predicted.shape}; allowed is (vectors, observables), here "
                    f"{(len(new), self._count)}"
                )
            self._rows.update(zip(new, predicted.astype(float), strict=True))
        return np.stack([self._rows[key] for key in keys])
