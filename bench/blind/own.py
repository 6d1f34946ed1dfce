"""The study of models of one's own: logs of machines and tables of a line, each diagnosed once.

A log comes from the integrator of the benchmark of causes, its readings with independent,
correlated or coarse errors, none of which is stated, or beside a model error: an uneven scale of
the sensor, or a drift. A line has two repeats at six places. The cause that is hidden is listed or
not; an unlisted cause may resemble a listed one. A cause that cannot have the wanted effect is
replaced by another one. Rows are appended to a file as they come.
"""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
from causes.make import KINDS, simulated
from scores import Answer, interval, markdown, table

from blind import seeds
from blind.kinds import ALIKE, ERROR_SHARE
from stickslip import Cause, Diagnosis, Parameter, Prior, Series, Table, diagnose_model, models
from stickslip.diagnosis.decision.posterior import cosine

Row = dict[str, Any]
Array = np.ndarray
MACHINES = {"joint": 0.12, "axis": 2.0, "oscillator": 4.0, "thermal": 60.0}
"""Sizes of their inputs."""
SERVO = 0.8  # size of the goals of servos
COUNT = 120  # readings of a log
NOISE, STRENGTH = 0.02, (4.0, 9.0)  # of the readings' scatter, and of a cause's effect in errors
WEAK = 6.0  # norm of an effect, in errors, after recalibration; as of the walkers
CORRELATION, STEP = 0.7, 2.0  # of neighbours; of a coarse meter, in errors
SLOPE_STEP = 1e-4  # of a constant; of a start that is 0, in its unit
DECADES, HALVINGS = 2.0, 12  # of the search for a cause's size about the usual one
PLACES = np.repeat(np.linspace(1.0, 6.0, 6), 2)
HIDDEN = ("none", "listed", "listed", "unlisted")
ERRORS = ("white", "correlated", "coarse", "uneven scale", "drift")
MODEL_ERRORS = ERRORS[3:]

# What is hidden: what is counted, the limit without and beside a model error, whether it is at most
# that, and the fewest sets that are judged; see the demands of the study of walkers.
DEMANDS = (
    ("none", "false alarm", 0.05, None, True, 60),
    ("none", "named, a pair or dominant", 0.02, 0.02, True, 60),
    ("listed", "right or in the set", 0.95, None, False, 40),
    ("listed", "right", None, 0.75, False, 40),
    ("listed", "wrongly named", 0.01, 0.03, True, 40),
    ("listed, weak", "wrongly named", 0.02, 0.03, True, 12),
    ("unlisted, unlike", "wrongly named", 0.03, 0.03, True, 30),
    ("unlisted, unlike", "dominant", 0.10, 0.10, True, 30),
)
FEWEST_BESIDE = 12  # sets with a model error


def _shapes(x: Array) -> dict[str, Array]:
    return {"bend": (x - 3.5) ** 2, "step": (x > 3.5) * 1.0, "wave": np.sin(4.0 * x)}


def _line(table: Table, p: Any) -> Array:
    x = table["x"]
    shapes = _shapes(x).items()
    return p["slope"] * x + sum(p.get(f"{name}.size", 0.0) * each for name, each in shapes)


def _scaled(change: Array, wanted: float) -> float:
    return wanted / max(float(np.sqrt(np.mean(change**2))), 1e-12)


def line(hidden: str, draw: np.random.Generator) -> tuple[str, Array, float, Diagnosis]:
    """The cause that is hidden in a table of a line, its effect, how far it stands out, and what is
    said of it."""
    effect = np.zeros(len(PLACES))
    cause = "" if hidden == "none" else str(draw.choice(["bend", "step", "wave"]))
    y = draw.normal(1.0, 0.1) * PLACES + 0.1 * draw.standard_normal(len(PLACES))
    if cause:
        effect = _shapes(PLACES)[cause]
        effect *= _scaled(refitted(effect, PLACES[:, None]), 0.1 * draw.uniform(2.0, 4.0))
        y = y + effect
    offered = [name for name in _shapes(PLACES) if hidden == "listed" or name != cause]
    causes = [Cause(each, Parameter(f"{each}.size", size=0.2, low=-5.0, high=5.0))
              for each in offered]  # fmt: skip
    slope = Parameter("slope", Prior("normal", 1.0, 0.1), cause=False)
    found = diagnose_model(_line, Table({"x": PLACES}, y), [slope], causes)
    seen = _stands_out(effect, PLACES[:, None], 0.1, 0.1)
    return cause, np.mean(effect.reshape(-1, 2), axis=1), seen, found


