"""This version beside an earlier commit: `python -m bench against COMMIT`.

The package of the earlier commit is built into build/against; the installed one is not touched.
Each version is a process of its own on the same core. They measure in turn, so that drift meets
them alike: a figure is the median of CPU time, a ratio the median of the ratios of the turns. Both
have rtol 1e-6; the median relative error of the mean velocities, against this version at rtol
1e-11, stands beside.
"""

from __future__ import annotations

import argparse
import functools
import io
import itertools
import json
import os
import statistics
import subprocess
import sys
import tarfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from measure import pin, saved
from speed import REFERENCE, with_solver

import stickslip
from stickslip import Drive, Scenario

RTOL, EXACT = 1e-6, 1e-11
BUILD = Path("build/against")
MIXED = [
    Scenario(drive=Drive(mode=mode, frequency=frequency, peak=peak, base=0.5e-3, pulses=20))
    for mode, frequency, peak in itertools.product(
        ("IPP", "OPP"), (10.0, 40.0, 100.0, 160.0), (1.5e-3, 3.5e-3)
    )
]
ALIKE = [
    REFERENCE.replace({"drive.peak": float(peak)}) for peak in np.linspace(2.4e-3, 2.6e-3, 400)
]

Answer = tuple[float, list[float]]  # simulated seconds, mean velocities


def one_by_one(scenarios: list[Scenario], rtol: float) -> Answer:
    runs = [stickslip.simulate(with_solver(each, "tsit5", rtol)) for each in scenarios]
    return sum(run.summary()["simulated_time"] for run in runs), [r.mean_velocity for r in runs]


def alike(rtol: float) -> Answer:
    """A batch of runs that differ little."""
    batch = [with_solver(each, "tsit5", rtol) for each in ALIKE]
    runs = stickslip.simulate_batch(batch, threads=1)
    return sum(run.summary()["simulated_time"] for run in runs), [r.mean_velocity for r in runs]


def swept(rtol: float) -> Answer:
    """A sweep over frequency and peak."""
    base = with_solver(Scenario(drive=Drive(base=0.5e-3, pulses=20)), "tsit5", rtol)
    vary = {
        "drive.frequency": np.linspace(5.0, 200.0, 40),
        "drive.peak": np.linspace(1e-3, 6e-3, 25),
    }
    data = stickslip.sweep(base, vary, threads=1)
    return float(data["simulated_time"].sum()), data["mean_velocity"].values.ravel().tolist()


def _rows(steps: int) -> np.ndarray:
    """Voltages of a robot that walks, V, a row each millisecond."""
    rows = np.zeros((steps, 5))
    rows[:, 0], rows[:, 4] = 26.0 - 2.0 * (np.arange(steps) % 10), -10.4
    return rows


def stepped(rtol: float) -> Answer:
    """Half a thousand steps of a simulator."""
    simulator = stickslip.Simulator(with_solver(REFERENCE, "tsit5", rtol))
    for row in _rows(500):
        state = simulator.step(row, 1e-3)
    return simulator.time, [state.x / simulator.time]


def rolled_out(rtol: float) -> Answer:
    """Sixty-four robots, a hundred steps each."""
    scenarios = [with_solver(each, "tsit5", rtol) for each in ALIKE[:64]]
    found = stickslip.rollout(scenarios, None, _rows(100), 1e-3, record=("x",), threads=1)
    return 64 * 0.1, (found.states[:, -1, 0] / 0.1).tolist()


def replaced(rtol: float) -> Answer:
    """A thousand calls of `Scenario.replace`; no simulated time."""
    for _ in range(1000):
        REFERENCE.replace({"drive.peak": 2.4e-3})
    return 0.0, []


WORKS: dict[str, Callable[[float], Answer]] = {
    "one": lambda rtol: one_by_one([REFERENCE], rtol),
    "mixed": lambda rtol: one_by_one(MIXED, rtol),
    "plane": lambda rtol: one_by_one([REFERENCE.replace({"drive.heading": 0.5})], rtol),
    "long": lambda rtol: one_by_one([REFERENCE.replace({"drive.pulses": 2000})], rtol),
    "alike": alike,
    "swept": swept,
    "stepped": stepped,
    "rolled_out": rolled_out,
    "replaced": replaced,
}
"""What is measured, by name."""


