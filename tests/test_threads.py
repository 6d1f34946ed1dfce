"""Threads of Python that simulate side by side have the bits that each has alone."""

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from own_effects import nothing_stays, parameter, register  # noqa: F401 (around every test)
from stickslip import (
    Scenario,
    Simulator,
    rollout,
    simulate,
    simulate_batch,
)

BASE = Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 5, "record.rate": 2e3})
# Of eight kinds: packs, single integration, whole plane, own effect, failure, events.
CHANGES = [
    {},
    {"drive.mode": "OPP", "drive.frequency": 30.0},
    {"effects.surface_tilt.angle": 0.02},
    {"drive.heading": 0.3},
    {"effects.pushed.force": 2e-9},
    {"solver.max_steps": 500},
    {"record.rate": "events"},
    {"contact.static_friction": 0.4, "contact.kinetic_friction": 0.3},
]


@pytest.fixture
def pushed():
    def force(state, parameters):
        return parameters[0], 0.0, 0.0

    register(force, parameter("force", low=-1e-6, high=1e-6, unit="N"), name="pushed")


def work(scenario):
    """Numbers of a run, a batch, steps and a rollout, as bytes."""
    run = simulate(scenario)
    batch = simulate_batch([scenario, BASE], threads=2)
    stepped = Simulator(scenario)
    states = [stepped.step({"xp": volts}, 1e-3) for volts in (5.0, -5.0, 10.0)]
    voltages = np.full((3, 5), 4.0)
    return (
        run.status,
        run.x.tobytes(),
        [each.mean_velocity for each in batch],
        [(each.x, each.theta, each.vx) for each in states],
        rollout(BASE, None, voltages, 1e-3).states.tobytes(),
    )


def test_eight_threads_have_the_bits_of_one(pushed):
    start = threading.Barrier(len(CHANGES))

    def begin(changes):
        start.wait()
        return repr(work(BASE.replace(changes)))

    with ThreadPoolExecutor(len(CHANGES)) as pool:
        beside = list(pool.map(begin, CHANGES))
    assert beside == [repr(work(BASE.replace(changes))) for changes in CHANGES]
    assert len(set(beside)) == len(CHANGES)
