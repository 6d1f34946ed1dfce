"""Differential evolution of points with words and numbers, a generation in one call."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import differential_evolution

from stickslip._util.arrays import Array

_POPULATION, _FEWEST = 40, 5  # points of a generation, and the fewest that SciPy takes
_MUTATION, _CROSSOVER = (0.4, 0.9), 0.8
_CONVERGED = 1e-3  # relative spread of the costs
_GENERATIONS = 4  # fewest of a small budget


def search(
    bounds: Sequence[tuple[float, float]],
    words: int,
    starts: Array,
    near: tuple[float, float],
    costs: Callable[[Array], Array],
    spent: Callable[[], float],
    expected: int,
    seed: int,
) -> None:
    """Search for the point with the least cost by differential evolution.

    Storn and Price (J. Global Optim. 11, 341, 1997) by SciPy. A search needs no smooth figure:
    velocities jump where the motion changes its kind. A population that has converged begins again
    at random points. Settings are chosen on drawn robots.

    The first `words` coordinates are whole numbers. The first population has `starts`, rows of
    points, and a part `near[0]` about them, `near[1]` of each range away. `costs` gets points, a
    row each, and keeps what it wants to know of them. The search ends with the generation after
    which `spent` is 1 or more; if only few points are expected, generations are small.
    """
    if words == len(bounds):
        costs(starts)
        return
    low, high = np.array(bounds).T
    random = np.random.default_rng(seed)
    size = min(_POPULATION, max(expected // _GENERATIONS, _FEWEST))

    def drawn() -> Array:
        parts = random.uniform(size=(size, len(low)))
        points = np.asarray(low + (high - low) * parts)
        points[:, :words] = np.floor((high[:words] + 1.0) * parts[:, :words])  # each as often
        return points

    population = drawn()
    chosen = starts[random.integers(len(starts), size=int(near[0] * size))]
    chosen = chosen + near[1] * (high - low) * random.standard_normal(chosen.shape)
    population[: len(chosen)] = np.clip(chosen, low, high)
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
        population = drawn()
