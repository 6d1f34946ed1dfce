"""What one worker does: it simulates a chunk of points, perhaps on another machine."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.scenario.scenario import Scenario

_MAX_SECONDS = 2.0
"""Time after which a chunk ends early, s: points can take far longer than those before them.
Chosen: twice what a chunk should take."""

_POINTS_PER_CALL = 64
"""Points between two looks at the clock; chosen: a call of the core costs little beside them."""


@dataclass(frozen=True, eq=False)
class Chunk:
    """Points that one worker simulates in one go."""

    scenario: Scenario  # what the points have in common
    keys: tuple[str, ...]  # dotted keys in which they differ
    values: NDArray[np.float64]  # a row for each point, a column for each key
    version: str  # of this package that asks for them
    # How often these points have met a worker that died. An executor that recognises work by its
    # arguments would otherwise answer with the failure again.
    attempt: int = 0


class ChunkResult(NamedTuple):
    """The results of a chunk's first m points."""

    columns: dict[str, NDArray[np.generic]]  # by name, shape (m,) each
    messages: dict[int, str]  # by place in the chunk, of points that did not end well
    seconds: float  # how long it took


def run_chunk(chunk: Chunk, poll: Callable[[float], object] | None = None) -> ChunkResult:
    """Simulate the points of a chunk, or as many of the first ones as two seconds allow.

    `poll` is called some twenty times a second; what it raises ends the work. A RuntimeError says
    that this process has another version of the package than the one that asks.
    """
    if chunk.version != _core.__version__:
        raise RuntimeError(
            f"a worker has stickslip {_core.__version__} and this process {chunk.version}: "
            "results need the same version everywhere"
        )
    start = time.perf_counter()
    base = chunk.scenario.to_core()
    slices = []
    messages: dict[int, str] = {}
    for first in range(0, len(chunk.values), _POINTS_PER_CALL):
        columns, said = _core.sweep(
            base, chunk.keys, chunk.values[first : first + _POINTS_PER_CALL], 1, poll
        )
        slices.append(columns)
        messages.update((first + place, text) for place, text in said.items())
        if time.perf_counter() - start > _MAX_SECONDS:
            break
    together = {name: np.concatenate([each[name] for each in slices]) for name in slices[0]}
    return ChunkResult(together, messages, time.perf_counter() - start)
