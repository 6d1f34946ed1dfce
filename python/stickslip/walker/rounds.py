"""A diagnosis and the experiments that it asks for, in turns, until a name is safe."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from stickslip._util.arrays import Array, numbers
from stickslip._util.messages import check_whole, refuse, shown
from stickslip._util.text import OneLine
from stickslip.diagnosis.decision.experiments import PROPOSED
from stickslip.diagnosis.fitting.search import Progress
from stickslip.diagnosis.result import Diagnosis
from stickslip.scenario.keys import Value
from stickslip.walker.diagnose import diagnose
from stickslip.walker.reading import Measurement

if TYPE_CHECKING:
    from pandas import DataFrame

_Measure = Callable[[dict[str, Value]], ArrayLike]

BUDGET = PROPOSED
"""Experiments that are measured in all if nothing else is said: as many as are proposed."""


@dataclass(frozen=True, repr=False, eq=False)
class Round(OneLine):
    """A verdict before some experiments, and their results.

    Attributes
    ----------
    result : Diagnosis
        The one that asked for them.
    trials : DataFrame
        One row a trial: its settings and its velocity, m/s.
    """

    result: Diagnosis
    trials: DataFrame


def diagnose_in_rounds(
    measurement: Measurement,
    measure: Callable[[dict[str, Value]], ArrayLike],
    *,
    budget: int = BUDGET,
    at_once: int = 1,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> tuple[Diagnosis, list[Round]]:
    """Diagnose, measure what is proposed, and diagnose again, until a name is safe.

    The end comes also when the budget is used up, when no drive that was tried would decide
    anything, and when nothing was measured of what was proposed; `Diagnosis.next_step` of the last
    diagnosis says whether its name is safe.

    Parameters
    ----------
    measurement : Measurement
        With velocities; else nothing is proposed.
    measure : callable
        ``measure(drive)`` is told the settings of ``[drive]`` by bare name, such as
        ``drive["frequency"]``, and returns the velocities of the trials, m/s. None, or NaN, of what
        could not be measured.
    budget : int
        Experiments that may be measured in all, from 0.
    at_once : int
        Experiments that are measured, at most, before the next diagnosis; from 1.
    seed, threads, progress : optional
        As for `diagnose`; the stages say which diagnosis they are of.

    Returns
    -------
    result : Diagnosis
        The last one.
    rounds : list of Round
        One for each time that something was measured.

    Raises
    ------
    ScenarioError
        As for `diagnose`; if an argument is not allowed; if `measure` returns no velocities.
    """
    import pandas as pd

    if not callable(measure):
        refuse("measure", measure, "a function of a drive")
    check_whole("budget", budget)
    check_whole("at_once", at_once, 1)
    rounds: list[Round] = []
    left = budget
    while True:
        report = None if progress is None else _of_round(progress, len(rounds), budget)
        result = diagnose(measurement, seed=seed, threads=threads, progress=report)
        tables = _measured(result, measure, min(at_once, left)) if left > 0 else []
        if not tables:
            break
        trials = pd.concat(tables, ignore_index=True)
        measurement = measurement.with_velocities(trials)
        rounds.append(Round(result, trials))
        left -= len(tables)
    if progress is not None:
        progress(1.0, "done")
    return result, rounds


def _measured(result: Diagnosis, measure: _Measure, count: int) -> list[DataFrame]:
    """A table of trials for each of the drives to measure next that could be measured."""
    tables = []
    for experiment in result.worth_measuring(count):
        velocities = _velocities(measure, dict(experiment.drive))
        if len(velocities):
            trials = result.trial_table([experiment], len(velocities))
            tables.append(trials.assign(velocity=velocities))
    return tables


def _velocities(measure: _Measure, drive: dict[str, Value]) -> Array:
    """Readings at a drive, without gaps."""
    readings = measure(drive)
    what, allowed = f"measure({shown(drive)})", "numbers in m/s, one for each trial"
    velocities = np.atleast_1d(numbers(what, readings, allowed, unit="m/s", gaps=True))
    if velocities.ndim != 1:
        refuse(what, readings, allowed)
    return np.asarray(velocities[~np.isnan(velocities)])


def _of_round(progress: Progress, done: int, budget: int) -> Progress:
    """The progress of one diagnosis among as many as there can be."""

    def report(fraction: float, stage: str) -> None:
        progress((done + fraction) / (budget + 1), f"diagnosis {done + 1}: {stage}")

    return report
