"""Random scenarios over wide ranges: each ends, with finite numbers and a possible motion.

`make nightly` draws more: `--hypothesis-profile nightly --hypothesis-seed N`. The scenario that is
being run stands in .hypothesis/running, for a crash or a hang that leaves no other trace.
"""

import math
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import laws
from fine_record import recorded
from free_shapes import LAWS
from populations import EFFECTS, EXTREME, USUAL, Draw, extreme, population, usual, wild
from stickslip import Scenario, _core, simulate, simulate_batch
from stickslip.scenario.keys import SAWTOOTH, known_keys

# A hang in the core hears no signal: the thread of pytest-timeout ends the process.
pytestmark = pytest.mark.timeout(1800, method="thread")

ROOT = Path(__file__).resolve().parents[1]
RUNNING = ROOT / ".hypothesis" / "running"
SANITIZED = ROOT / "build" / "asan" / "stickslip_fuzz"

BUDGET = 3 * 10**6  # steps: a stiff scenario is to say so, not to keep the others waiting
TIGHT = 1e-10  # relative tolerance at which balances are looked at


FEATURES = [
    ("drive.mode", "OPP"), ("drive.mode", "program"), ("drive.clamp", "up"), ("drive.edge", "fall"),
    ("drive.direction", "-x"), ("drive.coils", "pairs"), ("contact.restitution", 1.0),
    *((key, 0.0) for key in (
        "contact.static_friction", "contact.adhesion", "contact.restitution", "drag.linear",
        "contact.tangential_restitution", "drag.rotational", "environment.gravity", "initial.y")),
    *((key, Scenario().get(key)) for key in ("coil.turns", "robot.mass", "solver.rtol")),
    *((f"effects.{name}.{next(iter(drawn(Draw(0)))).rpartition('.')[2]}", 0.0)
      for name, drawn in EFFECTS.items() if name not in LAWS),
]  # fmt: skip


def test_each_feature_is_often_drawn_and_often_not():
    some = [wild(Draw(seed)) for seed in range(1000)]
    for key, value in FEATURES:
        assert 10 < sum(each.get(key) == value for each in some) < 990, (key, value)


def test_each_key_has_many_values_among_the_extreme():
    some = [extreme(Draw(seed)) for seed in range(170)]
    recorded = {key for key in known_keys() if key.startswith("record.")}
    dull = {key for key in known_keys() if len({each.get(key) for each in some}) == 1}
    assert dull < recorded


def share(part):
    """Examples of a dear test, of those of the profile."""
    return math.ceil(part * settings.default.max_examples)


def noted(*scenarios):
    """The scenarios, which are written down before they run."""
    RUNNING.mkdir(parents=True, exist_ok=True)
    name = f"{os.environ.get('PYTEST_XDIST_WORKER', 'alone')}.toml"
    (RUNNING / name).write_text("\n".join(each.to_toml() for each in scenarios))
    return list(scenarios)


def assert_ended(run, extreme=False):
    """Assert a known status and a message, and finite numbers where it is ok."""
    text = f"{run.status}: {run.message}\n{run.scenario.to_toml()}"
    assert run.status in _core.statuses, text
    assert run.message.strip(), text
    if run.ok:
        for name, value in run.summary().items():
            assert not isinstance(value, float) or math.isfinite(value), f"{name}: {text}"
        return
    # Bounces that lose little are ever smaller, and a patch's coefficient jumps where a face
    # becomes a corner, so that neither lasts.
    endless = run.scenario.contact.restitution >= 0.95
    endless |= run.scenario.get("effects.friction_patches.amplitude") != 0.0
    damped = re.search(r"damps a motion in (\S+) s", run.message)
    step = run.summary()["simulated_time"] / float(run.scenario.get("solver.max_steps"))
    fine = {
        "left_workspace": True,
        # A start or a field across may be anything.
        "heading_lost": run.scenario.whole_plane,
        "turns_too_fast": run.scenario.whole_plane,
        "too_many_events": endless,
        "too_many_steps": endless or (damped is not None and float(damped[1]) < 10 * step),
    }
    assert extreme or fine.get(run.status, False), text


@given(scenario=USUAL)
def test_a_run_ends(scenario):
    assert_ended(simulate(*noted(scenario.replace({"solver.max_steps": BUDGET}))))


@given(scenario=EXTREME)
def test_a_run_of_any_allowed_values_ends_or_says_why_not(scenario):
    assert_ended(simulate(*noted(scenario)), extreme=True)


@settings(max_examples=share(0.1))
@given(scenarios=population(lambda draw: [usual(draw) for _ in range(12)]))
def test_runs_of_a_batch_end_as_they_do_alone(scenarios):
    quiet = {"solver.max_steps": BUDGET, "record.rate": "none"}
    some = noted(*(each.replace(quiet) for each in scenarios))
    runs = simulate_batch(some, threads=1)
    for run in runs:
        assert_ended(run)
    for index in range(0, len(some), 4):
        # As text, where NaN equals itself.
        assert repr(simulate(some[index]).summary()) == repr(runs[index].summary())


