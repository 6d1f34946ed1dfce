"""The function `stickslip.optimise`: the best drive under limits, over uncertain parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from stickslip._util.arrays import Array, worker_count
from stickslip._util.messages import check_kind, check_whole
from stickslip.design.goal import DRAGGED, WALKING, Goal, make_goal
from stickslip.design.optimum import Optimum, SearchInterrupted
from stickslip.design.search import search
from stickslip.design.space import Space, Values, make_space
from stickslip.errors import ScenarioError
from stickslip.scenario.changes import Changes
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.quantities import ASKED
from stickslip.simulation.seen_from_drive import FROM_AXES
from stickslip.simulation.simulate import Progress, check_progress, simulate, simulate_batch

_LEADERS = 24  # that meet other draws; chosen: enough to find one among them that is no luck
# Part of the first population near the start, and how near. Chosen on drawn robots: a waveform has
# too many knots to be found from anywhere.
_NEAR = {"keys": (0.5, 0.15), "knots": (1.0, 0.07)}


def optimise(
    scenario: Scenario,
    *,
    maximise: str | None = None,
    minimise: str | None = None,
    free: Mapping[str, Any] | None = None,
    limits: Mapping[str, float] | None = None,
    at_least: Mapping[str, float] | None = None,
    allow_flight: bool = False,
    allow_pull: bool = False,
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
    """Search for the best drive under limits, over draws of the uncertain parameters.

    Differential evolution (Storn and Price, J. Global Optim. 11, 341, 1997) by SciPy. Candidates
    meet the same draws, but only the first if they exceed a limit there. Those that exceed a limit
    rank behind all others, by how much they do, and those that fail rank last. The best 24 meet
    other draws; of those that exceed a limit in the fewest the best is judged next to the start, on
    fresh ones.

    Parameters
    ----------
    scenario : Scenario
        The start. Without anything uncertain it is its own only draw.
    maximise, minimise : str
        A number of `Run.summary`, or ``velocity_along`` or ``velocity_across`` of the drive's
        heading; one of the two.
    free : mapping, optional
        By key ``(low, high)`` of a number, or a list of words. A positive range of a decade or more
        is searched in its logarithm. Of a velocity along an axis both words of ``drive.direction``
        are tried unless it is here: the robot may be faster backward. With ``drive.frequency`` the
        pulses change too, to at least four, so that drives last about as long as the start.
    limits : mapping, optional
        Greatest value of numbers of the summary, or of ``tilt_max``, the largest abs(theta), rad.
        To limit the field, limit ``field_max`` and not ``drive.peak``, which the field of a fast
        pulse does not reach.
    at_least : mapping, optional
        Least values of such numbers, as ``{"mean_velocity": 1e-3}``.
    allow_flight : bool
        Leaves out the default limits ``airborne_fraction`` 0.2 and ``tilt_max`` 1.5 rad.
    allow_pull : bool
        Leaves out the default limit ``pull_share`` 0.4, for which a simulation takes about twice as
        long. A robot with a mass inside has no such share.
    knots : int, optional
        Makes the drive a periodic voltage program, linear between so many knots of each coil, which
        needs a limit on ``voltage_max``. The search begins at the start, or with free words such as
        ``drive.mode`` at each of these sawtooths. All are measured with their ramp then.
    coils : sequence of str
        Coils of such a program; all others stay without voltage.
    score : str
        How the draws are summed up: ``"q10"``, the 10 % quantile, or another per cent, counted from
        the greatest value of a figure that is minimised; ``"mean"``; ``"worst"``.
    draws, fresh : int
        Draws in the search, and others to judge what it found.
    evaluations : int
        Simulations of the search, at least one generation. A number and not a time, so that a seed
        gives one result.
    seed : int
        Seed of all draws; equal seeds give the same bits for any number of threads.
    threads, progress
        As for `simulate_batch`.

    Returns
    -------
    Optimum

    Raises
    ------
    KeyboardInterrupt
        On Ctrl-C. Its ``best`` is the best Optimum until then, or None.
    ScenarioError
        If something is not allowed, or no drive is within the limits; then it says by how much the
        nearest exceeds them.
    MissingExtra
        If a package of the extra ``optimise`` is missing.
    """
    check_kind("scenario", scenario, Scenario)
    free, limits, at_least = free or {}, limits or {}, at_least or {}
    for name, given in {"free": free, "limits": limits, "at_least": at_least}.items():
        check_kind(name, given, Mapping)
    check_progress(progress)
    no_share = allow_pull or _holds_mass(scenario, free)
    defaults = ({} if allow_flight else WALKING) | ({} if no_share else DRAGGED)
    goal = make_goal(maximise, minimise, score, limits, defaults, at_least)
    named = {goal.figure, *goal.limits, *goal.at_least} & {*ASKED}
    scenario = scenario.replace({ASKED[name]: "yes" for name in named})
    for name, count in {"draws": draws, "fresh": fresh, "evaluations": evaluations}.items():
        check_whole(name, count, 1)
    check_whole("seed", seed)
    either_way = bool(FROM_AXES.keys() & {goal.figure, *at_least})
    space = make_space(scenario, free, knots, coils, limits.get("voltage_max"), either_way)
    streams = [_draw(scenario, n, [seed, k]) for k, n in enumerate((draws, fresh, fresh))]
    threads = worker_count(threads, "threads")
    found = _Search(space, goal, streams, evaluations, seed, threads, progress)
    try:
        return found.run()
    except KeyboardInterrupt:
        best = None if found.best is None else found.optimum()
        raise SearchInterrupted(best) from None


def _holds_mass(scenario: Scenario, free: Mapping[str, Any]) -> bool:
    """Whether there is a mass inside in some run, of which `pull_share` is not known."""
    uncertain = () if scenario.uncertain is None else scenario.uncertain.names
    return scenario.inner.mass > 0.0 or "inner.mass" in {*Changes(free), *uncertain}


def _draw(scenario: Scenario, count: int, seeds: list[int]) -> list[Scenario]:
    """Scenarios without a record; one alone where nothing is uncertain."""
    quiet = scenario.without_record()
    seed = int(np.random.SeedSequence(seeds).generate_state(1)[0])
    return [quiet] if quiet.uncertain is None else quiet.draws(count, seed=seed)


@dataclass(eq=False)
class _Search:
    """The drives that were tried; Ctrl-C leaves what there is.

    `streams` are the draws of the search, those to choose among leaders, and those to judge the
    best. `tried` has a row of `Goal.table` for each drive, with its `values` and `cost`; `best` is
    one of them. `judged` is the table of start and best in fresh draws.
    """

    space: Space
    goal: Goal
    streams: Sequence[Sequence[Scenario]]
    evaluations: int
    seed: int
    threads: int
    progress: Progress | None
    tried: pd.DataFrame = field(default_factory=pd.DataFrame)
    judged: pd.DataFrame = field(default_factory=pd.DataFrame)
    best: pd.Series[Any] | None = None
    runs: int = 0
    done: int = 0
    message: str = ""

    def run(self) -> Optimum:
        """Search, choose among the leaders, and judge the best next to the start."""
        space = self.space
        if space.holds_start:  # which its knots only resemble
            self._try([{}])
        search(
            space.bounds,
            len(space.words),
            space.starts(),
            _NEAR["knots" if space.knots else "keys"],
            costs=lambda points: self._try([space.values(point) for point in points]),
            spent=lambda: self.runs / self.evaluations,
            expected=self.evaluations // len(self.streams[0]),
            seed=self.seed,
        )
        if self.best is None:
            raise ScenarioError(self._reason())
        self.best = self._chosen()
        numbers = self._simulate([{}, self.best["values"]], self.streams[2], "judging")
        self.judged = self.goal.table(numbers).set_axis(["start", "best"])
        return self.optimum()

    def _try(self, drives: Sequence[Values]) -> Array:
        """Costs of drives; one that exceeds a limit in the first draw meets no other."""
        first, *others = self.streams[0]
        numbers = self._simulate(drives, [first], "searching")
        table = self.goal.table(numbers)
        within = [k for k, exceeding in enumerate(table["exceeding"]) if not exceeding]
        if others and within:
            more = self._simulate([drives[k] for k in within], others, "searching")
            whole = self.goal.table(np.concatenate([numbers[within], more], axis=1))
            table.loc[within] = whole.set_axis(within)
        costs = self.goal.costs(table)
        table = table.assign(values=drives, cost=costs)
        self.tried = pd.concat([self.tried, table], ignore_index=True)
        self.runs += int(table["draws"].sum())
        best = self.tried.loc[self.tried["cost"].idxmin()]
        self.best = None if best["exceeding"] else best
        return costs

    def _reason(self) -> str:
        """Why there is no best drive."""
        nearest = self.tried.loc[self.tried["cost"].idxmin()]
        tried = f"{len(self.tried)} drives that were tried"
        if nearest["failed"]:
            return f"each of the {tried} fails in a simulation; of the last: {self.message}"
        exceeded = ", ".join(self.goal.exceeded(nearest))
        return f"limits: none of the {tried} keeps all in every draw; the nearest has {exceeded}"

    def _chosen(self) -> pd.Series[Any]:
        """The leader that exceeds limits in the fewest other draws, and of those the best.

        The best of a search are so by luck, in part, and most of them are at a limit.
        """
        within = self.tried[self.tried["exceeding"] == 0]
        leaders = within.sort_values("cost", kind="stable")[:_LEADERS]
        numbers = self._simulate(list(leaders["values"]), self.streams[1], "judging")
        table = self.goal.table(numbers)
        costs = self.goal.costs(table.assign(excess=0.0))
        return leaders.iloc[np.lexsort([costs, table["exceeding"]])[0]]

    def optimum(self) -> Optimum:
        """The best so far, once a drive was within the limits."""
        assert self.best is not None
        searched = self.best.drop(["values", "cost"]).to_frame("search").T
        scenario = self.space.start.replace(self.space.changes(self.best["values"]))
        asked = {} if scenario.inner.mass > 0.0 else dict.fromkeys(ASKED.values(), "yes")
        return Optimum(
            scenario=scenario,
            start=self.space.start,
            run=simulate(scenario.without_record().replace(asked)),
            table=pd.concat([searched, self.judged]).infer_objects(),
            values=dict(self.best["values"]),
            goal=self.goal,
            runs=self.runs,
            seed=self.seed,
        )

    def _simulate(self, drives: Sequence[Values], draws: Sequence[Scenario], stage: str) -> Array:
        """Numbers of drives in each draw, (drives, draws, 1 + bounds), by one batch."""
        made: list[list[Scenario]] = []
        for values in drives:
            try:
                changes = self.space.changes(values)
                made.append([draw.replace(changes) for draw in draws])
            except ScenarioError as error:  # it fails in every draw
                self.message = str(error)
                made.append([])
        batch = [one for scenarios in made for one in scenarios]
        _, choosing, fresh = self.streams
        expected = self.evaluations + _LEADERS * len(choosing) + 2 * len(fresh)

        def report(fraction: float, _: str) -> None:
            if self.progress is not None:
                self.progress(min((self.done + fraction * len(batch)) / expected, 1.0), stage)

        runs = simulate_batch(batch, self.threads, report)
        report(1.0, stage)  # a short batch ends before its first report
        self.done += len(batch)
        self.message = next((run.message for run in runs if not run.ok), self.message)
        numbers = iter([self.goal.numbers(run) for run in runs])
        lost = [math.nan] * (1 + len(self.goal.bounds))
        return np.array([[next(numbers) if some else lost for _ in draws] for some in made])
