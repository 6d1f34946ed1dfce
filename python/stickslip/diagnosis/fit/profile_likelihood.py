"""Chi-square along one parameter of a cause, everything else fitted anew at each value.

The curvature at the best fit says too little where chi-square has steps and more than one minimum;
the profile shows them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.careful_fit import search_until_converged
from stickslip.diagnosis.fit.fit_result import Candidate, Fit, Fitted, Start, fitted_parameters
from stickslip.diagnosis.fit.multistart import AGREE, fit_candidates
from stickslip.diagnosis.model.problem import Array, Problem

FAR = 9.0
"""Rise of chi-square at both ends up to which a profile goes on: three standard deviations."""

# The numbers below are chosen, not derived.
#
# Values of the parameter in standard deviations by the curvature: close about the best fit, where
# the profile crosses 1 and 4, and so far out that another minimum beyond a barrier is seen.
_OFFSETS = (-8.0, -5.0, -3.0, -1.7, -1.0, -0.5, 0.0, 0.5, 1.0, 1.7, 3.0, 5.0, 8.0)
# Where chi-square has not risen enough at an end, the factor to the next value: a larger one leaves
# gaps in which a minimum is missed.
_FURTHER = 1.5
# The farthest that is gone on from: a parameter that is open so far has no useful error.
_WIDEST = 30.0
# Steps of a fit: it begins beside one that has ended.
_STEPS = 6
# Chi-square above the best value after two steps at which a fit is given up: four times what a
# profile shows, so that no value that is drawn is lost.
_HOPELESS = 4.0 * FAR
# Rounds of starts from the neighbours: a lower minimum spreads by one value on either side in each.
_ROUNDS = 2
# Fall of chi-square that counts as one: a tenth of the rise that is one standard deviation.
_LOWER = 0.1
# How often the fit may move to a lower minimum that its profile shows: each costs all profiles
# again.
_MOVES = 3


@dataclass(frozen=True, repr=False, eq=False)
class Profile(OneLine):
    """Profile of one parameter.

    Attributes
    ----------
    name, unit : str
    value : ndarray, shape (k,)
        In the unit, rising coordinates.
    chi2 : ndarray, shape (k,)
        Above the least of them.
    sd : float
        The largest of the distances from the fit to where chi-square crosses 1 for the last time
        on either side, and of half those to where it crosses 4.
    best : float
        The value of the fit. The least chi-square can be elsewhere, in a minimum so narrow that it
        has less evidence.
    """

    name: str
    unit: str
    value: Array
    chi2: Array
    sd: float
    best: float

    def interval(self, rise: float) -> tuple[float, float]:
        """Lowest and highest value at which chi-square has risen by so much, ``FAR`` at most.

        Where it does not rise so far before the end of the physical range, that end. The value of
        the fit lies within.
        """
        low, high = _crossings(self.value, self.chi2, rise)
        return min(low, self.best), max(high, self.best)


@dataclass
class _Line:
    """Fits with one coordinate held at each of some values, which rise."""

    u: Array
    fits: list[Fit]
    prior_width: float

    @property
    def chi2(self) -> Array:
        """With the prior's row of the coordinate that is held."""
        return np.array([fit.chi2 for fit in self.fits]) + (self.u / self.prior_width) ** 2


def profile(problem: Problem, fit: Fit) -> list[Profile]:
    """Profiles of all parameters of the causes of a fit, relaxed constants among them.

    Parameters
    ----------
    problem : Problem
    fit : Fit

    Returns
    -------
    list of Profile
        One for each parameter that says how strong a cause is, not how it looks.
    """
    return [_profile(fit, each, line) for each, line in _lines(problem, fit)]


def moved_to_profile_minimum(problem: Problem, fit: Fit) -> tuple[Fit, list[Profile]]:
    """A fit and its profiles; a better fit, where the profiles have led to one.

    A lower minimum that is so narrow that it has less evidence is no better one.
    """
    lines = _lines(problem, fit)
    for _ in range(_MOVES if lines else 0):
        best = min((line for _, line in lines), key=lambda line: float(line.chi2.min()))
        if best.chi2.min() > fit.chi2 - _LOWER:
            break
        begin = Start(best.fits[int(np.argmin(best.chi2))].x)
        lower = fit_candidates(problem, [fit.candidate], [[begin]], _STEPS)[0]
        if lower.log_evidence <= fit.log_evidence:
            break
        # As far apart as starts that agree may end.
        near = fit.converged and fit.chi2 - lower.chi2 < AGREE
        checked = replace(lower, converged=near, starts=fit.starts)
        (fit,) = search_until_converged(problem, [checked])
        lines = _lines(problem, fit)
    return fit, [_profile(fit, each, line) for each, line in lines]


def _lines(problem: Problem, fit: Fit) -> list[tuple[Fitted, _Line]]:
    """Fits along each parameter that says how strong a cause is."""
    shown = [each for each in fitted_parameters(problem, fit) if not each.shape]
    return [(each, _along(problem, fit, each)) for each in shown]


