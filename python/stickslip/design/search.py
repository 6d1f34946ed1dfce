"""CMA-ES with restarts, which sees nothing but ranks.

Hansen's strategy (arXiv:1604.00772) by the package ``cma``. A search needs no smooth figure:
velocities jump where the motion changes its kind.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip.extras import naming_the_extra

Evaluate = Callable[[Array], Array]
"""From candidates, rows of an arm's index and a point of the unit cube, to keys, rows of numbers.
Keys are compared column by column; the least is the best."""

_STEP = 0.25  # of the first generation, in parts of a range; chosen: most of the range is seen
_CONVERGED = 1e-3  # step in parts of a range; chosen: finer than any apparatus is set
_SILENT = {
    "bounds": [0.0, 1.0],
    "seed": math.nan,  # leaves numpy's global state alone; draws come from `randn`
    "verbose": -9,
    "verb_log": 0,
    "verb_disp": 0,
}


def search(starts: Array, evaluate: Evaluate, budget: int, seed: int) -> int:
    """Search for the point with the least key, from several starts.

    All arms advance together, one generation of each in one call of `evaluate`. Each time that its
    share of the budget is spent, the worse half of the arms is given up. An arm whose step has
    become small begins again at a random point, with twice as many candidates a generation.

    Parameters
    ----------
    starts : numpy.ndarray, shape (arms, dimensions)
        A point of the unit cube for each arm.
    evaluate : callable
        See `Evaluate`; it keeps what it wants to know of the candidates.
    budget : int
        Candidates in all; the last generation may pass it.
    seed : int

    Returns
    -------
    int
        How many of the last evaluated candidates are the centres at which the strategies ended.

    Raises
    ------
    MissingExtra
        If the package ``cma`` is missing.
    """
    with naming_the_extra("stickslip.optimise"):
        library = importlib.import_module("cma")
    arms = [_Arm(library, index, start, seed) for index, start in enumerate(starts)]
    spent = _compare(arms, [[arm.start] for arm in arms], evaluate)
    for left in range(math.ceil(math.log2(len(arms))) + 1, 0, -1):
        target = spent + (budget - spent) / left
        while starts.shape[1] and spent < target:
            spent += _compare(arms, [arm.ask() for arm in arms], evaluate)
        if left > 1:
            arms = sorted(arms, key=lambda arm: arm.best)[: math.ceil(len(arms) / 2)]
    return _compare(arms, [arm.centres() for arm in arms], evaluate)


class _Arm:
    """One start with its strategy."""

    def __init__(self, library: Any, index: int, start: Array, seed: int) -> None:
        self.index, self.start = index, start
        self.best: tuple[float, ...] = (math.inf,)
        self._library, self._random = library, np.random.default_rng([seed, index])
        self._strategy: Any = None
        self._asked: list[Array] | None = None
        self._left: list[Array] = []

    def ask(self) -> list[Array]:
        if self._strategy is None:
            # The package has no search in one dimension: the second one has no influence.
            self._begin(self.start if len(self.start) > 1 else np.append(self.start, 0.5))
        elif self._strategy.stds.max() < _CONVERGED:
            self._left = self.centres()
            self._begin(self._random.uniform(size=self._strategy.N), 2 * self._strategy.popsize)
        self._asked = self._strategy.ask()
        return [candidate[: len(self.start)] for candidate in self._asked]

    def tell(self, keys: Sequence[tuple[float, ...]]) -> None:
        """Take the keys of the candidates."""
        self.best = min([self.best, *keys])
        if self._asked is not None:
            ranks = {key: float(rank) for rank, key in enumerate(sorted(set(keys)))}
            self._strategy.tell(self._asked, [ranks[key] for key in keys])
            self._asked = None

    def centres(self) -> list[Array]:
        """Those of all its strategies, in the order in which they began."""
        if self._strategy is None:
            return []
        return [*self._left, np.array(self._strategy.result.xfavorite[: len(self.start)])]

    def _begin(self, point: Array, size: int | None = None) -> None:
        options = {**_SILENT, "randn": lambda *shape: self._random.standard_normal(shape)}
        options |= {} if size is None else {"popsize": size}
        self._strategy = self._library.CMAEvolutionStrategy(point, _STEP, options)


def _compare(arms: Sequence[_Arm], asked: Sequence[Sequence[Array]], evaluate: Evaluate) -> int:
    """Evaluate the candidates of all arms in one call, and tell the arms; their number."""
    rows = [
        np.append(arm.index, point) for arm, of in zip(arms, asked, strict=True) for point in of
    ]
    keys = iter([tuple(row) for row in evaluate(np.array(rows)).tolist()] if rows else [])
    for arm, of in zip(arms, asked, strict=True):
        arm.tell([next(keys) for _ in of])
    return len(rows)
