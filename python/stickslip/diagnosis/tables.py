"""Tables of a diagnosis: parameters, their intervals and covariance, and the candidates."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import chi2 as chi2_law

from stickslip.diagnosis.fit.fit_result import (
    Fit,
    Fitted,
    free_parameters,
    physical_covariance,
    ranked,
)
from stickslip.diagnosis.fit.goodness import adequacy
from stickslip.diagnosis.fit.prediction import predict_with_variance
from stickslip.diagnosis.fit.profile_likelihood import FAR
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.model.problem import Problem
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.parameters import estimates, with_profiles
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Value

if TYPE_CHECKING:
    from pandas import DataFrame


def parameter_table(found: Findings) -> DataFrame:
    """See `Diagnosis.params`."""
    problem, fit, parameters = _fitted(found)
    entries = with_profiles(found, estimates(fit, parameters))
    for each in parameters:
        entries[each.name] |= {"prior": _prior(problem, each), "pull": float(fit.x[each.column])}
    return _frame("parameter", entries, ["value", "sd", "unit", "prior", "pull"])


def interval_table(found: Findings, level: float) -> DataFrame:
    """See `Diagnosis.conf_int`."""
    most = float(chi2_law.cdf(FAR, 1))
    if not (isinstance(level, int | float) and 0.0 < level <= most):
        raise ScenarioError(f"level = {level!r}: allowed is a number above 0, at most {most:.4f}")
    problem, fit, parameters = _fitted(found)
    rise = float(chi2_law.ppf(level, 1))
    spread = np.sqrt(np.diag(fit.covariance))
    low, high = problem.limits()
    profiles = {each.name: each for each in found.profiles}
    entries: dict[str, dict[str, float | str]] = {}
    for each in parameters:
        if each.name in profiles:
            ends = profiles[each.name].interval(rise)
        else:
            reach = math.sqrt(rise) * float(spread[each.position])
            at = fit.x[each.column] + np.array([-reach, reach])
            at = np.clip(at, low[each.column], high[each.column])
            first, last = np.asarray(each.continuous(at)).tolist()
            ends = (min(first, last), max(first, last))
        entries[each.name] = {"low": ends[0], "high": ends[1], "unit": each.unit}
    return _frame("parameter", entries, ["low", "high", "unit"])


def covariance_table(found: Findings) -> DataFrame:
    """See `Diagnosis.covariance`."""
    from stickslip.diagnosis.printed_table import PrintedTable

    _, fit, parameters = _fitted(found)
    names = [each.name for each in parameters]
    return PrintedTable(physical_covariance(fit, parameters), index=names, columns=names)


def candidate_table(found: Findings) -> DataFrame:
    """See `Diagnosis.compare`."""
    fits = ranked([found.null, *found.ranking.singles, *found.ranking.pairs], priced=True)
    if found.verdict.kind == "data-problem":
        fits = ()
    entries = {
        fit.name: {
            "log_evidence": fit.priced_evidence - found.null.log_evidence,
            "delta": fits[0].priced_evidence - fit.priced_evidence,
            "chi2": fit.chi2,
            "p": adequacy(found.problem, fit),
            "converged": fit.agreement,
        }
        for fit in fits
    }
    return _frame("candidate", entries, ["log_evidence", "delta", "chi2", "p", "converged"])


def prediction_table(
    found: Findings, posed: PosedProblem, at: Any, settings: list[dict[str, Value]] | None
) -> DataFrame:
    """See `Diagnosis.predict`; `at` are the conditions as the model takes them."""
    import pandas as pd

    from stickslip.diagnosis.printed_table import PrintedTable

    columns: dict[str, Any] = {}
    models = {"recalibrated": (found.problem, found.null, posed.model)}
    if found.extended is not None:
        models["extended"] = (*found.extended, posed.extended_model(found))
    for name, (problem, fit, model) in models.items():
        level, variance = predict_with_variance(problem, fit, model.velocities, at)
        columns |= {name: level, f"{name}_sd": np.sqrt(variance)}
    given = pd.DataFrame() if settings is None else pd.DataFrame(settings)
    return PrintedTable(pd.concat([given, pd.DataFrame(columns)], axis=1))


def _fitted(found: Findings) -> tuple[Problem, Fit, list[Fitted]]:
    """The extended model, or the recalibrated one, and its free parameters."""
    problem, fit = found.extended or (found.problem, found.null)
    learnt = found.verdict.kind != "data-problem"
    return problem, fit, free_parameters(problem, fit) if learnt else []


def _prior(problem: Problem, each: Fitted) -> str:
    """In words what was known of it before the data."""
    base = problem.base_count
    if each.column < base:
        return str(problem.uncertain[each.column].prior)
    return problem.parameters[each.column - base].prior_in_words


def _frame(what: str, entries: Mapping[str, Mapping[str, Any]], columns: list[str]) -> DataFrame:
    """A table with a row for each entry, whose index is called `what`."""
    import pandas as pd

    from stickslip.diagnosis.printed_table import PrintedTable

    names = pd.Index(list(entries), name=what, dtype=object)
    return PrintedTable(list(entries.values()), index=names, columns=columns)
