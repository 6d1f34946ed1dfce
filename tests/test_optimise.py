"""Design of drives: known optima, limits in every draw, words, directions, seeds, Ctrl-C."""

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest

import stickslip.design.optimise as module
from helpers import HELD
from stickslip import Coils, Drive, Scenario, ScenarioError, load, optimise, simulate
from stickslip.design.goal import DRAGGED, make_goal
from stickslip.design.space import make_space
from stickslip.scenario.waveform import drive_waveform, volts_per_tesla

START = Scenario(drive=Drive(base=0.5e-3, pulses=6, ramp=0.02))
STILL = Scenario(drive=Drive(frequency=10.0, pulses=1, ramp=0.02)).replace(HELD)
WALK = {"maximise": "mean_velocity", "free": {"drive.frequency": (40.0, 160.0)}}
LITTLE = {"draws": 3, "fresh": 5, "evaluations": 90}
RESISTANCE = {"coil.resistance": {"mean": 10.0, "sd": 0.5}}
SURFACE = {"contact.adhesion": {"mean": 0.22e-6, "sd": 0.03e-6}}
HOPPER = {  # its peaks of speed, at 115 and 150 Hz, are hops
    "robot.length": 0.4e-3, "robot.width": 0.25e-3, "robot.height": 0.15e-3,
    "contact.adhesion": 0.0, "drive.mode": "OPP",
}  # fmt: skip
SAWTOOTH = {
    "drive.frequency": (30.0, 200.0), "drive.base": (-1e-3, 2e-3), "drive.hold": (0.5e-3, 2.5e-3),
}  # fmt: skip


@pytest.fixture
def batches(monkeypatch):
    """The scenarios of every batch; Ctrl-C comes in the batch of that index, if it is set."""
    judged = SimpleNamespace(all=[], ctrl_c=None)
    simulate_batch = module.simulate_batch

    def recorded(scenarios, *more):
        judged.all.append(list(scenarios))
        if len(judged.all) - 1 == judged.ctrl_c:
            raise KeyboardInterrupt
        return simulate_batch(scenarios, *more)

    monkeypatch.setattr(module, "simulate_batch", recorded)
    return judged


def space_of(free, start=START, knots=None, coils=("xp",)):
    return make_space(start, free, knots, coils, 26.0)


def test_the_largest_field_is_where_both_currents_are_at_their_limit():
    # |B| <= hypot(I, I) k with k the field per ampere at the centre; 1 A needs 10 of the 26 V.
    found = optimise(STILL, maximise="field_max", limits={"voltage_max": 26.0, "current_max": 1.0},
                     knots=2, evaluations=1500)  # fmt: skip
    most = np.sqrt(2.0) * Coils().centre_field_per_ampere
    assert 0.97 * most < found.table["score"]["best"] <= most
    assert 0.98 < found.table["current_max"]["best"] <= 1.0
    assert found.active == ["current_max"]


def test_a_limit_holds_for_the_worst_coil_and_not_for_the_nominal_one():
    # A field needs a voltage as the resistance: the coil of most resistance is at the limit.
    given = {"maximise": "field_max", "limits": {"voltage_max": 20.0}, "evaluations": 1200,
             "free": {"drive.peak": (1e-3, 4e-3)}, "draws": 4, "seed": 3}  # fmt: skip
    start = STILL.replace({"drive.hold": 0.0})
    uncertain = start.with_uncertain(RESISTANCE)
    draws = [each.coil for each in module._draw(uncertain, 4, [3, 0])]
    for scenario, coils in ((start, [start.coil]), (uncertain, draws)):
        most = 20.0 / max(map(volts_per_tesla, coils))
        found = optimise(scenario, **given)
        assert found.values["drive.peak"] == pytest.approx(most, rel=5e-3)
        assert found.table["voltage_max"]["search"] <= 20.0
        assert found.active == ["voltage_max"]
    assert max(each.resistance for each in draws) > 1.02 * start.coil.resistance


