"""Walks in the whole plane beside those of a rigid body with eight corners, which are stored."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from helpers import program_of
from reference.drive import voltages_of
from reference.heading import Heading, heading_voltages
from stickslip import Scenario, Simulator, State, Waveform, simulate
from stickslip.control import heading_voltages as steering_voltages

TABLE = json.loads((Path(__file__).parent / "data" / "steering_reference.json").read_text())
STEADY = [
    walk
    for walk in TABLE["walks"]
    if len(walk["heading"]["angles"]) == 1 and walk["coils"] in ("single", "pairs")
]
# Where the two differ by more, and by how much: see docs/theory/steering.md, "How far it holds".
# Part of the speed, and m/s across.
USUAL = (0.03, 5e-5)
OFF = {
    "OPP 20": (0.07, 5e-5),
    "OPP 160": (0.07, 5e-5),
    "OPP 20, pairs": (0.04, 5e-5),
    "OPP 20, friction 0.4": (0.5, 5e-5),
    "IPP 30, at (10, 0) mm": (0.05, 5e-5),
    "IPP 0, at (0, 10) mm": (0.08, 1e-4),
    "IPP 30, at (0, 10) mm": (0.12, 1e-4),
    "IPP 0, at (5, -7) mm": (0.04, 1e-4),
    "IPP 30, at (5, -7) mm": (0.07, 1e-4),
    "IPP 30, pairs, at (5, -7) mm": (0.16, 1e-4),
}
TURNING = [walk for walk in TABLE["walks"] if walk not in STEADY]
# Of walks that turn, where they differ by more than USUAL: m/s along and across. An edge that turns
# on the spot creeps, see the same place.
CREEPS = {
    "IPP turn 0 to 30 in 3 pulses": (9e-5, 5e-5),
    "IPP turn 0 to 30 in 3 pulses, pairs": (1.1e-4, 5e-5),
    "IPP turn 0 to 90 in 5 pulses": (1.6e-4, 2.3e-4),
    "IPP turn 0 to 90 in 5 pulses, pairs": (2.5e-4, 2.1e-4),
    "OPP turn 0 to 30 in 3 pulses": (6e-5, 5e-5),
    "OPP turn 0 to 90 in 5 pulses": (1.4e-4, 5e-5),
    "IPP turn 0 to 30 in 15 pulses": (1e-4, 5e-5),
    "IPP turn 0 to 60 in 15 pulses": (2.4e-4, 8e-5),
    "IPP turn 0 to 60 in 15 pulses, pairs": (2.2e-4, 6e-5),
    "OPP turn 0 to 30 in 15 pulses": (5e-5, 5e-5),
    "OPP turn 0 to 60 in 15 pulses": (1.2e-4, 5e-5),
}
TURNED = Scenario().replace(
    {"drive.base": 0.5e-3, "drive.heading": math.radians(30.0), "drive.pulses": 12}
)
# Nearly equal motions forth and back: in m/s.
BALANCED = {"OPP 20, at (10, 0) mm", "OPP 20, at (0, 10) mm", "OPP 20, at (5, -7) mm"}


def walk_of(walk):
    heading = math.remainder(walk["heading"]["angles"][0], 2.0 * math.pi)
    drive = {**walk["drive"], "heading": heading, "coils": walk["coils"]}
    changes = {f"drive.{name}": value for name, value in drive.items()}
    changes |= {f"contact.{name}": value for name, value in walk["contact"].items()}
    x, y = walk["place"]
    return Scenario(initial=State(x=x, y=y)).replace(changes)


@pytest.mark.parametrize("walk", STEADY, ids=lambda walk: walk["name"])
def test_a_walk_is_that_of_the_rigid_body(walk):
    run = simulate(walk_of(walk))
    assert run.ok
    expected = walk["whole"]["values"]
    along, across = run.velocity
    if walk["name"] in BALANCED:
        assert along == pytest.approx(expected["along"], abs=2.5e-4)
        assert across == pytest.approx(expected["across"], abs=1e-4)
        return
    part, aside = OFF.get(walk["name"], USUAL)
    assert along == pytest.approx(expected["along"], rel=part)
    assert across == pytest.approx(expected["across"], abs=aside)


def test_voltages_follow_a_heading_that_turns():
    drive = TABLE["walks"][0]["drive"]
    turn = Heading((0.1, 0.13), (0.0, np.radians(90.0)))
    volts, planar = heading_voltages(drive, turn), voltages_of(drive)
    t = np.linspace(0.001, 0.24, 1234)

    def at(program):
        k = np.searchsorted(program.start, t, side="right") - 1
        return program.level[k] + program.slope[k] * (t - program.start[k])[:, None]

    # Of the two coils of an axis, alike, the sum makes the field.
    found = np.stack([at(volts)[:, :2].sum(axis=1), at(volts)[:, 2:4].sum(axis=1)], axis=1)
    expected = at(planar)[:, :1] * np.stack([np.cos(turn(t)), np.sin(turn(t))], axis=1)
    # Sawtooth and heading both change between two points: a quarter of the product of the changes.
    assert found == pytest.approx(expected, abs=3e-5 * np.abs(expected).max())


def turning_run(walk, heading):
    """The run under the walk's five voltages."""
    volts = heading_voltages(walk["drive"], heading, walk["coils"])
    changes = {
        "drive.mode": "program",
        "drive.program": program_of(volts),
        "record.rate": 12e3,
        **{f"contact.{name}": value for name, value in walk["contact"].items()},
    }
    start = State(heading=float(heading(0.0)))
    return simulate(Scenario(initial=start).replace(changes)), volts


