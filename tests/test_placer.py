"""The placer: robots of several kinds come to their goal, or it says why they cannot."""

import sys
from pathlib import Path

import numpy as np
import pytest

from stickslip import Drive, Robot, Scenario, simulate
from stickslip.control import Camera, Placer

sys.path.append(str(Path(__file__).resolve().parents[1] / "examples"))

import controllers
from controllers import CAMERAS, PRIORS, TOLERANCE

COUNT = 12
# Of the tolerance: done is a mean of images within half of it, whose deviation is 0.3 of it.
ENOUGH, SURE, STILL = 0.5 * TOLERANCE, 0.3 * TOLERANCE, 0.1e-6
BLOCK = Robot.of(300e-6, 150e-6, 100e-6, material="NdFeB N42")


def differing(robot, **drive):
    """A robot whose friction, adhesion and drag are known within the priors of the example."""
    walk = Drive(base=0.5e-3, **drive)
    return Scenario(robot=robot, drive=walk, uncertain=PRIORS)


@pytest.fixture(scope="module")
def placer():
    return Placer(differing(Robot()), draws=16, seed=1)


@pytest.fixture(scope="module")
def placed(placer):
    return placer.put(placer.scenario.draws(COUNT, seed=2))


def test_the_tables_can_be_read_backwards(placer):
    assert (np.diff(placer.steps) > 0.0).all()
    assert placer.steps[0] < 0.0 < placer.steps[-1]
    assert np.abs(placer.steps[placer.steps != 0.0]).min() < TOLERANCE
    assert (placer.speeds > 0.0).all()


def test_robots_come_within_two_micrometres_of_the_goal(placed):
    assert np.abs(placed.error).max() <= ENOUGH + STILL
    assert placed.within(TOLERANCE) == 1.0
    assert placed.pulses.min() >= 1


def test_through_a_camera_few_of_them_stop_on_a_wrong_mean():
    found = Placer(differing(Robot()), camera=CAMERAS["camera"], draws=16, seed=1)
    seen = found.put(found.scenario.draws(COUNT, seed=2))
    # Beyond 4 deviations of a mean are 6 in 1e5; at worst 5 % of the robots are 1.7 of them beyond
    # ENOUGH, which is the tolerance: of twelve 3 or more with a probability of 2 %.
    assert np.isfinite(seen.time).all()
    assert np.abs(seen.error).max() <= ENOUGH + 4.0 * SURE + STILL
    assert seen.within(TOLERANCE) >= (COUNT - 2) / COUNT


@pytest.mark.parametrize(
    "scenario",
    [
        differing(BLOCK),
        differing(BLOCK, coils="pairs", frequency=60.0),
        differing(BLOCK, direction="-x", clamp="down"),
        Scenario(robot=BLOCK, drive=Drive(base=0.5e-3, coils="pairs")).in_fluid("water"),
        differing(Robot()).replace({"coil.turns": 300.0, "coil.xp.turns": 350.0}),
    ],
    ids=["N42", "pairs", "back", "water", "own coils"],
)
def test_a_robot_of_another_kind_is_placed_by_its_own_coils(scenario):
    found = Placer(scenario, draws=6, seed=3)
    robots = scenario.draws(6, seed=4) if scenario.uncertain is not None else [scenario]
    done = found.put(robots, goal=1e-3)
    assert done.within(TOLERANCE) == 1.0


@pytest.mark.parametrize(
    ("robot", "drive", "words"),
    [
        (Robot(magnetization=1e4), {}, "by no pulses do nine of ten robots walk ahead"),
        (Robot(mass=1e-6), {}, "slides by"),
        (Robot(), {"mode": "OPP"}, 'drive.mode = "OPP": allowed is "IPP"'),
        (Robot(), {"heading": 0.3}, "along x"),
        (Robot(), {"hold": 0.0}, "drive.hold = 0.0"),
    ],
)
def test_a_robot_that_cannot_be_placed_is_refused_with_the_reason(robot, drive, words):
    scenario = Scenario(robot=robot, drive=Drive(base=0.5e-3, **drive))
    with pytest.raises(ValueError, match=words) as refusal:
        Placer(scenario)
    assert "\n" not in str(refusal.value)
    if "by no pulses" in words:  # the reason is true
        assert abs(simulate(scenario).mean_velocity) < 1e-5


def test_a_robot_whose_simulation_fails_is_never_there(placer):
    ice = {"contact.static_friction": 0.0, "contact.kinetic_friction": 0.0, "drag.linear": 0.0}
    sound = placer.scenario.with_uncertain(None)
    done = placer.put([sound, sound.replace(ice)], goal=0.5e-3, limit=3.0)
    assert np.isfinite(done.time).tolist() == [True, False]
    assert done.within(TOLERANCE) == 0.5


def test_a_tolerance_below_every_step_is_refused():
    with pytest.raises(ValueError, match="for a tolerance of"):
        Placer(Scenario(drive=Drive(base=0.5e-3)), tolerance=1e-10)


def test_the_example_prints_a_row_for_each_camera(placer, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["controllers.py", "--robots", "2"])
    monkeypatch.setattr(controllers, "Placer", lambda *_, **__: placer)
    monkeypatch.setattr(controllers, "CAMERAS", {"exact state": Camera(frame_rate=1000.0)})
    controllers.main()
    rows = capsys.readouterr().out.splitlines()
    assert len(rows) == 3
    assert rows[-1].startswith("| exact state |")
    assert "| 100.0 % |" in rows[-1]
