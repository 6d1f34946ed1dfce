"""Truth behind one data set, drawn at random. The true constants come from the priors."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from blind.catalogue import CAUSES, INSTRUMENTS, LAWS, Value, entry, parameters
from blind.kinds import KINDS
from blind.model_errors import MODEL_ERRORS
from blind.settings import LIMITS, priors

_USUAL = 2.0  # largest factor between the usual size and that which is drawn first


@dataclass(frozen=True)
class Hidden:
    """One hidden thing of the catalogue: how much of it, and its parameters at an amount of 1."""

    amount: float
    base: dict[str, Value]


@dataclass(frozen=True)
class Truth:
    """Truth behind one data set.

    kind. answer: Names in the library's words; empty where nothing of the library is hidden.
    constants: By dotted key, SI units. hidden: By name of the catalogue; ``ripple`` is a wave
    of the velocity that no cause has, and ``smooth_error`` and ``correlated_error`` are errors
    of the model, see model_errors.py. correlation: Of neighbouring errors.
    """

    kind: str
    answer: tuple[str, ...]
    constants: dict[str, float]
    hidden: dict[str, Hidden] = field(default_factory=dict)
    correlation: float = 0.0

    def without(self) -> Truth:
        """The same robot with nothing hidden."""
        return replace(self, hidden={})

    def only(self, name: str) -> Truth:
        """The same robot with one of the hidden things."""
        return replace(self, hidden={name: self.hidden[name]})

    def scaled(self, factor: float) -> Truth:
        """The same with every hidden thing larger by a factor, as far as it can be."""
        hidden = {
            name: replace(each, amount=_clipped(name, each.amount * factor))
            for name, each in self.hidden.items()
        }
        return replace(self, hidden=hidden)

    def parameters(self, name: str) -> dict[str, Value]:
        """Parameters of what is hidden by that name, none if it is not."""
        if name not in self.hidden:
            return {}
        return parameters(name, self.hidden[name].base, self.hidden[name].amount)

    def amount(self, name: str, parameter: str) -> float:
        """One parameter, 0 where nothing is hidden."""
        return float(self.parameters(name).get(parameter, 0.0))

    @property
    def effects(self) -> dict[str, dict[str, Value]]:
        """Effects of the reference simulator."""
        causes = {name: self.parameters(name) for name in self.hidden if name in CAUSES}
        laws = [self.parameters(name) for name in self.hidden if name in LAWS]
        return {**causes, **({"law": laws[0]} if laws else {})}

    def as_record(self) -> dict[str, Any]:
        """Entry of a record: all of the truth, and what follows from it."""
        # Beside a cause a law is an error of the model, and none that is asked for.
        hook = None if self.answer else next((name for name in self.hidden if name in LAWS), None)
        return {**asdict(self), "effects": self.effects, "hook": hook}

    @staticmethod
    def of(record: dict[str, Any]) -> Truth:
        """The truth of a record."""
        return Truth(
            record["kind"],
            tuple(record["answer"]),
            dict(record["constants"]),
            {name: Hidden(**each) for name, each in record["hidden"].items()},
            record["correlation"],
        )


def _clipped(name: str, amount: float) -> float:
    if name in MODEL_ERRORS:
        return amount
    if name == "ripple":
        return float(np.clip(amount, 0.0, 0.9))
    return float(np.clip(amount, entry(name).least, entry(name).most))


def draw(kind: str, seed: int, random: np.random.Generator, again: int = 0) -> Truth:
    """The truth of a data set, its hidden things at a usual size; the seed goes round them.

    `again` is how often it was drawn before: what looks too much or too little like a listed cause
    gives way to another thing.
    """
    plan = KINDS[kind]
    constants = {}
    for name, prior in priors(plan.tables).items():
        coordinate = float(random.standard_normal())
        constants[name] = float(np.clip(prior.value(coordinate), *LIMITS.get(name, (0.0, np.inf))))
    passed = 0 if plan.alike is None else 5 * again
    names = plan.hidden[(seed + passed) % len(plan.hidden)]
    along = plan.noise.correlated
    correlation = 0.0 if along is None else float(random.uniform(*along))
    if kind.startswith("constant"):
        (name,) = names
        # Kinetic friction has room to one side only.
        sign = -1.0 if name in LIMITS else float(random.choice([-1.0, 1.0]))
        if name == "contact.adhesion":
            sign = float(random.choice([-1.0, 1.0]))
        middle = priors(plan.tables)[name]
        constants[name] = max(float(middle.value(sign * float(kind.split()[1]))), 0.0)
        return Truth(kind, names, constants, {}, correlation)
    listed = names[:1] if plan.error else names
    answer = tuple(name for name in listed if name in CAUSES or name in INSTRUMENTS)
    hidden = {name: _drawn(name, random) for name in names}
    return Truth(kind, answer, constants, hidden, correlation)


def _drawn(name: str, random: np.random.Generator) -> Hidden:
    if name == "ripple":
        # A resonance of the frame that moves the stage, for instance.
        wave = {"period": random.uniform(0.35, 0.6), "phase": random.uniform(0.0, 2.0 * np.pi)}
        return Hidden(0.1, {key: float(value) for key, value in wave.items()})
    if name in MODEL_ERRORS:
        return Hidden(1.0, {"number": float(random.integers(2**31))})
    own = entry(name)
    base: dict[str, Value] = {**own.fixed}
    base |= own.sizes[int(random.integers(len(own.sizes)))]
    for key, (low, high) in own.drawn.items():
        base[key] = float(np.exp(random.uniform(np.log(low), np.log(high))))
    sign = float(random.choice([-1.0, 1.0])) if own.least < 0.0 else 1.0
    size = float(np.exp(random.uniform(-np.log(_USUAL), np.log(_USUAL))))
    return Hidden(_clipped(name, sign * size), base)
