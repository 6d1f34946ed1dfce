"""Cost of parameter sweeps: `python -m bench sweep`.

Protocol. The sweep has 40 frequencies from 5 to 200 Hz in both modes, 20 pulses each. Its CPU time
on one thread is compared with that of the same runs one by one, in turn; the ratio is the median.
The speed-up is the wall time with one thread over that with several, for ten times as many
frequencies, in turn; the median and the best are given, as other work on the machine can only lower
it. The overhead is the CPU time of 100 000 points of one millisecond without field.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np
from measure import saved, timed

from stickslip import Drive, Scenario, simulate, sweep

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=20))
MODES = ["IPP", "OPP"]
TINY = Scenario(drive=Drive(frequency=1000.0, pulses=1, ramp=0.0, hold=0.0, peak=0.0))


def grid(count: int) -> dict[str, object]:
    return {"drive.frequency": np.linspace(5.0, 200.0, count), "drive.mode": MODES}


def against_single_runs(repeats: int) -> dict[str, float]:
    frequencies = np.linspace(5.0, 200.0, 40).tolist()

    def one_by_one() -> None:
        for frequency in frequencies:
            for mode in MODES:
                simulate(BASE.replace({"drive.frequency": frequency, "drive.mode": mode}))

    simulated = float(sweep(BASE, grid(40), threads=1)["simulated_time"].sum())
    pairs = [
        (timed(lambda: sweep(BASE, grid(40), threads=1)), timed(one_by_one)) for _ in range(repeats)
    ]
    together, single = (statistics.median(column) for column in zip(*pairs, strict=True))
    return {
        "simulated_seconds": simulated,
        "sweep_cpu_seconds": together,
        "single_runs_cpu_seconds": single,
        "sweep_simulated_per_cpu_second": simulated / together,
        "ratio": statistics.median(first / second for first, second in pairs),
    }


def speed_up(repeats: int, jobs: int) -> dict[str, float]:
    def wall(threads: int) -> float:
        return timed(lambda: sweep(BASE, grid(400), threads=threads), time.perf_counter)

    pairs = [(wall(1), wall(jobs)) for _ in range(repeats)]
    ratios = [one / several for one, several in pairs]
    return {
        "threads": jobs,
        "one_thread_seconds": min(one for one, _ in pairs),
        "seconds": min(several for _, several in pairs),
        "speed_up_median": statistics.median(ratios),
        "speed_up_best": max(ratios),
    }


def overhead(repeats: int) -> dict[str, float]:
    vary = {
        "drive.frequency": np.linspace(1e3, 2e3, 500),
        "contact.adhesion": np.linspace(0, 1e-6, 200),
    }
    costs = []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(repeats):
            path = Path(folder) / f"{number}.nc"
            costs.append(timed(lambda path=path: sweep(TINY, vary, threads=1, out=path)))
        size = path.stat().st_size
    return {
        "points": 100_000,
        "cpu_microseconds_a_point": statistics.median(costs) / 100_000 * 1e6,
        "file_megabytes": size / 1e6,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("bench/results/sweep.json"))
    options = parser.parse_args()

    sweep(BASE, grid(2))  # imports
    load = os.getloadavg()[0]
    result = {
        "load_before": load,
        "against_single_runs": against_single_runs(options.repeats),
        "threads": speed_up(options.repeats, options.jobs),
        "overhead": overhead(3),
    }
    for name, figures in result.items():
        print(name, figures)
    saved(options.out, result)


if __name__ == "__main__":
    main()
