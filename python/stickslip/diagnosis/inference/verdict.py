"""From tests and fits to one of six verdicts."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.distinguishability import SAME
from stickslip.diagnosis.fit.fit_result import PAIR_PRICE, Fit, Ranking, ranked
from stickslip.diagnosis.fit.goodness import ADEQUATE, adequacy, lack_of_fit_p
from stickslip.diagnosis.inference.detection import ALPHA, Detection
from stickslip.diagnosis.model.problem import Problem
from stickslip.facts import Code, Fact

Array = NDArray[np.float64]
VerdictKind = Literal["none", "named", "ambiguous", "pair", "unexplained", "data-problem"]

MARGIN = 3.0
"""Log-evidence by which a named cause leads."""

PRIOR_NONE, PRIOR_UNKNOWN = 0.5, 0.1
"""What is thought before any data of no cause, and of a cause of any shape; the rest is shared."""

LEAST_SHARE = 0.7
"""Of what a smooth function explains, so that a cause or a pair may be claimed."""


@dataclass(frozen=True, repr=False)
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
    rows: NDArray[np.int64]
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
    said = _decided(problem, ranking, cosines, improves_prediction, chance)
    if said.fit is not None and said.kind in ("named", "pair"):
        share = share_of_smooth_bound(ranking.null, said.fit, smooth_bound)
        if share is not None and share < LEAST_SHARE:
            part = {"percent": 100.0 * share, "needed": 100.0 * LEAST_SHARE}
            reason = Fact(Code.SMOOTH_REST, {"name": said.fit.name, **part})
            return Verdict("unexplained", (), None, (reason,), _unknown(chance, said.causes))
        against = contradicting(said.fit, tables)
        if against:
            fact = Fact(
                Code.TABLE_CONTRADICTS, {"name": said.fit.name, "level": ADEQUATE / len(tables)}
            )
            return replace(
                said, kind="ambiguous", reasons=tuple(fact.of(kind=each) for each in against)
            )
    return said


def contradicting(fit: Fit, tables: Sequence[Table]) -> list[str]:
    """Tables, of several, whose own misfit is too large although the whole may be adequate."""
    found = []
    for table in tables:
        mine = fit.residual[table.rows]
        # As many chances to fail by noise alone as there are tables.
        if lack_of_fit_p(float(mine @ mine), len(mine), table.dof) < ADEQUATE / len(tables):
            found.append(table.kind)
    return found if len(tables) > 1 else []


def _unknown(chance: Mapping[str, float], refused: Sequence[str]) -> dict[str, float]:
    """What was thought of causes that leave something smooth behind goes to what is not known."""
    result = {name: 0.0 if name in refused else p for name, p in chance.items()}
    result["unknown"] += sum(chance[name] for name in refused)
    return result


def share_of_smooth_bound(null: Fit, fit: Fit, smooth_bound: float | None) -> float | None:
    """Part of what a smooth function of the settings explains that a fit explains too."""
    return None if not smooth_bound else (null.chi2 - fit.chi2) / smooth_bound


def _decided(
    problem: Problem,
    ranking: Ranking,
    cosines: Array,
    improves_prediction: Callable[[Fit], bool],
    chance: Mapping[str, float],
) -> Verdict:
    """The verdict if something was detected and its causes explain enough."""
    singles, null = ranking.singles, ranking.null
    adequate = [fit for fit in singles if adequacy(problem, fit) >= ADEQUATE]
    if not adequate:
        return _without_single(problem, ranking, improves_prediction, chance)
    best = adequate[0]
    if best is not singles[0] and singles[0].log_evidence > best.log_evidence + MARGIN:
        return _without_single(problem, ranking, improves_prediction, chance)
    led = [fit for fit in ranking.pairs if fit.log_evidence > best.log_evidence + PAIR_PRICE]
    if any(adequacy(problem, fit) >= ADEQUATE for fit in led):
        return _without_single(problem, ranking, improves_prediction, chance)
    index = {cause.name: k for k, cause in enumerate(problem.causes)}
    # A candidate that is not quite adequate itself may still be too near to be dismissed.
    close = [fit for fit in singles if best.log_evidence - fit.log_evidence < MARGIN]
    alike = [
        fit
        for fit in singles
        if cosines[index[best.name], index[fit.name]] > SAME
        and best.log_evidence - fit.log_evidence < 2 * MARGIN
    ]
    candidates = [fit for fit in singles if fit in close or fit in alike]
    if len(candidates) > 1:
        names = tuple(fit.name for fit in candidates)
        said = Fact(Code.NOT_SEPARATED, {"causes": list(names), "margin": MARGIN})
        if all(fit in alike or fit is best for fit in candidates):
            said = Fact(Code.ALIKE, {"causes": list(names), "limit": SAME})
        return Verdict(
            "ambiguous", names, best, (said, *_reasons_against(problem, null, best)), chance
        )
    reasons = _reasons_against(problem, null, best, improves_prediction)
    if reasons:
        return Verdict("ambiguous", (best.name,), best, tuple(reasons), chance)
    others = [fit for fit in (*singles, *ranking.pairs) if fit is not best]
    return Verdict(
        "named", (best.name,), best, (describe_runner_up(problem, best, null, others),), chance
    )


def describe_runner_up(problem: Problem, said: Fit, null: Fit, others: Sequence[Fit]) -> Fact:
    """How the best of the others stands to what is said, after the price of a second cause.

    Parameters
    ----------
    problem : Problem
    said, null : Fit
        What is said, and the recalibrated model.
    others : sequence of Fit
        All other candidates.

    Returns
    -------
    Fact
    """
    second = ranked([null, *others], priced=True)[0]
    lead = said.priced_evidence - second.priced_evidence
    if lead >= 0.0:
        return Fact(Code.RUNNER_UP, {"name": second.name, "lead": lead})
    if adequacy(problem, second) >= ADEQUATE:
        return Fact(Code.OTHER_LEADS, {"name": second.name, "lead": -lead})
    unexplained = {"name": second.name, "lead": -lead, "level": ADEQUATE}
    return Fact(Code.OTHER_LEADS_UNEXPLAINED, unexplained)


def checked_on_training_subset(verdict: Verdict, ranking: Ranking, choice: str) -> Verdict:
    """The verdict beside the candidate that the conditions which are not held out rank first.

    What a part of the conditions turns into something else is not claimed. A cause fewer or more is
    nothing else: it takes many conditions to tell.
    """
    fit = verdict.fit
    if fit is None or choice == fit.name:
        return verdict
    said = Fact(Code.TRAINING_SUBSET, {"name": choice})
    candidates = [*ranking.singles, *ranking.pairs]
    other = next((each for each in candidates if each.name == choice), fit)
    own, theirs = ({cause.name for cause in each.candidate.causes} for each in (fit, other))
    if verdict.kind not in ("named", "pair") or own <= theirs or theirs <= own:
        return replace(verdict, reasons=(*verdict.reasons, said))
    # Single causes and pairs make no set together.
    also = sorted(theirs - own) if len(own) == len(theirs) else []
    return replace(verdict, kind="ambiguous", causes=(*verdict.causes, *also), reasons=(said,))


def _reasons_against(
    problem: Problem, null: Fit, best: Fit, improves_prediction: Callable[[Fit], bool] | None = None
) -> list[Fact]:
    """Why a candidate that leads all others is not claimed all the same."""
    reasons = []
    name = {"name": best.name}
    lead = best.log_evidence - null.log_evidence
    if lead < MARGIN:
        reasons.append(Fact(Code.LITTLE_EVIDENCE, {**name, "lead": lead, "margin": MARGIN}))
    if not best.converged:
        reasons.append(Fact(Code.STARTS_DISAGREE, name))
    # A constant's freedom adds no shape: the recalibrated model has moved it most of the way.
    shaped = any(cause.relaxes_prior is None for cause in best.candidate.causes)
    if improves_prediction is not None and shaped and not improves_prediction(best):
        reasons.append(Fact(Code.NOT_PREDICTED_BETTER, name))
    if _at_limit(problem, best):
        reasons.append(Fact(Code.AT_LIMIT, name))
    return reasons


def _without_single(
    problem: Problem,
    ranking: Ranking,
    improves_prediction: Callable[[Fit], bool],
    chance: Mapping[str, float],
) -> Verdict:
    best_single = ranking.singles[0] if ranking.singles else ranking.null
    adequate = [fit for fit in ranking.pairs if adequacy(problem, fit) >= ADEQUATE]
    if not adequate or adequate[0].log_evidence < best_single.log_evidence + PAIR_PRICE:
        reason = Fact(Code.NO_EXPLANATION, {"level": ADEQUATE})
        enough = [fit for fit in ranking.singles if adequacy(problem, fit) >= ADEQUATE]
        if enough:
            reason = Fact(
                Code.LESS_LIKELY, {"explaining": enough[0].name, "name": best_single.name}
            )
        elif adequate:
            lead = adequate[0].log_evidence - best_single.log_evidence
            pair = {"name": adequate[0].name, "lead": lead, "needed": PAIR_PRICE}
            reason = Fact(Code.PAIR_LEADS_TOO_LITTLE, pair)
        return Verdict("unexplained", (), None, (reason,), chance)
    best = adequate[0]
    close = [fit for fit in ranking.pairs if best.log_evidence - fit.log_evidence < MARGIN]
    names = tuple(sorted({cause.name for fit in close for cause in fit.candidate.causes}))
    if len(close) > 1:
        several = {"count": len(close), "pairs": [fit.name for fit in close], "margin": MARGIN}
        said = Fact(Code.SEVERAL_PAIRS, several)
        return Verdict("ambiguous", names, best, (said,), chance)
    reasons = _reasons_against(problem, ranking.null, best, improves_prediction)
    if reasons:
        return Verdict("ambiguous", names, best, tuple(reasons), chance)
    return Verdict("pair", names, best, (Fact(Code.PAIR_NEEDED, {"name": best.name}),), chance)


def _at_limit(problem: Problem, fit: Fit) -> bool:
    low, high = problem.limits()
    extra = fit.candidate.free[problem.base_count :]
    return bool(np.any((fit.x[extra] >= high[extra]) & np.isfinite(high[extra])) or
                np.any((fit.x[extra] <= low[extra]) & (low[extra] < 0.0)))  # fmt: skip


def prior_probabilities(problem: Problem) -> dict[str, float]:
    """What is thought before any data."""
    share = (1.0 - PRIOR_NONE - PRIOR_UNKNOWN) / max(len(problem.causes), 1)
    result = {cause.name: share for cause in problem.causes}
    none = PRIOR_NONE if result else 1.0 - PRIOR_UNKNOWN
    return {**result, "none": none, "unknown": PRIOR_UNKNOWN}


def probabilities(
    problem: Problem, ranking: Ranking, linear_evidence: Mapping[str, float]
) -> dict[str, float]:
    """Posterior over all causes, ``none`` and ``unknown``, summing to 1.

    Prior 0.5 for none, 0.1 for unknown, the rest shared. "Unknown" is a departure of any shape: its
    evidence is that of independent extra variance, fitted, at the price of one parameter. A pair
    counts half for each of its members.
    """
    share = (1.0 - PRIOR_NONE - PRIOR_UNKNOWN) / max(len(problem.causes), 1)
    null = ranking.null
    m = len(problem.observed)
    excess = max(null.chi2 / m, 1.0)
    gain = 0.5 * m * (excess - 1.0 - math.log(excess))
    generic = null.log_evidence + gain - 0.5 * math.log(m)
    # A cause that was not fitted leaves the misfit about as it is.
    nothing = _worth(problem, null)
    weights: dict[str, float] = {
        "none": math.log(PRIOR_NONE) + nothing,
        "unknown": math.log(PRIOR_UNKNOWN) + generic,
    }
    evidence = {name: nothing + above for name, above in linear_evidence.items()}
    evidence |= {fit.name: _worth(problem, fit) for fit in ranking.singles}
    for cause in problem.causes:
        weights[cause.name] = math.log(share) + evidence.get(cause.name, nothing)
    couples = [
        (fit, math.log(share) + math.log(0.1 / max(len(problem.causes), 1)) + _worth(problem, fit))
        for fit in ranking.pairs
        if fit.log_evidence
        > max(evidence.get(each.name, -math.inf) for each in fit.candidate.causes)
    ]
    top = max([*weights.values(), *(weight for _, weight in couples)])
    result = {name: math.exp(weight - top) for name, weight in weights.items()}
    for fit, weight in couples:
        for cause in fit.candidate.causes:
            result[cause.name] += 0.5 * math.exp(weight - top)
    total = sum(result.values())
    ordered = sorted(result.items(), key=lambda item: (item[0] in ("none", "unknown"), -item[1]))
    return {name: value / total for name, value in ordered}


def _worth(problem: Problem, fit: Fit) -> float:
    """Log-evidence, less where the model does not bring the misfit down to the noise."""
    return fit.log_evidence + math.log(min(adequacy(problem, fit) / ADEQUATE, 1.0) + 1e-300)
