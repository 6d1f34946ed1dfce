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
from stickslip.design.goal import DRAGGED, WALKING, Goal, best_first, made_goal
from stickslip.design.optimum import ABOUT, COMPARED, Optimum, SearchInterrupted
from stickslip.design.sawtooth import POINTS, NoSawtooth, sawtooths
from stickslip.design.search import search
from stickslip.design.space import WAY, Space, Values, made_space
from stickslip.errors import ScenarioError
from stickslip.scenario.changes import Changes
from stickslip.scenario.keys import find_key
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.quantities import ASKED
from stickslip.simulation.seen_from_drive import FROM_AXES, VELOCITIES
from stickslip.simulation.simulate import Progress, check_progress, simulate, simulate_batch

LEADERS = 24
"""Best candidates that meet other draws. Chosen: enough to find one among them that is no luck."""

OFFSETS = (-0.2, -0.1, -0.05, -0.02, 0.02, 0.05, 0.1, 0.2)
"""Steps from the best drive, in parts of a range; chosen: from a good setting to a bad one."""

NEAR, LOSS, RISE = 0.05, 0.1, 0.01
"""Within the part `NEAR` of a range (as well as a lab repeats a setting) a peak loses more than the
part `LOSS` of the score, and what is held by a limit gains more than `RISE` beyond it. All
chosen."""

_MOST_MOVES = 4  # chosen: each costs a whole landscape


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

    CMA-ES (Hansen, arXiv:1604.00772) by ranks alone. Every candidate meets the same draws. Those
    that pass a limit in a draw rank behind all others, by how much they pass it, and those whose
    simulation fails rank last. The best is judged on fresh draws beside the start and the best
    sawtooth of a grid. If the sawtooth is better there, it is the result, and so is a better
    neighbour, a step along one number.

    Parameters
    ----------
    scenario : Scenario
        The start. Without anything uncertain it is its own only draw.
    maximise, minimise : str
        A number of `Run.summary`, or ``velocity_along`` or ``velocity_across`` of the drive's
        heading; one of the two.
    free : mapping, optional
        By key ``(low, high)`` of a number, or a list of words, each combination of which is a
        restart. A positive range of a decade or more is searched in its logarithm. Of a velocity
        along an axis both words of ``drive.direction`` are tried unless it is here: the robot may
        be faster backward. With
        ``drive.frequency`` the pulses change too, to at least four, so that drives last about as
        long as the start.
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
        needs a limit on ``voltage_max``. It is measured over all of its time, and so are start and
        sawtooth then.
    coils : sequence of str
        Coils of such a program; all others stay without voltage.
    score : str
        How the draws are summed up: ``"q10"``, the 10 % quantile, or another per cent, counted from
        the greatest value of a figure that is minimised; ``"mean"``; ``"worst"``.
    draws, fresh : int
        Draws in the search, and others to judge what it found.
    evaluations : int
        Simulations of the search. A number and not a time, so that a seed gives one result.
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
        nearest passes them.
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
    goal = made_goal(maximise, minimise, score, limits, defaults, at_least)
    named = {goal.figure, *goal.limits, *goal.at_least} & {*ASKED}
    scenario = scenario.replace({ASKED[name]: "yes" for name in named})
    for name, count in {"draws": draws, "fresh": fresh, "evaluations": evaluations}.items():
        check_whole(name, count, 1)
    check_whole("seed", seed)
    either_way = bool(FROM_AXES.keys() & {goal.figure, *at_least})
    space = made_space(scenario, free, knots, coils, limits.get("voltage_max"), either_way)
    streams = [_drawn(scenario, n, [seed, k]) for k, n in enumerate((draws, fresh, fresh, ABOUT))]
    design = _Design(space, goal, streams, worker_count(threads, "threads"), progress)
    try:
        leaders = design.search(evaluations, seed)
        design.compare(leaders)
        design.climb()
    except KeyboardInterrupt:
        raise SearchInterrupted(design.optimum(seed, interrupted=True)) from None
    best = design.optimum(seed, interrupted=False)
    assert best is not None  # or the search has raised
    return best


