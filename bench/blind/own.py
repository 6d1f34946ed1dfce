"""The study of models of one's own: logs of machines and tables of a line, each diagnosed once.

A log comes from the integrator of the benchmark of causes, its readings with independent,
correlated or coarse errors, none of which is stated. A line has two repeats at six places. The
cause that is hidden is listed or not. Rows are appended to a file as they come.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from causes.make import KINDS, simulated

from blind.scoring import interval, markdown
from blind.study import append, lines, state
from stickslip import Cause, Diagnosis, Parameter, Prior, Series, Table, diagnose_model, models

Row = dict[str, Any]
Array = np.ndarray
MACHINES = {"joint": 0.12, "axis": 2.0, "oscillator": 4.0, "thermal": 60.0}
"""Sizes of their inputs."""
FIRST = 31000  # seeds; nobody has seen them
COUNT = 120  # readings of a log
NOISE, STRENGTH = 0.02, (4.0, 9.0)  # of the readings' scatter, and of a cause's effect in errors
CORRELATION, STEP = 0.7, 2.0  # of neighbours; of a coarse meter, in errors
PLACES = np.repeat(np.linspace(1.0, 6.0, 6), 2)
HIDDEN = ("none", "listed", "listed", "unlisted")
ERRORS = ("white", "correlated", "coarse")

# What is hidden: what is counted, the limit, whether it is at most that, and the fewest sets that
# are judged; see the demands of the study of walkers.
DEMANDS = (
    ("none", "false alarm", 0.05, True, 60), ("none", "named, a pair or dominant", 0.02, True, 60),
    ("listed", "right", None, False, 40), ("listed", "right or in the set", 0.95, False, 40),
    ("listed", "wrongly named", 0.01, True, 40), ("listed", "unexplained", None, True, 40),
    ("unlisted", "wrongly named", 0.03, True, 30), ("unlisted", "dominant", 0.10, True, 30),
)  # fmt: skip


def _shapes(x: Array) -> dict[str, Array]:
    return {"bend": (x - 3.5) ** 2, "step": (x > 3.5) * 1.0, "wave": np.sin(4.0 * x)}


def _line(table: Table, p: Any) -> Array:
    x = table["x"]
    shapes = _shapes(x).items()
    return p["slope"] * x + sum(p.get(f"{name}.size", 0.0) * each for name, each in shapes)


def _scaled(change: Array, wanted: float) -> float:
    return wanted / max(float(np.sqrt(np.mean(change**2))), 1e-12)


def line(hidden: str, draw: np.random.Generator) -> tuple[str, Diagnosis]:
    """The cause that is hidden in a table of a line, and what is said of it."""
    cause = "" if hidden == "none" else str(draw.choice(["bend", "step", "wave"]))
    y = draw.normal(1.0, 0.1) * PLACES + 0.1 * draw.standard_normal(len(PLACES))
    if cause:
        effect = _shapes(PLACES)[cause]
        beside = effect - PLACES * (PLACES @ effect) / (PLACES @ PLACES)
        y = y + effect * _scaled(beside, 0.1 * draw.uniform(2.0, 4.0))
    offered = [name for name in _shapes(PLACES) if hidden == "listed" or name != cause]
    causes = [Cause(each, Parameter(f"{each}.size", size=0.2, low=-5.0, high=5.0))
              for each in offered]  # fmt: skip
    slope = Parameter("slope", Prior("normal", 1.0, 0.1), cause=False)
    return cause, diagnose_model(_line, Table({"x": PLACES}, y), [slope], causes)


def log(kind: str, hidden: str, errors: str, draw: np.random.Generator) -> tuple[str, Diagnosis]:
    """The cause that is hidden in a log of a machine, and what is said of it."""
    own = KINDS[kind]
    t = own["step"] * np.arange(COUNT)
    u = MACHINES[kind] * np.repeat(draw.uniform(0.0 if kind == "thermal" else -1.0, 1.0, 12), 10)
    base = {name: value * (1.0 + part * draw.standard_normal())
            for name, (value, part) in own["constants"].items()}  # fmt: skip
    base |= {**own["known"], "start": 293.0 if kind == "thermal" else 0.0}
    seen = simulated(kind, base, t, u)
    sd = NOISE * float(np.std(seen))
    cause, wanted = "", draw.uniform(*STRENGTH) * sd
    if hidden != "none":
        cause, plain = str(draw.choice([*own["hidden"]])), seen
        size = own["hidden"][cause]
        for _ in range(6):
            seen = simulated(kind, {**base, cause: size}, t, u)
            # What is beyond a limit acts as the limit falls.
            power = -0.7 if cause == "saturation" else 0.7
            size *= np.clip(_scaled(seen - plain, wanted), 0.4, 2.5) ** power
    noise = draw.standard_normal(COUNT)
    if errors == "correlated":
        for k in range(1, COUNT):
            noise[k] = CORRELATION * noise[k - 1] + np.sqrt(1.0 - CORRELATION**2) * noise[k]
    seen = seen + sd * noise
    if errors == "coarse":
        seen = STEP * sd * np.round(seen / (STEP * sd))
    known = {name: (value, part * value) for name, (value, part) in own["constants"].items()}
    without = [*own["without"], *([cause] if hidden == "unlisted" else [])]
    model = getattr(models, kind)(without=without, **known, **own["known"])
    name = own["input"].partition(" (")[0]
    record = Series(t, seen, {name: u}, unit=own["reads"].rstrip(")").split(" (")[1])
    return cause, diagnose_model(model, record)


def sets() -> Iterator[tuple[str, str, str]]:
    """Kind, what is hidden, and errors; every second set is of the line."""
    machines = itertools.cycle(itertools.product(HIDDEN, ERRORS, MACHINES))
    for hidden in itertools.cycle(HIDDEN):
        yield "line", hidden, "few repeats"
        of_log, errors, kind = next(machines)
        yield kind, of_log, errors


def study(path: Path, minutes: float, most: int) -> None:
    """Diagnose sets that the present engine has no row of, and print the counts."""
    now, end = state(), time.monotonic() + 60.0 * minutes
    rows = [row for row in lines(path) if row["state"]["engine"] == now["engine"]]
    done = {row["seed"] for row in rows}
    for seed, (kind, hidden, errors) in zip(range(FIRST, FIRST + most), sets(), strict=False):
        if seed in done:
            continue
        if time.monotonic() > end:
            break
        draw, begin = np.random.default_rng([7, seed]), time.process_time()
        cause, found = line(hidden, draw) if kind == "line" else log(kind, hidden, errors, draw)
        verdict = found.verdict
        rows.append({
            "seed": seed, "kind": kind, "hidden": hidden, "errors": errors, "cause": cause,
            "verdict": verdict.kind, "causes": list(verdict.causes),
            "p_value": found.findings.test.p_value, "state": now,
            "cpu_seconds": round(time.process_time() - begin, 2),
        })  # fmt: skip
        append(path, rows[-1])
    print(tables(rows))


def counts(row: Row, what: str) -> bool:
    """Whether a set counts as what a demand is about."""
    verdict, claimed = row["verdict"], row["verdict"] in ("named", "pair")
    right = (claimed or verdict == "dominant") and row["causes"] == [row["cause"]]
    return {
        "false alarm": verdict != "none",
        "named, a pair or dominant": claimed or verdict == "dominant",
        "right": right,
        "right or in the set": right or (verdict == "ambiguous" and row["cause"] in row["causes"]),
        "wrongly named": claimed and not right,
        "unexplained": verdict == "unexplained",
        "dominant": verdict == "dominant",
    }[what]


def tables(rows: list[Row]) -> str:
    """Counts of logs and lines beside what is asked."""
    found = []
    for where, own in (
        ("lines, few repeats", ["few repeats"]),
        ("logs", ["white", "coarse"]),
        ("logs, correlated", ["correlated"]),
    ):
        mine = [row for row in rows if row["errors"] in own]
        for hidden, what, asked, at_most, fewest in DEMANDS:
            # Errors that are alike along a run may be found; they must not be named.
            asked = None if "correlated" in own and what == "false alarm" else asked
            some = [counts(row, what) for row in mine if row["hidden"] == hidden]
            if not some:
                continue
            low, high = interval(sum(some), len(some))
            limit, met = "-", "-"
            if asked is not None:
                limit = f"at {'most' if at_most else 'least'} {asked:.0%}"
                fine = low <= asked if at_most else high >= asked
                met = "not judged" if len(some) < fewest else "yes" if fine else "no"
            found.append((where, hidden, what, f"{sum(some)} of {len(some)}",
                          f"{low:.0%} to {high:.0%}", limit, met))  # fmt: skip
    heads = "data;hidden;counted;count;95 % interval;asked;met"
    seconds = [row["cpu_seconds"] for row in rows if row["kind"] != "line"] or [0.0]
    cost = f"A log took {np.median(seconds):.1f} CPU s in the median, {max(seconds):.0f} at most."
    return f"{markdown(heads, found)}\n\n{len(rows)} sets. {cost}"