def test_the_best_words_on_the_average_are_not_those_in_the_worst_draw():
    # Where the liquid may be thick, a robot that is pressed down slips in every draw.
    drag = {"drag.linear": {"median": 1e-5, "factor": 4.0}}
    start = START.replace({"drive.frequency": 60.0}).with_uncertain(drag)
    words = {"drive.direction": ["+x"], "drive.mode": ["OPP", "IPP"], "drive.clamp": ["down", "up"]}
    modes = set()
    for score, of_draws in (("mean", np.mean), ("worst", np.min)):
        found = optimise(start, maximise="mean_velocity", free=words, score=score, fresh=4,
                         allow_pull=True, allow_flight=True)  # fmt: skip
        scores = {
            chosen: of_draws([
                simulate(each.replace(dict(zip(words, chosen, strict=True)))).mean_velocity
                for each in module._draw(start, 8, [0, 0])
            ])
            for chosen in itertools.product(*words.values())
        }  # fmt: skip
        assert found.runs == 4 * 8
        assert found.table["score"]["search"] == pytest.approx(max(scores.values()))
        modes.add(max(scores, key=scores.get))
        assert tuple(found.values.values()) in modes
    assert len(modes) == 2


@pytest.mark.parametrize(
    "more",
    [
        {"free": {"drive.hold": (0.5e-3, 2e-3), "drive.edge": ["rise", "fall"]}},
        {"knots": 4, "free": {"drive.frequency": (50.0, 200.0)}, "limits": {"voltage_max": 26.0}},
    ],
    ids=["keys", "waveform"],
)
def test_a_seed_gives_the_same_bits_on_any_number_of_threads(more):
    start = START.with_uncertain(SURFACE)
    one, two, other = (
        optimise(start, maximise="mean_velocity", threads=threads, seed=seed, allow_flight=True,
                 **LITTLE, **more)
        for threads, seed in ((1, 0), (2, 0), (2, 1))
    )  # fmt: skip
    assert one.as_dict() == two.as_dict()
    assert one.scenario == two.scenario != other.scenario


def test_the_drive_that_is_written_walks(tmp_path):
    start = Scenario(drive=Drive(pulses=12)).replace(HOPPER)
    given = {"maximise": "mean_velocity", "free": SAWTOOTH, "evaluations": 200}
    walk, hop = (optimise(start, allow_flight=flight, **given) for flight in (False, True))
    assert {*walk.save(tmp_path)} == {each.name for each in tmp_path.iterdir()}
    run = simulate(load(tmp_path / "best.toml"))
    summary = run.summary()
    assert summary["airborne_fraction"] < 0.2
    assert -1.5 < summary["theta_min"] < summary["theta_max"] < 1.5
    assert run.mean_velocity == walk.table["score"]["best"] > 0.0
    # Else the limits would not matter.
    assert hop.run.summary()["airborne_fraction"] > 0.2
    assert "it hops and does not walk" in hop.summary()


@pytest.mark.parametrize("coils", [{}, {"coil.side": 40e-3, "coil.distance": 30e-3}])
def test_no_drive_drags_unless_that_is_allowed(coils):
    start = START.replace({"drive.peak": 4e-3, **coils}).with_uncertain(SURFACE)
    free = {"drive.peak": (1.1e-3, 8e-3), "drive.base": (-1e-3, 1e-3)}
    given = {"maximise": "mean_velocity", "free": free, **LITTLE, "evaluations": 300}
    walk, drag = (optimise(start, allow_pull=pull, **given) for pull in (False, True))
    for draw in module._draw(start, 3, [0, 0]):  # those of the search
        run = simulate(draw.replace({**walk.values, "record.pull_share": "yes"}))
        assert run.pull_share <= DRAGGED["pull_share"]
    assert walk.run.pull_share < 0.5 < 1.0 < drag.run.pull_share
    assert "dragged" in {note.code for note in drag.run.notes}


