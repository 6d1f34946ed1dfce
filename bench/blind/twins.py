"""The study of near twins beside what neither explains: logs that a distorted sensor has read.

A motion has one cause, which is listed with others that act alike; the scale of its sensor, or the
lens of its camera, bends what is read by a part of the cause's effect. Noise is as small beside the
effect as is drawn, so that no fit but a bent one could reach it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from typing import Any, NamedTuple

import numpy as np
import scores
from scipy.integrate import solve_ivp
from scores import Answer

from blind.kinds import ERROR_SHARE
from blind.own import refitted
from stickslip import Cause, Parameter, Prior, Series, Table, diagnose_model

Row = dict[str, Any]
Array = np.ndarray
STRENGTH = 6.0, 40.0  # of what constants leave of the cause's effect, in errors
SIZES = 0.5, 2.0  # of a cause beside its usual size
NEITHER = 0.35  # least part of an error that no listed cause explains, of what constants leave
LARGEST = 30.0  # size, in usual ones

COUNT = 100  # readings


class Kind(NamedTuple):
    """A motion, read as a place (0) or a rate (1), for so many seconds.

    Constants have middles and standard deviations, of which `x` and `v` are the starts; causes have
    their usual sizes; the rate is the acceleration.
    """

    read: int
    duration: float
    constants: dict[str, tuple[float, float]]
    causes: dict[str, float]
    rate: Callable[[Any, Any, Any, Any], Any]


def _swing(x: Any, v: Any, t: Any, p: Any) -> Any:
    damping = p["viscous"] + p["quadratic"] * abs(v) + p["cubic"] * v * v
    return -p["spring"] * np.sin(x) - damping * v - p["dry"] * np.tanh(v / 0.1)


def _turn(x: Any, v: Any, t: Any, p: Any) -> Any:
    torque = 0.1 * np.sin(0.9 * t) + 0.05 * np.sin(2.3 * t + 1.0) - p["load"]
    drag = (p["viscous"] + p["quadratic"] * abs(v)) * v + p["dry"] * np.tanh(v / 0.2)
    return (torque - drag) / p["inertia"]


_AIR = (
    {"linear": 0.3, "quadratic": 0.1, "lighter": 0.4, "clock": 0.02},
    (lambda x, v, t, p: p["lighter"] - 9.81 - p["linear"] * v - p["quadratic"] * v * abs(v)),
)
KINDS = {
    "ball": Kind(0, 0.9, {"x": (1.2, 0.02), "v": (2.5, 0.2)}, *_AIR),
    "fall": Kind(0, 0.6, {"x": (1.8, 0.02), "v": (0.0, 0.1)}, *_AIR),
    "cart": Kind(1, 8.0, {"v": (3.0, 0.1), "rolling": (0.15, 0.02)},
                 {"linear": 0.06, "quadratic": 0.03, "cubic": 0.01}, lambda x, v, t, p:
                 -p["rolling"] - (p["linear"] + p["quadratic"] * abs(v) + p["cubic"] * v * v) * v),
    "swing": Kind(0, 5.0, {"x": (0.8, 0.02), "v": (0.0, 0.05), "spring": (16.0, 0.5),
                           "viscous": (0.08, 0.03)},
                  {"quadratic": 0.1, "dry": 0.1, "cubic": 0.03}, _swing),
    "rotor": Kind(1, 15.0, {"v": (0.0, 0.1), "inertia": (0.012, 6e-4), "viscous": (0.02, 0.004)},
                  {"dry": 0.02, "quadratic": 0.003, "load": 0.01}, _turn),
    # Above the temperature of a room.
    "cooling": Kind(1, 300.0, {"v": (60.0, 1.0), "loss": (0.008, 0.001)},
                    {"growth": 5e-5, "radiation": 1e-11, "heat": 0.05}, lambda x, v, t, p:
                    p["heat"] - (p["loss"] + p["growth"] * abs(v)) * v
                    - p["radiation"] * ((v + 293.0) ** 4 - 293.0**4)),
}  # fmt: skip
# Of a reading between -1 and 1, with a number from 0 to 1.
DISTORTIONS: dict[str, Callable[[Array, float], Array]] = {
    "kink": lambda z, u: np.maximum(z - 0.8 * (2.0 * u - 1.0), 0.0),
    "lens": lambda z, u: (z - 0.6 * u) ** 3 - 0.8 * (z - 0.6 * u) ** 5,
    "ripple": lambda z, u: np.sin(2.0 * np.pi * ((0.5 + u) * z + u)),
}


def solved(kind: Kind, p: dict[str, float], t: Array) -> Array:
    """Readings without errors, by an adaptive method, shape (n,)."""
    pace = 1.0 + p.get("clock", 0.0)
    start = p.get("x", 0.0), p["v"]
    made = solve_ivp(lambda s, z: (z[1], kind.rate(*z, s, p)), (0.0, pace * t[-1]), start, "DOP853",
                     pace * t, rtol=1e-9, atol=1e-9)  # fmt: skip
    return np.asarray(made.y[kind.read])


def model_of(kind: str) -> Callable[[Table, Any], Array]:
    """The model as its user has it: steps of Runge and Kutta, shape (vectors, n)."""
    read, rate = KINDS[kind].read, KINDS[kind].rate

    def predict(table: Table, p: Any) -> Array:
        h = (table["t"][1] - table["t"][0]) * (1.0 + p.get("clock", 0.0))
        x, v, t = p.get("x", 0.0 * p["v"]), p["v"], 0.0 * h
        found = [(x, v)[read]]
        with np.errstate(over="ignore", invalid="ignore"):
            for _ in table["t"][1:]:
                one = rate(x, v, t, p)
                two = rate(x + 0.5 * h * v, v + 0.5 * h * one, t + 0.5 * h, p)
                three = rate(x + 0.5 * h * v, v + 0.5 * h * two, t + 0.5 * h, p)
                four = rate(x + h * v, v + h * three, t + h, p)
                x = x + h * (v + h / 6.0 * (one + two + three))
                v = v + h / 6.0 * (one + 2.0 * (two + three) + four)
                t = t + h
                found.append((x, v)[read])
        return np.hstack(found)

    return predict


def moves(kind: Kind, p: dict[str, float], t: Array, steps: dict[str, float]) -> Array:
    """Changes of what is to be read by a step of each parameter, over it, (n, parameters)."""
    plain = solved(kind, p, t)
    return np.array([(solved(kind, {**p, key: p[key] + step}, t) - plain) / step
                     for key, step in steps.items()]).T  # fmt: skip


def listed(kind: Kind, names: Collection[str]) -> tuple[list[Parameter], list[Cause]]:
    """Constants of a motion, and those of its causes that are listed."""
    uncertain = [Parameter(key, Prior("normal", *prior), cause=False)
                 for key, prior in kind.constants.items()]  # fmt: skip
    causes = [Cause(key, Parameter(key, size=usual, low=-LARGEST * usual * (key == "clock"),
                                   high=LARGEST * usual))
              for key, usual in kind.causes.items() if key in names]  # fmt: skip
    return uncertain, causes


def made(seed: int) -> tuple[Row, Series, list[Parameter], list[Cause]]:
    """The truth, the readings, constants and listed causes."""
    draw, name = np.random.default_rng([45, seed]), [*KINDS][seed % len(KINDS)]
    kind = KINDS[name]
    hidden = [*kind.causes][seed // len(KINDS) % len(kind.causes)]
    t = np.linspace(0.0, kind.duration, COUNT)
    base = {key: float(draw.normal(*prior)) for key, prior in kind.constants.items()}
    base |= dict.fromkeys(kind.causes, 0.0)
    size = kind.causes[hidden] * math.exp(draw.uniform(*np.log(SIZES)))
    plain, seen = (solved(kind, {**base, hidden: each}, t) for each in (0.0, size))
    acting = {**base, hidden: size}
    constants = {key: 0.01 * spread for key, (_, spread) in kind.constants.items()}
    of_constants = moves(kind, base, t, constants)
    every = np.hstack([
        of_constants, moves(kind, acting, t, {key: 0.01 * u for key, u in kind.causes.items()})
    ])  # fmt: skip
    effect = float(np.std(refitted(seen - plain, of_constants)))
    z, taken, left = 2.0 * (seen - seen.min()) / np.ptp(seen) - 1.0, 1.0, 0.0
    while left < NEITHER * taken:
        bent = str(draw.choice([*DISTORTIONS]))
        error = DISTORTIONS[bent](z, draw.uniform())
        taken, left = (float(np.std(refitted(error, some))) for some in (of_constants, every))
    error *= draw.uniform(*ERROR_SHARE) * effect / taken
    sd = effect / math.exp(draw.uniform(*np.log(STRENGTH)))
    y = seen + error + sd * draw.normal(size=COUNT)
    record = Series(t, y, sd=sd if seed % 2 else None)
    truth = {"kind": name, "cause": hidden, "distortion": bent}
    return truth, record, *listed(kind, kind.causes)


def judged(seed: int) -> Row:
    """The truth of a set, and its verdict."""
    answer, record, uncertain, causes = made(seed)
    verdict = diagnose_model(model_of(answer["kind"]), record, uncertain, causes).verdict
    return {**answer, "verdict": verdict.kind, "causes": list(verdict.causes)}


def answer(row: Row) -> Answer:
    """The verdict beside the hidden cause."""
    return Answer(row["verdict"], row["causes"], [row["cause"]])


def table(rows: list[Row]) -> str:
    """Counts of verdicts with intervals, for all sets and for each motion."""
    kinds = {name: [answer(row) for row in rows if row["kind"] == name] for name in KINDS}
    seconds = sum(row["cpu_seconds"] for row in rows)
    return f"{scores.table({'all': [*map(answer, rows)], **kinds})}\n\n{seconds:.0f} CPU s."