def log(
    kind: str, hidden: str, errors: str, draw: np.random.Generator
) -> tuple[str, Array, float, Diagnosis]:
    """The cause that is hidden in a log of a machine, its effect, how far it stands out, and what
    is said of it."""
    own = KINDS[kind]
    t = own["step"] * np.arange(COUNT)
    u = np.repeat(draw.uniform(0.0 if kind == "thermal" else -1.0, 1.0, 12), 10)
    u *= MACHINES.get(kind, SERVO)
    base = {name: value * (1.0 + part * draw.standard_normal())
            for name, (value, part) in own["constants"].items()}  # fmt: skip
    base |= {**own["known"], "start": 293.0 if kind == "thermal" else 0.0}
    seen = simulated(kind, base, t, u)
    sd = NOISE * float(np.std(seen))
    cause, wanted, plain = "", draw.uniform(*STRENGTH) * sd, seen
    for cause in draw.permutation([*own["hidden"]]).tolist() if hidden != "none" else []:
        seen, found = _sized(kind, cause, base, t, u, plain, wanted)
        if 0.9 * wanted < found < 1.1 * wanted:
            break  # some cannot be as strong: dry friction stops the machine first
    else:
        assert hidden == "none", f"{kind}: no cause has an effect of {wanted:.2g}"
    effect, part = seen - plain, draw.uniform(*ERROR_SHARE)
    steps = {name: SLOPE_STEP * base[name] or SLOPE_STEP for name in [*own["constants"], "start"]}
    moves = np.array([simulated(kind, {**base, name: base[name] + step}, t, u) - plain
                      for name, step in steps.items()]).T  # fmt: skip
    of_unit = np.array([math.prod(own["constants"].get(name, (math.inf,))) / step
                        for name, step in steps.items()])  # fmt: skip
    stands_out = _stands_out(effect, moves, of_unit, sd)
    if errors in MODEL_ERRORS:
        error = _error(errors, t, seen, draw)
        # What constants undo is no effect, and no error.
        left, wrong = (refitted(change, moves) for change in (effect, error))
        size = part * (float(np.sqrt(np.mean(left**2))) or wanted)
        seen = seen + _scaled(wrong, size) * error
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
    return cause, effect, stands_out, diagnose_model(model, record)


def _sized(
    kind: str, cause: str, base: dict[str, float], t: Array, u: Array, plain: Array, wanted: float
) -> tuple[Array, float]:
    """Readings with a cause of that size whose effect comes nearest to the wanted one, and it."""
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
    return seen, found


def _stands_out(effect: Array, moves: Array, size: float | Array, sd: float) -> float:
    """Norm of an effect in errors after recalibration, with what constants are moved for it.

    `moves` are changes by constants, whose priors have the standard deviation `size`.
    """
    prior = np.diag(np.full(moves.shape[1], 1.0) / size)
    columns = np.vstack([moves / sd, prior])
    return float(np.linalg.norm(refitted(np.append(effect / sd, np.zeros(len(prior))), columns)))


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


def likeness(found: Diagnosis, effect: Array) -> float:
    """Largest cosine of a hidden effect and that of a listed cause, beyond what constants undo.

    By changes of the model's predictions, not by what was fitted.
    """
    probes, null = found.findings.responses, found.findings.models.null
    changes = [change for each in probes for change in each.gaps]
    return max((abs(cosine(found.problem, null, effect, one)) for one in changes), default=0.0)


def plan(place: int) -> tuple[str, str, str]:
    """Kind, what is hidden, and errors of a set of a range; every second one is of the line."""
    turn, machine = divmod(place, 2)
    if not machine:
        return "line", HIDDEN[turn % len(HIDDEN)], "few repeats"
    every = [*itertools.product(HIDDEN, ERRORS, MACHINES)]
    hidden, errors, kind = every[turn % len(every)]
    return kind, hidden, errors


def of_seed(seed: int) -> Row:
    """The row of a seed, whose place in its range says what it is."""
    mine = seeds.of("own", seed)
    assert mine is not None, f"{seed}: in no range"
    return judged(seed, *plan(seed - mine.first))


