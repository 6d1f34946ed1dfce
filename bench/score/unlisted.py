"""Logs with a cause that no machine lists, of a shape that nobody lists either; twelve of each.

A dead zone where it is not listed, a hysteresis (an elastic force that slips at a limit), a wave of
a drawn period in the force, a second mode (a mass on a spring, carried along), and a constant that
drifts along a line or a random walk.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from causes.make import Acts, Array, Terms

from score.made import COUNT, Hidden, Key, Machine, Made, hide

FIRST, LAST, OF_A_SHAPE = 8.0, 25.0, 12  # strengths, and problems
DAMPING = 0.03  # of a second mode
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
RATES = {"pendulum": 4.0, "oscillator": 6.3, "servo": 8.0}
"""Of the machines themselves, rad/s."""


def _slips(width: float, h: float, c: Terms) -> Acts:
    part = 0.0

    def force(k: int, x: Any, v: Any) -> Any:
        nonlocal part
        part = np.clip(part + h * v / width, -1.0, 1.0)
        return -c["unlisted"] * part

    return force


def _waves(rate: float, phase: float, h: float, c: Terms) -> Acts:
    return lambda k, x, v: c["unlisted"] * np.sin(rate * h * (k + 0.5) + phase)


def _swings(rate: float, h: float, c: Terms) -> Acts:
    place = speed = None

    def force(k: int, x: Any, v: Any) -> Any:
        nonlocal place, speed
        place, speed = (x, v) if place is None else (place, speed)
        pulled = rate**2 * (x - place) + 2.0 * DAMPING * rate * (v - speed)
        speed = speed + h * pulled
        place = place + h * speed
        return -c["unlisted"] * pulled

    return force


def _drifts(of: Machine, course: Array, h: float, c: Terms) -> Acts:
    times = np.linspace(0.0, COUNT * of.step, len(course))
    now = np.interp(h * np.arange(COUNT * of.step / h), times, course)
    if of.kind == "thermal":  # its loss; else a stiffness, or damping
        return lambda k, x, v: -c["unlisted"] * now[k] * (x - c["ambient"])
    return lambda k, x, v: -c["unlisted"] * now[k] * (x if of.kind == "oscillator" else v)


def _drawn(shape: str, of: Machine, draw: np.random.Generator) -> Hidden:
    """What acts on a machine."""
    if shape == "hysteresis":
        return partial(_slips, WIDTHS[of.kind] * draw.uniform(0.5, 2.0))
    if shape == "wave":
        period = draw.uniform(0.08, 0.4) * COUNT * of.step
        return partial(_waves, 2.0 * np.pi / period, draw.uniform(0.0, 2.0 * np.pi))
    if shape == "second mode":
        return partial(_swings, RATES[of.kind] * draw.uniform(1.5, 3.0))
    walk = np.cumsum(np.r_[0.0, draw.standard_normal(30)])
    course = walk / np.max(np.abs(walk)) if draw.random() < 0.5 else np.linspace(0.0, 1.0, 31)
    return partial(_drifts, of, course)


def problems(first_seed: int) -> list[Key]:
    """All problems, of a drawn strength each."""
    strengths = np.random.default_rng(first_seed).uniform(FIRST, LAST, len(SHAPES) * OF_A_SHAPE)
    return [Key(first_seed + k, [*of][k % len(of)], shape, round(float(strengths[k]), 2), "clean")
            for k, (shape, of) in enumerate(each for each in SHAPES.items()
                                            for _ in range(OF_A_SHAPE))]  # fmt: skip


def made(key: Key) -> Made:
    """The problem of a key; its `size` is by the name of the shape."""
    zone = key.cause == "dead zone"  # which the integrators have
    acts = None if zone else partial(_drawn, key.cause)
    usual = SHAPES[key.cause][key.machine]
    found = hide(key, "dead_zone" if zone else "unlisted", usual, acts)
    return found._replace(truth="unlisted", size={key.cause: next(iter(found.size.values()))})
