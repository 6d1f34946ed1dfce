"""Data sets of the study: a truth, and the readings of it, as strong as the kind asks for."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from blind.catalogue import CAUSES, HOOK_OF, LAWS, entry
from blind.kinds import ERROR_SHARE, KINDS, Kind
from blind.model_errors import MODEL_ERRORS
from blind.readings import Readings, readings
from blind.settings import Drive, conditions, priors
from blind.strength import Absorber, Draft
from blind.truth import Truth, draw

# Draws after which the strongest truth is taken that was found: some causes cannot be as strong as
# the kind asks for with some constants.
_DRAWS = 6
_TRIES = 5  # changes of the amount for one draw
_HIDING = (25.0, 40.0)  # S of a cause that hides another one


@dataclass(frozen=True)
class Made:
    """A data set without its noise.

    strength: The least of the hidden causes' S. more: `error`: size of a model error over that
    of the cause beside it. `beside`: the least S of one of a pair beside the other. `cosine` and
    `like`: of a thing that no cause lists, the largest cosine to a listed cause and its name.
    """

    truth: Truth
    drives: list[Drive]
    level: Readings
    strength: float
    more: dict[str, float | str]
    random: np.random.Generator


_Found = tuple[Truth, float, dict[str, float | str]]


def make(kind: str, seed: int) -> Made:
    """A truth of a kind, scaled to the wanted strength, and its noiseless readings."""
    # By its name, so that another kind in the list changes no data set.
    random = np.random.default_rng([seed, zlib.crc32(kind.encode())])
    plan = KINDS[kind]
    drives = conditions(kind, plan.tables) if "velocity" in plan.tables else []
    found: list[tuple[float, _Found]] = []
    for again in range(_DRAWS):
        truth = draw(kind, seed, random, again)
        one: _Found = (truth, 0.0, {})
        if plan.wanted is not None:
            one = _scaled(truth, Draft(truth.without(), drives, plan.tables), random)
        found.append((_missed(plan, one), one))
        if found[-1][0] == 0.0:
            break
    truth, strength, more = min(found, key=lambda each: each[0])[1]
    return Made(truth, drives, readings(truth, drives, plan.tables), strength, more, random)


def _missed(plan: Kind, found: _Found) -> float:
    """How far a truth is from what its kind asks for; 0 where it has all of it."""
    if plan.wanted is None:
        return 0.0
    _, strength, more = found
    missed = _miss(strength, plan.wanted)
    if plan.error:
        missed += _miss(float(more["error"]), ERROR_SHARE)
    if plan.alike is not None:
        low, high = plan.alike
        missed += max(low - float(more["cosine"]), float(more["cosine"]) - high, 0.0)
    return missed


def _scaled(truth: Truth, draft: Draft, random: np.random.Generator) -> _Found:
    """The truth with each hidden thing scaled by itself, and the least of their strengths.

    Where one hides another, the second is what is left once the first is fitted too.
    """
    plan = KINDS[truth.kind]
    assert plan.wanted is not None
    plain = truth.without()
    if plan.family == "hiding":
        return _hiding(truth, draft, plan.wanted)
    if plan.error:
        return _disturbed(truth, draft, plan.wanted, random)
    found, more = {}, dict[str, float | str]()
    if plan.alike is not None and plan.family == "law":
        more = _most_alike(_elsewhere(truth))
        if float(more["cosine"]) > plan.alike[1]:
            return truth, 0.0, more
    for name in truth.hidden:
        rivals = entry(name).rivals if plan.family == "law" and not more else ()
        absorbers = [Absorber(draft, plain, freed) for freed in (None, *rivals)]
        found[name] = _alone(truth.only(name), absorbers, plan.wanted, draft)
    hidden = {name: each.hidden[name] for name, (each, _) in found.items()}
    scaled = replace(truth, hidden=hidden)
    if plan.family == "pair":
        more = {"beside": beside_each_other(scaled, draft)}
    if plan.alike is not None and not more:
        more = _most_alike(Absorber(draft, plain).cosines(draft(scaled), list(CAUSES)))
    return scaled, min(strength for _, strength in found.values()), more


def beside_each_other(truth: Truth, draft: Draft) -> float:
    """The least S of a hidden thing beside the other ones, whose sizes are free."""
    plain, seen = truth.without(), draft(truth)
    others = [{name: truth.hidden[name] for name in truth.hidden if name != one}
              for one in truth.hidden]  # fmt: skip
    return min(Absorber(draft, replace(plain, hidden=each), *each).searched(seen)
               for each in others)  # fmt: skip


def _most_alike(cosines: Mapping[str, float]) -> dict[str, float | str]:
    like = max(cosines, key=lambda name: cosines[name])
    return {"cosine": cosines[like], "like": like}


def _elsewhere(truth: Truth) -> dict[str, float]:
    """Cosines of a law at its usual size to constants, and to causes and laws that act elsewhere.

    With the middles of the constants: what the others change is then simulated once for all sets.
    """
    (name,) = truth.hidden
    others = [each for each in (*CAUSES, *LAWS) if HOOK_OF.get(each, each) != name]
    absorber, draft, usual = _usual(truth.kind)
    return absorber.cosines(draft(replace(usual, hidden=truth.hidden)), others)


@cache
def _usual(kind: str) -> tuple[Absorber, Draft, Truth]:
    """A robot with the middles of its constants and nothing hidden."""
    tables = KINDS[kind].tables
    usual = Truth(kind, (), {name: prior.value(0.0) for name, prior in priors(tables).items()})
    draft = Draft(usual, conditions(kind, tables), tables)
    return Absorber(draft, usual), draft, usual


def _hiding(truth: Truth, draft: Draft, wanted: tuple[float, float]) -> _Found:
    """Two causes, the first of them large; S of the second beside the first."""
    first, second = truth.hidden
    large, _ = _alone(truth.only(first), [Absorber(draft, truth.without())], _HIDING, draft)

    def both(small: Truth) -> Truth:
        return replace(truth, hidden={**large.hidden, **small.hidden})

    beside = Absorber(draft, large, first)
    small, strength = _alone(truth.only(second), [beside], wanted, lambda one: draft(both(one)))
    return both(small), strength, {}


def _disturbed(
    truth: Truth, draft: Draft, wanted: tuple[float, float], random: np.random.Generator
) -> _Found:
    """A cause, and a model error of a share of its effect."""
    cause, error = truth.hidden
    absorber = Absorber(draft, truth.without())
    main, strength = _alone(truth.only(cause), [absorber], wanted, draft)
    if error not in MODEL_ERRORS:
        low, high = (share * strength for share in ERROR_SHARE)
        small, size = _alone(truth.only(error), [absorber], (low, high), draft)
        hidden = {**main.hidden, **small.hidden}
        return replace(truth, hidden=hidden), strength, {"error": size / max(strength, 1e-3)}
    share = float(random.uniform(*ERROR_SHARE))
    both = replace(truth, hidden={**main.hidden, error: truth.hidden[error]})
    # Velocities change by it in proportion.
    change = draft(both) - draft(main)
    factor = share * strength / absorber.strength(draft(truth.without()) + change)
    scaled = replace(truth.hidden[error], amount=factor * truth.hidden[error].amount)
    return replace(both, hidden={**main.hidden, error: scaled}), strength, {"error": share}


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
