"""Restores without a changed bit, and what steps and rollouts cost.

`python -m bench stepping`. Exit status 1 where a bit differs or a promise is broken.
"""

from __future__ import annotations

import argparse
import collections
import json
import statistics
import sys
import time

import numpy as np
from measure import cpu_seconds_in_turn, machine, pin

from stickslip import (
    Drive,
    Scenario,
    Simulator,
    Snapshot,
    State,
    Waveform,
    rollout,
    simulate,
    simulate_batch,
)

STEPS, STEP = 64, 1.0 / 1024  # of a scenario; a power of two, so that times are exact
ADHESION = 0.22e-6


def voltages(rng: np.random.Generator) -> np.ndarray:
    """Random voltages of xp and the clamp, some of them zero."""
    rows = np.zeros((STEPS, 5))
    rows[:, 0] = rng.uniform(-25.0, 25.0, STEPS)
    rows[:, 4] = rng.uniform(-15.0, 8.0, STEPS)
    rows[rng.random(STEPS) < 0.2] = 0.0
    return rows


def program(rows: np.ndarray) -> Waveform:
    times = np.repeat(np.arange(len(rows) + 1) * STEP, 2)[1:-1]
    return Waveform.from_points(times, np.repeat(rows, 2, axis=0))


def random_scenario(rng: np.random.Generator, rows: np.ndarray) -> Scenario:
    """Robots that stick, slip, roll, bounce, jam and fly."""
    friction = rng.uniform(0.5, 6.0) if rng.random() < 0.4 else rng.uniform(0.05, 0.5)
    changes = {
        "drive.direction": str(rng.choice(["+x", "-x"])),
        "robot.mass": 25.6e-9 * rng.uniform(0.2, 2.0),
        "robot.magnetization": 5e5 * rng.uniform(0.3, 2.0),
        "contact.kinetic_friction": friction * rng.uniform(0.5, 1.0),
        "contact.static_friction": friction,
        "contact.adhesion": rng.choice([0.0, ADHESION, 5.0 * ADHESION]),
        "contact.restitution": rng.choice([0.0, rng.uniform(0.0, 0.8)]),
        "effects.surface_tilt.angle": rng.choice([0.0, rng.uniform(-0.6, 0.6)]),
        "effects.eddy_lag.time": rng.choice([0.0, 3e-4]),
        "effects.adhesion_ageing.rate": rng.choice([0.0, 0.2]),
        "record.rate": "events",
    }
    if rng.random() < 0.3:  # friction that rises as a slide slows, up to where it has no solution
        changes |= {
            "contact.static_friction": rng.uniform(2.0, 3.0),
            "contact.kinetic_friction": rng.uniform(0.3, 0.8),
            "contact.restitution": 0.0,
            "effects.stribeck_friction.velocity": 10.0 ** rng.uniform(-3.0, -1.5),
        }
    scenario = Scenario(drive=Drive(mode="program", program=program(rows)))
    return scenario.replace(changes).with_state(State(theta=float(rng.uniform(-0.4, 0.4))))


def restored(count: int) -> dict[str, object]:
    """Restores at random instants, and what was there or came in the next step."""
    rng = np.random.default_rng(1)
    seen: collections.Counter[str] = collections.Counter()
    done = different = scenarios = 0
    while done < count:
        rows = voltages(rng)
        scenario = random_scenario(rng, rows)
        whole = simulate(scenario)
        if not whole.ok:
            continue
        scenarios += 1
        run, other = Simulator(scenario), Simulator(scenario)
        states, snapshots = [], []
        for row in rows:
            snapshots.append(run.snapshot().to_bytes())
            states.append(run.step(_named(row), STEP))
        different += states[-1] != whole.final_state
        kinds = collections.defaultdict(set)
        for t, kind in zip(whole.t, whole.event, strict=True):
            kinds[int(t / STEP)].add(whole.event_names[kind])
        for step in rng.integers(1, STEPS, 20):
            before = states[step - 1]
            other.restore(Snapshot.from_bytes(snapshots[step]))
            different += other.state != before
            for after in range(step, min(step + 3, STEPS)):
                different += other.step(_named(rows[after]), STEP) != states[after]
            seen[before.contact] += 1
            seen.update(f"{kind} in the next step" for kind in kinds[step])
            if scenario.contact.adhesion > 0.0 and before.contact != "flight":
                seen["held by adhesion"] += 1
            done += 1
    return {"restores": done, "scenarios": scenarios, "different": different, **seen}


