"""From tests and fits to one of six verdicts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.stats import norm as normal_law
from scipy.stats import t as student_law

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.distinguishability import SAME, alike
from stickslip.diagnosis.fit.fit_result import PAIR_PRICE, Fit, Ranking
from stickslip.diagnosis.fit.goodness import ADEQUATE, adequacy, lack_of_fit_p
from stickslip.diagnosis.inference.detection import ALPHA, Detection
from stickslip.diagnosis.inference.probabilities import probabilities
from stickslip.diagnosis.inference.runner_up import describe_runner_up, rivals, second_look
from stickslip.diagnosis.model.problem import Array, Indices, Problem
from stickslip.facts import Code, Fact

VerdictKind = Literal["none", "named", "ambiguous", "pair", "unexplained", "data-problem"]

MARGIN = 3.0
"""Log-evidence by which a named cause leads. Chosen: odds of twenty to one."""

PAIR_MARGIN = 2.0
"""The same of a pair over other pairs, as it has paid its price over all of them. Chosen on the 480
data sets that the rules were made with: of four pairs that led by 2 to 3, three were right."""

ALIKE_MARGIN = 2.0 * MARGIN
"""The same over a cause, or a pair, whose effects on the data are alike: the lead of one over the
other then rests on small differences of nearly equal fits. Chosen, not derived: odds of four
hundred to one."""

LEAST_SHARE = 0.7
"""Share of what a smooth function explains that a claimed cause or pair has to explain. Chosen, not
derived: with a smaller one a cause is named that leaves much unexplained; with a
larger one noise, part of which a smooth function explains, refuses right causes."""

AT_END = 0.01
"""Distance of a coordinate from the end of its range within which it is at it, as a search creeps
the last of the way. Chosen: a hundredth of the prior's width."""

MOST_PULLED, _PULLED_SHARE = 2.5, 0.025
"""Pull of a constant, in standard deviations of its prior, beyond which a fit is not claimed, and
the share of right fits that it may refuse; see `most_pulled`. Chosen: the share is that of two
honest constants at this limit, and a constant that makes up for something else is pulled more."""

CONTRADICTED = 1e-3
"""p-value of the largest residual of all below which the error model is contradicted. Chosen: one
right name in a thousand is refused, and a reading that is off by five errors is no noise."""


@dataclass(frozen=True, repr=False, eq=False)
class Table(OneLine):
    """Observables of one kind.

    Attributes
    ----------
    kind : str
    rows : ndarray of int
        Among all observables, whose errors are independent of those of other tables.
    dof : float
        Degrees of freedom of their noise; infinity where it was stated.
    """

    kind: str
    rows: Indices
    dof: float


@dataclass(frozen=True, repr=False)
class Verdict(OneLine):
    """What is said.

    Attributes
    ----------
    kind : str
        One of the six verdicts.
    causes : tuple of str
        The named cause, the set, or the pair.
    fit : Fit, optional
        The extended model, where there is one.
    reasons : tuple of Fact
        Why it is this verdict and no bolder one.
    probabilities : dict
        Over all causes, ``none`` and ``unknown``; they sum to 1.
    """

    kind: VerdictKind
    causes: tuple[str, ...]
    fit: Fit | None
    reasons: tuple[Fact, ...]
    probabilities: Mapping[str, float]


