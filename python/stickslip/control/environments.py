"""Gymnasium environments of one robot and of many; importing this module registers them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.arrays import Array, Indices, Mask, numbers, worker_count
from stickslip.extras import naming_the_extra

with naming_the_extra("stickslip.control.environments"):
    import gymnasium
    from gymnasium.vector import AutoresetMode

from stickslip import _core
from stickslip._util.messages import (
    check_above_zero,
    check_kind,
    check_whole,
    known_arguments,
    refuse,
    shown,
    suggestion,
)
from stickslip._util.prior import Prior
from stickslip.control.camera import Camera, Film
from stickslip.control.steering import heading_voltages
from stickslip.control.tasks import TASKS, Places, Targets
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import COIL_NAMES, coil_places
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import CONTACT_WORDS, STATE_COLUMNS
from stickslip.scenario.uncertain import JointPrior

_BODY = {"goal ahead": 1e-3, "goal left": 1e-3, "cos heading": 1.0, "sin heading": 1.0}
OBSERVED = {
    **_BODY,
    "x": 1e-3, "y": 1e-3, "z": 1e-4, "theta": 1.0,
    "vx": 1e-2, "vy": 1e-2, "vz": 1e-2, "omega": 100.0,
    **{f"current_{coil}": 1.0 for coil in COIL_NAMES},
}  # fmt: skip
"""Columns of an observation without a camera: how far the goal is ahead of the robot and to its
left, where it faces, and its state; with what one stands for in each, SI units."""

CAMERA_OBSERVED = {**_BODY, "x": 1e-3, "y": 1e-3, "theta": 1.0, "age": 0.1}
"""Columns with a camera: of the pose that the newest frame shows, and the age of that, s."""

_Seeds = int | Sequence[int | None] | Indices | None
_FARTHEST = 1e6  # chosen: finite, as libraries want it, and beyond all that moves
# Part of the voltage that the field along the surface always has. Chosen: of 26 V it makes 0.5 mT,
# ten times the field below which friction may hold the heading.
_LEAST = 0.2
_STATE = [STATE_COLUMNS.index(name) for name in OBSERVED if name not in _BODY]
_POSE = [STATE_COLUMNS.index(name) for name in ("x", "y", "theta", "heading")]
_CONTACT = STATE_COLUMNS.index("contact")
_RESTS = [CONTACT_WORDS.index(name) for name in ("corner_stick", "face_stick")]


@known_arguments
class RobotVectorEnv(gymnasium.vector.VectorEnv[Array, Array, Any]):
    """Step robots together in the core.

    An action has values from -1 to 1 (others are clipped), and holds for `period`.
    In "walk" and "place" they are the voltages of `coils` over `voltage`. In "reach" and "follow"
    they are how fast the field along the surface turns to the left, over `turning`; the voltage
    that makes this field, see `stickslip.control.heading_voltages`, from a fifth of `voltage` at -1
    to all at 1; and the voltage of the clamp coil over `voltage`.

    An observation has the columns of `OBSERVED`, or through a camera of `CAMERA_OBSERVED`.

    A robot whose simulation fails, or that leaves its path, ends its episode (terminated), and
    ``info["failure"]`` names the status, or ``left_path``. A robot that follows a path has its
    ``progress``, and its distance to the left of it, ``across``, in `info`, m.

    The same seed gives the same bits for any number of threads. Copies are independent and go on
    with the same bits.

    Parameters
    ----------
    num_envs : int
    task : {"walk", "reach", "place", "follow"}
        See `stickslip.control.tasks.TASKS`.
    scenario : Scenario, optional
        The robot; its drive is not played.
    uncertain : JointPrior, mapping of str to Prior, or Scenario, optional
        The parameters drawn for each episode, see ``Scenario.with_uncertain``; by default those of
        `scenario`. An empty mapping draws none.
    camera : Camera, optional
    coils : sequence of str, optional
        Coils whose voltages the actions are: by default xp and the clamp in "walk" and "place". In
        "reach" and "follow" the clamp and another one are needed; actions that make the field jump
        end an episode by ``turns_too_fast``.
    path : array_like of shape (k, 2), optional
        Corners x and y of what is to be followed, m; by default a figure of eight of 4 mm.
    goal : array_like of shape (2,), optional
        Of "reach" and "place", x and y, m; by default drawn for each episode.
    voltage, turning, period : float
        V and rad/s of an action of one; s of a step.
    threads : int
    autoreset_mode : AutoresetMode
    max_episode_steps : int, optional
        After which an episode is truncated.

    Attributes
    ----------
    states : numpy.ndarray, shape (num_envs, 28)
        The robots now, with the columns of ``STATE_COLUMNS``.
    robots : list of Scenario
        The robots as they were drawn.

    Raises
    ------
    ScenarioError
        If a parameter is not allowed, a path or goal lies where no field is known, a path begins
        more than 0.25 mm from a robot, or actions are not finite numbers of the right shape.
    """

    def __init__(
        self, num_envs: int = 1, task: str = "walk", scenario: Scenario | None = None,
        uncertain: JointPrior | Mapping[str, Prior] | Scenario | None = None,
        camera: Camera | None = None, coils: Sequence[str] | None = None,
        path: ArrayLike | None = None, goal: ArrayLike | None = None, voltage: float = 26.0,
        turning: float = 50.0, period: float = 1e-3, threads: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
    ) -> None:  # fmt: skip
        check_whole("num_envs", num_envs, 1)
        if max_episode_steps is not None:
            check_whole("max_episode_steps", max_episode_steps, 1)
        check_above_zero("voltage", voltage, "V")
        check_above_zero("turning", turning, "rad/s")
        check_above_zero("period", period, "s")
        for name, value, kind in (("scenario", scenario, Scenario), ("camera", camera, Camera)):
            if value is not None:
                check_kind(name, value, kind)
        if not isinstance(task, str) or task not in TASKS:
            raise ScenarioError(f"task = {shown(task)}: {suggestion(str(task), TASKS)}")
        self._steered = TASKS[task].steered
        if coils is None and not self._steered:
            coils = ("xp", "clamp")
        self._coils = None if coils is None else coil_places(coils)
        if self._steered and coils is not None and ("clamp" not in coils or len(coils) < 2):
            refuse("coils", coils, '"clamp" and one or more of the others, or it does not walk')
        given = scenario or Scenario()
        given = given if uncertain is None else given.with_uncertain(uncertain or None)
        self.scenario, self.uncertain = given.with_uncertain(None), given.uncertain
        self.num_envs, self.task, self.camera = num_envs, task, camera
        self.voltage, self.turning, self.period = voltage, turning, period
        self.max_episode_steps, self._threads = max_episode_steps, worker_count(threads, "threads")
        self.metadata = {"autoreset_mode": AutoresetMode(autoreset_mode)}
        self._units = np.array([*(OBSERVED if camera is None else CAMERA_OBSERVED).values()])
        box, batched = gymnasium.spaces.Box, gymnasium.vector.utils.batch_space
        values = 3 if self._coils is None else len(self._coils)
        self.single_observation_space = box(-_FARTHEST, _FARTHEST, self._units.shape, np.float64)
        self.single_action_space = box(-1.0, 1.0, (values,), np.float32)
        self.observation_space = batched(self.single_observation_space, num_envs)
        self.action_space = batched(self.single_action_space, num_envs)
        self._targets = Targets(task, num_envs, self.scenario, path, goal)
        self.robots = [self.scenario] * num_envs
        self.states = np.zeros((num_envs, len(STATE_COLUMNS)))
        self._batch = _core.SimulatorBatch([self.scenario.to_core()] * num_envs, self._steered)
        self._random = [np.random.default_rng() for _ in range(num_envs)]
        self._films: dict[int, Film] = {}
        self._heading = np.zeros(num_envs)  # of the field along the surface, rad
        self._steps = np.zeros(num_envs, dtype=np.int64)
        self._over = np.zeros(num_envs, dtype=bool)  # the episode, and not begun anew

    __copy__ = deepcopy

    def __getstate__(self) -> dict[str, Any]:
        snapshots = [self._batch.snapshot(i) for i in range(self.num_envs)]
        return {**self.__dict__, "_batch": snapshots}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        robots = [robot.to_core() for robot in self.robots]
        self._batch = _core.SimulatorBatch(robots, self._steered)
        for i, snapshot in enumerate(state["_batch"]):
            self._batch.restore(i, snapshot)

    def reset(
        self, *, seed: _Seeds = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin all episodes anew, or those of ``options["reset_mask"]``."""
        given = (options or {}).get("reset_mask", [True] * self.num_envs)
        mask = np.asarray(given)
        if mask.dtype != bool or mask.shape != (self.num_envs,) or np.ma.is_masked(given):
            refuse("reset_mask", given, f"{self.num_envs} booleans, one for each robot")
        for i, one in enumerate(_seeds(seed, self.num_envs)):
            if mask[i] and one is not None:
                self._random[i] = np.random.default_rng(one)
        self._begin(mask)
        return self._observed(np.arange(self.num_envs)), {}

    def _begin(self, mask: Mask) -> None:
        robots = np.flatnonzero(mask).tolist()
        for i in robots:
            if self.uncertain is not None:
                self.robots[i] = self.scenario.drawn(self.uncertain, self._random[i])[0]
            self._batch.reset(i, self.robots[i].to_core())
        self._batch.states(self.states)
        for i in robots:
            x, y, _, self._heading[i] = pose = self.states[i, _POSE]
            self._targets.begin(i, complex(x, y), self._random[i])
            if self.camera is not None:
                self._films[i] = Film(self.camera, self.period, pose)
        self._steps[mask], self._over[mask] = 0, False

    def step(self, actions: Array) -> tuple[Array, Array, Mask, Mask, dict[str, Any]]:
        """Play one period of all robots; see `gymnasium.vector.VectorEnv.step`."""
        played = _checked("actions", actions, self.action_space)
        mode, begun = self.metadata["autoreset_mode"], self._over.copy()
        if mode == AutoresetMode.DISABLED and begun.any():
            raise ValueError(
                "an episode is over: call reset, with options={'reset_mask': mask} for some of many"
            )
        self._batch.step(self._voltages(played), self.period, False, self._threads)
        self._batch.states(self.states)
        words = np.array([*_core.statuses])[self._batch.statuses()]
        self._steps += 1
        if begun.any():
            self._begin(begun)
        rests = np.isin(self.states[:, _CONTACT], _RESTS)
        gains, reached, lost, figures = self._targets.judge(_places(self.states[:, _POSE]), rests)
        reached &= ~begun
        words[lost & (words == "ok")] = "left_path"
        failed = (words != "ok") & ~begun
        terminations = failed | reached
        late = self._steps >= (self.max_episode_steps or np.inf)
        truncations = late & ~begun & ~terminations
        info: dict[str, Any] = {"success": reached, **figures}
        info |= {f"_{name}": ~begun for name in info}
        if failed.any():
            info |= {"failure": np.where(failed, words, ""), "_failure": failed}
        self._over = terminations | truncations
        observations = self._observed(np.arange(self.num_envs))
        if mode == AutoresetMode.SAME_STEP and self._over.any():
            info = self._begin_over(observations, info)
        return observations, gains + reached, terminations, truncations, info

    def _begin_over(self, observations: Array, info: dict[str, Any]) -> dict[str, Any]:
        """Begin what is over within its last step; the info with the last observations."""
        ended = self._over.copy()
        finals = np.full(self.num_envs, None, dtype=object)
        for i in np.flatnonzero(ended):
            finals[i] = observations[i].copy()
        # Those that go on keep their entries, as in gymnasium's own vector environments.
        going = {key: value & ~ended if key[0] == "_" else value for key, value in info.items()}
        self._begin(ended)
        observations[ended] = self._observed(np.flatnonzero(ended))
        finished = {"final_obs": finals, "final_info": info}
        return {**going, **finished, **{f"_{name}": ended for name in finished}}

    def _voltages(self, actions: Array) -> Array:
        """Voltages of the five coils, (n, 5), V."""
        actions = np.clip(actions, -1.0, 1.0)
        if self._coils is not None:
            voltages = np.zeros((self.num_envs, len(COIL_NAMES)))
            voltages[:, self._coils] = self.voltage * actions
            return voltages
        self._heading += self.turning * self.period * actions[:, 0]
        along = self.voltage * (_LEAST + (1.0 - _LEAST) * 0.5 * (1.0 + actions[:, 1]))
        return heading_voltages(self._heading, along, self.voltage * actions[:, 2])

    def _observed(self, robots: Indices) -> Array:
        """Observations of some robots; a camera's are to be asked for once a step."""
        states = self.states[robots]
        poses, seen = states[:, _POSE], states[:, _STATE]
        if self.camera is not None:
            frames = [
                self._films[i].watch(self._steps[i] * self.period, pose, self._random[i])
                for i, pose in zip(robots.tolist(), poses, strict=True)
            ]
            poses = np.array([pose for pose, _ in frames])
            seen = np.column_stack([poses[:, :3], [age for _, age in frames]])
        offsets = self._targets.offsets(robots, _places(poses), exact=self.camera is None)
        facing = np.exp(1j * poses[:, 3])
        goals = offsets * facing.conj()
        columns = [goals.real, goals.imag, facing.real, facing.imag, seen]
        return np.asarray(np.column_stack(columns) / self._units)


