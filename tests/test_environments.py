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

from stickslip import Scenario, ScenarioError, Simulator, State
from stickslip.control import Camera
from stickslip.control.environments import RobotEnv, RobotVectorEnv
from stickslip.control.observations import OBSERVED, UNITS
from stickslip.scenario.uncertain import Prior

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
        check_env(gymnasium.make(f"stickslip/{task}-v0").unwrapped, skip_render_check=True)


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


def test_a_robot_of_many_moves_as_a_simulator():
    envs = gymnasium.make_vec("stickslip/Walk-v0", num_envs=3)
    assert isinstance(envs, RobotVectorEnv)
    envs.reset(seed=1)
    sims = [Simulator(Scenario()) for _ in range(3)]
    for each in actions(30, 3):
        observations, *_ = envs.step(each)
        for sim, action, seen in zip(sims, each, observations, strict=True):
            volts = 26.0 * action.astype(float)
            state = sim.step({"xp": volts[0], "clamp": volts[1]}, 1e-3)
            values = [0.0] + [getattr(state, name) for name in OBSERVED[1:]]
            assert np.array_equal(seen, np.array(values) / UNITS)


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
        observations, _ = envs.reset(options={"reset_mask": mask})
        assert np.array_equal(observations[mask], start[mask])
        assert not np.array_equal(observations[~mask], start[~mask])


def test_a_failure_ends_an_episode_and_says_so():
    fast = Scenario(initial=State(x=0.0885, vx=0.5)).replace({"drag.linear": 0.0})
    env = RobotEnv(scenario=fast)
    env.reset(seed=1)
    for _ in range(100):
        _, _, terminated, truncated, info = env.step(np.array([0.5, -0.4]))
        if terminated:
            break
    assert terminated
    assert not truncated
    assert info["failure"] == "left_workspace"


BAD_ACTIONS = {
    "not finite": (
        lambda n: np.r_[[0.5] * (n - 1), np.nan],
        r"\[.*nan\]: allowed is shape \(%d,\)",
    ),
    "infinite": (lambda n: np.r_[-np.inf, [0.5] * (n - 1)], r"\[-inf, .*\]: allowed is shape"),
    "too few": (lambda n: np.zeros(n - 1), r"of shape \(.*\): allowed is shape \(%d,\) of finite"),
    "too many": (lambda n: np.zeros(n + 2), r"of shape \(.*\): allowed is shape \(%d,\) of finite"),
    "of two": (lambda n: np.zeros((2, n)), r"of shape \(2, .*\): allowed is shape \(%d,\)"),
    "a word": (lambda n: "left", r'= "left" of shape \(\): allowed is shape \(%d,\)'),
    "nothing": (lambda n: None, r"= None of shape \(\): allowed is shape \(%d,\)"),
    "ragged": (lambda n: [[0.0], [0.0, 1.0]], r"allowed is shape \(%d,\)"),
}


@pytest.mark.parametrize("bad", BAD_ACTIONS)
@pytest.mark.parametrize("task", ["walk", "reach"])
def test_a_bad_action_is_refused_before_anything_changes(task, bad):
    env, twin = RobotEnv(task=task), RobotEnv(task=task)
    values = env.action_space.shape[0]
    for each in (env, twin):
        each.reset(seed=1)
        each.step(np.full(values, 0.5))
    make, told = BAD_ACTIONS[bad]
    told = "^action " + r".*" + (told % values if "%" in told else told)
    with pytest.raises(ScenarioError, match=told) as refusal:
        env.step(make(values))
    assert "\n" not in str(refusal.value)
    for action in actions(5, values=values)[:, 0]:
        one, other = env.step(action), twin.step(action)
        assert np.array_equal(one[0], other[0])
        assert one[1:] == other[1:]


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("task", ["walk", "reach"])
def test_of_many_robots_only_the_one_without_an_action_fails(task, threads):
    # Nine robots, so that the others are stepped as a pack.
    envs = RobotVectorEnv(9, task, threads=threads)
    twins = RobotVectorEnv(9, task)
    for each in (envs, twins):
        each.reset(seed=1)
    values = envs.values
    good = np.full((9, values), 0.3)
    with pytest.raises(
        ScenarioError, match=rf"of shape \(9, 1\): allowed is shape \(9, {values}\)"
    ):
        envs.step(good[:, :1])
    bad, others = good.copy(), np.arange(9) != 4
    bad[4, 1] = np.nan
    observations, _, terminations, truncations, info = envs.step(bad)
    expected, *_ = twins.step(good)
    assert terminations.tolist() == (~others).tolist()
    assert not truncations.any()
    assert info["failure"][4] == "not_finite"
    assert np.isfinite(observations).all()
    assert np.array_equal(observations[others], expected[others])
    # What is over begins anew with the next step, whatever its action is.
    for _ in range(3):
        observations, _, terminations, *_ = envs.step(bad)
        expected, *_ = twins.step(good)
        assert np.array_equal(observations[others], expected[others])
        assert not terminations[others].any()


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
    observation, _ = env.reset(seed=3)
    ahead = observation[0] * UNITS[0]
    assert 0.05e-3 <= ahead <= 0.3e-3
    begun = env._many._targets._goals[0] - [0.5e-6, 0.0]
    near = RobotEnv(task="place", scenario=Scenario(initial=State(x=begun[0])))
    near.reset(seed=3)
    near._many._targets._goals[:] = env._many._targets._goals
    _, reward, terminated, _, info = near.step(np.zeros(2))
    assert terminated
    assert info["success"]
    assert reward == pytest.approx(1.0, abs=1e-3)


