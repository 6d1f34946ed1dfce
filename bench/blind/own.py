"""Logs of machines and tables of a line with a hidden cause, for the score of the diagnosis.

A log comes from the integrator of the benchmark of causes, its readings with independent,
correlated or coarse errors, none of which is stated, or beside a model error: an uneven scale of
the sensor, or a drift. A line has two repeats at six places. The cause that is hidden is listed or
not; an unlisted cause may resemble a listed one. A cause that cannot have the wanted effect is
replaced by another one.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from causes.make import KINDS, PARAMETERS, correlated, simulated

from blind.kinds import ERROR_SHARE
from stickslip import Cause, Diagnosis, Parameter, Prior, Series, Table, diagnose_model, models

Array = np.ndarray
MACHINES = {"joint": 0.12, "axis": 2.0, "oscillator": 4.0, "thermal": 60.0}
"""Sizes of their inputs."""
SERVO = 0.8  # size of the goals of servos
COUNT = 120  # readings of a log
NOISE, STRENGTH = 0.02, (4.0, 9.0)  # of the readings' scatter, and of a cause's effect in errors
CORRELATION, STEP = 0.7, 2.0  # of neighbours; of a coarse meter, in errors
SLOPE_STEP = 1e-4  # of a constant; of a start that is 0, in its unit
DECADES, HALVINGS = 2.0, 12  # of the search for a cause's size about the usual one
PLACES = np.repeat(np.linspace(1.0, 6.0, 6), 2)
HIDDEN = ("none", "listed", "listed", "unlisted")
ERRORS = ("white", "correlated", "coarse", "uneven scale", "drift")
MODEL_ERRORS = ERRORS[3:]


class Drawn(NamedTuple):
    """What is hidden, "" for nothing; the truth; the change of the readings; the diagnosis."""

    cause: str
    sizes: dict[str, float]
    effect: Array
    diagnosed: Callable[[], Diagnosis]


def _shapes(x: Array) -> dict[str, Array]:
    return {"bend": (x - 3.5) ** 2, "step": (x > 3.5) * 1.0, "wave": np.sin(4.0 * x)}


def _line(table: Table, p: Any) -> Array:
    x = table["x"]
    shapes = _shapes(x).items()
    return p["slope"] * x + sum(p.get(f"{name}.size", 0.0) * each for name, each in shapes)


def _scaled(change: Array, wanted: float) -> float:
    return wanted / max(float(np.sqrt(np.mean(change**2))), 1e-12)


def line(hidden: str, draw: np.random.Generator) -> Drawn:
    """A table of a line."""
    effect = np.zeros(len(PLACES))
    cause = "" if hidden == "none" else str(draw.choice(["bend", "step", "wave"]))
    sizes = {"slope": draw.normal(1.0, 0.1)}
    y = sizes["slope"] * PLACES + 0.1 * draw.standard_normal(len(PLACES))
    if cause:
        shape = _shapes(PLACES)[cause]
        size = _scaled(refitted(shape, PLACES[:, None]), 0.1 * draw.uniform(2.0, 4.0))
        sizes[f"{cause}.size"], effect = size, size * shape
        y = y + effect
    offered = [name for name in _shapes(PLACES) if hidden == "listed" or name != cause]
    causes = [Cause(each, Parameter(f"{each}.size", size=0.2, low=-5.0, high=5.0))
              for each in offered]  # fmt: skip
    slope = Parameter("slope", Prior("normal", 1.0, 0.1), cause=False)
    asked = partial(diagnose_model, _line, Table({"x": PLACES}, y), [slope], causes)
    return Drawn(cause, sizes, effect, asked)


def log(kind: str, hidden: str, errors: str, draw: np.random.Generator) -> Drawn:
    """A log of a machine."""
    own = KINDS[kind]
    t = own["step"] * np.arange(COUNT)
    u = np.repeat(draw.uniform(0.0 if kind == "thermal" else -1.0, 1.0, 12), 10)
    u *= MACHINES.get(kind, SERVO)
    base = {name: value * (1.0 + part * draw.standard_normal())
            for name, (value, part) in own["constants"].items()}  # fmt: skip
    base |= {**own["known"], "start": 293.0 if kind == "thermal" else 0.0}
    seen = simulated(kind, base, t, u)
    sd = NOISE * float(np.std(seen))
    cause, wanted, plain, size = "", draw.uniform(*STRENGTH) * sd, seen, 0.0
    for cause in draw.permutation([*own["hidden"]]).tolist() if hidden != "none" else []:
        seen, found, size = _sized(kind, cause, base, t, u, plain, wanted)
        if 0.9 * wanted < found < 1.1 * wanted:
            break  # some cannot be as strong: dry friction stops the machine first
    else:
        if hidden != "none":
            raise ValueError(f"{kind}: no cause has an effect of {wanted:.2g}")
    effect, part = seen - plain, draw.uniform(*ERROR_SHARE)
    steps = {name: SLOPE_STEP * base[name] or SLOPE_STEP for name in [*own["constants"], "start"]}
    moves = np.array([simulated(kind, {**base, name: base[name] + step}, t, u) - plain
                      for name, step in steps.items()]).T  # fmt: skip
    if errors in MODEL_ERRORS:
        error = _error(errors, t, seen, draw)
        # What constants undo is no effect, and no error.
        left, wrong = (refitted(change, moves) for change in (effect, error))
        level = part * (float(np.sqrt(np.mean(left**2))) or wanted)
        seen = seen + _scaled(wrong, level) * error
    noise = draw.standard_normal(COUNT)
    if errors == "correlated":
        noise = correlated(noise, CORRELATION)
    seen = seen + sd * noise
    if errors == "coarse":
        seen = STEP * sd * np.round(seen / (STEP * sd))
    known = {name: (value, part * value) for name, (value, part) in own["constants"].items()}
    without = [*own["without"], *([cause] if hidden == "unlisted" else [])]
    model = getattr(models, kind)(without=without, **known, **own["known"])
    name = own["input"].partition(" (")[0]
    record = Series(t, seen, {name: u}, unit=own["reads"].rstrip(")").split(" (")[1])
    asked = partial(diagnose_model, model, record)
    sizes = {**base, cause + PARAMETERS.get(cause.partition(" ")[0], ""): size}
    return Drawn(cause, sizes, effect, asked)


def _sized(
    kind: str, cause: str, base: dict[str, float], t: Array, u: Array, plain: Array, wanted: float
) -> tuple[Array, float, float]:
    """Readings with a cause whose effect comes nearest to the wanted one, that, and the size."""
    low, high = np.log(KINDS[kind]["hidden"][cause]) + np.log(10.0) * np.array([-DECADES, DECADES])
    for _ in range(HALVINGS):
        size = float(np.exp(0.5 * (low + high)))
        with np.errstate(over="ignore", invalid="ignore"):
            seen = simulated(kind, {**base, cause: size}, t, u)
        found = float(np.sqrt(np.mean((seen - plain) ** 2)))
        # What is beyond a limit acts the more, the lower it is.
        if (found < wanted) == (cause != "saturation"):
            low = np.log(size)
        else:
            high = np.log(size)
    return seen, found, size


def refitted(change: Array, columns: Array) -> Array:
    """Residual of a change after a least-squares fit of the columns."""
    return change - columns @ np.linalg.lstsq(columns, change, rcond=None)[0]


def _error(kind: str, t: Array, seen: Array, draw: np.random.Generator) -> Array:
    """Error of a sensor whose scale has a ripple, or that adds slow waves."""
    if kind == "uneven scale":
        return np.sin(2.0 * np.pi * seen / (0.37 * np.ptp(seen)) + draw.uniform(0.0, 6.3))
    waves = [draw.normal() * np.sin(2.0 * np.pi * rate * t / t[-1] + draw.uniform(0.0, 6.3)) / rate
             for rate in (0.5, 1.0, 1.5, 2.3)]  # fmt: skip
    return np.sum(waves, axis=0)


def plan(place: int) -> tuple[str, str, str]:
    """Kind, what is hidden, and errors of a set of a range; every second one is of the line."""
    turn, machine = divmod(place, 2)
    if not machine:
        return "line", HIDDEN[turn % len(HIDDEN)], "few repeats"
    every = [*itertools.product(HIDDEN, ERRORS, MACHINES)]
    hidden, errors, kind = every[turn % len(every)]
    return kind, hidden, errors


def clean(place: int) -> tuple[str, str, str]:
    """Kind, what is hidden, and errors of a set that hides nothing, a line and a log in turn."""
    every = [*itertools.product(ERRORS, MACHINES)]
    errors, kind = every[place // 2 % len(every)] if place % 2 else ("few repeats", "line")
    return kind, "none", errors


def drawn(seed: int, kind: str, hidden: str, errors: str) -> Drawn:
    """The set of a seed."""
    draw = np.random.default_rng([7, seed])
    return line(hidden, draw) if kind == "line" else log(kind, hidden, errors, draw)
