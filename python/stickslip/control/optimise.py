"""The drive that walks best under limits, robust to what is uncertain."""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.processor_count import worker_count
from stickslip.control.design_space import DesignSpace, design_space
from stickslip.control.goal import FIGURES, Changes, Goal, Judged, judge_all, made_goal
from stickslip.control.landscape import ABOUT, OFFSETS, Slice, slices
from stickslip.control.optimum import Optimum, SearchInterrupted
from stickslip.control.sawtooth import POINTS, played, sawtooths
from stickslip.control.search import LEADERS, Candidate, Key, search
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import RECORD_RATE, Value, check_kind, check_whole
from stickslip.scenario.scenario import Scenario

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

VOLTAGE = "voltage_max"
"""The figure whose limit is the range of a free waveform's knots."""

_SEARCHING, _CHOOSING, _FRESH, _LANDSCAPE = range(4)  # streams of draws of one seed


def optimise(
    scenario: Scenario,
    *,
    maximise: str | None = None,
    minimise: str | None = None,
    free: Mapping[str, Any] | None = None,
    limits: Mapping[str, float] | None = None,
    knots: int | None = None,
    coils: Sequence[str] = ("xp", "clamp"),
    score: str = "q10",
    draws: int = 8,
    fresh: int = 64,
    evaluations: int = 10_000,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Optimum:
    """Look for the drive that is best under limits, over draws of what is uncertain.

    CMA-ES (Hansen, arXiv:1604.00772) by ranks alone. Every candidate meets the same draws of
    ``scenario.uncertain``. A limit has to hold in every draw: candidates that pass one rank behind
    all that do not, by how much they pass it, and those whose simulation fails rank last. The best
    is judged on fresh draws beside the start and the best sawtooth of a grid.

    The peak of a drive is the field that its voltage would have if it were held for ever. A coil
    lets little of a fast pulse through, so the field at the robot is smaller: where a field is to
    be limited, limit ``field_max``, not `drive.peak`.

    Parameters
    ----------
    scenario : Scenario
        The start. Without anything uncertain it is its own only draw.
    maximise, minimise : str
        Name of a number of `Run.summary`; one of the two. ``mean_velocity`` is along x: at a
        heading name ``velocity_along`` or ``velocity_across``, which `Run.velocity` has.
    free : mapping, optional
        By key ``(low, high)`` of a number, or a list of words; each combination of words is a
        restart. A positive range of a decade or more is searched in its logarithm. Where
        ``drive.frequency`` is free, the pulses change with it, so that all drives last as long as
        the start, but at least four pulses.
    limits : mapping, optional
        Greatest value of numbers of the summary, SI.
    knots : int, optional
        Makes the drive a periodic voltage program, linear between so many knots of each coil, with
        the frequency, pulses and ramp of the scenario. It needs a limit on ``voltage_max``, and is
        measured over all of it, as every program is; the start and the sawtooths are then too.
    coils : sequence of str
        Coils that such a program drives; all others stay without voltage.
    score : str
        What of the draws counts: ``"q10"``, the 10 % quantile, or another per cent; ``"mean"``;
        ``"worst"``. Of a figure that is minimised it is counted from the greatest value.
    draws, fresh : int
        Draws in the search, and others to judge what it found.
    evaluations : int
        Simulations of the search. A number and not a time, so that a seed gives one result.
    seed : int
        Of all draws; the same gives the same bits on any number of threads.
    threads, progress
        As for `simulate_batch`.

    Returns
    -------
    Optimum
        The best drive that was found.

    Raises
    ------
    KeyboardInterrupt
        On Ctrl-C in the search. Its ``best`` is the best Optimum until then, or None if no drive
        was within the limits.
    ScenarioError
        If something is not allowed, or no drive satisfies the limits; then the least value that was
        found is named.
    MissingExtra
        If the package ``cma`` is missing.
    """
    begin = time.perf_counter()
    check_kind("scenario", scenario, Scenario)
    limits = limits or {}
    goal = made_goal(maximise, minimise, score, limits)
    for name, count in {"draws": draws, "fresh": fresh, "evaluations": evaluations}.items():
        check_whole(name, count, 1)
    check_whole("seed", seed)
    space = design_space(scenario, free or {}, knots, coils, limits.get(VOLTAGE))
    drawn = _draws(scenario, draws, seed, _SEARCHING)
    trials = _Trials(space, goal, drawn, worker_count(threads, "threads"), progress)
    trials.expect(evaluations, fresh)
    starts = [space.start(arm) for arm in range(len(space.arms))]
    try:
        found = search(starts, trials.compared, max(1, evaluations // len(drawn)), seed)
    except KeyboardInterrupt:
        raise SearchInterrupted(None) from None
    leaders = [each for each in found.leaders + found.centres if each.known.feasible]
    if not leaders:
        if found.interrupted:
            raise SearchInterrupted(None)
        raise ScenarioError(trials.unmet())
    chosen = _Selection(trials, leaders, found.interrupted)
    chosen.judge(fresh, seed)
    arm, point = chosen.leader.arm, chosen.leader.point
    best = Optimum(
        scenario=scenario.replace(space.changes(arm, point)),
        start=scenario,
        values=space.values(arm, point),
        space=space,
        goal=goal,
        judged=chosen.leader.known,
        fresh=chosen.fresh,
        sawtooth=chosen.sawtooth,
        slices=chosen.slices,
        draws=len(drawn),
        runs=trials.runs,
        seed=seed,
        interrupted=chosen.interrupted,
        seconds=time.perf_counter() - begin,
    )
    if best.interrupted:
        raise SearchInterrupted(best)
    return best


class _Trials:
    """Candidates that are simulated, and the best of them."""

    def __init__(
        self,
        space: DesignSpace,
        goal: Goal,
        draws: Sequence[Scenario],
        threads: int,
        progress: Progress | None,
    ) -> None:
        self.space, self.goal, self.draws, self.threads = space, goal, draws, threads
        self.nearest: Judged | None = None
        self.least = dict.fromkeys(goal.limits, math.inf)
        self.message = ""
        self.runs = 0  # of the search
        self._progress = progress
        self._done, self._total = 0, 1

    def expect(self, evaluations: int, fresh: int) -> None:
        """Count what is to be done, for `progress`."""
        self._total = evaluations + 2 * POINTS * len(self.draws)
        if self.space.scenario.uncertain is not None:
            self._total += 2 * LEADERS * fresh + len(self.space.axes) * len(OFFSETS) * ABOUT

    def compared(self, candidates: Sequence[tuple[int, Array]]) -> list[tuple[Key, Judged]]:
        """Candidates of the search, as `search.Evaluate` has them."""
        changes = [self.space.changes_or_error(arm, point) for arm, point in candidates]
        judged = self.judged(changes, self.draws, "searching")
        sign = self.goal.sign
        self.runs += len(candidates) * len(self.draws)
        for each in judged:
            if self.nearest is None or each.rank(sign) < self.nearest.rank(sign):
                self.nearest = each
            self.message = each.message or self.message
            for name, value in each.worst.items():
                if value < self.least[name]:
                    self.least[name] = value
        return [(each.rank(sign), each) for each in judged]

    def judged(
        self, drives: Sequence[Changes], draws: Sequence[Scenario], stage: str
    ) -> list[Judged]:
        """Drives in some draws, in one batch."""
        count = len(drives) * len(draws)

        def report(fraction: float, _: str) -> None:
            if self._progress is not None:
                self._progress(min((self._done + fraction * count) / self._total, 1.0), stage)

        result = judge_all(self.goal, draws, drives, self.threads, report)
        self._done += count
        return result

    def unmet(self) -> str:
        """Why no candidate counts, in one line."""
        tried = f"{self.runs // len(self.draws)} drives that were tried"
        assert self.nearest is not None
        if self.nearest.failed:
            return f"a simulation fails of all {tried}; of the last: {self.message}"
        for name, limit in self.goal.limits.items():
            if self.least[name] > limit:
                return (
                    f"limit {name} = {limit:g} {FIGURES[name].unit}: none of the {tried} stays "
                    f"within it in every draw; the least value found is {self.least[name]:.6g}"
                )
        nearest = ", ".join(f"{name} = {value:.6g}" for name, value in self.nearest.worst.items())
        return f"limits: none of the {tried} satisfies all in every draw; the nearest has {nearest}"


class _Selection:
    """The candidate that is taken, and what it is compared with.

    The best of a search is the best in its draws, in part by luck. So the leaders meet draws of
    their own, and what is best there is judged in others again. Ctrl-C leaves what there is.
    """

    def __init__(
        self, trials: _Trials, leaders: Sequence[Candidate[Judged]], interrupted: bool
    ) -> None:
        self.leader = leaders[0]
        self.interrupted = interrupted
        self.sawtooth: dict[str, Value] | None = None
        self.slices: list[Slice] = []
        self.fresh: dict[str, Judged] = {}
        self._trials, self._leaders = trials, leaders

    def judge(self, fresh: int, seed: int) -> None:
        trials, space = self._trials, self._trials.space
        try:
            choosing = _draws(space.scenario, fresh, seed, _CHOOSING)
            changes = [space.changes(each.arm, each.point) for each in self._leaders]
            place = self._best(changes, choosing)
            self.leader = self._leaders[place]
            if not self.interrupted:
                self.sawtooth = self._best_sawtooth(choosing)
                about = _draws(space.scenario, ABOUT, seed, _LANDSCAPE)
                judged = functools.partial(trials.judged, draws=about, stage="landscape")
                self.slices = slices(space, self.leader, trials.goal.sign, judged)
            compared: dict[str, Any] = {"start": played(space, {}), "best": changes[place]}
            if self.sawtooth is not None:
                compared["sawtooth"] = played(space, self.sawtooth)
            others = _draws(space.scenario, fresh, seed, _FRESH)
            found = trials.judged(list(compared.values()), others, "fresh draws")
            self.fresh = dict(zip(compared, found, strict=True))
        except KeyboardInterrupt:
            self.interrupted = True

    def _best(self, drives: Sequence[Changes], draws: Sequence[Scenario]) -> int:
        judged = self._trials.judged(drives, draws, "choosing")
        # What passes a limit in no draw of the search may pass it in one of many others: that is
        # told, and costs it nothing here, or a drive at its limit would lose to any far from it.
        sign = self._trials.goal.sign
        ranks = [(each.failed, -sign * each.score if not each.failed else 0.0) for each in judged]
        return ranks.index(min(ranks))

    def _best_sawtooth(self, choosing: Sequence[Scenario]) -> dict[str, Value] | None:
        """None where the drive is a program, or no sawtooth satisfies the limits."""
        trials, space = self._trials, self._trials.space
        if space.scenario.drive.mode == "program":
            return None
        evaluate = functools.partial(trials.judged, draws=trials.draws, stage="sawtooths")
        points = sawtooths(space, trials.goal, evaluate)
        drives = [played(space, each) for each in points]
        judged = evaluate(drives)
        ranks = [each.rank(trials.goal.sign) for each in judged]
        order = sorted(range(len(points)), key=lambda place: ranks[place])[: len(self._leaders)]
        leading = [place for place in order if judged[place].feasible]
        if not leading:
            return None
        return points[leading[self._best([drives[place] for place in leading], choosing)]]


def _draws(scenario: Scenario, count: int, seed: int, stream: int) -> list[Scenario]:
    """Scenarios without a record; one alone where nothing is uncertain."""
    quiet = scenario.replace({RECORD_RATE: "none"})
    if scenario.uncertain is None:
        return [quiet]
    return quiet.draws(count, seed=int(np.random.SeedSequence([seed, stream]).generate_state(1)[0]))
