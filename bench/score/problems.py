"""Problems of the score by class: each a question to the diagnosis whose truth is known."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from blind import own, seeds
from blind.catalogue import entry
from blind.kinds import KINDS, plan
from blind.model_errors import MODEL_ERRORS
from blind.writing import write_case
from causes import tools
from causes.make import TRUTH
from real.sets import ASKED, UNSURE, measured_set

import stickslip
from score import made, pairs, unlisted
from stickslip import Diagnosis, Series, diagnose, diagnose_change, models, read_measurement

REACHED = 0.9  # part of the strength that its kind asks for below which a walker is too weak
WALKERS = 80
OF_WALKERS = ("constant 3 sd", "constant 5 sd", "single", "single, correlated", "weak", "pair",
              "near twins", "exact twins", "hiding", "instrument", "model error")  # fmt: skip
"""Families of kinds of walkers in which something listed is hidden."""
WORDS = {"none": "nothing", "listed": "listed", "unlisted": "not listed"}
ONE, ALONE = ("rounded", "correlated", "missing"), ("AR 0.5", "AR 0.8", "mean of three")
READINGS = {"rad/s": 57.29578, "rad": 57.29578, "m": 1e3}  # in deg or mm
SLOW = "wheels"  # measured sets that take a quarter of an hour or more
MILLI = "torque", "force", "command", "power"  # inputs that may be in a thousandth
LOGGED = {"held": (2, 5), "lines": (2, 5, 20), "mixed rates": (3,), "mean": (3, 9),
          "clipped": (10, 25), "turns": (2, 7), "gap": (12,)}  # fmt: skip
"""How rows of a log were made of readings, each with numbers of rows."""


TURNING = {"joint by its angle": 2, "pendulum with a moved pivot": 7, "servo": 7,
           "servo by its duty": 7}  # fmt: skip
"""Machines whose angle may begin anew, and after which part of a turn."""


class Asked(NamedTuple):
    """A question with its truth.

    truth: Causes that are hidden. listed: Whether they are offered. sizes: True values by the names
    of the package; of a measured set with standard deviations. more: Further items of the row.
    causes: What is said: the causes of the verdict, or a unit.
    """

    diagnosed: Callable[[], Diagnosis]
    truth: Sequence[str]
    listed: bool = True
    sizes: Mapping[str, Any] = {}
    more: Mapping[str, Any] = {}
    causes: Callable[[Diagnosis], Sequence[str]] = lambda found: found.verdict.causes


class Problem(NamedTuple):
    """A problem: its class, its name, the study and seed if it is drawn, how it is asked."""

    group: str
    name: str
    asked: Callable[[], Asked]
    study: str = ""
    seed: int = 0


def drawn(group: str, study: str, seed: int, words: str, asked: Callable[[], Asked]) -> Problem:
    return Problem(group, f"{study} {seed}, {words}", asked, study, seed)


def first(study: str) -> int:
    """First seed of the newest range of a study."""
    return seeds.ranges(study)[-1].first


# -------------------------------------------------------------------------------- stored questions
def of_causes(walkers: bool) -> Iterator[Problem]:
    """Questions of the benchmark of causes."""
    for name, truth in json.loads(TRUTH.read_text()).items():
        if name.startswith("walker") is walkers:
            what = "listed" if truth["listed"] else "not listed"
            group = f"{'walkers of causes' if walkers else 'logs'}, "
            group += what if truth["cause"] else "nothing"
            group += ", model error" * truth["model_error"]
            yield Problem(group, name, partial(_of_causes, name, truth))


def _of_causes(name: str, truth: dict[str, Any]) -> Asked:
    one = dict(tools.asked())[name]()
    return Asked(one.diagnosed, [truth["cause"]] * bool(truth["cause"]), truth["listed"])


def of_measured() -> Iterator[Problem]:
    """Measured sets, with the cause that acts among those that are listed and without it."""
    for machine, count in {**ASKED, **UNSURE}.items():
        for k, listed in ((k, listed) for k in range(count) for listed in (True, False)):
            what = "unsure" if machine in UNSURE else "listed" if listed else "not listed"
            name = f"{machine} {k + 1}{' unlisted' * (not listed)}"
            yield Problem(f"measured, {what}", name, partial(_of_measured, machine, k, listed))


def _of_measured(machine: str, k: int, listed: bool) -> Asked:
    one, more = measured_set(machine, k), {}
    truth, more = one.truth, {"also": list(one.truth.possible), "set": one.name}
    asked = partial(one.diagnosed, () if listed else truth.present)
    return Asked(asked, truth.present, listed, truth.values, more)


# --------------------------------------------------------------------------------- drawn questions
def of_own(study: str, count: int) -> Iterator[Problem]:
    """Sets of `blind.own`; those of the study `clean` hide nothing."""
    for place in range(count):
        kind, hidden, errors = (own.clean if study == "clean" else own.plan)(place)
        group = "clean" if study == "clean" else f"own, {WORDS[hidden]}"
        error = "model error" if errors in own.MODEL_ERRORS else errors
        seed = first(study) + place
        asked = partial(_of_own, seed, kind, hidden, errors)
        yield drawn(f"{group}, {error}", study, seed, f"{kind}, {errors}", asked)


def _of_own(seed: int, kind: str, hidden: str, errors: str) -> Asked:
    one = own.drawn(seed, kind, hidden, errors)
    return Asked(one.diagnosed, [one.cause] * bool(one.cause), hidden != "unlisted", one.sizes)


def _group(key: made.Key) -> str:
    if key.condition in ALONE:
        return "errors alike"
    word = "one error" if key.condition in ONE else key.condition
    word = f"{word}, S = {key.strength:g}" if word == "clean" else word
    return f"made, {'far scale' if key.size else word if key.cause else 'nothing'}"


def of_made() -> Iterator[Problem]:
    """Logs of `score.made` and of `score.unlisted`."""
    for key in made.problems(first("made logs")):
        words = f"{key.machine}, {key.cause or 'nothing'}, {key.condition}"
        yield drawn(_group(key), "made logs", key.seed, words, partial(_of_made, made.made, key))
    for key in unlisted.problems(first("unlisted")):
        asked = partial(_of_made, unlisted.made, key, listed=False)
        yield drawn("unlisted shapes", "unlisted", key.seed, f"{key.machine}, {key.cause}", asked)


def _of_made(make: Callable[[Any], made.Made], key: Any, listed: bool = True) -> Asked:
    return _of_log(make(key), listed=listed)


def _of_log(log: made.Made, listed: bool = True, **more: Any) -> Asked:
    truth = [log.truth] * bool(log.truth)
    sizes = {name: size for name, size in log.constants.items() if not name.startswith("start")}
    more |= {"strength": round(log.strength, 2), "by": log.by}
    return Asked(partial(_diagnosed, log), truth, listed, sizes, more)


def question(log: made.Made) -> tuple[Any, Series]:
    """The ready-made model and the log that a problem asks about."""
    reads = {} if log.kind == "thermal" else {"reads": log.reads}
    model = getattr(models, log.kind)(**reads, without=log.without, **log.stated, **log.known)
    return model, Series(log.t, log.y, log.inputs, unit=log.unit)


def _diagnosed(log: made.Made) -> Diagnosis:
    return stickslip.diagnose_model(*question(log))


def of_logged() -> Iterator[Problem]:
    """Logs of each machine whose rows are no readings, and the plain ones."""
    for k, (machine, of) in enumerate(made.MACHINES.items()):
        cause = "coulomb" if "coulomb" in of.causes else next(iter(of.causes))
        key = made.Key(first("rows") + k, machine, cause, 25.0, "clean")
        asked = partial(_of_made, made.made, key)
        plain = drawn("rows, plain", "rows", key.seed, f"{machine}, plain", asked)
        yield plain
        for how, n in ((how, n) for how, numbers in LOGGED.items() for n in numbers):
            if (how == "gap" and not of.input) or (how == "turns" and n != TURNING.get(machine)):
                continue
            asked = partial(_of_logged, key, how, n, plain.name)
            yield drawn(f"rows, {how}", "rows", key.seed, f"{machine}, {how} {n}", asked)


def _of_logged(key: made.Key, how: str, n: int, plain: str) -> Asked:
    log = made.made(key)
    at = np.arange(len(log.t))
    if how in ("held", "lines"):  # the rows of a faster logger
        fine = np.arange(at[-1] * n + 1) / n
        row, t = fine.astype(int), np.interp(fine, at, log.t)
        y = log.y[row] if how == "held" else np.interp(fine, at, log.y)
        log = log._replace(t=t, y=y, inputs={name: u[row] for name, u in log.inputs.items()})
    elif how == "mixed rates":  # inputs are read more often than the sensor
        log = log._replace(y=log.y[at - at % n])
    elif how == "clipped":  # a part of the readings, in percent
        log = log._replace(y=np.minimum(log.y, np.quantile(log.y, 1.0 - n / 100.0)))
    elif how == "turns":  # so many of them are one
        span = 2.0 * np.pi / n
        log = log._replace(y=(log.y + 0.5 * span) % span - 0.5 * span)
    elif how == "gap":  # in which the input switches
        switches = np.flatnonzero(np.diff(next(iter(log.inputs.values())))) + 1
        kept = np.abs(at + 0.5 - switches[len(switches) // 2]) > 0.5 * n
        inputs = {name: u[kept] for name, u in log.inputs.items()}
        log = log._replace(t=log.t[kept], y=log.y[kept], inputs=inputs)
    else:
        before = np.concatenate([np.full(n - 1, log.y[0]), log.y])
        log = log._replace(y=np.convolve(before, np.full(n, 1.0 / n), "valid"))
    return _of_log(log, plain=plain)


def of_units() -> Iterator[Problem]:
    """Logs of each machine of which one unit is another than is stated."""
    for k, (machine, of) in enumerate(made.MACHINES.items()):
        fits = {"time": True, "reading": of.kind != "thermal", "input": of.input in MILLI,
                "constant": True}  # fmt: skip
        key = made.Key(first("stated units") + k, machine, "", 0.0, "clean")
        for what in (what for what, may in fits.items() if may):
            asked = partial(_of_unit, key, what)
            yield drawn("units", "stated units", key.seed, f"{machine}, {what}", asked)


def _of_unit(key: made.Key, what: str) -> Asked:
    log, truth = made.made(key), f"unit of {what}"
    if what == "time":
        log = log._replace(t=1e3 * log.t)
    elif what == "reading":
        log = log._replace(y=READINGS[log.unit] * log.y)
    elif what == "input":
        ((name, u),) = log.inputs.items()
        log = log._replace(inputs={name: 1e3 * u})
    else:
        truth, (value, sd) = next(iter(log.stated.items()))
        log = log._replace(stated={**log.stated, truth: (1e3 * value, 1e3 * sd)})

    def causes(found: Diagnosis) -> Sequence[str]:
        # In a linear machine the scale of the input is that of the readings.
        said = any(note.code == "another-scale" for note in found.verdict.reasons)
        return [truth] if said and what in ("reading", "input") else found.verdict.causes

    return _of_log(log)._replace(truth=[truth], sizes={}, causes=causes)


def of_pairs(count: int) -> Iterator[Problem]:
    """Pairs of logs."""
    for place in range(count):
        seed = first("pairs") + place
        told = "friction or load not stated" if place % 2 else "all stated"
        group = f"pairs, {'no' if place % 7 in pairs.SAME else 'a'} change, {told}"
        yield drawn(group, "pairs", seed, told, partial(_of_pair, seed, place))


def _of_pair(seed: int, place: int) -> Asked:
    pair = pairs.made(seed, place)
    asked = partial(diagnose_change, pair.model, *pair.sides)
    return Asked(asked, [pair.change] * bool(pair.change), more={"alike": pair.alike})


def of_walkers() -> Iterator[Problem]:
    """Sets of walkers in which something listed is hidden."""
    kinds = [name for name, each in KINDS.items() if each.family in OF_WALKERS]
    for kind, seed in [*plan(first("walkers"), 1000, kinds)][:WALKERS]:
        yield drawn("walkers, listed", "walkers", seed, kind, partial(_of_walker, kind, seed))


def _of_walker(kind: str, seed: int) -> Asked:
    with tempfile.TemporaryDirectory() as folder:
        truth = write_case(Path(folder), kind, seed)
        measured = read_measurement(Path(folder, "measurement.toml"))
    wanted, strength, hidden = KINDS[kind].wanted, truth["strength"], list(truth["answer"])
    more = {"also": sorted({*truth["hidden"]} - {*hidden}), "strength": round(strength, 2)}
    if wanted and strength < REACHED * wanted[0]:
        more["state"] = "too weak"
    # Sizes of laws whose form is the library's too; "law" is one of another form.
    sizes = {f"{name}.{key}": value for name, sizes in truth["effects"].items()
             if name not in (*MODEL_ERRORS, "law") and not entry(name).fixed
             for key, value in sizes.items()}  # fmt: skip
    asked = partial(diagnose, measured, threads=1)
    return Asked(asked, hidden, sizes={**truth["constants"], **sizes}, more=more)


CLASSES: tuple[Callable[[], Iterator[Problem]], ...] = (
    partial(of_own, "clean", 245), partial(of_own, "own", 600), partial(of_causes, False),
    of_units, of_made, of_logged, partial(of_pairs, 140), of_measured, partial(of_causes, True),
    of_walkers,
)  # fmt: skip
"""Listings of problems; those that take less time come first."""
