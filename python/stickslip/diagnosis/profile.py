"""Chi-square along one parameter of a cause, everything else fitted anew at each value.

The curvature at the best fit says too little where chi-square has steps; the profile does not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.fits import Fit, Rival, Start, fitted_parameters
from stickslip.diagnosis.fitting import fit_rivals
from stickslip.diagnosis.model import Problem

Array = NDArray[np.float64]

_PLACES = (-3.0, -1.7, -1.0, -0.5, 0.0, 0.5, 1.0, 1.7, 3.0)
_STEPS = 4
_WIDEST = 8.0


@dataclass(frozen=True)
class Profile:
    """Profile of one parameter.

    Attributes
    ----------
    name, unit : str
    value : ndarray, shape (k,)
        In the unit, rising coordinates.
    chi2 : ndarray, shape (k,)
        Above the least of them.
    sd : float
        Half the width of the interval in which chi-square is less than 1 above the least.
    """

    name: str
    unit: str
    value: Array
    chi2: Array
    sd: float


def profile(problem: Problem, fit: Fit) -> list[Profile]:
    """Profiles of all parameters of the causes of a fit, freed constants among them."""
    spread = np.sqrt(np.diag(fit.covariance))
    found = []
    for each in fitted_parameters(problem, fit):
        if each.shape:
            continue
        u, chi2 = _along(problem, fit, each.column, float(spread[each.position]))
        value = np.asarray(each.continuous(u), dtype=float)
        found.append(Profile(each.name, each.unit, value, chi2, _half_width(value, chi2)))
    return found


def _along(problem: Problem, fit: Fit, column: int, spread: float) -> tuple[Array, Array]:
    """Coordinates about the fit and their chi-squares, wider until these have risen by one."""
    places = np.array(_PLACES)
    low, high = (float(end[column]) for end in problem.limits())
    while True:
        u = np.unique(np.clip(fit.x[column] + places * spread, low, high))
        chi2 = _fixed(problem, fit, column, u)
        chi2 -= chi2.min()
        reached = chi2[0] > 1.0 or u[0] <= low, chi2[-1] > 1.0 or u[-1] >= high
        if all(reached) or places[-1] > _WIDEST:
            return u, chi2
        places = places * 3.0


def _fixed(problem: Problem, fit: Fit, column: int, u: Array) -> Array:
    """Chi-square with one coordinate held at each of some values."""
    rival = fit.rival
    keep = rival.free != column
    held = Rival(rival.causes, rival.free[keep], rival.width[keep])
    own = float(rival.width[~keep][0])
    direction = fit.covariance[:, ~keep][:, 0]
    begins = []
    for value in u:
        x = fit.x.copy()
        # The others follow as the covariance says.
        step = (value - fit.x[column]) * direction / direction[~keep][0]
        x[rival.free] += step
        x[column] = value
        begins.append([Start(x, fit.slope[:, keep])])
    fits = fit_rivals(problem, [held] * len(u), begins, _STEPS, exact=False)
    return np.array([each.chi2 for each in fits]) + (u / own) ** 2


def _half_width(value: Array, chi2: Array) -> float:
    """Half the width in which chi-square is below 1, by straight lines between the points."""
    order = np.argsort(value)
    value, chi2 = value[order], chi2[order]
    inside = np.flatnonzero(chi2 <= 1.0)
    first, last = int(inside[0]), int(inside[-1])

    def crossing(a: int, b: int) -> float:
        share = (1.0 - chi2[a]) / (chi2[b] - chi2[a])
        return float(value[a] + share * (value[b] - value[a]))

    left = float(value[0]) if first == 0 else crossing(first, first - 1)
    right = float(value[-1]) if last == len(value) - 1 else crossing(last, last + 1)
    return 0.5 * (right - left)
