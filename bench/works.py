"""Works by which the speed of the simulator is measured, in one table.

Each work is also run by packages of earlier commits, beside which `against` sets this one.
"""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

import stickslip
from stickslip import Contact, Drive, Law, Scenario, Waveform, _core

REFERENCE = Scenario(
    drive=Drive(mode="IPP", frequency=100.0, peak=2.5e-3, base=0.5e-3, hold=1e-3, pulses=100)
)
# Slow enough on a sticky surface to stay between the coils for 100 s.
LASTING = Scenario(
    drive=Drive(mode="OPP", frequency=200.0, base=0.5e-3, hold=1.5e-3, ramp=0.0, pulses=200),
    contact=Contact(adhesion=1e-6),
)
# A millisecond without field.
TINY = Scenario(drive=Drive(frequency=1000.0, pulses=1, ramp=0.0, hold=0.0, peak=0.0))
SWEPT = Scenario(drive=Drive(base=0.5e-3, pulses=20))
MODES = ("IPP", "OPP")
FREQUENCIES, PEAKS = np.linspace(5.0, 200.0, 40), np.linspace(1e-3, 6e-3, 25)
GRID = {"drive.frequency": FREQUENCIES, "drive.peak": PEAKS}
ALIKE = np.linspace(2.4e-3, 2.6e-3, 400)  # T, peaks of runs that differ little
STEP = 1e-3  # s
CONSTANTS = ["robot.mass", "robot.magnetization", "contact.kinetic_friction", "drag.rotational"]
ONE_LAW = {"effects.stribeck_friction.velocity": 5e-3}
THREE_LAWS = {
    **ONE_LAW,
    "effects.adhesion_ageing.rate": 0.2,
    "effects.angle_drag.strength": 0.5,
}
CURVE = {
    "laws.curve": Law(quantity="sliding_friction", over="slip_speed", form="curve", fraction=1.0,
                      scale=0.02, knots=(0.1, -0.1, 0.1, -0.1, 0.0)),
}  # fmt: skip

Answer = tuple[float, list[float]]
"""Simulated seconds, and mean velocities by which two versions are compared."""


class Work(NamedTuple):
    """A work, run at a relative tolerance.

    count: runs, steps, calls or events of one call, by which its time is divided where a figure is
        of one of them.
    """

    call: Callable[[float], Answer]
    meaning: str
    count: int = 1


def with_solver(scenario: Scenario, rtol: float, method: str = "tsit5") -> Scenario:
    return scenario.replace({"solver.method": method, "solver.rtol": rtol})


def _answer(runs: list[stickslip.Run]) -> Answer:
    return sum(run.summary()["simulated_time"] for run in runs), [r.mean_velocity for r in runs]


def _run(rtol: float, scenario: Scenario) -> Answer:
    return _answer([stickslip.simulate(with_solver(scenario, rtol))])


def _changed(changes: dict[str, object], scenario: Scenario = REFERENCE) -> Callable:
    return functools.partial(_run, scenario=scenario.replace(changes))


def _apart(rtol: float) -> Answer:
    base = with_solver(SWEPT, rtol)
    return _answer(
        [
            stickslip.simulate(base.replace({"drive.frequency": frequency, "drive.mode": mode}))
            for frequency in FREQUENCIES.tolist()
            for mode in MODES
        ]
    )


def _sweep(base: Scenario, vary: dict[str, object], threads: int = 1, **options: object) -> Answer:
    data = stickslip.sweep(base, vary, threads=threads, **options)
    return float(data["simulated_time"].sum()), data["mean_velocity"].values.ravel().tolist()


def modes_swept(rtol: float, threads: int = 1, times: int = 1) -> Answer:
    """The runs of `apart`, or `times` as many frequencies."""
    frequencies = np.linspace(FREQUENCIES[0], FREQUENCIES[-1], times * len(FREQUENCIES))
    vary = {"drive.frequency": frequencies, "drive.mode": list(MODES)}
    return _sweep(with_solver(SWEPT, rtol), vary, threads=threads)


def _swept(rtol: float) -> Answer:
    return _sweep(with_solver(SWEPT, rtol), GRID)


def _points(rtol: float) -> Answer:
    vary = {
        "drive.frequency": np.linspace(1e3, 2e3, 500),
        "contact.adhesion": np.linspace(0, 1e-6, 200),
    }
    with tempfile.TemporaryDirectory() as folder:
        return _sweep(with_solver(TINY, rtol), vary, out=Path(folder) / "points.nc")


def _alike(rtol: float) -> Answer:
    base = with_solver(REFERENCE, rtol)
    batch = [base.replace({"drive.peak": float(peak)}) for peak in ALIKE]
    return _answer(stickslip.simulate_batch(batch, threads=1))


