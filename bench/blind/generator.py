"""Data sets of the study: a truth, and the readings of it, as strong as the kind asks for."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from blind.catalogue import LAWS, entry
from blind.kinds import KINDS
from blind.readings import Readings, readings
from blind.settings import Drive, conditions
from blind.strength import Absorber, Draft
from blind.truth import Truth, draw

# Draws after which the strongest truth is taken that was found: some causes cannot be as strong as
# the kind asks for with some constants.
_DRAWS = 6
_TRIES = 5  # changes of the amount for one draw
_HIDING = (25.0, 40.0)  # S of a cause that hides another one


@dataclass(frozen=True)
class Made:
    """A data set without its noise: strength is the least of the hidden things' S."""

    truth: Truth
    drives: list[Drive]
    level: Readings
    strength: float
    random: np.random.Generator


def make(kind: str, seed: int) -> Made:
    """A truth of a kind, scaled to the wanted strength, and its noiseless readings."""
    # By its name, so that another kind in the list changes no data set.
    random = np.random.default_rng([seed, zlib.crc32(kind.encode())])
    plan = KINDS[kind]
    drives = conditions(kind, plan.tables) if "velocity" in plan.tables else []
    best: tuple[Truth, float] | None = None
    for _ in range(_DRAWS):
        truth = draw(kind, seed, random)
        if plan.wanted is None:
            best = truth, 0.0
            break
        found = _scaled(truth, Draft(truth.without(), drives, plan.tables))
        if best is None or _miss(found[1], plan.wanted) < _miss(best[1], plan.wanted):
            best = found
        if _miss(best[1], plan.wanted) == 0.0:
            break
    assert best is not None
    return Made(best[0], drives, readings(best[0], drives, plan.tables), best[1], random)


def _scaled(truth: Truth, draft: Draft) -> tuple[Truth, float]:
    """The truth with each hidden thing scaled by itself, and the least of their strengths.

    Where one hides another, the second is what is left once the first is fitted too.
    """
    plan = KINDS[truth.kind]
    assert plan.wanted is not None
    plain = truth.without()
    if plan.family != "hiding":
        found = {}
        for name in truth.hidden:
            rivals = entry(name).rivals if name in LAWS else ()
            absorbers = [Absorber(draft, plain, freed) for freed in (None, *rivals)]
            found[name] = _alone(truth.only(name), absorbers, plan.wanted, draft)
        hidden = {name: each.hidden[name] for name, (each, _) in found.items()}
        return replace(truth, hidden=hidden), min(strength for _, strength in found.values())
    first, second = truth.hidden
    large, _ = _alone(truth.only(first), [Absorber(draft, plain)], _HIDING, draft)

    def both(small: Truth) -> Truth:
        return replace(truth, hidden={**large.hidden, **small.hidden})

    beside = Absorber(draft, large, first)
    small, strength = _alone(
        truth.only(second), [beside], plan.wanted, lambda other: draft(both(other))
    )
    return both(small), strength


def _miss(strength: float, wanted: tuple[float, float]) -> float:
    """How far a strength is from a range, in its logarithm."""
    low, high = (np.log(max(strength, 1e-3) / end) for end in wanted)
    return float(max(-low, high, 0.0))


def _alone(
    truth: Truth,
    absorbers: Sequence[Absorber],
    wanted: tuple[float, float],
    seen: Callable[[Truth], NDArray[np.float64]],
) -> tuple[Truth, float]:
    """One hidden thing scaled until its strength is in the range, or as near as it comes."""
    low, high = wanted
    aim = 0.5 * (low + high)
    best, nearest, curved = truth, 0.0, 1.0
    for _ in range(_TRIES):
        level = seen(truth)
        linear = min(each.strength(level) for each in absorbers)
        strength = curved * linear
        if low <= strength <= high:
            # Constants that are far from the truth may absorb more.
            strength = min(each.searched(level) for each in absorbers)
            curved = strength / max(linear, 1e-3)
        if _miss(strength, wanted) < _miss(nearest, wanted):
            best, nearest = truth, strength
        if low <= strength <= high:
            break
        larger = truth.scaled(float(np.clip(aim / max(strength, 0.1), 0.2, 5.0)))
        if larger == truth:
            break
        truth = larger
    return best, nearest