@settings(max_examples=share(0.4))
@given(scenario=USUAL)
def test_a_motion_keeps_the_laws_of_contact_momentum_and_energy(scenario):
    if scenario.whole_plane:
        return  # the laws are those of one plane
    (scenario,) = noted(scenario.replace({"solver.max_steps": BUDGET}))
    for rtol in (scenario.solver.rtol, TIGHT):
        (record,) = recorded([scenario], rtol)
        if record is None:
            return
        found = laws.contact_violations(record)
        if rtol == TIGHT:
            found += laws.unbalanced(record)
        assert not found, "\n".join([*found, scenario.to_toml()])


@pytest.mark.nightly
@settings(max_examples=share(0.3))
@pytest.mark.skipif(not SANITIZED.exists(), reason="cmake --build --preset asan builds it")
@given(scenario=st.one_of(USUAL, EXTREME))
def test_the_sanitizers_are_silent(scenario):
    keys = {}
    program = scenario.drive.program
    for name in known_keys():
        if name not in SAWTOOTH or program is None:
            value = scenario.get(name)
            keys[name] = repr(value) if isinstance(value, float) else str(value)
    if program is not None:
        ((times, voltages, repeats),) = program.blocks
        rows = np.column_stack([times, voltages]).tolist()
        keys["program"] = ";".join([str(repeats), *(" ".join(map(repr, row)) for row in rows)])
    text = "".join(f"{key}={value}\n" for key, value in keys.items())
    try:
        done = subprocess.run([SANITIZED], input=text, capture_output=True, text=True, timeout=25)
    except subprocess.TimeoutExpired:
        return  # sanitized runs take ten times as long; other tests look for hangs
    assert done.returncode == 0, f"{done.stderr}\n{scenario.to_toml()}"


# Drawn elsewhere and once wrong: a touch-down that the forces undo at once, with adhesion or
# without, after which flight began and ended in the same instant for ever; a slip that broke loose
# across the way without friction, and stopped within a nanosecond, for ever.
ONCE_WITHOUT_END = [
    {"drive.frequency": 5.007915511279933, "drive.peak": 0.0, "drive.hold": 0.006186914828174418,
     "drive.clamp": "up", "drive.direction": "-x", "drive.pulses": 2,
     "contact.static_friction": 2.68991807826395, "contact.kinetic_friction": 2.68991807826395,
     "contact.adhesion": 0.0, "effects.misalignment.angle": 2.6575681777476365,
     "drag.rotational": 1.6100224171190313e-14},
    {"drive.mode": "OPP", "drive.frequency": 10.170416312747513,
     "drive.base": 0.0038527824882566824, "drive.peak": 0.0038527824882566824,
     "drive.hold": 0.0009258878046308661, "drive.clamp": "up", "drive.pulses": 5,
     "contact.static_friction": 0.05371986253387051,
     "contact.kinetic_friction": 0.03764752406926946, "contact.adhesion": 0.0, "drag.linear": 0.0,
     "drag.rotational": 0.0},
    {"drive.frequency": 6.941420723065997, "drive.peak": 0.004048605088338368,
     "drive.hold": 0.0013980922054732947, "drive.clamp": "up", "drive.pulses": 5,
     "drive.ramp_down": 0.02, "contact.static_friction": 0.0, "contact.kinetic_friction": 0.0,
     "contact.adhesion": 0.0, "effects.misalignment.angle": -2.0022661570731106,
     "drag.rotational": 1.3108270542600845e-18},
    {"drive.heading": 1.2, "drive.pulses": 2, "effects.friction_anisotropy.fraction": -1.0,
     "effects.ambient_field.By": 7e-5},
]  # fmt: skip


@pytest.mark.parametrize("keys", ONCE_WITHOUT_END)
@pytest.mark.parametrize("method", ["tsit5", "arkode"])
def test_a_touch_down_that_the_forces_undo_ends(keys, method):
    assert simulate(Scenario().replace({**keys, "solver.method": method})).ok


@pytest.mark.parametrize("ramp", [0.0, 0.05])
@pytest.mark.parametrize("edge", ["rise", "fall"])
def test_an_edge_shorter_than_any_time_is_a_jump(edge, ramp):
    changes = {"drive.base": 0.5e-3, "drive.pulses": 4, "drive.edge": edge, "drive.ramp": ramp}
    short = [{**changes, "drive.edge_time": time} for time in (0.0, 1e-300, 1e-30, 1e-17, 1e-14)]
    jump, *runs = (simulate(Scenario().replace(each)) for each in short)
    assert jump.ok
    assert [run.mean_velocity for run in runs] == pytest.approx([jump.mean_velocity] * 4, rel=1e-3)
