"""What a drive is judged by: a figure of the summary over draws, under limits on other figures."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util import units
from stickslip._util.numbers import Array
from stickslip._util.text import is_number
from stickslip.design.search import Key
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import refuse, shown, suggestion
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.columns import NUMBERS, Column
from stickslip.simulation.seen_from_drive import VELOCITIES
from stickslip.simulation.simulate import simulate_batch

if TYPE_CHECKING:
    from stickslip.simulation.run import Run
    from stickslip.simulation.simulate import Progress

Changes = Mapping[str, Any] | ScenarioError
"""A drive, given by its changes of a scenario; or the error which says that they make none."""

Evaluate = Callable[[Sequence[Changes]], Sequence["Judged"]]
"""Drives that are judged in one batch."""

_TILT = Column("rad", "largest |theta|, measuring window")
FIGURES = {**NUMBERS, **VELOCITIES, "tilt_max": _TILT}
"""What can be a goal or have a limit: numbers of a summary, `Run.velocity`, the tilt either way."""

WALKING = {"airborne_fraction": 0.2, "tilt_max": 1.5}
"""Default limits: a robot that hops or stands on end does not walk. Chosen: at the paper's drives
up to a fifth of the time is flight; 1.5 rad is just short of upright."""

_QUANTILE = re.compile(r"q([1-9]\d?)")


@dataclass(frozen=True)
class Goal:
    """What is best.

    Attributes
    ----------
    figure : str
        Name of a number of the summary.
    sign : {1.0, -1.0}
        Of a figure that is maximised, or minimised.
    score : str
        What of the draws counts: ``"q10"`` for the 10 % quantile and other whole per cents,
        ``"mean"`` or ``"worst"``. Of a figure that is minimised the quantile is counted from its
        greatest value, so that the score is always on the bad side.
    limits : dict of float
        Greatest value that is allowed of a number of the summary, in every draw, by its name.
    assumed : tuple of str
        Figures whose limit nobody gave: it is that of ``WALKING``.
    """

    figure: str
    sign: float
    score: str
    limits: Mapping[str, float]
    assumed: tuple[str, ...] = ()

    @property
    def unit(self) -> str:
        """SI unit of the figure."""
        return FIGURES[self.figure].unit

    def beside_limit(self, name: str, value: float) -> str:
        """A figure that has a limit, beside it."""
        unit = units.unit_label(FIGURES[name].unit)
        shown = f"{name} {value:.6g} of {self.limits[name]:.6g} {unit}".rstrip()
        return shown + (", default (--allow-flight removes it)" if name in self.assumed else "")

    def passed(self, worst: Mapping[str, float]) -> list[str]:
        """The greatest values that pass their limits, each beside it."""
        return [self.beside_limit(k, v) for k, v in worst.items() if not v <= self.limits[k]]

    def scored(self, values: Array) -> Array:
        """Scores of figures, shape (..., draws) to (...), in the figure's unit; NaN where a draw
        has none."""
        good = self.sign * values
        if self.score == "mean":
            return np.asarray(self.sign * good.mean(axis=-1))
        share = 0.0 if self.score == "worst" else int(self.score[1:]) / 100.0
        return np.asarray(self.sign * np.quantile(good, share, axis=-1))

    def excess(self, worst: Mapping[str, float]) -> float:
        """By how much the greatest values pass the limits, relative to them, summed."""
        return sum(
            max(worst[name] - limit, 0.0) / (abs(limit) or 1.0)
            for name, limit in self.limits.items()
        )


@dataclass(frozen=True)
class Judged:
    """One drive in several draws.

    Attributes
    ----------
    figures : numpy.ndarray, shape (draws,)
        The goal's figure; NaN where the simulation failed.
    score : float
        NaN if one failed.
    worst : dict of float
        Greatest value of each figure that has a limit; NaN if a simulation failed.
    exceeding : int
        Draws that failed or pass a limit.
    excess : float
        See `Goal.excess`.
    failed : int
        Draws whose simulation failed.
    message : str
        Of the first that failed.
    """

    figures: Array
    score: float
    worst: dict[str, float]
    exceeding: int
    excess: float
    failed: int
    message: str = ""

    @property
    def feasible(self) -> bool:
        """Whether every draw came to its end within all limits."""
        return self.exceeding == 0

    def rank(self, sign: float) -> Key:
        """What it is sorted by: failures, then what passes the limits, then the score."""
        if self.failed:
            return (float(self.failed), 0.0, 0.0)
        return (0.0, self.excess, 0.0 if self.excess else -sign * self.score)


def _figures(run: Run) -> dict[str, Any]:
    found = run.numbers
    tilt = max(-found["theta_min"], found["theta_max"])
    return {**found, **dict(zip(VELOCITIES, run.velocity, strict=True)), "tilt_max": tilt}


def judge(goal: Goal, runs: Sequence[Run]) -> Judged:
    """One drive by its runs, one a draw."""
    summaries = [_figures(run) if run.ok else {} for run in runs]
    numbers = {
        name: np.array([summary.get(name, math.nan) for summary in summaries])
        for name in (goal.figure, *goal.limits)
    }
    figures = numbers[goal.figure]
    limited = {name: numbers[name] for name in goal.limits}
    worst = {name: float(values.max()) for name, values in limited.items()}
    within = np.isfinite(figures)
    for name, values in limited.items():
        within &= values <= goal.limits[name]
    failed = int(np.sum(~np.isfinite(figures)))
    message = next((r.message for r in runs if not r.ok), "")
    return Judged(
        figures=figures,
        score=float(goal.scored(figures)),
        worst=worst,
        exceeding=int(np.sum(~within)),
        excess=math.nan if failed else goal.excess(worst),
        failed=failed,
        message=message,
    )


def judge_all(
    goal: Goal,
    draws: Sequence[Scenario],
    drives: Sequence[Changes],
    threads: int,
    progress: Progress | None = None,
) -> list[Judged]:
    """Drives in some draws, in one batch; one that makes no scenario has failed in every draw."""
    made: list[list[Scenario] | str] = []
    for each in drives:
        try:
            if isinstance(each, ScenarioError):
                raise each
            made.append([draw.replace(each) for draw in draws])
        except ScenarioError as error:
            made.append(str(error))
    batch = [one for each in made if not isinstance(each, str) for one in each]
    runs = iter(simulate_batch(batch, threads, progress))
    nothing = np.full(len(draws), np.nan)
    lost = dict.fromkeys(goal.limits, math.nan)
    count = len(draws)
    return [
        Judged(nothing, math.nan, lost, count, math.nan, count, each)
        if isinstance(each, str)
        else judge(goal, [next(runs) for _ in each])
        for each in made
    ]


def made_goal(
    maximise: str | None,
    minimise: str | None,
    score: str,
    limits: Mapping[str, float],
    walking: bool = False,
) -> Goal:
    """The goal, once all is checked; a robot that has to walk has the limits of `WALKING` too."""
    if (maximise is None) == (minimise is None):
        raise ScenarioError("allowed is either maximise or minimise, with a figure of the summary")
    figure = maximise if minimise is None else minimise
    for name in (figure, *limits):
        if name not in FIGURES:
            raise ScenarioError(
                f"figure {shown(name)}: there is no such number in a summary; "
                f"{suggestion(str(name), FIGURES)}"
            )
    for name, limit in limits.items():
        if not is_number(limit) or not math.isfinite(limit):
            refuse(f"limit on {name}", limit, "a finite number")
    if not isinstance(score, str) or not (score in ("mean", "worst") or _QUANTILE.fullmatch(score)):
        refuse("score", score, '"q10" or another of "q1" to "q99", "mean", "worst"')
    assert figure is not None
    assumed = {k: v for k, v in WALKING.items() if walking and k not in limits}
    sign = 1.0 if minimise is None else -1.0
    return Goal(figure, sign, score, {**limits, **assumed}, tuple(assumed))
