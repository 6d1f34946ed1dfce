"""Design of drives: known optima, limits in every draw, seeds, the reference sawtooth, refusals."""

import dataclasses
import functools
import sys

import numpy as np
import pytest

import stickslip.design.optimise as module
import stickslip.design.search as search_module
from helpers import HELD, NO_FIELD
from stickslip import (
    Coils,
    Drive,
    Scenario,
    ScenarioError,
    load,
    optimise,
    simulate,
)
from stickslip.design.design_space import PeriodicWaveform, as_program, drive_waveform
from stickslip.design.goal import judge_all, made_goal
from stickslip.design.sawtooth import GRID, sawtooths
from stickslip.simulation.simulate import MOST_IN_MEMORY

START = Scenario(drive=Drive(base=0.5e-3, pulses=6, ramp=0.02))
WALK = {"maximise": "mean_velocity", "free": {"drive.frequency": (40.0, 160.0)}}
LITTLE = {"draws": 3, "fresh": 5, "evaluations": 90}
TWO = {  # modes only
    **{key: values[:1] for key, values in GRID.items()},
    "drive.mode": ("IPP", "OPP"), "drive.frequency": (80.0,), "drive.base": (0.2,),
}  # fmt: skip
RESISTANCE = {"coil.resistance": {"mean": 10.0, "sd": 0.5}}
HOPPER = {  # its peaks of speed, at 115 and 150 Hz, are hops
    "robot.length": 0.4e-3, "robot.width": 0.25e-3, "robot.height": 0.15e-3,
    "contact.adhesion": 0.0, "drive.mode": "OPP",
}  # fmt: skip
SAWTOOTH = {
    "drive.frequency": (30.0, 200.0), "drive.base": (-1e-3, 2e-3), "drive.hold": (0.5e-3, 2.5e-3),
}  # fmt: skip
# Fastest without the limits of walking, over draws of friction, adhesion and drag.
FAST_SAWTOOTH = """stickslip = 1
[drive]
frequency = 159.1
peak = 5.92e-3
base = -2.54e-3
hold = 1.05e-3
pulses = 32
"""
FAST_KNOTS = {  # V, at 390 Hz
    "xp": (25.58, 25.63, 24.99, 24.12, 25.98, 21.81, 25.98, 24.66, 25.93, 25.68, 23.54, 20.46),
    "clamp": (
        -25.44,
        0.69,
        22.78,
        -12.98,
        -22.6,
        -19.61,
        -20.41,
        14.56,
        22.99,
        18.42,
        -16.8,
        -9.77,
    ),
}
SURFACE = {"contact.adhesion": {"mean": 0.22e-6, "sd": 0.03e-6}}


@pytest.fixture
def few(monkeypatch):
    """A grid of two sawtooths: what is tested is no study."""
    monkeypatch.setattr(module, "sawtooths", functools.partial(sawtooths, grid=TWO))


@pytest.fixture
def batches(monkeypatch):
    """Draws and drives of every batch that is judged."""
    judged = []

    def recorded(goal, draws, drives, *more):
        judged.append((draws, drives))
        return judge_all(goal, draws, drives, *more)

    monkeypatch.setattr(module, "judge_all", recorded)
    return judged


def test_the_largest_field_is_where_both_currents_are_at_their_limit(few):
    # |B| <= hypot(I, I) k with k the field per ampere at the centre; 1 A needs 10 of the 26 V. Of
    # coils that are less resistant the limit is reached first, and it has to hold in these too.
    held = Scenario(drive=Drive(frequency=10.0, pulses=1, ramp=0.02)).replace(HELD)
    uncertain = {"coil.resistance": {"mean": 10.0, "sd": 0.1}}
    found = optimise(
        held.with_uncertain(uncertain),
        maximise="field_max",
        score="worst",
        limits={"voltage_max": 26.0, "current_max": 1.0},
        knots=2,
        draws=4,
        evaluations=4000,
    )
    most = np.sqrt(2.0) * Coils().centre_field_per_ampere
    # In the draw of most resistance the currents are as much smaller as it is larger: four draws
    # lie within three standard deviations of 1 %, on both sides of the mean.
    assert 0.92 * most < found.judged.score <= most
    assert found.judged.worst["current_max"] <= 1.0
    assert found.active == ["current_max"]
    assert found.judged.worst["current_max"] > 0.98