class RobotEnv(gymnasium.Env[Array, Array]):
    """Step one robot, by the parameters of `RobotVectorEnv`; `vector` is that of it alone."""

    __copy__ = deepcopy

    def __init__(self, **options: Any) -> None:
        self.vector = RobotVectorEnv(1, autoreset_mode=AutoresetMode.DISABLED, **options)
        self.observation_space = self.vector.single_observation_space
        self.action_space = self.vector.single_action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode; `seed` draws its goal, its uncertain values and its noise."""
        seed, *_ = _seeds(seed, 1)
        super().reset(seed=seed)
        return self.vector.reset(seed=seed)[0][0], {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Play one period."""
        played = _checked("action", action, self.action_space)
        observations, rewards, terminated, truncated, info = self.vector.step(played[None])
        only = {key: value[0] for key, value in info.items() if not key.startswith("_")}
        ends = bool(terminated[0]), bool(truncated[0])
        return observations[0], float(rewards[0]), *ends, only


def _places(poses: Array) -> Places:
    return np.asarray(poses[:, 0] + 1j * poses[:, 1])


def _seeds(seed: object, count: int) -> list[int | None]:
    """The seed of each robot; of one number it and those that follow."""
    given = np.asarray(seed, dtype=object)
    seeds: list[Any] = given.tolist() if given.ndim else [seed] * count
    for number in seeds:
        if number is not None:
            check_whole("seed", number)
    if len(seeds) != count:
        raise ScenarioError(f"seed has {len(seeds)} entries: allowed are {count}")
    one = given.ndim == 0 and seed is not None
    return [int(first) + i for i, first in enumerate(seeds)] if one else seeds


def _checked(name: str, actions: object, space: gymnasium.Space[Array]) -> Array:
    """Actions of the shape of a space, as numbers; else refuse them."""
    allowed = f"shape {space.shape} of finite numbers, which are clipped to -1 to 1"
    given = numbers(name, actions, allowed)
    if given.shape != space.shape:
        raise ScenarioError(f"{name} of shape {given.shape}: allowed is {allowed}")
    return given


for _name, _task in TASKS.items():
    gymnasium.register(
        id=f"stickslip/{_name.capitalize()}-v0",
        entry_point=f"{__name__}:RobotEnv",
        vector_entry_point=f"{__name__}:RobotVectorEnv",
        max_episode_steps=_task.steps,
        kwargs={"task": _name},
    )
