"""A diagnosis in numbers: the keys of ``--json``, and the rest of report.json."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.fit.goodness import adequacy
from stickslip.diagnosis.inference.constancy import changing, refit_parts
from stickslip.diagnosis.inference.experiment_design import Experiment, advice
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import leading, runner_up
from stickslip.diagnosis.inference.upper_bounds import smallest_effects
from stickslip.diagnosis.inference.verdict import share_of_smooth_bound
from stickslip.diagnosis.model.problem import Problem
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.evidence import (
    carriers,
    misfit_by_part,
    pattern,
    signal_to_noise,
    velocity_changes,
    where_it_lives,
)
from stickslip.diagnosis.report.messages import headline
from stickslip.diagnosis.report.parameters import describe, extended_parameters, short
from stickslip.diagnosis.report.section import ReportSection
from stickslip.facts import Code, Fact

Array = NDArray[np.float64]


class Source(Protocol):
    """Where the data are from, such as a `Measurement`."""

    @property
    def name(self) -> str:
        """Title of the report."""
        ...

    @property
    def left_out(self) -> tuple[Fact, ...]:
        """What of the data was not sound."""
        ...


def summary(
    found: Findings, posed: PosedProblem, measurement: Source, experiments: Sequence[Experiment]
) -> dict[str, Any]:
    """Keys of ``stickslip diagnose --json``; SI units."""
    verdict = found.verdict
    cause: Any = None
    if verdict.kind == "named":
        cause = verdict.causes[0]
    elif verdict.kind in ("ambiguous", "pair"):
        cause = list(verdict.causes)
    gain = found.gain
    return {
        "verdict": verdict.kind,
        "cause": cause,
        "parameters": {
            short(name): entry
            for name, entry in extended_parameters(found).items()
        },
        "probabilities": dict(verdict.probabilities),
        "p_value": found.detection.p_value,
        "bounds": {short(name): value for name, value in found.bounds.items()},
        "gain": None if gain is None else {
            "n": len(gain.held_out),
            "heldout_chi2_before": gain.chi2_before,
            "heldout_chi2_after": gain.chi2_after,
            "mae_before": gain.mae_before,
            "mae_after": gain.mae_after,
            "interval": list(gain.interval),
        },
        "next_experiments": [
            {"drive": dict(each.drive), "why": str(each.why), "predictions": each.predictions}
            for each in experiments
        ],
        "left_out": _said([*measurement.left_out, *posed.left_out]),
        "seed": found.seed,
        "version": _core.__version__,
    }  # fmt: skip


def details(found: Findings, posed: PosedProblem, measurement: Source, unit: str) -> dict[str, Any]:
    """What was found, beyond the summary; `unit` is that of the held-out observables."""
    problem, gain = found.problem, found.gain
    return {
        "name": measurement.name,
        "headline": headline(found),
        "runner_up": str(runner_up(found) or ""),
        "reasons": _said(found.verdict.reasons),
        "notes": _said(found.notes),
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
        "recalibrated": _recalibrated(found),
        "flat_directions": _said(flat_directions(problem, found.null)),
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
        "held_out_level": _level(found, unit),
        "held_out_p_value": None if gain is None else gain.p_value,
        "conditions": _condition_rows(found, posed),
    }


def _condition_rows(found: Findings, posed: PosedProblem) -> list[dict[str, Any]]:
    """Each condition with its settings, its reading, and what the models say of it."""
    problem, gain, extended = found.problem, found.gain, found.verdict.fit
    points = [found.null.x] if extended is None else [found.null.x, extended.x]
    predicted = problem.predicted(np.stack(points))
    sd = np.sqrt(np.diag(found.noise.covariance))
    held = {} if gain is None else {int(k): number for number, k in enumerate(gain.held_out)}
    rows = []
    for k, each in enumerate(posed.conditions):
        row: dict[str, Any] = {key.split(".")[1]: value for key, value in each.items()}
        row["velocity"] = float(problem.observed[k])
        row["sd"] = float(sd[k]) if found.noise.dof > 0.0 else None
        row["model_scatter"] = float(found.roughness[k])
        row["trials"] = int(found.noise.count[k])
        row["given"] = float(posed.given[k])
        row["recalibrated"] = float(predicted[0, k])
        row["extended"] = float(predicted[1, k]) if len(predicted) > 1 else None
        row["held_out"] = k in held
        if gain is not None and k in held:
            row["recalibrated_without_it"] = float(gain.predicted_before[held[k]])
            row["extended_without_it"] = float(gain.predicted_after[held[k]])
        rows.append(row)
    return rows


def _recalibrated(found: Findings) -> dict[str, dict[str, float | str | None]]:
    """Each uncertain parameter in both models, with its error in the recalibrated one."""
    extended = found.verdict.fit
    spread = np.sqrt(np.diag(found.null.covariance))
    return {
        each.name: {
            "value": float(each.prior.value(found.null.x[k])),
            "unit": each.unit,
            "stated": float(each.prior.value(0.0)) if each.prior.has_middle else None,
            "low": float(each.prior.value(found.null.x[k] - spread[k])),
            "high": float(each.prior.value(found.null.x[k] + spread[k])),
            "pull": float(found.null.x[k]),
            "extended": None if extended is None else float(each.prior.value(extended.x[k])),
            "pull_extended": None if extended is None else float(extended.x[k]),
        }
        for k, each in enumerate(found.problem.uncertain)
    }


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
            "certified": fit.converged,
            "leading": fit.name in shown,
            "parameters": describe(found.problem, fit),
        }
        for fit in [found.null, *found.ranking.singles, *found.ranking.pairs]
    ]


def further(found: Findings, posed: PosedProblem) -> dict[str, Any]:
    """What the verdict rests on, and what takes some more simulations."""
    problem = found.problem
    parts = refit_parts(problem, found.null, posed.parts())
    smallest = smallest_effects(problem, found.sensitivities, found.detection.threshold)
    share = None
    if found.verdict.fit is not None:
        share = share_of_smooth_bound(found.null, found.verdict.fit, found.smooth_bound)
    judged = found.verdict.kind != "data-problem"
    misfit = misfit_by_part(found, posed.parts()) if judged else {}
    lives = where_it_lives(misfit) if misfit and found.detection.found else None
    velocities = velocity_changes(found, posed.conditions)
    changes = {name: pattern(each) for name, each in velocities.items()}
    changed, looks = changing(problem, parts), advice(found)
    return {
        "signal_to_noise": signal_to_noise(found),
        "misfit_by_part": misfit,
        "where_it_lives": str(lives or ""),
        "velocity_changes": {
            name: {"parts": parts, "in_words": str(changes[name])}
            for name, parts in velocities.items()
        },
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
        "changing": _said(changed),
        "smallest_effects": {short(name): value for name, value in smallest.items()},
        "smooth_ceiling": found.smooth_bound,
        "share_of_ceiling": share,
        "carried_by": carriers(found, len(posed.conditions)),
        "advice": _said(looks),
        "facts": {
            "changing": _data(changed),
            "where_it_lives": _data([] if lives is None else [lives]),
            "velocity_changes": {name: fact.as_dict() for name, fact in changes.items()},
            "advice": _data(looks),
        },
    }


def facts(
    found: Findings,
    left_out: Sequence[Fact],
    experiments: Sequence[Experiment],
    report_sections: Sequence[ReportSection],
) -> dict[str, Any]:
    """The facts of the sentences of `summary` and `details`, under the same keys."""
    second = runner_up(found)
    return {
        "reasons": _data(found.verdict.reasons),
        "runner_up": _data([] if second is None else [second]),
        "notes": _data(found.notes),
        "left_out": _data(left_out),
        "flat_directions": _data(flat_directions(found.problem, found.null)),
        "next_experiments": [each.why.as_dict() for each in experiments],
        "channels": {each.title: _data(each.lines) for each in report_sections},
    }


def _said(told: Iterable[Fact]) -> list[str]:
    return [str(each) for each in told]


def _data(told: Iterable[Fact]) -> list[dict[str, Any]]:
    return [each.as_dict() for each in told]


def _level(found: Findings, unit: str) -> float | None:
    """Mean size of what is held out, where it has one unit: its error is given in per cent."""
    if found.gain is None or unit == "SI":
        return None
    size = float(np.mean(np.abs(found.problem.observed[found.gain.held_out])))
    return size if size > 0.0 else None


def gain_unit(posed: PosedProblem) -> str:
    """Unit of what is held out: velocities, where there are any, else the channels' observables."""
    if posed.conditions:
        return "m/s"
    kinds = {observable.name for observable in posed.model.observables}
    return {"angle": "rad", "field": "T"}.get(kinds.pop(), "SI") if len(kinds) == 1 else "SI"


def flat_directions(problem: Problem, fit: Fit) -> list[Fact]:
    """Combinations of uncertain parameters that the data says nothing about."""
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
            said.append(Fact(Code.TRADE_OFF, {"names": strong[:3]}))
        elif strong:
            said.append(Fact(Code.LITTLE_KNOWN, {"name": strong[0]}))
    return said
