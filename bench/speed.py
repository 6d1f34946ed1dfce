"""Speed of the simulator: `python -m bench speed`.

Protocol. One process on one core. The reference run is IPP at 100 Hz, peak 2.5 mT, base 0.5 mT,
hold 1 mT, sudden rise, 100 pulses, summaries only. CPU time is the median of repeated calls through
the Python interface, the methods measured in turn.

Equal accuracy. The error of a method at a tolerance is the root mean square, over sixteen runs with
peaks from 2.40 to 2.60 mT, of the relative difference of the mean velocity from that of `tsit5` at
rtol 1e-11; one run alone can be right by luck. CPU time against error is then interpolated in the
logarithms to the same error for both methods.
"""

from __future__ import annotations

import argparse
import math

import numpy as np
from measure import add_out, cpu_seconds_in_turn, pin, saved
from works import REFERENCE, with_solver

import stickslip
from stickslip import Scenario

PEAKS = np.linspace(2.40e-3, 2.60e-3, 16)
EQUAL_ERRORS = (1e-3, 1e-4, 1e-5)
METHODS, TOLERANCES = ("tsit5", "arkode"), (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)


def velocities(method: str, rtol: float) -> np.ndarray:
    runs = stickslip.simulate_batch(
        [
            with_solver(REFERENCE.replace({"drive.peak": float(peak)}), rtol, method)
            for peak in PEAKS
        ],
        threads=1,
    )
    return np.array([run.mean_velocity for run in runs])


def simulated_time(scenario: Scenario) -> float:
    return stickslip.simulate(scenario).summary()["simulated_time"]


def tolerance_table(repeats: int) -> list[dict[str, float | str]]:
    exact = velocities("tsit5", 1e-11)
    time = simulated_time(REFERENCE)
    rows = []
    pairs = [(method, rtol) for method in METHODS for rtol in TOLERANCES]
    scenarios = [with_solver(REFERENCE, rtol, method) for method, rtol in pairs]
    works = [lambda scenario=scenario: stickslip.simulate(scenario) for scenario in scenarios]
    costs = cpu_seconds_in_turn(works, repeats)
    for (method, rtol), cost in zip(pairs, costs, strict=True):
        error = float(np.sqrt(np.mean((velocities(method, rtol) / exact - 1.0) ** 2)))
        rows.append({"method": method, "rtol": rtol, "simulated_per_cpu_second": time / cost,
                     "velocity_error": error})  # fmt: skip
    return rows


def speed_at_error(rows: list[dict], method: str, error: float) -> float:
    """Simulated seconds a CPU second at a velocity error, interpolated in the logarithms."""
    points = sorted(
        (math.log(row["velocity_error"]), math.log(row["simulated_per_cpu_second"]))
        for row in rows
        if row["method"] == method
    )
    x, y = np.array(points).T
    if not x[0] <= math.log(error) <= x[-1]:
        return math.nan
    return math.exp(np.interp(math.log(error), x, y))


def long_run(repeats: int) -> dict[str, float]:
    scenarios = [REFERENCE.replace({"drive.pulses": pulses}) for pulses in (100, 10_000)]
    short, long = cpu_seconds_in_turn(
        [lambda scenario=scenario: stickslip.simulate(scenario) for scenario in scenarios], repeats
    )
    return {"cpu_seconds_100_pulses": short, "cpu_seconds_10000_pulses": long,
            "ratio": long / short}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=9)
    add_out(parser, "speed")
    options = parser.parse_args()
    core = pin()

    rows = tolerance_table(options.repeats)
    print(f"{'method':8} {'rtol':>7} {'simulated s / CPU s':>20} {'velocity error':>15}")
    for row in rows:
        print(
            f"{row['method']:8} {row['rtol']:7.0e} {row['simulated_per_cpu_second']:20.0f}"
            f" {row['velocity_error']:15.1e}"
        )
    equal = []
    print(f"\n{'equal velocity error':>20} {'tsit5':>8} {'arkode':>8} {'ratio':>6}")
    for error in EQUAL_ERRORS:
        own, other = (speed_at_error(rows, method, error) for method in METHODS)
        equal.append({"velocity_error": error, "tsit5": own, "arkode": other, "ratio": own / other})
        print(f"{error:20.0e} {own:8.0f} {other:8.0f} {own / other:6.1f}")
    scaling = long_run(3)
    print(f"\n100 times as many pulses cost {scaling['ratio']:.1f} times the CPU time")

    result = {"core": core, "reference_run": REFERENCE.to_toml(), "tolerances": rows,
              "equal_accuracy": equal, "long_run": scaling}  # fmt: skip
    saved(options.out, "speed", result)


if __name__ == "__main__":
    main()
