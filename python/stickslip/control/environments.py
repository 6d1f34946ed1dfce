"""Gymnasium environments of one robot and of many; importing this module registers them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.arrays import Array, Indices, Mask, in_columns, numbers, worker_count
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
from stickslip.control.drawing import Pixels, side_view, view_from_above
from stickslip.control.path import COLUMNS, Path
from stickslip.control.steering import check_within_coils, heading_voltages
from stickslip.control.tasks import TASKS, Targets
from stickslip.design.space import coil_places
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import COIL_NAMES
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

RENDERED: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 25}
"""A film of every step shows the motion 40 times slower than it is."""

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
    """Robots that are stepped together in the core.

    An action has values from -1 to 1 (others are clipped), and holds for `period`.
    In "walk" and "place" they are the voltages of `coils` over `voltage`. In "reach" and "follow"
    they are how fast the field along the surface turns to the left, over `turning`; the voltage
    that makes this field, see `stickslip.control.heading_voltages`, from a fifth of `voltage` at -1
    to all at 1; and the voltage of the clamp coil over `voltage`.

    An observation has the columns of `OBSERVED`, or through a camera of `CAMERA_OBSERVED`.

    A robot whose simulation fails, or that leaves its path, ends its episode (terminated), and
    ``info["failure"]`` names the status, or ``left_path``. Actions of another shape, or with a
    number that is not finite, are a ``ScenarioError``. A robot that follows a path has its
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
    path : Path or array_like of shape (k, 2), optional
        What is to be followed, m; by default a figure of eight of 4 mm.
    goal : array_like of shape (2,), optional
        What "reach" is to reach, m; by default drawn for each episode.
    voltage, turning, period : float
        V and rad/s of an action of one; s of a step.
    threads : int
    autoreset_mode : AutoresetMode
    max_episode_steps : int, optional
        After which an episode is truncated.
    render_mode : {"rgb_array"}, optional
        What `render` gives: the robot from its right in "walk" and "place", else from above.

    Raises
    ------
    ScenarioError
        If a parameter is not allowed, a path begins more than 0.25 mm from the robot, or a path or
        goal lies where no field is known.
    """

    def __init__(
        self,
        num_envs: int = 1,
        task: str = "walk",
        scenario: Scenario | None = None,
        uncertain: JointPrior | Mapping[str, Prior] | Scenario | None = None,
        camera: Camera | None = None,
        coils: Sequence[str] | None = None,
        path: Path | ArrayLike | None = None,
        goal: ArrayLike | None = None,
        voltage: float = 26.0,
        turning: float = 50.0,
        period: float = 1e-3,
        threads: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
    ) -> None:
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
        self.num_envs, self.task = num_envs, task
        given = scenario or Scenario()
        given = given if uncertain is None else given.with_uncertain(uncertain or None)
        self.scenario, self.uncertain = given.with_uncertain(None), given.uncertain
        self.camera = camera
        self.voltage, self.turning, self.period = voltage, turning, period
        self.max_episode_steps = max_episode_steps
        self.render_mode = _checked_mode(render_mode)
        self.metadata = {**RENDERED, "autoreset_mode": AutoresetMode(autoreset_mode)}
        self._threads = worker_count(threads, "threads")
        self._steered = TASKS[task].steered
        if coils is None and not self._steered:
            coils = ("xp", "clamp")
        self._coils = None if coils is None else coil_places(coils)
        if self._steered and coils is not None and ("clamp" not in coils or len(coils) < 2):
            refuse("coils", coils, '"clamp" and one or more of the others, or it does not walk')
        self._targets = self._made_targets(path, goal)
        units = OBSERVED if camera is None else CAMERA_OBSERVED
        self._units = np.array(list(units.values()))
        box = gymnasium.spaces.Box
        self.single_observation_space = box(-_FARTHEST, _FARTHEST, (len(units),), np.float64)
        values = 3 if self._coils is None else len(self._coils)
        self.single_action_space = box(-1.0, 1.0, (values,), np.float32)
        batched = gymnasium.vector.utils.batch_space
        self.observation_space = batched(self.single_observation_space, num_envs)
        self.action_space = batched(self.single_action_space, num_envs)
        self._random = [np.random.default_rng() for _ in range(num_envs)]
        self._robots = [self.scenario] * num_envs  # each with its draw
        self._films: list[Film | None] = [None] * num_envs
        self._batch = _core.SimulatorBatch([self.scenario.to_core()] * num_envs, self._steered)
        self._states = np.zeros((num_envs, len(STATE_COLUMNS)))
        self._heading = np.zeros(num_envs)  # of the field along the surface, rad
        self._steps = np.zeros(num_envs, dtype=np.int64)
        self._over = np.zeros(num_envs, dtype=bool)  # the episode, and not begun anew

    def __copy__(self) -> RobotVectorEnv:
        return deepcopy(self)

    def __getstate__(self) -> dict[str, Any]:
        snapshots = [self._batch.snapshot(i) for i in range(self.num_envs)]
        return {**self.__dict__, "_batch": snapshots}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        robots = [robot.to_core() for robot in self._robots]
        self._batch = _core.SimulatorBatch(robots, self._steered)
        for i, snapshot in enumerate(state["_batch"]):
            self._batch.restore(i, snapshot)

    def _made_targets(self, path: Path | ArrayLike | None, goal: ArrayLike | None) -> Targets:
        """Where the robots are to go, once all that is known of it is checked."""
        task, follows = TASKS[self.task], self.task == "follow"
        if path is not None and not follows:
            raise ScenarioError(f'path: the task "{self.task}" follows none')
        if goal is not None and self.task != "reach":
            raise ScenarioError(f'goal: the task "{self.task}" takes none')
        if goal is not None:
            goal = in_columns("goal", goal, COLUMNS, "x and y, m", axes=1, unit="m")
            check_within_coils("goal", goal[None], self.scenario)
        way = Path.figure_of_eight() if follows and path is None else None
        if path is not None:
            way = path if isinstance(path, Path) else Path(path)
        targets = Targets(task, self.num_envs, way, goal)
        if way is not None:
            check_within_coils("path", way.points, self.scenario)
            drawn = set() if self.uncertain is None else set(self.uncertain.names)
            if not drawn & {"initial.x", "initial.y"}:
                targets.check_begin(np.array([self.scenario.initial.x, self.scenario.initial.y]))
        return targets

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | Indices | None = None,
        options: dict[str, Any] | None = None,
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
                self._robots[i] = self.scenario.drawn(self.uncertain, self._random[i])[0]
            self._batch.reset(i, self._robots[i].to_core())
        self._batch.states(self._states)
        for i in robots:
            self._targets.begin(i, self._states[i, _POSE[:2]], self._random[i])
            if self.camera is not None:
                self._films[i] = Film(self.camera, self.period, self._states[i, _POSE])
        self._heading[mask] = self._states[mask, _POSE[3]]
        self._steps[mask], self._over[mask] = 0, False

    def step(self, actions: Array) -> tuple[Array, Array, Mask, Mask, dict[str, Any]]:
        """Play one period of all robots; see `gymnasium.vector.VectorEnv.step`."""
        played = _checked("actions", actions, self.action_space)
        mode, mask = self.metadata["autoreset_mode"], self._over.copy()
        if mode == AutoresetMode.DISABLED and mask.any():
            raise ValueError(
                "an episode is over: call reset, with options={'reset_mask': mask} for some of many"
            )
        self._batch.step(self._voltages(played), self.period, False, self._threads)
        self._batch.states(self._states)
        status = self._batch.statuses()
        self._steps += 1
        if mask.any():
            self._begin(mask)
        rests = np.isin(self._states[:, _CONTACT], _RESTS)
        judged = self._targets.judge(self._states[:, _POSE[:2]], rests)
        rewards = np.where(mask, 0.0, judged.rewards)
        failed, reached = (status != 0) & ~mask, judged.reached & ~mask
        lost = judged.lost & ~mask & ~failed
        terminations = failed | lost | reached
        truncations = np.zeros(self.num_envs, dtype=bool)
        if self.max_episode_steps is not None:
            truncations = (self._steps >= self.max_episode_steps) & ~mask & ~terminations
        info: dict[str, Any] = {"success": reached, **judged.figures}
        info |= {f"_{name}": ~mask for name in info}
        if failed.any() or lost.any():
            words = np.where(failed, np.array(tuple(_core.statuses))[status], "")
            words = np.where(lost, "left_path", words)
            info |= {"failure": words, "_failure": failed | lost}
        self._over = terminations | truncations
        observations = self._observed(np.arange(self.num_envs))
        if mode == AutoresetMode.SAME_STEP and self._over.any():
            ended = self._over.copy()
            finals = np.full(self.num_envs, None, dtype=object)
            for i in np.flatnonzero(ended):
                finals[i] = observations[i].copy()
            # Those that go on keep their entries, as in gymnasium's own vector environments.
            going = {key: value & ~ended if key[0] == "_" else value for key, value in info.items()}
            info = {**going, "final_obs": finals, "_final_obs": ended, "final_info": info}
            info["_final_info"] = ended
            self._begin(ended)
            observations[ended] = self._observed(np.flatnonzero(ended))
        return observations, rewards, terminations, truncations, info

    def render(self) -> tuple[Pixels, ...] | None:
        """A picture of each robot, shape (240, 400, 3); None without a `render_mode`."""
        if self.render_mode is None:
            return None
        goals, path = self._targets.shown
        pictures = []
        for i, (robot, state) in enumerate(zip(self._robots, self._states, strict=True)):
            goal = None if goals is None else goals[i]
            if self._steered:
                pictures.append(view_from_above(robot, state, goal, path))
            else:
                pictures.append(side_view(robot, state, goal))
        return tuple(pictures)

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
        states = self._states[robots]
        if self.camera is None:
            poses, seen = states[:, _POSE], states[:, _STATE]
        else:
            rows = []
            for i, state in zip(robots.tolist(), states, strict=True):
                film = self._films[i]
                assert film is not None  # from the first reset on
                time = float(self._steps[i] * self.period)
                pose, age = film.watch(time, state[_POSE], self._random[i])
                rows.append([*pose, age])
            poses = np.array(rows)[:, :4]
            seen = np.array(rows)[:, [0, 1, 2, 4]]
        offsets = self._targets.offsets(robots, poses[:, :2], exact=self.camera is None)
        cosine, sine = np.cos(poses[:, 3]), np.sin(poses[:, 3])
        ahead = cosine * offsets[:, 0] + sine * offsets[:, 1]
        left = cosine * offsets[:, 1] - sine * offsets[:, 0]
        return np.asarray(np.column_stack([ahead, left, cosine, sine, seen]) / self._units)


class RobotEnv(gymnasium.Env[Array, Array]):
    """One robot; parameters are those of `RobotVectorEnv` without `num_envs`."""

    def __copy__(self) -> RobotEnv:
        return deepcopy(self)

    metadata = RENDERED

    def __init__(self, render_mode: str | None = None, **options: Any) -> None:
        self.render_mode = _checked_mode(render_mode)
        options["render_mode"] = render_mode
        self._many = RobotVectorEnv(1, autoreset_mode=AutoresetMode.DISABLED, **options)
        self.observation_space = self._many.single_observation_space
        self.action_space = self._many.single_action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode; `seed` draws its goal, its uncertain values and its noise."""
        seed, *_ = _seeds(seed, 1)
        super().reset(seed=seed)
        observations, _ = self._many.reset(seed=seed)
        return observations[0], {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Play one period."""
        played = _checked("action", action, self.action_space)
        observations, rewards, terminated, truncated, info = self._many.step(played[None])
        only = {key: value[0] for key, value in info.items() if not key.startswith("_")}
        ends = bool(terminated[0]), bool(truncated[0])
        return observations[0], float(rewards[0]), *ends, only

    def render(self) -> Pixels | None:
        """A picture, shape (240, 400, 3); None without a `render_mode`."""
        pictures = self._many.render()
        return None if pictures is None else pictures[0]


def _checked_mode(render_mode: str | None) -> str | None:
    if render_mode not in (None, *RENDERED["render_modes"]):
        refuse("render_mode", render_mode, '"rgb_array", or None')
    return render_mode


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


# Steps of 1 ms: about twice what a robot of some 2 mm/s needs.
for _name, _most in (("Walk", 1000), ("Reach", 2000), ("Place", 1000), ("Follow", 12_000)):
    gymnasium.register(
        id=f"stickslip/{_name}-v0",
        entry_point=f"{__name__}:RobotEnv",
        vector_entry_point=f"{__name__}:RobotVectorEnv",
        max_episode_steps=_most,
        kwargs={"task": _name.lower()},
    )
