"""One data set of the study, from its making to what is said of it."""

from __future__ import annotations

import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from drawn_law import drawn
from scipy.stats import norm

import stickslip
from blind.frozen import checksum, generator_files
from blind.readings import velocities
from blind.truth import Truth
from blind.writing import KEYS, write_case, write_more
from stickslip import Cause, Diagnosis, Drive, Scenario, Solver, diagnose, simulate_batch
from stickslip.diagnosis.data.velocity import VelocityTable
from stickslip.diagnosis.result import CLAIMS
from stickslip.diagnosis.terms.library import library
from stickslip.measurement import read_measurement
from stickslip.scenario.keys import known_keys

_HERE = Path(__file__).resolve().parent
_VOLTS = 30.0  # near what the drives ask for, so that a limit of the voltage acts
# Rooms of the package that decide about a verdict; the report and all else do not.
_ENGINE = ("diagnosis", "measurement", "scenario")
_KNOT = 0.3  # usual size of a law of a free shape
_POINTS = 13  # of a law's curve


def state() -> dict[str, str]:
    """Which engine and which generator made a row: version, commit, sums of what decides.

    Of the engine these are the files of its rooms without the report, and velocities that the core
    computes: two builds of one source differ in their bytes.
    """
    package = Path(stickslip.__file__).resolve().parent
    deciding = [
        path
        for room in _ENGINE
        for path in (package / room).rglob("*.py")
        if "report" not in path.parts
    ]
    asked = ("git", "-C", str(_HERE), "rev-parse", "--short", "HEAD")
    commit = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    return {
        "version": stickslip.__version__,
        "commit": commit,
        "engine": checksum(deciding, _velocities()),
        "data": checksum(generator_files()),
    }


def same_state(row: dict[str, Any], now: dict[str, str]) -> bool:
    """Whether the present files would say the same; another commit may have the same ones."""
    return all(row.get("state", {}).get(key) == now[key] for key in ("engine", "data"))


def _velocities() -> bytes:
    """Mean velocities of runs with each parameter that a diagnosis tries by itself, as bytes."""
    causes = library(Scenario(), {}, _VOLTS)
    sizes = {p.name: float(p.value(np.ones(1))[0]) for cause in causes for p in cause.parameters}
    sizes |= {key: _KNOT for key in known_keys() if ".free_" in key and ".knot_" in key}
    base = Scenario(drive=Drive(base=0.5e-3, pulses=5), solver=Solver(rtol=1e-5))
    runs = [
        base.replace({"drive.frequency": 20.0 + 7.0 * k, name: size})
        for k, (name, size) in enumerate(sizes.items())
    ]
    return np.array([run.mean_velocity for run in simulate_batch(runs)]).tobytes()


def study(kind: str, seed: int) -> dict[str, Any]:
    """Make one data set, diagnose it from its files alone, and return what was said.

    Near twins are measured again at the experiments that the diagnosis proposes.
    """
    with tempfile.TemporaryDirectory() as work:
        folder, more = Path(work) / "data", Path(work) / "more"
        answer = write_case(folder, kind, seed)
        return with_answer(diagnosed(folder), answer, folder, more)


def with_answer(
    row: dict[str, Any], answer: dict[str, Any], folder: Path, more: Path
) -> dict[str, Any]:
    """What was said of a data set, with its answer and what only the answer can tell."""
    row = {"answer": answer, **row, "truth_error": None}
    if answer["hook"] and row["gain"] is not None:
        measurement = read_measurement(folder / "measurement.toml")
        row["truth_error"] = _truth_error(VelocityTable(measurement, threads=1, seed=0), answer)
    drives = [each["drive"] for each in row["said"]["next_experiments"]]
    if answer["kind"] == "near twins" and drives:
        write_more(folder, more, answer, drives)
        row["followed"] = diagnosed(more)["said"]
    return row


def diagnosed(folder: Path) -> dict[str, Any]:
    """What is said of a data set by its files alone."""
    start = time.process_time()
    result = diagnose(read_measurement(folder / "measurement.toml"), threads=1)
    seconds, gain = time.process_time() - start, result.gain
    causes = [each for each in result.problem.causes if each.curve is not None]
    laws = {each.name: _effect(each) for each in causes if each.name in result.verdict.causes}
    # By the normal law the error that is left has a mean of 0.80 errors.
    middle, sd = np.sqrt(2.0 / np.pi), np.sqrt((1.0 - 2.0 / np.pi) / len(result.problem.y))
    return {
        "said": {**result.as_dict(), "laws": laws, "open_set": _law(result)},
        "reasons": [each.code for each in result.verdict.reasons],
        "gain": None if gain is None else {"p_value": norm.sf((gain.after - middle) / sd)},
        "cpu_seconds": seconds,
    }


def _effect(law: Cause) -> str:
    """The effect of the simulator that a law of a free shape is."""
    assert law.curve is not None
    (span,) = law.curve.fixed
    return span.split(".")[1]


def _law(result: Diagnosis) -> dict[str, Any] | None:
    """The claimed law of a free shape: its curve with the ends of 95 %, and its formula."""
    causes = result.best.fit.causes if result.verdict.kind in CLAIMS else ()
    for cause in causes:
        curve = cause.curve
        if curve is None:
            continue
        at = np.linspace(curve.low, curve.high, _POINTS)
        low, high, found = drawn(result, cause, at)
        return {
            "accepted": True, "effect": _effect(cause), "gain": result.as_dict()["gain"],
            "curve": {"argument": at.tolist(), "low": low.tolist(), "high": high.tolist()},
            "formula": None if found is None else found.text,
            "others": [] if found is None else list(found.others),
        }  # fmt: skip
    return None


def _truth_error(table: VelocityTable, answer: dict[str, Any]) -> float:
    """Mean absolute error of the truth on all conditions, m/s: what noise leaves."""
    drives = [{key: each[f"drive.{key}"] for key in KEYS} for each in table.conditions]
    return float(np.mean(np.abs(table.mean - velocities(Truth.of(answer), drives))))
