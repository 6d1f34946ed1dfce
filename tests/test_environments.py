"""Gymnasium environments, and the camera between a robot and its controller."""

import importlib
import math
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from stickslip import Scenario, ScenarioError, Simulator, State
from stickslip.control import Camera, Film
from stickslip.control.environments import OBSERVED, UNITS, RobotEnv, RobotVectorEnv
from stickslip.scenario.priors import Prior

TASKS = ("Walk", "Reach", "Place")
UNCERTAIN = {
    "contact.static_friction": Prior("normal", 0.3, 0.02),
    "robot.mass": Prior("log-normal", 25.6e-9, 1.1),
}
CAMERA = Camera(
    frame_rate=100.0, exposure=3e-3, latency=0.02, noise_x=1e-6, noise_theta=0.01, pixel=1e-6,
    dropped=0.1,
)  # fmt: skip


def actions(steps, robots=1, seed=0):
    draws = np.random.default_rng(seed).uniform(-1.0, 1.0, (steps, robots, 2))
    return draws.astype(np.float32)


def played(envs, steps, seed=1):
    found = [envs.reset(seed=seed)[0]]
    for each in actions(steps, envs.num_envs):
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
def test_the_same_seed_gives_the_same_bits_on_any_number_of_threads(camera):
    one, other = (
        played(
            RobotVectorEnv(
                12, "reach", uncertain=UNCERTAIN, camera=camera, threads=n, max_episode_steps=30
            ),
            70,
        )
        for n in (1, 3)
    )
    assert np.array_equal(one, other)
    again = RobotVectorEnv(12, "reach", uncertain=UNCERTAIN, camera=camera, max_episode_steps=30)
    assert np.array_equal(played(again, 70), one)
    assert not np.array_equal(played(again, 70, seed=2), one)


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


def test_a_goal_that_is_reached_ends_an_episode_with_success():
    # The goal is ahead by 0.5 to 2 mm; the robot is put there.
    env = RobotEnv(task="reach")
    observation, _ = env.reset(seed=3)
    ahead = observation[0] * UNITS[0]
    assert 0.5e-3 <= ahead <= 2e-3
    near = RobotEnv(task="reach", scenario=Scenario(initial=State(x=1e-3)))
    near.reset(seed=3)
    near._many._goals[:] = 1.02e-3
    _, reward, terminated, _, info = near.step(np.zeros(2))
    assert terminated
    assert info["success"]
    assert reward == pytest.approx(1.0, abs=1e-3)


def test_frames_come_at_their_rate_and_late():
    camera = Camera(frame_rate=100.0, latency=0.025)
    film = Film(camera, 1e-3, np.zeros(2))
    random = np.random.default_rng(0)
    for k in range(1, 101):
        time = 1e-3 * k
        pose, age = film.watch(time, np.array([time, 0.0]), random)
        if time >= 0.045:
            # The newest frame is at most one period older than the latency.
            assert camera.latency - 1e-9 <= age <= camera.latency + 0.01 + 1e-9
            assert pose[0] == pytest.approx(time - age, abs=1e-12)


def test_an_exposure_averages_and_noise_has_its_size():
    camera = Camera(frame_rate=100.0, exposure=5e-3, noise_x=2e-6)
    film = Film(camera, 1e-3, np.zeros(2))
    random = np.random.default_rng(0)
    errors = []
    for k in range(1, 20_001):
        time = 1e-3 * k
        pose, age = film.watch(time, np.array([time, 0.0]), random)
        if age == 0.0:
            # The mean of five samples, the last of them now.
            errors.append(pose[0] - (time - 2e-3))
    # 2000 normal draws: the mean within 4 sd / sqrt(n), the sd within 4 / sqrt(2 n) of itself.
    count = len(errors) - 1
    assert abs(np.mean(errors[1:])) < 4 * 2e-6 / math.sqrt(count)
    assert np.std(errors[1:]) == pytest.approx(2e-6, rel=4 / math.sqrt(2 * count))


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
    "period = 0": lambda: Film(Camera(), 0, np.zeros(2)),
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
