"""Places to begin from: a scan of the constants, and of many places those that lie apart."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import qmc

from stickslip.diagnosis.fits import Rival
from stickslip.diagnosis.model import Problem

Array = NDArray[np.float64]
Item = TypeVar("Item")

_FARTHEST = 7.0


def scan(problem: Problem, rival: Rival, count: int, seed: int) -> Array:
    """Coordinates of a Sobol scan of the constants, best first.

    A freed constant is looked for at up to seven standard deviations of its prior, evenly.
    """
    p = problem.base_count
    x = np.zeros((count, problem.size))
    width = rival.width[:p]
    if p:
        sobol = qmc.Sobol(p, scramble=True, seed=seed)
        share = np.clip(sobol.random(count), 1e-3, 1 - 1e-3)
        x[:, :p] = np.where(width > 1.0, _FARTHEST * (2.0 * share - 1.0), ndtri(share))
        x[0] = 0.0
    chi2 = problem.misfit(problem.residuals(x)) + np.sum((x[:, :p] / width) ** 2, axis=1)
    return np.asarray(x[np.argsort(chi2, kind="stable")])


def apart(items: Iterable[Item], place: Callable[[Item], Array], distance: float) -> list[Item]:
    """Those that are not closer than a distance to an earlier one."""
    kept: list[Item] = []
    for item in items:
        if all(np.linalg.norm(place(item) - place(other)) > distance for other in kept):
            kept.append(item)
    return kept
