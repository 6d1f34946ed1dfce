"""Logs with a cause that no machine lists, of a shape that nobody lists either.

A dead zone where it is not listed, a hysteresis (an elastic force that slips at a limit), a wave of
a drawn period in the force, a second mode (a mass on a spring, carried along), and a constant that
drifts along a line or a random walk; twelve of each.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from causes.make import Terms

from score.made import COUNT, Hidden, Key, Machine, Made, hide

FIRST, LAST = 8.0, 25.0  # strength
OF_A_SHAPE = 12
SHAPES: dict[str, dict[str, float]] = {
    "dead zone": {"joint": 0.01, "oscillator": 0.3, "heater": 5.0, "servo by its duty": 0.01},
    "hysteresis": {"joint": 0.02, "axis": 0.1, "oscillator": 0.3,
                   "pendulum with a moved pivot": 0.3},
    "wave": {"joint": 0.01, "axis": 0.1, "oscillator": 0.2, "heater": 2.0},
    "second mode": {"pendulum": 0.1, "oscillator": 0.1, "servo": 5e-3, "servo by its duty": 5e-3},
    "drift": {"joint": 0.01, "oscillator": 2.0, "heater": 0.2, "pendulum": 0.03},
}  # fmt: skip
"""Machines that may have a shape, with usual sizes: of a command, a force, a mass, a constant."""
WIDTHS = {"joint": 0.3, "axis": 0.03, "oscillator": 0.05, "pendulum": 0.1}
"""Ways over which an elastic force rises to its limit."""
FREQUENCIES = {"pendulum": 4.0, "oscillator": 6.3, "servo": 8.0}  # of the machines, rad/s
DAMPING = 0.03  # of a second mode


def _hysteresis(of: Machine, draw: np.random.Generator) -> Hidden:
    width = WIDTHS[of.kind] * draw.uniform(0.5, 2.0)

    def hidden(h: float, c: Terms) -> Any:
        part = 0.0

        def force(k: int, x: Any, v: Any) -> Any:
            nonlocal part
            part = np.clip(part + h * v / width, -1.0, 1.0)
            return -c["unlisted"] * part

        return force

    return hidden


def _wave(of: Machine, draw: np.random.Generator) -> Hidden:
    rate = 2.0 * np.pi / (draw.uniform(0.08, 0.4) * COUNT * of.step)
    phase = draw.uniform(0.0, 2.0 * np.pi)
    return lambda h, c: lambda k, x, v: c["unlisted"] * np.sin(rate * h * (k + 0.5) + phase)


def _second_mode(of: Machine, draw: np.random.Generator) -> Hidden:
    turns = FREQUENCIES[of.kind] * draw.uniform(1.5, 3.0)

    def hidden(h: float, c: Terms) -> Any:
        place = speed = None

        def force(k: int, x: Any, v: Any) -> Any:
            nonlocal place, speed
            place, speed = (x, v) if place is None else (place, speed)
            pulled = turns**2 * (x - place) + 2.0 * DAMPING * turns * (v - speed)
            speed = speed + h * pulled
            place = place + h * speed
            return -c["unlisted"] * pulled

        return force

    return hidden


def _drift(of: Machine, draw: np.random.Generator) -> Hidden:
    walk = np.cumsum(np.r_[0.0, draw.standard_normal(30)])
    course = np.linspace(0.0, 1.0, 31) if draw.random() < 0.5 else walk / np.max(np.abs(walk))
    places = np.linspace(0.0, COUNT * of.step, 31)

    def hidden(h: float, c: Terms) -> Any:
        now = np.interp(h * np.arange(COUNT * of.step / h), places, course)
        if of.kind == "oscillator":  # its stiffness; else damping or loss
            return lambda k, x, v: -c["unlisted"] * now[k] * x
        if of.kind == "thermal":
            return lambda k, x, v: -c["unlisted"] * now[k] * (x - c["ambient"])
        return lambda k, x, v: -c["unlisted"] * now[k] * v

    return hidden


ACTS = {"hysteresis": _hysteresis, "wave": _wave, "second mode": _second_mode, "drift": _drift}


def problems(first_seed: int) -> list[Key]:
    """All problems, of a drawn strength each."""
    keys = []
    for seed, (shape, number) in enumerate(
        ((shape, number) for shape in SHAPES for number in range(OF_A_SHAPE)), first_seed
    ):
        machine = [*SHAPES[shape]][number % len(SHAPES[shape])]
        strength = float(np.random.default_rng([seed, 7]).uniform(FIRST, LAST))
        keys.append(Key(seed, machine, shape, round(strength, 2), "clean"))
    return keys


def made(key: Key) -> Made:
    """The problem of a key; its `size` is by the shape's name."""
    name, usual = "unlisted", SHAPES[key.cause][key.machine]
    found = hide(key, "dead_zone" if key.cause == "dead zone" else name, usual, ACTS.get(key.cause))
    (size,) = found.size.values()
    title = f"{key.machine}, {key.cause}, {key.strength:g}, {key.condition}"
    return found._replace(name=title, truth="unlisted", size={key.cause: size})
