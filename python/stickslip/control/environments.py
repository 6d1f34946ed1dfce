"""Gymnasium environments of one robot and of many; importing this module registers them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._util.extras import naming_the_extra
from stickslip._util.numbers import Array

with naming_the_extra("stickslip.control.environments"):
    import gymnasium
    from gymnasium.vector import AutoresetMode

from stickslip import _core
from stickslip._util.numbers import worker_count
from stickslip.control.camera import Camera
from stickslip.control.checks import (
    check_above_zero,
    check_within_coils,
    checked_actions,
    coils_named,
    numbers_of,
)
from stickslip.control.observations import PLACE, Observer, columns_of
from stickslip.control.path import Path
from stickslip.control.steering import heading_voltages
from stickslip.control.tasks import PathTargets, PointTargets, Targets, task_named
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import check_kind, check_whole
from stickslip.scenario.priors import Prior
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import COIL_NAMES
from stickslip.scenario.state import CONTACT_WORDS, STATE_COLUMNS
from stickslip.scenario.uncertain import JointPrior

_FARTHEST = 1e6  # chosen: finite, as libraries want it, and beyond all that moves
# Part of the voltage that the field along the surface always has. Chosen: of 26 V it makes 0.5 mT,
# ten times the field below which friction may hold the heading.
_LEAST = 0.2
_CONTACT, _HEADING = columns_of(["contact", "heading"])
_RESTS = [CONTACT_WORDS.index(name) for name in ("corner_stick", "face_stick")]


class RobotVectorEnv(gymnasium.vector.VectorEnv[Array, Array, Any]):
    """Robots that are stepped together in the core.

    An action has values from -1 to 1, to which values beyond are clipped, and holds for `period`.
    Where a robot stays in its plane, they
    are the voltages of `coils` over `voltage`. Where it is steered, in "reach" and "follow", they
    are how fast the field along the surface turns to the left, over `turning`; the voltage that
    makes this field, from a fifth of `voltage` at -1, which keeps the heading of the default robot
    if `voltage` is near 26 V, to `voltage` at 1, see `stickslip.control.heading_voltages`; and the
    voltage of the clamp coil over `voltage`. The field begins at the robot's heading.

    An observation has the columns `stickslip.control.observations.OBSERVED` where a robot stays in
    its plane, else `stickslip.control.observations.OBSERVED_IN_PLANE`; through a camera
    `stickslip.control.observations.CAMERA_OBSERVED` or
    `stickslip.control.observations.CAMERA_OBSERVED_IN_PLANE`. Each is divided by its unit there.

    A robot whose simulation fails ends its episode (terminated), and ``info["failure"]`` names the
    status, among them ``heading_lost`` and ``turns_too_fast``; where a robot has left its path, it
    is ``left_path``. A robot that follows a path has its ``progress`` and its distance to the left
    of the path, ``across``, in `info`, m.

    Actions of another shape are a ``ScenarioError``, before anything has moved. A robot whose row
    has a value that is not finite fails with the status ``not_finite``, and the others go on.

    The same seed gives the same bits for any number of threads. Copies (`copy`, `pickle`) are
    independent environments that go on with the same bits.

    Parameters
    ----------
    num_envs : int
    task : {"walk", "reach", "place", "follow"}
        See `stickslip.control.tasks.TASKS`.
    scenario : Scenario, optional
        The robot; its drive is not played, see `stickslip.Simulator`.
    uncertain : JointPrior, mapping of str to Prior, or Scenario, optional
        What is drawn anew for each episode, as `Measurement.uncertain` or a scenario has it, see
        ``Scenario.with_uncertain``; an empty mapping is nothing. If it is not given, what is
        uncertain in `scenario`.
    camera : Camera, optional
        What the robots are seen through.
    coils : sequence of str, optional
        Coils whose voltages the actions are; if not given, the xp and the clamp coil of a robot
        that stays in its plane, and one that is steered is driven along a heading. A robot that is
        steered by coils needs the clamp and another one; actions that make the field jump, such as
        random ones, end its episode by ``turns_too_fast``.
    path : Path or array_like of shape (k, 2), optional
        What is to be followed, m, from where the robot begins; if not given, a figure of eight of
        4 mm, `stickslip.control.Path.figure_of_eight`.
    goal : array_like of shape (2,), optional
        What is to be reached by "reach", x and y, m; if not given, it is drawn for each episode,
        0.5 to 2 mm from where the robot begins.
    voltage : float
        V, at an action of one; above 0.
    turning : float
        Rate at which the heading is turned at an action of one, rad/s; above 0.
    period : float
        Of a step, s; above 0.
    threads : int
    autoreset_mode : AutoresetMode
    max_episode_steps : int, optional
        After which an episode is truncated, at least 1; to ``gymnasium.make`` -1 says that none
        is.

    Raises
    ------
    ScenarioError
        If one of these is not what it should be: with its name, its value and what is allowed. Also
        if a path begins, as far as that is known, more than 0.25 mm from the robot, or if a path or
        a goal lies beyond the coils, or outside of the field map.
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
        render_mode: None = None,
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
        self.num_envs = num_envs
        self.task = task_named(task)
        given = scenario or Scenario()
        given = given if uncertain is None else given.with_uncertain(uncertain or None)
        self.scenario, self.uncertain = given.with_uncertain(None), given.uncertain
        self.camera = camera
        self.voltage, self.turning, self.period = voltage, turning, period
        self.max_episode_steps = max_episode_steps
        self.render_mode = render_mode
        self._threads = worker_count(threads, "threads")
        in_plane = self.task.in_plane
        if coils is None and not in_plane:
            coils = ("xp", "clamp")
        self._coils = None if coils is None else coils_named(coils, in_plane)
        self._targets = self._made_targets(path, goal)
        mode = AutoresetMode(autoreset_mode)
        self.metadata = {"autoreset_mode": mode, "render_modes": []}
        self._observer = Observer(camera, in_plane, period, num_envs)
        box, columns = gymnasium.spaces.Box, (len(self._observer.units),)
        self.single_observation_space = box(-_FARTHEST, _FARTHEST, columns, np.float64)
        self.values = 3 if self._coils is None else len(self._coils)
        """How many an action has of one robot."""
        self.single_action_space = box(-1.0, 1.0, (self.values,), np.float32)
        batched = gymnasium.vector.utils.batch_space
        self.observation_space = batched(self.single_observation_space, num_envs)
        self.action_space = batched(self.single_action_space, num_envs)
        self._random = [np.random.default_rng() for _ in range(num_envs)]
        self._robots = [self.scenario] * num_envs  # each with its draw of what is uncertain
        self._batch = _core.SimulatorBatch([self.scenario.to_core()] * num_envs, in_plane)
        self._states = np.zeros((num_envs, len(STATE_COLUMNS)))
        self._heading = np.zeros(num_envs)  # of the field along the surface, rad
        self._steps = np.zeros(num_envs, dtype=np.int64)
        self._over = np.zeros(num_envs, dtype=bool)  # the episode, and not begun anew

    def __copy__(self) -> RobotVectorEnv:
        return deepcopy(self)

    def __getstate__(self) -> dict[str, Any]:
        snapshots = [self._batch.snapshot(i).to_bytes() for i in range(self.num_envs)]
        return {**self.__dict__, "_batch": snapshots}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        robots = [robot.to_core() for robot in self._robots]
        self._batch = _core.SimulatorBatch(robots, self.task.in_plane)
        for i, snapshot in enumerate(state["_batch"]):
            self._batch.restore(i, _core.Snapshot.from_bytes(snapshot))

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Array, dict[str, Any]]:
        """Begin all episodes anew, or those of ``options["reset_mask"]``."""
        mask = (options or {}).get("reset_mask", np.ones(self.num_envs, dtype=bool))
        if seed is None:
            seeds: Sequence[int | None] = [None] * self.num_envs
        elif isinstance(seed, Sequence):
            seeds = seed
            if len(seeds) != self.num_envs:
                raise ScenarioError(f"seed has {len(seeds)} entries: allowed are {self.num_envs}")
        else:
            seeds = [int(seed) + i for i in range(self.num_envs)]
        for i, own in enumerate(seeds):
            if mask[i] and own is not None:
                self._random[i] = np.random.default_rng(own)
        self._begin(mask)
        return self._observed(), {}

    def _made_targets(self, path: Path | ArrayLike | None, goal: ArrayLike | None) -> Targets:
        task = self.task
        if path is not None and not task.look_ahead:
            raise ScenarioError(f'path: the task "{task.name}" follows none')
        if goal is not None:
            if task.name != "reach":
                raise ScenarioError(f'goal: the task "{task.name}" takes none')
            goal = numbers_of("goal", goal, "x and y, m")
            if goal.shape != (2,):
                raise ScenarioError(f"goal of shape {goal.shape}: allowed is (2,), x and y, m")
            check_within_coils("goal", goal[None], self.scenario)
        if not task.look_ahead:
            return PointTargets(task, self.num_envs, goal)
        if path is None:
            path = Path.figure_of_eight()
        way = path if isinstance(path, Path) else Path(path)
        check_within_coils("path", way.points, self.scenario)
        targets = PathTargets(task, self.num_envs, way)
        if self.uncertain is None or not {"initial.x", "initial.y"} & set(self.uncertain.names):
            targets.check_begin(np.array([self.scenario.initial.x, self.scenario.initial.y]))
        return targets

    def _begin(self, mask: NDArray[np.bool_]) -> None:
        robots = np.flatnonzero(mask)
        for i in robots:
            self._robots[i] = self._drawn(self._random[i])
            self._batch.reset(int(i), self._robots[i].to_core())
        self._batch.states(self._states)
        for i in robots:
            self._targets.begin(int(i), self._states[i, PLACE], self._random[i])
            self._observer.begin(int(i), self._states[i])
        self._heading[mask] = self._states[mask, _HEADING]
        self._steps[mask], self._over[mask] = 0, False

    def _drawn(self, random: np.random.Generator) -> Scenario:
        """The scenario with new values of what is uncertain."""
        return self.uncertain.draw(self.scenario, random) if self.uncertain else self.scenario

    def step(
        self, actions: Array
    ) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Play one period of all robots; see `gymnasium.vector.VectorEnv.step`."""
        played = checked_actions("actions", actions, (self.num_envs, self.values))
        mode, mask = self.metadata["autoreset_mode"], self._over.copy()
        if mode == AutoresetMode.DISABLED and mask.any():
            raise ValueError("an episode is over: reset, or options={'reset_mask': mask} of many")
        unknown: NDArray[np.bool_] = np.any(np.isnan(played), axis=1)
        voltages = self._voltages(np.where(unknown[:, None], 0.0, played))
        voltages[unknown] = np.nan  # with which the core lets this robot fail
        voltages[mask] = 0.0  # what is over is begun anew below, whatever it does now
        self._batch.step(voltages, self.period, False, self._threads)
        self._batch.states(self._states)
        status = self._batch.statuses()
        self._steps += 1
        if mask.any():
            self._begin(mask)
        rests = np.isin(self._states[:, _CONTACT], _RESTS)
        judged = self._targets.judge(self._states[:, PLACE], rests)
        rewards = np.where(mask, 0.0, judged.rewards)
        failed = (status != 0) & ~mask
        lost = judged.lost & ~mask & ~failed
        reached = judged.reached & ~mask
        terminations = failed | lost | reached
        truncations = np.zeros(self.num_envs, dtype=bool)
        if self.max_episode_steps is not None:
            truncations = (self._steps >= self.max_episode_steps) & ~mask & ~terminations
        info: dict[str, Any] = {"success": reached, "_success": ~mask}
        for name, values in judged.figures.items():
            info |= {name: values, f"_{name}": ~mask}
        if failed.any() or lost.any():
            names = tuple(_core.statuses)
            words = np.where(failed, [names[each] for each in status], "")
            words = np.where(lost, "left_path", words)
            info |= {"failure": words, "_failure": failed | lost}
        self._over = terminations | truncations
        observations = self._observed()
        if mode == AutoresetMode.SAME_STEP and self._over.any():
            ended = self._over.copy()
            finals = np.full(self.num_envs, None, dtype=object)
            for i in np.flatnonzero(ended):
                finals[i] = observations[i].copy()
            # Those that go on keep their entries, as in gymnasium's own vector environments.
            going = {key: each & ~ended if key[0] == "_" else each for key, each in info.items()}
            info = {**going, "final_obs": finals, "_final_obs": ended, "final_info": info}
            info["_final_info"] = ended
            self._begin(ended)
            observations[ended] = self._observed(np.flatnonzero(ended))
        return observations, rewards, terminations, truncations, info

    def _voltages(self, actions: Array) -> Array:
        """Voltages of the five coils, (n, 5), V."""
        if self._coils is not None:
            voltages = np.zeros((self.num_envs, len(COIL_NAMES)))
            voltages[:, self._coils] = self.voltage * actions
            return voltages
        self._heading += self.turning * self.period * actions[:, 0]
        along = self.voltage * (_LEAST + (1.0 - _LEAST) * 0.5 * (1.0 + actions[:, 1]))
        return heading_voltages(self._heading, along, self.voltage * actions[:, 2])

    def _observed(self, rows: NDArray[np.int64] | None = None) -> Array:
        """Observations of some robots, or all; a camera's are to be asked for once a step."""
        robots = np.arange(self.num_envs) if rows is None else rows
        times = np.asarray(self._steps[robots] * self.period, dtype=float)
        states = self._states[robots]
        return self._observer.observed(robots, states, times, self._targets, self._random)


