"""Differential evolution of points with words and numbers, a generation in one call."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import differential_evolution

from stickslip._util.arrays import Array

_POPULATION, _FEWEST = 40, 5  # points of a generation, and the fewest that SciPy takes
_NEAR, _SPREAD = 0.5, 0.15  # part of the first population near its starts, in parts of a range
_MUTATION, _CROSSOVER = (0.4, 0.9), 0.8
_CONVERGED = 1e-3  # relative spread of the costs
_GENERATIONS = 4  # fewest of a small budget


def search(
    bounds: Sequence[tuple[float, float]],
    words: int,
    starts: Array,
    costs: Callable[[Array], Array],
    spent: Callable[[], float],
    points: int,
    seed: int,
) -> None:
    """Search for the point with the least cost by differential evolution.

    Storn and Price (J. Global Optim. 11, 341, 1997) by SciPy. A search needs no smooth figure:
    velocities jump where the motion changes its kind. A population that has converged begins again
    at random points. Settings are chosen on drawn robots.

    Parameters
    ----------
    bounds : sequence of (float, float)
        Lowest and highest of each coordinate.
    words : int
        How many of the coordinates, the first ones, are whole numbers.
    starts : numpy.ndarray, shape (m, coordinates)
        Points of the first population.
    costs : callable
        From points, a row each, to their costs; it keeps what it wants to know of them.
    spent : callable
        Part of the budget that is spent; the search ends with the generation that makes it 1.
    points : int
        About as many are tried: a small number makes small generations.
    seed : int
    """
    if words == len(bounds):
        costs(starts)
        return
    low, high = np.array(bounds).T
    random = np.random.default_rng(seed)
    size = min(_POPULATION, max(points // _GENERATIONS, _FEWEST))
    population = low + (high - low) * random.uniform(size=(size, len(low)))
    near = starts[random.integers(len(starts), size=int(_NEAR * size))]
    near = near + _SPREAD * (high - low) * random.standard_normal(near.shape)
    population[: len(near)] = np.clip(near, low, high)
    population[-min(len(starts), size) :] = starts[:size]
    while spent() < 1.0:
        try:
            differential_evolution(
                lambda columns: costs(columns.T),
                bounds,
                init=population,
                maxiter=sys.maxsize,
                tol=_CONVERGED,
                mutation=_MUTATION,
                recombination=_CROSSOVER,
                rng=random,
                callback=lambda x, convergence: spent() >= 1.0,
                polish=False,
                updating="deferred",
                vectorized=True,
                integrality=np.arange(len(low)) < words,
            )
        except RuntimeError as error:  # SciPy's, about an error of `costs`
            raise (error.__cause__ or error) from None
        population = low + (high - low) * random.uniform(size=population.shape)
