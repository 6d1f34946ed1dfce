"""What a fit predicts at any conditions, and how sure it is of that."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.model.problem import Array, Predict, Problem

# Widest difference of a derivative, in coordinates. Chosen: where the data leave a parameter open,
# a tenth of its prior's standard deviation.
_STEP = 0.1


def predict_with_variance(
    problem: Problem, fit: Fit, predict: Predict, conditions: Any
) -> tuple[Array, Array]:
    """Prediction of a fit at k conditions, shape (k,), and its variance by the fit's covariance.

    In the observable's unit and its square, without the noise of a trial. NaN where `predict`,
    which is called as that of the problem, cannot compute a condition.
    """
    width = np.minimum(np.sqrt(np.diag(fit.covariance)), _STEP)
    points = [fit.x]
    for k, step in zip(fit.candidate.free, width, strict=True):
        for sign in (1.0, -1.0):
            point = fit.x.copy()
            point[k] += sign * step
            points.append(point)
    values = problem.physical(np.stack(points))
    predicted = np.asarray(predict(conditions, values), dtype=float)
    slope = _slopes(predicted, width[:, None])
    return predicted[0], np.einsum("kc,kl,lc->c", slope, fit.covariance, slope)


def _slopes(predicted: Array, width: Array) -> Array:
    """Central differences of a point and pairs about it; of one side if the other has none.

    A fit may stand at an end of what the model can compute, such as a static friction that is just
    above the kinetic one.
    """
    centre, up, down = predicted[0], predicted[1::2], predicted[2::2]
    one_sided = np.where(np.isfinite(up), up - centre, centre - down) / width
    both = np.isfinite(up) & np.isfinite(down)
    return np.asarray(np.where(both, (up - down) / (2.0 * width), one_sided))