def test_the_better_way_is_found_where_the_direction_is_not_stated():
    # It slides back: test_run_notes.py.
    start = START.replace({"drive.mode": "OPP", "drive.peak": 1.5e-3, "drive.frequency": 60.0})
    free, words = {"drive.hold": (0.8e-3, 1.2e-3)}, {"drive.direction": ["+x"]}
    either = optimise(start, maximise="mean_velocity", free=free, **LITTLE)
    assert either.values["drive.direction"] == "-x"
    assert either.run.mean_velocity > 0.0 > either.run.velocity[0]
    for figure, stated in (("mean_velocity", words), ("velocity_along", {})):
        forward = optimise(start, maximise=figure, free={**free, **stated}, **LITTLE)
        assert forward.run.mean_velocity < 0.0


def test_the_limits_of_walking_are_replaced_and_removed():
    own = optimise(START, **WALK, **LITTLE, limits={"airborne_fraction": 0.5}).as_dict()
    assert own["limits"] == {"airborne_fraction": 0.5, "tilt_max": 1.5, **DRAGGED}
    assert own["default_limits"] == ["tilt_max", "pull_share"]
    still = START.replace({"inner.mass": 1e-9})  # of which no share is known
    assert optimise(still, **WALK, **LITTLE, allow_flight=True).as_dict()["limits"] == {}


@pytest.mark.parametrize(
    ("robot", "more", "words"),
    [
        (HOPPER, {}, r"airborne_fraction .* of 0\.2, default .*--allow-flight"),
        # The voltage is that of the field at the top, whatever else.
        ({}, {"limits": {"voltage_max": 1.0}}, r"the nearest has voltage_max 25\.\d+ of 1 V"),
        (
            {},
            {"at_least": {"mean_velocity": 1.0}},
            "nearest has mean_velocity .* of at least 1 m",
        ),
        ({}, {"free": {"drive.base": (8e-3, 9e-3)}}, "each of the .* fails in a simulation.* peak"),
    ],
    ids=["hops", "voltage", "least", "no scenario"],
)
def test_where_no_drive_is_allowed_the_nearest_is_told(robot, more, words):
    start = Scenario().replace({**robot, "drive.frequency": 130.0, "drive.pulses": 12})
    free = {"free": {"drive.hold": (2e-3, 2.5e-3)}, "maximise": "mean_velocity"}
    with pytest.raises(ScenarioError, match=words):
        optimise(start, evaluations=9, **{**free, **more})


def test_a_weaker_drive_that_still_walks_is_found():
    free, least = {"drive.peak": (0.6e-3, 3e-3)}, {"mean_velocity": 1e-3}
    found = optimise(START, minimise="current_max", free=free, at_least=least, evaluations=60)
    assert found.run.mean_velocity >= 1e-3
    assert found.table["score"]["best"] < 0.9 * found.table["score"]["start"]


def test_a_drive_beyond_its_limits_is_never_written_without_saying_so(tmp_path):
    # At the limit in one draw of the resistance, and so beyond it in some of others.
    start = START.replace({"coil.resistance": 12.0}).with_uncertain(RESISTANCE)
    found = optimise(start, maximise="power_mean", free={"drive.hold": (0.5e-3, 2e-3)},
                     limits={"power_mean": 30.0}, draws=1, fresh=20, evaluations=40)  # fmt: skip
    best = found.table.loc["best"]
    assert 0 < best["exceeding"] < 20
    told = f"{best['exceeding']:.0f} of 20 fresh draws: power_mean {best['power_mean']:.6g} of 30 W"
    found.save(tmp_path)
    assert load(tmp_path / "best.toml") == found.scenario
    head = (tmp_path / "best.toml").read_text().partition("\n")[0]
    headline = found.summary().partition("\n")[0]
    for text in (headline, found.as_dict()["beyond_limits"], head):
        assert f"beyond the limits in {told}" in text


