"""Environments of a robot that is steered in the whole plane."""

import math

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from measured_maps import HALF, formula_map, with_map
from stickslip import STATE_COLUMNS, Scenario, ScenarioError, Simulator, State
from stickslip.control import Camera, Path, heading_voltages
from stickslip.control.environments import CAMERA_OBSERVED, OBSERVED, RobotEnv, RobotVectorEnv

COILS = ("xp", "xm", "yp", "ym", "clamp")
TOOTH = np.linspace(1.0, -0.6, 10)  # 26 V, and down to 5 V


def walked(env, steps, turn=0.0):
    """Pulses of 10 ms until the episode ends; rewards, and the last step."""
    env.reset(seed=1)
    rewards = []
    for k in range(steps):
        step = env.step(np.float32([turn, TOOTH[k % 10] if k >= 50 else 0.0, -0.4]))
        rewards.append(step[1])
        if step[2] or step[3]:
            break
    return rewards, step


@pytest.mark.parametrize("task", ["reach", "follow"])
def test_the_spaces_are_those_of_a_robot_that_is_steered(task):
    env = RobotEnv(task=task)
    assert env.action_space.shape == (3,)
    assert env.observation_space.shape == (len(OBSERVED),)
    seen = RobotEnv(task=task, camera=Camera())
    assert seen.observation_space.shape == (len(CAMERA_OBSERVED),)
    assert RobotEnv(task=task, coils=COILS).action_space.shape == (5,)


def test_a_steered_robot_moves_as_a_simulator():
    envs = RobotVectorEnv(3, "reach")
    envs.reset(seed=1)
    sims, headings = [Simulator(Scenario(), whole_plane=True) for _ in range(3)], np.zeros(3)
    random = np.random.default_rng(0)
    for _ in range(40):
        actions = np.float32(random.uniform([-1.0, 0.0, -0.5], [1.0, 1.0, 0.0], (3, 3)))
        observations, *_, info = envs.step(actions)
        assert "failure" not in info
        given = actions.astype(float)
        headings += 50.0 * 1e-3 * given[:, 0]
        along = 26.0 * (0.2 + 0.8 * 0.5 * (1.0 + given[:, 1]))
        volts = heading_voltages(headings, along, 26.0 * given[:, 2])
        for sim, own, seen in zip(sims, volts, observations, strict=True):
            state = sim.step(own, 1e-3)
            values = [math.cos(state.heading), math.sin(state.heading)]
            values += [getattr(state, name) for name in [*OBSERVED][4:]]
            assert np.array_equal(seen[2:], np.array(values) / [*OBSERVED.values()][2:])
    assert np.abs(headings).min() > 0.01  # all of them have turned


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


def test_a_goal_in_the_plane_that_is_reached_ends_an_episode_with_success():
    env = RobotEnv(task="reach")
    env.reset(seed=1)
    env._many._targets.goals[:] = [30e-6, -20e-6]
    _, reward, terminated, truncated, info = env.step(np.zeros(3))
    assert terminated
    assert not truncated
    assert info["success"]
    assert reward == pytest.approx(1.0, abs=1e-3)


def test_a_goal_can_be_given():
    given = State(x=0.2e-3, y=-0.1e-3)
    envs = RobotVectorEnv(2, "reach", scenario=Scenario(initial=given), goal=(1.5e-3, 0.7e-3))
    for seed in (1, 2):
        observations, _ = envs.reset(seed=seed)
        assert 1e-3 * observations[:, :2] == pytest.approx(np.tile([1.3e-3, 0.8e-3], (2, 1)))


def test_with_a_field_map_a_path_and_a_goal_lie_within_it():
    scenario = with_map(formula_map())
    beyond = 1.1 * HALF[1]
    with pytest.raises(ScenarioError, match=r"path: .* y from -0.003 to 0.003 m"):
        RobotEnv(task="follow", scenario=scenario, path=[(0.0, 0.0), (0.0, beyond)])
    with pytest.raises(ScenarioError, match=r"goal: .* x from -0.008 to 0.008 m"):
        RobotEnv(task="reach", scenario=scenario, goal=(0.0, beyond))
    assert RobotEnv(task="follow", scenario=scenario, path=[(0.0, 0.0), (beyond, 0.0)])


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
    slanted = Path([(0.0, 0.0), (1e-2 * math.cos(0.3), 1e-2 * math.sin(0.3))])
    env = RobotEnv(task="follow", path=slanted)
    rewards, (*_, info) = walked(env, 200)
    x, y = (env._many._states[0, STATE_COLUMNS.index(name)] for name in ("x", "y"))
    assert abs(y) < 1e-15  # rounding of the field across
    assert info["progress"] == pytest.approx(x * math.cos(0.3))
    assert info["across"] == pytest.approx(-x * math.sin(0.3))
    assert 0.0 < sum(rewards) < 1e3 * info["progress"]


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
    envs = RobotVectorEnv(5, "reach", camera=camera)
    envs.reset(seed=1)
    for k in range(60):
        actions = np.tile(np.float32([0.2, TOOTH[k % 10], -0.4]), (5, 1))
        observations, *_ = envs.step(actions)
    ahead, left, cosine, sine, x, y, _, age = (observations * [*CAMERA_OBSERVED.values()]).T
    assert cosine**2 + sine**2 == pytest.approx(1.0)
    goals = np.column_stack([x + cosine * ahead - sine * left, y + sine * ahead + cosine * left])
    assert goals == pytest.approx(envs._targets.goals, abs=1e-12)
    assert (np.abs(x - envs._states[:, 0]) > 1e-7).all()
    assert ((age >= 0.02 - 1e-9) & (age < 0.03 + 1e-9)).all()


def test_the_next_point_of_a_path_lies_ahead_of_where_the_robot_is_seen():
    camera = Camera(frame_rate=100.0, latency=0.05)
    path = Path([(0.0, 0.0), (5e-3, 0.0)])
    env = RobotEnv(task="follow", path=path, camera=camera)
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