def worker() -> None:
    """Answer each line of standard input, a work and a tolerance, with seconds and the answer."""
    pin()
    print(json.dumps(os.path.dirname(stickslip.__file__)), flush=True)
    for line in sys.stdin:
        name, rtol = json.loads(line)
        started = time.process_time()
        simulated, velocities = WORKS[name](rtol)
        print(json.dumps([time.process_time() - started, simulated, velocities]), flush=True)


def built(commit: str) -> Path:
    """Folder with the package of `commit`; built if it is not there."""
    git = functools.partial(subprocess.run, check=True, stdout=subprocess.PIPE)
    full = git(["git", "rev-parse", "--verify", f"{commit}^{{commit}}"]).stdout.decode().strip()
    package = BUILD / full / "package"
    if not (package / "stickslip").is_dir():
        print(f"building stickslip of {full[:7]} (some minutes)", flush=True)
        source = BUILD / full / "source"
        with tarfile.open(fileobj=io.BytesIO(git(["git", "archive", full]).stdout)) as archive:
            archive.extractall(source)
        install = ["-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps"]
        subprocess.run([sys.executable, *install, "--target", package, source], check=True)
    return package


class Version:
    """A process with the package of a folder."""

    def __init__(self, package: Path) -> None:
        paths = [str(package.resolve()), str(Path(__file__).parent)]
        self._process = subprocess.Popen(
            [sys.executable, "-c", "import against; against.worker()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OPENBLAS_NUM_THREADS": "1"},
        )
        self.package = json.loads(self._process.stdout.readline())

    def ask(self, work: str, rtol: float) -> tuple[float, float, list[float]]:
        """CPU seconds, simulated seconds and mean velocities."""
        self._process.stdin.write(json.dumps([work, rtol]) + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def close(self) -> None:
        self._process.stdin.close()
        self._process.wait()


def measured(before: Version, now: Version, work: str, repeats: int) -> dict[str, object]:
    """Costs of both versions, the ratio, and the errors of their velocities."""
    pairs = [(before.ask(work, RTOL), now.ask(work, RTOL)) for _ in range(repeats + 1)][1:]
    costs = [statistics.median(each[0] for each in mine) for mine in zip(*pairs, strict=True)]
    ratio = statistics.median(one[0] / two[0] for one, two in pairs)
    exact = np.array(now.ask(work, EXACT)[2])
    # Below 1 um/s, relative to that.
    size = np.maximum(np.abs(exact), 1e-6)
    errors = [float(np.median(np.abs(each[2] - exact) / size)) if len(exact) else 0.0
              for each in pairs[-1]]  # fmt: skip
    return {"work": work, "cpu_seconds": costs, "simulated": pairs[-1][1][1], "ratio": ratio,
            "errors": errors}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench against", description=__doc__)
    parser.add_argument("commit", help="the earlier commit, or a folder with its built package")
    parser.add_argument("--works", default=",".join(WORKS), help="separated by commas")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--out", type=Path, default=Path("bench/results/against.json"))
    options = parser.parse_args()
    package = Path(options.commit)
    package = package if (package / "stickslip").is_dir() else built(options.commit)
    before, now = Version(package), Version(Path(stickslip.__file__).parents[1])
    if before.package == now.package:
        parser.error(f"both versions are the same package: {now.package}")
    print(f"{'work':12}{'CPU s before':>13}{'now':>10}{'before / now':>14}{'errors':>20}")
    rows = []
    for work in options.works.split(","):
        rows.append(measured(before, now, work, options.repeats))
        first, second = rows[-1]["cpu_seconds"]
        errors = " ".join(f"{each:.1e}" for each in rows[-1]["errors"])
        print(
            f"{work:12}{first:13.4f}{second:10.4f}{rows[-1]['ratio']:14.2f}{errors:>20}", flush=True
        )
    before.close()
    now.close()
    saved(options.out, {"before": options.commit, "works": rows})


if __name__ == "__main__":
    main()