def decide(
    problem: Problem,
    detection: Detection,
    ranking: Ranking,
    cosines: Array,
    linear_evidence: Mapping[str, float],
    improves_prediction: Callable[[Fit], bool],
    smooth_bound: float | None = None,
    tables: Sequence[Table] = (),
) -> Verdict:
    """The verdict by the rules of the documentation.

    Parameters
    ----------
    problem : Problem
    detection : Detection
    ranking : Ranking
    cosines : ndarray, shape (causes, causes)
        Distinguishability.
    linear_evidence : dict
        Log-evidence of each cause above no cause by linear screening, for those without a fit.
    improves_prediction : callable
        Whether a candidate predicts held-out conditions better than the recalibrated model.
    smooth_bound : float, optional
        Chi-square that a smooth function of the settings would take from the misfit.
    tables : sequence of Table, optional
        Kinds of data that have to agree each.
    """
    chance = probabilities(problem, ranking, linear_evidence)
    if not detection.found:
        passed = Fact(Code.NOTHING_DETECTED, {"p_value": detection.p_value, "level": ALPHA})
        return Verdict("none", (), None, (passed,), chance)
    said = _decided(problem, ranking, cosines, improves_prediction, chance, tables)
    if said.fit is None or said.kind not in ("named", "pair"):
        return said
    smooth = smooth_rest(ranking.null, said.fit, smooth_bound)
    if smooth:
        # The probability of causes that leave something smooth behind goes to the unknown.
        moved = {name: 0.0 if name in said.causes else p for name, p in chance.items()}
        moved["unknown"] += sum(chance[name] for name in said.causes)
        return Verdict("unexplained", (), None, smooth, moved)
    against = contradictions(said.fit, tables)
    return replace(said, kind="ambiguous", reasons=against) if against else said


def smooth_rest(null: Fit, fit: Fit, smooth_bound: float | None) -> tuple[Fact, ...]:
    """That a fit leaves too much that is smooth, where it does."""
    share = share_of_smooth_bound(null, fit, smooth_bound)
    if share is None or share >= LEAST_SHARE:
        return ()
    part = {"percent": 100.0 * share, "needed": 100.0 * LEAST_SHARE}
    return (Fact(Code.SMOOTH_REST, {"name": fit.name, **part}),)


def contradictions(fit: Fit, tables: Sequence[Table]) -> tuple[Fact, ...]:
    """Tables, of several, whose own misfit is too large although the whole may be adequate."""
    found = []
    for table in tables if len(tables) > 1 else ():
        mine = fit.residual[table.rows]
        # As many chances to fail by noise alone as there are tables.
        level = ADEQUATE / len(tables)
        if lack_of_fit_p(float(mine @ mine), len(mine), table.dof) < level:
            said = {"kind": table.kind, "name": fit.name, "level": level}
            found.append(Fact(Code.TABLE_CONTRADICTS, said))
    return tuple(found)


def share_of_smooth_bound(null: Fit, fit: Fit, smooth_bound: float | None) -> float | None:
    """Part of what a smooth function of the settings explains that a fit explains too."""
    return None if not smooth_bound else (null.chi2 - fit.chi2) / smooth_bound


def _adequate(problem: Problem, fits: Sequence[Fit]) -> list[Fit]:
    return [fit for fit in fits if adequacy(problem, fit) >= ADEQUATE]


def _decided(
    problem: Problem,
    ranking: Ranking,
    cosines: Array,
    improves_prediction: Callable[[Fit], bool],
    chance: Mapping[str, float],
    tables: Sequence[Table],
) -> Verdict:
    """The verdict if something was detected, before smooth functions and tables are asked."""
    singles, null = ranking.singles, ranking.null
    best = next(iter(_adequate(problem, singles)), None)
    if best is None or singles[0].log_evidence > best.log_evidence + MARGIN:
        return _without_single(problem, ranking, cosines, improves_prediction, chance, tables)
    least = singles[0].log_evidence + PAIR_PRICE
    led = [fit for fit in ranking.pairs if fit.log_evidence > least]
    if _adequate(problem, led):
        return _without_single(problem, ranking, cosines, improves_prediction, chance, tables)
    # A candidate that is not quite adequate itself may still be too near to be dismissed.
    candidates = _near(problem, cosines, best, singles, MARGIN)
    if len(candidates) > 1:
        names = tuple(fit.name for fit in candidates)
        said = Fact(Code.NOT_SEPARATED, {"causes": list(names), "margin": MARGIN})
        if all(_alike(problem, cosines, best, fit) for fit in candidates if fit is not best):
            said = Fact(Code.ALIKE, {"causes": list(names), "limit": SAME})
        reasons = (said, *reasons_against(problem, null, best, tables))
        return Verdict("ambiguous", names, best, reasons, chance)
    others = [null, *singles, *ranking.pairs]
    reasons = reasons_against(
        problem, null, best, tables, improves_prediction, others,
        lambda fit: _needed(problem, cosines, best, fit, MARGIN),
    )  # fmt: skip
    if reasons:
        return Verdict("ambiguous", (best.name,), best, reasons, chance)
    second = describe_runner_up(problem, best, null, others)
    look = second_look(problem, best, ranking.pairs)
    return Verdict("named", (best.name,), best, (second, *look), chance)


