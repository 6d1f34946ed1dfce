"""Careful fits of the candidates that lead, with further starts until two of them agree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stickslip.diagnosis.fit.fit_result import Fit, Start, ranked
from stickslip.diagnosis.fit.least_squares import spread_factor
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.model.problem import Problem

# The numbers below are chosen, not derived. Distances are in coordinates, of which 1 is a standard
# deviation of the prior; leads are of log-evidence.

CAREFUL = 10
"""Most steps of a careful fit. Chosen: most searches end before."""

SURVIVORS = 6
"""Candidates that are refitted with care: with fewer, one that was fitted badly is lost; most of
the time of a diagnosis goes with their number."""

WITHIN = 14.0
"""How far behind the best in log-evidence they may be: a million to one, as a quick fit may be some
units too low."""

# Longest step of a coordinate to a start beside a fit: a longer one would leave its minimum.
_NEARBY = 0.5
# Leaders whose starts have to agree: the verdict compares two.
_LEADING = 2
# Widths of the rounds of further starts, in standard deviations of the posterior: wide ones first,
# as they find other minima, and narrow ones for what has jumps in between. With fewer rounds more
# candidates count as not converged.
_ROUNDS = (2.0, 2.0, 2.0, 1.0, 1.0, 1.0)
# Starts of a round beside that of the fit, and the farthest that a coordinate moves in it: wider
# ones rarely end at the same place.
_PER_ROUND, _ROUND_REACH = 2, 1.0


def refine(
    problem: Problem,
    quick: Sequence[Fit],
    others: Mapping[str, Sequence[Start]],
    random_restarts: int = 0,
    survivors: int = SURVIVORS,
    within: float = WITHIN,
) -> tuple[Fit, ...]:
    """Refit the survivors with care and from further starts; the rest keep their quick fits.

    The survivors are the best few that are not farther than `within` behind in log-evidence.
    """
    if not quick:
        return ()
    order = ranked(quick)
    chosen = [fit for fit in order[:survivors] if fit.log_evidence > order[0].log_evidence - within]
    begins = [[Start.of(fit), *others.get(fit.name, ()), _nearby(problem, fit)] for fit in chosen]
    candidates = [fit.candidate for fit in chosen]
    careful = fit_candidates(problem, candidates, begins, CAREFUL, random_restarts=random_restarts)
    by_name = {fit.name: fit for fit in careful}
    fits = [by_name.get(fit.name, fit) for fit in quick]
    return ranked(search_until_converged(problem, fits, random_restarts))


def _nearby(problem: Problem, fit: Fit) -> Start:
    """A start one standard deviation of the posterior away, in alternating signs."""
    low, high = problem.limits()
    free = fit.candidate.free
    x = fit.x.copy()
    signs = np.where(np.arange(len(free)) % 2 == 0, 1.0, -1.0)
    step = signs * np.minimum(np.sqrt(np.diag(fit.covariance)), _NEARBY)
    x[free] = np.clip(x[free] + step, low[free], high[free])
    return Start(x)


def search_until_converged(
    problem: Problem, fits: Sequence[Fit], random_restarts: int = 0
) -> list[Fit]:
    """Fits in their order, leaders whose starts do not agree after more starts about them."""
    leaders = {fit.name: fit for fit in ranked(fits)[:_LEADING]}
    low, high = problem.limits()
    random = np.random.default_rng(7)
    for width in _ROUNDS:
        doubtful = [fit for fit in leaders.values() if not fit.converged]
        begins = []
        for fit in doubtful:
            free = fit.candidate.free
            lower = spread_factor(fit.jacobian)
            points = [Start.of(fit)]
            for _ in range(_PER_ROUND):
                x = fit.x.copy()
                step = width * lower @ random.standard_normal(len(free))
                x[free] += np.clip(step, -_ROUND_REACH, _ROUND_REACH)
                points.append(Start(np.clip(x, low, high)))
            begins.append(points)
        again = fit_candidates(
            problem,
            [fit.candidate for fit in doubtful],
            begins,
            CAREFUL,
            random_restarts=max(random_restarts, 1),
        )
        leaders |= {fit.name: fit for fit in again}
    return [leaders.get(fit.name, fit) for fit in fits]
