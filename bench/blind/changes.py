"""The study of what changed: pairs of logs, or of measurements of a walker, with one difference.

Of four pairs one has no difference, and in half both sides have an error of the model. Of three
pairs of logs two have the same times and inputs on both sides. A difference is 4 to 9 errors of
what constants of both sides and starts leave of it. Motions of logs come from Euler's method in
fine steps, those of walkers from the reference simulator. Beside what `diagnose_change` says stand
two absolute diagnoses, and the least of BIC over single differences.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import scores
from scores import FEW, markdown

from blind.readings import STEP, simulate_reference
from stickslip import (
    Diagnosis,
    Measurement,
    Prior,
    Scenario,
    Series,
    diagnose,
    diagnose_change,
    diagnose_model,
    models,
)
from stickslip.diagnosis.decision.verdict import CLAIMS

Row = dict[str, Any]
Array = np.ndarray
COUNT, STAIR, FINE = 240, 12, 40  # readings; of them one input; steps of Euler's method
STRENGTH, ERROR = (4.0, 9.0), (5.0, 20.0)  # of the difference, and of the model's error, in errors
STATED, NOISE = 0.05, (0.01, 0.03)  # errors: relative of constants; of the readings' scatter
SURE = 3.0  # errors of a constant that two logs tell


class Kind(NamedTuple):
    """A machine: stated constants, step (s), size of the input, what may change and its unit.

    `errors` are of the model and their units: one that nobody lists, and one that is listed.
    """

    model: Callable[..., Any] | None
    input: str
    step: float
    size: float
    constants: dict[str, float]
    changes: dict[str, float]
    errors: dict[str, float]


_PLACE = 0.01, 1.0
KINDS = {
    "joint": Kind(
        models.joint, "torque", 0.01, 0.3, {"inertia": 0.012, "viscous": 0.05, "coulomb": 0.01},
        {"inertia change": 6e-4, "viscous change": 2e-3, "coulomb change": 2e-3, "load after": 3e-3,
         "quadratic after": 5e-4, "quadratic before": 5e-4, "zero after": 0.02,
         "scale after": 0.02},
        {"ripple": 5e-3, "quadratic": 1e-3},
    ),
    "axis": Kind(
        models.axis, "command", 0.01, 5.0, {"mass": 2.0, "viscous": 8.0, "coulomb": 0.3},
        {"mass change": 0.1, "viscous change": 0.2, "coulomb change": 0.05, "load after": 0.1,
         "quadratic after": 0.5, "dead_zone before": 0.05, "scale after": 0.02},
        {"ripple": 0.2, "quadratic": 1.0},
    ),
    "thermal": Kind(
        models.thermal, "power", 5.0, 60.0, {"capacity": 400.0, "loss": 1.5},
        {"capacity change": 10.0, "loss change": 0.04, "loss_growth after": 2e-3,
         "loss_growth before": 2e-3, "zero after": 0.3, "power_error after": 0.02},
        {"wave": 2.0, "loss_growth": 2e-3},
    ),
    "walker": Kind(
        None, "", 0.0, 0.0, {"contact.kinetic_friction": 0.145, "drag.linear": 1.2e-5},
        {"contact.kinetic_friction change": 0.01, "drag.linear change": 2e-6,
         "surface_tilt after": 0.01, "surface_tilt before": 0.01, "velocity_offset after": 3e-5},
        {"friction_anisotropy": 0.05, "surface_tilt": 0.02},
    ),
}  # fmt: skip
ORDER = ("joint", "axis", "thermal", "joint", "axis", "thermal", "joint", "walker")
DRIVES = [(way, f) for way in ("+x", "-x") for f in (25.0, 40.0, 60.0, 90.0)]
_NAMES = {"friction_anisotropy": "fraction", "surface_tilt": "angle"}


def _moved(kind: str, t: Array, u: Array, p: dict[str, float]) -> Array:
    """Readings of a machine, by Euler's method."""
    of, h = KINDS[kind], (t[1] - t[0]) / FINE
    x, v, seen = 0.0, p.get("start", 0.0), []
    for k, acts in enumerate(u.tolist()):
        seen.append(v if kind != "axis" else x)
        for part in range(FINE if k + 1 < len(u) else 0):
            if kind == "thermal":
                wave = p.get("wave", 0.0) * math.sin(4.0 * math.pi * (t[k] + part * h) / t[-1])
                power = acts * (1.0 + p.get("power_error", 0.0)) + wave
                lost = p["loss"] * v + p.get("loss_growth", 0.0) * v * abs(v)
                v += h * (power - lost) / p["capacity"]
                continue
            dead = p.get("dead_zone", 0.0)
            force = acts - math.copysign(min(abs(acts), dead), acts)
            force -= p["coulomb"] * math.tanh(v / 1e-3) + p.get("load", 0.0) + p["viscous"] * v
            force -= p.get("quadratic", 0.0) * v * abs(v)
            force -= p.get("ripple", 0.0) * math.sin(x / (0.05 if kind == "axis" else 1.0))
            v += h * force / p[next(iter(of.constants))]
            x += h * v
    return np.array(seen) * (1.0 + p.get("scale", 0.0)) + p.get("zero", 0.0)