def _profile(fit: Fit, each: Fitted, line: _Line) -> Profile:
    value = each.continuous(line.u)
    here = float(each.continuous(fit.x[[each.column]])[0])
    chi2 = line.chi2 - line.chi2.min()
    distances = [
        abs(place - here) / root
        for root in (1.0, 2.0)
        for place in _crossings(value, chi2, root**2)
    ]
    return Profile(each.name, each.unit, value, chi2, max(distances), here)


def _along(problem: Problem, fit: Fit, each: Fitted) -> _Line:
    """Fits about one, on and on to either side until chi-square has risen by ``FAR``."""
    spread = float(np.sqrt(fit.covariance[each.position, each.position]))
    low, high = (float(end[each.column]) for end in problem.limits())
    middle = float(fit.x[each.column])
    offsets = np.array(_OFFSETS)
    done: dict[float, Fit] = {}
    while True:
        u = np.unique(np.clip(middle + offsets * spread, low, high))
        line = _fixed(problem, fit, each.column, u, done)
        chi2 = line.chi2 - line.chi2.min()
        more = []
        if chi2[0] < FAR and u[0] > low and -offsets[0] < _WIDEST:
            more.append(_FURTHER * offsets[0])
        if chi2[-1] < FAR and u[-1] < high and offsets[-1] < _WIDEST:
            more.append(_FURTHER * offsets[-1])
        if not more:
            return line
        offsets = np.unique([*offsets, *more])
        done = dict(zip(u.tolist(), line.fits, strict=True))


def _fixed(problem: Problem, fit: Fit, column: int, u: Array, done: Mapping[float, Fit]) -> _Line:
    """Fits with one coordinate held at each of some values, some of which are done already.

    Every one begins where the covariance leads it, and at a random point about that; then where its
    neighbours have ended, since a jump of chi-square stops many a search.
    """
    candidate = fit.candidate
    keep = candidate.free != column
    held = Candidate(candidate.causes, candidate.free[keep], candidate.width[keep])
    prior_width = float(candidate.width[~keep][0])
    slope, covariance = fit.slope[:, keep], fit.covariance
    random = np.random.default_rng(29)
    begins = []
    for value in u.tolist():
        if value in done:
            begins.append([Start.of(done[value])])
            continue
        led = fit.x.copy()
        step = value - fit.x[column]
        led[candidate.free] += step * covariance[:, ~keep][:, 0] / covariance[~keep, ~keep][0]
        drawn = led.copy()
        drawn[candidate.free] += 2.0 * random.multivariate_normal(
            np.zeros(len(keep)), covariance, method="eigh"
        )
        for x in (led, drawn):
            x[column] = value
        begins.append([Start(x, slope) for x in (led, drawn)])
    candidates = [held] * len(u)
    fits = fit_candidates(problem, candidates, begins, _STEPS, _HOPELESS, exact=False)
    changed = list(range(len(u)))
    for _ in range(_ROUNDS):
        beside = {k for other in changed for k in (other - 1, other + 1) if 0 <= k < len(u)}
        least = min(fit.chi2 for fit in fits)
        which = sorted(k for k in beside if fits[k].chi2 < least + _HOPELESS)
        again, changed = _from_neighbours(problem, fits, column, u, which), []
        for k, new in again.items():
            if new.chi2 < fits[k].chi2 - _LOWER:
                changed.append(k)
                fits[k] = new
    return _Line(u, fits, prior_width)


def _from_neighbours(
    problem: Problem, fits: Sequence[Fit], column: int, u: Array, which: Sequence[int]
) -> dict[int, Fit]:
    """Fits at some of the values, begun where those beside them have ended."""

    def moved(end: Fit, value: float) -> Start:
        x = end.x.copy()
        x[column] = value
        return Start(x, end.slope)

    begins = [
        [moved(fits[other], u[k]) for other in (k - 1, k + 1) if 0 <= other < len(u)] for k in which
    ]
    candidates = [fits[k].candidate for k in which]
    again = fit_candidates(problem, candidates, begins, _STEPS, _HOPELESS, exact=False)
    return dict(zip(which, again, strict=True))


def _crossings(value: Array, chi2: Array, level: float) -> tuple[float, float]:
    """First and last crossing of a level; the end where there is none.

    By straight lines between the roots of chi-square, which are straight where it is a parabola.
    """
    order = np.argsort(value)
    value, chi2 = value[order], chi2[order]
    inside = np.flatnonzero(chi2 <= level)
    first, last = int(inside[0]), int(inside[-1])

    def between(a: int, b: int) -> float:
        low, high = np.sqrt(chi2[[a, b]])
        share = (np.sqrt(level) - low) / (high - low)
        return float(value[a] + share * (value[b] - value[a]))

    left = float(value[0]) if first == 0 else between(first, first - 1)
    right = float(value[-1]) if last == len(value) - 1 else between(last, last + 1)
    return left, right