def _holds_mass(scenario: Scenario, free: Mapping[str, Any]) -> bool:
    """Whether there is a mass inside in some run, of which `pull_share` is not known."""
    uncertain = () if scenario.uncertain is None else scenario.uncertain.names
    return scenario.inner.mass > 0.0 or "inner.mass" in {*Changes(free), *uncertain}


def _at_middle(scenario: Scenario) -> Scenario:
    """With uncertain keys at the middle of their priors, where a scenario has all of these."""
    priors = {} if scenario.uncertain is None else scenario.uncertain.priors
    try:
        return scenario.replace({key: float(prior.value(0.0)) for key, prior in priors.items()})
    except ScenarioError:
        return scenario


def _drawn(scenario: Scenario, count: int, seeds: list[int]) -> list[Scenario]:
    """Scenarios without a record; one alone where nothing is uncertain."""
    quiet = scenario.without_record()
    if quiet.uncertain is None:
        return [quiet]
    return quiet.draws(count, seed=int(np.random.SeedSequence(seeds).generate_state(1)[0]))


class _Design:
    """The best drive so far, and what it is compared with; Ctrl-C leaves what there is.

    `best` is its row of `Goal.table` in the draws of the search, with its `values`. `compared` has
    the numbers of drives in fresh draws, (draws, 1 + bounds), by name.
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
        self._searching, self._choosing, self._fresh, self._about = streams
        self._begin, self._done, self._expected = time.perf_counter(), 0, 1
        self._message = ""  # of a simulation that failed
        self.best: pd.Series[Any] | None = None
        self.compared: dict[str, Array] = {}
        self.sawtooth: Values | None = None
        self.landscape: list[dict[str, Any]] = []
        self.origin, self.moves, self.runs, self.other_way = "search", 0, 0, 0.0
        self.no_sawtooth = "it was interrupted"
        self.ended, self.agreeing = 0, 0

    def search(self, evaluations: int, seed: int) -> pd.DataFrame:
        """The leaders within the limits: rows of a table in the draws of the search."""
        space, goal = self._space, self._goal
        self._expected = evaluations + POINTS * (1 + len(self._searching))
        self._expected += 2 * LEADERS * len(self._choosing)
        self._expected += len(space.ranges) * len(OFFSETS) * len(self._about)
        tables: list[pd.DataFrame] = []
        least: tuple[float, ...] = (math.inf,)

        def evaluate(rows: Array) -> Array:
            nonlocal least
            table = self._judged([space.values(*row) for row in rows.tolist()], "searching")
            keys = goal.keys(table)
            tables.append(table)
            self.runs += len(table) * len(self._searching)
            first = best_first(keys)[0]
            if not table["exceeding"][first] and tuple(keys[first]) < least:
                least, self.best = tuple(keys[first]), table.loc[first]
            return keys

        budget = max(1, evaluations // len(self._searching))
        centres = search(space.starts(), evaluate, budget, seed)
        table = pd.concat(tables, ignore_index=True)
        order = best_first(goal.keys(table))
        if self.best is None:
            nearest, tried = table.loc[order[0]], f"{len(table)} drives that were tried"
            if nearest["failed"]:
                raise ScenarioError(
                    f"a simulation fails of all {tried}; of the last: {self._message}"
                )
            raise ScenarioError(
                f"limits: none of the {tried} is within all in every draw; the nearest has "
                + ", ".join(goal.passed(nearest))
            )
        # The best are so by luck, in part; the centres are less.
        ends = range(len(table) - centres, len(table))
        leading, within = [*order[:LEADERS], *ends], table.loc[ends].query("exceeding == 0")
        lost = np.abs(within["score"] - self.best["score"])
        self.ended = centres
        self.agreeing = int((lost <= RISE * abs(self.best["score"])).sum())
        leaders = pd.concat([table.loc[leading], *self._turned(table)], ignore_index=True)
        return leaders.query("exceeding == 0")

    def _turned(self, table: pd.DataFrame) -> list[pd.DataFrame]:
        """The fastest drive the wrong way, turned round, where it is faster than the best."""
        if self._goal.figure not in {*FROM_AXES, *VELOCITIES} or self.best is None:
            return []
        back = -self._goal.sign * table.query("exceeding == 0")["mean"]
        self.other_way = max(0.0, float(back.max()))
        ways = {arm[WAY] for arm in self._space.arms if WAY in arm}
        if len(ways) < 2 or self.other_way <= self._goal.sign * self.best["mean"]:
            return []
        values = table["values"][back.idxmax()]
        (other,) = ways - {values[WAY]}
        self.runs += len(self._searching)
        turned = self._judged([{**values, WAY: other}], "searching")
        self.other_way *= bool(turned["exceeding"][0])
        return [turned]

    def compare(self, leaders: pd.DataFrame) -> None:
        """Choose among the leaders in draws of their own, and judge the best in others."""
        self.best = self._chosen(leaders)
        drives: dict[str, Values] = {"start": {}, "best": self.best["values"]}
        sawtooth = None
        try:
            sawtooth = self._best_sawtooth()
            self.sawtooth, drives["sawtooth"] = sawtooth["sawtooth"], sawtooth["values"]
        except NoSawtooth as reason:
            self.no_sawtooth = str(reason)
        numbers = self._judge(list(drives.values()), self._fresh, "fresh draws")
        self.compared = dict(zip(drives, numbers, strict=True))
        best = self.compared["best"]
        if sawtooth is not None and self._is_better(self.compared["sawtooth"], best):
            self.best, self.origin = sawtooth, "sawtooth"
            self.compared |= {"search": best, "best": self.compared["sawtooth"]}

    def climb(self) -> None:
        """Look at the neighbours, and go to the best as long as it is better on fresh draws too."""
        assert self.best is not None
        while self._space.ranges.keys() <= self.best["values"].keys():
            drives = [self.best["values"], *neighbours(self._space, self.best["values"])]
            table = self._goal.table(self._judge(drives, self._about, "landscape"))
            self.landscape = landscape(self._space, self._goal, drives, table)
            gain = self._goal.sign * (table["score"] - table["score"][0])
            better = gain[(table["exceeding"] == 0) & (gain > 0.0)]
            if better.empty or self.moves == _MOST_MOVES:
                return
            values = drives[int(better.idxmax())]
            row = self._judged([values], "landscape").loc[0]
            new = self._judge([values], self._fresh, "landscape")[0]
            if row["exceeding"] or not self._is_better(new, self.compared["best"]):
                return
            self.best, self.landscape = row, []
            self.compared = {"search": self.compared["best"], **self.compared, "best": new}
            self.moves += 1

    def optimum(self, seed: int, interrupted: bool) -> Optimum | None:
        """The best so far; None before a drive was within the limits."""
        if self.best is None:
            return None
        fresh = {name: self.compared[name] for name in COMPARED if name in self.compared}
        table = pd.DataFrame()
        if fresh:
            table = self._goal.table(np.array(list(fresh.values()))).set_axis(list(fresh))
        scenario = self._space.start.replace(self._space.changes(self.best["values"]))
        asked = {} if scenario.inner.mass > 0.0 else dict.fromkeys(ASKED.values(), "yes")
        return Optimum(
            scenario=scenario,
            start=self._space.start,
            run=simulate(_at_middle(scenario.without_record().replace(asked))),
            table=table,
            fresh=pd.DataFrame({name: scores[:, 0] for name, scores in fresh.items()}),
            search=self.best.drop(["values", "sawtooth"], errors="ignore"),
            values=dict(self.best["values"]),
            sawtooth=None if self.sawtooth is None else dict(self.sawtooth),
            no_sawtooth=self.no_sawtooth if self.sawtooth is None else "",
            landscape=pd.DataFrame(self.landscape),
            goal=self._goal,
            other_way=self.other_way,
            origin=self.origin,
            moves=self.moves,
            ended=self.ended,
            agreeing=self.agreeing,
            runs=self.runs,
            seed=seed,
            interrupted=interrupted,
            seconds=time.perf_counter() - self._begin,
        )

    def _judge(self, drives: Sequence[Values], draws: Sequence[Scenario], stage: str) -> Array:
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

    def _judged(self, drives: Sequence[Values], stage: str) -> pd.DataFrame:
        """The table of drives in the draws of the search, with their values."""
        return self._goal.table(self._judge(drives, self._searching, stage)).assign(values=drives)

    def _best_sawtooth(self) -> pd.Series[Any]:
        """Raises NoSawtooth where there is none to compare with, or none satisfies the limits."""
        space, goal, draws = self._space, self._goal, self._searching

        def probe(drives: Sequence[Values], draw: int) -> Array:
            return self._judge(drives, [draws[draw]], "sawtooths")[:, 0]

        of_start = self._judge([{}], draws, "sawtooths")[0]
        shapes = sawtooths(space, goal, of_start, probe)
        free = space.values(0, *space.starts()[0])
        drives = (
            shapes if space.knots else [{k: one.get(k, free[k]) for k in free} for one in shapes]
        )
        table = self._judged(drives, "sawtooths").assign(sawtooth=shapes)
        leaders = table.loc[best_first(goal.keys(table))[:LEADERS]].query("exceeding == 0")
        if leaders.empty:
            raise NoSawtooth("none of the grid is within the limits in every draw")
        return self._chosen(leaders)

    def _chosen(self, leaders: pd.DataFrame) -> pd.Series[Any]:
        numbers = self._judge(list(leaders["values"]), self._choosing, "choosing")
        keys = self._goal.keys(self._goal.table(numbers), limited=False)
        return leaders.iloc[best_first(keys)[0]]

    def _is_better(self, one: Array, other: Array) -> bool:
        keys = self._goal.keys(self._goal.table(np.stack([one, other])), limited=False)
        return bool(tuple(keys[0]) < tuple(keys[1]))


def neighbours(space: Space, values: Values) -> list[Values]:
    """Drives that differ in one number, within its range."""
    others: list[Values] = []
    for name in space.ranges:
        coordinate = space.coordinate(name, float(values[name]))
        for other in dict.fromkeys(np.clip(coordinate + np.array(OFFSETS), 0.0, 1.0).tolist()):
            if other != coordinate:
                others.append({**values, name: space.number(name, other)})
    return others


def landscape(
    space: Space, goal: Goal, drives: Sequence[Values], table: pd.DataFrame
) -> list[dict[str, Any]]:
    """The score along each free number: of the best drive, the first, and its neighbours.

    A number is at a limit if it is at an end of its range, or if more than `RISE` is gained within
    `NEAR` where a limit does not hold; else on a peak, if more than `LOSS` is lost.
    """
    rows = []
    for name in space.ranges:
        values = pd.Series([float(drive[name]) for drive in drives])
        along = table.assign(value=values)[(values != values[0]) | (values.index == 0)]
        along = along.sort_values("value")
        coordinate = space.coordinate(name, values[0])
        away = np.array([space.coordinate(name, value) for value in along["value"]]) - coordinate
        near = along[np.abs(away) <= NEAR * (1.0 + 1e-9)]  # but for rounding
        score = table["score"][0]
        lost = goal.sign * (score - near["score"]) / (abs(score) or 1.0)
        loss = float(lost.fillna(math.inf).max())
        end = "low" if coordinate < 0.01 else "high" if coordinate > 0.99 else ""
        limited = end or bool((lost < -RISE)[near["exceeding"] > 0].any())
        rows.append(
            {
                "name": name,
                "unit": "V" if " " in name else find_key(name).unit,
                "best": values[0],
                "kind": "at a limit" if limited else "peak" if loss > LOSS else "plateau",
                "loss": loss,
                "at_end": end,
                "values": along["value"].tolist(),
                "scores": along["score"].tolist(),
                "feasible": (along["exceeding"] == 0).tolist(),
            }
        )
    return rows
