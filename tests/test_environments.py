"""Gymnasium environments, and the camera between a robot and its controller."""

import copy
import importlib
import math
import pickle
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from measured_maps import HALF, formula_map, with_map
from stickslip import STATE_COLUMNS, Scenario, ScenarioError, Simulator, State
from stickslip._util.prior import Prior
from stickslip.control import Camera, Film, heading_voltages
from stickslip.control.environments import CAMERA_OBSERVED, OBSERVED, RobotEnv, RobotVectorEnv

TASKS = ("Walk", "Reach", "Place", "Follow")
UNCERTAIN = {
    "contact.static_friction": Prior("normal", 0.3, 0.02),
    "robot.mass": Prior("log-normal", 25.6e-9, 1.1),
}
CAMERA = Camera(
    frame_rate=100.0, exposure=3e-3, latency=0.02, noise_x=1e-6, noise_theta=0.01, pixel=1e-6,
    dropped=0.1,
)  # fmt: skip


def actions(steps, robots=1, seed=0, values=2):
    draws = np.random.default_rng(seed).uniform(-1.0, 1.0, (steps, robots, values))
    return draws.astype(np.float32)


def played(envs, steps, seed=1):
    found = [envs.reset(seed=seed)[0]]
    values = envs.single_action_space.shape[0]
    for each in actions(steps, envs.num_envs, values=values):
        observations, rewards, terminations, truncations, _ = envs.step(each)
        found += [observations.copy(), rewards[:, None], terminations[:, None]]
        found.append(truncations[:, None])
    return np.concatenate([np.asarray(each, dtype=float).ravel() for each in found])


@pytest.mark.parametrize("task", TASKS)
def test_the_checks_of_gymnasium_find_nothing(task):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(f"stickslip/{task}-v0").unwrapped)


@pytest.mark.parametrize("camera", [None, CAMERA])
@pytest.mark.parametrize("task", ["place", "reach", "follow"])
def test_the_same_seed_gives_the_same_bits_on_any_number_of_threads(task, camera):
    options = {"uncertain": UNCERTAIN, "camera": camera, "max_episode_steps": 30}
    one, other = (played(RobotVectorEnv(12, task, threads=n, **options), 70) for n in (1, 3))
    assert np.array_equal(one, other)
    again = RobotVectorEnv(12, task, **options)
    assert np.array_equal(played(again, 70), one)
    assert not np.array_equal(played(again, 70, seed=2), one)


@pytest.mark.parametrize("task", TASKS)
def test_a_copy_is_an_independent_environment(task):
    # Each robot has its own draw, its noise and, after some steps, a state in the whole plane.
    def last(envs, steps):
        return [np.copy(envs.step(each)[0]) for each in steps]

    envs = RobotVectorEnv(3, task.lower(), uncertain=UNCERTAIN, camera=CAMERA)
    values = envs.single_action_space.shape[0]
    first, later = np.split(actions(24, 3, values=values), 2)
    envs.reset(seed=4)
    last(envs, first)
    copies = [copy.copy(envs), copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))]
    expected = last(envs, later)
    for each in copies:
        assert np.array_equal(last(each, later), expected)


def test_an_empty_mapping_says_that_nothing_is_uncertain():
    given = Scenario(uncertain=UNCERTAIN)
    assert RobotVectorEnv(scenario=given).uncertain == given.uncertain
    assert RobotVectorEnv(scenario=given, uncertain={}).uncertain is None


@pytest.mark.parametrize(("task", "direction"), [("Walk", "+x"), ("Walk", "-x"), ("Reach", "+x")])
def test_a_robot_of_many_moves_as_a_simulator(task, direction):
    scenario, steered = Scenario().replace({"drive.direction": direction}), task == "Reach"
    envs = gymnasium.make_vec(f"stickslip/{task}-v0", num_envs=3, scenario=scenario)
    assert isinstance(envs, RobotVectorEnv)
    envs.reset(seed=1)
    sims = [Simulator(scenario, whole_plane=steered) for _ in range(3)]
    headings = np.zeros(3)
    for given in actions(40, 3, values=2 + steered):
        if steered:
            given[:, 1:] = 0.5 * given[:, 1:] + [0.5, -0.25]  # so that it faces the field
            headings += 50.0 * 1e-3 * given[:, 0].astype(float)
            along = 26.0 * (0.2 + 0.8 * 0.5 * (1.0 + given[:, 1].astype(float)))
            volts = heading_voltages(headings, along, 26.0 * given[:, 2].astype(float))
        else:
            volts = np.zeros((3, 5))
            volts[:, [0, 4]] = 26.0 * given.astype(float)
        observations, *_, info = envs.step(given)
        assert "failure" not in info
        for sim, own, seen in zip(sims, volts, observations, strict=True):
            state = sim.step(own, 1e-3)
            values = [math.cos(state.heading), math.sin(state.heading)]
            values += [getattr(state, name) for name in [*OBSERVED][4:]]
            assert np.array_equal(seen[2:], np.array(values) / [*OBSERVED.values()][2:])


