"""Gymnasium environments of one robot and of many; importing this module registers them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.arrays import Array
from stickslip._util.missing_extra import naming_the_extra
from stickslip.scenario.keys import check_kind

with naming_the_extra("stickslip.control.environments"):
    import gymnasium
    from gymnasium.vector import AutoresetMode

from stickslip import _core
from stickslip._util.processor_count import worker_count
from stickslip.control.camera import Camera, Film
from stickslip.control.tasks import task_named
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import check_whole, meant
from stickslip.scenario.priors import Prior
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import COIL_NAMES
from stickslip.scenario.state import STATE_COLUMNS
from stickslip.scenario.uncertain import JointPrior

OBSERVED = ("to goal", "x", "z", "theta", "vx", "vz", "omega", "current_xp", "current_clamp")
"""Columns of an observation without a camera; with one: to goal, x, theta, age of the frame."""

UNITS = (1e-3, 1e-3, 1e-4, 1.0, 1e-2, 1e-2, 100.0, 1.0, 1.0)
"""What one stands for in each column of `OBSERVED`, in SI units: about the size of a walk's."""

CAMERA_UNITS = (1e-3, 1e-3, 1.0, 0.1)
"""The same with a camera; the age is in tenths of a second."""

_FARTHEST = 1e6  # chosen: finite, as libraries want it, and beyond all that moves
_X, _THETA, _CONTACT = (STATE_COLUMNS.index(name) for name in ("x", "theta", "contact"))
_STATE = [STATE_COLUMNS.index(name) for name in OBSERVED[1:]]