def _named(row: np.ndarray) -> dict[str, float]:
    return {"xp": row[0], "clamp": row[4]}


def cost_of_a_step() -> float:
    """Processor time of `Simulator.step` beside the core's own, us: 1 ns of motion is none."""
    sim = Simulator(Scenario())
    sim.step({"clamp": -10.0}, 0.05)
    samples = []
    for _ in range(9):
        begin = time.process_time()
        for _ in range(5000):
            sim.step({"xp": 20.0, "clamp": -10.0}, 1e-9)
        samples.append((time.process_time() - begin) / 5000)
    return 1e6 * statistics.median(samples)


def cost_of_rollouts() -> dict[str, float]:
    """Rollouts at 1 kHz beside the same drive in one call, whose edge lasts 1 ms."""
    pulses, runs = 100, 64
    drive = Drive(base=0.5e-3, edge_time=1e-3, ramp=0.01, pulses=pulses)
    scenarios = [
        Scenario(drive=drive).replace({"contact.kinetic_friction": 0.14 + 1e-4 * k})
        for k in range(runs)
    ]
    steps = round(scenarios[0].duration * 1000)
    rows = _sampled(scenarios[0], steps)
    states = rollout(scenarios, None, rows, 1e-3, hold="linear", threads=1).states
    ends = np.array([run.final_state.x for run in simulate_batch(scenarios, threads=1)])
    once, stepped, held = cpu_seconds_in_turn(
        [
            lambda: simulate_batch(scenarios, threads=1),
            lambda: rollout(scenarios, None, rows, 1e-3, hold="linear", threads=1),
            lambda: rollout(scenarios, None, rows, 1e-3, threads=1),
        ]
    )
    return {
        "difference of x at the end, um": 1e6 * float(np.abs(states[:, -1, 0] - ends).max()),
        "one call, us a ms": 1e6 * once / runs / steps,
        "rollout at 1 kHz, us a step": 1e6 * stepped / runs / steps,
        "the same with held voltages, us a step": 1e6 * held / runs / steps,
        "rollout over one call": stepped / once,
    }


def _sampled(scenario: Scenario, steps: int) -> np.ndarray:
    """Voltages of a drive at the end of each ms."""
    rows = np.zeros((steps, 5))
    start = 0.0
    marks = (np.arange(steps) + 1) * 1e-3
    for times, volts, repeats in scenario.to_core().program():
        for _ in range(repeats):
            inside = (marks > start + 1e-9) & (marks <= start + times[-1] + 1e-9)
            for coil in range(5):
                rows[inside, coil] = np.interp(marks[inside] - start, times, volts[:, coil])
            start += times[-1]
    return rows


def main() -> None:
    """Measure all, and check what is promised."""
    parser = argparse.ArgumentParser(prog="python -m bench stepping", description=__doc__)
    parser.add_argument("--restores", type=int, default=10_000)
    options = parser.parse_args()
    restores = restored(options.restores)
    pin()
    step, costs = cost_of_a_step(), cost_of_rollouts()
    result = {"restores": restores, "step beside the physics, us": step, "rollout": costs}
    print(json.dumps({"machine": machine(), **result}, indent=2))
    kept = {
        "no restored bit differs": restores["different"] == 0,
        "a step costs at most 5 us": step <= 5.0,
        "a rollout costs at most 1.3 calls": costs["rollout over one call"] <= 1.3,
    }
    broken = [name for name, holds in kept.items() if not holds]
    sys.exit("broken: " + "; ".join(broken) if broken else 0)


if __name__ == "__main__":
    main()