class RobotEnv(gymnasium.Env[Array, Array]):
    """One robot; parameters are those of `RobotVectorEnv` without `num_envs`.

    An action that is not finite is a ``ScenarioError``.
    """

    def __copy__(self) -> RobotEnv:
        return deepcopy(self)

    def __init__(self, render_mode: None = None, **options: Any) -> None:
        self.render_mode = render_mode
        self.metadata = {"render_modes": []}
        self._many = RobotVectorEnv(1, autoreset_mode=AutoresetMode.DISABLED, **options)
        self.observation_space = self._many.single_observation_space
        self.action_space = self._many.single_action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode; `seed` draws its goal, its uncertain values and its noise."""
        super().reset(seed=seed)
        observations, _ = self._many.reset(seed=seed)
        return observations[0], {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Play one period."""
        played = checked_actions("action", action, (self._many.values,))
        many = self._many.step(played[None])
        observations, rewards, terminations, truncations, info = many
        own = {key: value[0] for key, value in info.items() if not key.startswith("_")}
        return (
            observations[0],
            float(rewards[0]),
            bool(terminations[0]),
            bool(truncations[0]),
            own,
        )


# Steps of 1 ms: about twice what a robot of some 2 mm/s needs.
for _name, _steps in (("Walk", 1000), ("Reach", 2000), ("Place", 1000), ("Follow", 12_000)):
    gymnasium.register(
        id=f"stickslip/{_name}-v0",
        entry_point=f"{__name__}:RobotEnv",
        vector_entry_point=f"{__name__}:RobotVectorEnv",
        max_episode_steps=_steps,
        kwargs={"task": _name.lower()},
    )
