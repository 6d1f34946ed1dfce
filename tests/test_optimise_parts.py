"""Parts of the design of drives: scores and ranks, the space, sawtooths, the landscape."""

import math

import numpy as np
import pandas as pd
import pytest

from stickslip import Drive, Scenario, Waveform, optimise, simulate, simulate_batch
from stickslip.design.goal import best_first, made_goal
from stickslip.design.optimise import landscape, neighbours
from stickslip.design.sawtooth import GRID, POINTS, sawtooths
from stickslip.design.space import made_space
from stickslip.scenario.waveform import drive_waveform

START = Scenario(drive=Drive(base=0.5e-3, pulses=6, ramp=0.02))


def space_of(free, start=START, knots=None, coils=("xp",), volts=26.0):
    return made_space(start, free, knots, coils, volts)


def numbers_of(goal, drives):
    """Numbers of drives by their changes of the start, in one draw; NaN of no scenario."""
    runs = simulate_batch([START.replace(each) for each in drives])
    return np.array([[goal.numbers(run)] for run in runs])


@pytest.mark.parametrize(
    "changes", [{"drive.direction": "+x"}, {"drive.direction": "-x"}, {"drive.coils": "pairs"}]
)
def test_a_pulsed_drive_is_the_same_as_a_program(changes):
    start = START.replace(changes)
    program = start.replace(space_of({}, start, knots=4).changes({}))
    assert program.drive.mode == "program"
    assert simulate(program).final_state == simulate(start).final_state


@pytest.mark.parametrize(
    ("score", "maximised", "minimised"),
    [("q10", 1.0, 9.0), ("q25", 2.5, 7.5), ("mean", 5.0, 5.0), ("worst", 0.0, 10.0)],
)
def test_a_score_is_on_the_bad_side(score, maximised, minimised):
    values = np.arange(11.0).reshape(1, 11, 1)
    goals = {
        maximised: made_goal("power_mean", None, score, {}, {}),
        minimised: made_goal(None, "power_mean", score, {}, {}),
    }
    for expected, goal in goals.items():
        assert goal.table(values)["score"][0] == pytest.approx(expected)
    assert goal.table(values)["worst"][0] == 10.0


def test_failures_rank_behind_what_passes_a_limit_and_that_behind_what_does_not():
    goal = made_goal("mean_velocity", None, "worst", {"voltage_max": 26.0}, {})
    back = Waveform.hold(0.1, {"yp": 20.0}) + Waveform.hold(0.2, {"yp": -20.0})
    drives = [
        {"drive.mode": "program", "drive.program": back},  # the heading is lost
        {"drive.peak": 4e-3},
        {"drive.peak": 3e-3},
        {"drive.peak": 2.4e-3},
        {"drive.peak": 2.4e-3, "drive.base": 2.4e-3},  # does not move
    ]
    table = goal.table(numbers_of(goal, drives))
    assert table["exceeding"].tolist() == [1, 1, 1, 0, 0]
    assert table["failed"].tolist() == [1, 0, 0, 0, 0]
    assert best_first(goal.keys(table)) == [3, 4, 2, 1, 0]
    # Where the limits do not count, only failures are behind slower ones.
    order = best_first(goal.keys(table, limited=False))
    speeds = table["score"].to_numpy()[order[:-1]]
    assert (np.diff(speeds) <= 0.0).all()
    assert order[-1] == 0


def test_a_least_value_is_a_limit_from_below():
    speed, field = "mean_velocity", "field_max"
    goal = made_goal(None, "power_mean", "worst", {speed: 5.0}, {}, {speed: 2.0, field: 0.0})
    # The figure, the speed for both its limits, the field.
    fine, slow, fast = [5.0, 3.0, 3.0, 1.0], [1.0, 1.5, 1.5, 1.0], [1.0, 6.0, 6.0, 0.0]
    table = goal.table(np.array([[fine, fine], [fine, slow], [fast, fine]]))
    assert table["exceeding"].tolist() == [0, 1, 1]
    assert table["excess"].tolist() == pytest.approx([0.0, 0.25, 0.2])
    assert table["mean_velocity_least"].tolist() == [3.0, 1.5, 3.0]
    assert table[speed].tolist() == [3.0, 3.0, 6.0]
    assert best_first(goal.keys(table)) == [0, 2, 1]
    assert [goal.passed(table.loc[k]) for k in range(3)] == [
        [],
        ["mean_velocity 1.5 of at least 2 m/s"],
        ["mean_velocity 6 of 5 m/s"],
    ]