def along_and_across(run, heading, volts):
    """Mean velocities along the commanded heading and to its left, as the reference has them."""
    inside = (run.t >= volts.first_counted - 1e-9) & (run.t <= volts.last_counted + 1e-9)
    t, x, y = run.t[inside], run.x[inside], run.y[inside]
    angle = heading(0.5 * (t[1:] + t[:-1]))
    dx, dy, seconds = np.diff(x), np.diff(y), volts.last_counted - volts.first_counted
    along = np.sum(np.cos(angle) * dx + np.sin(angle) * dy) / seconds
    return along, np.sum(np.cos(angle) * dy - np.sin(angle) * dx) / seconds


@pytest.mark.parametrize("walk", TURNING, ids=lambda walk: walk["name"])
def test_a_walk_that_turns_or_is_pushed_is_that_of_the_rigid_body(walk):
    heading = Heading(tuple(walk["heading"]["times"]), tuple(walk["heading"]["angles"]))
    run, volts = turning_run(walk, heading)
    assert run.ok
    along, across = along_and_across(run, heading, volts)
    expected = walk["whole"]["values"]
    if walk["name"] in CREEPS:
        part, aside = CREEPS[walk["name"]]
        # The note of the run tells as much.
        assert max(part, aside) < run.summary()["turning_speed"]
        assert any(note.code == "turning" for note in run.notes)
        assert along == pytest.approx(expected["along"], abs=part)
    else:
        part, aside = USUAL
        assert along == pytest.approx(expected["along"], rel=part)
    assert across == pytest.approx(expected["across"], abs=aside)
    if len(heading.times) > 1:
        period = 1.0 / walk["drive"]["frequency"]
        pulses = round((volts.last_counted - volts.first_counted) / period)
        ended = volts.first_counted + period * np.arange(1, pulses + 1)
        ends = np.interp(ended, run.t, np.unwrap(run.heading))
        assert ends == pytest.approx(np.array(walk["whole"]["headings"]), abs=math.radians(0.5))


def test_a_run_along_x_has_no_velocity_across():
    run = simulate(Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 5}))
    assert run.velocity == (run.mean_velocity, 0.0)


def test_the_heading_and_the_place_across_are_recorded():
    heading = math.radians(30.0)
    run = simulate(TURNED.replace({"record.rate": 1e3}))
    assert run.heading[-1] == pytest.approx(heading, abs=0.01)
    assert run.y[-1] == pytest.approx(run.final_state.y, rel=1e-12)
    along, across = run.velocity
    assert run.summary()["mean_velocity_y"] == pytest.approx(
        along * math.sin(heading) + across * math.cos(heading)
    )


