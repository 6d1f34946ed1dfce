"""The goal of an optimisation: a figure of the summary over draws, under limits on others."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from stickslip._util import units
from stickslip._util.arrays import Array
from stickslip._util.messages import refuse, shown, suggestion
from stickslip._util.text import is_number
from stickslip.errors import ScenarioError
from stickslip.simulation.quantities import NUMBERS, Column
from stickslip.simulation.run import Run
from stickslip.simulation.seen_from_drive import VELOCITIES

FIGURES = {**NUMBERS, **VELOCITIES, "tilt_max": Column("rad", "largest |theta|, measuring window")}
"""Figures that can be a goal or have a limit: numbers of a summary, `Run.velocity`, the pitch."""

WALKING = {"airborne_fraction": 0.2, "tilt_max": 1.5}
"""Default limits: a robot that hops or stands on end does not walk. Chosen: at the paper's drives
up to a fifth of the time is flight; 1.5 rad is just short of upright."""

DRAGGED = {"pull_share": 0.4}
"""Default limit: a robot that is dragged does not walk either; the note ``dragged`` has it too.
Chosen: of random drives of 40 robots, once more without the gradient, 18 of 38 with 0.3 to 0.4 keep
half of their velocity, 10 of 44 with 0.4 to 0.6, and 3 of 97 beyond. The first example has 0.29,
and what slides at constant speed mu_k/mu_s."""

_UNITS_OF_SIZES = ("T", "A", "V", "W", "s")
_SIZES = {
    *(name for name, column in FIGURES.items() if column.unit in _UNITS_OF_SIZES),
    "airborne_fraction", "pull_ratio", "tilt_max", "turning_speed",
}  # fmt: skip
"""Figures that are never below 0."""

# Costs of an excess of the limit's size, and of a draw that fails: far apart, of finite squares.
_EXCEEDING, _FAILED = 1e60, 1e120


@dataclass(frozen=True)
class Goal:
    """Figure, score and limits by which drives are compared.

    `sign` is 1 of a figure that is maximised, else -1. `score` is what of the draws counts: "q10"
    for the 10 % quantile, counted from the bad side, "mean" or "worst". `limits` has the greatest
    value that is allowed of other figures, in every draw, SI units; `assumed` names those that
    nobody gave. `at_least` has the least values.
    """

    figure: str
    sign: float
    score: str
    limits: Mapping[str, float]
    assumed: tuple[str, ...] = ()
    at_least: Mapping[str, float] = field(default_factory=dict)

    @property
    def bounds(self) -> dict[str, tuple[str, float, float]]:
        """Both by column of `table`: the figure, 1 or for a least value -1, and the value."""
        most = {name: (name, 1.0, value) for name, value in self.limits.items()}
        least = {f"{name}_least": (name, -1.0, value) for name, value in self.at_least.items()}
        return most | least

    @property
    def unit(self) -> str:
        """SI unit of the figure."""
        return FIGURES[self.figure].unit

    def numbers(self, run: Run) -> list[float]:
        """The figure of a run and those that have a limit; NaN of one that failed."""
        if not run.ok:
            return [math.nan] * (1 + len(self.bounds))
        numbers = {**run.numbers, **dict(zip(VELOCITIES, run.velocity, strict=True))}
        numbers["tilt_max"] = max(-numbers["theta_min"], numbers["theta_max"])
        names = (self.figure, *(name for name, _, _ in self.bounds.values()))
        return [float(numbers[name]) for name in names]

    def table(self, numbers: Array) -> pd.DataFrame:
        """Tabulate drives by their numbers in each draw, shape (drives, draws, 1 + bounds).

        `exceeding` draws fail or exceed a limit, `failed` ones fail; `excess` is by how much limits
        are exceeded, relative to them and summed. The columns of `bounds` have the worst values.
        """
        bounds = self.bounds
        limits = np.array([sign * limit for _, sign, limit in bounds.values()])
        signs = np.array([sign for _, sign, _ in bounds.values()])
        good, limited = self.sign * numbers[..., 0], signs * numbers[..., 1:]
        if self.score == "mean":
            score = good.mean(axis=1)
        else:
            share = 0.0 if self.score == "worst" else int(self.score[1:]) / 100.0
            score = np.quantile(good, share, axis=1)
        worst = limited.max(axis=1)
        lost = ~np.isfinite(numbers).all(axis=-1)
        excess = np.maximum(worst - limits, 0.0) / np.where(limits == 0.0, 1.0, np.abs(limits))
        return pd.DataFrame(
            {
                "score": self.sign * score,
                "mean": self.sign * good.mean(axis=1),
                "worst": self.sign * good.min(axis=1),
                "draws": numbers.shape[1],
                "exceeding": (lost | (limited > limits).any(axis=-1)).sum(axis=1),
                "failed": lost.sum(axis=1),
                "excess": excess.sum(axis=1),
                **dict(zip(bounds, (signs * worst).T, strict=True)),
            }
        )

    def costs(self, table: pd.DataFrame) -> Array:
        """Return a cost of each drive, by failures, then the excess over limits, then the score."""
        score = -self.sign * table["score"]
        exceeding = np.where(table["excess"] > 0.0, _EXCEEDING * table["excess"], score)
        costs: Array = np.where(table["failed"] > 0, _FAILED * table["failed"], exceeding)
        return costs

    def next_to_limit(self, column: str, value: float) -> str:
        """A figure that has a limit, with the limit."""
        name, sign, limit = self.bounds[column]
        unit = units.unit_label(FIGURES[name].unit)
        of = "of" if sign > 0.0 else "of at least"
        text = f"{name} {value:.6g} {of} {limit:.6g} {unit}".rstrip()
        kind = "pull" if column in DRAGGED else "flight"
        removed = f", default (--allow-{kind} or allow_{kind}=True removes it)"
        return text + removed * (column in self.assumed)

    def exceeded(self, worst: Mapping[str, float]) -> list[str]:
        """The worst values that exceed their limits, each with its limit."""
        return [
            self.next_to_limit(column, worst[column])
            for column, (_, sign, limit) in self.bounds.items()
            if not sign * worst[column] <= sign * limit
        ]


def make_goal(
    maximise: str | None,
    minimise: str | None,
    score: str,
    limits: Mapping[str, float],
    defaults: Mapping[str, float],
    at_least: Mapping[str, float] | None = None,
) -> Goal:
    """Check all and make the goal; `defaults` are limits on what `limits` does not name."""
    figure = maximise if minimise is None else minimise
    if figure is None or (maximise is not None and minimise is not None):
        raise ScenarioError("allowed is either maximise or minimise, with a figure of the summary")
    at_least = at_least or {}
    for name in (figure, *limits, *at_least):
        if name not in FIGURES:
            hint = suggestion(str(name), FIGURES)
            raise ScenarioError(f"figure {shown(name)}: no number of a summary; {hint}")
    for name, limit in (*limits.items(), *at_least.items()):
        if not is_number(limit) or not math.isfinite(limit):
            refuse(f"limit on {name}", limit, "a finite number")
        if limits.get(name, 0.0) < 0.0 and name in _SIZES:
            refuse(f"limit on {name}", limits[name], "a number from 0, as it is never below")
    for name in at_least.keys() & limits.keys():
        if at_least[name] > limits[name]:
            refuse(f"at least {name}", at_least[name], f"at most its limit, {limits[name]:g}")
    if not isinstance(score, str) or not re.fullmatch(r"q[1-9]\d?|mean|worst", score):
        refuse("score", score, '"q10" or another of "q1" to "q99", "mean", "worst"')
    assumed = {k: v for k, v in defaults.items() if k not in limits}
    sign = 1.0 if minimise is None else -1.0
    return Goal(figure, sign, score, {**limits, **assumed}, tuple(assumed), at_least)
