"""Many runs of the reference problem in heyoka's batch mode.

Stick, slip and flight are three integrators of a batch each. A run has a lane in that of its mode.
`propagate_until` steps all lanes of one integrator until a terminal event stops one of them or all
have reached the end of their stretch; lanes that did not stop go on from where they are. A run that
has changed its mode leaves its lane to the next that waits for it. The fullest integrator goes
first, so that few lanes are empty.
"""

from __future__ import annotations

import math
from collections import deque

from peers.corner import STICK, Mode, State, force_law, next_mode, tipping_time
from peers.heyoka_peer import UNITS, Compiled
from peers.problem import PULSES, Problem, mean_velocity


class Run:
    """One run, from event to event."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem.scaled(**UNITS)
        self._body = self._problem.body
        self._at, self.tau = tipping_time(self._problem)
        self.mode: Mode = STICK
        self.state = State(self._body.half_length, 0.0, 0.0, 0.0, 0.0, 0.0)
        self._path: list[float] = []
        self._enter_stretch()

    def _enter_stretch(self) -> None:
        segment = self._problem.segments[self._at]
        self.length = segment.end - segment.start
        self.currents = segment.current.ravel().tolist()
        self._law = force_law(self._problem, segment)

    def end_stretch(self) -> None:
        """Goes on to the next stretch, if there is one."""
        a, b = self._body.half_length, self._body.half_height
        theta = self.state.theta
        self._path.append(self.state.px - a * math.cos(theta) + b * math.sin(theta))
        self._at += 1
        if not self.is_over:
            self.tau = 0.0
            self._enter_stretch()

    def meet(self, event: str) -> None:
        """Changes mode and state at an event."""
        self.mode, self.state = next_mode(self._body, self._law, self.tau, self.state, event)

    @property
    def is_over(self) -> bool:
        return self._at == len(self._problem.segments)

    def velocity(self) -> float:
        """Mean velocity of the centre of mass, m/s."""
        found = mean_velocity(self._problem, self._path[-PULSES:])
        return found * UNITS["time"] / UNITS["length"]


class Lanes:
    """heyoka's integrator of one mode, and the runs in that mode."""

    def __init__(self, kind: str, compiled: Compiled) -> None:
        self._kind, self._compiled = kind, compiled
        self._integrator = getattr(compiled, kind)
        self._events = compiled.events[kind]
        self._state, self._pars = self._integrator.state, self._integrator.pars  # views
        self._runs: list[Run | None] = [None] * self._integrator.batch_size
        self._waiting: deque[Run] = deque()
        self._times = self._integrator.time.tolist()
        self._limits = list(self._times)
        self.count = 0

    def add(self, run: Run) -> None:
        self._waiting.append(run)
        self.count += 1

    def advance(self) -> list[Run]:
        """Steps all lanes until one stops; the runs that are over or have left this mode."""
        integrator, runs = self._integrator, self._runs
        for lane, run in enumerate(runs):
            if run is None and self._waiting:
                runs[lane] = self._waiting.popleft()
                self._write(lane, runs[lane])
        integrator.set_time(self._times)
        self._compiled.propagate(integrator, self._limits)
        self._times = integrator.time.tolist()
        left = []
        for lane, event in self._stops():
            run = runs[lane]
            run.tau = self._times[lane]
            run.state = Compiled.state(run.mode, run.state, self._state[:, lane].tolist())
            if event is None:
                run.end_stretch()
            else:
                run.meet(self._events[event])
            if run.mode.kind == self._kind and not run.is_over:
                self._write(lane, run)
            else:
                left.append(run)
                runs[lane], self._limits[lane] = None, self._times[lane]
        self.count -= len(left)
        return left

    def _stops(self) -> list[tuple[int, int | None]]:
        """Lanes that have stopped, and the number of the event, or None at a stretch's end."""
        stopped: list[tuple[int, int | None]] = list(self._integrator.stopped)
        self._integrator.stopped.clear()
        by_event = {lane for lane, _ in stopped}
        for lane, run in enumerate(self._runs):
            if run is not None and self._times[lane] >= run.length and lane not in by_event:
                stopped.append((lane, None))
        return stopped

    def _write(self, lane: int, run: Run) -> None:
        self._state[:, lane] = Compiled.values(run.mode, run.state)
        pars = self._pars
        pars[:, lane] = Compiled.parameters(run.mode, run.state, run.currents)[: len(pars)]
        self._integrator.reset_cooldowns(lane)
        self._times[lane], self._limits[lane] = run.tau, run.length


def simulate(problems: list[Problem], compiled: Compiled) -> list[float]:
    """Mean velocities of the centres of mass, m/s."""
    runs = [Run(problem) for problem in problems]
    modes = {kind: Lanes(kind, compiled) for kind in compiled.events}
    for run in runs:
        modes[run.mode.kind].add(run)
    going = len(runs)
    while going:
        fullest = max(modes.values(), key=lambda lanes: lanes.count)
        for run in fullest.advance():
            if run.is_over:
                going -= 1
            else:
                modes[run.mode.kind].add(run)
    return [run.velocity() for run in runs]
