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
from stickslip.diagnosis.inference.detection import Detection
from stickslip.diagnosis.model.problem import Problem

Array = NDArray[np.float64]
VerdictKind = Literal["none", "named", "ambiguous", "pair", "unexplained", "data-problem"]

MARGIN = 3.0
"""Log-evidence by which a named cause leads."""

_NONE, _UNKNOWN = 0.5, 0.1
_LEAST_SHARE = 0.7
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
    reasons : tuple of str
        Why it is this verdict and no bolder one.
    probabilities : dict
        Over all causes, ``none`` and ``unknown``; they sum to 1.
    """

    kind: VerdictKind
    causes: tuple[str, ...]
    fit: Fit | None
    reasons: tuple[str, ...]
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
        return Verdict("none", (), None, ("both tests pass",), chance)
    said = _decided(problem, ranking, cosines, improves_prediction, chance)
    if said.fit is not None and said.kind in ("named", "pair"):
        share = share_of_smooth_bound(ranking.null, said.fit, smooth_bound)
        if share is not None and share < _LEAST_SHARE:
            reason = (
                f"{said.fit.name} takes {100.0 * share:.0f} % of what a smooth function of the "
                f"settings would take from the misfit"
            )
            return Verdict("unexplained", (), None, (reason,), _unknown(chance, said.causes))
        against = contradicting(said.fit, tables)
        if against:
            reasons = tuple(f"the table of kind {name} contradicts it" for name in against)
            return replace(said, kind="ambiguous", reasons=reasons)
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
        said = "the evidence does not separate them"
        if all(fit in alike or fit is best for fit in candidates):
            said = "their effects on this data are alike once the model is recalibrated"
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


def describe_runner_up(problem: Problem, said: Fit, null: Fit, others: Sequence[Fit]) -> str:
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
    str
        In words, with the lead in log-evidence.
    """
    second = ranked([null, *others], priced=True)[0]
    name = "no cause at all" if second is null else second.name
    lead = said.priced_evidence - second.priced_evidence
    if lead < 0.0:
        leads = f"{name} leads by {-lead:.1f} in log-evidence"
        explains = adequacy(problem, second) >= ADEQUATE
        return leads if explains else f"{leads}, but does not explain the data"
    return f"the runner-up, {name}, is behind by {lead:.1f} in log-evidence"


def checked_on_training_subset(verdict: Verdict, ranking: Ranking, choice: str) -> Verdict:
    """The verdict beside the candidate that the conditions which are not held out rank first.

    What a part of the conditions turns into something else is not claimed. A cause fewer or more is
    nothing else: it takes many conditions to tell.
    """
    fit = verdict.fit
    if fit is None or choice == fit.name:
        return verdict
    said = f"without the held-out conditions {choice} would lead"
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
) -> list[str]:
    """Why a candidate that leads all others is not claimed all the same."""
    reasons = []
    if best.log_evidence - null.log_evidence < MARGIN:
        reasons.append("the log-evidence is less than 3 above that of no cause")
    if not best.converged:
        reasons.append("fits from different starts do not agree")
    # A constant's freedom adds no shape: the recalibrated model has moved it most of the way.
    shaped = any(cause.relaxes_prior is None for cause in best.candidate.causes)
    if improves_prediction is not None and shaped and not improves_prediction(best):
        reasons.append("conditions that are left out are not predicted better")
    if _at_limit(problem, best):
        reasons.append("an amplitude is at the end of its physical range")
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
        reason = "no single cause and no pair brings the misfit down to the noise"
        enough = [fit for fit in ranking.singles if adequacy(problem, fit) >= ADEQUATE]
        if enough:
            reason = (
                f"{enough[0].name} brings the misfit down to the noise, but is less likely than "
                f"{best_single.name}, which does not"
            )
        elif adequate:
            reason = "no single cause is adequate, and a pair leads by too little to be claimed"
        return Verdict("unexplained", (), None, (reason,), chance)
    best = adequate[0]
    close = [fit for fit in ranking.pairs if best.log_evidence - fit.log_evidence < MARGIN]
    names = tuple(sorted({cause.name for fit in close for cause in fit.candidate.causes}))
    if len(close) > 1:
        said = f"{len(close)} pairs explain the data about as well: " + "; ".join(
            fit.name for fit in close[:4]
        )
        return Verdict("ambiguous", names, best, (said,), chance)
    reasons = _reasons_against(problem, ranking.null, best, improves_prediction)
    if reasons:
        return Verdict("ambiguous", names, best, tuple(reasons), chance)
    return Verdict("pair", names, best, ("no single cause explains the data as well",), chance)


def _at_limit(problem: Problem, fit: Fit) -> bool:
    low, high = problem.limits()
    extra = fit.candidate.free[problem.base_count :]
    return bool(np.any((fit.x[extra] >= high[extra]) & np.isfinite(high[extra])) or
                np.any((fit.x[extra] <= low[extra]) & (low[extra] < 0.0)))  # fmt: skip


def prior_probabilities(problem: Problem) -> dict[str, float]:
    """What is thought before any data."""
    share = (1.0 - _NONE - _UNKNOWN) / max(len(problem.causes), 1)
    result = {cause.name: share for cause in problem.causes}
    return {**result, "none": _NONE if result else 1.0 - _UNKNOWN, "unknown": _UNKNOWN}


def probabilities(
    problem: Problem, ranking: Ranking, linear_evidence: Mapping[str, float]
) -> dict[str, float]:
    """Posterior over all causes, ``none`` and ``unknown``, summing to 1.

    Prior 0.5 for none, 0.1 for unknown, the rest shared. "Unknown" is a departure of any shape: its
    evidence is that of independent extra variance, fitted, at the price of one parameter. A pair
    counts half for each of its members.
    """
    share = (1.0 - _NONE - _UNKNOWN) / max(len(problem.causes), 1)
    null = ranking.null
    m = len(problem.observed)
    excess = max(null.chi2 / m, 1.0)
    gain = 0.5 * m * (excess - 1.0 - math.log(excess))
    generic = null.log_evidence + gain - 0.5 * math.log(m)
    # A cause that was not fitted leaves the misfit about as it is.
    nothing = _worth(problem, null)
    weights: dict[str, float] = {
        "none": math.log(_NONE) + nothing,
        "unknown": math.log(_UNKNOWN) + generic,
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