def reasons_against(
    problem: Problem,
    null: Fit,
    best: Fit,
    tables: Sequence[Table],
    improves_prediction: Callable[[Fit], bool] | None = None,
    others: Sequence[Fit] = (),
    needed: Callable[[Fit], float] = lambda fit: MARGIN,
) -> tuple[Fact, ...]:
    """Why a candidate that leads each of `others` by what is `needed` is not claimed all the same.

    Without `others`, starts that do not agree are a reason, however little they differ.
    """
    reasons = []
    name = {"name": best.name}
    lead = best.log_evidence - null.log_evidence
    if lead < MARGIN:
        reasons.append(Fact(Code.LITTLE_EVIDENCE, {**name, "lead": lead, "margin": MARGIN}))
    if not best.converged and _can_be_led(best, others, needed):
        reasons.append(Fact(Code.STARTS_DISAGREE, name))
    # A relaxed constant adds no shape: the recalibrated model has moved it most of the way.
    shaped = any(cause.relaxes_prior is None for cause in best.candidate.causes)
    if improves_prediction is not None and shaped and not improves_prediction(best):
        reasons.append(Fact(Code.NOT_PREDICTED_BETTER, name))
    pulls = _pulls(problem, best)
    most = max(pulls, key=lambda each: abs(pulls[each]), default=None)
    if most is not None and abs(pulls[most]) > most_pulled(len(pulls)):
        pull = {"constant": most, "pull": pulls[most], "limit": most_pulled(len(pulls))}
        reasons.append(Fact(Code.CONSTANT_PULLED, {**name, **pull}))
    off = np.abs(best.residual[: len(problem.observed)])
    chance = _chance(off, tables, problem.dof)
    rarest = int(np.argmin(chance))
    # As many chances to be that far off by noise alone as there are readings.
    if len(chance) * chance[rarest] < CONTRADICTED:
        fields = {**name, "errors": float(off[rarest]), "level": CONTRADICTED}
        reasons.append(Fact(Code.ERRORS_CONTRADICTED, fields))
    extra = best.candidate.free[problem.base_count :]
    low, high = (end[extra] for end in problem.limits())
    at_high = (best.x[extra] >= high - AT_END) & np.isfinite(high)
    # At a lowest value of 0 a cause is absent.
    at_low = (best.x[extra] <= low + AT_END) & (low < 0.0)
    if np.any(at_high | at_low):
        reasons.append(Fact(Code.AT_LIMIT, name))
    return tuple(reasons)


def _can_be_led(best: Fit, others: Sequence[Fit], needed: Callable[[Fit], float]) -> bool:
    """Whether one whose starts do not agree could lead another candidate by too little.

    A better minimum would only add to its lead. But the searches of its rivals may have missed
    theirs by as much as the second best of its own has missed the best. Where there are no others,
    nothing is known of them.
    """
    second = best.starts[1] if len(best.starts) > 1 else np.inf
    spare = [
        best.priced_evidence - fit.priced_evidence - needed(fit) for fit in rivals(best, others)
    ]
    return min(spare, default=-np.inf) < 0.5 * (second - best.starts[0])


def _chance(off: Array, tables: Sequence[Table], dof: float) -> Array:
    """Probability that noise alone makes each residual, in errors, larger: by its own table's.

    By that of all, with degrees of freedom `dof`, where there are no tables.
    """
    freedom = np.full(len(off), dof)
    for table in tables:
        freedom[table.rows] = table.dof
    return np.asarray(2.0 * student_law.sf(off, freedom))


