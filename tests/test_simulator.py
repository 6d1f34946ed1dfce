"""A run that is entered and left: states, steps, snapshots, rollouts and stop conditions."""

import copy
import math
import pickle
import signal
import threading
import time

import numpy as np
import pytest

from own_effects import nothing_stays, register  # noqa: F401 (around every test here)
from steps import STEP, named, random_rows
from stickslip import (
    STATE_COLUMNS,
    Accelerations,
    Coil,
    Coils,
    Drive,
    FieldMap,
    Forces,
    Robot,
    Scenario,
    ScenarioError,
    SimulationError,
    Simulator,
    Snapshot,
    State,
    Waveform,
    _core,
    rollout,
    simulate,
)


def stepped(scenario, rows, hold="constant", **begin):
    sim = Simulator(scenario, **begin)
    return [sim.step(named(row), STEP, hold) for row in rows]


@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_a_sawtooth_is_stepped_tooth_by_tooth(direction):
    low, high = {"xp": 5.0, "clamp": -10.0}, {"xp": 25.0, "clamp": -10.0}
    falls = Waveform.from_points([0.0, STEP], [[25.0, 0, 0, 0, -10.0], [5.0, 0, 0, 0, -10.0]])
    program = Waveform.ramp(0.0625, low) + 20 * falls
    scenario = Scenario(drive=Drive(mode="program", program=program, direction=direction))
    sim = Simulator(scenario)
    sim.step(low, 0.0625, "linear")
    for _ in range(20):
        state = sim.step({"xp": 5.0}, STEP, "linear", start=high)
    assert state == simulate(scenario).final_state
    assert sim.voltages == {"xp": 5.0, "xm": 0.0, "yp": 0.0, "ym": 0.0, "clamp": -10.0}
    # A jump across turns the robot, though the step ends without a voltage across.
    across = Simulator(Scenario(), whole_plane=True)
    across.step({"xp": 15.0, "clamp": -10.0}, 0.02)
    assert across.step({"yp": 0.0}, 0.02, "linear", start={"yp": 8.0}).heading > 0.0


def test_a_voltage_across_needs_a_simulator_in_the_whole_plane():
    sim = Simulator(Scenario())
    sim.step({"xp": 15.0, "clamp": -10.0}, 0.02)
    before = (sim.time, sim.state, sim.voltages)
    for step in ({"voltages": {"yp": 2.0}}, {"voltages": {}, "start": {"yp": 2.0}}):
        with pytest.raises(ScenarioError, match=r"^voltages: yp = 2, ym = 0 make .* whole_plane"):
            sim.step(**step, duration=STEP, hold="linear")
    assert (sim.time, sim.state, sim.voltages) == before
    batch = _core.SimulatorBatch([Scenario().to_core()] * 2, whole_plane=False)
    rows = np.array([[15.0, 0, 0, 0, -10.0], [15.0, 0, 2.0, 0, -10.0]])
    begun = batch_states(batch, 2)
    with pytest.raises(ValueError, match=r"^run 1: voltages: yp = 2, ym = 0 make "):
        batch.step(rows, STEP, False, 1)
    assert np.array_equal(batch_states(batch, 2), begun)
    assert not batch.statuses().any()


def test_free_fall_ends_at_the_analytic_instant():
    # Without field, fluid and magnet: the corner 1 mm above the surface arrives after sqrt(2h/g).
    robot = Robot(magnetization=0.0)
    scenario = Scenario(
        robot=robot, initial=State(z=robot.height / 2 + 1e-3), drive=Drive(pulses=100)
    ).replace({"drag.linear": 0.0, "drag.rotational": 0.0})
    run = simulate(scenario, until=f"z <= {robot.height / 2 + 1e-6!r}")
    assert run.condition_met
    fallen = math.sqrt(2.0 * (1e-3 - 1e-6) / scenario.environment.gravity)
    # The root's resolution is 1e-12 of a step, of at most 15 ms.
    assert run.summary()["simulated_time"] == pytest.approx(fallen, abs=1e-9)