def test_a_weaker_drive_that_still_walks_is_found():
    free, least = {"drive.peak": (0.6e-3, 3e-3)}, {"mean_velocity": 1e-3}
    few = {"evaluations": 40, "fresh": 1, "seed": 2}
    found = optimise(START, minimise="current_max", free=free, at_least=least, **few)
    walk, start = found.run.summary(), simulate(START).summary()
    assert walk["mean_velocity"] >= 1e-3
    assert walk["current_max"] < 0.9 * start["current_max"]
    assert found.as_dict()["at_least"] == least
    with pytest.raises(ValueError, match=r"nearest has mean_velocity .* of at least 1 m/s"):
        optimise(START, minimise="current_max", free=free, at_least={"mean_velocity": 1.0}, **few)


def test_one_draw_that_fails_or_passes_a_limit_counts():
    goal = made_goal("mean_velocity", None, "mean", {"voltage_max": 10.0}, {})
    fine, over, lost = [[1.0, 9.0]] * 3, [[1.0, 9.0], [1.0, 12.0], [2.0, 9.0]], [[1.0, 9.0]] * 2
    lost += [[math.nan, math.nan]]
    table = goal.table(np.array([fine, over, lost]))
    assert table["exceeding"].tolist() == [0, 1, 1]
    assert table["excess"][:2].tolist() == pytest.approx([0.0, 0.2])
    assert best_first(goal.keys(table)) == [0, 1, 2]
    assert goal.keys(table)[2].tolist() == [1.0, 0.0, 0.0]  # failures rank by their number alone


def test_a_drive_that_makes_no_scenario_is_told_as_a_failure():
    free = {"drive.base": (8e-3, 9e-3)}  # above the peak
    with pytest.raises(ValueError, match=r"a simulation fails of all .* peak"):
        optimise(START, maximise="mean_velocity", free=free, evaluations=10)


def test_every_sawtooth_of_the_grid_is_as_strong_as_the_limit_allows():
    limit = 1.5e-3
    goal = made_goal("mean_velocity", None, "mean", {"field_max": limit}, {})
    space = space_of(
        {
            "drive.peak": (1e-3, 20e-3),
            "drive.base": (-9e-3, 9e-3),
            "drive.hold": (0.0, 20e-3),
            "drive.frequency": (50.0, 300.0),
            **{key: GRID[key] for key in ("drive.mode", "drive.edge", "drive.clamp")},
        }
    )
    of_start = numbers_of(goal, [{}])[0]
    probed = []

    def probe(drives, draw):
        probed.append((len(drives), draw))
        return numbers_of(goal, [space.changes(each) for each in drives])[:, 0]

    points = sawtooths(space, goal, of_start, probe)
    assert probed == [(POINTS, 0)]  # one run each
    assert len(points) == POINTS + 1  # the start
    fields = numbers_of(goal, points[:-1:16])[:, 0, 1]
    assert np.nanmax(fields) <= limit
    # A hundredth below it are those whose field differs where a stronger one moves the robot.
    assert np.nanmedian(fields) > 0.98 * limit


