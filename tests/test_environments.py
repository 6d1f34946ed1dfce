"""Gymnasium environments, and the camera between a robot and its controller."""

import copy
import importlib
import math
import pickle
import re
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from stickslip import Scenario, ScenarioError, Simulator, State
from stickslip._util.prior import Prior
from stickslip.control import Camera
from stickslip.control.environments import OBSERVED, RobotEnv, RobotVectorEnv

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
@pytest.mark.daily("Walk")
def test_the_checks_of_gymnasium_find_nothing(task):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        made = gymnasium.make(f"stickslip/{task}-v0", render_mode="rgb_array")
        check_env(made.unwrapped)


def test_pictures_of_many_are_those_of_each():
    envs = RobotVectorEnv(3, "reach", render_mode="rgb_array", uncertain=UNCERTAIN)
    envs.reset(seed=5)
    pictures = envs.render()
    assert [each.shape for each in pictures] == [(240, 400, 3)] * 3
    one = gymnasium.make("stickslip/Reach-v0", render_mode="rgb_array", uncertain=UNCERTAIN)
    one.reset(seed=5)
    assert np.array_equal(one.render(), pictures[0])
    with pytest.raises(ScenarioError, match=r"^render_mode = .human"):
        RobotVectorEnv(1, render_mode="human")


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


def test_a_made_environment_can_be_copied():
    env = gymnasium.make("stickslip/Walk-v0")
    env.reset(seed=1)
    first, later = np.split(actions(20), 2)
    for each in first:
        env.step(each[0])
    other = copy.deepcopy(env)
    expected = [env.step(each[0])[0] for each in later]
    assert np.array_equal([other.step(each[0])[0] for each in later], expected)


def test_an_empty_mapping_says_that_nothing_is_uncertain():
    given = Scenario(uncertain=UNCERTAIN)
    assert RobotVectorEnv(scenario=given).uncertain == given.uncertain
    assert RobotVectorEnv(scenario=given, uncertain={}).uncertain is None


@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_a_robot_of_many_moves_as_a_simulator(direction):
    scenario = Scenario().replace({"drive.direction": direction})
    envs = gymnasium.make_vec("stickslip/Walk-v0", num_envs=3, scenario=scenario)
    assert isinstance(envs, RobotVectorEnv)
    envs.reset(seed=1)
    sims = [Simulator(scenario) for _ in range(3)]
    for each in actions(30, 3):
        observations, *_ = envs.step(each)
        for sim, action, seen in zip(sims, each, observations, strict=True):
            volts = 26.0 * action.astype(float)
            state = sim.step({"xp": volts[0], "clamp": volts[1]}, 1e-3)
            body = [0.0, 0.0, math.cos(state.heading), math.sin(state.heading)]
            values = body + [getattr(state, name) for name in [*OBSERVED][4:]]
            assert np.array_equal(seen, np.array(values) / [*OBSERVED.values()])


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


@pytest.mark.parametrize("count", [1, 9])  # nine are stepped as a pack
@pytest.mark.parametrize("task", ["walk", "reach"])
def test_a_bad_action_is_refused_before_anything_changes(task, count):
    env, twin = (RobotEnv(task=task) if count == 1 else RobotVectorEnv(9, task) for _ in range(2))
    shape = env.action_space.shape
    good = np.full(shape, 0.3)
    for each in (env, twin):
        each.reset(seed=1)
        each.step(good)
    last = np.arange(good.size).reshape(shape) == good.size - 1
    for bad in (
        np.where(last, np.nan, good),
        np.where(last, -np.inf, good),
        np.ma.array(good, mask=last),
        good[..., :1],
        np.zeros((*shape[:-1], shape[-1] + 2)),
        "left",
        None,
    ):
        with pytest.raises(
            ScenarioError, match=rf"^action.*: allowed is shape {re.escape(str(shape))}"
        ):
            env.step(bad)
    for _ in range(5):
        for one, other in zip(env.step(good), twin.step(good), strict=True):
            np.testing.assert_equal(one, other)


@pytest.mark.parametrize("task", ["walk", "reach"])
def test_values_beyond_one_are_clipped(task):
    env, twin = RobotEnv(task=task), RobotEnv(task=task)
    signs = np.array([1.0, 1.0, -1.0])[: env.action_space.shape[0]]
    for each, size in ((env, 1.0), (twin, 1000.0)):
        each.reset(seed=1)
        each.step(size * signs)
    assert np.array_equal(env.step(0.1 * signs)[0], twin.step(0.1 * signs)[0])


def test_a_goal_that_is_reached_ends_an_episode_with_success():
    # The goal is drawn from the start, 0.05 to 0.3 mm ahead; the robot is put there, at rest.
    env = RobotEnv(task="place")
    env.reset(seed=3)
    begun = env._many._targets.goals[0] - [0.5e-6, 0.0]
    near = RobotEnv(task="place", scenario=Scenario(initial=State(x=begun[0])))
    near.reset(seed=3)
    near._many._targets.goals[:] = env._many._targets.goals
    _, reward, terminated, _, info = near.step(np.zeros(2))
    assert terminated
    assert info["success"]
    assert reward == pytest.approx(1.0, abs=1e-3)
    # A robot that flies past it, 50 um above the surface, has not been put down there.
    high = Scenario().robot.height / 2 + 50e-6
    above = RobotEnv(task="place", scenario=Scenario(initial=State(x=begun[0], z=high)))
    above.reset(seed=3)
    above._many._targets.goals[:] = env._many._targets.goals
    assert not above.step(np.zeros(2))[2]


def test_without_gymnasium_the_import_says_what_to_install(monkeypatch):
    monkeypatch.delitem(sys.modules, "stickslip.control.environments")
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(ImportError, match=r'pip install "\.\[gym\]" in the folder of stickslip$'):
        importlib.import_module("stickslip.control.environments")
