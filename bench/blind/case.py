"""One data set of the study, from its making to what is said of it."""

from __future__ import annotations

import json
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import stickslip
from blind.frozen import checksum, generator_files
from blind.readings import velocities
from blind.truth import Truth
from blind.writing import KEYS, write_case, write_more
from stickslip import Drive, Scenario, Solver, simulate_batch
from stickslip.diagnosis.api import diagnose
from stickslip.diagnosis.model.effect_causes import library
from stickslip.diagnosis.model.free_shapes import HOOKS
from stickslip.diagnosis.report.certainty import gain_of
from stickslip.diagnosis.results import Diagnosis
from stickslip.measurement import read_measurement

_HERE = Path(__file__).resolve().parent
_VOLTS = 30.0  # near what the drives ask for, so that a limit of the voltage acts
# Rooms of the package that decide about a verdict; the report and all else do not.
_ENGINE = ("diagnosis", "measurement", "scenario")
# Files that decide only about the law that is said in the place of a cause.
LAWS_ONLY = (
    "between_knots", "form_curves", "form_starts", "formula_search", "formulas", "free_shapes",
    "free_term_search", "law_posterior", "law_prior", "open_set", "simultaneous_band",
)  # fmt: skip


def state() -> dict[str, str]:
    """Which engine and which generator made a row: version, commit, sums of what decides.

    Of the engine these are the files of its rooms without the report, and velocities that the core
    computes: two builds of one source differ in their bytes. Those that decide only about laws have
    a sum of their own.
    """
    package = Path(stickslip.__file__).resolve().parent
    deciding = [
        path
        for room in _ENGINE
        for path in (package / room).rglob("*.py")
        if "report" not in path.parts
    ]
    laws = [path for path in deciding if path.stem in LAWS_ONLY and "diagnosis" in path.parts]
    engine = [path for path in deciding if path not in laws]
    asked = ("git", "-C", str(_HERE), "rev-parse", "--short", "HEAD")
    commit = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    return {
        "version": stickslip.__version__,
        "commit": commit,
        "engine": checksum(engine, _velocities(_named_sizes())),
        "laws": checksum(laws, _velocities(_law_sizes())),
        "data": checksum(generator_files()),
    }


def same_state(row: dict[str, Any], now: dict[str, str]) -> bool:
    """Whether the present files would say the same; another commit may have the same ones."""
    said = [row["said"], *([row["followed"]] if row.get("followed") else [])]
    for_laws = any(each.get("open_set") is not None for each in said)
    there = row.get("state", {})
    return all(there.get(key) == now[key] for key in ["engine", "data", *["laws"] * for_laws])


def _named_sizes() -> dict[str, float]:
    """A usual size of each parameter of each effect that a diagnosis tries."""
    causes = library(Scenario(), {}, _VOLTS)
    return {p.name: float(p.value(np.ones(1))[0]) for cause in causes for p in cause.parameters}


def _law_sizes() -> dict[str, float]:
    """The same of the knots of each law."""
    return {p.name: p.scale for hook in HOOKS for p in hook.cause.parameters}


def _velocities(sizes: dict[str, float]) -> bytes:
    """Mean velocities of runs with each of these parameters by itself, as bytes."""
    base = Scenario(drive=Drive(base=0.5e-3, pulses=5), solver=Solver(rtol=1e-5))
    runs = [
        base.replace({"drive.frequency": 20.0 + 7.0 * k, name: size})
        for k, (name, size) in enumerate(sizes.items())
    ]
    return np.array([run.mean_velocity for run in simulate_batch(runs)]).tobytes()


def _folder_name(kind: str, seed: int) -> str:
    return f"{kind.replace(', ', '-').replace(' ', '_')}-{seed}"


def prepared(kind: str, seed: int, store: Path) -> tuple[Path, dict[str, Any]]:
    """Folder and answer of a data set in a store, made if it is not there.

    Those of another generator lie in another folder; the engine has no say in them.
    """
    place = store / checksum(generator_files()) / _folder_name(kind, seed)
    if not place.exists():
        place.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=place.parent) as work:
            made = Path(work) / "made"
            answer = write_case(made / "data", kind, seed)
            (made / "answer.json").write_text(json.dumps(answer) + "\n")
            made.rename(place)
    return place / "data", json.loads((place / "answer.json").read_text())


def study(
    kind: str, seed: int, store: Path | None = None, reports: Path | None = None
) -> dict[str, Any]:
    """Make one data set, diagnose it from its files alone, and return what was said.

    Near twins are measured again at the experiments that the diagnosis proposes. With a `store`
    the data set is taken from there, or kept there; with `reports` the page of this diagnosis
    is saved below it.
    """
    with tempfile.TemporaryDirectory() as work:
        folder, answer = prepared(kind, seed, Path(work) if store is None else store)
        page = None if reports is None else reports / _folder_name(kind, seed)
        row = {"answer": answer, **_diagnosed(folder, answer, page)}
        drives = [each["drive"] for each in row["said"]["next_experiments"]]
        if kind == "near twins" and drives:
            more = Path(work) / "more"
            write_more(folder, more, answer, drives)
            row["followed"] = _diagnosed(more, answer)["said"]
        return row


def _diagnosed(folder: Path, answer: dict[str, Any], page: Path | None = None) -> dict[str, Any]:
    start = time.process_time()
    result = diagnose(read_measurement(folder / "measurement.toml"), threads=1)
    seconds, gain = time.process_time() - start, result.gain
    if page is not None:
        result.save_report(page)
    return {
        "said": result.as_dict(),
        "reasons": [each.code.name for each in result.verdict.reasons],
        "gain": None if gain is None else {"p_value": gain.p_value, "choice": gain.choice},
        "truth_error": _truth_error(result, answer) if answer["hook"] else None,
        "cpu_seconds": seconds,
    }


def _truth_error(result: Diagnosis, answer: dict[str, Any]) -> float | None:
    """Mean absolute error of the truth on the held-out conditions, m/s: what noise leaves."""
    gain, problem = gain_of(result.findings), result.findings.problem
    if gain is None:
        return None
    drives = [{key: problem.conditions[k][f"drive.{key}"] for key in KEYS} for k in gain.held_out]
    error = problem.observed[gain.held_out] - velocities(Truth.of(answer), drives)
    return float(np.mean(np.abs(error)))