def test_a_free_waveform_is_faster_than_its_sawtooth_and_is_the_program_that_was_scored():
    found = optimise(START, knots=3, limits={"voltage_max": 26.0}, maximise="mean_velocity",
                     evaluations=200)  # fmt: skip
    run = simulate(found.scenario)
    scores = found.table["score"]
    assert run.mean_velocity == scores["search"] == scores["best"] > 1.2 * scores["start"]
    assert run.summary()["voltage_max"] <= 26.0
    assert found.scenario.drive.mode == "program"
    knots = np.array([found.values[f"xp {k}"] for k in (1, 2, 3)])
    period = 1.0 / START.drive.frequency
    times = START.drive.ramp + period * (2 + np.arange(3) / 3)
    asked = found.scenario.drive.program.voltages(times)
    assert asked[:, 0] == pytest.approx(knots)
    assert not asked[:, 1:4].any()  # no coil is driven but those that are named


@pytest.mark.parametrize(
    ("changes", "coils", "holds"),
    [
        ({"drive.frequency": (5.0, 200.0)}, ("xp", "clamp"), True),
        ({"drive.frequency": (5.0, 6.0)}, ("xp", "clamp"), False),
        ({"drive.clamp": ["up"]}, ("xp", "clamp"), False),
        ({}, ("clamp",), False),
    ],
)
def test_the_start_competes_with_waveforms_only_where_it_is_allowed(changes, coils, holds):
    assert space_of(changes, knots=4, coils=coils).holds_start == holds
    assert not space_of({"drive.frequency": (5.0, 200.0)}).holds_start


def test_every_stage_has_draws_of_its_own(batches):
    found = optimise(START.with_uncertain(RESISTANCE), **WALK, **LITTLE)
    drawn = {frozenset(each.coil.resistance for each in batch) for batch in batches.all}
    # Searching, the first for itself, choosing, fresh draws.
    assert sorted(map(len, drawn)) == [1, 2, 5, 5]
    assert len(frozenset().union(*drawn)) == 3 + 5 + 5
    last = [simulate(each).mean_velocity for each in batches.all[-1]]  # of the start, of the best
    scores = [np.quantile(each, 0.1) for each in (last[:5], last[5:])]
    assert found.table["score"][["start", "best"]].tolist() == scores


def test_ctrl_c_keeps_the_best_so_far(batches):
    batches.ctrl_c = 2
    with pytest.raises(KeyboardInterrupt) as interrupt:
        optimise(START, **{**WALK, "evaluations": 90})
    found = interrupt.value.best
    tried = [each for batch in batches.all[:2] for each in batch]
    assert found.runs == len(tried)
    runs = [simulate(each.replace({"record.pull_share": "yes"})) for each in tried]
    best = max(each.mean_velocity for each in runs if each.pull_share <= DRAGGED["pull_share"])
    assert found.table["score"]["search"] == simulate(found.scenario).mean_velocity == best
    assert found.table.index.tolist() == ["search"]


@pytest.mark.parametrize(("batch", "limits"), [(0, {}), (2, {"voltage_max": 1.0})])
def test_ctrl_c_before_a_drive_within_the_limits_was_found_has_no_best(batch, limits, batches):
    batches.ctrl_c = batch
    with pytest.raises(KeyboardInterrupt) as interrupt:
        optimise(START, **{**WALK, "limits": limits, "evaluations": 90})
    assert interrupt.value.best is None


def test_the_picture_has_all_that_it_draws_whatever_the_start_records():
    start = START.replace({"record.fields": "x"})
    volts, field = optimise(start, **WALK, evaluations=1, limits={"field_max": 4e-3}).figure().axes
    assert [each.get_label() for each in volts.get_lines()] == ["coil xp", "coil clamp"]
    assert [each.get_label() for each in field.get_lines()] == ["$B_x$", "$B_z$", "$|B|$", "limit"]
    assert field.get_lines()[-1].get_ydata()[0] == 4.0  # mT


