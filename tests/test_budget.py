"""Runs that would take too long: refused before, or ended with what is to blame."""

import re

import pytest

from helpers import scenario
from stickslip import ScenarioError, simulate, simulate_batch, sweep

PULSES = {"drive.base": 0.5e-3, "drive.pulses": 5}


def test_a_run_stops_at_its_budget():
    twenty = scenario({**PULSES, "drive.pulses": 20})
    run = simulate(twenty.replace({"solver.max_steps": 1000}))
    assert run.status == "too_many_steps"
    # Nothing in the scenario is stiff, so the budget itself is what there is to change.
    assert "solver.max_steps = 1000 allows; raise solver.max_steps" in run.message
    assert 0.0 < run.summary()["simulated_time"] < run.scenario.duration
    assert run.summary()["steps"]["accepted"] == 1000
    enough = simulate(twenty.replace({"solver.max_steps": 100_000}))
    assert enough.ok
    assert enough.summary() == simulate(twenty).summary()


def assert_that_the_key_is_to_blame(changes, key, how):
    """The run needs more than its budget, and not with the value that its message names."""
    run = simulate(scenario(PULSES, changes))
    assert run.status == "too_many_steps"
    found = re.search(rf"{re.escape(key)} = \S+ {how} .* take a value near (\S+)$", run.message)
    assert found, run.message
    sane = simulate(scenario(PULSES, changes, {key: float(found[1])}))
    assert sane.ok, sane.message


@pytest.mark.parametrize("method", ["tsit5", "arkode"])
@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"drag.rotational": 1e-3}, "drag.rotational"),
        # The drag itself makes 4e4 1/s.
        ({"drag.linear": 1e-3, "effects.angle_drag.strength": 1e3}, "effects.angle_drag.strength"),
    ],
)
def test_a_stiff_run_names_the_key_that_makes_it_stiff(changes, key, method):
    how = {"solver.max_steps": 20_000, "solver.method": method}
    assert_that_the_key_is_to_blame({**changes, **how}, key, "makes a motion of")


PASSING = [
    # The gap within which the corner is pulled is that of rounding.
    ({"contact.adhesion_range": 3e-18, "contact.adhesion": 1e-6}, "contact.adhesion_range"),
    ({"effects.stribeck_friction.velocity": 1e-12, "contact.static_friction": 0.3,
      "contact.kinetic_friction": 0.2, "drag.linear": 1e-7}, "effects.stribeck_friction.velocity"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "key"), PASSING)
def test_a_growing_motion_is_named_if_it_made_the_steps_short(changes, key):
    most = {"solver.max_steps": 20_000}
    assert_that_the_key_is_to_blame({**changes, **most}, key, "makes a motion of")


@pytest.mark.parametrize(("changes", "key"), PASSING)
def test_a_growing_motion_is_not_named_for_a_small_budget(changes, key):
    # Such a motion is fast, and over at once: the run needs about as many steps without.
    slower = {key: 1e5 * changes[key], "solver.max_steps": 300}
    run = simulate(scenario(PULSES, changes, slower))
    assert run.status == "too_many_steps"
    assert run.message.endswith("raise solver.max_steps, or simulate less time")


# Nothing rests, so that every stretch of time takes steps.
FRICTIONLESS = {
    "drive.ramp": 0.0, "drag.linear": 1e-6, "contact.adhesion": 0.0,
    "contact.static_friction": 0.0, "contact.kinetic_friction": 0.0,
}  # fmt: skip


@pytest.mark.parametrize("method", ["tsit5", "arkode"])
@pytest.mark.parametrize("key", ["effects.sample_hold.period", "solver.max_step"])
def test_a_key_that_causes_too_many_steps_is_named(key, method):
    # 50 ms in all: as many parts as the budget has steps, beside which there are events.
    how = {key: 1e-5, "solver.max_steps": 5000, "solver.method": method}
    assert_that_the_key_is_to_blame({**FRICTIONLESS, **how}, key, "alone takes at least")


def test_strong_linear_drag_reaches_its_end():
    # m/c = 26 ns, which a million steps have to follow.
    strong, usual = (simulate(scenario(PULSES, change)) for change in ({"drag.linear": 1.0}, {}))
    assert strong.ok, strong.message
    assert 0.0 < strong.mean_velocity < 0.01 * usual.mean_velocity


@pytest.mark.parametrize(
    ("changes", "key", "allowed"),
    [
        ({"effects.sample_hold.period": 1e-12}, "effects.sample_hold.period", "0 (none) or at"),
        ({"solver.max_step": 1e-12}, "solver.max_step", "0 (no limit) or at least"),
        ({"solver.max_step": 5e-5, "solver.max_steps": 1000}, "solver.max_step", "steps = 1000"),
        ({"drive.pulses": 10**9}, "drive.pulses", "at most 5e+08"),
        ({"robot.mass": 1e-300}, "robot.mass", "from 1e-18"),
        ({"drive.frequency": 1e-7}, "drive.frequency", "from 1e-06"),
        ({"coil.side": 1e-7}, "coil.side", "from 1e-06"),
        ({"coil.turns": 1e-4}, "coil.turns", "from 0.001"),
        ({"solver.max_steps": 0}, "solver.max_steps", "from 1"),
    ],
)  # fmt: skip
def test_endless_work_is_refused_in_one_line(changes, key, allowed):
    with pytest.raises(ScenarioError) as refusal:
        simulate(scenario(PULSES, changes))
    text = str(refusal.value)
    assert text.startswith(f"{key} = ")
    assert "allowed" in text
    assert allowed in text
    assert "\n" not in text


@pytest.mark.parametrize(
    ("key", "value", "others", "before"),
    [
        ("solver.max_step", 1e-8, {"solver.max_steps": 997}, "at least "),
        ("effects.sample_hold.period", 1e-8, {"solver.max_steps": 1003}, "at least "),
        ("drive.pulses", 10**9, {"solver.max_steps": 999}, "at most "),
        ("record.rate", 1e11, {"drive.frequency": 37.0}, "here "),
        ("contact.adhesion_range", 1e-3, {"robot.height": 0.1234567e-3}, "side, "),
    ],
)
def test_a_limit_that_is_printed_is_short_and_allowed(key, value, others, before):
    with pytest.raises(ScenarioError) as refusal:
        scenario(PULSES, others, {key: value})
    limit = str(refusal.value).partition(before)[2].split()[0]
    assert len(limit) <= len("0.000123456")
    assert scenario(PULSES, others, {key: float(limit)}).get(key) == float(limit)


def test_a_budget_of_just_the_steps_that_a_run_needs_is_enough():
    needed = simulate(scenario(PULSES, {})).summary()["steps"]["accepted"]
    budget = {"solver.max_steps": needed}
    assert simulate(scenario(PULSES, budget)).status == "ok"
    assert simulate(scenario(PULSES, {"solver.max_steps": needed - 1})).status == "too_many_steps"


def test_a_point_that_is_out_of_budget_does_not_stop_a_sweep():
    values = [1e-12, 0.0]
    data = sweep(scenario(PULSES), {"effects.sample_hold.period": values})
    assert data["status"].values.tolist()[1] == 0
    assert data["message"].values[0].startswith("effects.sample_hold.period = 1e-12")
    runs = simulate_batch([scenario(PULSES, {"solver.max_steps": n}) for n in (500, 10**6)])
    assert [run.status for run in runs] == ["too_many_steps", "ok"]
