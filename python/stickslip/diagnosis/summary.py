"""A diagnosis in words and numbers: headline, keys of ``--json``, and the rest of report.json."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.diagnosis.constancy import changing, refit_parts
from stickslip.diagnosis.engine import Diagnosis
from stickslip.diagnosis.experiments import Experiment, advice
from stickslip.diagnosis.fits import Fit, fitted_parameters
from stickslip.diagnosis.model import Problem
from stickslip.diagnosis.signatures import smallest_effects
from stickslip.diagnosis.simulator import Examination
from stickslip.diagnosis.verdict import share_of_ceiling
from stickslip.keys import Value
from stickslip.measurement.reading import Measurement

Array = NDArray[np.float64]

_NAMELESS = {
    "none": "Nothing beyond the recalibrated model can be seen in this data.",
    "unexplained": "Something is there that no cause of the library and no pair of them explains.",
}

_LISTED = 6
_CARRIERS = 3


def rounded(value: float, sd: float) -> str:
    """A value and its error, both to the error's second digit."""
    if not (math.isfinite(value) and math.isfinite(sd) and sd > 0.0):
        return f"{value:.3g} +- {sd:.2g}"
    ten = math.floor(math.log10(max(abs(value), sd)))
    ten = 0 if -3 <= ten <= 3 else ten
    places = max(1 - math.floor(math.log10(sd / 10.0**ten)), 0)
    number = f"{value / 10.0**ten:.{places}f} +- {sd / 10.0**ten:.{places}f}"
    return number if ten == 0 else f"({number})e{ten}"


def headline(found: Diagnosis) -> str:
    """The verdict in one sentence."""
    verdict = found.verdict
    if verdict.word in _NAMELESS:
        text = _NAMELESS[verdict.word]
    elif verdict.word == "data-problem":
        text = f"The data does not allow a diagnosis: {verdict.reasons[0]}."
    elif verdict.word == "named":
        text = f"The data points to {verdict.causes[0]}: {_sizes(found)}."
    elif verdict.word == "pair":
        text = f"The data points to two causes together: {' and '.join(verdict.causes)}."
    elif verdict.fit is not None and len(verdict.causes) == len(verdict.fit.rival.causes):
        members = " and ".join(verdict.causes)
        best = "is the best candidate" if len(verdict.causes) == 1 else "are the best pair"
        text = f"{members} {best}, but {verdict.reasons[0]}."
    else:
        first, more = verdict.causes[:_LISTED], len(verdict.causes) - _LISTED
        pair = verdict.fit is not None and len(verdict.fit.rival.causes) > 1
        text = "Two of these together" if pair else "One of these"
        text += f", and this data cannot say which: {', '.join(first)}"
        text += f" and {more} more." if more > 0 else "."
    if found.gain is not None and found.gain.interval[0] <= 0.0:
        text += f" On {len(found.gain.held_out)} held-out conditions the gain is not certain: its "
        text += "interval includes 0."
    return text


def summary(
    found: Diagnosis, measurement: Measurement, experiments: Sequence[Experiment]
) -> dict[str, Any]:
    """Keys of ``stickslip diagnose --json``; SI units."""
    verdict = found.verdict
    cause: Any = None
    if verdict.word == "named":
        cause = verdict.causes[0]
    elif verdict.word in ("ambiguous", "pair"):
        cause = list(verdict.causes)
    gain = found.gain
    return {
        "verdict": verdict.word,
        "cause": cause,
        "parameters": {
            _short(name): entry
            for name, entry in extended_parameters(found).items()
        },
        "probabilities": dict(verdict.probabilities),
        "p_value": found.detection.p_value,
        "bounds": {_short(name): value for name, value in found.bounds.items()},
        "gain": None if gain is None else {
            "n": len(gain.held_out),
            "heldout_chi2_before": gain.chi2_before,
            "heldout_chi2_after": gain.chi2_after,
            "mae_before": gain.mae_before,
            "mae_after": gain.mae_after,
            "interval": list(gain.interval),
        },
        "next_experiments": [
            {"drive": dict(each.drive), "why": each.why, "predictions": each.predictions}
            for each in experiments
        ],
        "left_out": list(measurement.left_out),
        "seed": found.seed,
        "version": _core.__version__,
    }  # fmt: skip


