"""Random scenarios over wide ranges: each ends, with finite numbers and a possible motion."""

import math
import subprocess
import sys

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from helpers import MOMENT, WEIGHT, violations
from stickslip import Scenario, simulate

STEPS_AT_MOST = 10**6  # a run of a few pulses takes some thousand; what takes more goes nowhere

SETTINGS = {
    "derandomize": True,
    "deadline": None,
    "database": None,
    "suppress_health_check": list(HealthCheck),
    # A failing example is reported as it was drawn; shrinking it would take minutes.
    "phases": (Phase.explicit, Phase.generate),
}


# Drawn as whole numbers, which hypothesis spreads over the range; floats it would crowd about zero.
STEPS = 10**6


def number(low, high):
    """Uniform, with both ends likely."""
    inside = st.integers(0, STEPS).map(lambda k: low + (high - low) * k / STEPS)
    return st.one_of(st.sampled_from([low, high]), inside, inside)


def decades(low, high):
    return st.integers(0, STEPS).map(lambda k: low * (high / low) ** (k / STEPS))


def often(value, other):
    return st.one_of(st.just(value), st.just(value), other)


@st.composite
def scenarios(draw, restitution):
    frequency = draw(decades(1.0, 500.0))
    static = draw(number(0.0, 3.0))
    base = draw(number(0.0, 5e-3))
    keys = {
        "drive.mode": draw(st.sampled_from(["IPP", "OPP"])),
        "drive.frequency": frequency,
        "drive.base": base,
        "drive.peak": draw(number(base, 10e-3)),
        "drive.hold": draw(number(0.0, 10e-3)),
        "drive.clamp": draw(st.sampled_from(["down", "up"])),
        "drive.edge": draw(st.sampled_from(["rise", "fall"])),
        "drive.edge_time": draw(often(0.0, number(0.0, 0.9 / frequency))),
        "drive.direction": draw(st.sampled_from(["+x", "-x"])),
        "drive.ramp": draw(st.sampled_from([0.0, 0.05])),
        "drive.pulses": draw(st.integers(1, 5)),
        "contact.static_friction": static,
        "contact.kinetic_friction": static * draw(number(0.0, 1.0)),
        "contact.adhesion": draw(number(0.0, 1e-6)),
        "contact.restitution": draw(restitution),
        "effects.surface_tilt.angle": draw(often(0.0, number(-0.5, 0.5))),
    }
    return Scenario().replace(keys)


def may_leave(scenario):
    """Whether weight and coils can push the robot out of the set-up: that is no failure.

    A coil's field falls by 18.7 times itself a metre at the centre, so that is what pulls; friction
    holds with what is left of weight and adhesion; and nothing slides faster than drag lets it. The
    pull grows on the way, so half the way to the coils is taken for all of it.
    """
    drive, contact = scenario.drive, scenario.contact
    tilt = abs(scenario.get("effects.surface_tilt.angle"))
    pull = MOMENT * 18.7 * (max(drive.peak, drive.base) + drive.hold)
    normal = max(0.0, WEIGHT * math.cos(tilt) + contact.adhesion - pull)
    push = WEIGHT * math.sin(tilt) + pull - contact.kinetic_friction * normal
    return push / scenario.drag.linear * scenario.duration > 0.5 * scenario.coil.distance


def simulated(scenario, endless=False, **more):
    """A run of the scenario that has ended soon and is finite.

    endless: bounces that lose nothing may go on until the run is given up.
    """
    run = simulate(scenario.replace({f"{key}": value for key, value in more.items()}))
    text = scenario.to_toml()
    steps = run.summary()["steps"]
    most = 10 * STEPS_AT_MOST if endless else STEPS_AT_MOST
    assert steps["accepted"] + steps["rejected"] < most, f"{steps}:\n{text}"
    given_up = endless and run.status == "too_many_events"
    fine = run.ok or given_up or (run.status == "left_workspace" and may_leave(scenario))
    assert fine, f"{run.message}:\n{text}"
    for name, value in run.summary().items():
        if isinstance(value, float) and run.ok:
            assert math.isfinite(value), f"{name} = {value}:\n{text}"
    return run


def assert_sound(scenario, rtol, slack, speed_slack, gap_slack=0.0):
    for rate in ("events", 5e3):
        run = simulated(scenario, **{"record.rate": rate, "solver.rtol": rtol})
        # A body that cannot stick from the start has its first sample before it slips.
        found = violations(
            run, slack=slack, start=1e-12, speed_slack=speed_slack, gap_slack=gap_slack
        )
        assert not found, "\n".join([*found, scenario.to_toml()])


