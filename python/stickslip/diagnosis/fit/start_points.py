"""Points to begin from: a scan of the constants, and of many points those that lie apart."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from stickslip.diagnosis.fit.fit_result import Candidate
from stickslip.diagnosis.model.problem import Array, Problem

Item = TypeVar("Item")

# Largest coordinates of a scan: of a relaxed constant, in standard deviations of its own prior, and
# of an amplitude, whose prior is standard normal. Chosen: 99 % of the amplitudes are not larger.
_FARTHEST, _LARGEST = 7.0, 2.5
# Length over which a drawn curve changes, in its range. Chosen: it bends about once.
_BEND = 0.7


def sobol_scan(
    problem: Problem, candidate: Candidate, count: int, seed: int, of_curves: bool = False
) -> Array:
    """Coordinates of a Sobol scan of all that the candidate fits, best first.

    Constants are drawn from their priors; a relaxed one is scanned evenly up to seven standard
    deviations of its prior, and a cause at all amplitudes that are not extreme. With `of_curves`
    the amplitudes are knots of a curve, which are drawn from their priors as smooth curves.
    """
    p, free = problem.base_count, candidate.free
    low, high = problem.limits()
    x = np.zeros((count, problem.size))
    if len(free):
        sobol = qmc.Sobol(len(free), scramble=True, seed=seed)
        share = np.clip(sobol.random(count), 1e-3, 1 - 1e-3)
        known = np.where(candidate.width > 1.0, _FARTHEST * (2.0 * share - 1.0), ndtri(share))
        least, most = np.maximum(low[free], -_LARGEST), np.minimum(high[free], _LARGEST)
        if of_curves:
            amplitudes = ndtri(share)
            amplitudes[:, free >= p] @= _smooth(len(free[free >= p])).T
            amplitudes = np.clip(amplitudes, low[free], high[free])
        else:
            amplitudes = least + (most - least) * share
        x[:, free] = np.where(free < p, known, amplitudes)
        x[0] = 0.0
    prior = np.sum((x[:, free] / candidate.width) ** 2, axis=1)
    chi2 = problem.misfit(problem.residuals(x)) + prior
    return np.asarray(x[np.argsort(chi2, kind="stable")])


def _smooth(knots: int) -> Array:
    """What makes independent normal numbers the values of a smooth random curve at its knots."""
    along = np.linspace(0.0, 1.0, knots)
    alike = np.exp(-0.5 * ((along[:, None] - along) / _BEND) ** 2)
    return np.asarray(np.linalg.cholesky(alike + 1e-6 * np.eye(knots)))


def well_separated(
    items: Iterable[Item], place: Callable[[Item], Array], distance: float, most: int | None = None
) -> list[Item]:
    """Those that are not closer than a distance to an earlier one, and of them the first `most`."""
    kept: list[Item] = []
    for item in items:
        if len(kept) == most:
            break
        if all(np.linalg.norm(place(item) - place(other)) > distance for other in kept):
            kept.append(item)
    return kept
