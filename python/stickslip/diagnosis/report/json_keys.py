"""A diagnosis in numbers: the keys of ``--json``, and the rest of report.json."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip import _core
from stickslip.diagnosis.fit.goodness import adequacy
from stickslip.diagnosis.inference.constancy import changing, refit_parts
from stickslip.diagnosis.inference.evidence import (
    carriers,
    flat_directions,
    misfit_by_part,
    pattern,
    signal_to_noise,
    velocity_changes,
    where_it_lives,
)
from stickslip.diagnosis.inference.experiment_design import Experiment, advice
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import leading, runner_up
from stickslip.diagnosis.inference.upper_bounds import smallest_effects
from stickslip.diagnosis.inference.verdict import share_of_smooth_bound
from stickslip.diagnosis.model.problem import Uncertain
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.certainty import gain_of
from stickslip.diagnosis.report.headline import headline
from stickslip.diagnosis.report.parameters import describe, extended_parameters, short
from stickslip.diagnosis.report.section import ReportSection
from stickslip.facts import Fact
from stickslip.measurement.reading import Measurement


@dataclass(frozen=True)
class OwnData:
    """Data of a model of the user's own, as far as a report says where they are from."""

    name: str
    left_out: tuple[Fact, ...] = ()


def summary(
    found: Findings,
    posed: PosedProblem,
    measurement: Measurement | OwnData,
    experiments: Sequence[Experiment],
) -> dict[str, Any]:
    """Keys of ``stickslip diagnose --json``; SI units.

    A law of another shape has put the causes behind it, and with them the experiments that tell
    them apart.
    """
    verdict = found.verdict
    experiments = experiments if found.free_shape is None else []
    cause: Any = None
    if verdict.kind == "named":
        cause = verdict.causes[0]
    elif verdict.kind in ("ambiguous", "pair"):
        cause = list(verdict.causes)
    return {
        "verdict": verdict.kind,
        "cause": cause,
        "parameters": _by_short_name(extended_parameters(found)),
        "probabilities": dict(verdict.probabilities),
        "p_value": found.detection.p_value,
        "bounds": _by_short_name(found.bounds),
        "gain": None if found.gain is None else found.gain.as_dict(),
        "next_experiments": [
            {"drive": dict(each.drive), "why": str(each.why), "predictions": each.predictions}
            for each in experiments
        ],
        "left_out": _sentences([*measurement.left_out, *posed.left_out]),
        "open_set": None if found.open_set is None else found.open_set.as_dict(),
        "seed": found.seed,
        "version": _core.__version__,
    }


def report_numbers(
    found: Findings,
    posed: PosedProblem,
    source: Measurement | OwnData,
    experiments: Sequence[Experiment],
    sections: Sequence[ReportSection],
    unit: str,
) -> dict[str, Any]:
    """All keys of report.json; `unit` is that of the held-out observables.

    The facts of the sentences are under the same keys as these, in ``facts``.
    """
    second = runner_up(found)
    facts = {
        "reasons": _data(found.verdict.reasons),
        "runner_up": _data([] if second is None else [second]),
        "notes": _data(found.notes),
        "left_out": _data([*source.left_out, *posed.left_out]),
        "flat_directions": _data(flat_directions(found.problem, found.null)),
        "next_experiments": [
            each.why.as_dict() for each in experiments if found.free_shape is None
        ],
        "channels": {each.title: _data(each.lines) for each in sections},
    }
    evidence, facts_of_it = _evidence(found, posed)
    return {
        **summary(found, posed, source, experiments),
        "name": source.name,
        **_details(found, posed, unit),
        "channels": {each.title: each.numbers for each in sections},
        "gain_unit": unit,
        **evidence,
        "facts": {**facts, **facts_of_it},
    }