def test_the_goal_is_seen_from_the_body():
    # Both goals lie on +x: ahead of a robot that faces +x, behind one that faces -x.
    for direction, sign in (("+x", 1.0), ("-x", -1.0)):
        env = RobotEnv(task="place", scenario=Scenario().replace({"drive.direction": direction}))
        ahead, left, cosine, sine = env.reset(seed=3)[0][:4]
        assert 0.05 <= sign * ahead <= 0.3  # mm
        assert (left, cosine, sine) == pytest.approx((0.0, sign, 0.0), abs=1e-12)


@pytest.mark.parametrize(
    "seed", [[5, 6, 7], (5, 6, 7), range(5, 8), np.array([5, 6, 7], np.uint8), np.int64(5), None]
)
def test_seeds_are_numbers_of_any_kind(seed):
    envs = RobotVectorEnv(3, "reach")
    expected = envs.reset(seed=5)[0]
    assert np.array_equal(envs.reset(seed=seed)[0], expected) == (seed is not None)


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_an_episode_that_is_over_begins_anew_as_the_mode_says(mode):
    envs = RobotVectorEnv(4, max_episode_steps=5, autoreset_mode=mode)
    start, _ = envs.reset(seed=1)
    for each in actions(5, 4):
        observations, rewards, terminations, truncations, info = envs.step(each)
    assert truncations.all()
    assert not terminations.any()
    if mode == AutoresetMode.SAME_STEP:
        assert np.array_equal(observations, start)
        assert info["_final_obs"].all()
        assert not np.array_equal(np.stack(info["final_obs"]), start)
    elif mode == AutoresetMode.NEXT_STEP:
        observations, rewards, terminations, truncations, info = envs.step(actions(1, 4)[0])
        assert np.array_equal(observations, start)
        assert not rewards.any()
        assert not truncations.any()
    else:
        with pytest.raises(ValueError, match="reset_mask"):
            envs.step(actions(1, 4)[0])
        mask = np.array([True, False, True, False])
        observations, _ = envs.reset(options={"reset_mask": mask.tolist()})
        assert np.array_equal(observations[mask], start[mask])
        assert not np.array_equal(observations[~mask], start[~mask])


@pytest.mark.parametrize("task", ["walk", "reach"])
def test_a_bad_action_is_refused_before_anything_changes_and_a_large_one_clipped(task):
    env, twin = (RobotVectorEnv(9, task) for _ in range(2))  # nine are stepped as a pack
    good = np.full(env.action_space.shape, 0.3)
    for each in (env, twin):
        each.reset(seed=1)
        each.step(good)
    last = np.arange(good.size).reshape(good.shape) == good.size - 1
    for bad in (np.where(last, np.nan, good), np.ma.array(good, mask=last), good[:, :1]):
        with pytest.raises(ScenarioError, match=r"^actions.*: allowed is shape \(9, "):
            env.step(bad)
    env.step(np.where(last, 1000.0, good))  # which is clipped
    twin.step(np.where(last, 1.0, good))
    for _ in range(5):
        for one, other in zip(env.step(good), twin.step(good), strict=True):
            np.testing.assert_equal(one, other)


@pytest.mark.parametrize(("task", "goal"), [("place", (0.1e-3, 0.0)), ("reach", (0.12e-3, -30e-6))])
def test_a_goal_that_is_reached_ends_an_episode_with_success(task, goal):
    def last_step(**start):
        env = RobotEnv(task=task, goal=goal, scenario=Scenario(initial=State(**start)))
        env.reset(seed=3)
        return env.step(np.zeros(env.action_space.shape))

    _, reward, terminated, truncated, info = last_step(x=0.1e-3 - 0.5e-6)
    assert (terminated, truncated, info["success"]) == (True, False, True)
    assert reward == pytest.approx(1.0, abs=1e-3)
    # A robot that flies past it, 50 um above the surface, has not been put down there.
    flies = last_step(x=0.1e-3, z=Scenario().robot.height / 2 + 50e-6)
    assert flies[2] == (task == "reach")