def of_servo(seed: int) -> Row:
    """The row of a servo: a quarter hides nothing, a quarter has an uneven scale too."""
    parts = ("none", "white"), ("listed", "uneven scale"), ("listed", "white"), ("listed", "white")
    return judged(seed, "servo", *parts[seed % 4])


def judged(seed: int, kind: str, hidden: str, errors: str) -> Row:
    """The truth of a set, and its verdict."""
    draw = np.random.default_rng([7, seed])
    made = line(hidden, draw) if kind == "line" else log(kind, hidden, errors, draw)
    cause, effect, stands_out, found = made
    alike = likeness(found, effect) if hidden == "unlisted" else None
    return {
        "kind": kind, "hidden": hidden, "errors": errors, "cause": cause,
        "alike": alike and round(alike, 3), "strength": round(stands_out, 2),
        "verdict": found.verdict.kind, "causes": list(found.verdict.causes),
        "p_value": found.findings.test.p_value,
    }  # fmt: skip


def group(row: Row) -> str:
    """Kind of hidden cause: a listed one weak where constants leave little of it, an unlisted one
    alike where a listed one acts alike."""
    if row["alike"] is None:
        weak = row["hidden"] == "listed" and row["strength"] < WEAK
        return f"{row['hidden']}{', weak' * weak}"
    return f"{row['hidden']}, {'alike' if row['alike'] >= ALIKE else 'unlike'}"


def answer(row: Row) -> Answer:
    """The verdict beside the hidden cause, if that is listed."""
    return Answer(row["verdict"], row["causes"], [row["cause"]] * (row["hidden"] == "listed"))


def counts(row: Row, what: str) -> bool:
    """Whether a set has the outcome that a demand counts."""
    one, verdict = answer(row), row["verdict"]
    return {
        "false alarm": verdict != "none",
        "named, a pair or dominant": one.claims,
        "right": one.outcome == "right name",
        "right or in the set": one.outcome in ("right name", "right set"),
        "wrongly named": verdict in ("named", "pair") and one.outcome == "wrong name",
        "dominant": verdict == "dominant",
    }[what]


def tables(rows: list[Row]) -> str:
    """Counts of what is said of logs and lines, and beside what is asked."""
    parts = {
        "lines": ["few repeats"], "logs": ["white", "coarse"],
        "logs, correlated errors": ["correlated"], "logs, model error": MODEL_ERRORS,
    }  # fmt: skip
    groups = {
        f"{which}: {hidden}": [answer(row) for row in rows if row["hidden"] == hidden
                               and (which == "all" or row["kind"] != "line")]
        for hidden in ("listed", "unlisted", "none") for which in ("all", "all logs")
    }  # fmt: skip
    found = []
    for where, own in parts.items():
        mine = [row for row in rows if row["errors"] in own]
        for name in sorted(set(map(group, mine))):
            groups[f"{where}: {name}"] = [answer(row) for row in mine if group(row) == name]
        for hidden, what, plain, beside, at_most, fewest in DEMANDS:
            # Errors that are alike along a run may be found; they must not be named.
            asked = beside if own is MODEL_ERRORS else plain
            some = [counts(row, what) for row in mine if group(row) == hidden]
            if asked is None or not some or ("correlated" in own and what == "false alarm"):
                continue
            low, high = interval(sum(some), len(some))
            few = len(some) < (FEWEST_BESIDE if own is MODEL_ERRORS else fewest)
            fine = low <= asked if at_most else high >= asked
            found.append((where, hidden, what, f"{sum(some)} of {len(some)}",
                          f"{low:.0%} to {high:.0%}",
                          f"at {'most' if at_most else 'least'} {asked:.0%}",
                          "not judged" if few else "yes" if fine else "no"))  # fmt: skip
    heads = "data;hidden;counted;count;95 % interval;asked;met"
    seconds = [row["cpu_seconds"] for row in rows if row["kind"] != "line"] or [0.0]
    cost = f"A log took {np.median(seconds):.1f} CPU s in the median, {max(seconds):.0f} at most."
    return f"{table(groups)}\n\n{markdown(heads, found)}\n\n{len(rows)} sets. {cost}"
