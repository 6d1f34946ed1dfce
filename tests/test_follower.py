"""The follower: robots of several kinds follow a path, or it says why they cannot."""

import math
import sys
from pathlib import Path as File

import numpy as np
import pytest

from stickslip import STATE_COLUMNS, Drive, Robot, Scenario, simulate
from stickslip.control import Follower, Path, follow
from stickslip.control.follower import judged

sys.path.append(str(File(__file__).resolve().parents[1] / "examples"))

from controllers import SCENARIO
from steer import CAMERA, row

QUARTER = Path(Path.figure_of_eight(4e-3).points[:91])
SQUARE = Path([(0.0, 0.0), (1e-3, 0.0), (1e-3, 1e-3), (0.0, 1e-3), (0.0, 0.0)])
TIGHTEST = 0.41e-3  # m, radius where the figure is bent most
TURNED = 60  # pulses, after which every robot has turned from +x to the path
WALK = Drive(base=0.5e-3)
PLACE = [STATE_COLUMNS.index("x"), STATE_COLUMNS.index("y")]
BLOCK = Robot.of(300e-6, 150e-6, 100e-6, material="NdFeB N42")


@pytest.fixture(scope="module")
def followed():
    (robot,) = SCENARIO.draws(1, seed=3)
    return follow(SCENARIO, QUARTER, robot, camera=CAMERA)


def test_a_robot_follows_a_quarter_of_the_figure_through_a_camera(followed):
    assert followed.arrived
    # A robot that aims at a point AHEAD lags behind it by what pushes it across, at most 0.2 of
    # 1.2 mm/s, cuts a bend of radius R by AHEAD**2 / 2 R, and believes single frames. At the start
    # it faces +x, 45 degrees beside the path.
    ahead = SCENARIO.robot.length
    bound = 0.2 / 1.2 * ahead + ahead**2 / (2.0 * TIGHTEST) + 4.0 * CAMERA.noise_x
    assert bound < ahead
    assert followed.across[TURNED:].max() < bound


def test_the_robot_is_where_the_path_ends_and_faces_along_it(followed):
    end, ahead = followed.states[-1], SCENARIO.robot.length
    assert math.dist(end[PLACE], QUARTER.points[-1]) < math.hypot(0.1 * ahead + 40e-6, ahead)
    along = QUARTER.points[-1] - QUARTER.at(QUARTER.length - 50e-6)
    heading = math.atan2(along[1], along[0])
    # It aims at most half the angle of the bend AHEAD beside the tangent, and as much for what
    # pushes it across.
    off = math.remainder(end[STATE_COLUMNS.index("heading")] - heading, 2.0 * math.pi)
    assert abs(off) < ahead / TIGHTEST


def test_its_voltages_as_a_program_make_the_same_walk(followed):
    (robot,) = SCENARIO.draws(1, seed=3)
    program = {"drive.mode": "program", "drive.program": followed.program()}
    again = simulate(robot.replace(program)).final_state
    assert [again.x, again.y] == pytest.approx(followed.states[-1, PLACE], abs=1e-7)


@pytest.mark.parametrize(
    "scenario",
    [
        Scenario(robot=BLOCK, drive=WALK),
        Scenario(robot=BLOCK, drive=Drive(base=0.5e-3, coils="pairs")).in_fluid("water"),
        Scenario(drive=WALK).replace({"coil.turns": 300.0, "coil.yp.turns": 360.0}),
    ],
    ids=["N42", "pairs in water", "own coils"],
)
def test_a_robot_of_another_kind_follows_a_square_by_its_own_coils(scenario):
    found = follow(scenario, SQUARE, camera=CAMERA)
    assert found.arrived
    assert np.quantile(found.across, 0.95) < 0.3 * scenario.robot.length


@pytest.mark.parametrize(
    ("robot", "drive", "words"),
    [
        (Robot(magnetization=1e4), {}, "its pulses take it 0 um ahead"),
        (Robot(mass=1e-6), {}, "its pulses take it -"),
        (Robot(), {"mode": "OPP"}, 'drive.mode = "OPP"'),
        (Robot(), {"peak": 0.0, "base": -1e-3}, "drive.peak = 0.0"),
        (BLOCK, {"frequency": 12.0, "peak": 5e-3}, "more than half of its length"),
    ],
)
def test_a_robot_that_cannot_be_steered_is_refused_with_the_reason(robot, drive, words):
    with pytest.raises(ValueError, match=words) as refusal:
        Follower(Scenario(robot=robot, drive=Drive(**{"base": 0.5e-3, **drive})), SQUARE)
    assert "\n" not in str(refusal.value)


def test_a_robot_that_stops_short_or_leaves_the_path_has_not_followed_it(followed):
    follower = Follower(SCENARIO, QUARTER)
    lost = follower.ahead
    along = np.linspace(0.0, 1.0, 2000) * QUARTER.length
    exact, left, fails = (QUARTER.at(along) for _ in range(3))
    left[500:, 1] += 1.1 * lost
    fails[700:] = np.nan
    assert judged(exact, QUARTER, follower)[0]
    for places in (exact[:-100], left, fails):
        assert not judged(places, QUARTER, follower)[0]
    assert len(judged(fails, QUARTER, follower)[1]) == 70
    assert row("two", [followed, followed]).startswith("| two | 2 of 2 |")