without_rebound = scenarios(restitution=st.just(0.0))
with_rebound = scenarios(restitution=number(0.0, 0.9))


@pytest.mark.nightly
@settings(max_examples=300, **SETTINGS)
@given(scenario=st.one_of(without_rebound, with_rebound))
def test_invariants_hold_at_a_tight_tolerance(scenario):
    assert_sound(scenario, rtol=1e-10, slack=1e-9, speed_slack=1e-9)


@settings(max_examples=300, **SETTINGS)
@given(scenario=st.one_of(without_rebound, with_rebound))
def test_invariants_hold_at_the_default_tolerance(scenario):
    assert_sound(scenario, rtol=1e-7, slack=1e-2, speed_slack=1e-4, gap_slack=1e-9)


@pytest.mark.nightly
@settings(max_examples=100, **SETTINGS)
@given(scenario=scenarios(restitution=number(0.9, 1.0)))
def test_elastic_bounces_end(scenario):
    simulated(scenario, endless=True)


@settings(max_examples=60, **SETTINGS)
@given(scenario=st.one_of(without_rebound, with_rebound))
def test_a_run_repeats_to_the_last_bit(scenario):
    # As text, where NaN equals itself.
    assert repr(simulate(scenario).summary()) == repr(simulate(scenario).summary())


# Drawn elsewhere and once wrong: a touch-down that the forces undo at once, with adhesion or
# without, after which flight began and ended in the same instant for ever.
ONCE_WITHOUT_END = [
    {
        "drive.frequency": 5.007915511279933,
        "drive.peak": 0.0,
        "drive.hold": 0.006186914828174418,
        "drive.clamp": "up",
        "drive.direction": "-x",
        "drive.pulses": 2,
        "contact.static_friction": 2.68991807826395,
        "contact.kinetic_friction": 2.68991807826395,
        "contact.adhesion": 0.0,
        "effects.misalignment.angle": 2.6575681777476365,
        "drag.rotational": 1.6100224171190313e-14,
    },
    {
        "drive.mode": "OPP",
        "drive.frequency": 10.170416312747513,
        "drive.base": 0.0038527824882566824,
        "drive.peak": 0.0038527824882566824,
        "drive.hold": 0.0009258878046308661,
        "drive.clamp": "up",
        "drive.pulses": 5,
        "contact.static_friction": 0.05371986253387051,
        "contact.kinetic_friction": 0.03764752406926946,
        "contact.adhesion": 0.0,
        "drag.linear": 0.0,
        "drag.rotational": 0.0,
    },
    {
        "drive.frequency": 6.941420723065997,
        "drive.peak": 0.004048605088338368,
        "drive.hold": 0.0013980922054732947,
        "drive.clamp": "up",
        "drive.pulses": 5,
        "drive.ramp_down": 0.02,
        "contact.static_friction": 0.0,
        "contact.kinetic_friction": 0.0,
        "contact.adhesion": 0.0,
        "effects.misalignment.angle": -2.0022661570731106,
        "drag.rotational": 1.3108270542600845e-18,
    },
]


@pytest.mark.parametrize("keys", ONCE_WITHOUT_END)
@pytest.mark.parametrize("method", ["tsit5", "arkode"])
def test_a_touch_down_that_the_forces_undo_ends(keys, method):
    simulated(Scenario().replace({**keys, "solver.method": method}))


SHORT_EDGE = """
import sys
from stickslip import Drive, Scenario, simulate
for edge_time in sys.argv[3:]:
    run = simulate(Scenario(drive=Drive(base=0.5e-3, pulses=4, edge=sys.argv[1],
                                        edge_time=float(edge_time), ramp=float(sys.argv[2]))))
    print(run.status, run.mean_velocity)
"""
EDGE_TIMES = ["0.0", "1e-300", "1e-30", "1e-17", "1e-14"]  # s


@pytest.mark.parametrize("ramp", ["0.0", "0.05"])
@pytest.mark.parametrize("edge", ["rise", "fall"])
def test_an_edge_shorter_than_any_time_is_a_jump(edge, ramp):
    # In a process of its own, which can be ended if it hangs.
    command = [sys.executable, "-c", SHORT_EDGE, edge, ramp, *EDGE_TIMES]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    outcomes = [line.split() for line in done.stdout.splitlines()]
    assert [status for status, _ in outcomes] == ["ok"] * len(EDGE_TIMES)
    jump, *velocities = (float(velocity) for _, velocity in outcomes)
    assert velocities == pytest.approx([jump] * len(velocities), rel=1e-3)
