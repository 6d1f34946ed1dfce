"""Parameters of fitted models, with errors, in their units."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip.diagnosis.fit.fit_result import Fit, Fitted, fitted_parameters
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.model.problem import Problem


def short(name: str) -> str:
    """A parameter's name as a reader knows it."""
    return name.removeprefix("effects.")


def describe(problem: Problem, fit: Fit) -> dict[str, dict[str, float | str]]:
    """Value, standard deviation and unit of the parameters of a fit's causes."""
    return estimates(fit, fitted_parameters(problem, fit))


def estimates(fit: Fit, parameters: Sequence[Fitted]) -> dict[str, dict[str, float | str]]:
    """Value, standard deviation and unit of parameters of a fit, by name."""
    spread = np.sqrt(np.diag(fit.covariance))
    return {
        each.name: {
            "value": float(np.asarray(each.value(fit.x[[each.column]]))[0]),
            "sd": abs(each.slope(fit)) * float(spread[each.position]),
            "unit": each.unit,
        }
        for each in parameters
    }


def with_profiles(
    found: Findings, entries: dict[str, dict[str, float | str]]
) -> dict[str, dict[str, float | str]]:
    """The same, with errors no smaller than those of the profile likelihood, where there is one."""
    for each in found.profiles:
        if each.name in entries:
            entries[each.name]["sd"] = max(float(entries[each.name]["sd"]), each.sd)
    return entries


def extended_parameters(found: Findings) -> dict[str, dict[str, float | str]]:
    """Parameters of the extended model; of a set, what each of its members would need."""
    if found.verdict.fit is None and found.extended is not None:
        return describe(*found.extended)
    first, *others = [describe(found.problem, fit) for fit in set_members(found)] or [{}]
    result = with_profiles(found, first)
    for entries in others:
        result |= {name: each for name, each in entries.items() if name not in result}
    return result
