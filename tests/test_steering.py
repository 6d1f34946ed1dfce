"""Walks in the whole plane beside the rigid body with eight corners of `tests/reference`."""

import json
import math
from pathlib import Path

import pytest

from stickslip import Scenario, State, Waveform, simulate

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


def test_enough_walks_are_compared_and_most_are_equal():
    assert len(STEADY) >= 40
    assert len(STEADY) - len(OFF) - len(BALANCED) >= 24


def test_a_run_along_x_has_the_columns_and_the_bits_that_it_had():
    # The planar check number, and no column across.
    run = simulate(Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 20}))
    assert not run.scenario.turns
    assert run.mean_velocity == pytest.approx(1.9128e-3, rel=1e-4)
    assert run.velocity == (run.mean_velocity, 0.0)


def test_the_heading_and_the_place_across_are_recorded_and_read_back(tmp_path):
    from stickslip import open_run

    heading = math.radians(30.0)
    scenario = Scenario().replace(
        {"drive.base": 0.5e-3, "drive.pulses": 6, "drive.heading": heading, "record.rate": 1e3}
    )
    run = simulate(scenario)
    assert run.heading[-1] == pytest.approx(heading, abs=0.01)
    assert run.y[-1] == run.final_state.y
    along, across = run.velocity
    assert run.summary()["mean_velocity_y"] == pytest.approx(
        along * math.sin(heading) + across * math.cos(heading)
    )
    run.save(tmp_path / "run.nc")
    again = open_run(tmp_path / "run.nc")
    assert (again.y == run.y).all()
    assert (again.slip_across[run.contact > 0] == run.slip_across[run.contact > 0]).all()
    run.save(tmp_path / "run.csv")
    assert "heading (rad)" in (tmp_path / "run.csv").read_text().splitlines()[0]


def test_a_field_that_comes_back_from_another_side_is_refused_in_one_line():
    voltages = Waveform.hold(0.1, {"yp": 25.0}) + Waveform.hold(0.1, {"yp": -25.0})
    run = simulate(Scenario().replace({"drive.mode": "program", "drive.program": voltages}))
    assert run.status == "heading_lost"
    assert "\n" not in run.message