def turning(clamp):
    """A robot on its face, or tilted by the clamp coil, whose field turns by a right angle."""
    turn = Waveform.hold(0.1, {"xp": 25.0, "clamp": clamp}) + Waveform.from_points(
        [0.0, 0.2], [[25.0, 0, 0, 0, clamp], [0, 0, 25.0, 0, clamp]]
    )
    return Scenario().replace({"drive.mode": "program", "drive.program": turn})


@pytest.mark.parametrize(
    ("scenario", "name", "value"),
    [(TURNED, "y", 5e-5), (turning(0.0), "heading", 0.7), (turning(-10.0), "heading", 0.7)],
    ids=["y", "heading on a face", "heading of a tilted robot"],
)
def test_a_run_ends_where_y_or_the_heading_comes_to_a_value(scenario, name, value):
    run = simulate(scenario, until=f"{name} >= {value!r}")
    assert run.condition_met
    assert getattr(run.final_state, name) == pytest.approx(value, rel=1e-9)
    fine = simulate(scenario.replace({"record.rate": 1e5}))
    first = int((getattr(fine, name) >= value).argmax())
    assert fine.t[first - 1] <= run.summary()["simulated_time"] <= fine.t[first]


def test_steady_headings_near_the_centre_have_no_note_of_turning():
    draws = np.random.default_rng(3)
    walked = 0
    for _ in range(40):
        drive = {
            "mode": str(draws.choice(["IPP", "OPP"])),
            "coils": str(draws.choice(["single", "pairs"])),
            "edge": str(draws.choice(["rise", "fall"])),
            "heading": draws.uniform(-math.pi, math.pi),
            "frequency": draws.uniform(20.0, 150.0),
            "base": draws.uniform(0.2e-3, 0.8e-3),
            "pulses": 12,
        }
        run = simulate(Scenario().replace({f"drive.{name}": each for name, each in drive.items()}))
        assert run.ok
        assert not any(note.code == "turning" for note in run.notes), drive
        walked += math.hypot(*run.velocity) > 1e-4
    assert walked > 30


def test_a_heading_that_swings_with_every_pulse_is_noted():
    # 10 mm beside the centre the clamp coil's field points away from the axis.
    run = simulate(TURNED.with_state(State(y=10e-3)))
    (note,) = [str(each) for each in run.notes if each.code == "turning"]
    turning, speed = run.summary()["turning_speed"], math.hypot(*run.velocity)
    assert turning > 0.05 * speed
    assert f"{1e3 * turning:.2g} mm/s" in note


def test_the_voltages_of_a_quarter_turn_leave_the_coils_across_off():
    quarters = 0.5 * math.pi * np.arange(-4, 9)
    rows = steering_voltages(quarters, 26.0, -10.0)
    expected = [[26, 0, 0, 0], [0, 0, 26, 0], [0, -26, 0, 0], [0, 0, 0, -26]]
    assert (rows[:, :4] == [expected[n % 4] for n in range(len(quarters))]).all()
    assert (rows[:, 4] == -10.0).all()
    part = 26.0 * math.sqrt(0.5)
    between = steering_voltages(np.radians([45.0, 135.0, -135.0]), 26.0, 0.0)[:, :4]
    expected = [[part, 0, part, 0], [0, -part, part, 0], [0, -part, 0, -part]]
    assert between == pytest.approx(np.array(expected))


@pytest.mark.parametrize("heading", [0.0, math.pi])
def test_steps_along_x_stay_in_the_plane(heading):
    direction = "-x" if heading else "+x"
    simulator = Simulator(Scenario().replace({"drive.direction": direction}))
    for strength in (10.0, 20.0, 10.0):
        row = steering_voltages(heading, strength, -10.0)
        state = simulator.step(row, 5e-3)
    assert (state.y, state.heading) == (0.0, heading)