def extended_parameters(found: Diagnosis) -> dict[str, dict[str, float | str]]:
    """Parameters of the extended model; of a set, what each of its members would need."""
    if found.verdict.fit is None:
        return {}
    result = describe(found.problem, found.verdict.fit)
    for each in found.profiles:
        result[each.name]["sd"] = max(float(result[each.name]["sd"]), each.sd)
    among = set(found.verdict.causes) if found.verdict.word == "ambiguous" else set()
    many = len(found.verdict.fit.rival.causes)
    for fit in found.ranking.singles if many == 1 else found.ranking.pairs:
        if among.issuperset(cause.name for cause in fit.rival.causes):
            for name, entry in describe(found.problem, fit).items():
                result.setdefault(name, entry)
    return result


def _sizes(found: Diagnosis) -> str:
    """The fitted parameters with their errors."""
    return ", ".join(
        f"{_short(name)} = {rounded(float(each['value']), float(each['sd']))} {each['unit']}"
        for name, each in extended_parameters(found).items()
    )


def _short(name: str) -> str:
    return name.removeprefix("effects.")


def details(
    found: Diagnosis, measurement: Measurement, conditions: Sequence[Mapping[str, Value]]
) -> dict[str, Any]:
    """Every number of the report beyond the summary."""
    problem = found.problem
    extended = found.verdict.fit
    points = [found.null.x] if extended is None else [found.null.x, extended.x]
    predicted = problem.predicted(np.stack(points))
    sd = np.sqrt(np.diag(found.noise.covariance))
    rows = []
    for k, each in enumerate(conditions):
        row: dict[str, Any] = {key.split(".")[1]: value for key, value in each.items()}
        row["velocity"] = float(problem.observed[k])
        row["sd"] = float(sd[k])
        row["model_scatter"] = float(found.roughness[k])
        row["trials"] = int(found.noise.count[k])
        row["recalibrated"] = float(predicted[0, k])
        row["extended"] = float(predicted[1, k]) if len(predicted) > 1 else None
        row["held_out"] = found.gain is not None and k in found.gain.held_out
        rows.append(row)
    fits = [found.null, *found.ranking.singles, *found.ranking.pairs]
    return {
        "name": measurement.name,
        "headline": headline(found),
        "reasons": list(found.verdict.reasons),
        "notes": list(found.notes),
        "tests": {
            "lack_of_fit": found.detection.lack_of_fit,
            "lack_of_fit_p": found.detection.lack_of_fit_p,
            "score": found.detection.score,
            "score_threshold": found.detection.threshold,
            "score_p": found.detection.score_p,
            "bootstrapped": found.detection.bootstrapped,
        },
        "noise": {
            "floor": found.noise.floor,
            "relative": found.noise.relative,
            "between_setups": found.noise.between,
            "between_setups_gain": found.noise.between_gain,
            "dof": found.noise.dof,
        },
        "recalibrated": {
            each.name: {
                "value": float(each.prior.value(found.null.x[k])),
                "unit": each.unit,
                "pull": float(found.null.x[k]),
                "extended": None if extended is None else float(each.prior.value(extended.x[k])),
                "pull_extended": None if extended is None else float(extended.x[k]),
            }
            for k, each in enumerate(problem.uncertain)
        },
        "flat_directions": flat_directions(problem, found.null),
        "ranking": [
            {
                "causes": [cause.name for cause in fit.rival.causes],
                "chi2": fit.chi2,
                "data_chi2": fit.data_chi2,
                "log_evidence": fit.log_evidence - found.null.log_evidence,
                "certified": fit.certified,
                "parameters": describe(problem, fit),
            }
            for fit in fits
        ],
        "profiles": {
            each.name: {"value": each.value.tolist(), "chi2": each.chi2.tolist(), "unit": each.unit}
            for each in found.profiles
        },
        "isolability_classes": [list(each) for each in found.classes],
        "choice_without_held_out": None if found.gain is None else found.gain.choice,
        "conditions": rows,
    }


