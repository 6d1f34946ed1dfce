"""A fixed program with the same physics as the product, by which CPU times are divided.

`reference.cpp` is written once and not changed: see its first lines. It is compiled for the
processor that it runs on.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import NamedTuple

from measure import ROOT
from works import REFERENCE

from stickslip import Scenario

SOURCE = Path(__file__).with_name("reference.cpp")
PROGRAM = ROOT / "build" / "limit" / "reference"
FLAGS = ("-std=c++20", "-O3", "-march=native")
RTOL, REPEATS = 1e-6, 21
KEYS = (
    *(f"drive.{key}" for key in ("mode", "frequency", "peak", "base", "hold", "ramp", "pulses")),
    *("drive.edge", "drive.clamp", "environment.gravity", "drag.linear", "drag.rotational"),
    *(f"coil.{key}" for key in ("side", "distance", "turns", "resistance", "inductance")),
    *(f"robot.{key}" for key in ("length", "width", "height", "mass", "magnetization")),
    *(f"contact.{key}" for key in ("static_friction", "kinetic_friction", "adhesion")),
)
"""What the program takes of a scenario; the other keys have to have their defaults."""


class Answer(NamedTuple):
    """Of a run: CPU seconds (median), what it took, and where it ended (m, m/s)."""

    rtol: float
    cpu_seconds: float
    evaluations: int
    steps: int
    events: int
    x: float
    mean_velocity: float


def built() -> Path:
    """The program, compiled if it is not there or older than its source."""
    if not PROGRAM.is_file() or PROGRAM.stat().st_mtime < SOURCE.stat().st_mtime:
        PROGRAM.parent.mkdir(parents=True, exist_ok=True)
        part = PROGRAM.with_name(f"{PROGRAM.name}-{os.getpid()}")
        compiler = os.environ.get("CXX", "g++")
        subprocess.run([compiler, *FLAGS, str(SOURCE), "-o", str(part)], check=True)
        part.replace(PROGRAM)
    return PROGRAM


class Reference:
    """A process of the program, on the processors of this one."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [built()], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def answer(
        self, rtol: float = RTOL, scenario: Scenario = REFERENCE, repeats: int = 1
    ) -> Answer:
        """Play a scenario; the time is the median of `repeats` runs after one that is not counted.

        Raises RuntimeError where the program ends, as for a body that stands on end.
        """
        keys = "".join(f"{key} {scenario.get(key)}\n" for key in KEYS)
        self._process.stdin.write(f"{keys}run {rtol!r} {repeats}\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("the fixed program ended; see its message above")
        return Answer(**json.loads(line))

    def seconds(self, rtol: float = RTOL) -> float:
        """CPU seconds of the reference run: what other CPU times are divided by."""
        return self.answer(rtol, repeats=REPEATS).cpu_seconds

    def close(self) -> None:
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()


def measured(rtols: list[float], repeats: int = REPEATS) -> list[Answer]:
    """The reference run at each tolerance."""
    reference = Reference()
    answers = [reference.answer(rtol, repeats=repeats) for rtol in rtols]
    reference.close()
    return answers