@pytest.mark.nightly
@pytest.mark.parametrize(
    "more",
    [
        {"free": {"drive.hold": (0.5e-3, 2e-3), "drive.edge": ["rise", "fall"]}},
        {"knots": 4, "free": {"drive.frequency": (50.0, 200.0)}, "limits": {"voltage_max": 26.0}},
    ],
    ids=["keys", "waveform"],
)
def test_a_seed_gives_the_same_bits_on_any_number_of_threads(few, more):
    start = START.with_uncertain(SURFACE)
    one, two = (
        optimise(start, maximise="mean_velocity", threads=threads, **LITTLE, **more)
        for threads in (1, 2)
    )
    first, second = one.as_dict(), two.as_dict()
    del first["seconds"], second["seconds"]
    assert first == second
    assert one.scenario == two.scenario


def test_limits_hold_in_every_draw_of_the_search(few, batches):
    start = START.with_uncertain(RESISTANCE)
    limits = {"field_max": 2.2e-3, "power_mean": 15.0}
    free = {"drive.peak": (1e-3, 4e-3), "drive.base": (0.0, 2e-3), "drive.hold": (0.2e-3, 3e-3)}
    found = optimise(start, maximise="mean_velocity", free=free, limits=limits, seed=3, **LITTLE)
    draws, _ = batches[0]
    resistances = [each.coil.resistance for each in draws]
    assert resistances[0] < max(resistances)  # one draw alone does not tell
    assert len(set(resistances)) == LITTLE["draws"]
    for draw in draws:
        run = simulate(draw.replace(found.values))
        for name, limit in limits.items():
            assert run.summary()[name] <= limit
    # The sawtooth too is as strong as the coil of the most resistance allows, but for the
    # thousandth that is left, and what the moving robot changes.
    (judged,) = judge_all(found.goal, draws, [found.sawtooth], 1)
    assert 0.98 < max(judged.worst[name] / limit for name, limit in limits.items()) <= 1.0


@pytest.mark.parametrize("robot", [{}, HOPPER], ids=["default", "hopper"])
def test_the_drive_that_is_written_walks(robot, tmp_path):
    start = Scenario(drive=Drive(pulses=12)).replace(robot)
    walk, hop = (
        optimise(
            start, maximise="mean_velocity", free=SAWTOOTH, evaluations=200, allow_flight=flight
        )
        for flight in (False, True)
    )
    walk.save_report(tmp_path)
    run = simulate(load(tmp_path / "best.toml"))
    summary = run.summary()
    assert summary["airborne_fraction"] < 0.2
    assert -1.5 < summary["theta_min"] < summary["theta_max"] < 1.5
    assert run.mean_velocity == walk.fresh["best"].score > 0.0
    # Else the limits would not matter.
    assert hop.run.summary()["airborne_fraction"] > 0.2
    assert not robot or "it hops and does not walk" in hop.summary()


def test_the_peaks_of_speed_of_the_hopper_are_hops():
    for frequency in (115.0, 150.0):
        run = simulate(Scenario().replace({**HOPPER, "drive.frequency": frequency}))
        assert run.summary()["airborne_fraction"] > 0.5


def test_the_fastest_drives_without_limits_of_walking_get_the_note_on_flight(tmp_path):
    path = tmp_path / "fast.toml"
    path.write_text(FAST_SAWTOOTH)
    start = Scenario(drive=Drive(frequency=390.0, pulses=78))
    knots = np.concatenate([FAST_KNOTS[coil] for coil in ("xp", "clamp")])
    program = PeriodicWaveform(12, ("xp", "clamp"), 26.0).waveform(start, knots)
    for scenario in (load(path), start.replace(as_program(program, {}))):
        run = simulate(scenario)
        assert run.summary()["airborne_fraction"] > 0.5
        assert run.notes[0].code == "flight"


def test_the_limits_of_walking_are_stated_replaced_and_removed(few):
    found, own, without = (
        optimise(START, **WALK, **LITTLE, **more)
        for more in ({}, {"limits": {"airborne_fraction": 0.5}}, {"allow_flight": True})
    )
    assert found.goal.limits == {"airborne_fraction": 0.2, "tilt_max": 1.5}
    assert found.as_dict()["default_limits"] == list(found.goal.limits)
    assert found.summary().count(", default (--allow-flight removes it)") == 2
    assert own.goal.limits == {"airborne_fraction": 0.5, "tilt_max": 1.5}
    assert own.goal.assumed == ("tilt_max",)
    assert without.as_dict()["limits"] == {}


