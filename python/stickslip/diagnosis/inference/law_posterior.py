"""Draws of a law of a free shape, from what the data and its prior leave open."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fit.fit_result import Fit, Fitted
from stickslip.diagnosis.inference.law_prior import log_prior, with_learned_prior
from stickslip.diagnosis.model.problem import Problem

# Walkers, steps of each, and steps that are left out at the beginning. Chosen: the bands of hidden
# laws changed little with more.
_WALKERS, _STEPS, _BURNED = 40, 200, 60
# Draws of the linear model.
_DRAWS = 4000


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
    every = [*own, *knots]
    shift, covariance = with_learned_prior(fit, own, knots, size)
    values = np.array([float(each.value(fit.x[each.column])) for each in every])
    random = np.random.default_rng(31)
    return random.multivariate_normal(values + shift, covariance, _DRAWS, check_valid="ignore")


def posterior_draws(
    problem: Problem, fit: Fit, own: Sequence[Fitted], knots: Sequence[Fitted], size: float
) -> Array:
    """The same from the posterior, in which all that the fit has free may be anywhere.

    What the data leave open of a law is curved: far from the fit, constants make up for a change of
    the law that near it they cannot make up for. The posterior is sampled by an ensemble that
    begins at draws of the linear model (Goodman and Weare, Communications in Applied Mathematics
    and Computational Science 5, 2010, 65-80, with the moves of ter Braak, Statistics and Computing
    16, 2006, 239-249).

    It moves in the law itself and not in its knots: of a constant and a knot the data tell the
    product alone, and walkers are slow on the thin curve on which the two then lie.
    """
    import emcee

    free, width = fit.candidate.free, fit.candidate.width
    low, high = (ends[free] for ends in problem.limits())
    at = [each.position for each in knots]
    is_constant = np.ones(len(free), dtype=bool)
    is_constant[at] = False

    def values(u: Array, parameters: Sequence[Fitted]) -> Array:
        return np.stack([each.value(u[:, each.position]) for each in parameters], axis=1)

    def factor(u: Array) -> Array:
        return values(u, own) if own else np.ones((len(u), 1))

    def knots_of(place: Array) -> Array:
        return place[:, at] / factor(place) - 1.0

    def log_posterior(place: Array) -> Array:
        knot = knots_of(place)
        u = place.copy()
        # As `CauseParameter.value`, whose ends are those of the coordinates.
        u[:, at] = np.arcsinh(knot / size * np.sinh(1.0))
        inside = np.all((u >= low) & (u <= high), axis=1) & np.isfinite(u).all(axis=1)
        result = np.full(len(u), -np.inf)
        if not inside.any():
            return result
        x = np.tile(fit.x, (int(inside.sum()), 1))
        x[:, free] = u[inside]
        squares = np.sum(problem.residuals(x) ** 2, axis=1)
        squares += np.sum((u[inside] / width)[:, is_constant] ** 2, axis=1)
        # The prior is one of knots, of which the law is a multiple.
        volume = len(at) * np.log(np.abs(factor(u[inside])[:, 0]))
        found = -0.5 * squares + log_prior(knot[inside], size) - volume
        result[inside] = np.where(np.isfinite(found), found, -np.inf)
        return result

    centre = fit.x[free][None, :].copy()
    constant, knot = factor(centre)[0, 0], values(centre, knots)[0]
    turn = np.eye(len(free))
    turn[at, at] = constant * np.array([each.slope(fit) for each in knots])
    for each in own:
        turn[at, each.position] = (1.0 + knot) * each.slope(fit)
    centre[0, at] = constant * (1.0 + knot)
    random = np.random.RandomState(31)
    begin = random.multivariate_normal(
        centre[0], turn @ fit.covariance @ turn.T, _WALKERS, check_valid="ignore"
    )
    sampler = emcee.EnsembleSampler(
        _WALKERS, len(free), log_posterior, vectorize=True,
        moves=[(emcee.moves.StretchMove(), 0.5), (emcee.moves.DEMove(), 0.5)],
    )  # fmt: skip
    state = emcee.State(begin, random_state=random.get_state())
    sampler.run_mcmc(state, _STEPS, skip_initial_state_check=True)
    chain = sampler.get_chain(discard=_BURNED, flat=True)
    return np.hstack([*([values(chain, own)] if own else []), knots_of(chain)])
