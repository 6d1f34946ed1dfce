"""Mean velocities at any tolerance, the default one where drag is low, and two integrators."""

import numpy as np
import pytest

from effect_table import rows
from helpers import HOPS, TIGHT, friction, launched, needs_arkode, run, scenario, still_for, tilted
from stickslip import Scenario, _core, simulate, simulate_batch

# mode, frequency (Hz), base and hold (mT), edge, clamp
WALKS = [
    ("IPP", 100.0, 0.5, 1.0, "rise", "down"),
    ("IPP", 30.0, 0.5, 1.0, "fall", "up"),
    ("OPP", 30.0, 0.5, 2.5, "fall", "down"),
    ("OPP", 100.0, 0.0, 2.5, "rise", "up"),
]


def _velocity(mode, frequency, base, hold, edge, clamp, **solver):
    """mm/s"""
    keys = {f"solver.{key}": value for key, value in solver.items()}
    drive = {"mode": mode, "frequency": frequency, "edge": edge, "clamp": clamp, "pulses": 20}
    return run(keys, base=base * 1e-3, hold=hold * 1e-3, **drive).mean_velocity * 1e3


METHODS = ["tsit5", "arkode"] if _core.has_arkode else ["tsit5"]


@pytest.mark.skipif(_core.has_arkode, reason="this build has arkode")
def test_a_build_without_arkode_says_so():
    assert simulate(scenario({"solver.method": "arkode"})).status == "no_arkode"


@pytest.mark.parametrize("walk", WALKS, ids=lambda walk: f"{walk[0]}-{walk[1]:.0f}Hz")
@pytest.mark.parametrize("method", METHODS)
def test_default_tolerance_is_tight_enough(walk, method):
    fine = _velocity(*walk, rtol=1e-11)
    assert _velocity(*walk, method=method) == pytest.approx(fine, rel=1e-4)
    # A thousand times the tolerance moves the result, so that the one above means something.
    assert _velocity(*walk, method=method, rtol=1e-4) != fine


def random_drive(random):
    """Keys and drive of a walk, some of them with hops."""
    drive = {
        "mode": random.choice(["IPP", "OPP"]).item(),
        "edge": random.choice(["rise", "fall"]).item(),
        "clamp": random.choice(["up", "down"]).item(),
        "frequency": random.uniform(5.0, 200.0),
        "base": random.uniform(-0.5e-3, 1.5e-3),
        "hold": random.uniform(0.5e-3, 3e-3),
        "pulses": 8,
    }
    static = float(np.exp(random.uniform(np.log(0.05), np.log(2.0))))
    keys = friction(static, static * random.uniform(0.3, 1.0))
    keys["contact.adhesion"] = random.uniform(0.0, 1e-6)
    keys["drag.linear"] = float(np.exp(random.uniform(np.log(1e-6), np.log(1e-4))))
    return keys, drive


def test_the_default_tolerance_agrees_with_a_fine_one_on_random_drives():
    # Events decide the motion: one that is missed changes it by percents.
    random = np.random.default_rng(20)
    worst = []
    for _ in range(150):
        keys, drive = random_drive(random)
        default, fine = run(keys, **drive), run(keys, {"solver.rtol": 1e-11}, **drive)
        worst.append(abs(default.mean_velocity - fine.mean_velocity))
    # 2 um/s is a thousandth of a brisk walk; a run at a bifurcation may fall either way.
    assert np.sum(np.array(worst) > 2e-6) <= 1


# Where an integrator that locates its events in another way would go wrong: keys and drive.
HARD = {
    **{name: (keys, HOPS) for name, keys in rows().items()},
    "plain": ({}, HOPS),
    "a dip inside a step": (
        friction(1.8, 1.305),
        {"mode": "OPP", "hold": 1e-3, "edge": "fall", "pulses": 8},
    ),
    "lift-off after a touch-down": (
        {},
        {"mode": "OPP", "frequency": 60.0, "base": 0.3e-3, "hold": 2.5e-3, "pulses": 20},
    ),
    "equal coefficients": (friction(0.5), {"mode": "IPP", "base": 0.5e-3, "pulses": 10}),
    "no solution of a slide": (
        {**friction(2.45, 0.39), "effects.stribeck_friction.velocity": 23.9e-3},
        {"frequency": 161.0, "base": 0.4e-3, "peak": 3.7e-3, "hold": 3.2e-3, "mode": "OPP"},
    ),
    "free fall": (launched(0.02), {}),
    "rebounds": ({**launched(0.2), "contact.restitution": 0.5}, {}),
    "a slide": ({**still_for(0.05), **tilted(0.6)}, {}),
    "the other direction": ({}, {**HOPS, "direction": "-x"}),
}


