"""The drive that walks best under limits, robust to what is uncertain."""

from __future__ import annotations

import functools
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util.numbers import Array, worker_count
from stickslip.design.design_space import DesignSpace, design_space
from stickslip.design.goal import Changes, Goal, Judged, judge_all, made_goal
from stickslip.design.landscape import ABOUT, OFFSETS, Slice, slices
from stickslip.design.optimum import Optimum, Origin, SearchInterrupted
from stickslip.design.sawtooth import POINTS, played, sawtooths
from stickslip.design.search import LEADERS, Candidate, Key, search
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import RECORD_RATE, Value, check_kind, check_whole
from stickslip.scenario.scenario import Scenario

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

VOLTAGE = "voltage_max"
"""The figure whose limit is the range of a free waveform's knots."""

MOST_MOVES = 4
"""Neighbours that are taken one after another at most; chosen: each costs a whole landscape."""

_SEARCHING, _CHOOSING, _FRESH, _LANDSCAPE = range(4)  # streams of draws of one seed


def optimise(
    scenario: Scenario,
    *,
    maximise: str | None = None,
    minimise: str | None = None,
    free: Mapping[str, Any] | None = None,
    limits: Mapping[str, float] | None = None,
    allow_flight: bool = False,
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
    is judged on fresh draws beside the start and the best sawtooth of a grid; if the sawtooth is
    better there, it is the result. So is a neighbour, a step along one number, that is better.

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
        Greatest value of numbers of the summary, SI; or of ``tilt_max``, the largest abs(theta).
    allow_flight : bool
        By default a drive has to walk: ``airborne_fraction`` up to 0.2 and ``tilt_max`` up to 1.5
        rad, where `limits` has no other value. True leaves these two out.
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
        If something is not allowed, or no drive satisfies the limits; then it says by how much the
        nearest passes them.
    MissingExtra
        If the package ``cma`` is missing.
    """
    begin = time.perf_counter()
    check_kind("scenario", scenario, Scenario)
    limits = limits or {}
    goal = made_goal(maximise, minimise, score, limits, walking=not allow_flight)
    for name, count in {"draws": draws, "fresh": fresh, "evaluations": evaluations}.items():
        check_whole(name, count, 1)
    check_whole("seed", seed)
    space = design_space(scenario, free or {}, knots, coils, limits.get(VOLTAGE))
    drawn = _draws(scenario, draws, seed, _SEARCHING)
    trials = _Trials(space, goal, drawn, worker_count(threads, "threads"), progress)
    trials.expect(evaluations, fresh)
    if progress is not None:
        progress(0.0, "starting")
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
    changes = chosen.best.changes
    assert not isinstance(changes, ScenarioError)  # it was simulated
    best = Optimum(
        scenario=scenario.replace(changes),
        start=scenario,
        values=chosen.best.values,
        space=space,
        goal=goal,
        origin=chosen.origin,
        moves=chosen.moves,
        judged=chosen.best.known,
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
        passed = ", ".join(self.goal.passed(self.nearest.worst))
        return f"limits: none of the {tried} is within all in every draw; the nearest has {passed}"


class _Selection:
    """The drive that is taken, and what it is compared with.

    The best of a search is the best in its draws, in part by luck. So the leaders meet draws of
    their own, and what is best there is judged in others again, beside the best sawtooth; of the
    two the better is taken, and a neighbour of it that is better still. Ctrl-C leaves what there
    is.
    """

    def __init__(
        self, trials: _Trials, leaders: Sequence[Candidate[Judged]], interrupted: bool
    ) -> None:
        self._trials = trials
        self._leaders = [_Drive.of(trials.space, each) for each in leaders]
        self.best = self._leaders[0]
        self.origin: Origin = "search"
        self.moves = 0
        self.interrupted = interrupted
        self.sawtooth: dict[str, Value] | None = None
        self.slices: list[Slice] = []
        self.fresh: dict[str, Judged] = {}

    def judge(self, fresh: int, seed: int) -> None:
        trials, space = self._trials, self._trials.space
        try:
            choosing = _draws(space.scenario, fresh, seed, _CHOOSING)
            self.best = self._chosen(self._leaders, choosing)
            drives: dict[str, Changes] = {"start": played(space, {}), "best": self.best.changes}
            found = None if self.interrupted else self._best_sawtooth(choosing)
            if found is not None:
                self.sawtooth = found.values
                drives["sawtooth"] = found.changes
            others = _draws(space.scenario, fresh, seed, _FRESH)
            judged = trials.judged(list(drives.values()), others, "fresh draws")
            self.fresh = dict(zip(drives, judged, strict=True))
            search, sawtooth = self.fresh["best"], self.fresh.get("sawtooth")
            if found and sawtooth and self._order(sawtooth) < self._order(search):
                self.best, self.origin = found, "sawtooth"
                self.fresh.update(search=search, best=sawtooth)
            if not self.interrupted:
                self._climb(others, _draws(space.scenario, ABOUT, seed, _LANDSCAPE))
        except KeyboardInterrupt:
            self.interrupted = True

    def _climb(self, fresh: Sequence[Scenario], about: Sequence[Scenario]) -> None:
        """Look at the neighbours, and go to the best as long as it is better on fresh draws too."""
        trials, space, sign = self._trials, self._trials.space, self._trials.goal.sign
        judged = functools.partial(trials.judged, draws=about, stage="landscape")
        while self.best.place is not None:
            arm, point = self.best.place
            self.slices, better = slices(space, arm, point, sign, judged)
            if better is None or self.moves == MOST_MOVES:
                return
            changes = space.changes(arm, better)
            known, new = (judged([changes], draws=each)[0] for each in (trials.draws, fresh))
            if not known.feasible or self._order(new) >= self._order(self.fresh["best"]):
                return
            self.best = _Drive(space.values(arm, better), changes, known, (arm, better))
            self.fresh = {"search": self.fresh["best"], **self.fresh, "best": new}
            self.slices = []  # those of the drive before
            self.moves += 1

    def _order(self, judged: Judged) -> tuple[float, float]:
        # What passes a limit in no draw of the search may pass it in one of many others: that is
        # told, and costs it nothing here, or a drive at its limit would lose to any far from it.
        failed = judged.failed
        return failed, 0.0 if failed else -self._trials.goal.sign * judged.score

    def _chosen(self, drives: Sequence[_Drive], draws: Sequence[Scenario]) -> _Drive:
        judged = self._trials.judged([each.changes for each in drives], draws, "choosing")
        order = [self._order(each) for each in judged]
        return drives[order.index(min(order))]

    def _best_sawtooth(self, choosing: Sequence[Scenario]) -> _Drive | None:
        """None where the drive is a program, or no sawtooth satisfies the limits."""
        trials, space = self._trials, self._trials.space
        if space.scenario.drive.mode == "program":
            return None
        evaluate = functools.partial(trials.judged, draws=trials.draws, stage="sawtooths")
        values = sawtooths(space, trials.goal, evaluate)
        places = [None if space.periodic else space.place(each) for each in values]
        changes = [
            played(space, each) if place is None else space.changes_or_error(*place)
            for each, place in zip(values, places, strict=True)
        ]
        judged = evaluate(changes)
        made = map(_Drive, values, changes, judged, places)
        drives = sorted(made, key=lambda each: each.known.rank(trials.goal.sign))[:LEADERS]
        leading = [each for each in drives if each.known.feasible]
        return self._chosen(leading, choosing) if leading else None


@dataclass(frozen=True)
class _Drive:
    """A drive that may be taken: by names, as changes, in the search's draws, and in the space."""

    values: dict[str, Value]
    changes: Changes
    known: Judged
    place: tuple[int, Array] | None  # arm and point; None of a sawtooth beside a free waveform

    @staticmethod
    def of(space: DesignSpace, found: Candidate[Judged]) -> _Drive:
        place = found.arm, found.point
        return _Drive(space.values(*place), space.changes(*place), found.known, place)


def _draws(scenario: Scenario, count: int, seed: int, stream: int) -> list[Scenario]:
    """Scenarios without a record; one alone where nothing is uncertain."""
    quiet = scenario.replace({RECORD_RATE: "none"})
    if scenario.uncertain is None:
        return [quiet]
    return quiet.draws(count, seed=int(np.random.SeedSequence([seed, stream]).generate_state(1)[0]))