@functools.cache
def _constants(count: int) -> np.ndarray:
    """Constants of `count` robots, drawn about the usual one."""
    usual = [SWEPT.get(key) for key in CONSTANTS]
    return usual * np.random.default_rng(count).normal(1.0, 0.05, (count, len(usual)))


@functools.cache
def _drive(rtol: float, pulses: int) -> Scenario:
    return with_solver(SWEPT.replace({"drive.pulses": pulses}), rtol)


def _asked(rtol: float, count: int, pulses: int) -> Answer:
    """The request of a descent of the diagnosis to the core: summaries of one prepared drive."""
    drive = _drive(rtol, pulses).to_core()
    columns, _ = _core.sweep(drive, CONSTANTS, _constants(count), 1, None)
    return float(columns["simulated_time"].sum()), columns["mean_velocity"].tolist()


def rows(steps: int) -> np.ndarray:
    """Voltages of a robot that walks, V, a row each millisecond."""
    made = np.zeros((steps, 5))
    made[:, 0], made[:, 4] = 26.0 - 2.0 * (np.arange(steps) % 10), -10.4
    return made


def _program(steps: int) -> Scenario:
    times = np.repeat(np.arange(steps + 1) * STEP, 2)[1:-1]
    held = Waveform.from_points(times, np.repeat(rows(steps), 2, axis=0))
    return Scenario(drive=Drive(mode="program", program=held))


def _stepped(rtol: float) -> Answer:
    simulator = stickslip.Simulator(with_solver(REFERENCE, rtol))
    for row in rows(500):
        state = simulator.step(row, STEP)
    return simulator.time, [state.x / simulator.time]


def _bare_steps(rtol: float) -> Answer:
    # 1 ns of motion is none: what is left is the way from Python into the core and back.
    simulator = stickslip.Simulator(with_solver(Scenario(), rtol))
    for _ in range(5000):
        simulator.step({"xp": 20.0, "clamp": -10.0}, 1e-9)
    return 0.0, []


def _rolled_out(rtol: float) -> Answer:
    base = with_solver(REFERENCE, rtol)
    scenarios = [base.replace({"drive.peak": float(peak)}) for peak in ALIKE[:64]]
    found = stickslip.rollout(scenarios, None, rows(100), STEP, record=("x",), threads=1)
    return 64 * 100 * STEP, (found.states[:, -1, 0] / (100 * STEP)).tolist()


def _replaced(rtol: float) -> Answer:
    base = with_solver(REFERENCE, rtol)
    for _ in range(1000):
        base.replace({"drive.peak": 2.4e-3})
    return 0.0, []


WORKS = {
    "run": Work(_changed({}), "IPP at 100 Hz, 100 pulses, summary only"),
    "law": Work(_changed(ONE_LAW), "the same with the Stribeck law of friction"),
    "laws": Work(_changed(THREE_LAWS), "the same with laws of friction, adhesion and drag"),
    "curve": Work(_changed(CURVE), "the same with a free curve of friction over slip speed"),
    "plane": Work(_changed({"drive.heading": np.pi / 6}), "the same in the whole plane, at 30 deg"),
    "events": Work(_changed({"contact.restitution": 0.7}), "the same with 2800 bounces", 2800),
    "program": Work(_changed({}, _program(500)), "held voltages, 500 of 1 ms, as a program"),
    "short": Work(_changed({}, LASTING), "200 pulses at 200 Hz on a sticky surface"),
    "long": Work(_changed({"drive.pulses": 20_000}, LASTING), "the same with 20 000 pulses"),
    "alike": Work(_alike, "a batch of 400 runs with other peaks", 400),
    "swept": Work(_swept, "a sweep over 40 frequencies and 25 peaks", 1000),
    **{
        f"batch of {count}": Work(
            functools.partial(_asked, count=count, pulses=pulses),
            f"{count} robots in one drive of {pulses} pulses, as a diagnosis asks for",
            count,
        )
        for count, pulses in ((8, 20), (24, 10), (190, 4))
    },
    "modes": Work(modes_swept, "a sweep over 40 frequencies and both modes", 80),
    "apart": Work(_apart, "the same runs one by one", 80),
    "points": Work(_points, "a sweep over 100 000 points of 1 ms without field", 100_000),
    "stepped": Work(_stepped, "500 steps of 1 ms", 500),
    "bare steps": Work(_bare_steps, "5000 steps without motion", 5000),
    "rolled out": Work(_rolled_out, "64 robots, 100 steps of 1 ms each", 6400),
    "replaced": Work(_replaced, "1000 calls of Scenario.replace", 1000),
}
"""All works by name; one thread each."""
