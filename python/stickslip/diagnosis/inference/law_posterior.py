"""Draws of a law of a free shape, from what the data and its prior leave open."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip._util.arrays import Array, Mask
from stickslip.diagnosis.fit.fit_result import Fit, Fitted
from stickslip.diagnosis.inference.law_prior import log_prior, with_learned_prior
from stickslip.diagnosis.model.problem import Problem

# Draws of the linear model.
_DRAWS = 4000
# Fewest walkers, walkers for each free coordinate, steps of each, and steps that are left out at
# the beginning. Chosen: a place is forgotten after ten steps where the model is linear, and after
# thirty where two hidden laws bent it, so that all tell as much as 100 independent draws at least,
# whose width is known to 7 %.
_WALKERS, _FOR_EACH, _STEPS, _BURNED = 40, 3, 100, 20
# Times that a draw beyond a limit is moved half the way to the fit: then it is there but for
# rounding.
_HALVINGS = 50
# Length of a step towards a draw of the linear model, as a share of the model's width. Chosen:
# places are forgotten soonest, with 4 free coordinates as with 25.
_LENGTH = 0.8


def linear_draws(fit: Fit, own: Sequence[Fitted], knots: Sequence[Fitted], size: float) -> Array:
    """Draws of a law's constant and knots, as normal about the fit.

    Parameters
    ----------
    fit : Fit
    own, knots : sequence of Fitted
        The constant of the law, if there is one, and the knots, evenly over the range.
    size : float
        What would not surprise of a knot, in its unit.

    Returns
    -------
    ndarray, shape (draws, own + knots)
        In their units.
    """
    drawn = _drawn_about(fit, own, knots, size)
    constants = [
        each.value(fit.x[each.column])
        + each.slope(fit) * (drawn[:, each.position] - fit.x[each.column])
        for each in own
    ]
    return np.stack([*constants, *(drawn[:, each.position] for each in knots)], axis=1)


def posterior_draws(
    problem: Problem, fit: Fit, own: Sequence[Fitted], knots: Sequence[Fitted], size: float
) -> Array:
    """The same from the posterior, in which all that the fit has free may be anywhere.

    What the data leave open of a law is curved: far from the fit, constants make up for a change of
    the law that near it they cannot make up for. The posterior is sampled by an ensemble (Goodman
    and Weare, Communications in Applied Mathematics and Computational Science 5, 2010, 65-80, with
    the moves of ter Braak, Statistics and Computing 16, 2006, 239-249). It begins at draws of the
    linear model, and half of its steps go towards other draws of it (Cotter, Roberts, Stuart and
    White, Statistical Science 28, 2013, 424-446).
    """
    import emcee

    law = _Law(problem, fit, own, knots, size)
    places = law.places(law.within_limits(_drawn_about(fit, own, knots, size)))
    walkers = max(_WALKERS, _FOR_EACH * places.shape[1])
    towards_linear = emcee.moves.MHMove(_steps_within(places))
    sampler = emcee.EnsembleSampler(
        walkers, places.shape[1], law.log_posterior, vectorize=True,
        moves=[(emcee.moves.StretchMove(), 0.25), (emcee.moves.DEMove(), 0.25),
               (towards_linear, 0.5)],
    )  # fmt: skip
    state = emcee.State(places[:walkers], random_state=np.random.RandomState(31).get_state())
    sampler.run_mcmc(state, _STEPS, skip_initial_state_check=True)
    chain = sampler.get_chain(discard=_BURNED, flat=True)
    return np.hstack([law.constants(chain), law.knots_at(chain)])


def _drawn_about(fit: Fit, own: Sequence[Fitted], knots: Sequence[Fitted], size: float) -> Array:
    """All that is free, shape (draws, free), as normal about the fit: coordinates, knots' values.

    The prior of the knots is the one whose size and smoothness the data tell. What else is free
    goes with them as it does in the fit.
    """
    every = [*own, *knots]
    seen = [each.position for each in every]
    slope = np.array([each.slope(fit) for each in every])
    shift, covariance = with_learned_prior(fit, own, knots, size)
    before = fit.covariance[np.ix_(seen, seen)]
    go_with = np.linalg.solve(before, fit.covariance[seen]).T
    more = go_with @ (covariance / np.outer(slope, slope) - before) @ go_with.T
    random = np.random.default_rng(31)
    off = random.multivariate_normal(
        go_with @ (shift / slope), fit.covariance + more, _DRAWS, check_valid="ignore"
    )
    drawn = fit.x[fit.candidate.free] + off
    for each in knots:
        at_fit = each.value(fit.x[each.column])
        drawn[:, each.position] = at_fit + each.slope(fit) * off[:, each.position]
    return np.asarray(drawn)


def _steps_within(draws: Array) -> Callable[[Array, Any], tuple[Array, Array]]:
    """Steps that stay within a normal law, the one with the mean and covariance of `draws`.

    The second result is the logarithm of how much likelier the way back is than the step.
    """
    centre, root = np.mean(draws, axis=0), np.linalg.cholesky(np.cov(draws.T))

    def step(at: Array, random: Any) -> tuple[Array, Array]:
        now = np.linalg.solve(root, (at - centre).T).T
        then = np.sqrt(1.0 - _LENGTH**2) * now + _LENGTH * random.randn(*now.shape)
        back = 0.5 * (np.sum(then**2, axis=1) - np.sum(now**2, axis=1))
        return centre + then @ root.T, back

    return step


@dataclass(frozen=True)
class _Law:
    """The posterior of a law, at places whose knots are replaced by the law itself.

    Of a constant and a knot the data tell the product alone, and walkers are slow on the thin curve
    on which the two then lie.
    """

    problem: Problem
    fit: Fit
    own: Sequence[Fitted]
    knots: Sequence[Fitted]
    size: float

    @property
    def _at(self) -> list[int]:
        return [each.position for each in self.knots]

    def constants(self, place: Array) -> Array:
        """The law's constant in its unit, shape (places, 1), or (places, 0) without one."""
        values = [each.value(place[:, each.position]) for each in self.own]
        return np.reshape(values, (len(self.own), len(place))).T

    def _factor(self, place: Array) -> Array:
        return self.constants(place) if self.own else np.ones((len(place), 1))

    def within_limits(self, drawn: Array) -> Array:
        """The same, with what is beyond a limit moved towards the fit, which is within all."""
        fit = self.fit.x[self.fit.candidate.free]
        fit[self._at] = [each.value(self.fit.x[each.column]) for each in self.knots]
        drawn = drawn.copy()
        for _ in range(_HALVINGS):
            beyond = ~self.is_allowed(self.coordinates(self.places(drawn)))
            drawn[beyond] = 0.5 * (drawn[beyond] + fit)
        return drawn

    def places(self, drawn: Array) -> Array:
        """Places of coordinates with values of knots."""
        place = drawn.copy()
        place[:, self._at] = self._factor(drawn) * (1.0 + drawn[:, self._at])
        return place

    def knots_at(self, place: Array) -> Array:
        return np.asarray(place[:, self._at] / self._factor(place) - 1.0)

    def coordinates(self, place: Array) -> Array:
        u = place.copy()
        # As `CauseParameter.value`, whose ends are those of the coordinates.
        u[:, self._at] = np.arcsinh(self.knots_at(place) / self.size * np.sinh(1.0))
        return u

    def is_allowed(self, u: Array) -> Mask:
        low, high = (ends[self.fit.candidate.free] for ends in self.problem.limits())
        inside = np.all((u >= low) & (u <= high), axis=1)
        return np.asarray(inside & np.isfinite(u).all(axis=1))

    def log_posterior(self, place: Array) -> Array:
        u = self.coordinates(place)
        allowed = self.is_allowed(u)
        result = np.full(len(u), -np.inf)
        if not allowed.any():
            return result
        place, u = place[allowed], u[allowed]
        x = np.tile(self.fit.x, (len(u), 1))
        x[:, self.fit.candidate.free] = u
        squares = np.sum(self.problem.residuals(x) ** 2, axis=1)
        pulls = np.delete(u / self.fit.candidate.width, self._at, axis=1)
        # The prior is one of knots, of which the law is a multiple.
        volume = len(self.knots) * np.log(np.abs(self._factor(u)[:, 0]))
        knots = log_prior(self.knots_at(place), self.size)
        found = -0.5 * (squares + np.sum(pulls**2, axis=1)) + knots - volume
        result[allowed] = np.where(np.isfinite(found), found, -np.inf)
        return result
