"""The one search of this project: CMA-ES by ask and tell, which sees nothing but ranks.

Hansen's strategy (arXiv:1604.00772) with the library ``cma``. What is compared are sort keys, so a
search needs no differentiable figure: velocities jump where the motion changes its kind.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import numpy as np

from stickslip._util.extras import naming_the_extra
from stickslip._util.numbers import Array

T = TypeVar("T")

Key = tuple[float, ...]
"""What candidates are sorted by; the least is the best."""

Evaluate = Callable[[Sequence[tuple[int, Array]]], Sequence[tuple[Key, T]]]
"""Of candidates, each an arm and a point of the unit cube: their keys, and what else is known."""

STEP = 0.25
"""Step of the first generation, in parts of a range. Chosen: most of the range is seen."""

LEADERS = 24
"""Best candidates that a search keeps. Chosen: enough to find one among them that is no luck."""

_CONVERGED = 1e-3  # step in parts of a range; chosen: finer than any apparatus is set
_SILENT = {
    "bounds": [0.0, 1.0],
    "seed": math.nan,  # numpy's own state is left alone; draws come from `randn`
    "verbose": -9,
    "verb_log": 0,
    "verb_disp": 0,
}


@dataclass(frozen=True)
class Candidate(Generic[T]):
    """A point that was evaluated.

    Attributes
    ----------
    key : tuple of float
        What it is sorted by.
    arm : int
        Index of the start whose dimensions it has.
    point : numpy.ndarray
        In the unit cube.
    known : T
        What the search was told of it beside its key.
    """

    key: Key
    arm: int
    point: Array
    known: T


@dataclass
class Found(Generic[T]):
    """What a search has found so far.

    Attributes
    ----------
    leaders : list of Candidate
        The best candidates, the best first.
    centres : list of Candidate
        Where the strategies of the arms that were not given up ended: less by luck than the best.
    count : int
        Candidates that were evaluated.
    interrupted : bool
        Whether Ctrl-C ended the search.
    """

    leaders: list[Candidate[T]] = field(default_factory=list)
    centres: list[Candidate[T]] = field(default_factory=list)
    count: int = 0
    interrupted: bool = False


def search(
    starts: Sequence[Array], evaluate: Evaluate[T], budget: int, seed: int, step: float = STEP
) -> Found[T]:
    """Look for the point with the least key, from several starts.

    All arms advance together, one generation of each in one call of `evaluate`; each time that its
    share of the budget is spent, the worse half of them is given up. An arm whose step has become
    small begins again at a random point, with twice as many candidates a generation.

    Parameters
    ----------
    starts : sequence of numpy.ndarray
        A point of the unit cube for each arm, of any number of dimensions.
    evaluate : callable
        Judges candidates. A KeyboardInterrupt in it ends the search, which keeps what
        was found, or passes through if nothing was.
    budget : int
        Candidates in all; the last generation may pass it.
    seed : int
        Of all draws; the same gives the same result.
    step : float
        Of the first generations, in parts of a range.

    Returns
    -------
    Found

    Raises
    ------
    MissingExtra
        If the library ``cma`` is missing.
    """
    found: Found[T] = Found()
    alive = [_Arm(index, start, seed, step) for index, start in enumerate(starts)]
    try:
        # Before the library, whose import takes seconds: an interrupt in it has a best.
        _compare(alive, [[arm.start] for arm in alive], evaluate, found)
        for left in range(math.ceil(math.log2(len(alive))) + 1, 0, -1):
            target = found.count + (budget - found.count) / left
            searching = [arm for arm in alive if len(arm.start)]
            while searching and found.count < target:
                asked = [arm.ask() for arm in searching]
                parts = _compare(searching, asked, evaluate, found)
                for arm, candidates in zip(searching, parts, strict=True):
                    arm.tell(candidates)
            if left > 1:
                alive = sorted(alive, key=lambda arm: arm.best)[: math.ceil(len(alive) / 2)]
        centres = [arm.centres() for arm in alive]
        found.centres = [
            each for part in _compare(alive, centres, evaluate, found) for each in part
        ]
    except KeyboardInterrupt:
        if not found.leaders:
            raise
        found.interrupted = True
    return found


class _Arm:
    """One start with its strategy."""

    def __init__(self, index: int, start: Array, seed: int, step: float) -> None:
        self.index, self.start = index, start
        self.best: Key = (math.inf,)
        self._step = step
        self._random = np.random.default_rng([seed, index])
        self._strategy: Any = None
        self._left: list[Array] = []

    def ask(self) -> list[Array]:
        if self._strategy is None:
            self._begin(self._padded(self.start), None)
        elif self._strategy.stds.max() < _CONVERGED:
            self._left.append(self._centre())
            point = self._random.uniform(size=self._strategy.N)
            self._begin(point, 2 * self._strategy.popsize)
        self._asked = self._strategy.ask()
        return [np.array(each[: len(self.start)]) for each in self._asked]

    def tell(self, candidates: Sequence[Candidate[Any]]) -> None:
        ranks = {key: rank for rank, key in enumerate(sorted({each.key for each in candidates}))}
        self._strategy.tell(self._asked, [float(ranks[each.key]) for each in candidates])

    def centres(self) -> list[Array]:
        """Of all its strategies, in the order in which they began."""
        return [*self._left, self._centre()] if self._strategy else []

    def _centre(self) -> Array:
        return np.array(self._strategy.result.xfavorite[: len(self.start)])

    def _begin(self, point: Array, size: int | None) -> None:
        options = {**_SILENT, "randn": lambda *shape: self._random.standard_normal(shape)}
        if size is not None:
            options["popsize"] = size
        self._strategy = _library().CMAEvolutionStrategy(point, self._step, options)

    @staticmethod
    def _padded(point: Array) -> Array:
        """The library has no search in one dimension: a second one is not looked at."""
        return point if len(point) > 1 else np.append(point, 0.5)


def _compare(
    arms: Sequence[_Arm], asked: Sequence[Sequence[Array]], evaluate: Evaluate[T], found: Found[T]
) -> list[list[Candidate[T]]]:
    """Evaluate what all arms ask for at once, and keep the best."""
    pairs = [(arm.index, point) for arm, of in zip(arms, asked, strict=True) for point in of]
    results = evaluate(pairs) if pairs else []
    new = [Candidate(key, *pair, known) for pair, (key, known) in zip(pairs, results, strict=True)]
    found.count += len(new)
    found.leaders = sorted([*found.leaders, *new], key=lambda each: each.key)[:LEADERS]
    parts = []
    for arm in arms:
        parts.append([each for each in new if each.arm == arm.index])
        arm.best = min([arm.best, *(each.key for each in parts[-1])])
    return parts


def _library() -> Any:
    # In a thread of its own Ctrl-C ends no import halfway: a report needs packages that it loads.
    with naming_the_extra("stickslip.optimise"), ThreadPoolExecutor(1) as thread:
        return thread.submit(importlib.import_module, "cma").result()