# Parts: the goal, the space.


def test_failures_rank_behind_what_exceeds_a_limit_and_that_behind_what_does_not():
    speed, field = "mean_velocity", "field_max"
    goal = make_goal(None, "power_mean", "worst", {speed: 5.0}, {}, {speed: 2.0, field: 0.0})
    # The figure, the speed for both its limits, the field; one draw of two counts.
    fine, weak = [5.0, 3.0, 3.0, 1.0], [4.0, 3.0, 3.0, 1.0]
    slow, fast = [1.0, 1.5, 1.5, 1.0], [1.0, 6.0, 6.0, 0.0]
    drives = [[fine, fine], [fine, slow], [fast, fine], [weak, [math.nan] * 4], [weak, weak]]
    table = goal.table(np.array(drives))
    assert table["exceeding"].tolist() == [0, 1, 1, 1, 0]
    assert table["failed"].tolist() == [0, 0, 0, 1, 0]
    assert table["excess"].drop(3).tolist() == pytest.approx([0.0, 0.25, 0.2, 0.0])
    assert table["mean_velocity_least"].drop(3).tolist() == [3.0, 1.5, 3.0, 3.0]
    assert np.argsort(goal.costs(table)).tolist() == [4, 0, 2, 1, 3]
    assert [goal.exceeded(table.loc[k]) for k in range(3)] == [
        [],
        ["mean_velocity 1.5 of at least 2 m/s"],
        ["mean_velocity 6 of 5 m/s"],
    ]


@pytest.mark.parametrize(
    ("score", "maximised", "minimised"),
    [("q10", 1.0, 9.0), ("q25", 2.5, 7.5), ("mean", 5.0, 5.0), ("worst", 0.0, 10.0)],
)
def test_a_score_is_on_the_bad_side(score, maximised, minimised):
    values = np.arange(11.0).reshape(1, 11, 1)
    goals = {
        maximised: make_goal("power_mean", None, score, {}, {}),
        minimised: make_goal(None, "power_mean", score, {}, {}),
    }
    for expected, goal in goals.items():
        assert goal.table(values)["score"][0] == pytest.approx(expected)
    assert goal.table(values)["worst"][0] == 10.0


@pytest.mark.parametrize(
    "changes", [{"drive.direction": "+x"}, {"drive.direction": "-x"}, {"drive.coils": "pairs"}]
)
def test_a_pulsed_drive_is_the_same_as_a_program(changes):
    start = START.replace(changes)
    program = start.replace(space_of({}, start, knots=4).changes({}))
    assert program.drive.mode == "program"
    assert simulate(program).final_state == simulate(start).final_state


def test_drives_of_any_frequency_are_equally_long_but_for_the_start_up():
    space = space_of({"drive.frequency": (10.0, 1000.0)})  # of two decades, in its logarithm
    for place, frequency in ((0.0, 10.0), (0.5, 100.0), (1.0, 1000.0)):
        made = START.replace(space.changes(space.values(np.array([place])))).drive
        assert made.frequency == pytest.approx(frequency)
        # The speed is measured after the third pulse.
        assert made.pulses == max(4, round(6 * frequency / START.drive.frequency))


def test_a_free_waveform_begins_with_each_sawtooth_of_the_words():
    space = space_of({"drive.mode": ["OPP", "IPP"]}, knots=10, coils=("xp", "clamp"))
    times = START.drive.ramp + np.arange(10) / (10 * START.drive.frequency)
    for mode, point in zip(("IPP", "OPP"), space.starts(), strict=True):  # that of the start first
        given = START.replace({"drive.mode": mode})
        made = START.replace(space.changes(space.values(point))).drive.program
        assert made.voltages(times) == pytest.approx(drive_waveform(given).voltages(times))