def test_where_nothing_walks_the_error_names_the_default_limit():
    start = Scenario().replace({**HOPPER, "drive.frequency": 130.0, "drive.pulses": 12})
    with pytest.raises(
        ScenarioError, match=r"airborne_fraction .* of 0\.2, default .*--allow-flight"
    ):
        optimise(
            start, maximise="mean_velocity", free={"drive.hold": (2e-3, 2.5e-3)}, evaluations=9
        )


def test_a_drive_beyond_its_limits_is_never_written_without_saying_so(tmp_path):
    # At the limit in one draw of the resistance, and so beyond it in some of others.
    start = START.with_uncertain(RESISTANCE)
    found = optimise(start, maximise="power_mean", free={"drive.hold": (0.5e-3, 2e-3)},
                     limits={"power_mean": 30.0}, draws=1, fresh=20, evaluations=40)  # fmt: skip
    best = found.fresh["best"]
    assert 0 < best.exceeding < 20
    told = f"{best.exceeding} of 20 fresh draws: power_mean {best.worst['power_mean']:.6g} of 30 W"
    found.save_report(tmp_path)
    assert load(tmp_path / "best.toml") == found.scenario
    head = (tmp_path / "best.toml").read_text().partition("\n")[0]
    texts = [found.summary(), found.as_dict()["beyond_limits"], head]
    for text in (*texts, (tmp_path / "report.html").read_text()):
        assert told in text
    assert head.startswith("# beyond the limits in ")


def test_the_score_is_that_of_the_scenario_that_is_found(few):
    found = optimise(START, knots=3, limits={"voltage_max": 26.0}, maximise="mean_velocity",
                     evaluations=40)  # fmt: skip
    run = simulate(found.scenario)
    assert run.mean_velocity == found.judged.score == found.fresh["best"].score
    assert run.summary()["voltage_max"] <= 26.0
    assert found.scenario.drive.mode == "program"
    knots = np.array([found.values[f"xp {k}"] for k in (1, 2, 3)])
    period = 1.0 / START.drive.frequency
    times = START.drive.ramp + period * (2 + np.arange(3) / 3)
    asked = found.scenario.drive.program.voltages(times)
    assert asked[:, 0] == pytest.approx(knots)
    assert not asked[:, 1:4].any()  # no coil is driven but those that are named


def test_every_stage_has_draws_of_its_own(few, batches):
    found = optimise(START.with_uncertain(RESISTANCE), **WALK, **LITTLE)
    resistances = [{each.coil.resistance for each in draws} for draws, _ in batches]
    # Searching, choosing, the landscape about the best, and the fresh draws.
    assert len(set(map(frozenset, resistances))) == 4
    about = next(k for k, (_, drives) in enumerate(batches) if len(drives) == 1 + 8)
    assert not resistances[about] & set().union(*resistances[:about])
    centre = found.slices[0].scores[found.slices[0].values == found.slices[0].best]
    judged = judge_all(found.goal, *batches[about], 1)
    assert centre == judged[0].score


def test_of_search_and_sawtooth_the_better_is_taken(few, monkeypatch):
    faster = functools.partial(sawtooths, grid={**TWO, "drive.frequency": (150.0,)})
    with monkeypatch.context() as patch:
        patch.setattr(module, "sawtooths", faster)
        found = optimise(START, **WALK, evaluations=1)  # that of the start
    scores = {name: judged.score for name, judged in found.fresh.items()}
    assert found.origin == "sawtooth"
    assert scores["sawtooth"] > scores["search"] == simulate(START).mean_velocity
    assert scores["best"] == simulate(found.scenario).mean_velocity >= scores["sawtooth"]
    assert "sawtooth of the grid is better than the search" in found.summary()
    for key in ("drive.mode", "drive.base", "drive.hold", "drive.edge"):  # are not free
        assert found.scenario.get(key) == found.sawtooth[key] == START.get(key)
    searched = optimise(START, **WALK, **LITTLE)
    assert searched.origin == "search"
    assert searched.fresh["best"].score >= searched.fresh["sawtooth"].score
    assert "is better than the search" not in searched.summary()


def test_a_sawtooth_beside_a_free_waveform_is_taken_as_a_program(few):
    options = {"maximise": "mean_velocity", "limits": {"voltage_max": 26.0}, "evaluations": 1}
    start = START.replace({"drive.frequency": 80.0})
    found = optimise(start, knots=3, **options)
    assert found.origin == "sawtooth"
    assert found.slices == []
    assert found.scenario.drive.mode == "program"
    assert simulate(found.scenario).mean_velocity == found.fresh["best"].score
    assert simulate(found.scenario).summary()["voltage_max"] <= 26.0
    assert f"drive.hold = {found.sawtooth['drive.hold']:.6g} T" in found.summary()
    # It drives no coil that the waveform may not.
    clamp = optimise(start, knots=3, coils=("clamp",), allow_flight=True, **options)
    assert clamp.sawtooth is None


