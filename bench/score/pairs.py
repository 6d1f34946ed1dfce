"""Pairs of logs of a machine, of which most have one difference.

In half of them the model is not told of a dry friction or a load that both sides have. Machines are
those of the benchmark of causes. A difference is so many errors of a reading, after a refit of what
both sides share and of where each begins. Of three pairs two have the same inputs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from blind.own import COUNT, MACHINES, NOISE, SERVO, refitted
from causes.make import KINDS, STRENGTH, Array, simulated

from stickslip import Series, models

TOLD, UNTOLD = ("joint", "axis", "thermal", "servo"), ("joint", "axis", "oscillator")
SAME = 2, 5  # of seven pairs those without a difference
DRY = 0.2  # error of dry friction that is stated
STEP, TRIES, CLOSE = 1e-3, 8, 0.1  # of a slope; by which a difference gets its strength, nearly


class Pair(NamedTuple):
    """The difference, "" for none; whether inputs are alike; what is compared."""

    change: str
    alike: bool
    sides: tuple[Series, Series]
    model: Any


def made(seed: int, place: int) -> Pair:
    """A pair of a seed; its place says of which kind it is."""
    draw, kinds = np.random.default_rng([47, seed]), UNTOLD if place % 2 else TOLD
    kind, alike = kinds[place // 2 % len(kinds)], bool(draw.random() < 2 / 3)
    own, stated, heats = KINDS[kind], dict(KINDS[kind]["constants"]), kind == "thermal"
    if place % 2 == 0 and kind in ("joint", "axis"):
        stated["coulomb"] = own["hidden"]["coulomb"], DRY
    t = own["step"] * np.arange(COUNT)
    u = np.repeat(draw.uniform(heats - 1.0, 1.0, (2, 12)), COUNT // 12, axis=1)
    u = MACHINES.get(kind, SERVO) * (u[[0, 0]] if alike else u)
    base = {name: value * (1.0 + part * draw.standard_normal())
            for name, (value, part) in stated.items()}  # fmt: skip
    base |= {**own["known"], "start": 293.0 * heats}
    if place % 2:
        name = "load" if place // 6 % 2 and kind != "oscillator" else "coulomb"
        base[name] = 0.5 * own["hidden"]["coulomb"]

    def read(changes: dict[str, float]) -> Array:
        return np.array([simulated(kind, {**base, **changes}, t, each) for each in u])

    change, level = "", read({})
    sd = NOISE * np.std(level, axis=1, keepdims=True)
    if place % 7 not in SAME:
        sizes = {**own["hidden"], **{name: 0.2 * base[name] for name in stated}}
        change, level = _changed(read, base, [*stated, "start"], sizes, sd, draw)
    level = level + sd * draw.standard_normal(level.shape)
    known = {name: (value, part * value) for name, (value, part) in stated.items()}
    model = getattr(models, kind)(without=own["without"], **known, **own["known"])
    name = own["input"].partition(" (")[0]
    before, after = (Series(t, level[k], {name: u[k]}, unit=model.unit) for k in range(2))
    return Pair(change, alike, (before, after), model)


def _changed(
    read: Callable[[dict[str, float]], Array], base: dict[str, float], shared: list[str],
    sizes: dict[str, float], sd: Array, draw: np.random.Generator,
) -> tuple[str, Array]:  # fmt: skip
    """The name of a difference with its side, and readings."""
    plain, steps = read({}), {name: STEP * (base[name] or 1.0) for name in shared}
    moves = [(read({name: base[name] + step}) - plain) / sd for name, step in steps.items()]
    moves += [moves[-1] * [[1], [0]]]  # each side begins by itself
    columns = np.array(moves).reshape(len(moves), -1).T
    for name in draw.permutation([*sizes]).tolist():
        side = 1 if name in base else int(draw.integers(2))
        size, wanted, level = sizes[name], draw.uniform(*STRENGTH), plain.copy()
        for _ in range(TRIES):
            level[side] = read({name: base.get(name, 0.0) + size})[side]
            left = refitted(((level - plain) / sd).ravel(), columns)
            found = float(np.sqrt(np.mean(left**2)))
            if abs(found / wanted - 1.0) < CLOSE:
                return f"{name}[{('before', 'after')[side]}]", level
            # What is beyond a limit acts as the limit falls.
            power = -0.7 if name == "saturation" else 0.7
            size *= float(np.clip(wanted / max(found, 1e-3), 0.5, 2.0)) ** power
    raise ValueError(f"no difference of {wanted:.2g} errors")
