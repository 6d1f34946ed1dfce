"""The study of units that nobody stated, of the time, the readings, an input or a constant.

Of five sets four have a wrong unit; the fifth has right units and a constant that is 20 % to
tenfold off, as a wrong gear or winding is. Motions come from Euler's method in fine steps.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scores import CLAIMS, markdown, share

from stickslip import Parameter, Prior, ScenarioError, Series, diagnose_model, models
from stickslip._util.units import factor_text

Row = dict[str, Any]
STEPS = 40  # of Euler's method, from one reading to the next
WRONG = ("time", "reading", "input", "constant", "")
TIMES = {"ms": 1e3, "us": 1e6, "min": 1 / 60}
CLOCK = 39780.0  # ms, of a logger that has run for a while


class Kind(NamedTuple):
    """A machine: its usual constants, input, step (s), start and the slope of its state.

    `reads` and `inputs` have other units by how many of them are one of SI; `others` has, of a
    constant, the factors of units in which it may be stated.
    """

    model: Callable[..., Any]
    constants: dict[str, float]
    input: str
    size: float
    step: float
    start: list[float]
    slope: Callable[[Any, float, dict[str, float]], list[float]]
    reads: dict[str, float]
    inputs: dict[str, float]
    others: dict[str, tuple[float, ...]]


def _tank(table: Series, p: dict[str, Any]) -> Any:
    """Level of a tank with a hole, by the midpoint rule."""
    level = p["start"][:, 0]
    made = [level]
    for step, inflow in zip(np.diff(table.t), table["inflow"][:-1], strict=True):
        for _ in range(4):
            slope = (inflow - p["outlet"][:, 0] * np.sqrt(np.maximum(level, 0.0))) / p["area"][:, 0]
            half = np.sqrt(np.maximum(level + 0.125 * step * slope, 0.0))
            level = level + 0.25 * step * (inflow - p["outlet"][:, 0] * half) / p["area"][:, 0]
        made.append(level)
    return np.stack(made, axis=1)


def _tank_of(**known: tuple[float, float]) -> tuple[Any, list[Parameter]]:
    start = Parameter("start", Prior("normal", 0.4, 0.02), cause=False)
    return _tank, [start, *(Parameter(key, Prior("normal", *one), low=1e-3 * one[0])
                            for key, one in known.items())]  # fmt: skip


KINDS = {
    "joint": Kind(
        models.joint, {"inertia": 0.012, "viscous": 0.02, "coulomb": 0.03}, "torque", 0.3, 0.01,
        [0.0], lambda x, u, c: [
            (u - c["viscous"] * x[0] - c["coulomb"] * np.tanh(x[0] / 1e-3)) / c["inertia"]
        ],
        {"rpm": 30 / np.pi, "deg/s": 180 / np.pi}, {"mN m": 1e3, "N cm": 100.0},
        {"inertia": (1e7, 1e4, 1e3)},
    ),
    "axis": Kind(
        models.axis, {"mass": 2.0, "viscous": 3.0}, "command", 5.0, 0.02, [0.0, 0.0],
        lambda x, u, c: [x[1], (u - c["viscous"] * x[1]) / c["mass"]],
        {"mm": 1e3, "cm": 100.0}, {"mV": 1e3, "mN": 1e3}, {"mass": (1e3,), "viscous": (1e-3,)},
    ),
    "heater": Kind(
        models.thermal, {"capacity": 400.0, "loss": 1.5}, "power", 60.0, 8.0, [0.0],
        lambda x, u, c: [(u - c["loss"] * x[0]) / c["capacity"]],
        {"degF": 1.8}, {"kW": 1e-3, "mW": 1e3}, {"capacity": (1e-3,), "loss": (1e3,)},
    ),
    "oscillator": Kind(
        models.oscillator, {"mass": 0.8, "stiffness": 60.0, "viscous": 0.7}, "force", 3.0, 0.03,
        [0.02, 0.0],
        lambda x, u, c: [x[1], (u - c["viscous"] * x[1] - c["stiffness"] * x[0]) / c["mass"]],
        {"mm": 1e3, "cm": 100.0, "um": 1e6}, {"mN": 1e3, "kN": 1e-3},
        {"mass": (1e3,), "stiffness": (1e-3,)},
    ),
    "own": Kind(
        _tank_of, {"area": 0.05, "outlet": 0.004}, "inflow", 0.003, 1.5, [0.4],
        lambda x, u, c: [(u - c["outlet"] * np.sqrt(max(x[0], 0.0))) / c["area"]],
        {"mm": 1e3, "cm": 100.0}, {"l/s": 1e3, "l/min": 6e4}, {"area": (1e4,), "outlet": (1e3,)},
    ),
}  # fmt: skip


def made(seed: int) -> tuple[Row, str, Any, Series]:
    """The error of the log, the words that tell it, the model and its log."""
    draw = np.random.default_rng(seed)
    kind, wrong = list(KINDS)[seed // 5 % 5], WRONG[seed % 5]
    of = KINDS[kind]
    count = int(draw.integers(120, 260))
    t = of.step * np.arange(count)
    turn, begin = draw.uniform(0.06, 0.15), draw.uniform(0, 6)
    waves = np.sign(np.sin(t / of.step * turn + begin)) * draw.uniform(0.7, 1)
    swings = kind in ("joint", "axis", "oscillator")
    u = waves * (0.6 + 0.4 * np.sin(0.02 * t / of.step)) if swings else 0.6 + 0.4 * waves
    u = of.size * u
    truth = {key: value * draw.uniform(0.6, 1.6) for key, value in of.constants.items()}
    errors = {key: float(draw.choice([0.02, 0.05, 0.1])) for key in truth}
    known = {key: value * (1 + errors[key] * draw.standard_normal())
             for key, value in truth.items()}  # fmt: skip
    x, seen = np.array(of.start), []
    for acts in u:
        seen.append(x[0])
        for _ in range(STEPS):
            x = x + of.step / STEPS * np.array(of.slope(x, acts, truth))
    y = np.array(seen)
    sd = float(np.ptp(y) * draw.choice([0.003, 0.01, 0.03]))
    y = y + sd * draw.standard_normal(count)
    what, factor, words = wrong, 1.0, ""
    if wrong == "time":
        unit = str(draw.choice(list(TIMES)))
        factor, words = TIMES[unit], f'"time ({unit})"'
        t = t * factor + CLOCK * (unit == "ms")
    elif wrong == "reading":
        words = str(draw.choice(list(of.reads)))
        factor = of.reads[words]
        sd, y = sd * factor, y * factor
        if kind == "heater" and draw.random() < 0.5:
            known["ambient"], errors["ambient"], y = 20.0, 1e-3, y + 20.0 * factor + 32.0
    elif wrong == "input":
        unit = str(draw.choice(list(of.inputs)))
        factor, words = of.inputs[unit], f"{of.input} ({unit})"
        u = u * factor
    else:
        what = words = str(draw.choice(list(of.others if wrong else truth)))
        off = float(np.exp(draw.uniform(np.log(1.2), np.log(10))) ** draw.choice([-1, 1]))
        factor = float(draw.choice(of.others[what])) if wrong else off
        known[what] *= factor
    stated = {key: (value, errors[key] * value) for key, value in known.items()}
    log = Series(t, y, {of.input: u}, sd if draw.random() < 0.6 else None)
    if kind == "own" and wrong in ("reading", "input"):  # A model of one's own has no units.
        words = f"{factor_text(1.0 / factor)} times as large"
    return (
        {"kind": kind, "wrong": wrong, "what": what, "factor": factor},
        words,
        of.model(**stated),
        log,
    )


def judged(seed: int) -> Row:
    """The error of a set, its verdict, and whether the factor is said rightly."""
    answer, words, model, log = made(seed)
    predict, constants = model if isinstance(model, tuple) else (model, None)
    try:
        found = diagnose_model(predict, log, constants)
    except ScenarioError as error:
        return {**answer, "verdict": "refused", "causes": [], "said": str(error), "right": False}
    verdict = found.verdict
    problem = verdict.kind == "data-problem"
    text = " ".join(map(str, verdict.reasons)) if problem else found.summary()
    told = problem or "factor of" in text
    right = words in text and told if answer["wrong"] else _is_single(verdict, answer["what"])
    return {**answer, "verdict": verdict.kind, "causes": list(verdict.causes), "told": told,
            "right": right, "said": text[:200]}  # fmt: skip


def _is_single(verdict: Any, constant: str) -> bool:
    return verdict.kind in CLAIMS and tuple(verdict.causes) == (constant,)


def table(rows: list[Row]) -> str:
    """Counts by what is wrong: told rightly, `data-problem`, and named without the factor."""
    wrong = [row for row in rows if row["wrong"]]
    groups = [(name, [row for row in wrong if row["wrong"] == name]) for name in WRONG[:-1]]
    groups += [("any of these", wrong), ("right units", [row for row in rows if not row["wrong"]])]
    found = []
    for name, some in groups:
        counts = [sum(row["right"] for row in some),
                  sum(row["verdict"] == "data-problem" for row in some),
                  sum(row["verdict"] in CLAIMS and not row["told"] for row in some)]  # fmt: skip
        if some:
            found.append((name, len(some), *(share(count, len(some)) for count in counts)))
    head = "wrong unit of;sets;right;`data-problem`;named without the factor"
    return f"{markdown(head, found)}\n\n{sum(row['cpu_seconds'] for row in rows):.0f} CPU s."
