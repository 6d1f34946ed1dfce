"""The study of late inputs: logs whose input acts by a part of a step up to three steps late.

A joint, an axis or a heater has an input that is held between two readings, or a line. The delay is
listed beside a load or another power. What is said of it is compared with the truth, and its error
with that of a fit that is told all but the numbers: of its constants, start, delay and the input
before the record, by changes of an integrator of its own at the truth.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.stats import chi2
from scores import markdown, share

from stickslip import Series, diagnose_model, models

Row = dict[str, Any]
Array = np.ndarray
COUNT, STAIR = 300, 15  # readings, and of them between two changes of a held input
DELAYS = 0.1, 3.0  # in steps
NOISE = 1e-3, 3e-3  # over the readings' scatter
STATED = 0.05  # relative errors of constants
BEFORE, START = 0.5, 10.0  # errors of the part before, and of a start, which is hardly known
FINE, SLOPE_STEP = 40, 1e-4  # parts of a step of the own integrator; of a number
KINDS = (
    ("joint", "torque", 0.005, (0.1, 0.4, 0.1), ("inertia", "viscous", "coulomb")),
    ("axis", "command", 0.01, (2.0, 8.0, 0.1), ("mass", "viscous", "coulomb")),
    ("thermal", "power", 5.0, (2000.0, 8.0), ("capacity", "loss")),
)
"""Kind, input, step (s), and its inertia, friction and dry friction, by their names there."""
REACH, WIDER = 1.2, 1.5  # asked: rms of z, median width over that of the fit, at most


def _true(place: bool, t: Array, u: Array, line: bool, p: Array) -> Array:
    """Readings of ``inertia v' = u - viscous v - coulomb sign(v)``: v, or its place.

    p: late, before, x, v, inertia, viscous, and perhaps coulomb. Steps are exact where the input is
    held.
    """
    late, before, x, v, inertia, viscous, dry = [*p, 0.0][:7]
    ends = np.unique(np.r_[np.linspace(t[0], t[-1], (len(t) - 1) * FINE + 1), t, t + late])
    ends = ends[(ends >= t[0]) & (ends <= t[-1])]
    at = 0.5 * (ends[1:] + ends[:-1]) - late
    acts = np.interp(at, t, u) if line else u[np.clip(np.searchsorted(t, at) - 1, 0, None)]
    found, rate = [(v, x)], viscous / inertia
    for h, force in zip(np.diff(ends), np.where(at < t[0], before * u[0], acts), strict=True):
        while h > 0.0:
            sign = np.sign(v) or np.sign(force) * (abs(force) > dry)
            if not sign:
                break
            aim = (force - sign * dry) / viscous
            stops = math.log(1.0 - v / aim) / rate if v * aim < 0.0 else math.inf
            part = min(h, stops)
            kept = math.exp(-rate * part)
            x += aim * part + (v - aim) * (1.0 - kept) / rate
            v = 0.0 if stops <= h else aim + (v - aim) * kept
            h -= part
        found.append((v, x))
    return np.array(found)[np.searchsorted(ends, t), int(place)]


def made(seed: int) -> tuple[Row, models.Model, Series]:
    """The truth with the width of the told fit, a model, and its log."""
    draw, line = np.random.default_rng([77, seed]), bool(seed % 2)
    kind, name, step, constants, names = KINDS[seed // 2 % len(KINDS)]
    t = step * np.arange(COUNT)
    late = step * math.exp(draw.uniform(*np.log(DELAYS)))
    if line:
        waves = draw.uniform([[0.4], [2.0], [0.0]], [[1.0], [8.0], [6.0]], (3, 3))
        u = sum(a * np.sin(2.0 * np.pi * f * t / t[-1] + phase) for a, f, phase in waves.T)
    else:
        u = np.repeat(draw.uniform(-1.0, 1.0, COUNT // STAIR), STAIR)
    u = 100.0 * np.abs(u) if kind == "thermal" else u
    p = np.array([late, 0.0, 0.0, 0.0, *constants])
    seen = _true(kind == "axis", t, u, line, p)
    sd = float(np.std(seen)) * draw.choice(NOISE)
    known = {key: (value, STATED * value) for key, value in zip(names, constants, strict=True)}
    model = getattr(models, kind)(smooth=line, **known)
    record = Series(t, seen + sd * draw.normal(size=COUNT), {name: u}, sd=sd, unit=model.unit)
    steps = SLOPE_STEP * np.where(p, p, 1.0)
    moves = [(_true(kind == "axis", t, u, line, p + one) - seen) / one.sum() / sd
             for one in np.diag(steps)]  # fmt: skip
    prior = 1.0 / np.array([np.inf, BEFORE, START, START, *(STATED * np.array(constants))])
    fit = np.vstack([np.array(moves).T, np.diag(prior)])
    width = math.sqrt(np.linalg.inv(fit.T @ fit)[0, 0])
    truth = {"kind": kind, "input": "line" if line else "held", "late": late, "width": width}
    return truth, model, record


def judged(seed: int) -> Row:
    """The truth of a log, the error of the told delay in its sd, and its sd over the fit's."""
    truth, model, record = made(seed)
    uncertain, causes = model.terms(record)
    late = next(each.name for each in causes if each.name.startswith("late "))
    listed = [each for each in causes if each.name in (late, "load", "power_error")]
    found = diagnose_model(model, record, uncertain, listed)
    if late not in found.verdict.causes:
        return truth
    told = found.params.loc[f"{late}.time"]
    z, wider = (told["value"] - truth["late"]) / told["sd"], told["sd"] / truth["width"]
    return {**truth, "z": round(float(z), 3), "wider": round(float(wider), 3)}


def table(rows: list[Row]) -> str:
    """Table by kind of input: how many delays are told, how far off, and how much wider."""
    found = []
    for kind in sorted({row["input"] for row in rows}):
        own = [row for row in rows if row["input"] == kind]
        z, wider = np.array([(row["z"], row["wider"]) for row in own if "z" in row]).T
        rms, near = math.sqrt(np.mean(z**2)), int(np.sum(np.abs(z) < 2.0))
        low, high = (rms * math.sqrt(len(z) / chi2.ppf(part, len(z))) for part in (0.975, 0.025))
        found.append((kind, f"{len(z)} of {len(own)}", f"{rms:.2f} ({low:.2f} to {high:.2f})",
                      share(near, len(z)), f"{np.median(wider):.2f}"))  # fmt: skip
    heads = "input;told;rms of z (95 %);within two errors (95 %);median width over the fit's"
    seconds = sum(row["cpu_seconds"] for row in rows)
    asked = f"Asked: an rms of z of {REACH} and a width of {WIDER} at most."
    return f"{markdown(heads, found)}\n\n{asked} {seconds:.0f} CPU s."