def _details(found: Findings, posed: PosedProblem, unit: str) -> dict[str, Any]:
    """What was found, beyond the summary."""
    problem, gain, test = found.problem, gain_of(found), found.detection
    return {
        "headline": str(headline(found, posed, unit)),
        "runner_up": str(runner_up(found) or ""),
        "reasons": _sentences(found.verdict.reasons),
        "notes": _sentences(found.notes),
        "tests": {
            "lack_of_fit": test.lack_of_fit,
            "lack_of_fit_p": test.lack_of_fit_p,
            "score": test.score,
            "score_threshold": test.threshold,
            "score_p": test.score_p,
            "bootstrapped": test.bootstrapped,
        },
        "noise": {
            "floor": found.noise.floor,
            "relative": found.noise.relative,
            "between_setups": found.noise.between,
            "between_setups_gain": found.noise.between_gain,
            "dof": found.noise.dof,
            "correlation": _correlation(found),
        },
        "recalibrated": _recalibrated(found),
        "flat_directions": _sentences(flat_directions(problem, found.null)),
        "ranking": _ranking(found),
        "profiles": {
            each.name: {"value": each.value.tolist(), "chi2": each.chi2.tolist(), "unit": each.unit}
            for each in found.profiles
        },
        "isolability_classes": [list(each) for each in found.indistinguishable_causes],
        "isolability": {
            "causes": [cause.name for cause in problem.causes],
            "cosines": found.cosines.tolist(),
        },
        "choice_without_held_out": None if gain is None else gain.choice,
        "choice_lead": None if gain is None else gain.lead,
        "held_out_level": _level(found, unit),
        "held_out_p_value": None if gain is None else gain.p_value,
        "conditions": _condition_rows(found, posed),
    }


def _correlation(found: Findings) -> dict[str, Any] | None:
    """The correlation of errors within runs, where it could be estimated."""
    known = found.noise.correlation
    if known is None:
        return None
    return {
        "value": known.value,
        "interval": [known.low, known.high],
        "origin": known.origin,
        "used": known.used,
        "readings": known.readings,
        "effective_readings": known.effective,
    }


def _condition_rows(found: Findings, posed: PosedProblem) -> list[dict[str, Any]]:
    """Each condition with its settings, its reading, and the predictions of the models."""
    problem, gain = found.problem, gain_of(found)
    fits = [(problem, found.null), *([] if found.extended is None else [found.extended])]
    predicted = [of.predicted(fit.x[None, :])[0] for of, fit in fits]
    sd = np.sqrt(np.diag(found.noise.covariance))
    held = {} if gain is None else {int(k): number for number, k in enumerate(gain.held_out)}
    rows = []
    for k, each in enumerate(posed.conditions):
        row: dict[str, Any] = {key.split(".")[1]: value for key, value in each.items()}
        row |= {
            "velocity": float(problem.observed[k]),
            "sd": float(sd[k]) if found.noise.dof > 0.0 else None,
            "model_scatter": float(found.roughness[k]),
            "trials": int(found.noise.count[k]),
            "given": float(posed.given[k]),
            "recalibrated": float(predicted[0][k]),
            "extended": float(predicted[1][k]) if len(predicted) > 1 else None,
            "held_out": k in held,
        }
        if gain is not None and k in held:
            row["recalibrated_without_it"] = float(gain.predicted_before[held[k]])
            row["extended_without_it"] = float(gain.predicted_after[held[k]])
        rows.append(row)
    return rows


def _recalibrated(found: Findings) -> dict[str, dict[str, float | str | None]]:
    """Each uncertain parameter in both models, with its error in the recalibrated one."""
    extended = None if found.extended is None else found.extended[1]
    spread = np.sqrt(np.diag(found.null.covariance))
    result: dict[str, dict[str, float | str | None]] = {}
    for k, each in enumerate(found.problem.uncertain):
        interval = _interval(each, found.null.x[k], spread[k])
        result[each.name] = {
            "value": interval.pop("value"),
            "unit": each.unit,
            "stated": float(each.prior.value(0.0)) if each.prior.has_middle else None,
            **interval,
            "pull": float(found.null.x[k]),
            "extended": None if extended is None else float(each.prior.value(extended.x[k])),
            "pull_extended": None if extended is None else float(extended.x[k]),
        }
    return result