# Speeds in m/s and rad/s of a body that lies flat, and what touches: of the front corner of half a
# length and half a height, which stays while the body turns nose-down about it, or of the rear one.
HALF_LENGTH, HALF_HEIGHT = 125e-6, 50e-6
BEGUN = {
    "rest": ({}, "face_stick", np.nan),
    "slides": ({"vx": 0.01}, "face_slip_forward", np.nan),
    "rises": ({"vz": 1e-3}, "flight", np.nan),
    "about the front": ({"vx": 2 * HALF_HEIGHT, "vz": 2 * HALF_LENGTH, "omega": 2.0},
                        "corner_stick", HALF_LENGTH),
    "about the rear": ({"vx": -2 * HALF_HEIGHT, "vz": 2 * HALF_LENGTH, "omega": -2.0},
                       "corner_stick", -HALF_LENGTH),
}  # fmt: skip


@pytest.mark.parametrize("case", BEGUN)
def test_the_motion_says_what_touches_at_the_start(case):
    given, contact, corner = BEGUN[case]
    scenario = Scenario(initial=State(**given)).replace({"record.rate": 1e4})
    assert Simulator(scenario).state.contact == contact
    if math.isfinite(corner):
        assert simulate(scenario).contact_x[0] == pytest.approx(corner, rel=1e-12)


def test_what_comes_down_at_the_start_lands_there():
    run = simulate(Scenario(initial=State(vz=-1e-3)).replace({"record.rate": "events"}))
    assert (run.t[0], run.event_names[run.event[0]]) == (0.0, "touch_down")


def test_what_is_not_given_of_a_start_is_at_rest_on_the_lowest_corner():
    state = Simulator(Scenario(initial=State(theta=0.3))).state
    height = HALF_LENGTH * math.sin(0.3) + HALF_HEIGHT * math.cos(0.3)
    assert (state.contact, state.z) == ("corner_stick", pytest.approx(height, rel=1e-15))
    above = Simulator(Scenario(initial=State(theta=0.3, z=state.z + 1e-6))).state
    assert above.contact == "flight"
    with pytest.raises(ScenarioError, match=r"initial\.z"):
        Scenario(initial=State(theta=0.3, z=state.z - 1e-9))


def test_the_limit_on_steps_of_the_integrator_is_one_for_each_step():
    sim = Simulator(Scenario().replace({"solver.max_steps": 500}))
    for _ in range(1000):
        sim.step({}, 1e-3)
    assert sim.status == "ok"


def test_a_coil_that_the_drive_does_not_use_may_be_stepped():
    sim = Simulator(Scenario())  # xp and clamp
    sim.step({"clamp": -10.0}, 0.05)
    before = sim.snapshot()
    reached = sim.step({"xm": -20.0}, 0.05)
    # 50 ms are seven time constants of 7 ms; the current is that of the voltage.
    assert reached.current_xm == pytest.approx(-2.0, rel=2e-3)
    assert reached.theta != 0.0
    sim.restore(before)
    assert sim.step({"xm": -20.0}, 0.05) == reached


def test_a_rollout_goes_on_from_an_array_of_states_and_writes_into_one():
    rows = random_rows(5)
    first = rollout(Scenario(), None, rows[:20], STEP, record=STATE_COLUMNS)
    out = np.zeros((1, 30, 2))
    found = rollout(Scenario(), first.states[:, -1], rows[20:], STEP, out=out)
    assert found.states is out
    assert found.columns == ("x", "theta")
    direct = stepped(Scenario(), rows[20:], state=State.from_row(first.states[0, -1]))
    assert out[0, -1].tolist() == [direct[-1].x, direct[-1].theta]


