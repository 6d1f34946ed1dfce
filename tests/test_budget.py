"""Runs that would take too long: refused before, or ended with what their steps followed."""

import math
import re

import pytest

from helpers import scenario
from stickslip import ScenarioError, simulate, simulate_batch, sweep

PULSES = {"drive.base": 0.5e-3, "drive.pulses": 5}


def test_a_run_stops_at_its_budget():
    twenty = scenario({**PULSES, "drive.pulses": 20})
    run = simulate(twenty.replace({"solver.max_steps": 1000}))
    assert run.status == "too_many_steps"
    assert "solver.max_steps = 1000 allows: " in run.message
    assert "raise solver.max_steps" in run.message
    assert 0.0 < run.summary()["simulated_time"] < run.scenario.duration
    assert run.summary()["steps"]["accepted"] == 1000
    enough = simulate(twenty.replace({"solver.max_steps": 100_000}))
    assert enough.ok
    assert enough.summary() == simulate(twenty).summary()


@pytest.mark.parametrize("method", ["tsit5", "arkode"])
@pytest.mark.parametrize(
    ("changes", "key", "damping_time"),
    [
        ({"drag.linear": 1e-3}, "drag.linear", 25.6e-9 / 1e-3),
        # J/c; the drag itself makes m/c = 26 us.
        ({"effects.rotational_drag.coefficient": 1e-11},
         "effects.rotational_drag.coefficient", 25.6e-9 * (250e-6**2 + 100e-6**2) / 12 / 1e-11),
        ({"drag.linear": 1e-3, "effects.angle_drag.strength": 1e3},
         "effects.angle_drag.strength", 25.6e-9 / 1e-3 / 1e3),
    ],
)  # fmt: skip
def test_a_run_out_of_budget_tells_what_its_steps_followed(changes, key, damping_time, method):
    most = 100
    how = {"solver.max_steps": most, "solver.method": method}
    run = simulate(scenario(PULSES, changes, how))
    assert run.status == "too_many_steps"
    found = re.search(
        r"steps took (\S+) s in the mean, a free swing takes (\S+) s, "
        rf"{re.escape(key)} = \S+ damps a motion in (\S+) s; look for a value in a wrong unit",
        run.message,
    )
    assert found, run.message
    step, _, damped = (float(each) for each in found.groups())
    # Six digits are printed.
    assert step == pytest.approx(run.summary()["simulated_time"] / most, rel=1e-5)
    assert damped == pytest.approx(damping_time, rel=1e-5)


def test_the_swing_of_a_message_is_that_of_the_weight_where_no_field_acts():
    length, height = 250e-6, 100e-6
    radius = math.hypot(length, height) / 2
    lifted = {"drive.base": 0.0, "drive.hold": 0.0, "drive.peak": 1e-15, "contact.adhesion": 0.0,
              "initial.z": 5e-3, "solver.max_steps": 20}  # fmt: skip
    run = simulate(scenario(PULSES, lifted))
    assert run.status == "too_many_steps"
    # (J + m r^2) Omega^2 = m g r with J = m r^2 / 3.
    swing = 2 * math.pi * math.sqrt(4 / 3 * radius / 9.81)
    assert float(re.search(r"swing takes (\S+) s", run.message)[1]) == pytest.approx(
        swing, rel=1e-5
    )


def test_strong_linear_drag_reaches_its_end():
    # m/c = 26 ns, which a million steps have to follow.
    strong, usual = (simulate(scenario(PULSES, change)) for change in ({"drag.linear": 1.0}, {}))
    assert strong.ok, strong.message
    assert 0.0 < strong.mean_velocity < 0.01 * usual.mean_velocity


@pytest.mark.parametrize(
    ("key", "value", "others", "before"),
    [
        ("solver.max_step", 1e-8, {"solver.max_steps": 997}, "at least "),
        ("effects.sample_hold.period", 1e-8, {"solver.max_steps": 1003}, "at least "),
        ("drive.pulses", 10**9, {"solver.max_steps": 999}, "at most "),
        ("record.rate", 1e11, {"drive.frequency": 37.0}, "here "),
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