def test_without_gymnasium_the_import_says_what_to_install(monkeypatch):
    monkeypatch.delitem(sys.modules, "stickslip.control.environments")
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(ImportError, match=r'pip install "\.\[gym\]" in the folder of stickslip$'):
        importlib.import_module("stickslip.control.environments")


COILS = ("xp", "xm", "yp", "ym", "clamp")
TOOTH = np.linspace(1.0, -0.6, 10)  # 26 V, and down to 5 V


def walked(env, steps):
    """Pulses of 10 ms until the episode ends; rewards, and the last step."""
    env.reset(seed=1)
    rewards = []
    for k in range(steps):
        step = env.step(np.float32([0.0, TOOTH[k % 10] if k >= 50 else 0.0, -0.4]))
        rewards.append(step[1])
        if step[2] or step[3]:
            break
    return rewards, step


@pytest.mark.parametrize("ambient", [0.0, 2e-5])
def test_no_actions_lose_the_heading(ambient):
    # The Earth's field aside, and the weakest field while it is turned.
    scenario = Scenario().replace({"effects.ambient_field.By": ambient})
    envs = RobotVectorEnv(8, "reach", scenario=scenario, goal=(9e-3, 0.0))
    envs.reset(seed=1)
    random = np.random.default_rng(1)
    for step in range(200):
        actions = random.uniform(-1.0, 1.0, (8, 3))
        actions[:4] = [1.0, 1.0 if step // 40 % 2 == 0 else -1.0, -0.4]
        *_, info = envs.step(np.float32(actions))
        assert "failure" not in info


def test_a_goal_lies_somewhere_around_the_start():
    envs = RobotVectorEnv(400, "reach")
    observations, _ = envs.reset(seed=1)
    offsets = 1e-3 * observations[:, :2]  # all face +x
    distances = np.hypot(*offsets.T)
    assert distances.min() >= 0.5e-3
    assert distances.max() <= 2e-3
    # Of 400 bearings each quarter has 100, with a deviation of 9.
    quarters = np.floor(np.arctan2(offsets[:, 1], offsets[:, 0]) / (0.5 * np.pi))
    assert min(np.sum(quarters == each) for each in (-2, -1, 0, 1)) > 100 - 4 * 9


def test_with_a_field_map_a_path_lies_within_it():
    scenario, beyond = with_map(formula_map()), 1.1 * HALF[1]
    with pytest.raises(ScenarioError, match=r"x from -0.008 to 0.008 m and y from -0.003 to 0.003"):
        RobotEnv(task="follow", scenario=scenario, path=[(0.0, 0.0), (0.0, beyond)])
    RobotEnv(task="follow", scenario=scenario, path=[(0.0, 0.0), (beyond, 0.0)])


def test_a_straight_path_is_followed_to_its_end():
    env = RobotEnv(task="follow", path=[(0.0, 0.0), (0.4e-3, 0.0)])
    rewards, (observation, _, terminated, _, info) = walked(env, 1000)
    assert terminated
    assert info["success"]
    # The end counts from 50 um before it; one step of 1 ms goes less than 50 um.
    assert 0.35e-3 <= info["progress"] < 0.4e-3
    assert abs(info["across"]) < 1e-15  # rounding of the field across
    assert sum(rewards) == pytest.approx(1e3 * info["progress"] + 1.0)
    # The next point ahead is the end.
    x = 1e-3 * observation[[*OBSERVED].index("x")]
    assert observation[:2] == pytest.approx([(0.4e-3 - x) / 1e-3, 0.0], abs=1e-12)


def test_what_counts_is_the_way_along_the_path_less_what_is_beside_it():
    slanted = [(0.0, 0.0), (1e-2 * math.cos(0.3), 1e-2 * math.sin(0.3))]
    env = RobotEnv(task="follow", path=slanted)
    rewards, (*_, info) = walked(env, 200)
    x, y = (env.vector.states[0, STATE_COLUMNS.index(name)] for name in ("x", "y"))
    assert abs(y) < 1e-15  # rounding of the field across
    assert info["progress"] == pytest.approx(x * math.cos(0.3))
    assert info["across"] == pytest.approx(-x * math.sin(0.3))
    assert 0.0 < sum(rewards) < 1e3 * info["progress"]


@pytest.mark.nightly
def test_a_path_is_followed_through_its_crossing():
    env = RobotEnv(task="follow")
    observation, _ = env.reset(seed=1)
    progress, terminated = [0.0], False
    while not terminated:
        turn = np.clip(np.arctan2(observation[1], observation[0]), -1.0, 1.0)
        action = [turn, TOOTH[len(progress) % 10], -0.4]
        observation, _, terminated, _, info = env.step(np.float32(action))
        progress.append(info["progress"])
    assert info["success"]
    # A figure of eight of 4 mm is 3.0487 widths long; one step of 1 ms goes less than 50 um.
    assert 3.0487 * 4e-3 - 60e-6 < progress[-1] < 3.0487 * 4e-3
    assert np.abs(np.diff(progress)).max() < 50e-6


# Each with an environment, and the action of a step.
FAILURES = {
    "left_workspace": (
        {"scenario": Scenario(initial=State(x=0.0885, vx=0.5)).replace({"drag.linear": 0.0})},
        lambda k, random: [0.5, -0.4],
    ),
    # The figure of eight begins at 45 degrees, and the robot walks on along x.
    "left_path": (
        {"task": "follow"},
        lambda k, random: [0.0, TOOTH[k % 10] if k >= 50 else 0.0, -0.4],
    ),
    "heading_lost": ({"task": "reach", "coils": ("yp", "clamp"), "voltage": 25.0},
                     lambda k, random: [1.0 if k < 100 else -1.0, 0.0]),
    # Voltages of single coils chosen at random: the field is weak, and its direction jumps.
    "turns_too_fast": ({"task": "reach", "coils": COILS},
                       lambda k, random: random.uniform(-1.0, 1.0, 5)),
}  # fmt: skip


@pytest.mark.parametrize("failure", FAILURES)
def test_a_failure_ends_an_episode_and_says_so(failure):
    options, action = FAILURES[failure]
    env, random = RobotEnv(**options), np.random.default_rng(0)
    env.reset(seed=1)
    for k in range(1000):
        *_, terminated, truncated, info = env.step(np.float32(action(k, random)))
        if terminated or truncated:
            break
    assert (terminated, truncated, info["failure"]) == (True, False, failure)
    assert not info.get("success")
    assert k > 100 or failure != "heading_lost"
    assert abs(info.get("across", math.inf)) > 0.25e-3


def test_a_camera_shows_the_goal_from_where_it_sees_the_robot():
    camera = Camera(frame_rate=100.0, latency=0.02, noise_x=20e-6, noise_heading=0.2)
    envs = RobotVectorEnv(5, "reach", camera=camera, goal=(1e-3, 0.5e-3))
    envs.reset(seed=1)
    for k in range(60):
        actions = np.tile(np.float32([0.2, TOOTH[k % 10], -0.4]), (5, 1))
        observations, *_ = envs.step(actions)
    ahead, left, cosine, sine, x, y, _, age = (observations * [*CAMERA_OBSERVED.values()]).T
    assert cosine**2 + sine**2 == pytest.approx(1.0)
    goals = np.column_stack([x + cosine * ahead - sine * left, y + sine * ahead + cosine * left])
    assert goals == pytest.approx(np.tile([1e-3, 0.5e-3], (5, 1)), abs=1e-12)
    assert (np.abs(x - envs.states[:, 0]) > 1e-7).all()
    assert ((age >= 0.02 - 1e-9) & (age < 0.03 + 1e-9)).all()


def test_the_next_point_of_a_path_lies_ahead_of_where_the_robot_is_seen():
    camera = Camera(frame_rate=100.0, latency=0.05)
    env = RobotEnv(task="follow", path=[(0.0, 0.0), (5e-3, 0.0)], camera=camera)
    _, (observation, *_, info) = walked(env, 200)
    ahead, _, _, _, x, *_ = observation * [*CAMERA_OBSERVED.values()]
    assert x < info["progress"] - 20e-6  # it walks some 2 mm/s
    assert ahead == pytest.approx(0.25e-3, abs=1e-9)


def test_robots_that_go_on_keep_their_figures_where_another_begins_anew():
    envs = RobotVectorEnv(2, "follow", autoreset_mode=AutoresetMode.SAME_STEP)
    envs.reset(seed=1)
    # The second robot walks straight on, away from the path, and its episode ends.
    for k in range(2000):
        actions = np.float32([[0.0, 0.0, -0.4], [0.0, TOOTH[k % 10], -0.4]])
        _, _, terminated, truncated, info = envs.step(actions)
        if np.any(terminated | truncated):
            break
    ended = terminated | truncated
    assert ended.tolist() == [False, True]
    assert info["_final_info"].tolist() == info["_final_obs"].tolist() == [False, True]
    assert info["_progress"].tolist() == [True, False]
    assert info["progress"][0] == info["final_info"]["progress"][0]


def watched(camera, poses):
    """Poses and ages that a film shows after each step of 1 ms."""
    film, random = Film(camera, 1e-3, np.zeros_like(poses[0])), np.random.default_rng(0)
    shown = [film.watch(1e-3 * k, pose, random) for k, pose in enumerate(poses, start=1)]
    return np.array([pose for pose, _ in shown]), np.array([age for _, age in shown])


TIMES = 1e-3 * np.arange(1, 101)
GOES_ON = np.column_stack([TIMES, np.zeros(100)])


def test_frames_come_at_their_rate_and_late():
    camera = Camera(frame_rate=100.0, latency=0.025)
    poses, ages = watched(camera, GOES_ON)
    later = slice(45, None)
    # The newest frame is at most one period older than the latency.
    assert ages[later].min() >= camera.latency - 1e-9
    assert ages[later].max() <= camera.latency + 0.01 + 1e-9
    assert poses[later, 0] == pytest.approx((TIMES - ages)[later], abs=1e-12)


def test_an_exposure_averages():
    poses, ages = watched(Camera(frame_rate=100.0, exposure=5e-3), GOES_ON)
    # The mean of five samples, the last of them now.
    fresh = (ages == 0.0) & (TIMES > 1.5e-3)
    assert TIMES[fresh] == pytest.approx(1e-2 * np.arange(1, 11))
    assert poses[fresh, 0] == pytest.approx(TIMES[fresh] - 2e-3, abs=1e-12)


def test_frames_are_dropped_as_often_as_said():
    count = 4000
    _, ages = watched(Camera(frame_rate=1000.0, dropped=0.3), np.zeros((count, 2)))
    # A binomial number, within four deviations.
    assert np.mean(ages == 0.0) == pytest.approx(0.7, abs=4 * math.sqrt(0.3 * 0.7 / count))


def test_a_camera_sees_the_plane_with_noise_of_every_kind():
    camera = Camera(frame_rate=1000.0, noise_x=2e-6, noise_theta=0.01, noise_heading=0.03)
    still, count = np.array([1e-3, -2e-3, 0.5, 1.0]), 2000
    seen, _ = watched(camera, np.tile(still, (count, 1)))
    # The mean within 4 sd / sqrt(n), the sd within 4 / sqrt(2 n) of itself.
    sd = np.array([2e-6, 2e-6, 0.01, 0.03])
    assert (np.abs(seen.mean(axis=0) - still) < 4 * sd / math.sqrt(count)).all()
    assert seen.std(axis=0) == pytest.approx(sd, rel=4 / math.sqrt(2 * count))


def test_both_places_have_the_quantum_of_a_pixel():
    poses, _ = watched(Camera(frame_rate=1000.0, pixel=5e-6), [np.array([12e-6, -13e-6, 0.3, 0.7])])
    assert poses[0] == pytest.approx([10e-6, -15e-6, 0.3, 0.7])


def test_headings_about_half_a_turn_are_averaged_as_directions():
    # 3.1 and -3.1 lie on both sides of the -x direction, whose heading is pi or -pi.
    turned = np.array([[0.0, 0.0, 0.0, 3.1], [0.0, 0.0, 0.0, -3.1]])
    poses, _ = watched(Camera(frame_rate=500.0, exposure=2e-3), turned)
    assert math.cos(poses[-1, 3]) == pytest.approx(-1.0, abs=1e-12)


def test_a_film_of_many_robots_is_a_film_of_each():
    camera = Camera(frame_rate=60.0, exposure=4e-3, latency=0.02, pixel=1e-6)
    poses = np.random.default_rng(0).normal(0.0, 1e-5, (200, 3, 2)).cumsum(axis=0)
    together, ages = watched(camera, poses)
    for k in range(3):
        alone, own_ages = watched(camera, poses[:, k])
        assert np.array_equal(alone, together[:, k])
        assert np.array_equal(own_ages, ages)
