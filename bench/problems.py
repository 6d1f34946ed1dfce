"""Problems of the golden verdicts, by name: each a diagnosis with fixed seeds.

They ask the package by its public names alone, so that an earlier one can answer them too.
"""

from __future__ import annotations

import contextlib
import functools
import io
import json
import lzma
import os
import re
import runpy
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from stickslip import (
    Diagnosis,
    Series,
    diagnose,
    diagnose_change,
    diagnose_model,
    models,
    read_measurement,
)

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "tests"))
import toys  # noqa: E402


class Problem(NamedTuple):
    """A diagnosis by a number of threads; whether it uses more than one."""

    diagnosed: Callable[[int], Diagnosis]
    threaded: bool = False


# Stored sets of the blind study whose diagnosis takes little time: walkers; tables of angles, of
# fields and of both beside velocities; films, of which those of a cause without their velocities.
WALKERS = {
    "76a8acdf": "nothing", "8e488dd7": "nothing, hard noise", "7c024bef": "weak cause",
    "8edbe26b": "nothing, outlier", "247ea6b2": "shuffled", "8db8e269": "constant off by 3 sd",
    "f04b2094": "constant off by 5 sd", "34644b75": "nothing, set-ups",
    "ac8e076f": "nothing, correlated", "99a58e22": "near twins", "7ea00b71": "law",
    "a8b830d5": "law, not seen",
}  # fmt: skip
TABLES = {
    "8f53a71b": "angles, nothing", "54e6daed": "angles, one cause",
    "1db93e00": "angles, instrument", "single, angles 23001": "angles, misalignment",
    "instrument, angles 23000": "angles, clipping", "ed3c0527": "fields, nothing",
    "841bad6d": "fields, instrument", "single, fields 23000": "fields, gain",
    "constant 5 sd, fields 23000": "fields, constant off", "4f72736d": "all tables, nothing",
}  # fmt: skip
FILMS = {
    "b4e909ba": "nothing", "74240c1c": "nothing, correlated", "aadef3e5": "one cause",
    "single, film 23000": "surface tilt",
}  # fmt: skip
CASES = {
    "axis": "diagnosed", "axis in time": "diagnose_in_time", "axis repeats": "diagnose_repeats",
    "cart": "diagnosed", "heater": "diagnosed", "rollers": "result", "tumbler": "result",
}  # fmt: skip
CHANGES = {
    "oiled": ("joint_oiled.csv", True, False),
    "friction not stated": ("joint_oiled.csv", False, False),
    "nothing": ("joint.csv", True, False),
    "oiled, other inputs": ("joint_oiled.csv", True, True),
    "nothing, other inputs": ("joint.csv", False, True),
}
"""Log after, whether dry friction is stated, and whether the halves of the logs are compared."""
_X = np.linspace(1.0, 3.0, 30)
_WAVE, _STEP, _BEND, _ = toys.shapes(_X).values()
TOYS = {
    "nothing": 0.0, "wave": 0.5 * _WAVE, "step": 0.4 * _STEP, "bend": 0.5 * _BEND,
    "weak wave": 0.08 * _WAVE, "wave and bend": 0.5 * (_WAVE + _BEND),
    "unlisted": 0.4 * np.sin(11.0 * _X), "smooth": 0.15 * np.sin(2.2 * _X) ** 2,
}  # fmt: skip
"""Changes added to the toys' line; the seed of each is its place."""

QUICK = (
    *(f"toy {name}" for name in ("nothing", "wave", "step", "bend", "wave and bend", "unlisted")),
    "table angles, clipping", "table fields, nothing", "axis-04", "joint-00", "oscillator-00",
    "pendulum-00", "thermal-00", "change nothing",
)  # fmt: skip
"""Problems of `make test`: 20 s of CPU together at most, the same verdict on each machine."""