def test_no_neighbour_within_the_limits_is_better(few):
    # The search sees the start alone, which lies on a slope: the bound is a field of 2 mT.
    found = optimise(START, maximise="field_max", free={"drive.peak": (1e-3, 4e-3)},
                     limits={"field_max": 2.1e-3}, evaluations=1)  # fmt: skip
    field = START.drive.peak
    assert found.moves > 0
    assert found.fresh["search"].score == simulate(START).summary()["field_max"]
    (about,) = found.slices
    assert about.scores[about.feasible].max() == found.judged.score <= 2.1e-3
    assert about.kind == "slope at a limit"
    assert "a neighbour is better within the limits" in found.summary()
    assert found.scenario.drive.peak > field


def test_the_waveform_of_a_long_drive_is_drawn(few):
    from stickslip.design.optimum_figures import waveform

    found = optimise(START, **WALK, draws=1, fresh=1, evaluations=10)
    still = START.replace({**HELD, **NO_FIELD, "drive.pulses": 26_000})
    figure = waveform(dataclasses.replace(found, scenario=still))
    times = figure.axes[2].get_lines()[0].get_xdata()
    assert still.duration * 400 * found.frequency > MOST_IN_MEMORY
    shown = (times[-1] - times[0]) * found.frequency
    assert shown == pytest.approx(3.0, abs=0.01)


def test_ctrl_c_keeps_the_best_so_far(few, monkeypatch):
    batches = []

    def interrupted(goal, draws, drives, *more):
        batches.append(drives)
        if len(batches) == 4:
            raise KeyboardInterrupt
        return judge_all(goal, draws, drives, *more)

    monkeypatch.setattr(module, "judge_all", interrupted)
    with pytest.raises(KeyboardInterrupt) as interrupt:
        optimise(START, **WALK, **LITTLE)
    found = interrupt.value.best
    assert found.interrupted
    assert found.runs == sum(map(len, batches[:3]))
    best = max(
        simulate(START.replace(each)).mean_velocity for drives in batches[:3] for each in drives
    )
    assert found.judged.score == best
    assert simulate(found.scenario).mean_velocity == best
    assert found.sawtooth is None
    assert found.slices == []


def test_the_first_stage_is_told_and_the_start_judged_before_the_library_is_loaded(monkeypatch):
    stages = []

    def interrupted():
        assert stages[0] == (0.0, "starting")
        raise KeyboardInterrupt

    monkeypatch.setattr(search_module, "_library", interrupted)
    with pytest.raises(KeyboardInterrupt) as interrupt:
        optimise(START, **WALK, **LITTLE, progress=lambda *told: stages.append(told))
    assert interrupt.value.best.scenario.drive.frequency == pytest.approx(START.drive.frequency)


def test_ctrl_c_while_fresh_draws_are_made_keeps_the_best(few, monkeypatch):
    made = []

    def draws(self, *arguments, **named):
        made.append(arguments)
        if len(made) == 2:
            raise KeyboardInterrupt
        return given(self, *arguments, **named)

    given = Scenario.draws
    monkeypatch.setattr(Scenario, "draws", draws)
    with pytest.raises(KeyboardInterrupt) as interrupt:
        optimise(START.with_uncertain(SURFACE), **WALK, **LITTLE)
    found = interrupt.value.best
    assert found.interrupted
    assert np.isfinite(found.judged.score)
    assert not found.fresh


@pytest.mark.parametrize(("batch", "limits"), [(1, {}), (3, {"voltage_max": 1.0})])
def test_ctrl_c_before_a_drive_within_the_limits_was_found_has_no_best(
    batch, limits, few, monkeypatch
):
    batches = []

    def interrupted(*arguments):
        batches.append(arguments)
        if len(batches) == batch:
            raise KeyboardInterrupt
        return judge_all(*arguments)

    monkeypatch.setattr(module, "judge_all", interrupted)
    with pytest.raises(KeyboardInterrupt) as interrupt:
        optimise(START, **{**WALK, "limits": limits}, **LITTLE)
    assert interrupt.value.best is None


