"""Robots of several kinds follow a path, and are placed; the paths themselves."""

import math
import sys
from pathlib import Path as File

import numpy as np
import pytest

from stickslip import STATE_COLUMNS, Drive, Robot, Scenario, simulate
from stickslip.control import Follower, Path, follow, heading_voltages
from stickslip.control.follower import judged

sys.path.append(str(File(__file__).resolve().parents[1] / "examples"))

import controllers
from controllers import CAMERAS, SCENARIO, TOLERANCE, Placer
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


EIGHT = Path.figure_of_eight(4e-3)


def test_a_path_is_known_by_its_length():
    path = Path([(0.0, 0.0), (3e-3, 0.0), (3e-3, 1e-3)])
    assert path.length == pytest.approx(4e-3)
    expected = [[0.0, 0.0], [2e-3, 0.0], [3e-3, 0.5e-3], [3e-3, 1e-3]]
    assert path.at([-1.0, 2e-3, 3.5e-3, 1.0]) == pytest.approx(np.array(expected))


def test_the_figure_of_eight_has_its_size():
    size = EIGHT.points.max(axis=0) - EIGHT.points.min(axis=0)
    assert size == pytest.approx([4e-3, 2e-3], rel=1e-4)
    assert EIGHT.length == pytest.approx(3.0487 * 4e-3, rel=1e-4)
    for progress in (0.0, EIGHT.length / 2, EIGHT.length):
        assert EIGHT.at(progress) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_places_beside_the_path_are_found_again_with_their_side():
    random = np.random.default_rng(0)
    progress = random.uniform(1e-4, EIGHT.length - 1e-4, 500)
    # Nearer than the least radius, 0.42 mm, the nearest point is the one that it was put beside.
    across = random.uniform(-0.1e-3, 0.1e-3, 500)
    along = EIGHT.at(progress + 1e-7) - EIGHT.at(progress - 1e-7)
    along /= np.hypot(*along.T)[:, None]
    places = EIGHT.at(progress) + across[:, None] * np.column_stack([-along[:, 1], along[:, 0]])
    before = progress + random.uniform(-0.3e-3, 0.1e-3, 500)
    found, off = EIGHT.project(places, np.clip(before, 0.0, EIGHT.length))
    # The corners of the polyline are 34 um apart: at one of them a place has two nearest points,
    # or none, over a stretch of its distance times the angle between the sides.
    angle = 34e-6 / 0.42e-3
    assert np.abs(found - progress).max() < angle * 0.1e-3
    assert np.abs(off - across).max() < 0.5 * angle**2 * 0.1e-3 + 1e-9


def test_a_crossing_is_passed_straight_on():
    # The figure crosses itself half way; from before it, no place on the other branch is taken.
    half = EIGHT.length / 2
    progress = half - 0.3e-3
    for ahead in np.linspace(-0.3e-3, 0.3e-3, 61):
        progress, off = EIGHT.project(EIGHT.at(half + ahead), progress)
        assert progress == pytest.approx(half + ahead, abs=1e-9)
        assert off == pytest.approx(0.0, abs=1e-9)


def test_what_lies_beyond_the_ends_belongs_to_them():
    path = Path([(0.0, 0.0), (1e-3, 0.0)])
    assert path.project([-0.1e-3, 0.0], 0.0) == pytest.approx((0.0, 0.1e-3))
    assert path.project([1.2e-3, 0.0], 1e-3) == pytest.approx((1e-3, 0.2e-3))


def test_a_heading_is_made_by_the_coils_that_lie_ahead():
    headings = np.radians([0.0, 45.0, 135.0, -135.0])
    root = math.sqrt(0.5)
    expected = [
        [20.0, 0.0, 0.0, 0.0, -10.0],
        [20.0 * root, 0.0, 20.0 * root, 0.0, -10.0],
        [0.0, -20.0 * root, 20.0 * root, 0.0, -10.0],
        [0.0, -20.0 * root, 0.0, -20.0 * root, -10.0],
    ]
    assert heading_voltages(headings, 20.0, -10.0) == pytest.approx(np.array(expected))


COUNT = 12
# Of the tolerance: done is a mean of images within half of it, whose deviation is 0.3 of it.
ENOUGH, SURE, STILL = 0.5 * TOLERANCE, 0.3 * TOLERANCE, 0.1e-6


@pytest.fixture(scope="module")
def placer():
    return Placer(SCENARIO, CAMERAS["exact state"], draws=16, seed=1)


def test_the_tables_can_be_read_backwards(placer):
    assert (np.diff(placer.steps) > 0.0).all()
    assert placer.steps[0] < 0.0 < placer.steps[-1]
    assert np.abs(placer.steps[placer.steps != 0.0]).min() < TOLERANCE
    assert (placer.low > 0.0).all()


@pytest.mark.parametrize(("name", "deviations", "wrong"), [("exact state", 0, 0), ("camera", 4, 2)])
def test_robots_come_within_two_micrometres_of_the_goal(placer, name, deviations, wrong):
    # Beyond 4 deviations of a mean are 6 in 1e5; at worst 5 % of the robots are 1.7 of them beyond
    # ENOUGH, which is the tolerance: of twelve 3 or more with a probability of 2 %.
    placer.camera = CAMERAS[name]
    time, error, pulses = placer.put(SCENARIO.draws(COUNT, seed=2), 3e-3)
    assert np.isfinite(time).all()
    assert np.abs(error).max() <= ENOUGH + deviations * SURE + STILL
    assert np.sum(np.abs(error) > TOLERANCE) <= wrong
    assert pulses.min() >= 1


def test_a_robot_whose_simulation_fails_is_never_there(placer):
    ice = {"contact.static_friction": 0.0, "contact.kinetic_friction": 0.0, "drag.linear": 0.0}
    sound = SCENARIO.with_uncertain(None)
    placer.camera = CAMERAS["exact state"]
    time, *_ = placer.put([sound, sound.replace(ice)], 0.5e-3, limit=3.0)
    assert np.isfinite(time).tolist() == [True, False]


def test_the_example_prints_a_row_for_each_camera(placer, monkeypatch, capsys):
    monkeypatch.setattr(controllers, "Placer", lambda *_, **__: placer)
    monkeypatch.setattr(controllers, "CAMERAS", {"exact state": CAMERAS["exact state"]})
    controllers.main(2)
    rows = capsys.readouterr().out.splitlines()
    assert len(rows) == 3
    assert rows[-1].startswith("| exact state |")
    assert "| 100.0 % |" in rows[-1]