def test_a_run_that_fails_in_a_rollout_is_a_status_and_no_number():
    rows = np.zeros((400, 5))
    rows[:, 0], rows[:, 4] = 20.0, -10.0
    sliding = Scenario(initial=State(x=0.0885, vx=0.5)).replace({"drag.linear": 0.0})
    found = rollout([Scenario(), sliding], None, rows, 1e-3, threads=1)
    assert [found.status_names[each] for each in found.status] == ["ok", "left_workspace"]
    assert np.isfinite(found.states[0]).all()
    assert np.isnan(found.states[1, -1]).all()
    sim = Simulator(sliding)
    with pytest.raises(SimulationError, match="reached the coils"):
        stepped(sliding, rows)
    with pytest.raises(SimulationError, match="reached the coils"):
        sim.step({"xp": 20.0, "clamp": -10.0}, 0.4)
    with pytest.raises(SimulationError, match="has ended"):
        sim.step({}, 1e-3)
    assert sim.status == "left_workspace"


def test_a_row_that_is_not_finite_fails_alone():
    threads = 2
    # Thirteen robots, which are stepped as packs: one that an earlier rollout left as a failure,
    # one of whose state one number is missing, and two whose voltages end, of which one turns.
    rows = np.stack([random_rows(seed) for seed in range(13)])
    states = np.stack([Scenario().initial.row] * 13)
    states[3], states[5, 2] = np.nan, np.inf
    rows[7, 10:, 0], rows[9, 25, 4] = np.nan, np.inf
    rows[9, :, 0], rows[9, 12:, 2] = 15.0, 3.0
    masked = np.ma.array(np.where(np.isnan(rows), 5.0, rows), mask=np.isnan(rows))
    found = rollout(Scenario(), states, masked, STEP, record=STATE_COLUMNS, threads=threads)
    failed = {3: 0, 5: 0, 7: 10, 9: 25}  # the step in which each does
    for run in range(13):
        end = failed.get(run, len(rows[run]))
        assert found.status_names[found.status[run]] == ("not_finite" if run in failed else "ok")
        assert np.isnan(found.states[run, end:]).all()
        expected = [
            state.row for state in stepped(Scenario(), rows[run, :end], whole_plane=run == 9)
        ]
        assert found.states[run, :end].tolist() == [list(row) for row in expected]
    # The next one goes on with those that are left.
    again = rollout(Scenario(), found.states[:, -1], rows[:, :5], STEP, threads=threads)
    assert np.flatnonzero(again.status).tolist() == list(failed)
    assert np.isfinite(again.states[again.status == 0]).all()
    assert np.isnan(again.states[again.status != 0]).all()


def batch_states(batch, count):
    out = np.zeros((count, len(STATE_COLUMNS)))
    batch.states(out)
    return out


def test_a_batch_goes_on_with_those_whose_voltages_are_finite():
    threads = 2
    rows = np.stack([random_rows(seed) for seed in range(9)])
    batch = _core.SimulatorBatch([Scenario().to_core()] * 9, whole_plane=False)
    for step in range(20):
        volts = rows[:, step].copy()
        if step >= 7:
            volts[2, 3] = np.nan
        batch.step(volts, STEP, False, threads)
    found = batch_states(batch, 9)
    for run in range(9):
        expected = stepped(Scenario(), rows[run, : 7 if run == 2 else 20])[-1]
        assert found[run].tolist() == list(expected.row)
    names = [tuple(_core.statuses)[each] for each in batch.statuses()]
    assert names == ["not_finite" if run == 2 else "ok" for run in range(9)]
    batch.reset(2, Scenario().to_core())
    batch.step(rows[:, 0], STEP, False, threads)
    assert not batch.statuses().any()


def test_ctrl_c_ends_a_long_step_of_a_batch_and_leaves_it_usable():
    threads = 2
    batch = _core.SimulatorBatch([Scenario().to_core()] * 3, whole_plane=False)
    volts = np.tile([10.0, 0.0, 0.0, 0.0, -10.0], (3, 1))
    slow = Scenario().replace({"solver.max_step": 1e-6, "solver.max_steps": 10**9})
    batch.reset(1, slow.to_core())
    for _ in range(2):
        batch.step(volts, STEP, False, threads)  # after which it is known what a step takes
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        batch.step(volts, 100.0, False, threads)  # 1e8 steps of the second robot take minutes
    assert time.monotonic() - begun < 10.0  # a busy machine
    timer.join()
    assert tuple(_core.statuses)[batch.statuses()[1]] == "interrupted"
    for run in range(3):
        batch.reset(run, Scenario().to_core())
    batch.step(volts, STEP, False, threads)
    assert not batch.statuses().any()


