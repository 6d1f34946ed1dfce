"""What a verdict rests on: misfit of parts of the data, changes by each cause, flat directions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.data.conditions import Conditions, panel
from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.model.problem import Problem
from stickslip.facts import Code, Fact

Array = NDArray[np.float64]

_CARRIERS = 3
"""Conditions that are listed. Chosen: those with the largest shares are enough to look at."""

_CONTRAST = 2.0
"""Ratio of chi-square per condition from which on one part of the data is said to be worse. Chosen:
for eight conditions of noise alone it is two standard deviations above 1."""

_SEEN = 1.0
"""Signal to noise after projection that a response needs for the data to say anything about its
cause. Chosen: one standard deviation."""

_STRONG = 0.4
"""Component of a unit vector from which on it is named. Chosen: at most six have as much."""

_NAMED = 3
"""Constants of a flat direction that are named. Chosen: more are not read."""


def unseen_causes(found: Findings) -> frozenset[str]:
    """Causes that these data cannot show at any size that was simulated, and that are not claimed.

    Their probability is that before the data beside those of the others, and may be large. Of a
    constant that is itself suspected, recalibration says what the data tell, so it is none of them.
    """
    seen = set(found.sensitivities.cause[found.sensitivities.size >= _SEEN].tolist())
    names = {
        cause.name
        for k, cause in enumerate(found.problem.causes)
        if k not in seen and cause.relaxes_prior is None
    }
    return frozenset(names.difference(found.verdict.causes))


def carriers(found: Findings, m: int) -> list[dict[str, Any]]:
    """Which of the first m rows, the conditions, the extended model takes most misfit from."""
    if found.extended is None or not m:
        return []
    fall = (_misfit(found.problem, found.null) - _misfit(*found.extended))[:m]
    total = max(float(np.sum(np.maximum(fall, 0.0))), 1e-300)
    return [
        {"condition": int(k) + 1, "share": float(fall[k]) / total}
        for k in np.argsort(-fall)[:_CARRIERS]
        if fall[k] > 0.0
    ]


def misfit_by_part(
    found: Findings, parts: Mapping[str, NDArray[np.int64]]
) -> dict[str, dict[str, float | int | None]]:
    """Chi-square per condition of complementary parts of the table, of both models."""
    before = _misfit(found.problem, found.null)
    after = None if found.extended is None else _misfit(*found.extended)
    return {
        name: {
            "conditions": len(rows),
            "recalibrated": float(np.mean(before[rows])),
            "extended": None if after is None else float(np.mean(after[rows])),
        }
        for name, rows in parts.items()
    }


def where_it_lives(parts: Mapping[str, Mapping[str, float | int | None]]) -> Fact:
    """The contrasts among `misfit_by_part`; its parts come in twos."""
    names = list(parts)
    misfit = {name: float(each["recalibrated"] or 0.0) for name, each in parts.items()}
    found: list[dict[str, str | float]] = []
    for one, other in zip(names[::2], names[1::2], strict=True):
        high, low = sorted((one, other), key=lambda name: -misfit[name])
        most, least = misfit[high], misfit[low]
        if most > _CONTRAST * max(least, 1.0):
            found.append({"part": high, "misfit": most, "other": low, "misfit_of_other": least})
    if not found:
        return Fact(Code.MISFIT_EVEN, {"contrast": _CONTRAST})
    return Fact(Code.MISFIT_UNEVEN, {"parts": found, "contrast": _CONTRAST})


def signal_to_noise(found: Findings) -> dict[str, float] | None:
    """Strength of the claimed cause in the data, before and after projection on the constants.

    Before, the cause is switched on with all constants as the extended model has them.
    """
    fit, problem = found.verdict.fit, found.problem
    if fit is None:
        return None
    on, off = _on_and_off(problem, fit)
    gap = problem.whiten @ np.where(np.isfinite(on - off), on - off, 0.0)
    return {
        "before_absorption": float(np.linalg.norm(gap)),
        "after_absorption": float(np.sqrt(max(found.null.chi2 - fit.chi2, 0.0))),
    }


def velocity_changes(
    found: Findings, conditions: Conditions
) -> dict[str, dict[str, dict[str, float]]]:
    """For each candidate and each mode and direction: mean velocity, and what the cause adds, m/s.

    The constants are those of the candidate's own fit, with and without the cause; `noise` is the
    error of the measured mean. Conditions that cannot be computed without the cause do not count.
    """
    problem, m = found.problem, len(conditions)
    words = np.array([panel(each) for each in conditions])
    result: dict[str, dict[str, dict[str, float]]] = {}
    for fit in set_members(found) if conditions else []:
        on, off = _on_and_off(problem, fit)[:, :m]
        sound = np.isfinite(on) & np.isfinite(off)
        result[fit.name] = {
            word: {
                "velocity": float(np.mean(off[rows])),
                "change": float(np.mean((on - off)[rows])),
                "noise": float(np.linalg.norm(problem.sd[:m][rows]) / rows.sum()),
            }
            for word in dict.fromkeys(words.tolist())
            for rows in [sound & (words == word)]
            if rows.any()
        }
    return result


def pattern(changes: Mapping[str, Mapping[str, float]]) -> Fact:
    """What a cause does to the velocities.

    Parameters
    ----------
    changes : dict
        For each mode and direction `velocity` without the cause, its `change`, and the `noise`
        below which a change is none.
    """
    clear = {word: each for word, each in changes.items() if abs(each["change"]) > each["noise"]}
    way = {word: np.sign(each["change"]) for word, each in clear.items()}
    faster = [word for word, each in clear.items() if way[word] * each["velocity"] > 0.0]
    slower = [word for word in clear if word not in faster]
    if not clear:
        return Fact(Code.VELOCITIES_UNCHANGED, {})
    if len(clear) == len(changes) and not (faster and slower):
        return Fact(Code.VELOCITIES_FASTER if faster else Code.VELOCITIES_SLOWER, {})
    if len(clear) == len(changes) and len(set(way.values())) == 1:
        direction = "+x" if next(iter(way.values())) > 0.0 else "-x"
        return Fact(Code.VELOCITIES_SHIFTED, {"direction": direction})
    return Fact(Code.VELOCITIES_MIXED, {"faster": faster, "slower": slower})


def flat_directions(problem: Problem, fit: Fit) -> list[Fact]:
    """Combinations of uncertain parameters on which the data carry less information than priors."""
    m, p = len(problem.observed), problem.base_count
    if p == 0:
        return []
    _, singular, right = np.linalg.svd(fit.jacobian[:m, :p], full_matrices=False)
    facts = []
    for direction in right[singular < 1.0]:
        order = np.argsort(-np.abs(direction))
        strong = [problem.uncertain[k].name for k in order if abs(direction[k]) > _STRONG]
        if len(strong) > 1:
            facts.append(Fact(Code.TRADE_OFF, {"names": strong[:_NAMED]}))
        elif strong:
            facts.append(Fact(Code.LITTLE_KNOWN, {"name": strong[0]}))
    return facts


def _on_and_off(problem: Problem, fit: Fit) -> Array:
    """Predictions of a fit, and of it with its causes absent and their constants as stated."""
    off = fit.x.copy()
    off[fit.candidate.free[problem.base_count :]] = 0.0
    relaxed = {cause.relaxes_prior for cause in fit.candidate.causes}
    off[[k for k, each in enumerate(problem.uncertain) if each.name in relaxed]] = 0.0
    return problem.predicted(np.stack([fit.x, off]))


def _misfit(problem: Problem, fit: Fit) -> Array:
    """Each observable's part of chi-square; where errors are shared, some parts are negative."""
    whitened = fit.residual[: len(problem.observed)]
    gap = np.linalg.solve(problem.whiten, whitened)
    return np.asarray(gap * (problem.whiten.T @ whitened))
