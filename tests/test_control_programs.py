"""The programs on control in `examples`: a follower of paths, a placer, views of a robot."""

import math
import re
import sys
from pathlib import Path as File

import numpy as np
import pytest
from gymnasium.wrappers import RenderCollection
from PIL import Image

from stickslip import STATE_COLUMNS, Drive, Robot, Scenario, simulate
from stickslip.control.environments import RobotEnv

sys.path.append(str(File(__file__).resolve().parents[1] / "examples"))

import controllers
import follower
import side_view
import steer
from controllers import CAMERAS, SCENARIO, TOLERANCE, Placer
from follower import Follower, Path, follow
from steer import CAMERA, figure_of_eight

EXAMPLES = File(follower.__file__).parent
EIGHT = figure_of_eight()
QUARTER = Path(EIGHT.points[:91])
SQUARE = Path([(0.0, 0.0), (1e-3, 0.0), (1e-3, 1e-3), (0.0, 1e-3), (0.0, 0.0)])
TIGHTEST = 0.41e-3  # m, radius where the figure is bent most
TURNED = 60  # pulses, after which every robot has turned from +x to the path
WALK = Drive(base=0.5e-3)
PLACE = [STATE_COLUMNS.index("x"), STATE_COLUMNS.index("y")]
BLOCK = Robot.of(300e-6, 150e-6, 100e-6, material="NdFeB N42")