@needs_arkode
@pytest.mark.parametrize("name", HARD)
def test_the_two_integrators_agree(name):
    keys, drive = HARD[name]
    one, other = (run(keys, TIGHT, {"solver.method": each}, **drive) for each in METHODS)
    # Each errs by 1e-10 in each of some hundred steps of a pulse, which move the slip after them;
    # the most sensitive law differs by 1.03e-6. What is missing moves more than 1e-3.
    assert one.mean_velocity == pytest.approx(other.mean_velocity, rel=1e-5, abs=1e-11)
    assert one.final_state.theta == pytest.approx(other.final_state.theta, abs=1e-6)
    ours, theirs = one.summary(), other.summary()
    assert ours["events"] == theirs["events"]
    assert ours["painleve_events"] == theirs["painleve_events"]
    assert ours["steps"] != theirs["steps"]  # else one of them stands in for the other


@needs_arkode
@pytest.mark.parametrize("rate", ["events", 300.0, 1e5])
def test_recording_does_not_change_the_motion_of_arkode(rate):
    method = {"solver.method": "arkode"}
    plain, recorded = (run(method, rate=each, **HOPS).summary() for each in ("none", rate))
    # To look inside a step, ARKODE evaluates the rates, which it counts.
    assert recorded["steps"].pop("evaluations") >= plain["steps"]["evaluations"]
    assert recorded == {**plain, "steps": recorded["steps"]}


@needs_arkode
def test_both_integrators_agree_on_random_drives():
    random = np.random.default_rng(7)
    for _ in range(50):
        keys, drive = random_drive(random)
        ours, theirs = (
            run(keys, TIGHT, {"solver.method": method}, **drive).mean_velocity for method in METHODS
        )
        # Two runs, each good to 1e-10 a step; a net motion that nearly cancels has an error of the
        # size of its parts.
        assert ours == pytest.approx(theirs, rel=2e-6, abs=1e-11), drive


FINE = 1e-11
# Of velocities. The motions below may amplify a part in 1e9 to 1e-5; steps that are not tightened
# are off by up to 6e-4 at the default tolerance.
CLOSE = 2e-5

# mode, frequency (Hz), base (mT), edge, drag.linear (N s/m). They are from a grid of both modes,
# 1 to 15 Hz, two bases, both edges and drags of 0, 1e-8 and 1e-7 (the default is 1e-5), and such
# that a part in 1e9 of the mass moves the velocity by less than a part in 1e5 (checked below), but
# steps that are not tightened are not enough. Others, above all those that turn over in the ramp,
# amplify more.
CASES = [
    ("IPP", 1.0, 0.3, "rise", 0.0), ("IPP", 2.8, 0.3, "rise", 0.0),
    ("IPP", 4.0, 0.5, "fall", 0.0), ("IPP", 7.0, 0.3, "fall", 0.0),
    ("OPP", 1.0, 0.5, "fall", 0.0), ("OPP", 2.0, 0.5, "fall", 0.0),
    ("OPP", 2.8, 0.5, "fall", 0.0), ("OPP", 5.0, 0.3, "fall", 0.0),
    ("OPP", 10.0, 0.5, "rise", 0.0), ("OPP", 15.0, 0.5, "rise", 0.0),
    ("OPP", 2.0, 0.5, "fall", 1e-8), ("OPP", 5.0, 0.5, "fall", 1e-8),
    ("IPP", 2.8, 0.5, "fall", 1e-7), ("IPP", 7.0, 0.3, "fall", 1e-7),
    ("OPP", 2.8, 0.3, "rise", 1e-7), ("OPP", 4.0, 0.3, "fall", 1e-7),
]  # fmt: skip


def velocities(**solver_and_mass):
    scenarios = []
    for mode, frequency, base, edge, drag in CASES:
        keys = {
            "drive.mode": mode, "drive.hold": 1e-3 if mode == "IPP" else 2.5e-3,
            "drive.frequency": frequency, "drive.base": base * 1e-3, "drive.edge": edge,
            "drive.pulses": 5, "drag.linear": drag, "drag.rotational": 1e-10 * drag,
            "contact.static_friction": 0.2, "contact.kinetic_friction": 0.145,
        }  # fmt: skip
        scenarios.append(Scenario().replace({**keys, **solver_and_mass}))
    runs = simulate_batch(scenarios)
    assert all(run.ok for run in runs)
    return np.array([run.mean_velocity for run in runs])


@pytest.fixture(scope="module")
def fine():
    return velocities(**{"solver.rtol": FINE})


def test_the_motions_do_not_amplify_what_is_small(fine):
    mass = Scenario().robot.mass
    for part in (-1e-9, 0.6e-9):
        other = velocities(**{"solver.rtol": FINE, "robot.mass": mass * (1.0 + part)})
        np.testing.assert_allclose(other, fine, rtol=1e-5)


def test_the_default_tolerance_holds_where_drag_is_low(fine):
    np.testing.assert_allclose(velocities(), fine, rtol=CLOSE)


def test_without_a_tighter_tolerance_the_error_is_too_large(fine):
    # Without drag the tolerance is a thousandth of rtol, so that these give steps of 1e-8 and 1e-7:
    # else the test above would show nothing.
    undamped = np.array([drag == 0.0 for *_, drag in CASES])
    for rtol, error in ((1e-5, CLOSE), (1e-4, 1e-3)):
        off = np.abs(velocities(**{"solver.rtol": rtol}) / fine - 1.0)[undamped]
        assert np.count_nonzero(off > error) >= 3
