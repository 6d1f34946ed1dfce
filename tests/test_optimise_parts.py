"""Parts of the design of drives: scores and ranks, the space, sawtooths, slices."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import Drive, Scenario, ScenarioError, Waveform, simulate, simulate_batch
from stickslip.design.design_space import FEWEST, Axis, design_space, drive_waveform
from stickslip.design.goal import judge, judge_all, made_goal
from stickslip.design.landscape import slices
from stickslip.design.sawtooth import GRID, POINTS, played, sawtooths

START = Scenario(drive=Drive(base=0.5e-3, pulses=6, ramp=0.02))


def test_a_pulsed_drive_is_the_same_as_a_program():
    for direction in ("+x", "-x"):
        start = START.replace({"drive.direction": direction})
        space = design_space(start, {}, 4, ("xp",), 26.0)
        program = start.replace(played(space, {}))
        assert program.drive.mode == "program"
        assert simulate(program).final_state == simulate(start).final_state


def test_a_drive_of_pairs_of_coils_is_the_same_as_a_program():
    start = START.replace({"drive.coils": "pairs"})
    program = start.replace(played(design_space(start, {}, 4, ("xp",), 26.0), {}))
    assert simulate(program).final_state == simulate(start).final_state


def test_a_free_waveform_has_no_heading():
    with pytest.raises(ScenarioError, match=r"knots: .* drive\.heading"):
        design_space(START.replace({"drive.heading": 0.5}), {}, 4, ("xp",), 26.0)


def test_minimising_scores_the_greatest_values():
    goal = made_goal(None, "power_mean", "q10", {})
    values = np.arange(11.0)
    assert goal.scored(values) == pytest.approx(9.0)
    assert made_goal("power_mean", None, "q10", {}).scored(values) == pytest.approx(1.0)
    assert made_goal("power_mean", None, "worst", {}).scored(values) == 0.0
    assert made_goal(None, "power_mean", "mean", {}).scored(values) == pytest.approx(5.0)


def test_failures_rank_behind_what_passes_a_limit_and_that_behind_what_does_not():
    goal = made_goal("mean_velocity", None, "worst", {"voltage_max": 26.0})
    reversed_field = Waveform.hold(0.1, {"yp": 20.0}) + Waveform.hold(0.2, {"yp": -20.0})
    drives = [
        {"drive.mode": "program", "drive.program": reversed_field},
        {"drive.base": 9e-3},  # above the peak: no scenario
        {"drive.peak": 4e-3},
        {"drive.peak": 3e-3},
        {"drive.peak": 2.4e-3},
    ]
    judged = judge_all(goal, [START], drives, 1)
    ranks = [each.rank(goal.sign) for each in judged]
    assert ranks[0] == ranks[1]
    assert ranks[1:] == sorted(ranks[1:], reverse=True)
    assert len(set(ranks[1:])) == 4
    assert [each.feasible for each in judged] == [False] * 4 + [True]
    assert "peak" in judged[1].message


def test_every_sawtooth_of_the_grid_is_as_strong_as_the_limit_allows():
    limit = 1.5e-3
    goal = made_goal("mean_velocity", None, "mean", {"field_max": limit})
    free = {"drive.peak": (1e-3, 20e-3), "drive.base": (-9e-3, 9e-3), "drive.hold": (0.0, 20e-3)}
    free |= {"drive.frequency": (50.0, 300.0)}
    free |= {key: GRID[key] for key in ("drive.mode", "drive.edge", "drive.clamp")}
    space = design_space(START, free, None, (), None)
    points = sawtooths(space, goal, lambda drives: judge_all(goal, [START], drives, 2))
    assert len(points) == POINTS + 1  # the start
    runs = simulate_batch([START.replace(each) for each in points[:-1:16]])
    fields = np.array([run.summary()["field_max"] for run in runs if run.ok])
    assert fields.max() <= limit
    # A hundredth below it are those whose field differs where a stronger one moves the robot.
    assert np.median(fields) > 0.98 * limit


@pytest.mark.parametrize("pulses", [1, 6])
def test_drives_of_any_frequency_are_equally_long_but_for_the_start_up(pulses):
    # 80 pulses a second at the start; a speed is measured after the third pulse.
    space = design_space(
        START.replace({"drive.pulses": pulses}),
        {"drive.frequency": (5.0, 500.0), "drive.hold": (1e-3, 2e-3)}, None, (), None,
    )  # fmt: skip
    for place in (0.0, 0.5, 1.0):
        made = START.replace(space.changes(0, np.array([place, 0.5]))).drive
        lasting = pulses * made.frequency / START.drive.frequency
        assert made.pulses == max(FEWEST, round(lasting))
    fixed = design_space(START, {"drive.hold": (1e-3, 2e-3)}, None, (), None)
    assert START.replace(fixed.changes(0, np.array([0.5]))).drive.pulses == START.drive.pulses


def test_a_slice_tells_a_peak_from_a_plateau():
    space = design_space(
        START, {"drive.frequency": (50.0, 100.0), "drive.hold": (1e-3, 2e-3)}, None, (), None
    )
    goal = made_goal("mean_velocity", None, "mean", {})

    def evaluate(drives):
        # Falls to half within a tenth of the range of the frequency, and not at all with hold.
        return [_judged(goal, 1.0 - 0.1 * abs(each["drive.frequency"] - 75.0)) for each in drives]

    (peak, plateau), better = slices(space, 0, np.array([0.5, 1.0]), goal.sign, evaluate)
    assert better is None
    assert (peak.kind, plateau.kind) == ("peak", "plateau")
    assert peak.loss == pytest.approx(0.25)  # at 2.5 Hz, a twentieth of the range
    assert plateau.loss == 0.0
    assert (peak.at_end, plateau.at_end) == ("", "high")
    assert plateau.values.max() == 2e-3


def test_a_slice_tells_a_slope_at_a_limit_and_the_best_neighbour_within_it():
    space = design_space(START, {"drive.hold": (1e-3, 2e-3)}, None, (), None)

    def found(limit, place):
        goal = made_goal("power_mean", None, "mean", {"power_mean": limit})
        judged = functools.partial(_judged, goal)
        (about,), better = slices(
            space, 0, np.array([place]), 1.0,
            lambda drives: [judged(1e3 * each["drive.hold"] - 0.5) for each in drives],
        )  # fmt: skip
        return about.kind, better

    # The score is the place and a half. A twentieth of the range is 5 % of a score of one.
    assert found(1.01, 0.5) == ("slope at a limit", None)
    assert found(1.04, 0.5) == ("slope at a limit", pytest.approx([0.52]))
    assert found(9.0, 0.5) == ("plateau", pytest.approx([0.7]))
    # At an end the score may rise beyond it only where it rises towards it.
    assert found(9.0, 1.0) == ("plateau", None)


@pytest.mark.parametrize("knots", [None, 4])
def test_of_a_sawtooth_only_what_is_free_changes(knots):
    free = {"drive.frequency": (60.0, 100.0)}
    if knots is None:
        free |= {"drive.edge": ["fall", "rise"], "drive.hold": (0.9e-3, 1.1e-3)}
    space = design_space(START, free, knots, ("xp", "clamp"), 26.0)
    points = sawtooths(space, made_goal("mean_velocity", None, "mean", {}), None)
    varied = {key: {each[key] for each in points} for key in points[0]}
    assert sorted(varied["drive.frequency"]) == pytest.approx([60.0, 90.9, 100.0])
    # The edge, and a hold at both ends of its range and between them; or the grid, at its nearest.
    assert len(points) == (3 * 2 * 3 if knots is None else 3 * POINTS // 4) + 1  # the start
    for key, values in varied.items():
        if key not in (*free, "drive.pulses") and knots is None:
            assert values == {START.get(key)}
    if knots is None:
        for each in points:
            arm, point = space.place(each)
            assert {**space.values(arm, point), **each} == pytest.approx(each)


def _judged(goal, score):
    summary = {goal.figure: score, "theta_min": 0.0, "theta_max": 0.0}
    run = SimpleNamespace(ok=True, numbers=summary, velocity=(0.0, 0.0))
    return judge(goal, [run])


def test_a_range_of_a_decade_is_searched_in_its_logarithm():
    wide, narrow = Axis("a", "Hz", 10.0, 1000.0), Axis("b", "Hz", 10.0, 50.0)
    assert (wide.logarithmic, narrow.logarithmic) == (True, False)
    assert wide.value(0.5) == pytest.approx(100.0)
    assert narrow.value(0.5) == pytest.approx(30.0)
    for axis in (wide, narrow, Axis("c", "V", -5.0, 5.0)):
        assert (axis.value(0.0), axis.value(1.0)) == (axis.low, axis.high)
        assert axis.value(axis.coordinate(axis.value(0.3))) == pytest.approx(axis.value(0.3))


def test_a_free_waveform_begins_as_the_start_drives():
    space = design_space(START, {}, 10, ("xp", "clamp"), 26.0)
    point = space.start(0)
    period = 1.0 / START.drive.frequency
    times = START.drive.ramp + period * np.arange(10) / 10
    given = drive_waveform(START).voltages(times)
    made = START.replace(space.changes(0, point)).drive.program.voltages(times)
    assert made == pytest.approx(given)


def test_the_velocity_along_a_heading_can_be_a_goal():
    goal = made_goal("velocity_along", None, "mean", {})
    assert goal.unit == "m/s"
    start = START.replace({"drive.heading": 1.5})
    (judged,) = judge_all(goal, [start], [{"drive.peak": 2.4e-3}], 1)
    assert judged.score == simulate(start.replace({"drive.peak": 2.4e-3})).velocity[0]
