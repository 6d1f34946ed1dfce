"""One version of stickslip under `bench/against.py`: measures what it is told, a line each.

A line of standard input is a name of `REQUESTS` and its arguments as JSON; the answer is a line of
JSON. A workload is prepared and run once when it is asked for first, so that neither counts.
"""

from __future__ import annotations

import functools
import inspect
import itertools
import json
import os
import sys
import time
from collections.abc import Callable

import numpy as np
from measure import pin
from speed import PEAKS, REFERENCE, velocities, with_solver

import stickslip
from stickslip import Drive, Scenario

RTOL = 1e-6
FREQUENCIES = np.linspace(5.0, 200.0, 40)  # Hz
SWEPT_PEAKS = np.linspace(1e-3, 6e-3, 25)  # T
MIXED = [
    with_solver(
        Scenario(drive=Drive(mode=mode, frequency=frequency, peak=peak, base=0.5e-3, pulses=20)),
        "tsit5",
        RTOL,
    )
    for mode, frequency, peak in itertools.product(
        ("IPP", "OPP"), (10.0, 40.0, 100.0, 160.0), (1.5e-3, 3.5e-3)
    )
]
ALIKE = [
    with_solver(REFERENCE.replace({"drive.peak": float(peak)}), "tsit5", RTOL)
    for peak in np.linspace(2.4e-3, 2.6e-3, 400)
]

Answer = tuple[float, list[float]]  # simulated seconds, mean velocities


def summed(runs) -> Answer:
    """Of runs that were simulated."""
    return sum(run.summary()["simulated_time"] for run in runs), [run.mean_velocity for run in runs]


def one(rtol: float) -> Answer:
    """The reference run."""
    return summed([stickslip.simulate(with_solver(REFERENCE, "tsit5", rtol))])


def mixed(rtol: float) -> Answer:
    """Sixteen different runs in both modes, one by one."""
    return summed([stickslip.simulate(with_solver(each, "tsit5", rtol)) for each in MIXED])


# An earlier version had another name for it.
_THREADS = "threads" if "threads" in inspect.signature(stickslip.sweep).parameters else "jobs"


def swept(rtol: float, jobs: int = 1) -> Answer:
    """A sweep over frequency and peak."""
    base = Scenario(drive=Drive(base=0.5e-3, pulses=20))
    data = stickslip.sweep(
        with_solver(base, "tsit5", rtol),
        {"drive.frequency": FREQUENCIES, "drive.peak": SWEPT_PEAKS},
        **{_THREADS: jobs},
    )
    return float(data["simulated_time"].sum()), data["mean_velocity"].values.ravel().tolist()


def alike(rtol: float) -> Answer:
    """A batch of runs that differ little."""
    batch = [with_solver(each, "tsit5", rtol) for each in ALIKE]
    return summed(stickslip.simulate_batch(batch, threads=1))


def plane(rtol: float) -> Answer:
    """The reference run at a heading of half a radian, in the whole plane."""
    turned = REFERENCE.replace({"drive.heading": 0.5})
    return summed([stickslip.simulate(with_solver(turned, "tsit5", rtol))])


def long(rtol: float) -> Answer:
    """Two thousand pulses."""
    pulses = REFERENCE.replace({"drive.pulses": 2000})
    return summed([stickslip.simulate(with_solver(pulses, "tsit5", rtol))])


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
    rows = _rows(100)
    found = stickslip.rollout(scenarios, None, rows, 1e-3, record=("x",), threads=1)
    return 64 * 0.1, (found.states[:, -1, 0] / 0.1).tolist()


def replaced() -> Answer:
    """`Scenario.replace` of one key."""
    REFERENCE.replace({"drive.peak": 2.4e-3})
    return 0.0, []


def converted() -> Answer:
    """`Scenario.to_core`."""
    REFERENCE.to_core()
    return 0.0, []


WORKS: dict[str, Callable[..., Answer]] = {
    each.__name__: each
    for each in (one, mixed, swept, alike, plane, long, stepped, rolled_out, replaced, converted)
}


@functools.cache
def prepared(name: str, arguments: str) -> tuple[Callable[[], Answer], int, float]:
    """A workload, how often it is repeated within a measurement, and its simulated seconds."""
    work = functools.partial(WORKS[name], **json.loads(arguments))
    started = time.process_time()
    simulated, _ = work()
    spent = max(time.process_time() - started, 1e-6)
    return work, max(1, round(0.05 / spent)), simulated


def measured(name: str, clock: str = "process_time", **arguments) -> dict[str, float]:
    """Seconds of one call by a clock of `time`, and simulated seconds."""
    work, inner, simulated = prepared(name, json.dumps(arguments))
    now = getattr(time, clock)
    started = now()
    for _ in range(inner):
        work()
    return {"seconds": (now() - started) / inner, "simulated": simulated}


def found(name: str, **arguments) -> list[float]:
    """The mean velocities of a workload, m/s."""
    return WORKS[name](**arguments)[1]


def about_reference(rtol: float) -> list[float]:
    """The mean velocities of the runs over which speed.py takes its error, m/s."""
    return velocities("tsit5", rtol).tolist()


def identity() -> dict[str, object]:
    """Which package this process has."""
    return {"package": os.path.dirname(stickslip.__file__), "peaks": len(PEAKS)}


REQUESTS = {each.__name__: each for each in (measured, found, about_reference, identity)}


def main() -> None:
    if "--unpinned" not in sys.argv:
        pin()
    for line in sys.stdin:
        name, arguments = json.loads(line)
        print(json.dumps(REQUESTS[name](**arguments)), flush=True)


if __name__ == "__main__":
    main()