class RobotVectorEnv(gymnasium.vector.VectorEnv[Array, Array, Any]):
    """Robots that are stepped together in the core.

    An action is the voltage of each coil in `coils` over `voltage`, -1 to 1, held for `period`; an
    observation has the columns `OBSERVED` in the units `UNITS`. A robot whose simulation fails ends
    its episode (terminated), and ``info["failure"]`` names the status. The same seed gives the same
    bits for any number of threads.

    Parameters
    ----------
    num_envs : int
    task : {"walk", "reach", "place"}
        See `stickslip.control.tasks.TASKS`.
    scenario : Scenario, optional
        The robot; its drive is not played, see `stickslip.Simulator`.
    uncertain : JointPrior, mapping of str to Prior, or Scenario, optional
        What is drawn anew for each episode, as `Measurement.uncertain` or a scenario has it, see
        ``Scenario.with_uncertain``; an empty mapping is nothing. If it is not given, what is
        uncertain in `scenario`.
    camera : Camera, optional
        What the robots are seen through.
    coils : sequence of str
        Coils that the actions drive.
    voltage : float
        V, at an action of one.
    period : float
        Of a step, s.
    threads : int
    autoreset_mode : AutoresetMode
    max_episode_steps : int, optional
        After which an episode is truncated.
    """

    def __init__(
        self,
        num_envs: int = 1,
        task: str = "walk",
        scenario: Scenario | None = None,
        uncertain: JointPrior | Mapping[str, Prior] | Scenario | None = None,
        camera: Camera | None = None,
        coils: Sequence[str] = ("xp", "clamp"),
        voltage: float = 26.0,
        period: float = 1e-3,
        threads: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
        render_mode: None = None,
    ) -> None:
        check_whole("num_envs", num_envs, 1)
        for name, value, kind in (("scenario", scenario, Scenario), ("camera", camera, Camera)):
            if value is not None:
                check_kind(name, value, kind)
        self.num_envs = num_envs
        self.task = task_named(task)
        given = scenario or Scenario()
        given = given if uncertain is None else given.with_uncertain(uncertain or None)
        self.scenario, self.uncertain = given.with_uncertain(None), given.uncertain
        self.camera = camera
        self.voltage, self.period = voltage, period
        self.max_episode_steps = max_episode_steps
        self.render_mode = render_mode
        self._threads = worker_count(threads, "threads")
        unknown = [coil for coil in coils if coil not in COIL_NAMES]
        if unknown or not coils:
            hint = meant(unknown[0], COIL_NAMES) if unknown else ""
            allowed = f"allowed are some of {list(COIL_NAMES)}{hint}"
            raise ScenarioError(f"coils = {list(coils)}: {allowed}")
        self._coils = [COIL_NAMES.index(coil) for coil in coils]
        mode = AutoresetMode(autoreset_mode)
        self.metadata = {"autoreset_mode": mode, "render_modes": []}
        units = UNITS if camera is None else CAMERA_UNITS
        self._units = np.array(units)
        box = gymnasium.spaces.Box
        self.single_observation_space = box(-_FARTHEST, _FARTHEST, (len(units),), np.float64)
        self.single_action_space = box(-1.0, 1.0, (len(coils),), np.float32)
        batched = gymnasium.vector.utils.batch_space
        self.observation_space = batched(self.single_observation_space, num_envs)
        self.action_space = batched(self.single_action_space, num_envs)
        self._random = [np.random.default_rng() for _ in range(num_envs)]
        self._batch = _core.SimulatorBatch([self.scenario.to_core()] * num_envs)
        self._states = np.zeros((num_envs, len(STATE_COLUMNS)))
        self._goals, self._steps = np.zeros(num_envs), np.zeros(num_envs, dtype=np.int64)
        self._films: list[Film] = []
        self._over = np.zeros(num_envs, dtype=bool)  # the episode, and not begun anew

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

    def _begin(self, mask: NDArray[np.bool_]) -> None:
        for i in np.flatnonzero(mask):
            self._batch.reset(int(i), self._drawn(self._random[i]).to_core())
            self._goals[i] = self.task.draw_goal(self._random[i])
        self._steps[mask], self._over[mask] = 0, False
        self._batch.states(self._states)
        self._goals[mask] += self._states[mask, _X] if self.task.farthest else 0.0
        if self.camera is not None:
            poses = self._states[:, [_X, _THETA]]
            self._films = self._films or [Film(self.camera, self.period, each) for each in poses]
            for i in np.flatnonzero(mask):
                self._films[i] = Film(self.camera, self.period, poses[i])

    def _drawn(self, random: np.random.Generator) -> Scenario:
        """The scenario with new values of what is uncertain."""
        return self.uncertain.draw(self.scenario, random) if self.uncertain else self.scenario

    def step(
        self, actions: Array
    ) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Play one period of all robots; see `gymnasium.vector.VectorEnv.step`."""
        mode, mask = self.metadata["autoreset_mode"], self._over.copy()
        if mode == AutoresetMode.DISABLED and mask.any():
            raise ValueError("an episode is over: reset it by options={'reset_mask': mask}")
        voltages = np.zeros((self.num_envs, len(COIL_NAMES)))
        voltages[:, self._coils] = self.voltage * np.clip(np.asarray(actions, dtype=float), -1, 1)
        before = self._states[:, _X].copy()
        voltages[mask] = 0.0  # what is over is begun anew below, whatever it does now
        self._batch.step(voltages, self.period, False, self._threads)
        self._batch.states(self._states)
        status = self._batch.statuses()
        self._steps += 1
        if mask.any():
            self._begin(mask)
        x = self._states[:, _X]
        reached = self.task.reached(x, self._goals, self._states[:, _CONTACT])
        rewards = np.where(mask, 0.0, self.task.reward(before, x, self._goals, reached))
        failed = (status != 0) & ~mask
        terminations = (failed | reached) & ~mask
        truncations = np.zeros(self.num_envs, dtype=bool)
        if self.max_episode_steps is not None:
            truncations = (self._steps >= self.max_episode_steps) & ~mask & ~terminations
        info: dict[str, Any] = {"success": reached & ~mask, "_success": ~mask}
        if failed.any():
            words = [_core.status_names[each] for each in status]
            info |= {"failure": np.where(failed, words, ""), "_failure": failed}
        self._over = terminations | truncations
        observations = self._observed()
        if mode == AutoresetMode.SAME_STEP and self._over.any():
            ended = self._over.copy()
            finals = np.full(self.num_envs, None, dtype=object)
            for i in np.flatnonzero(ended):
                finals[i] = observations[i].copy()
            info = {"final_obs": finals, "_final_obs": ended, "final_info": info}
            self._begin(ended)
            observations[ended] = self._observed(np.flatnonzero(ended))
        return observations, rewards, terminations, truncations, info

    def _observed(self, rows: NDArray[np.int64] | None = None) -> Array:
        """Observations of some robots, or all; a camera's are to be asked for once a step."""
        rows = np.arange(self.num_envs) if rows is None else rows
        states, goals = self._states[rows], self._goals[rows]
        if self.camera is None:
            values = np.column_stack([goals - states[:, _X], states[:, _STATE]])
            if not self.task.farthest:
                values[:, 0] = 0.0
            return np.asarray(values / self._units)
        values = np.zeros((len(rows), len(CAMERA_UNITS)))
        for k, i in enumerate(rows):
            time = float(self._steps[i]) * self.period
            pose, age = self._films[i].watch(time, states[k, [_X, _THETA]], self._random[i])
            to_goal = goals[k] - pose[0] if self.task.farthest else 0.0
            values[k] = to_goal, *pose, age
        return np.asarray(values / self._units)


class RobotEnv(gymnasium.Env[Array, Array]):
    """One robot; parameters are those of `RobotVectorEnv` without `num_envs`."""

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
        many = self._many.step(np.asarray(action)[None])
        observations, rewards, terminations, truncations, info = many
        own = {key: value[0] for key, value in info.items() if not key.startswith("_")}
        return (
            observations[0],
            float(rewards[0]),
            bool(terminations[0]),
            bool(truncations[0]),
            own,
        )


for _name in ("Walk", "Reach", "Place"):
    gymnasium.register(
        id=f"stickslip/{_name}-v0",
        entry_point=f"{__name__}:RobotEnv",
        vector_entry_point=f"{__name__}:RobotVectorEnv",
        max_episode_steps=1000,
        kwargs={"task": _name.lower()},
    )
