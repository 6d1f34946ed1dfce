"""Runs that end as nobody knows any more where the robot faces, and those that do not."""

import math

import numpy as np
import pytest

from stickslip import (
    Drive,
    Scenario,
    SimulationError,
    Simulator,
    State,
    Waveform,
    rollout,
    simulate,
)
from stickslip.control import heading_voltages

AHEAD, ASIDE, BACK, NONE, SLIGHTLY = (
    [x, 0.0, y, 0.0, -10.0] for x, y in ((26, 0), (0, 26), (-26, 0), (0, 0), (26, 3))
)


def played(waveform, **keys):
    scenario = Scenario(drive=Drive(mode="program", program=waveform))
    return simulate(scenario.replace({key.replace("__", "."): v for key, v in keys.items()}))


@pytest.mark.parametrize(("base", "status"), [(-1e-3, "heading_lost"), (0.0, "ok")])
def test_a_field_that_comes_back_from_another_side_loses_the_heading(base, status):
    # One that only fades does not.
    drive = Drive(base=base, pulses=8, heading=math.radians(10.0))
    assert simulate(Scenario(drive=drive)).status == status


def coming_back(way, last):
    """One way, none, and then another way (rad) for `last` s, in one straight segment."""
    parts = (0.05, 0.3, 26.0), (0.1, 0.3, 0.0), (last, way, 26.0)  # s, rad, V
    holds = (Waveform.hold(s, heading_voltages(angle, volts, -10.4)) for s, angle, volts in parts)
    return played(sum(holds, start=next(holds)), record__rate=1e3)


def test_a_run_ends_at_the_instant_when_its_heading_is_lost_also_within_a_segment():
    brief, *others = (coming_back(2.5, last) for last in (0.01, 1.0, 20.0))
    summary = brief.summary()
    assert 0.15 < summary["simulated_time"] < 0.151
    assert brief.final_state.heading == pytest.approx(0.3, rel=0.1)
    assert np.max(np.abs(np.diff(brief.heading[1:]))) < 0.01
    assert "\n" not in brief.message
    for name in ("mean_velocity_y", "turning_speed"):
        assert math.isnan(summary[name])
    for run in (brief, *others):
        assert run.status == "heading_lost"
        end = run.summary()["simulated_time"]
        assert end == pytest.approx(summary["simulated_time"], rel=1e-7)
        assert run.t[-1] == brief.t[-1] <= end
    # From the same side it is known on.
    assert coming_back(0.3, 1.0).ok


def test_a_run_ends_at_the_instant_when_the_field_turns_too_fast():
    run = played(Waveform.hold(0.05, AHEAD) + Waveform.hold(2.0, [0.0, -26.0, 1.5, 0.0, -10.0]))
    assert run.status == "turns_too_fast"
    assert 0.05 < run.summary()["simulated_time"] < 0.06
    # 0.2 of the frequency of yaw, between that in the weakest field and that in 2.5 mT.
    rate, limit = (float(each.split()[-1]) for each in run.message.split(" rad/s")[:2])
    assert 100.0 < limit < min(rate, 1000.0)


@pytest.mark.parametrize("side", [0.5, 1.5, 2.5, -1.0])
@pytest.mark.parametrize(("volts", "ambient"), [(5.0, 2e-5), (26.0, 5e-5)])
def test_a_robot_stands_up_to_a_field_that_outgrows_an_ambient_one(volts, ambient, side):
    # The sum of an ambient field and one that is switched on turns as fast as its current rises.
    field = {"Bx": ambient * math.cos(side), "By": ambient * math.sin(side)}
    robot = Simulator(Scenario(effects={"ambient_field": field}))
    assert abs(robot.step([volts, 0.0, 0.0, 0.0, -10.0], 0.05).heading) < 0.1
    # Once it stands, a field that goes over to the other side ends what is known.
    with pytest.raises(SimulationError):
        robot.step([0.0, -volts, 0.02 * volts, 0.0, -10.0], 0.05)
    assert 0.05 < robot.time < 0.065


@pytest.mark.parametrize("ambient", [0.0, 1e-4])  # one that holds the robot is followed from there
@pytest.mark.parametrize("grows", [0.0, 0.15])
def test_a_field_that_goes_round_from_its_first_instant_turns_too_fast(grows, ambient):
    t = 5e-5 * np.arange(401)
    angle = 2.0 * np.pi * 400.0 * t
    volts = 26.0 * np.exp(grows * (angle - 50.0) * (grows > 0.0))
    rows = np.zeros((401, 5))
    rows[:, 0], rows[:, 2] = volts * np.cos(angle), volts * np.sin(angle)
    run = played(Waveform.from_points(t, rows), effects__ambient_field__Bx=ambient)
    assert run.status == "turns_too_fast"


def test_a_robot_that_begins_beyond_the_coils_is_told_so():
    run = simulate(Scenario().with_state(State(x=0.2)))
    assert run.status == "left_workspace"
    assert "begin nearer" in run.message


def test_the_heading_that_stays_is_the_one_at_which_the_field_became_weak():
    # The field turns by a quarter and fades, all in one segment.
    rows = np.zeros((5, 5))
    rows[:2, 0], rows[2, 2] = 10.0, 10.0
    run = played(Waveform.from_points([0.0, 0.05, 0.1, 0.15, 0.2], rows))
    assert run.ok
    assert run.final_state.heading == pytest.approx(0.5 * np.pi, rel=1e-3)


LOST = [
    [(0.05, AHEAD), (0.1, NONE), (0.05, ASIDE)],
    [(0.05, AHEAD), (0.1, BACK), (0.05, ASIDE)],
    [(0.05, AHEAD), (0.05, BACK), (0.05, AHEAD), (0.05, ASIDE)],
]
KEPT = [
    [(0.05, AHEAD), (0.02, SLIGHTLY)],
    [(0.05, NONE), (0.02, ASIDE)],
    [(0.05, AHEAD), (0.05, NONE), (0.05, AHEAD), (0.02, SLIGHTLY)],
]


@pytest.mark.parametrize("parts", [*LOST, *KEPT])
def test_a_simulator_a_rollout_and_a_program_lose_a_heading_alike(parts):
    step, status = 1e-3, "heading_lost" if parts in LOST else "ok"
    rows = np.repeat([row for _, row in parts], [round(s / step) for s, _ in parts], axis=0)
    simulator = Simulator(Scenario(), whole_plane=True)
    try:
        for row in rows:
            state = simulator.step(row, step)
    except SimulationError:
        assert simulator.time <= 0.2
    assert simulator.status == status
    found = rollout(Scenario(), None, rows[None], step, record=("x", "y", "theta", "heading"))
    assert found.status_names[found.status[0]] == status
    holds = (Waveform.hold(*part) for part in parts)
    assert played(sum(holds, start=next(holds)), initial__y=1e-12).status == status
    if status == "ok":
        expected = [getattr(state, name) for name in found.columns]
        assert found.states[0, -1].tolist() == expected