@pytest.mark.parametrize("knots", [None, 4])
def test_a_sawtooth_of_the_grid_changes_what_is_free_only(knots):
    free = {"drive.frequency": (60.0, 100.0)}
    if knots is None:
        free |= {"drive.edge": ["rise", "fall"], "drive.hold": (0.6e-3, 1.5e-3)}
    coils = ("xp", "clamp")
    goal = made_goal("mean_velocity", None, "mean", {}, {})
    points = sawtooths(space_of(free, knots=knots, coils=coils), goal, np.empty((1, 1)), None)
    varied = {key: {each[key] for each in points} for key in points[0]}
    assert sorted(varied["drive.frequency"]) == pytest.approx([60.0, 90.9, 100.0])
    # The edge, and a hold at both ends of its range and between them; or the grid, at its nearest.
    assert len(points) == (3 * 2 * 3 if knots is None else 3 * POINTS // 4) + 1  # the start
    for key, values in varied.items():
        if key not in (*free, "drive.pulses") and knots is None:
            assert values == {START.get(key)}


@pytest.mark.parametrize("pulses", [1, 6])
def test_drives_of_any_frequency_are_equally_long_but_for_the_start_up(pulses):
    start = START.replace({"drive.pulses": pulses})
    space = space_of({"drive.frequency": (5.0, 500.0), "drive.hold": (1e-3, 2e-3)}, start)
    for place in (0.0, 0.5, 1.0):
        made = START.replace(space.changes(space.values(0, place, 0.5))).drive
        # The speed is measured after the third pulse.
        assert made.pulses == max(4, round(pulses * made.frequency / START.drive.frequency))
    fixed = space_of({"drive.hold": (1e-3, 2e-3)})
    assert "drive.pulses" not in fixed.changes(fixed.values(0, 0.5))


def test_a_range_of_a_decade_is_searched_in_its_logarithm():
    space = space_of({"drive.frequency": (10.0, 1000.0), "drive.hold": (1e-3, 5e-3)})
    values = space.values(0, 0.5, 0.5)
    assert values == pytest.approx({"drive.frequency": 100.0, "drive.hold": 3e-3})
    for name, (low, high) in space.ranges.items():
        assert (space.number(name, 0.0), space.number(name, 1.0)) == (low, high)
        assert space.coordinate(name, space.number(name, 0.3)) == pytest.approx(0.3)
        assert space.coordinate(name, 2.0 * high) == 1.0


def test_the_words_of_the_start_are_the_first_arm():
    space = space_of({"drive.edge": ["fall", "rise"], "drive.mode": ["OPP", "IPP"]})
    assert space.arms[0] == {"drive.edge": "rise", "drive.mode": "IPP"}
    assert len(space.arms) == 4


def test_a_free_waveform_begins_as_the_start_drives():
    space = space_of({"drive.mode": ["IPP", "OPP"]}, knots=10, coils=("xp", "clamp"))
    times = START.drive.ramp + np.arange(10) / (10 * START.drive.frequency)
    for arm, point in enumerate(space.starts()):
        given = START.replace(space.arms[arm])
        made = START.replace(space.changes(space.values(arm, *point))).drive.program
        assert made.voltages(times) == pytest.approx(drive_waveform(given).voltages(times))


def about(space, values, score, **limits):
    """The landscape about a drive by a function to its score, by kind; and the table."""
    goal = made_goal("power_mean", None, "mean", limits, {})
    drives = [values, *neighbours(space, values)]
    scores = np.array([score(each) for each in drives])
    table = goal.table(np.repeat(scores[:, None, None], 1 + len(limits), axis=2))
    return pd.DataFrame(landscape(space, goal, drives, table)).set_index("name")


def test_the_landscape_tells_a_peak_from_a_plateau_and_an_end_first():
    space = space_of(
        {"drive.frequency": (50.0, 100.0), "drive.hold": (1e-3, 2e-3), "drive.ramp": (0.1, 0.2)}
    )
    # Falls by a quarter at a twentieth of the range of the frequency, and not at all with others.
    best = space.values(0, 0.5, 1.0, 0.5)
    found = about(space, best, lambda each: 1.0 - 0.1 * abs(each["drive.frequency"] - 75))
    assert found["kind"].tolist() == ["peak", "at a limit", "plateau"]
    assert found["loss"].tolist() == pytest.approx([0.25, 0.0, 0.0])
    assert found["at_end"].tolist() == ["", "high", ""]
    assert found["best"].tolist() == pytest.approx([75.0, 2e-3, 0.15])
    assert max(found["values"]["drive.hold"]) == 2e-3
    assert list(map(len, found["scores"])) == [9, 5, 9]


def test_a_failure_nearby_is_a_peak():
    space = space_of({"drive.hold": (1e-3, 2e-3)})
    values = space.values(0, 0.5)
    found = about(space, values, lambda each: 1.0 if each == values else math.nan)
    assert found["kind"].tolist() == ["peak"]
    assert found["loss"].tolist() == [math.inf]


@pytest.mark.parametrize("limit", [1.01, 1.04])
def test_the_landscape_tells_a_number_at_a_limit(limit):
    # The score is the place and a half. A twentieth of the range is 5 % of a score of one.
    space = space_of({"drive.hold": (1e-3, 2e-3)})
    found = about(
        space, space.values(0, 0.5), lambda each: 1e3 * each["drive.hold"] - 0.5, power_mean=limit
    )
    assert found["kind"].tolist() == ["at a limit"]
    within = np.array(found["scores"].iloc[0])[found["feasible"].iloc[0]]
    assert within.max() == pytest.approx(1.0 if limit == 1.01 else 1.02)


def test_the_velocity_along_a_heading_can_be_a_goal():
    goal = made_goal("velocity_along", None, "mean", {}, {})
    assert goal.unit == "m/s"
    run = simulate(START.replace({"drive.heading": 1.5}))
    assert goal.numbers(run) == [run.velocity[0]]