def refusal(limits, free):
    with pytest.raises(ScenarioError) as refused:
        optimise(START, maximise="mean_velocity", free=free, limits=limits, evaluations=30)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_a_limit_that_nothing_satisfies_is_named_with_the_nearest_value():
    # The voltage is that of the field at the top, whatever the base is.
    text = refusal({"voltage_max": 1.0}, {"drive.base": (0.0, 2e-3)})
    assert f"voltage_max {simulate(START).summary()['voltage_max']:.6g} of 1 V" in text


def test_of_limits_that_exclude_each_other_the_nearest_drive_is_told(batches):
    # A higher base takes more power and leaves the robot less room to rock.
    limits = {"power_mean": 35.0, "theta_max": 0.6}
    text = refusal(limits, {"drive.base": (0.0, 2e-3)})
    goal = made_goal("mean_velocity", None, "q10", limits)
    tried = [each for batch in batches for each in judge_all(goal, *batch, 1)]
    for name, limit in limits.items():
        assert min(each.worst[name] for each in tried) <= limit
    nearest = min(tried, key=lambda each: each.excess)
    assert nearest.excess > 0.0
    passed = {name for name, value in nearest.worst.items() if value > limits[name]}
    assert passed == {name for name in limits if name in text}
    assert all(f"{name} {nearest.worst[name]:.6g} of" in text for name in passed)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"maximise": "speed"}, "mean_velocity"),
        ({"maximise": None}, "either maximise or minimise"),
        ({"minimise": "power_mean"}, "either maximise or minimise"),
        ({"free": None}, "nothing is free"),
        ({"free": {"drive.frequncy": (1, 2)}}, 'did you mean "drive.frequency"'),
        ({"free": {"drive.frequency": (100.0, 50.0)}}, "low below high"),
        ({"free": {"drive.frequency": (-1.0, 50.0)}}, "drive.frequency = -1.0"),
        ({"free": {"drive.frequency": 100.0}}, "(low, high)"),
        ({"free": {"drive.pulses": (10, 20)}}, "cannot be free"),
        ({"free": {"solver.rtol": (1e-9, 1e-6)}}, "cannot be free"),
        ({"free": {"drive.edge": ["rise", "drop"]}}, "drop"),
        ({"free": {"drive.mode": ["IPP", "program"]}}, "knots"),
        ({"limits": {"voltage": 3.0}}, "voltage_max"),
        ({"limits": {"voltage_max": "much"}}, "allowed is a finite number"),
        ({"limits": {"voltage_max": np.inf}, "knots": 3}, "allowed is a finite number"),
        ({"score": "q0"}, '"q10"'),
        ({"score": "best"}, '"q10"'),
        ({"draws": 0}, "draws = 0"),
        ({"evaluations": 2.5}, "evaluations = 2.5"),
        ({"seed": -1}, "seed = -1"),
        ({"knots": 12, "limits": {}}, "voltage_max"),
        ({"knots": 1}, "knots = 1"),
        ({"knots": 4, "coils": ["zp"]}, "zp"),
        ({"knots": 4, "coils": ["xp", "xp"]}, "each coil once"),
        ({"knots": 4, "free": {"drive.peak": (1e-3, 2e-3)}}, "of no use with knots"),
        (
            {"scenario": START.with_uncertain(SURFACE), "free": {"contact.adhesion": (0.0, 1e-6)}},
            "not both",
        ),
        ({"scenario": 3}, "allowed is a Scenario"),
    ],
)  # fmt: skip
def test_what_is_not_allowed_is_refused_in_one_line(changes, word):
    given = {"scenario": START, **WALK, "limits": {"voltage_max": 26.0}, **changes}
    with pytest.raises(ScenarioError) as refused:
        optimise(given.pop("scenario"), **given)
    assert word in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_program_has_no_sawtooth_and_no_period_for_knots():
    program = Scenario(drive=Drive(mode="program", program=drive_waveform(START)))
    with pytest.raises(ScenarioError, match="period is not known"):
        optimise(program, maximise="mean_velocity", knots=4, limits={"voltage_max": 26.0})
    found = optimise(program, maximise="mean_velocity", free={"robot.length": (2e-4, 3e-4)},
                     evaluations=20)  # fmt: skip
    assert found.sawtooth is None
    assert "sawtooth" not in found.fresh


def test_a_missing_library_is_named_with_its_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "cma", None)
    with pytest.raises(ImportError, match=r"stickslip\[optimise\]"):
        optimise(START, **WALK)