def most_pulled(count: int) -> float:
    """Largest pull that is claimed where there are some constants, cameras' and others'.

    Each of n honest constants lies beyond L on either side with a probability of 2 Q(L), so that
    one of them does with at most 2 n Q(L), whatever their correlation. This is `_PULLED_SHARE`
    where Q(L) = 0.0125 / n.
    """
    return max(MOST_PULLED, float(normal_law.isf(0.5 * _PULLED_SHARE / max(count, 1))))


def _pulls(problem: Problem, fit: Fit) -> dict[str, float]:
    """Distances of the constants from their priors, in their standard deviations, by name.

    Without those that are known in range only, or whose prior the fit relaxes.
    """
    relaxed = {cause.relaxes_prior for cause in fit.candidate.causes}
    return {
        each.name: float(fit.x[k])
        for k, each in enumerate(problem.uncertain)
        if each.prior.has_middle and each.name not in relaxed
    }


def _near(
    problem: Problem, cosines: Array, best: Fit, fits: Sequence[Fit], margin: float
) -> list[Fit]:
    """The best of some fits and those it leads by too little."""
    return [
        fit
        for fit in fits
        if best.log_evidence - fit.log_evidence < _needed(problem, cosines, best, fit, margin)
    ]


def _needed(problem: Problem, cosines: Array, best: Fit, fit: Fit, margin: float) -> float:
    """By how much a candidate has to lead another one: `margin`, or more of an alike one."""
    return ALIKE_MARGIN if _alike(problem, cosines, best, fit) else margin


def _alike(problem: Problem, cosines: Array, one: Fit, other: Fit) -> bool:
    return alike(problem, cosines, one.candidate.causes, other.candidate.causes)


def _without_single(
    problem: Problem,
    ranking: Ranking,
    cosines: Array,
    improves_prediction: Callable[[Fit], bool],
    chance: Mapping[str, float],
    tables: Sequence[Table],
) -> Verdict:
    """The verdict if no single cause can be claimed: a pair, a set of pairs, or unexplained."""
    best_single = ranking.singles[0] if ranking.singles else ranking.null
    adequate = _adequate(problem, ranking.pairs)
    if not adequate or adequate[0].log_evidence < best_single.log_evidence + PAIR_PRICE:
        reason = Fact(Code.NO_EXPLANATION, {"level": ADEQUATE})
        enough = _adequate(problem, ranking.singles)
        if enough:
            names = {"explaining": enough[0].name, "name": best_single.name}
            reason = Fact(Code.LESS_LIKELY, names)
        elif adequate:
            lead = adequate[0].log_evidence - best_single.log_evidence
            pair = {"name": adequate[0].name, "lead": lead, "needed": PAIR_PRICE}
            reason = Fact(Code.PAIR_LEADS_TOO_LITTLE, pair)
        return Verdict("unexplained", (), None, (reason,), chance)
    best = adequate[0]
    if ranking.pairs[0].log_evidence > best.log_evidence + MARGIN:
        names = {"explaining": best.name, "name": ranking.pairs[0].name}
        return Verdict("unexplained", (), None, (Fact(Code.LESS_LIKELY, names),), chance)
    close = _near(problem, cosines, best, ranking.pairs, PAIR_MARGIN)
    causes = tuple(sorted({cause.name for fit in close for cause in fit.candidate.causes}))
    if len(close) > 1:
        far = best.log_evidence - close[-1].log_evidence
        margin = PAIR_MARGIN if far < PAIR_MARGIN else ALIKE_MARGIN
        several = {"count": len(close), "pairs": [fit.name for fit in close], "margin": margin}
        reasons: tuple[Fact, ...] = (Fact(Code.SEVERAL_PAIRS, several),)
    else:
        others = [ranking.null, *ranking.singles, *ranking.pairs]
        reasons = reasons_against(
            problem, ranking.null, best, tables, improves_prediction, others,
            lambda fit: _needed(problem, cosines, best, fit, MARGIN),
        )  # fmt: skip
    if reasons:
        return Verdict("ambiguous", causes, best, reasons, chance)
    return Verdict("pair", causes, best, (Fact(Code.PAIR_NEEDED, {"name": best.name}),), chance)
