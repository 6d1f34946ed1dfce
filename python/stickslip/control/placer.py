"""Put robots to a place ahead by what a camera shows: walk there, then give single pulses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._util.arrays import Array, Mask, numbers
from stickslip._util.messages import as_list, check_above_zero, check_kind, check_whole
from stickslip.control.camera import Camera, Film
from stickslip.control.steering import check_within_coils, field_voltages, pulse_fields
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import STATE_COLUMNS
from stickslip.simulation.rollout import rollout

# All chosen. Times are steps of a tenth of the drive's period, heights parts of its peak.
_WINDOW = 20  # steps from one decision to the next
_PULSES = (1, 2, 4)  # in a window while it walks
_HEIGHTS = np.linspace(0.2, 0.8, 16)
_SINGLE = np.linspace(0.05, 0.6, 23)  # of a single pulse forward, and back
_STANDS, _RESTS = 150, 200  # steps to stand up, and to come to rest after a pulse
_SLOWEST = 0.05  # part of the greatest speed; slower pulses are none of a walk
_ENOUGH, _SURE, _STILL, _BEHIND = 0.5, 0.3, 0.05, 2.5  # parts of the tolerance
X, THETA = STATE_COLUMNS.index("x"), STATE_COLUMNS.index("theta")


class Placer:
    """Puts robots of a scenario to a place ahead, by the fields and coils of its drive.

    It simulates robots that differ by the scenario's uncertain parameters, and tabulates what
    pulses do. While the goal is far it *walks*: of the pulses that take fewer than 10 % of the
    robots beyond the goal before the next image, by those with which 90 % are fastest. Near the
    goal it *looks* until a mean of images is sure, and gives the single pulse whose step is the
    distance; how far a pulse came scales the next one of this robot. A robot that went too far is
    taken behind the goal first, as steps forward are surer.

    A robot stands at half of ``drive.peak`` and the field ``drive.hold``. A pulse that falls slowly
    and rises suddenly is a step forward, the reverse a step back.

    Parameters
    ----------
    scenario : Scenario
        The robot, its coils, what is uncertain of it, and a drive (IPP, along x) with which it
        walks.
    camera : Camera, optional
        By default one without errors, of 1000 frames a second.
    tolerance : float
        Distance from the goal that is good enough, m.
    draws, seed : int
        How many robots are drawn for the tables, and by which seed.
    threads : int, optional
        How many robots are simulated at a time; as many as there are processors, if not given.

    Attributes
    ----------
    step : float
        Duration of a voltage, s; a decision holds for 20 of them.
    steps : numpy.ndarray
        Median steps of single pulses, ascending, m.
    speeds : numpy.ndarray
        What 90 % of the robots exceed, for each kind of pulse of a walk, m/s.

    Raises
    ------
    ScenarioError
        If such a robot cannot be placed; it says why.
    """

    def __init__(
        self,
        scenario: Scenario,
        *,
        camera: Camera | None = None,
        tolerance: float = 2e-6,
        draws: int = 64,
        seed: int = 0,
        threads: int | None = None,
    ) -> None:
        check_kind("scenario", scenario, Scenario)
        check_above_zero("tolerance", tolerance, "m")
        check_whole("draws", draws, 1)
        self.camera = Camera(frame_rate=1000.0) if camera is None else camera
        check_kind("camera", self.camera, Camera)
        self.scenario, self.tolerance, self._threads = scenario, float(tolerance), threads
        if scenario.whole_plane:
            raise ScenarioError("scenario: allowed is a robot that moves along x, not in the plane")
        self._fields = pulse_fields(scenario)
        self.step = 0.1 / scenario.drive.frequency
        robots = [scenario] if scenario.uncertain is None else scenario.draws(draws, seed)
        standing = self._standing(robots)
        self._tabulate_walks(robots, standing)
        self._tabulate_steps(robots, standing)

    @property
    def period(self) -> float:
        """From one decision to the next, s."""
        return _WINDOW * self.step

    def voltages(self, along: Array) -> Array:
        """Voltages of the five coils, V, shape (..., 5), of parts of the peak, shape (...)."""
        peak, clamp = self._fields
        heading = 0.0 if self.scenario.drive.facing > 0.0 else np.pi
        return field_voltages(self.scenario, heading, peak * along, clamp)

    def put(
        self,
        robots: Sequence[Scenario],
        goal: ArrayLike = 3e-3,
        *,
        seed: int = 0,
        limit: float = 30.0,
    ) -> Placed:
        """Simulate how robots are put to `goal` (m, ahead of the origin) within `limit` (s).

        Parameters
        ----------
        robots : sequence of Scenario
            With the coils and the drive of the placer's scenario; no parameter uncertain.
        goal : float or array_like of shape (n,)
            One for all, or for each.
        seed : int
            Of the camera's noise.

        Raises
        ------
        ScenarioError
            If a goal lies where no field is known, or an argument is not allowed.
        """
        robots = as_list("robots", robots, "a list of Scenarios")
        check_above_zero("limit", limit, "s")
        check_whole("seed", seed)
        placing, time = Placing(self, goal, len(robots)), 0.0
        random, states = np.random.default_rng(seed), self._standing(robots, refuse=False)
        ahead = self.scenario.drive.facing
        film = Film(self.camera, self.step, self._pose(states))
        while np.isnan(placing.done_at).any() and time < limit:
            volts = placing.decide(time, film.pose[:, 0], film.taken)
            played = self._play(robots, states, volts)
            states = played[:, -1]
            for now in played.swapaxes(0, 1):
                time += self.step
                film.watch(time, self._pose(now), random)
        rest = self.voltages(np.full((len(robots), _RESTS), 0.5))
        error = ahead * self._play(robots, states, rest)[:, -1, X] - placing.goal
        return Placed(placing.done_at, error, placing.pulses)

    def _pose(self, states: Array) -> Array:
        """What a camera sees: the way ahead, and the pitch."""
        return np.stack([self.scenario.drive.facing * states[:, X], states[:, THETA]], axis=-1)

    def _play(self, robots: Sequence[Scenario], states: Array | None, volts: Array) -> Array:
        record, threads = STATE_COLUMNS, self._threads
        result = rollout(
            robots, states, volts, self.step, hold="linear", record=record, threads=threads
        )
        return np.asarray(result.states)

    def _ways(self, robots: Sequence[Scenario], states: Array, along: Array) -> Array:
        """Ways ahead after each step, (n, steps), m, from `states` with parts of the peak."""
        volts = np.broadcast_to(self.voltages(along), (len(robots), len(along), 5))
        x = self._play(robots, states, volts)[:, :, X] - states[:, None, X]
        if np.isnan(x).any():
            lost = int(np.isnan(x).any(axis=1).sum())
            _refuse(f"{lost} of {len(robots)} robots cannot be simulated under its pulses")
        return self.scenario.drive.facing * x

    def _standing(self, robots: Sequence[Scenario], refuse: bool = True) -> Array:
        """States of robots that have stood up."""
        volts = self.voltages(np.full((len(robots), _STANDS), 0.5))
        played = self._play(robots, None, volts)
        drift = np.abs(played[:, -1, X] - played[:, -1 - _WINDOW, X]).max()
        if refuse and not drift <= self.tolerance:
            pairs = 'drive.coils = "pairs", ' if self.scenario.drive.coils == "single" else ""
            _refuse(
                f"where it stands with half of drive.peak it slides by {1e6 * drift:.3g} um in "
                f"{1e3 * self.period:.3g} ms; give {pairs}a lower field or a pitch that is less"
            )
        return np.asarray(played[:, -1])

    def _tabulate_walks(self, robots: Sequence[Scenario], standing: Array) -> None:
        kinds = [
            np.tile(_tooth(height, _WINDOW // count), count)
            for count in _PULSES
            for height in _HEIGHTS
        ]
        speeds, coasts = [], []
        for kind in kinds:
            along = np.append(np.tile(kind, 10), np.full(_RESTS, 0.5))
            way = self._ways(robots, standing, along)
            before, end = way[:, 4 * _WINDOW - 1], way[:, 10 * _WINDOW - 1]
            speeds.append((end - before) / (6 * self.period))
            coasts.append(way[:, -1] - end)
        low, median, high = np.quantile(speeds, [0.1, 0.5, 0.9], axis=1)
        if not low.max() * self.period > self.tolerance:
            _refuse(
                "by no pulses do nine of ten robots walk ahead: with the best ones they make "
                f"{1e3 * low.max():.2g} mm/s; change the drive until `stickslip run` walks"
            )
        walks = low > _SLOWEST * low.max()
        self._kinds, self.speeds = np.array(kinds)[walks], low[walks]
        self._median, self._high = median[walks], high[walks]
        self._coast = np.median(coasts, axis=1)[walks]
        self._slowest = int(np.argmin(self._high))

    def _tabulate_steps(self, robots: Sequence[Scenario], standing: Array) -> None:
        heights, steps, moving = [0.0], [0.0], 0
        for signed in (-_SINGLE, _SINGLE):
            for height in signed:
                along = np.append(_tooth(height, _WINDOW), np.full(_RESTS, 0.5))
                way = self._ways(robots, standing, along)
                step = float(np.median(way[:, -1]))
                far = np.abs(way - way[:, -1:]) > _STILL * self.tolerance
                moving = max(moving, int(np.max(far * np.arange(way.shape[1]))))
                # One that is as long as a weaker one is not needed.
                longer = np.sign(height) * (step - (max if height > 0.0 else min)(steps))
                if longer > _STILL * self.tolerance:
                    heights.append(float(height))
                    steps.append(step)
        if moving >= _WINDOW + _RESTS - 2:
            _refuse(f"it does not come to rest within {1e3 * _RESTS * self.step:.3g} ms of a pulse")
        order = np.argsort(steps)
        self._singles, self.steps = np.array(heights)[order], np.array(steps)[order]
        for way, name in ((self.steps, "ahead"), (-self.steps, "back")):
            least = np.min(way, where=way > 0.0, initial=np.inf)
            if least > 2.0 * self.tolerance:
                text = f"the shortest step {name} is {1e6 * least:.3g} um"
                text = text if np.isfinite(least) else f"no single pulse takes it {name}"
                _refuse(f"{text}, for a tolerance of {1e6 * self.tolerance:.3g} um")
        self._settle = max(moving - _WINDOW, 0) * self.step


class Placing:
    """Robots on their way to a goal, seen by a camera; see `Placer.put` for a simulated one.

    Attributes
    ----------
    goal : numpy.ndarray, shape () or (n,)
        m.
    done_at : numpy.ndarray, shape (n,)
        When each was seen to be there, s; NaN before.
    pulses : numpy.ndarray, shape (n,)
        Single pulses that each had.
    """

    def __init__(self, placer: Placer, goal: ArrayLike, count: int) -> None:
        self._placer, self.goal = placer, numbers("goal", goal, "finite numbers of m", unit="m")
        if self.goal.shape not in ((), (count,)):
            allowed = f"one for all, or one for each of {count}"
            raise ScenarioError(f"goal of shape {self.goal.shape}: allowed is {allowed}")
        x = np.atleast_1d(placer.scenario.drive.facing * self.goal)
        check_within_coils("goal", np.stack([x, np.zeros_like(x)], axis=-1), placer.scenario)
        self._sum, self._images = np.zeros(count), np.zeros(count)
        self._before, self._scale = np.zeros(count), np.ones(count)
        self._way = [np.zeros(count)]  # after each step, by the table
        self._walks, self._still_from = np.ones(count, dtype=bool), np.zeros(count)
        self._last = 0.0
        self.done_at = np.full(count, np.nan)
        self.pulses = np.zeros(count, dtype=np.int64)

    def decide(self, time: float, seen: Array, taken: float) -> Array:
        """Voltages of the next 20 steps, V, shape (n, 20, 5).

        Parameters
        ----------
        time : float
            Since the robots stood up, s.
        seen : array, shape (n,)
            The newest image: the way of each from the origin, m, along its heading.
        taken : float
            When that was taken, s.
        """
        placer, seen = self._placer, numbers("seen", seen, unit="m", gaps=True)
        along, onward = np.full((len(seen), _WINDOW), 0.5), np.zeros(len(seen))
        # Where a robot is now: the newest image, and the way since then by the table.
        ways = self._way[-1] - self._way[round(taken / placer.step)]
        distance = self.goal - seen - ways
        slow = placer._slowest
        near = placer.steps[-1] + placer._coast[slow]
        self._walks &= distance > near
        choice = self._choose(distance[self._walks])
        along[self._walks] = placer._kinds[choice]
        onward[self._walks] = placer.step * placer._median[choice]
        rest = time + placer.period + placer._settle
        self._still_from[self._walks] = rest
        stands = ~self._walks & np.isnan(self.done_at) & np.isfinite(seen)
        looks = stands & (taken > self._last) & (taken >= self._still_from)
        there, pushed, wanted = self._look(looks, seen)
        for robot, way in zip(np.flatnonzero(pushed), wanted, strict=True):
            height = np.interp(way, placer.steps, placer._singles)
            along[robot] = _tooth(float(height), _WINDOW)
        self._still_from[pushed] = rest
        self.done_at[there], self._last = time, taken
        self._way += [self._way[-1] + (k + 1) * onward for k in range(_WINDOW)]
        return placer.voltages(along)

    def _choose(self, distance: Array) -> NDArray[np.intp]:
        """Of pulses that take almost no robot beyond the goal soon, the surely fastest."""
        placer, camera = self._placer, self._placer.camera
        horizon = camera.latency + camera.exposure + 1.0 / camera.frame_rate + placer.period
        allowed = placer._high * horizon + placer._coast <= distance[:, None]
        allowed[:, placer._slowest] = True
        best: NDArray[np.intp] = np.argmax(np.where(allowed, placer.speeds, -np.inf), axis=1)
        return best

    def _look(self, looks: Mask, seen: Array) -> tuple[Mask, Mask, Array]:
        """Who is there, who is pushed, and how far, by a new image of those that rest."""
        placer = self._placer
        self._sum[looks] += seen[looks]
        self._images[looks] += 1
        images = np.maximum(self._images, 1)
        off, sd = self.goal - self._sum / images, placer.camera.noise_x / np.sqrt(images)
        enough, sure = _ENOUGH * placer.tolerance, _SURE * placer.tolerance
        pushed = looks & (np.abs(off) > enough + np.where(sd > sure, 3.0 * sd, 0.0))
        # How far the last pulse forward came says what to ask of the next, within bounds.
        came = np.maximum(self._before - off, 1e-9)
        learned = pushed & (self._before > 0.0)
        self._scale[learned] *= np.clip(self._before / came, 2 / 3, 3 / 2)[learned]
        self._before[pushed] = off[pushed]
        self._sum[pushed] = self._images[pushed] = 0
        self.pulses[pushed] += 1
        wanted = np.where(off > 0.0, self._scale * off, off - _BEHIND * placer.tolerance)
        return looks & ~pushed & (sd <= sure), pushed, wanted[pushed]


@dataclass(frozen=True)
class Placed:
    """Robots that were put to a goal, arrays of shape (n,).

    Attributes
    ----------
    time : numpy.ndarray
        When the camera saw them there, s; NaN: never.
    error : numpy.ndarray
        How far beyond the goal they truly are, m; NaN where the simulation failed.
    pulses : numpy.ndarray
        Single pulses that they had.
    """

    time: Array
    error: Array
    pulses: NDArray[np.int64]

    def within(self, tolerance: float) -> float:
        """Share of the robots that were seen there and are within `tolerance`, m."""
        return float(np.mean(np.isfinite(self.time) & (np.abs(self.error) <= tolerance)))


def _tooth(height: float, steps: int) -> Array:
    """A pulse from half of the peak: a slow fall and a sudden rise, or the reverse below 0."""
    slope = np.arange(1, steps) / (steps - 1)
    along = np.full(steps, 0.5)
    along[:-1] -= abs(height) * (slope if height > 0.0 else slope[::-1])
    return along


def _refuse(reason: str) -> NoReturn:
    raise ScenarioError(f"the robot cannot be placed: {reason}")
