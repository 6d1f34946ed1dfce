"""Cost of a diagnosis in time: ``python -m bench series [--readings N ...]``.

A mass on a rail is driven by hand: the force over its speed and acceleration, with ten suspects of
which one acts, and noise that lasts for some readings. The model costs next to nothing, so that
what is measured is the diagnosis itself: CPU seconds, the largest memory, and what of that the
interpreter with its libraries had before.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import time

import numpy as np
from scipy.signal import lfilter

from stickslip import Cause, Parameter, Prior, Series, diagnose_model, instruments

STEP, NOISE, LASTS = 0.01, 0.05, 0.9
"""s between readings, N, and the correlation of a part of the noise from one to the next."""

_SHAPES = {
    "asymmetry": lambda v, a, t: np.abs(v),
    "friction": lambda v, a, t: np.sign(v),
    "quadratic": lambda v, a, t: v * np.abs(v),
    "cubic": lambda v, a, t: v**3,
    "zero": lambda v, a, t: np.ones_like(v),
    "stiffness": lambda v, a, t: np.cumsum(v) * STEP,
    "drift": lambda v, a, t: t / t[-1],
}


def measured(count: int) -> Series:
    """The record, with friction that is larger in one direction."""
    random, t = np.random.default_rng(count), STEP * np.arange(count)
    v = np.sin(2.0 * np.pi * t / 6.2) + 0.3 * np.sin(2.0 * np.pi * t / 1.7)
    a = np.gradient(v, t)
    white = random.standard_normal((2, count))
    noise = NOISE * (white[0] + lfilter([1.0], [1.0, -LASTS], white[1]))
    return Series(t, 2.0 * a + 1.05 * v + 0.4 * np.abs(v) + noise, {"v": v, "a": a}, unit="N")


def force(record: Series, p: dict[str, np.ndarray]) -> np.ndarray:
    """Of the mass at its speed and acceleration, N."""
    v, a = record["v"], record["a"]
    total = p["mass"] * a + p["viscous"] * v
    for name, shape in _SHAPES.items():
        total = total + p[f"{name}.size"] * shape(v, a, record.t)
    return total


def diagnosed(count: int) -> str:
    """One line: readings, verdict, cost."""
    causes = [
        Cause(name, Parameter(f"{name}.size", low=-30.0, high=30.0, size=0.2)) for name in _SHAPES
    ]
    meters = [instruments.scale(), instruments.lag(0.05), instruments.delay(size=0.05)]
    uncertain = [
        Parameter("mass", Prior("normal", 2.0, 0.1), "kg"),
        Parameter("viscous", Prior("normal", 1.0, 0.1), "N s/m"),
    ]
    record, before = measured(count), _megabytes()
    begin = time.process_time()
    verdict = diagnose_model(force, record, uncertain, [*causes, *meters]).verdict
    seconds = time.process_time() - begin
    said = f"{verdict.kind} {' + '.join(verdict.causes)}"
    return (
        f"{count:>6} readings: {said}, {seconds:.1f} CPU s, {_megabytes():.0f} MB "
        f"({before:.0f} before)"
    )


def _megabytes() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    """Each number of readings in a process of its own, as memory is that of a process."""
    parser = argparse.ArgumentParser(prog="python -m bench series", description=__doc__)
    parser.add_argument("--readings", type=int, nargs="+", default=[2048, 25000])
    counts = parser.parse_args().readings
    if len(counts) == 1:
        print(diagnosed(counts[0]))
        return
    for count in counts:
        subprocess.run([sys.executable, "-m", "series", "--readings", str(count)], check=True)


if __name__ == "__main__":
    main()
