"""Data sets of the study: a folder each with what a laboratory would have, answers elsewhere."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blind import apparatus
from blind.strength import Absorber
from blind.truth import KINDS, Drive, Truth, conditions, draw

Array = NDArray[np.float64]

KEYS = ("mode", "frequency", "peak", "base", "hold", "direction")
MORE_KEYS = (*KEYS, "edge")

UNCERTAIN = """
[uncertain]
"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }
"contact.adhesion" = { mean = 0.22e-6, sd = 0.03e-6 }
"drag.linear" = { low = 1e-6, high = 1e-4 }
"drag.rotational" = { median = 9e-17, factor = 2 }
"""

NOMINAL = f"""stickslip = 1

[drive]
pulses = {apparatus.PULSES}
"""

# Signal to noise after absorption, low and high end of a draw.
_WANTED = {
    "single": (6.0, 20.0),
    "weak": (3.8, 4.2),
    "near twins": (6.0, 15.0),
    "exact twins": (6.0, 15.0),
    "pair": (8.0, 16.0),
    "unknown": (15.0, 25.0),
    "shuffled": (6.0, 20.0),
}


def make(kind: str, seed: int) -> tuple[Truth, list[Drive], Array, float, np.random.Generator]:
    """Truth, drives, velocities without noise, and the signal to noise of what is hidden."""
    random = np.random.default_rng([seed, KINDS.index(kind)])
    drives = conditions(kind)
    while True:
        truth = draw(kind, random)
        plain = apparatus.velocities(truth.without(), drives)
        if kind not in _WANTED:
            return truth, drives, plain, 0.0, random
        absorber = Absorber(truth, drives, plain)
        found = _scaled_to(truth, drives, absorber, _WANTED[kind])
        if found is not None:
            return found[0], drives, found[1], found[2], random


def _scaled_to(
    truth: Truth, drives: list[Drive], absorber: Absorber, wanted: tuple[float, float]
) -> tuple[Truth, Array, float] | None:
    """The truth with each hidden effect scaled until its strength by itself is in the range."""
    parts = [replace(truth, effects={name: each}) for name, each in truth.effects.items()]
    scaled = dict(truth.effects)
    strengths = []
    for part in parts or [truth]:
        found = _alone(part, drives, absorber, wanted)
        if found is None:
            return None
        strengths.append(found[2])
        scaled |= found[0].effects
        whole = found[0]
    if len(parts) < 2:
        return whole, found[1], strengths[0]
    whole = replace(truth, effects=scaled)
    return whole, apparatus.velocities(whole, drives), min(strengths)


def _alone(
    truth: Truth, drives: list[Drive], absorber: Absorber, wanted: tuple[float, float]
) -> tuple[Truth, Array, float] | None:
    low, high = wanted
    aim = 0.5 * (low + high)
    for _ in range(5):
        level = apparatus.velocities(truth, drives)
        strength = absorber.strength(level)
        if low <= strength <= high:
            # Constants that are far from the truth may absorb more.
            strength = absorber.searched(level)
            if low <= strength <= high:
                return truth, level, strength
        larger = truth.scaled(float(np.clip(aim / max(strength, 0.1), 0.2, 5.0)))
        if larger == truth:
            return None
        truth = larger
    return None


def write_case(folder: Path, kind: str, seed: int) -> dict[str, Any]:
    """Write one data set into `folder`; return the answer."""
    truth, drives, level, strength, random = make(kind, seed)
    hard = kind == "none, hard"
    trials, setup = apparatus.read(level, drives, random, hard)
    if kind == "shuffled":
        trials = random.permutation(trials.ravel()).reshape(trials.shape)
    write_tables(folder, drives, trials, setup if hard else None)
    return {"kind": kind, "seed": seed, "strength": strength, **asdict(truth)}


def write_more(
    folder: Path, more: Path, answer: dict[str, Any], drives: Sequence[dict[str, Any]]
) -> None:
    """Write `more`: the data of `folder`, and a table of the same robot at further settings."""
    known = {each.name for each in fields(Truth)}
    truth = Truth(**{key: value for key, value in answer.items() if key in known})
    chosen: list[Drive] = [{key: each[key] for key in MORE_KEYS} for each in drives]
    random = np.random.default_rng([answer["seed"], KINDS.index(truth.kind), 1])
    trials, _ = apparatus.read(apparatus.velocities(truth, chosen), chosen, random, False)
    shutil.copytree(folder, more, dirs_exist_ok=True)
    head = ",".join(["velocity", "trial", *MORE_KEYS])
    lines = [head, *_rows(chosen, trials, None, MORE_KEYS)]
    (more / "proposed.csv").write_text("\n".join(lines) + "\n")
    with (more / "measurement.toml").open("a") as file:
        file.write('\n[[velocity]]\nfile = "proposed.csv"\n')


def write_tables(
    folder: Path, drives: list[Drive], trials: Array, setup: NDArray[np.int64] | None
) -> None:
    """What a laboratory would have: its table, its scenario and its measurement file."""
    folder.mkdir(parents=True, exist_ok=True)
    head = ",".join(["velocity", "trial", *KEYS, *(["block"] if setup is not None else [])])
    lines = [head, *_rows(drives, trials, setup)]
    (folder / "velocity.csv").write_text("\n".join(lines) + "\n")
    (folder / "nominal.toml").write_text(NOMINAL)
    (folder / "measurement.toml").write_text(
        'stickslip_measurement = 1\nname = "study"\nscenario = "nominal.toml"\n'
        + UNCERTAIN
        + '\n[[velocity]]\nfile = "velocity.csv"\n'
    )


def _rows(
    drives: list[Drive],
    trials: Array,
    setup: NDArray[np.int64] | None,
    keys: Sequence[str] = KEYS,
) -> list[str]:
    """Lines of the table, one a trial."""
    lines = []
    for at, (drive, row) in enumerate(zip(drives, trials, strict=True)):
        for number, value in enumerate(row):
            cells = [repr(float(value)), str(number), *(str(drive[key]) for key in keys)]
            if setup is not None:
                cells.append(f"day{setup[at, number]}")
            lines.append(",".join(cells))
    return lines