def started(program, monkeypatch, folder, *options):
    """Run the main function of a program in a folder."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", [program.__name__, *options])
    program.main()


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
    end = followed.states[-1]
    assert math.dist(end[PLACE], QUARTER.points[-1]) < math.hypot(0.1 * ahead + 40e-6, ahead)
    # It faces along the path: it aims at most half the angle of the bend AHEAD beside the tangent,
    # and as much for what pushes it across.
    along = QUARTER.points[-1] - QUARTER.at(QUARTER.length - 50e-6)
    off = end[STATE_COLUMNS.index("heading")] - math.atan2(along[1], along[0])
    assert abs(math.remainder(off, 2.0 * math.pi)) < ahead / TIGHTEST


def test_its_voltages_as_a_program_make_the_same_walk(followed):
    (robot,) = SCENARIO.draws(1, seed=3)
    program = {"drive.mode": "program", "drive.program": followed.program()}
    again = simulate(robot.replace(program)).final_state
    assert [again.x, again.y] == pytest.approx(followed.states[-1, PLACE], abs=1e-7)


def test_a_robot_that_stops_short_or_leaves_the_path_has_not_followed_it():
    known = Follower(SCENARIO, QUARTER)
    exact = np.array([QUARTER.at(part * QUARTER.length) for part in np.linspace(0.0, 1.0, 2000)])
    left = exact.copy()
    left[500:, 1] += 1.1 * known.ahead
    arrived, across = follower.judge(exact, QUARTER, known)
    assert arrived
    assert across.max() < 1e-12
    for places in (exact[:-100], left):
        assert not follower.judge(places, QUARTER, known)[0]


def test_a_path_is_known_by_its_length_and_passes_its_crossing_straight_on():
    assert EIGHT.length == pytest.approx(3.0487 * 4e-3, rel=1e-4)
    half = EIGHT.length / 2
    progress = half - 0.3e-3
    for ahead in np.linspace(-0.3e-3, 0.3e-3, 61):  # no place on the other branch is taken
        progress, off = EIGHT.project(EIGHT.at(half + ahead), progress)
        assert progress == pytest.approx(half + ahead, abs=1e-9)
        assert off == pytest.approx(0.0, abs=1e-9)


@pytest.mark.nightly
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
        (Robot(), {"mode": "OPP"}, "give IPP"),
        (BLOCK, {"frequency": 12.0, "peak": 5e-3}, "more than half of its length"),
    ],
)
def test_a_robot_that_cannot_be_steered_is_refused_with_the_reason(robot, drive, words):
    with pytest.raises(ValueError, match=f"cannot be steered: .*{words}"):
        Follower(Scenario(robot=robot, drive=Drive(**{"base": 0.5e-3, **drive})), SQUARE)


@pytest.mark.nightly
def test_the_follower_takes_a_corner(monkeypatch, tmp_path, capsys):
    (tmp_path / "walk.toml").write_bytes((EXAMPLES / "walk.toml").read_bytes())
    started(follower, monkeypatch, tmp_path)
    found = re.fullmatch(r"arrived after (1\.\d+) s, .* (\d+) um .*\n", capsys.readouterr().out)
    assert float(found[2]) < 1e6 * Scenario().robot.length / 4


@pytest.mark.nightly
def test_robots_that_differ_follow_the_figure_of_eight(monkeypatch, tmp_path, capsys):
    started(steer, monkeypatch, tmp_path, "--robots", "3")
    row = capsys.readouterr().out.splitlines()[-1]
    median, most = re.match(r"\| camera \| 3 of 3 \| (\d+) \| (\d+) \|", row).groups()
    # A few times the noise of a frame, and 95 % within the bound of a bend.
    assert int(median) < 4 * 1e6 * CAMERA.noise_x
    assert int(most) < 1e6 * SCENARIO.robot.length / 4


def test_a_row_of_robots_has_quantiles_of_all_distances_and_of_the_times_of_those_that_arrived():
    """Of 0 to 100 um the median is 50, and 95 % are below 95; times are steps of 0.5 s."""
    distances, none = 1e-6 * np.arange(101), np.zeros(0)
    robots = [follower.Followed(np.zeros((steps, 28)), np.zeros((steps, 5)), 0.5, arrived, part)
              for steps, arrived, part in ((20, True, distances[:30]), (24, True, distances[30:]),
                                           (90, False, none), (26, True, none))]  # fmt: skip
    assert steer.row("eye", robots) == "| eye | 3 of 4 | 50 | 95 | 100 | 12.0 (10.0 to 13.0) |"


COUNT = 12
# Of the tolerance: done is a mean of images within half of it, whose deviation is 0.3 of it.
ENOUGH, SURE, STILL = 0.5 * TOLERANCE, 0.3 * TOLERANCE, 0.1e-6


@pytest.fixture(scope="module")
def placer():
    return Placer(SCENARIO, CAMERAS["exact state"], draws=16, seed=1)


@pytest.mark.nightly
def test_the_tables_can_be_read_backwards(placer):
    assert (np.diff(placer.steps) > 0.0).all()
    assert placer.steps[0] < 0.0 < placer.steps[-1]
    assert np.abs(placer.steps[placer.steps != 0.0]).min() < TOLERANCE
    assert (placer.low > 0.0).all()


@pytest.mark.nightly
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


@pytest.mark.nightly
def test_a_robot_whose_simulation_fails_is_never_there(placer):
    ice = {"contact.static_friction": 0.0, "contact.kinetic_friction": 0.0, "drag.linear": 0.0}
    sound = SCENARIO.with_uncertain(None)
    placer.camera = CAMERAS["exact state"]
    time, *_ = placer.put([sound, sound.replace(ice)], 0.5e-3, limit=3.0)
    assert np.isfinite(time).tolist() == [True, False]


@pytest.mark.nightly
def test_the_placer_prints_a_row_for_each_camera(placer, monkeypatch, capsys):
    monkeypatch.setattr(controllers, "Placer", lambda *_, **__: placer)
    monkeypatch.setattr(controllers, "CAMERAS", {"exact state": CAMERAS["exact state"]})
    controllers.main(2)
    rows = capsys.readouterr().out.splitlines()
    assert len(rows) == 3
    assert rows[-1].startswith("| exact state |")
    assert "| 100.0 % |" in rows[-1]


def middle_of(picture, *colours):
    """Mean row and column of the pixels of some colours."""
    return np.argwhere(np.isin(picture[..., 0], [each[0] for each in colours])).mean(axis=0)


def test_a_view_from_the_side_shows_the_robot_on_the_surface():
    env = side_view.View(RobotEnv(task="walk"))
    env.reset(seed=1)
    shown, robot = env.render(), Scenario().robot
    pixel = side_view.LENGTHS * robot.length / side_view.SIZE[1]  # m
    ground = np.argmax(shown[:, 0, 0] != 255)
    row, column = middle_of(shown, side_view.RED, side_view.BLUE)
    assert column == pytest.approx(0.5 * side_view.SIZE[1], abs=1.0)
    assert ground - row == pytest.approx(0.5 * robot.height / pixel, abs=1.0)


def test_a_view_from_above_shows_where_the_robot_faces_and_its_goal():
    env = side_view.View(RobotEnv(task="reach", goal=(0.5e-3, 0.3e-3)))
    env.reset(seed=1)
    shown, vector = env.render(), env.unwrapped.vector
    assert shown.shape == (*side_view.SIZE, 3)
    length = Scenario().robot.length
    pixel = 2.0 * side_view.LENGTHS * length / side_view.SIZE[1]  # m
    # It faces +x, and its front is red, as its goal is.
    alone = side_view.view_from_above(vector.robots[0], vector.states[0])
    ahead = middle_of(alone, side_view.RED) - middle_of(alone, side_view.BLUE)
    assert ahead * pixel == pytest.approx([0.0, 0.5 * length], abs=pixel)
    goal = np.argwhere((shown != alone).any(axis=-1)).mean(axis=0) - 0.5 * np.array(side_view.SIZE)
    assert goal * pixel == pytest.approx([-0.3e-3, 0.5e-3], abs=pixel)


def test_wrappers_of_gymnasium_collect_what_a_view_draws():
    env = RenderCollection(side_view.View(RobotEnv(task="walk")))
    env.reset(seed=1)
    for _ in range(3):
        env.step(np.float32([1.0, -0.4]))
    assert len(env.render()) == 4


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "options"), [("walk", ()), ("reach", ("--above",))])
def test_an_episode_is_filmed(name, options, monkeypatch, tmp_path, capsys):
    started(side_view, monkeypatch, tmp_path, *options)
    with Image.open(tmp_path / f"{name}.webp") as film:
        assert film.n_frames > 30
        film.seek(film.n_frames - 1)
        assert film.size == side_view.SIZE[::-1]
    assert ("the goal is reached" in capsys.readouterr().out) == (name == "reach")
