"""How finely each coordinate has to be looked through: predictions may turn with it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fitting.problem import LOST, Problem
from stickslip.diagnosis.fitting.responses import USUAL, within
from stickslip.diagnosis.terms.cause import Cause

_ALIKE = 0.8  # cosine of effects that one descent leads between; chosen: a quarter of a wave has 0
_STEPS: Array = 2.0 ** -np.arange(8.0)  # moves that are tried; the last is the finest told
_PLACES = 4  # from which a coordinate is moved; chosen
_SEEN = 0.3  # norm of an effect, in errors, below which it tells nothing; chosen


def with_measured_fineness(problem: Problem) -> Problem:
    """The problem whose shapes and delays are at least as fine as effects turn with them about the
    stated constants.

    A period turns an effect, as a delay does; the size of a force makes it grow.
    """
    found: dict[int, float] = {}
    asked = [(cause, k) for cause in problem.causes for k in _turning(problem, cause)]
    for steps in (_STEPS[:1], _STEPS):  # most effects do not turn with the widest move
        asked = [(cause, k) for cause, k in asked if found.get(k, 0.0) < steps[0]]
        if asked:
            found |= _measured(problem, asked, steps)
    return replace(problem, finer={problem.names[k]: size for k, size in found.items()})


def _measured(
    problem: Problem, asked: Sequence[tuple[Cause, int]], steps: Array
) -> dict[int, float]:
    """The largest of some moves of each coordinate that turns no effect, or half the least."""
    here, found = problem.residuals(np.zeros((1, problem.size))), {}
    for cause, k in asked:
        way = _ways(problem, cause, k, steps)
        effects = problem.residuals(way)
        lost = np.any(effects == LOST * problem.sd, axis=1)
        effects = np.divide(np.subtract(here, effects, out=effects), problem.sd, out=effects)
        effects[lost] = 0.0
        if problem.parameters[k].is_amplitude:
            effects *= np.sign(way[:, [k]])  # the other sign reverses an effect: no turn
        found[k] = _told(effects.reshape(_PLACES, len(steps) + 1, -1), steps)
    return found


def _turning(problem: Problem, cause: Cause) -> Iterator[int]:
    """Coordinates of a cause that may turn its effect: shapes, and what an instrument is late by.

    Other amplitudes turn it where they are so large that the motion is of another kind.
    """
    columns = [] if cause.has_knots else problem.columns([cause]).tolist()
    amplitudes = [k for k in columns if problem.parameters[k].is_amplitude]
    alone = cause.is_instrument and len(amplitudes) == 1
    yield from (k for k in columns if k not in amplitudes or alone)


def _ways(problem: Problem, cause: Cause, k: int, steps: Array) -> Array:
    """Places of a coordinate and moves from each, shape (places * (1 + moves), size)."""
    low, high = problem.scanned[:, k]
    x = np.zeros((_PLACES, len(steps) + 1, problem.size))
    for column in problem.columns([cause]).tolist():
        if problem.parameters[column].is_amplitude:
            x[..., column] = within(USUAL, *problem.limits[:, column])
            break  # of several amplitudes one shows how their effect turns
    places = low + (high - low) * (np.arange(_PLACES) + 0.5) / _PLACES
    moves = np.where(places + 1.0 > high, -1.0, 1.0)[:, None] * np.concatenate([[0.0], steps])
    x[..., k] = places[:, None] + moves
    return x.reshape(-1, problem.size)


def _told(effects: Array, steps: Array) -> float:
    """The largest move up to which no place's effect, shape (places, 1 + moves, n), turns."""
    finest = float(steps[0])
    for here, *moved in effects:
        size = float(np.linalg.norm(here))
        if size < _SEEN:
            continue
        norms = np.maximum(np.linalg.norm(moved, axis=1), 1e-300)
        alike = np.asarray(moved) @ here / (size * norms) >= _ALIKE
        # Moves become smaller: the first from which on all are alike.
        ok = np.logical_and.accumulate(alike[::-1])[::-1]
        finest = min(finest, float(steps[np.argmax(ok)]) if ok.any() else 0.5 * float(steps[-1]))
    return finest
