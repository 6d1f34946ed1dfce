"""Probabilities of all causes, of none, and of one that is not known."""

from __future__ import annotations

import math
from collections.abc import Mapping

from stickslip.diagnosis.fit.fit_result import Fit, Ranking
from stickslip.diagnosis.fit.goodness import ADEQUATE, adequacy
from stickslip.diagnosis.model.problem import Problem

PRIOR_NONE, PRIOR_UNKNOWN = 0.5, 0.1
"""Probability before any data of no cause, and of a cause of any shape; the causes share the rest.
Chosen, not derived: either is an opinion, and both are told beside the probabilities."""

_PAIR_SHARE = 0.1
"""How much less likely two causes at once are than one, before any data. Chosen: apparatus with two
hidden errors is rarer; the many pairs share it, or they would outweigh single causes by number."""


def _share(problem: Problem) -> float:
    """Prior probability of each cause."""
    return (1.0 - PRIOR_NONE - PRIOR_UNKNOWN) / max(len(problem.causes), 1)


def prior_probabilities(problem: Problem) -> dict[str, float]:
    """Probabilities before any data."""
    result = {cause.name: _share(problem) for cause in problem.causes}
    none = PRIOR_NONE if result else 1.0 - PRIOR_UNKNOWN
    return {**result, "none": none, "unknown": PRIOR_UNKNOWN}


def probabilities(
    problem: Problem, ranking: Ranking, linear_evidence: Mapping[str, float]
) -> dict[str, float]:
    """Posterior over all causes, ``none`` and ``unknown``, summing to 1.

    "Unknown" is a departure of any shape: its evidence is that of independent extra variance,
    fitted, at the price of one parameter. A pair counts half for each of its members.
    """
    share, null = _share(problem), ranking.null
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
    pair_share = math.log(share) + math.log(_PAIR_SHARE / max(len(problem.causes), 1))
    pairs = [
        (fit, pair_share + _worth(problem, fit))
        for fit in ranking.pairs
        if fit.log_evidence
        > max(evidence.get(each.name, -math.inf) for each in fit.candidate.causes)
    ]
    top = max([*weights.values(), *(weight for _, weight in pairs)])
    result = {name: math.exp(weight - top) for name, weight in weights.items()}
    for fit, weight in pairs:
        for cause in fit.candidate.causes:
            result[cause.name] += 0.5 * math.exp(weight - top)
    total = sum(result.values())
    ordered = sorted(result.items(), key=lambda item: (item[0] in ("none", "unknown"), -item[1]))
    return {name: value / total for name, value in ordered}


def _worth(problem: Problem, fit: Fit) -> float:
    """Log-evidence, less where the model does not bring the misfit down to the noise."""
    return fit.log_evidence + math.log(min(adequacy(problem, fit) / ADEQUATE, 1.0) + 1e-300)