def _log(path: Path, _: int) -> Diagnosis:
    told = tomllib.loads(path.read_text())
    known = {**{name: tuple(each) for name, each in told["constants"].items()}, **told["known"]}
    model = getattr(models, told["kind"])(without=told["without"], **known)
    return diagnose_model(model, models.read_log(path.with_name(told["log"]), model))


def _measured(path: Path, threads: int) -> Diagnosis:
    return diagnose(read_measurement(path), threads=threads)


@functools.cache
def _sets() -> dict[str, dict[str, str]]:
    """Files of each stored set; those that are known by kind and seed are of the old seeds."""
    found = {}
    for folder in ("study", "frozen"):
        with lzma.open(ROOT / "bench" / "blind" / folder / "sets.jsonl.xz", "rt") as file:
            found.update({each["name"]: each["files"] for each in map(json.loads, file)})
    return found


def _stored(name: str, film_alone: bool, threads: int) -> Diagnosis:
    with tempfile.TemporaryDirectory() as folder:
        for file, text in _sets()[name].items():
            if film_alone and file == "measurement.toml":
                text = re.sub(r"\[\[velocity\]\][^\[]*", "", text)
            Path(folder, file).write_text(text)
        return _measured(Path(folder, "measurement.toml"), threads)


def _case(name: str, what: str, _: int) -> Diagnosis:
    before = os.getcwd()
    with contextlib.redirect_stdout(io.StringIO()), tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # for the picture of one
        try:
            ran = runpy.run_path(str(ROOT / "examples" / "cases" / name / "case.py"))[what]
        finally:
            os.chdir(before)
    return ran if isinstance(ran, Diagnosis) else ran()


def _change(after: str, is_stated: bool, halves: bool, _: int) -> Diagnosis:
    stated = {"coulomb": (0.03, 0.01)} if is_stated else {}
    joint = models.joint(inertia=(0.012, 0.0005), viscous=(0.02, 0.01), **stated)
    one, other = (models.read_log(ROOT / "examples" / name, joint) for name in ("joint.csv", after))
    half = len(one.t) // 2
    rows = (slice(half), slice(half, None)) if halves else (slice(None), slice(None))
    noise = 0.02 * np.random.default_rng(3).standard_normal(len(other.t))
    readings = one.y, other.y + noise * (after == "joint.csv")
    sides = [
        Series(
            log.t[part], y[part], {"torque": log.inputs["torque"][part]}, name=name, unit="rad/s"
        )
        for log, y, part, name in zip((one, other), readings, rows, "ab", strict=True)
    ]
    return diagnose_change(joint, *sides)


def _toy(seed: int, extra: float | np.ndarray, _: int) -> Diagnosis:
    table = toys.data(extra, seed=seed)
    return diagnose_model(toys.line, table, [toys.SLOPE, toys.LEVEL], toys.CAUSES)


def _problems() -> Iterator[tuple[str, Problem]]:
    def of(function: Callable[..., Diagnosis], *given: object, threaded: bool = False) -> Problem:
        return Problem(functools.partial(function, *given), threaded)

    for seed, (name, extra) in enumerate(TOYS.items()):
        yield f"toy {name}", of(_toy, seed, extra)
    for name, what in CASES.items():
        yield f"case {name}", of(_case, name.partition(" ")[0], what)
    for name, given in CHANGES.items():
        yield f"change {name}", of(_change, *given)
    yield "example", of(_measured, ROOT / "examples" / "measurement.toml", threaded=True)
    for kind, sets in (("blind", WALKERS), ("table", TABLES), ("film", FILMS)):
        for name, what in sets.items():
            alone = kind == "film" and "nothing" not in what
            yield f"{kind} {what}", of(_stored, name, alone, threaded=True)
    logs = ROOT / "bench" / "causes" / "sets"
    for name in ("walker-00", "walker-02"):
        yield name, of(_measured, logs / name / "measurement.toml", threaded=True)
    for path in sorted(logs.glob("[!w]*/*.toml")):
        yield path.parent.name + " unlisted" * (path.stem == "unlisted"), of(_log, path)


PROBLEMS = dict(_problems())