CONDITIONS = {
    "x >= 1e-3": lambda state: state.x,
    "theta >= 0.5": lambda state: state.theta,
    "revolutions >= 0.08": lambda state: state.theta / (2 * math.pi),
}


@pytest.mark.parametrize("until", CONDITIONS)
def test_a_run_ends_where_its_condition_is_met(until):
    scenario = Scenario().replace({"record.rate": 1e4})
    run, whole = simulate(scenario, until=until), simulate(scenario)
    assert run.ok
    assert run.condition_met
    value = float(until.split()[2])
    assert CONDITIONS[until](run.final_state) == pytest.approx(value, rel=1e-9)
    # Up to there the record is that of the whole run, and it ends there.
    assert 0 <= run.summary()["simulated_time"] - run.t[-1] < 1e-4
    assert np.array_equal(run.x, whole.x[: run.samples])


@pytest.mark.parametrize("until", ["x >= -1", "time >= 0", "time >= 1e-20", "theta >= 0"])
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_a_condition_that_is_met_at_the_start_ends_the_run_there(until, direction):
    scenario = Scenario(drive=Drive(direction=direction)).replace({"record.rate": 1e3})
    run = simulate(scenario, until=until)
    assert run.condition_met
    assert run.summary()["simulated_time"] == 0.0
    assert run.t.tolist() == [0.0]
    assert run.final_state == simulate(scenario, until="x >= -1").final_state
    assert simulate(scenario.replace({"record.from": 1e-3}), until=until).samples == 0


@pytest.mark.parametrize("early", [0.0, 1e-13, 1e-9])
def test_a_time_at_the_end_of_the_drive_is_met_there(early):
    scenario = Scenario(drive=Drive(pulses=4)).replace({"record.rate": 1e3})
    whole, end = simulate(scenario), scenario.duration
    run = simulate(scenario, until=f"time >= {end - early!r}")
    assert run.condition_met
    assert run.summary()["simulated_time"] == pytest.approx(end - early, rel=1e-12)
    assert np.array_equal(run.t, whole.t[: run.samples])
    assert run.samples == whole.samples - (early == 1e-9)
    assert not simulate(scenario, until=f"time >= {end + 1e-9!r}").condition_met


def test_a_run_that_its_condition_ends_says_over_what_it_is_measured():
    scenario = Scenario(drive=Drive(pulses=12))  # from 0.08 s on
    for end in (0.06, 0.1):
        run = simulate(scenario, until=f"time >= {end}")
        summary = run.summary()
        assert summary["window_end"] == pytest.approx(max(end, scenario.window[0]), rel=1e-9)
        assert math.isfinite(run.mean_velocity) == (end > 0.08)
        assert any(note.code == "window-cut" for note in run.notes)
    unmet = simulate(scenario, until="x >= 1")
    assert not any(note.code == "window-cut" for note in unmet.notes)
    assert unmet.notes[0].code == "condition-not-met"


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


def test_a_restored_snapshot_goes_on_with_the_same_bits_after_a_step_that_failed():
    # Of a held sample the failed step leaves segments behind.
    scenario = Scenario().replace({"effects.sample_hold.period": 1e-4})
    allowed = {"xp": 20.0, "yp": 0.01, "clamp": -10.0}
    whole, failing = (Simulator(scenario, whole_plane=True) for _ in range(2))
    for sim in (whole, failing):
        sim.step(allowed, 5e-3)
    before = failing.snapshot()
    with pytest.raises(SimulationError, match="heading"):
        failing.step({"xp": -20.0}, 50e-3)
    failing.restore(before)
    for _ in range(3):
        assert failing.step(allowed, 5e-3) == whole.step(allowed, 5e-3)
        assert failing.time == whole.time


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
