"""Made sets whose data cannot tell something, and as many of the same kinds in which they tell.

Of each set it is known by the way it was made: twins, constants that trade, constants that hide a
cause or are idle.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip import Cause, Diagnosis, Parameter, Prior, Series, Table, diagnose_model

Array = np.ndarray
Values = dict[str, float]
Predict = Callable[[Any, Any], Array]


def cause(name: str) -> Cause:
    return Cause(name, Parameter(f"{name}.size", size=0.3, low=-9.0, high=9.0), f"a {name}")


def wave(x: Array) -> Array:
    return np.sin(4.0 * x)


def bend(x: Array) -> Array:
    return (x - 1.0) ** 2


# Of each kind: true values of the constants, units, predictions by x, u and p where the data cannot
# tell and where they can, combinations that they tell, and parameters that they do not.
COMBINED = {
    "ratio": (
        {"a": 1.02, "b": 1.0}, "N",
        lambda x, u, p: p["a"] / p["b"] * u * (1.0 + x),
        lambda x, u, p: p["a"] / p["b"] * u * (1.0 + x) + p["a"] * x**2,
        [({"a": 1.0, "b": -1.0}, True)],
    ),
    "product": (
        {"a": 0.7, "b": 2.1}, "-",
        lambda x, u, p: p["a"] * p["b"] * u * (1.0 + x),
        lambda x, u, p: p["a"] * p["b"] * u * (1.0 + x) + p["b"] * x,
        [({"a": 1.0, "b": 1.0}, True)],
    ),
    "sum": (
        {"a": 0.9, "b": 1.4}, "V",
        lambda x, u, p: (p["a"] + p["b"]) * u,
        lambda x, u, p: (p["a"] + p["b"]) * u + p["b"] * x,
        [({"a": 1.0, "b": 1.0}, False)],
    ),
    "weighted sum": (
        {"a": 0.1, "b": 0.6}, "V",
        lambda x, u, p: u * (p["a"] + 2.5 * (p["b"] - 0.6)),
        lambda x, u, p: u * (p["a"] + 2.5 * (p["b"] - 0.6)) + p["a"] * x,
        [({"a": 1.0, "b": 2.5}, False)],
    ),
    "scale": (
        {"a": 1.3, "b": 0.8, "c": 1.1}, "-",
        lambda x, u, p: u * (p["a"] * (1.0 + x) + p["b"] * x**3) / p["c"],
        lambda x, u, p: u * (p["a"] * (1.0 + x) + p["b"] * x**3) / p["c"] + p["a"],
        [],
    ),
    "square": (
        {"a": 1.2, "b": 0.9}, "m",
        lambda x, u, p: p["a"] * p["b"] ** 2 * u * (1.0 + x),
        lambda x, u, p: p["a"] * p["b"] ** 2 * u * (1.0 + x) + p["b"] * x,
        [({"a": 1.0, "b": 2.0}, True)],
    ),
}  # fmt: skip


def stated(random: np.random.Generator, value: float) -> Prior:
    """The prior of a constant that is off by about one of its errors."""
    width, off = random.uniform(0.08, 0.25), float(np.clip(random.normal(), -1.5, 1.5))
    if value < 0.3:
        return Prior("normal", value + 0.3 * off, 0.3)
    if random.random() < 0.5:
        return Prior("normal", value / (1.0 + width * off), width * value / (1.0 + width * off))
    return Prior("log-normal", value / (1.0 + 4.0 * width) ** off, 1.0 + 4.0 * width)


def diagnosed(
    random: np.random.Generator, predict: Predict, truth: dict[str, float],
    uncertain: list[Parameter], causes: list[Cause], way: str,
) -> Diagnosis:  # fmt: skip
    """Readings of a model at true values, as a table or one record, and its diagnosis."""
    n, sd = int(random.integers(30, 60)), random.choice([0.02, 0.05, 0.1])
    x, u = np.linspace(0.0, 2.0, n), random.uniform(0.5, 2.0, n)
    values = {name: np.array([[value]]) for name, value in truth.items()}
    y = predict({"x": x, "u": u}, values)[0] + sd * random.standard_normal(n)
    if way == "table":
        return diagnose_model(predict, Table({"x": x, "u": u}, y, sd=sd), uncertain, causes)

    def in_time(record: Any, p: Any) -> Array:
        return predict({"x": record.t, "u": record["u"]}, p)

    return diagnose_model(in_time, Series(x, y, {"u": u}, sd=sd), uncertain, causes)


def made(kind: str, telling: bool, seed: int, way: str = "table") -> tuple[Diagnosis, Values]:
    """A diagnosis of a kind of data, and the true values."""
    random = np.random.default_rng([seed, telling, len(kind)])
    if kind in MACHINES:
        predict, data, uncertain, causes, values = MACHINES[kind](telling, random)
        return diagnose_model(predict, data, uncertain, causes), values
    shapes = {"wave": wave, "bend": bend}
    hidden = random.choice([0.0, 0.4]) * random.choice([-1.0, 1.0])
    values, unit, cannot, can, _ = COMBINED.get(kind, COMBINED["ratio"])
    formula, priors = can if telling or kind not in COMBINED else cannot, {}
    if kind == "twins":
        # The twin is the wave itself, or another one; where that is there, it is large.
        late = random.uniform(0.3, 0.35) if telling else random.choice([0.0, 0.02])
        shapes["twin"] = lambda x: 2.0 * np.sin(4.0 * x + late)
        hidden = random.choice([0.8, 1.2]) if telling else random.choice([0.0, 0.1, 0.4])
    elif kind == "hidden":
        values = {"a": 1.0, "b": 1.0, "c": 0.0}
        priors["c"] = Prior("normal", random.normal(), 1.0)
        shapes["twin"] = (lambda x: np.cos(6.0 * x)) if telling else (lambda x: 1.5 * np.exp(-x))
        formula = lambda x, u, p: p["a"] * u + p["b"] * x + p["c"] * np.exp(-x)  # noqa: E731
    elif kind == "silent":
        values = {"a": 1.0, "b": 1.0, "c": 1.2}
        some = 1.0 if telling else 1e-3
        formula = lambda x, u, p: p["a"] * u + p["b"] * x + some * p["c"] * u * x**2  # noqa: E731

    def predict(table: Any, p: Any) -> Array:
        x, u = table["x"], table["u"]
        beside = (p.get(f"{name}.size", 0.0) * shape(x) for name, shape in shapes.items())
        return formula(x, u, p) + sum(beside)

    priors = {name: stated(random, value) for name, value in values.items()} | priors
    uncertain = [Parameter(name, prior, unit) for name, prior in priors.items()]
    truth = {**values, "wave.size": hidden}
    return diagnosed(random, predict, truth, uncertain, [*map(cause, shapes)], way), values


Machine = tuple[Predict, list[Table], list[Parameter], list[Cause], Values]


def _constants(random: np.random.Generator, values: Values) -> list[Parameter]:
    return [
        Parameter(name, Prior("log-normal", value * 1.2 ** random.normal(), 1.3), unit=name)
        for name, value in values.items()
    ]


def joint(telling: bool, random: np.random.Generator) -> Machine:
    """A motor of unknown gain: only ratios act, until it turns a known inertia too."""
    values = {"gain": 0.8, "inertia": 0.5, "viscous": 0.6}
    t, more = 0.05 * np.arange(80), (0.0, 0.5)
    volts = np.repeat(random.uniform(-1.0, 1.0, 8), 10)

    def predict(record: Any, p: Any) -> Array:
        inertia = p["inertia"] + more[record.name == "loaded"]
        kept = np.exp(-0.05 * p["viscous"] / inertia)
        speed, found = 0.0 * kept, []
        for each in record["volts"]:
            found.append(speed)
            speed = kept * speed + (1.0 - kept) * p["gain"] / p["viscous"] * each
        return np.hstack(found)

    records = [Series(t, t, {"volts": volts}, name=name)
               for name in ("bare", "loaded")[: 1 + telling]]  # fmt: skip
    true = {name: np.array([[value]]) for name, value in values.items()}
    data: list[Table] = [
        Series(t, predict(each, true)[0] + 0.01 * random.standard_normal(len(t)),
               {"volts": volts}, sd=0.01, name=each.name)
        for each in records
    ]  # fmt: skip
    return predict, data, _constants(random, values), [], values


def cooling(telling: bool, random: np.random.Generator) -> Machine:
    """A body that cools by loss over capacity; under a known power each acts by itself."""
    values = {"loss": 1.5, "capacity": 90.0}
    t, power = np.linspace(0.0, 200.0, 40), 60.0 * telling

    def predict(record: Any, p: Any) -> Array:
        rate, level = p["loss"] / p["capacity"], power / p["loss"]
        return level + (30.0 - level) * np.exp(-rate * record["t"])

    true = {name: np.array([[value]]) for name, value in values.items()}
    y = predict({"t": t}, true)[0] + 0.2 * random.standard_normal(len(t))
    return predict, [Table({"t": t}, y, sd=0.2)], _constants(random, values), [], values


def fall(telling: bool, random: np.random.Generator) -> Machine:
    """A late clock and a push at the start, which only a precise meter parts."""
    sd, late = 1e-3 if telling else 0.1, random.choice([0.04, 0.06] if telling else [0.0, 0.04])
    t = np.linspace(0.1, 2.7, 27)

    def predict(table: Any, p: Any) -> Array:
        since = table["t"] - p["late.time"]
        return 0.5 * p["gravity"] * since**2 + p["push.speed"] * table["t"]

    true = {"late.time": late, "gravity": 9.81, "push.speed": 0.0}
    y = predict({"t": t}, true) + sd * random.standard_normal(len(t))
    causes = [
        Cause("late", Parameter("late.time", unit="s", low=-0.2, high=0.2, size=0.03)),
        Cause("push", Parameter("push.speed", unit="m/s", low=-2.0, high=2.0, size=0.3)),
    ]
    gravity = Parameter("gravity", Prior("normal", 9.81, 0.01), "m/s2", cause=False)
    return predict, [Table({"t": t}, y, sd=sd)], [gravity], causes, {}


def braking(telling: bool, random: np.random.Generator) -> Machine:
    """Dry and viscous friction: one at nearly one speed, two where the speeds differ."""
    speed = random.uniform(*((0.1, 3.0) if telling else (0.95, 1.05)), 40)
    if telling:
        speed *= random.choice([-1.0, 1.0], 40)
    dry, push = float(random.choice([0.0, 0.4])), random.uniform(-1.0, 1.0, 40)

    def predict(table: Any, p: Any) -> Array:
        v = table["speed"]
        return p["mass"] * table["push"] + p["dry.force"] * np.sign(v) + p["viscous.rate"] * v

    y = predict({"speed": speed, "push": push}, {"mass": 1.3, "dry.force": dry,
                "viscous.rate": 0.0}) + 0.05 * random.standard_normal(40)  # fmt: skip
    causes = [
        Cause("dry", Parameter("dry.force", unit="N", low=0.0, high=3.0, size=0.4)),
        Cause("viscous", Parameter("viscous.rate", unit="N s/m", low=0.0, high=3.0, size=0.4)),
    ]
    mass = Parameter("mass", Prior("normal", 1.25, 0.1), "kg")
    data: list[Table] = [Table({"speed": speed, "push": push}, y, sd=0.05)]
    return predict, data, [mass], causes, {}


MACHINES = {"joint": joint, "cooling": cooling, "fall": fall, "braking": braking}
RATIO = [({"loss": 1.0, "capacity": -1.0}, True)]
TWINS = {"twins": {"wave", "twin"}, "fall": {"late", "push"}, "braking": {"dry", "viscous"}}
KINDS = (*COMBINED, "twins", "hidden", "silent", *MACHINES)


def pairs(found: Any) -> list[set[str]]:
    """Causes that are said to be alike and not parted."""
    return [{each.cause, each.other} for each in found.alike if not each.parted]


def is_told(kind: str, result: Diagnosis, values: Values) -> bool:
    """Whether what the data of a kind cannot tell is said."""
    found = result.cannot_tell
    if kind in TWINS:
        return TWINS[kind] in pairs(found)
    if kind == "hidden":
        return found.hidden.get("twin") == ("c",)
    if kind == "silent":
        return found.silent == ["c"]
    if len(found.groups) != 1 or set(found.groups[0].names) != set(values):
        return False
    said = [(each.weights, each.product) for each in found.groups[0].known]
    if kind in ("scale", "joint"):  # it is free which constant is in both ratios
        if [(sorted(each.values()), product) for each, product in said] != 2 * [
            ([-1.0, 1.0], True)
        ]:
            return False
    elif said != (RATIO if kind == "cooling" else COMBINED[kind][-1]):
        return False
    for each in found.groups[0].known:
        terms = [(values[name], weight) for name, weight in each.weights.items()]
        true = (
            np.prod([value**weight for value, weight in terms])
            if each.product else sum(value * weight for value, weight in terms)
        )  # fmt: skip
        if abs(each.value - true) > 4.0 * each.sd:
            return False
    return True


def is_more_told(result: Diagnosis) -> bool:
    """Whether anything is said to be untold."""
    found = result.cannot_tell
    return bool(pairs(found) or found.groups or found.silent or found.hidden)
