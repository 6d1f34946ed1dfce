"""Diagnoses whose cost and errors `now` counts."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from unittest import mock

import numpy as np
from measure import ROOT
from real.study import axis

from stickslip import (
    Cause,
    Diagnosis,
    Parameter,
    Prior,
    Scenario,
    Table,
    _core,
    diagnose,
    diagnose_model,
    read_measurement,
    simulate,
)

EXAMPLE = ROOT / "examples" / "measurement.toml"
FREQUENCIES = (25.0, 50.0, 75.0)  # Hz; two of them are those of the example
SPREAD = 0.2  # of a velocity: twenty times the error of a trial, and like no cause


def _example() -> Diagnosis:
    return diagnose(read_measurement(EXAMPLE), threads=1)


def _unexplained(conditions: int) -> Diagnosis:
    """The example's drives with velocities that are each off by a random factor."""
    factors = 1.0 + SPREAD * np.random.default_rng(1).standard_normal(conditions)
    walk = Scenario.from_toml(EXAMPLE.with_name("walk.toml"))
    rows = ["mode,direction,frequency,velocity"]
    for frequency in FREQUENCIES[: conditions // 4]:
        for mode in ("IPP", "OPP"):
            for direction in ("+x", "-x"):
                drive = {"mode": mode, "direction": direction, "frequency": frequency}
                run = simulate(walk.replace({f"drive.{key}": each for key, each in drive.items()}))
                velocity = run.mean_velocity * factors[len(rows) - 1]
                rows.append(f"{mode},{direction},{frequency:g},{velocity:.4e}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for each in ("measurement.toml", "walk.toml"):
            (folder / each).write_text(EXAMPLE.with_name(each).read_text())
        (folder / "velocity.csv").write_text("\n".join(rows) + "\n")
        return diagnose(read_measurement(folder / "measurement.toml"), threads=1)


CASES: dict[str, Callable[[], Diagnosis]] = {
    "README's example": _example,
    "nothing explains, 8 conditions": lambda: _unexplained(8),
    "nothing explains, 12 conditions": lambda: _unexplained(12),
    "own model, a record of 495 readings": lambda: axis.diagnose_in_time(),
}


def main(name: str) -> None:
    """Print CPU seconds, simulations or predictions, and the verdict of a case, as JSON."""
    simulations = 0

    def counting(run: Callable, place: int) -> Callable:
        def counted(*given: object) -> object:
            nonlocal simulations
            simulations += len(given[place])
            return run(*given)

        return counted

    def own(predict: Callable, *given: object, **options: object) -> Diagnosis:
        def counted(table: object, p: dict[str, np.ndarray]) -> np.ndarray:
            nonlocal simulations
            simulations += len(next(iter(p.values())))
            return predict(table, p)

        return diagnose_model(counted, *given, **options)

    with (
        mock.patch.object(_core, "sweep", counting(_core.sweep, 2)),
        mock.patch.object(_core, "simulate_batch", counting(_core.simulate_batch, 0)),
        mock.patch.object(axis, "diagnose_model", own),
    ):
        started = time.process_time()
        found = CASES[name]()
        seconds = time.process_time() - started
    print(json.dumps({"cpu_seconds": seconds, "simulations": simulations, "verdict": str(found)}))


BEND = Cause("bend", Parameter("bend.size", size=0.2, low=-3.0, high=3.0), "a parabola")
STEP = Cause("step", Parameter("step.height", size=0.5, low=-5.0, high=5.0), "a step")


def _line(table: Table, p: dict[str, np.ndarray]) -> np.ndarray:
    x = table["x"]
    bent = p.get("bend.size", 0.0) * (x - 2.5) ** 2 + p.get("step.height", 0.0) * (x > 2.5)
    return p["slope"] * x + bent


def sound_table(seed: int) -> tuple[str, float, float]:
    """Verdict, p of the test and CPU seconds on a line at four places, three repeats each.

    The slope is drawn from its prior, the errors are normal, and the repeats alone tell their size.
    """
    draw = np.random.default_rng(seed)
    x = np.repeat([1.0, 2.0, 3.0, 4.0], 3)
    table = Table({"x": x}, draw.normal(1.0, 0.1) * x + 0.1 * draw.standard_normal(len(x)))
    slope = Parameter("slope", Prior("normal", 1.0, 0.1), cause=False)
    started = time.process_time()
    found = diagnose_model(_line, table, [slope], [BEND, STEP])
    seconds = time.process_time() - started
    return found.verdict.kind, found.findings.test.p_value, seconds
