"""Runs that step together have the bits of runs alone, whatever their company and threads."""

import numpy as np
import pytest

from stickslip import Drive, Scenario, _core, simulate, simulate_batch, sweep
from stickslip.sweeping.dataset import EVENTS

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=4))

# Each kind of run that a thread may have beside others: in packs, alone, at rest, and cut short.
KINDS = [
    {},
    {"drive.mode": "OPP", "drive.hold": 2.5e-3},
    {"drive.edge": "fall", "drive.clamp": "up"},
    {"drive.direction": "-x", "contact.restitution": 0.6, "drag.linear": 1e-6},
    {"contact.static_friction": 0.05, "contact.kinetic_friction": 0.05, "drive.peak": 5e-3},
    {"drive.peak": 0.0, "drive.base": 0.0, "drive.hold": 0.0},
    {"record.rate": "events"},
    {"record.rate": 2000.0},
    {"solver.method": "arkode"},
    {"solver.max_steps": 300},
    {"solver.max_step": 2e-5},
    {"effects.surface_tilt.angle": 0.03},
    {"effects.angle_adhesion.strength": 0.5},
    {"effects.mutual_inductance.coupling": 0.1},
    {"effects.stribeck_friction.velocity": 1e-2},
]
FREQUENCIES = (15.0, 60.0, 140.0)
CHANGES = [{**kind, "drive.frequency": f} for f in FREQUENCIES for kind in KINDS]


@pytest.fixture(scope="module")
def alone():
    return [simulate(BASE.replace(changes)) for changes in CHANGES]


def exact(summary):
    """A summary without rounding: numbers as their bits."""
    return {
        key: value.hex() if isinstance(value, float) else value for key, value in summary.items()
    }


def test_the_runs_are_of_different_kinds(alone):
    assert {run.status for run in alone} == {"ok", "too_many_steps"}
    assert sum(run.ok for run in alone) == len(FREQUENCIES) * (len(KINDS) - 1)
    assert any(run.summary()["airborne_fraction"] > 0.0 for run in alone)
    assert any(run.mean_velocity == 0.0 for run in alone)


@pytest.mark.parametrize("threads", [1, 3])
def test_a_batch_gives_the_bits_of_single_runs(alone, threads):
    together = simulate_batch([BASE.replace(changes) for changes in CHANGES], threads=threads)
    assert len(together) == len(alone)
    for run, single in zip(together, alone, strict=True):
        assert exact(run.summary()) == exact(single.summary())
        assert run.recorded == single.recorded
        if single.recorded:
            for column in ("t", "x", "theta", "omega", "normal_force", "contact"):
                assert getattr(run, column).tobytes() == getattr(single, column).tobytes()


@pytest.mark.parametrize("threads", [1, 3])
def test_a_sweep_gives_the_bits_of_single_runs(alone, threads):
    # A sweep records nothing.
    places = [k for k, changes in enumerate(CHANGES) if "record.rate" not in changes]
    data = sweep(BASE, [CHANGES[k] for k in places], threads=threads)
    for point, single in zip(range(len(places)), (alone[k] for k in places), strict=True):
        at, summary = data.isel(point=point), single.summary()
        assert (int(at["status"]) == 0) == single.ok
        for name in _core.summary_numbers if single.ok else ["simulated_time"]:
            assert float(at[name]).hex() == summary[name].hex(), name
        if single.ok:
            counts = dict(zip(EVENTS, at["events"].values.tolist(), strict=True))
            assert counts == summary["events"]


def test_results_do_not_depend_on_other_runs_or_their_order(alone):
    order = np.random.default_rng(3).permutation(len(CHANGES))[:20]
    together = simulate_batch([BASE.replace(CHANGES[k]) for k in order], threads=2)
    for run, k in zip(together, order, strict=True):
        assert exact(run.summary()) == exact(alone[k].summary())