REFUSED = {
    "task": lambda: RobotEnv(task="wlak"),
    "coils": lambda: RobotEnv(coils=["zp"]),
    "camera.frame_rate": lambda: Camera(frame_rate=0.0),
    "camera.dropped": lambda: Camera(dropped=2.0),
    "camera.exposure": lambda: Camera(frame_rate=100.0, exposure=0.1),
    "camera = 30": lambda: gymnasium.make("stickslip/Walk-v0", camera=30),
    'scenario = "x.toml"': lambda: gymnasium.make("stickslip/Walk-v0", scenario="x.toml"),
    "num_envs = 0": lambda: RobotVectorEnv(0),
    "num_envs = -1": lambda: RobotVectorEnv(-1),
    "seed has 3 entries: allowed are 2": lambda: RobotVectorEnv(2).reset(seed=[1, 2, 3]),
    'path: the task "reach" follows none': lambda: RobotEnv(task="reach", path=[(0, 0), (1, 0)]),
    "the path begins 5 mm from the robot: allowed is at most 0.25 mm": lambda: RobotEnv(
        task="follow", path=[(5e-3, 0.0), (6e-3, 0.0)]
    ),
    "the path begins 3 mm": lambda: RobotEnv(  # known when it is drawn
        task="follow",
        path=[(0.0, 0.0), (1e-3, 0.0)],
        uncertain={"initial.x": {"mean": 3e-3, "sd": 1e-9}},
    ).reset(seed=1),
    r"path: \(2, 0\) m lies beyond .* x from -0.099 to 0.099 m": lambda: RobotEnv(
        task="follow", path=[(0.0, 0.0), (2.0, 0.0)]
    ),
    'path = "L"': lambda: RobotEnv(task="follow", path="L"),
    r"goal: \(0, 1\) m lies beyond": lambda: RobotEnv(task="reach", goal=(0.0, 1.0)),
    "goal = .*: allowed is x and y": lambda: RobotEnv(task="reach", goal=(math.nan, 0.0)),
    r"goal of shape \(3,\): allowed is \(2,\)": lambda: RobotEnv(
        task="reach", goal=(0.0, 0.0, 0.0)
    ),
    'goal: the task "walk" takes none': lambda: RobotEnv(goal=(1e-3, 0.0)),
    "turning = -3: allowed is a finite number of rad/s above 0": lambda: RobotEnv(turning=-3),
    "voltage = -5: allowed is a finite number of V above 0": lambda: RobotEnv(voltage=-5),
    "voltage = nan": lambda: RobotEnv(voltage=math.nan),
    "period = 0: allowed is a finite number of s above 0": lambda: RobotEnv(period=0),
    "period = -1": lambda: RobotEnv(period=-1),
    'period = "x"': lambda: RobotEnv(period="x"),
    "max_episode_steps = -1: allowed is a whole": lambda: RobotVectorEnv(max_episode_steps=-1),
    'coils = .* allowed is "clamp" and one': lambda: RobotEnv(task="follow", coils=("xp", "yp")),
    'coils = "xp"': lambda: RobotEnv(coils="xp"),
    "coils = 5": lambda: RobotEnv(coils=5),
    "each once": lambda: RobotEnv(coils=("xp", "xp")),
    "corner 2 is where the one before it is": lambda: RobotEnv(
        task="follow", path=[(0.0, 0.0), (1e-3, 0.0), (1e-3, 0.0)]
    ),
    "robot.mass": lambda: RobotEnv(uncertain={"robot.mass": Prior("normal", 1e3, 1.0)}),
}


@pytest.mark.parametrize("told", REFUSED)
def test_what_makes_no_environment_is_refused_in_one_line(told):
    with pytest.raises(ScenarioError, match=told) as refusal:
        REFUSED[told]()
    assert "\n" not in str(refusal.value)


def test_without_gymnasium_the_import_says_what_to_install(monkeypatch):
    monkeypatch.delitem(sys.modules, "stickslip.control.environments")
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(ImportError, match=r'pip install "stickslip\[gym\]"$'):
        importlib.import_module("stickslip.control.environments")
