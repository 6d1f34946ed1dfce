"""The study of what changed: pairs of logs, or of measurements of a walker, with one difference.

A quarter has no difference, and in half both sides have an error of the model: of a log an uneven
scale or a drift, of a walker a smooth one. Of three pairs of logs two have the same inputs on both
sides. Machines and walkers are those of the benchmark of causes, where dry friction of a joint or
an axis is a constant; as there, a difference is so many errors of a reading, here after the refit
of what both sides share. Beside what `diagnose_change` says stand two absolute diagnoses, and the
least of BIC over single differences.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import scores
from causes import walkers
from causes.make import KINDS, STRENGTH, simulated
from scores import CLAIMS, Answer, markdown, share

import stickslip
from blind.kinds import ERROR_SHARE
from blind.own import COUNT, MACHINES, MODEL_ERRORS, NOISE, SERVO, _error, refitted
from blind.readings import velocities
from blind.settings import PULSES
from blind.truth import Hidden, Truth
from stickslip import Diagnosis, Measurement, Prior, Scenario, Series, models
from stickslip._util.arrays import root_mean_square

Row = dict[str, Any]
Array = np.ndarray
ORDER = ("joint", "axis", "thermal", "servo", "joint", "axis", "thermal", "walker")
DRY = 0.2  # error of dry friction as a constant
TRIES, NEAR = 8, 0.1  # simulations by which a difference gets its strength, and how nearly
COARSE = 1e-5  # s, of the simulator of walkers, whose trials scatter by 3 %
SLOPE_STEP, SURE = 1e-3, 3.0  # of a constant; errors of a constant that two diagnoses tell


def _log(kind: str, alike: bool, draw: np.random.Generator) -> SimpleNamespace:
    """A machine: what is true, what is refitted by steps, differences, and readings of a side."""
    own = KINDS[kind]
    stated = dict(own["constants"])
    if kind in ("joint", "axis"):
        stated["coulomb"] = own["hidden"]["coulomb"], DRY
    t, name = own["step"] * np.arange(COUNT), own["input"].partition(" (")[0]
    inputs = [np.repeat(draw.uniform(-1.0 + (kind == "thermal"), 1.0, 12), COUNT // 12)
              * MACHINES.get(kind, SERVO) for _ in range(2)]  # fmt: skip
    inputs[1] = inputs[0] if alike else inputs[1]
    base = {key: value * (1.0 + part * draw.standard_normal())
            for key, (value, part) in stated.items()}  # fmt: skip
    base |= {**own["known"], "start": 293.0 if kind == "thermal" else 0.0}
    wrong, phase = str(draw.choice(MODEL_ERRORS)), int(draw.integers(2**31))

    def pair(seen: list[Array]) -> tuple[Any, Any, Any]:
        known = {key: (value, part * value) for key, (value, part) in stated.items()}
        model = getattr(models, kind)(without=own["without"], **known, **own["known"])
        unit = own["reads"].rstrip(")").split(" (")[1]
        logs = [Series(t, y, {name: u}, unit=unit) for y, u in zip(seen, inputs, strict=True)]
        return (*logs, model)

    return SimpleNamespace(
        base=base, pair=pair,
        shared={key: SLOPE_STEP * base[key] or SLOPE_STEP for key in (*stated, "start")},
        changes={**own["hidden"], **{key: 0.2 * base[key] for key in stated}},
        read=lambda k, p: simulated(kind, p, t, inputs[k]),
        error=lambda seen: _error(wrong, t, seen, np.random.default_rng(phase)),
        errors=lambda seen: np.full(len(seen), NOISE * float(np.std(seen))),
    )  # fmt: skip


def _walker(draw: np.random.Generator) -> SimpleNamespace:
    drives, stated = walkers.drives()[:6], walkers.STATED
    base = {key: float(prior.value(draw.standard_normal())) for key, prior in stated.items()}
    number = float(draw.integers(2**31))
    usual = {key: {**walkers.entry(key).fixed, **walkers.entry(key).sizes[0]}
             for key in walkers.HIDDEN}  # fmt: skip

    def read(k: int, p: dict[str, float]) -> Array:
        hidden = {key: Hidden(p[key], usual[key]) for key in usual if p.get(key)}
        if "wrong" in p:
            hidden["smooth_error"] = Hidden(p["wrong"], {"number": number})
        constants = {key: p[key] for key in stated}
        return velocities(Truth("walker", (), constants, hidden), drives, COARSE)

    def pair(seen: list[Array]) -> tuple[Any, Any, Any]:
        sides, priors = [], {key: Prior(one.kind, one.first, one.second)
                             for key, one in stated.items()}  # fmt: skip
        for level in seen:
            rows = [{"velocity": v + s * draw.standard_normal(), "trial": k, **drive}
                    for v, s, drive in zip(level, errors(level), drives, strict=True)
                    for k in range(walkers.TRIALS)]  # fmt: skip
            nominal = Scenario().replace({"drive.pulses": PULSES})
            sides.append(Measurement.from_dataframe(pd.DataFrame(rows), nominal, priors))
        return (*sides, None)

    def errors(level: Array) -> Array:
        return np.hypot(walkers.SCATTER * level, walkers.FLOOR)

    return SimpleNamespace(
        base=base, shared={key: 10.0 * SLOPE_STEP * value for key, value in base.items()},
        changes={**{key: 0.1 * value for key, value in base.items()}, **dict.fromkeys(usual, 1.0)},
        error=lambda seen: read(0, {**base, "wrong": 1.0}) - read(0, base),
        read=read, errors=errors, pair=pair,
    )  # fmt: skip


def made(seed: int) -> tuple[Row, Any, Any, Any]:
    """What is hidden, both sides, and the model of logs."""
    draw, kind = np.random.default_rng([47, seed]), ORDER[seed % len(ORDER)]
    changed, bent = draw.random() >= 0.25, bool(draw.random() < 0.5)
    alike = kind == "walker" or bool(draw.random() < 2 / 3)
    of = _walker(draw) if kind == "walker" else _log(kind, alike, draw)

    def both(p: dict[str, float]) -> Array:
        one = of.read(0, p)
        return np.array([one, one if alike else of.read(1, p)])

    plain = both(of.base)
    sd = np.array([of.errors(level) for level in plain])
    moves = []
    for key, step in of.shared.items():
        each = (both({**of.base, key: of.base[key] + step}) - plain) / sd
        # Each side has a start of its own.
        moves += [each * [[1], [0]], each * [[0], [1]]] if key == "start" else [each]
    columns = np.array(moves).reshape(len(moves), -1).T

    def strength(level: Array) -> float:
        return root_mean_square(refitted(((level - plain) / sd).ravel(), columns))

    wanted, name, found, level = draw.uniform(*STRENGTH), "", 0.0, plain
    for key in draw.permutation([*of.changes]).tolist() if changed else []:
        constant = key in of.base
        size = of.changes[key] * (draw.choice([-1.0, 1.0]) if constant else 1.0)
        side = 1 if constant else int(draw.integers(2))
        for _ in range(TRIES):
            level = plain.copy()
            level[side] = of.read(side, {**of.base, key: of.base.get(key, 0.0) + size})
            found, name = strength(level), f"{key}[{('before', 'after')[side]}]"
            if abs(found / wanted - 1.0) < NEAR:
                break
            # What is beyond a limit acts as the limit falls.
            power = -0.7 if key == "saturation" else 0.7
            size *= float(np.clip(wanted / max(found, 1e-3), 0.5, 2.0)) ** power
            size = max(size, -0.9 * of.base.get(key, math.inf))
        if abs(found / wanted - 1.0) < NEAR:
            break  # some cannot be as strong: dry friction stops the machine first
    if bent:
        wrong = np.array([of.error(each) for each in level])
        wrong *= draw.uniform(*ERROR_SHARE) * wanted / strength(plain + wrong)
        level = level + wrong
    if kind != "walker":
        level = level + sd * draw.standard_normal(level.shape)
    row = {"kind": kind, "change": name, "error": bent, "alike": alike, "strength": round(found, 2)}
    return (row, *of.pair([*level]))


def judged(seed: int) -> Row:
    """What is hidden, and what the comparison, two absolute diagnoses and BIC say."""
    row, before, after, model = made(seed)
    begin = time.process_time()
    if model is None:
        found = stickslip.diagnose(after, against=before, threads=1)
    else:
        found = stickslip.diagnose_change(model, before, after)
    spent = time.process_time() - begin
    of_one = partial(stickslip.diagnose, threads=1)
    alone = [(of_one if model is None else partial(stickslip.diagnose_model, model))(log)
             for log in (before, after)]  # fmt: skip
    others = 0.5 * (time.process_time() - begin - spent)
    if row["change"] not in {cause.name for cause in found.problem.causes} | {""}:
        # Of differences of readings the earlier side has the later one's causes, of other sign.
        row["change"] = row["change"].replace("[before]", "[after]")
    return {
        **row, "verdict": found.verdict.kind, "causes": list(found.verdict.causes),
        "p": round(found.findings.test.p_value, 5), "absolute": _absolute(alone),
        "bic": _bic(found), "seconds": round(spent, 2), "seconds_of_one": round(others, 2),
    }  # fmt: skip


def _absolute(alone: Sequence[Diagnosis]) -> list[str]:
    """What two diagnoses say: causes that one has alone; else the constant that differs most."""
    if any(each.verdict.kind not in (*CLAIMS, "none") for each in alone):
        return []
    one, two = (set(each.verdict.causes) for each in alone)
    constants = {each.name for each in alone[0].problem.constants if each.cause}
    said = {f"{name}[{'after' if name in two | constants else 'before'}]" for name in one ^ two}
    if said:
        return sorted(said)
    tables = [each.best.params for each in alone]
    apart = {name: abs(float(np.diff([table["value"][name] for table in tables])[0]))
             / math.hypot(*(table["sd"][name] for table in tables))
             for name in constants}  # fmt: skip
    name = max(apart, key=lambda each: apart[each])
    return [f"{name}[after]"] if apart[name] > SURE else []


def _bic(found: Diagnosis) -> list[str]:
    """The single difference, or none, whose fit has the least of chi-square and k ln n."""
    fits = [fit for (names, form), fit in found.findings.models.best.items()
            if form == "exact" and len(names) < 2]  # fmt: skip
    count = math.log(len(found.problem.y))
    return sorted(min(fits, key=lambda fit: fit.chi2 + len(fit.free) * count).names)


def answer(row: Row, whose: str = "causes") -> Answer:
    """What is said beside what is hidden; what both sides have is no difference.

    Without one any verdict but `none` counts as a change, but what both sides have, and what is
    unexplained with other inputs: of that the verdict says that both sides may have it.
    """
    said = [name for name in row[whose] if "[" in name]
    verdict = row["verdict"] if whose == "causes" else "named" if said else "none"
    if verdict in (*CLAIMS, "ambiguous") and not said:
        verdict = "none"
    if not row["change"] and verdict == "unexplained" and row["alike"]:
        verdict, said = "ambiguous", ["?"]
    return Answer(verdict, said, [row["change"]] if row["change"] else [])


def table(rows: list[Row]) -> str:
    """Counts of ours, and of the others, by what is hidden; and the time."""
    groups = {"all": rows}
    groups |= {kind: [row for row in rows if row["kind"] == kind] for kind in dict.fromkeys(ORDER)}
    for key, words in {"alike": ("same inputs", "other inputs"),
                       "error": ("model error", "no model error")}.items():  # fmt: skip
        groups |= {word: [row for row in rows if row[key] != bool(k)]
                   for k, word in enumerate(words)}  # fmt: skip
    of_all = {f"{name}: {'one difference' if some else 'none'}":
              [answer(row) for row in own if bool(row["change"]) == some]
              for name, own in groups.items() for some in (True, False)}  # fmt: skip
    found = []
    for name, whose in {"ours": "causes", "two diagnoses": "absolute", "BIC": "bic"}.items():
        every = [answer(row, whose).outcome for row in rows if row["change"]]
        rest = [answer(row, whose).outcome for row in rows if not row["change"]]
        right, sets = every.count("right name"), every.count("right set")
        false = len(rest) - rest.count("rightly silent")
        found.append((name, *(share(k, max(len(every), 1)) for k in
                              (right, right + sets, every.count("wrong name"))),
                      share(false, max(len(rest), 1))))  # fmt: skip
    heads = "by;named;named or in a set of 3;wrong;a change where none is"
    ratio = [row["seconds"] / row["seconds_of_one"] for row in rows]
    whole = sum(row["seconds"] for row in rows) / sum(row["seconds_of_one"] for row in rows)
    cost = f"CPU of a pair over that of one log: median {np.median(ratio):.2f}, of all {whole:.2f}."
    open_ = sum(row["verdict"] == "unexplained" and not row["change"] for row in rows)
    beside = f"{open_} pairs without a difference are unexplained: both sides may have an error."
    parts = scores.table(of_all), markdown(heads, found), f"{len(rows)} pairs. {beside} {cost}"
    return "\n\n".join(parts)