def _interval(constant: Uncertain, x: float, sd: float) -> dict[str, float]:
    """A constant at a coordinate, and one standard deviation below and above."""
    at = {"value": x, "low": x - sd, "high": x + sd}
    return {name: float(constant.prior.value(u)) for name, u in at.items()}


def _ranking(found: Findings) -> list[dict[str, Any]]:
    """All fits, the recalibrated model first."""
    shown = {fit.name for fit in [found.null, *leading(found)]}
    return [
        {
            "causes": [cause.name for cause in fit.candidate.causes],
            "chi2": fit.chi2,
            "data_chi2": fit.data_chi2,
            "misfit_p": adequacy(found.problem, fit),
            "log_evidence": fit.log_evidence - found.null.log_evidence,
            "priced_evidence": fit.priced_evidence - found.null.log_evidence,
            "converged": fit.agreement,
            "leading": fit.name in shown,
            "parameters": describe(found.problem, fit),
        }
        for fit in [found.null, *found.ranking.singles, *found.ranking.pairs]
    ]


def _evidence(found: Findings, posed: PosedProblem) -> tuple[dict[str, Any], dict[str, Any]]:
    """What the verdict rests on, by some more simulations, and the facts of its sentences."""
    problem, fit = found.problem, found.verdict.fit
    parts = refit_parts(problem, found.null, posed.parts())
    smallest = smallest_effects(problem, found.sensitivities, found.detection.threshold)
    judged = found.verdict.kind != "data-problem"
    misfit = misfit_by_part(found, posed.parts()) if judged else {}
    lives = [where_it_lives(misfit)] if misfit and found.detection.found else []
    velocities = velocity_changes(found, posed.conditions)
    patterns = {
        name: pattern(each).of(causes=1 + name.count(" + ")) for name, each in velocities.items()
    }
    changed, looks = changing(problem, parts), advice(found)
    numbers = {
        "signal_to_noise": signal_to_noise(found),
        "misfit_by_part": misfit,
        "where_it_lives": "".join(_sentences(lives)),
        "velocity_changes": {
            name: {"parts": each, "in_words": str(patterns[name])}
            for name, each in velocities.items()
        },
        "constancy": {
            part.name: {
                each.name: _interval(each, part.x[k], part.sd[k])
                for k, each in enumerate(problem.uncertain)
            }
            for part in parts
        },
        "changing": _sentences(changed),
        "smallest_effects": _by_short_name(smallest),
        "smooth_ceiling": found.smooth_bound,
        "share_of_ceiling": None
        if fit is None
        else share_of_smooth_bound(found.null, fit, found.smooth_bound),
        "carried_by": carriers(found, len(posed.conditions)),
        "advice": _sentences(looks),
    }
    facts = {
        "changing": _data(changed),
        "where_it_lives": _data(lives),
        "velocity_changes": {name: fact.as_dict() for name, fact in patterns.items()},
        "advice": _data(looks),
    }
    return numbers, facts


def _by_short_name(values: Mapping[str, Any]) -> dict[str, Any]:
    return {short(name): value for name, value in values.items()}


def _sentences(facts: Iterable[Fact]) -> list[str]:
    return [str(each) for each in facts]


def _data(facts: Iterable[Fact]) -> list[dict[str, Any]]:
    return [each.as_dict() for each in facts]


def _level(found: Findings, unit: str) -> float | None:
    """Mean size of what is held out, where it has one unit: its error is given in per cent."""
    gain = gain_of(found)
    if gain is None or unit == "SI":
        return None
    size = float(np.mean(np.abs(found.problem.observed[gain.held_out])))
    return size if size > 0.0 else None
