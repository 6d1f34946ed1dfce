"""The function `stickslip.optimise`: the best drive under limits, over uncertain parameters."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
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

LEADERS = 24
"""Best candidates that meet other draws. Chosen: enough to find one among them that is no luck."""


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

    Differential evolution: see `stickslip.design.search`. Every candidate meets the same draws.
    Those that exceed a limit in a draw rank behind all others, by how much they exceed it, and
    those whose simulation fails rank last. The best few meet other draws, and the winner is judged
    next to the start on fresh ones.

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
    defaults = ({} if allow_flight else WALKING) | (
        {} if allow_pull or _holds_mass(scenario, free) else DRAGGED
    )
    goal = make_goal(maximise, minimise, score, limits, defaults, at_least)
    named = {goal.figure, *goal.limits, *goal.at_least} & {*ASKED}
    scenario = scenario.replace({ASKED[name]: "yes" for name in named})
    for name, count in {"draws": draws, "fresh": fresh, "evaluations": evaluations}.items():
        check_whole(name, count, 1)
    check_whole("seed", seed)
    either_way = bool(FROM_AXES.keys() & {goal.figure, *at_least})
    space = make_space(scenario, free, knots, coils, limits.get("voltage_max"), either_way)
    streams = [_draw(scenario, n, [seed, k]) for k, n in enumerate((draws, fresh, fresh))]
    found = _Search(space, goal, streams, worker_count(threads, "threads"), progress)
    try:
        found.search(evaluations, seed)
        found.judge()
    except KeyboardInterrupt:
        raise SearchInterrupted(found.optimum(seed, interrupted=True)) from None
    best = found.optimum(seed, interrupted=False)
    assert best is not None  # or the search has raised
    return best


def _holds_mass(scenario: Scenario, free: Mapping[str, Any]) -> bool:
    """Whether there is a mass inside in some run, of which `pull_share` is not known."""
    uncertain = () if scenario.uncertain is None else scenario.uncertain.names
    return scenario.inner.mass > 0.0 or "inner.mass" in {*Changes(free), *uncertain}


def _draw(scenario: Scenario, count: int, seeds: list[int]) -> list[Scenario]:
    """Scenarios without a record; one alone where nothing is uncertain."""
    quiet = scenario.without_record()
    if quiet.uncertain is None:
        return [quiet]
    return quiet.draws(count, seed=int(np.random.SeedSequence(seeds).generate_state(1)[0]))


class _Search:
    """The best drive so far; Ctrl-C leaves what there is.

    `best` is its row of `Goal.table` in the draws of the search, with its `values` and `cost`.
    """

    def __init__(
        self,
        space: Space,
        goal: Goal,
        streams: Sequence[Sequence[Scenario]],
        threads: int,
        progress: Progress | None,
    ) -> None:
        self._space, self._goal, self._threads, self._progress = space, goal, threads, progress
        self._searching, self._choosing, self._fresh = streams
        self._begin, self._done, self._expected = time.perf_counter(), 0, 1
        self._message, self._runs = "", 0  # of a simulation that failed; those of the search
        self._tried = pd.DataFrame()
        self._judged = pd.DataFrame()  # of start and best, in fresh draws
        self.best: pd.Series[Any] | None = None

    def search(self, evaluations: int, seed: int) -> None:
        """Try drives, and keep those that were tried."""
        space, goal, draws = self._space, self._goal, self._searching
        self._expected = evaluations + LEADERS * len(self._choosing) + 2 * len(self._fresh)

        def costs(points: Array) -> Array:
            return self._try([space.values(point) for point in points])

        if space.knots:  # the start itself, which its knots only resemble
            self._try([{}])
        points = evaluations // len(draws)
        spent = lambda: self._runs / evaluations  # noqa: E731
        search(space.bounds, len(space.words), space.starts(), costs, spent, points, seed)
        if self.best is None:
            nearest = self._tried.loc[self._tried["cost"].idxmin()]
            tried = f"{len(self._tried)} drives that were tried"
            if nearest["failed"]:
                raise ScenarioError(
                    f"a simulation fails of all {tried}; of the last: {self._message}"
                )
            raise ScenarioError(
                f"limits: none of the {tried} is within all in every draw; the nearest has "
                + ", ".join(goal.exceeded(nearest))
            )

    def _try(self, drives: Sequence[Values]) -> Array:
        """Costs of drives; one that exceeds a limit in the first draw meets no other."""
        first, *others = self._searching
        numbers = self._simulate(drives, [first], "searching")
        table = self._goal.table(numbers)
        within = np.flatnonzero(table["exceeding"] == 0)
        if others and len(within):
            more = self._simulate([drives[k] for k in within], others, "searching")
            whole = self._goal.table(np.concatenate([numbers[within], more], axis=1))
            table.loc[within] = whole.set_axis(within)
        costs = self._goal.costs(table)
        tried = table.assign(values=drives, cost=costs)
        self._tried = pd.concat([self._tried, tried], ignore_index=True)
        self._runs = int(self._tried["draws"].sum())
        best = self._tried.loc[self._tried["cost"].idxmin()]
        self.best = None if best["exceeding"] else best
        return costs

    def judge(self) -> None:
        """Choose among the leaders in draws of their own, and judge the best in others.

        The best of a search are so by luck, in part, and most of them are at a limit.
        """
        within = self._tried[self._tried["exceeding"] == 0]
        leaders = within.sort_values("cost", kind="stable")[:LEADERS]
        numbers = self._simulate(list(leaders["values"]), self._choosing, "judging")
        table = self._goal.table(numbers)
        costs = self._goal.costs(table.assign(excess=0.0))
        self.best = leaders.iloc[np.lexsort([costs, table["exceeding"]])[0]]
        numbers = self._simulate([{}, self.best["values"]], self._fresh, "judging")
        self._judged = self._goal.table(numbers).set_axis(["start", "best"])

    def optimum(self, seed: int, interrupted: bool) -> Optimum | None:
        """The best so far; None before a drive was within the limits."""
        if self.best is None:
            return None
        of_search = self.best.drop(["values", "cost"]).to_frame("search").T
        scenario = self._space.start.replace(self._space.changes(self.best["values"]))
        asked = {} if scenario.inner.mass > 0.0 else dict.fromkeys(ASKED.values(), "yes")
        return Optimum(
            scenario=scenario,
            start=self._space.start,
            run=simulate(scenario.without_record().replace(asked)),
            table=pd.concat([of_search, self._judged]).infer_objects(),
            values=dict(self.best["values"]),
            goal=self._goal,
            runs=self._runs,
            seed=seed,
            interrupted=interrupted,
            seconds=time.perf_counter() - self._begin,
        )

    def _simulate(self, drives: Sequence[Values], draws: Sequence[Scenario], stage: str) -> Array:
        """Numbers of drives in each draw, (drives, draws, 1 + bounds), by one batch."""
        made: list[list[Scenario]] = []
        for values in drives:
            try:
                changes = self._space.changes(values)
                made.append([draw.replace(changes) for draw in draws])
            except ScenarioError as error:  # it fails in every draw
                self._message = str(error)
                made.append([])
        batch = [one for scenarios in made for one in scenarios]

        def report(fraction: float, _: str) -> None:
            if self._progress is not None:
                done = self._done + fraction * len(batch)
                self._progress(min(done / self._expected, 1.0), stage)

        runs = simulate_batch(batch, self._threads, report)
        report(1.0, stage)  # a short batch ends before its first report
        self._done += len(batch)
        self._message = next((run.message for run in runs if not run.ok), self._message)
        numbers = iter([self._goal.numbers(run) for run in runs])
        lost = [math.nan] * (1 + len(self._goal.bounds))
        return np.array([[next(numbers) if some else lost for _ in draws] for some in made])
