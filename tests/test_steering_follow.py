"""The example of a robot that follows a path, on one robot."""

import math
import sys
from pathlib import Path as File

import numpy as np
import pytest

sys.path.append(str(File(__file__).resolve().parents[1] / "examples"))

from controllers import drawn
from steer import AHEAD, ARRIVED, CAMERA, LOST, PLACE, PULSE, follow, judged, row

from stickslip import STATE_COLUMNS
from stickslip.control import Path

QUARTER = Path(Path.figure_of_eight(4e-3).points[:91])
TIGHTEST = 0.41e-3  # m, radius where the figure is bent most
TURNED = 60  # pulses, after which every robot has turned from +x to the path


@pytest.fixture(scope="module")
def states():
    (robot,) = drawn(1, seed=3)
    return follow(robot, QUARTER, np.random.default_rng(0))[0]


def test_a_robot_follows_a_quarter_of_the_figure_through_a_camera(states):
    followed, across = judged(states[:, PLACE], QUARTER)
    assert followed
    # A robot that aims at a point AHEAD lags behind it by what pushes it across, at most 0.2 of
    # 1.2 mm/s, cuts a bend of radius R by AHEAD**2 / 2 R, and believes single frames. At the start
    # it faces +x, 45 degrees beside the path.
    bound = 0.2 / 1.2 * AHEAD + AHEAD**2 / (2.0 * TIGHTEST) + 4.0 * CAMERA.noise_x
    assert bound < LOST
    assert across[TURNED:].max() < bound


def test_the_robot_is_where_the_path_ends_and_faces_along_it(states):
    progress = QUARTER.length - ARRIVED
    assert math.dist(states[-1, PLACE], QUARTER.points[-1]) < math.hypot(ARRIVED, LOST)
    along = QUARTER.points[-1] - QUARTER.at(progress)
    heading = math.atan2(along[1], along[0])
    # It aims at most half the angle of the bend AHEAD beside the tangent, and as much for what
    # pushes it across.
    off = math.remainder(states[-1, STATE_COLUMNS.index("heading")] - heading, 2.0 * math.pi)
    assert abs(off) < AHEAD / TIGHTEST


def test_a_robot_that_stops_short_or_leaves_the_path_has_not_followed_it():
    along = np.linspace(0.0, 1.0, 2000) * QUARTER.length
    exact, left, fails = (QUARTER.at(along) for _ in range(3))
    left[500:, 1] += 1.1 * LOST
    fails[700:] = np.nan
    assert judged(exact, QUARTER)[0]
    for places in (exact[:-100], left, fails):
        assert not judged(places, QUARTER)[0]
    assert len(judged(fails, QUARTER)[1]) == 700 // len(PULSE)
    assert row("two", [exact, left], QUARTER).startswith("| two | 1 of 2 |")