def _walked(_: str, t: Array, u: Array, p: dict[str, float]) -> Array:
    """Velocities of a walker at `DRIVES`, m/s, by the reference simulator."""
    effects = {name: {word: p[name]} for name, word in _NAMES.items() if p.get(name)}
    sections: dict[str, dict[str, float]] = {"contact": {}, "drag": {}}
    for key in KINDS["walker"].constants:
        section, _, name = key.partition(".")
        sections[section][name] = p[key]
    found = [
        simulate_reference(
            {"base": 5e-4, "pulses": 6, "direction": way, "frequency": f}, None,
            sections["contact"], sections["drag"], effects, STEP,
        ).mean_velocity for way, f in DRIVES
    ]  # fmt: skip
    return np.array(found) + p.get("velocity_offset", 0.0)


def made(seed: int) -> tuple[Row, list[Any], Any]:
    """What is hidden, both sides, and the model of logs or what is uncertain of a walker."""
    draw = np.random.default_rng([47, seed])
    kind = ORDER[seed % len(ORDER)]
    of, moved = KINDS[kind], _walked if kind == "walker" else _moved
    name = "" if draw.random() < 0.25 else str(draw.choice(list(of.changes)))
    error = str(draw.choice(list(of.errors))) if draw.random() < 0.5 else ""
    alike = kind == "walker" or bool(draw.random() < 2 / 3)
    t = of.step * np.arange(COUNT)
    inputs = []
    for _ in range(2):
        stairs = of.size * np.repeat(draw.uniform(-1.0, 1.0, COUNT // STAIR), STAIR)
        inputs.append(np.abs(stairs) if kind == "thermal" else stairs)
    inputs = [inputs[0], inputs[0] if alike else inputs[1]]
    truth = {key: value * (1.0 + STATED * draw.standard_normal())
             for key, value in of.constants.items()}  # fmt: skip

    def both(p: dict[str, float], change: str = "", size: float = 0.0) -> Array:
        base, _, word = change.rpartition(" ")
        sides = [{**p, base: p.get(base, 0.0) + size} if change and word == side else p
                 for side in ("before", "after" if word != "change" else "change")]  # fmt: skip
        rows = [moved(kind, t, u, one) for u, one in zip(inputs, sides, strict=True)]
        return np.concatenate(rows)

    plain = both(truth)
    if kind == "walker":
        sd = np.abs(plain) * 0.02 / math.sqrt(3.0)
    else:
        sd = np.full(len(plain), float(np.std(plain)) * draw.uniform(*NOISE))
    slopes = [(both({**truth, key: value * 1.01}) - plain) / (0.01 * value) * STATED * value
              for key, value in truth.items()]  # fmt: skip
    if kind != "walker":
        begun = both({**truth, "start": 1e-2 * float(np.std(plain))}) - plain
        half = np.arange(len(plain)) < COUNT
        slopes += [100.0 * begun * half, 100.0 * begun * ~half]
    columns = np.vstack([np.array(slopes).T / sd[:, None], np.eye(len(slopes))])
    basis = np.linalg.qr(columns)[0]

    def strength(effect: Array) -> float:
        rows = np.concatenate([effect / sd, np.zeros(len(slopes))])
        return float(np.linalg.norm(rows - basis @ (basis.T @ rows)))

    if error:
        unit = of.errors[error]
        asked = draw.uniform(*ERROR) / strength(both({**truth, error: unit}) - plain)
        truth[error] = unit * asked
        plain = both(truth)
    size, s = 0.0, 0.0
    if name:
        asked = float(draw.uniform(*STRENGTH))
        size = of.changes[name] * (-1.0 if name.endswith("change") and draw.random() < 0.5 else 1.0)
        for _ in range(3):
            s = strength(both(truth, name, size) - plain)
            size *= asked / s
        plain = both(truth, name, size)
        s = asked
    answer = {"kind": kind, "change": name, "error": error, "alike": alike, "strength": s}
    if kind == "walker":
        return {**answer, "size": size}, _measurements(draw, plain), None
    read = np.split(plain + sd * draw.standard_normal(len(plain)), 2)
    assert of.model is not None
    model = of.model(**{key: (value, STATED * value) for key, value in of.constants.items()})
    logs = [Series(t, y, {of.input: u}, sd=float(sd[0]), unit=model.unit)
            for y, u in zip(read, inputs, strict=True)]  # fmt: skip
    return {**answer, "size": size}, logs, model


def _measurements(draw: np.random.Generator, plain: Array) -> list[Measurement]:
    uncertain = {key: Prior("normal", value, STATED * value)
                 for key, value in KINDS["walker"].constants.items()}  # fmt: skip
    scenario = Scenario().replace({"drive.base": 5e-4, "drive.pulses": 6})
    tables = [
        pd.DataFrame(
            {"direction": way, "frequency": f, "trial": k,
             "velocity": v * (1.0 + 0.02 * draw.standard_normal())}
            for (way, f), v in zip(DRIVES, side, strict=True) for k in range(3)
        ) for side in np.split(plain, 2)
    ]  # fmt: skip
    return [Measurement.from_dataframe(table, scenario, uncertain) for table in tables]


def judged(seed: int) -> Row:
    """What is hidden, and what the comparison, two absolute diagnoses and BIC say."""
    answer, (before, after), model = made(seed)
    begin = time.process_time()
    if model is None:
        found = diagnose(after, against=before, threads=1)
    else:
        found = diagnose_change(model, before, after)
    spent = time.process_time() - begin
    alone = [diagnose(one, threads=1) if model is None else diagnose_model(model, one)
             for one in (before, after)]  # fmt: skip
    others = 0.5 * (time.process_time() - begin - spent)
    paired = any(table.less is not None for table in found.problem.tables)
    return {
        **answer, "paired": paired, "verdict": found.verdict.kind,
        "causes": list(found.verdict.causes), "p": round(found.findings.test.p_value, 5),
        "absolute": _absolute(alone), "bic": _bic(found), "seconds": round(spent, 2),
        "seconds_of_one": round(others, 2),
    }  # fmt: skip


def _absolute(alone: Sequence[Diagnosis]) -> list[str]:
    """What two diagnoses say: causes that one has alone; else the constant that differs most."""
    if any(each.verdict.kind not in (*CLAIMS, "none") for each in alone):
        return ["unknown"]
    causes = [set(each.verdict.causes) for each in alone]
    said = [f"{name} before" for name in causes[0] - causes[1]]
    said += [f"{name} after" for name in causes[1] - causes[0]]
    constants = {parameter.name for parameter in alone[0].problem.constants
                 if parameter.cause or not parameter.name.startswith("start")}  # fmt: skip
    said = [f"{name.rpartition(' ')[0]} change" if name.rpartition(" ")[0] in constants else name
            for name in said]  # fmt: skip
    if said:
        return sorted(said)
    tables = [each.best.params for each in alone]
    apart = {
        name: abs(tables[0]["value"][name] - tables[1]["value"][name])
        / math.hypot(*(table["sd"][name] for table in tables))
        for name in constants & set(tables[0].index) & set(tables[1].index)
    }
    name = max(apart, key=lambda each: apart[each])
    return [f"{name} change"] if apart[name] > SURE else []


def _bic(found: Diagnosis) -> list[str]:
    """The single difference, or none, whose fit has the least of chi-square and k ln n."""
    fits = [fit for (names, form), fit in found.findings.models.best.items()
            if form == "exact" and len(names) < 2]  # fmt: skip
    count = math.log(len(found.problem.y))
    return sorted(min(fits, key=lambda fit: fit.chi2 + len(fit.free) * count).names)


def is_it(name: str, row: Row) -> bool:
    """Whether a cause is the hidden one; of differences of readings only the sign tells the side
    of what may have either."""
    if name == row["change"] or not row["paired"]:
        return name == row["change"]
    base, _, _ = name.rpartition(" ")
    return base == row["change"].rpartition(" ")[0] and base in ("surface_tilt", "velocity_offset")


def told(causes: Sequence[str], row: Row) -> str:
    """What an answer of causes is: right, wrong, missed, or sound where nothing changed.

    What both sides have is no change, and no error where both have it.
    """
    changes = [name for name in causes if not name.endswith(" both")]
    if not row["change"]:
        return "wrong" if changes else "right"
    if not changes:
        return "missed"
    return "right" if len(changes) == 1 and is_it(changes[0], row) else "wrong"


def of_ours(row: Row) -> str:
    """The same of a verdict, and `set` where a set of at most three has the truth.

    Where nothing changed, all is wrong but `none` and what both sides have: also a set, and a
    change that nobody lists.
    """
    if not row["change"] and row["verdict"] not in (*CLAIMS, "none"):
        return "wrong"
    if row["verdict"] in CLAIMS:
        return told(row["causes"], row)
    if row["verdict"] == "none":
        return told([], row)
    if row["verdict"] == "ambiguous":
        has = any(is_it(name, row) for name in row["causes"])
        return ("set" if len(row["causes"]) <= FEW else "larger set") if has else "other set"
    return "unexplained"


def table(rows: list[Row]) -> str:
    """Counts of ours, of two absolute diagnoses and of BIC, by what is hidden; and the time."""

    def share(count: int, of: int) -> str:
        return scores.share(count, of) if of else "-"

    groups: dict[str, list[Row]] = {"all": rows}
    groups |= {kind: [row for row in rows if row["kind"] == kind] for kind in KINDS}
    groups |= {
        "same inputs": [row for row in rows if row["paired"]],
        "other inputs": [row for row in rows if not row["paired"]],
        "model error": [row for row in rows if row["error"]],
        "no model error": [row for row in rows if not row["error"]],
    }
    found = []
    for name, some in groups.items():
        hidden = [row for row in some if row["change"]]
        rest = [row for row in some if not row["change"]]
        ours = [of_ours(row) for row in hidden]
        others = [[told(row[key], row) for row in hidden] for key in ("absolute", "bic")]
        false = [[told(row[key], row) for row in rest] for key in ("absolute", "bic")]
        said = [of_ours(row) for row in rest]
        found.append((
            name, len(hidden), len(rest), share(ours.count("right"), len(ours)),
            share(ours.count("right") + ours.count("set"), len(ours)),
            share(ours.count("wrong"), len(ours)),
            *(share(each.count("right"), len(each)) for each in others),
            *(share(each.count("wrong"), len(each)) for each in others),
            share(said.count("wrong"), len(said)),
            *(share(each.count("wrong"), len(each)) for each in false),
        ))  # fmt: skip
    heads = (
        "pairs;changed;unchanged;named;named or in a set of 3;wrong;right by two diagnoses;"
        "right by BIC;wrong by two;wrong by BIC;a change where none is;by two;by BIC"
    )
    ratio = float(np.median([row["seconds"] / row["seconds_of_one"] for row in rows]))
    whole = sum(row["seconds"] for row in rows) / sum(row["seconds_of_one"] for row in rows)
    spent = sum(row["cpu_seconds"] for row in rows)
    cost = f"CPU of a pair over that of one log: median {ratio:.2f}, of all {whole:.2f}."
    return f"{markdown(heads, found)}\n\n{cost} {spent:.0f} CPU s."
