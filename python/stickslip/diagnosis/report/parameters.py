"""Parameters of fitted causes, with errors, in their units."""

from __future__ import annotations

import numpy as np

from stickslip.diagnosis.fit.fit_result import Fit, fitted_parameters
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.model.problem import Problem


def short(name: str) -> str:
    """A parameter's name as a reader knows it."""
    return name.removeprefix("effects.")


def describe(problem: Problem, fit: Fit) -> dict[str, dict[str, float | str]]:
    """Value, standard deviation and unit of the parameters of a fit's causes."""
    spread = np.sqrt(np.diag(fit.covariance))
    result: dict[str, dict[str, float | str]] = {}
    for each in fitted_parameters(problem, fit):
        value = float(np.asarray(each.value(fit.x[[each.column]]))[0])
        sd = abs(each.slope(fit)) * float(spread[each.position])
        result[each.name] = {"value": value, "sd": sd, "unit": each.unit}
    return result


def extended_parameters(found: Findings) -> dict[str, dict[str, float | str]]:
    """Parameters of the extended model; of a set, what each of its members would need."""
    members = set_members(found)
    if not members:
        return {}
    result = describe(found.problem, members[0])
    for each in found.profiles:
        result[each.name]["sd"] = max(float(result[each.name]["sd"]), each.sd)
    for fit in members[1:]:
        for name, entry in describe(found.problem, fit).items():
            result.setdefault(name, entry)
    return result
