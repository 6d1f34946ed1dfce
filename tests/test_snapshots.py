"""Snapshots and copies of simulators: they go on with the same bits, and damage is seen."""

import copy
import pickle

import numpy as np
import pytest

from own_effects import register, unregister
from steps import STEP, random_rows
from stickslip import (
    Accelerations,
    Coil,
    Coils,
    FieldMap,
    Forces,
    Scenario,
    ScenarioError,
    SimulationError,
    Simulator,
    Snapshot,
    State,
)


def test_snapshots_of_equal_simulators_are_equal_bytes_and_damage_is_seen():
    first, second = Simulator(Scenario()), Simulator(Scenario())
    for sim in (first, second):
        sim.step({"clamp": -10.0, "xp": 3.0}, 1e-3)
    data = first.snapshot().to_bytes()
    assert data == second.snapshot().to_bytes()
    assert Snapshot.from_bytes(bytearray(data)) == first.snapshot()
    assert pickle.loads(pickle.dumps(first.snapshot())) == first.snapshot()
    rng = np.random.default_rng(1)
    for place in range(len(data)):
        damaged = bytearray(data)
        damaged[place] ^= 1 << int(rng.integers(8))
        with pytest.raises(ScenarioError, match="snapshot"):
            Snapshot.from_bytes(bytes(damaged))
    with pytest.raises(ScenarioError, match="damaged"):
        Snapshot.from_bytes(data[:16] + b"\xff" * (len(data) - 16))


def _with_map(size):
    axes = [np.linspace(-half, half, 5) for half in (8e-3, 3e-3, 3e-3)]
    points = np.stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")], axis=1)
    fields = [Coils(turns=510.0 * size).field(points, one) for one in np.eye(5)]
    return Scenario(coil=Coil(map=FieldMap.from_points(points, np.stack(fields, axis=1))))


def _with_accelerations(size):
    return Scenario().replace(
        {"shake.accelerations": Accelerations([[0, 0, 0], [1e-3, size, 0], [2e-3, 0, 0]])}
    )


def _with_forces(size):
    return Scenario().replace(
        {"inner.mass": 1e-8, "inner.forces": Forces([[0, 0], [1e-3, 1e-7 * size], [2e-3, 0]])}
    )


@pytest.mark.parametrize("scenario", [_with_map, _with_accelerations, _with_forces])
def test_a_snapshot_of_another_file_is_refused(scenario):
    first, second = (Simulator(scenario(size)) for size in (1.0, 1.001))
    second.restore(second.snapshot())
    with pytest.raises(ScenarioError, match="another scenario"):
        second.restore(first.snapshot())


COPIES = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda each: pickle.loads(pickle.dumps(each)),
}


@pytest.mark.parametrize("made", COPIES.values(), ids=COPIES)
def test_a_copy_is_an_independent_simulator(made):
    # It is in the whole plane, which a copy has to take over too.
    first, *later = random_rows(5, 6)
    sim = Simulator(Scenario(), whole_plane=True)
    sim.step({"xp": 20.0, "clamp": first[4]}, STEP)
    sim.step({"yp": 5.0}, STEP)
    other = made(sim)
    expected = [sim.step({"clamp": row[4]}, STEP) for row in later]
    assert other.time == 2 * STEP
    assert other.scenario == sim.scenario
    assert [other.step({"clamp": row[4]}, STEP) for row in later] == expected
    assert expected[-1].y != 0.0
    assert sim.time == 7 * STEP


@pytest.mark.parametrize("made", COPIES.values(), ids=COPIES)
def test_a_copy_of_a_failed_simulator_has_failed(made):
    sim = Simulator(Scenario(), whole_plane=True)
    sim.step({"xp": 20.0, "yp": 0.01, "clamp": -10.0}, 5e-3)
    with pytest.raises(SimulationError):
        sim.step({"xp": -20.0}, 50e-3)
    other = made(sim)
    assert (other.status, other.time, other.state) == (sim.status, sim.time, sim.state)
    assert 5e-3 < other.time < 55e-3
    with pytest.raises(SimulationError, match="heading"):
        other.step({}, STEP)


@pytest.mark.parametrize("made", COPIES.values(), ids=COPIES)
def test_a_copy_before_the_first_step_has_the_impact_to_come(made):
    sim = Simulator(Scenario(initial=State(vz=-1e-2)))
    other = made(sim)
    assert other.step({}, STEP) == sim.step({}, STEP)


def test_an_effect_that_raises_leaves_the_simulator_where_it_was():
    raises = False

    def push(state, parameters):
        if raises:
            raise RuntimeError("no force today")
        return 1e-9 * parameters[0], 0.0, 0.0

    register(push)
    try:
        scenario = Scenario(effects={"own": {"k": 0.5}})
        sim, twin = Simulator(scenario), Simulator(scenario)
        for each in (sim, twin):
            each.step({"clamp": -10.0, "xp": 5.0}, 10 * STEP)
        raises = True
        with pytest.raises(RuntimeError, match="today"):
            sim.step({"xp": 20.0}, 10 * STEP)
        raises = False
        assert (sim.status, sim.time, sim.state) == (twin.status, twin.time, twin.state)
        assert sim.voltages == twin.voltages
        assert sim.step({"xp": -5.0}, STEP) == twin.step({"xp": -5.0}, STEP)
    finally:
        unregister("own")