def further(examination: Examination) -> dict[str, Any]:
    """What takes some more simulations: constancy, the ceiling, and where the verdict lives."""
    found, problem = examination.found, examination.found.problem
    parts = refit_parts(problem, found.null, examination.parts())
    smallest = smallest_effects(problem, found.signatures, found.detection.threshold)
    share = None
    if found.verdict.fit is not None:
        share = share_of_ceiling(found.null, found.verdict.fit, found.ceiling)
    return {
        "constancy": {
            part.name: {
                each.name: {
                    "value": float(each.prior.value(part.x[k])),
                    "low": float(each.prior.value(part.x[k] - part.sd[k])),
                    "high": float(each.prior.value(part.x[k] + part.sd[k])),
                }
                for k, each in enumerate(problem.uncertain)
            }
            for part in parts
        },
        "changing": changing(problem, parts),
        "smallest_effects": {_short(name): value for name, value in smallest.items()},
        "smooth_ceiling": found.ceiling,
        "share_of_ceiling": share,
        "carried_by": _carriers(examination),
        "advice": advice(found),
    }


def _carriers(examination: Examination) -> list[dict[str, Any]]:
    """Conditions at which the extended model takes most from the misfit."""
    found, m = examination.found, len(examination.conditions)
    if found.verdict.fit is None or not m:
        return []
    fall = (_misfit(found.problem, found.null) - _misfit(found.problem, found.verdict.fit))[:m]
    total = max(float(np.sum(np.maximum(fall, 0.0))), 1e-300)
    return [
        {"condition": int(k) + 1, "share": float(fall[k]) / total}
        for k in np.argsort(-fall)[:_CARRIERS]
        if fall[k] > 0.0
    ]


def _misfit(problem: Problem, fit: Fit) -> Array:
    """Each observable's part of chi-square; where errors are shared, some parts are negative."""
    whitened = fit.residual[: len(problem.observed)]
    gap = np.linalg.solve(problem.whiten, whitened)
    return np.asarray(gap * (problem.whiten.T @ whitened))


def gain_unit(examination: Examination) -> str:
    """Unit of what is held out: velocities, where there are any, else the channels' observables."""
    if examination.conditions:
        return "m/s"
    kinds = {channel.name for channel in examination.combined.channels}
    return {"angle": "rad", "field": "T"}.get(kinds.pop(), "SI") if len(kinds) == 1 else "SI"


def flat_directions(problem: Problem, fit: Fit) -> list[str]:
    """Combinations of uncertain parameters that the data says nothing about, in words."""
    m, p = len(problem.observed), problem.base_count
    if p == 0:
        return []
    data = fit.jacobian[:m, :p]
    _, singular, right = np.linalg.svd(data, full_matrices=False)
    said = []
    for size, direction in zip(singular, right, strict=True):
        if size >= 1.0:
            continue
        strong = [
            problem.uncertain[k].name for k in np.argsort(-np.abs(direction)) if
            abs(direction[k]) > 0.4
        ]  # fmt: skip
        if len(strong) > 1:
            said.append(" and ".join(strong[:3]) + " trade off")
        elif strong:
            said.append(f"the data says nothing about {strong[0]}")
    return said


def describe(problem: Problem, fit: Fit) -> dict[str, dict[str, float | str]]:
    """Value, standard deviation and unit of the parameters of a fit's causes."""
    spread = np.sqrt(np.diag(fit.covariance))
    result: dict[str, dict[str, float | str]] = {}
    for each in fitted_parameters(problem, fit):
        u = fit.x[each.column]
        value = np.asarray(each.value(np.array([u - 0.01, u, u + 0.01])))
        sd = abs(float(value[2] - value[0])) / 0.02 * float(spread[each.position])
        result[each.name] = {"value": float(value[1]), "sd": sd, "unit": each.unit}
    return result
