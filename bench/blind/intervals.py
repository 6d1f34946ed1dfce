"""The study of intervals beside a discrepancy: whether they hold a cause's size, and how wide.

A motion of the study of twins has one cause, listed with those that act unlike it, and beside it an
error of the model: smooth or correlated along the record, or a force that ripples with the state.
Widths stand beside that of a fit that is told the structure: which cause acts, and the covariance
that errors of this kind and size have.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scores import interval, markdown

from blind.kinds import ALIKE, ERROR_SHARE
from blind.own import refitted
from blind.twins import COUNT, KINDS, SIZES, STRENGTH, Kind, listed, model_of, moves, solved
from stickslip import Cause, Diagnosis, Parameter, Series, diagnose_model

Row = dict[str, Any]
Array = np.ndarray
ERRORS = ("smooth", "correlated", "physical")
LENGTH = {"smooth": (0.05, 0.3), "correlated": (0.01, 0.1)}  # over the record
RIPPLES = 0.5, 6.0  # of a force over the range of the state
DRAWN = 40  # physical errors, whose mean covariance the told fit has
PULL = 1e-3  # a ripple's part of the largest acceleration: its effect is linear
LEVEL, HOLD, WIDER = 0.95, 0.90, 1.5  # of the intervals; asked: their share, median width at most


def _physical(kind: Kind, p: dict[str, float], t: Array, draw: np.random.Generator) -> Array:
    """Changes of what is read by a force that ripples with the state, of one size, (DRAWN, n)."""
    plain, found = solved(kind, p, t), []
    state = solved(kind._replace(read=0), p, t) if "x" in p else plain
    span, size = np.ptp(state), PULL * float(np.max(np.abs(np.gradient(plain, t))))
    for waves in np.exp(draw.uniform(*np.log(RIPPLES), DRAWN)):
        rate = _rippled(kind, size, 2.0 * math.pi * waves / span, draw.uniform(0.0, 6.3))
        found.append(solved(kind._replace(rate=rate), p, t) - plain)
    return np.array(found)


def _rippled(kind: Kind, size: float, wave: float, phase: float) -> Callable[..., Any]:
    def rate(x: Any, v: Any, t: Any, p: Any) -> Any:
        return kind.rate(x, v, t, p) + size * np.sin(wave * (x if "x" in p else v) + phase)

    return rate


def _error(
    errors: str, kind: Kind, p: dict[str, float], t: Array, draw: np.random.Generator
) -> tuple[Array, Array]:
    """A model error and the covariance that it was drawn from, both of no size yet."""
    if errors == "physical":
        every = _physical(kind, p, t, draw)
        every /= np.std(every, axis=1)[:, None]
        return every[0], every.T @ every / DRAWN
    length = t[-1] * math.exp(draw.uniform(*np.log(LENGTH[errors])))
    apart = np.abs(t[:, None] - t) / length
    cov = np.exp(-0.5 * apart**2 if errors == "smooth" else -apart) + 1e-9 * np.eye(len(t))
    return np.linalg.cholesky(cov) @ draw.standard_normal(len(t)), cov


def made(seed: int) -> tuple[Row, Series, list[Parameter], list[Cause]]:
    """The truth with the width of the told fit, the readings, constants and listed causes."""
    draw, name = np.random.default_rng([48, seed]), [*KINDS][seed % len(KINDS)]
    kind, errors = KINDS[name], ERRORS[seed // len(KINDS) % len(ERRORS)]
    hidden = [*kind.causes][seed // len(KINDS) // len(ERRORS) % len(kind.causes)]
    t = np.linspace(0.0, kind.duration, COUNT)
    base = {key: float(draw.normal(*prior)) for key, prior in kind.constants.items()}
    base |= dict.fromkeys(kind.causes, 0.0)
    size = kind.causes[hidden] * math.exp(draw.uniform(*np.log(SIZES)))
    acting = {**base, hidden: size}
    plain, seen = (solved(kind, each, t) for each in (base, acting))
    steps = {key: 0.01 * spread for key, (_, spread) in kind.constants.items()}
    columns = moves(kind, acting, t, steps)
    effects = {key: solved(kind, {**base, key: usual}, t) - plain
               for key, usual in kind.causes.items()}  # fmt: skip
    effect = refitted(seen - plain, columns)
    error, cov = _error(errors, kind, acting, t, draw)
    scale = draw.uniform(*ERROR_SHARE) * np.std(effect) / np.std(refitted(error, columns))
    sd = float(np.std(effect)) / math.exp(draw.uniform(*np.log(STRENGTH)))
    y = seen + scale * error + sd * draw.normal(size=COUNT)
    apart = {key: refitted(one, columns) for key, one in effects.items()}
    unlike = {key for key, one in apart.items()
              if key == hidden or abs(np.corrcoef(one, effect)[0, 1]) < ALIKE}  # fmt: skip
    every = np.column_stack([columns, moves(kind, acting, t, {hidden: 0.01 * size})])
    stated = np.diag([1.0 / spread**2 for _, spread in kind.constants.values()] + [0.0])
    whole = every.T @ np.linalg.solve(scale**2 * cov + sd**2 * np.eye(COUNT), every) + stated
    width = math.sqrt(np.linalg.inv(whole)[-1, -1])
    truth = {"kind": name, "cause": hidden, "error": errors, "size": size, "width": width}
    return truth, Series(t, y, sd=sd if seed % 2 else None), *listed(kind, unlike)


def diagnosed(seed: int) -> tuple[Row, Diagnosis]:
    """The truth of a set, and its diagnosis."""
    truth, record, uncertain, causes = made(seed)
    predict, absent = model_of(truth["kind"]), dict.fromkeys(KINDS[truth["kind"]].causes, 0.0)
    return truth, diagnose_model(
        lambda table, p: predict(table, {**absent, **p}), record, uncertain, causes
    )


def judged(seed: int) -> Row:
    """Whether the interval of the told model holds the hidden size, and how wide it is."""
    truth, found = diagnosed(seed)
    row = {**truth, "verdict": found.verdict.kind, "causes": list(found.verdict.causes)}
    if found.verdict.fit is None or truth["cause"] not in found.verdict.fit.names:
        return row
    low, high = found.conf_int(LEVEL).loc[truth["cause"], ["low", "high"]]
    wider = (high - low) / (2.0 * 1.959964 * truth["width"])
    return {**row, "form": found.verdict.fit.form, "z": round(
        float(truth["size"] - 0.5 * (low + high)) / (0.5 * float(high - low)), 3),
        "wider": round(float(wider), 3)}  # fmt: skip


def table(rows: list[Row]) -> str:
    """Table by kind of error: how many sizes are told, how many hold the truth, their width."""
    found = []
    for errors in (*ERRORS, ""):
        own = [row for row in rows if row["error"] == errors or not errors]
        told = [row for row in own if "z" in row]
        if not told:
            continue
        held = sum(abs(row["z"]) <= 1.0 for row in told)
        low, high = interval(held, len(told))
        found.append((errors or "any", f"{len(told)} of {len(own)}", f"{held} of {len(told)}",
                      f"{low:.0%} to {high:.0%}",
                      f"{np.median([row['wider'] for row in told]):.2f}"))  # fmt: skip
    heads = "error of the model;sizes told;hold the truth;95 % interval;median width over the fit's"
    asked = f"Asked: {HOLD:.0%} hold the truth, a width of {WIDER} at most."
    seconds = sum(row["cpu_seconds"] for row in rows)
    return f"{markdown(heads, found)}\n\n{asked} {seconds:.0f} CPU s."
