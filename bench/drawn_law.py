"""The curve of a law of a free shape that a diagnosis has found."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from stickslip import Cause, Diagnosis
from stickslip.diagnosis.candidate import spread_of
from stickslip.diagnosis.decision.formulas import Formula, formula

Array = NDArray[np.float64]


def drawn(result: Diagnosis, law: Cause, argument: Array) -> tuple[Array, Array, Formula | None]:
    """Ends of 95 % of a law of the extended model, shape (points,) each, and its formula."""
    curve, problem, values = law.curve, result.problem, result.best.values()
    assert curve is not None
    f = values[:, [problem.names.index(each.name) for each in law.parameters]]
    f = f @ curve.design(argument).T
    told, base, constant = f, np.full((1, 1), curve.stated), None
    if curve.constant is not None:
        k = problem.names.index(curve.constant)
        base, constant = values[:, [k]], problem.parameters[k]
        told = np.hstack([f, base])
    found = formula(argument, told[0], spread_of(told), curve, constant)
    whole = base * (1.0 + f) if curve.relative else f
    half = norm.ppf(0.975) * np.sqrt(np.diag(spread_of(whole)))
    return whole[0] - half, whole[0] + half, found
