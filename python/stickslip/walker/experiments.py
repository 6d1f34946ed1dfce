"""Drives to measure: those that separate causes before there are data, and models after."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np
import pandas as pd

from stickslip._util.arrays import Array, worker_count
from stickslip._util.messages import check_whole, refuse
from stickslip._util.text import is_number
from stickslip.diagnosis.decision import experiments as design
from stickslip.diagnosis.decision.experiments import TRIALS, Experiment
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.terms.words import Words
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.walker.drives import CHOICES, Drive, choose, proposals
from stickslip.walker.problem import posed_by
from stickslip.walker.reading import Measurement
from stickslip.walker.velocity import VelocityTable

_NOISE = 0.05  # of one trial, relative; as in the measured tables
# Before data. Chosen: the mean is of nine pulses; noise falls no more below half the median speed;
# draws reach as far as data leave the constants; an error that surprises.
_PULSES, _FLOOR, _DRAWS, _WIDTH, _OFF = 12, 0.5, 24, 0.3, 3.0
_STILL = 2e-5  # m/s, a speed that is no walk; as of the paper's statements
_ENOUGH = 0.5  # share of drives, and of draws, that has to be simulated; chosen


def propose_experiments(
    what: Scenario | Diagnosis, count: int = design.PROPOSED, *, noise: float = _NOISE,
    trials: int = TRIALS, seed: int = 0, threads: int | None = None,
) -> pd.DataFrame:  # fmt: skip
    """Propose the drives whose velocities separate causes best.

    After a diagnosis: its leading models. Before data: all causes of a scenario, to first order,
    each of its usual size and as uncertain, with the priors of the uncertain constants.

    Parameters
    ----------
    what : Diagnosis or Scenario
        Of a measurement with velocities; or with a drive near which the robot can be driven.
    count : int
        Drives at most, from 1. Each differs from all others in mode, direction or frequency.
    noise, trials, seed, threads : float, int, int, int
        Of a scenario: relative standard deviation of one trial, trials of each drive, seed of the
        draws of its constants, and simulations at a time.

    Returns
    -------
    DataFrame
        A row for each drive, the best with those before it: settings; `why`; `separation` of two
        causes beyond those rows, in standard errors; and for each model, or the ``stated`` one,
        ``expected_NAME`` and ``sd_NAME`` of the velocity without the noise of a trial, m/s. With a
        column `velocity` `Measurement.with_velocities` takes it. Before data
        ``attrs["confounded"]`` has the pairs of causes within two standard errors by all rows.

    Raises
    ------
    ScenarioError
        If an argument is not allowed, or the robot of a scenario cannot be driven so along x.
    """
    check_whole("count", count, 1)
    if isinstance(what, Diagnosis):
        if (noise, trials, seed, threads) != (_NOISE, TRIALS, 0, None):
            raise ScenarioError("noise, trials, seed, threads: allowed for a Scenario alone")
        found = what.propose_experiments(count)
        return tabulate(found, what.words, cast(Measurement, what.measurement).scenario)
    if not isinstance(what, Scenario):
        refuse("what", what, "a Scenario or a Diagnosis")
    check_whole("trials", trials, 1)
    check_whole("seed", seed)
    if not (is_number(noise) and 0.0 < noise < 1.0):
        refuse("noise", noise, "a number above 0 and below 1")
    if what.drive.kind != "sawtooth":
        refuse("drive.mode", what.drive.mode, "IPP or OPP, whose settings vary")
    short = what.replace({"drive.pulses": min(what.drive.pulses, _PULSES)})
    problem, drives = _posed(short, noise, worker_count(threads, "threads"))
    names, sound, level, covariance, rough = _first_order(problem, drives, seed)
    speed, pairs = np.abs(level[0]), [*itertools.combinations(range(1, len(names)), 2)]
    variance = (noise * np.maximum(speed, _FLOOR * np.median(speed))) ** 2 / trials + rough
    found, chi2 = choose(sound, names, (level, covariance, variance), pairs, count, trials)
    found = [replace(each, predictions={"stated": each.predictions["stated"]}) for each in found]
    table = tabulate(found, Words(problem.words, problem.causes), short)
    confounded = itertools.compress(pairs, chi2 <= design.DECISIVE)
    table.attrs["confounded"] = [(names[first], names[second]) for first, second in confounded]
    return table


def _posed(scenario: Scenario, noise: float, threads: int) -> tuple[Problem, VelocityTable]:
    """The problem of velocities that nobody has read yet, and all drives to choose from."""
    fastest = 1e-3
    for _ in range(2):  # usual errors of an instrument follow the fastest reading
        reading = pd.DataFrame({"velocity": [fastest]})
        data = Measurement.from_dataframe(reading, scenario, velocity_sd=noise)
        problem = posed_by(data, threads)
        table = cast(VelocityTable, problem.tables[0])
        table = table.at_drives([*table.conditions, *proposals(table.conditions)])
        fastest = float(np.max(np.abs(np.nan_to_num(table.physics([], np.zeros((1, 0)))))))
    return problem, table


def _first_order(
    problem: Problem, table: VelocityTable, seed: int
) -> tuple[list[str], Sequence[Drive], Array, Array, Array]:
    """Names of the candidates, the stated model first, drives, levels, covariances, roughness.

    The roughness is the mean squared distance of velocities from a plane over the constants. Left
    out are drives that cannot be simulated with all, and causes that cannot be at most.
    """
    count = len(problem.constants)
    points = np.zeros((_DRAWS + 3 * count + len(problem.causes), problem.size))
    draws, usual = np.split(points, [_DRAWS + 3 * count])
    some = draws[1:, :count]
    some[:] = _WIDTH * np.random.default_rng(seed).standard_normal(some.shape)
    for row, cause in zip(usual, problem.causes, strict=True):
        own = [one.name for one in cause.parameters if one.is_amplitude]
        row[np.isin(problem.names, own)] = 1.0
    values = problem.physical(np.clip(points, *problem.limits))
    made, moved = np.split(table.predict(problem.names, values), [len(draws)])
    possible = np.mean(np.isfinite(made), axis=1) >= _ENOUGH
    level, made = made[0], made[possible]
    plane = np.hstack([np.ones((len(made), 1)), draws[possible, :count]])
    fit = np.linalg.lstsq(plane, np.nan_to_num(made), rcond=None)[0]
    rough = np.sum((made - plane @ fit) ** 2, axis=0) / max(len(plane) - count - 1, 1)
    # A constant as a cause is as large as its prior does not allow.
    moves = np.array([moved[k] - level if cause.frees is None else _OFF * fit[1 + problem.at(cause)]
                      for k, cause in enumerate(problem.causes)])  # fmt: skip
    kept = np.mean(np.isfinite(moves), axis=1) >= _ENOUGH
    names = ["stated", *(cause.name for cause in itertools.compress(problem.causes, kept))]
    moves = np.vstack([np.zeros_like(level), moves[kept]])
    sound = np.flatnonzero(np.isfinite([*moves, level, rough]).all(axis=0))
    if np.mean(possible) < _ENOUGH or not np.median(np.abs(level[sound])) > _STILL:
        raise ScenarioError(
            "the stated scenario stands still, or cannot be simulated, at most of the proposed "
            "drives with constants within a third of their stated errors"
        )
    moves, slopes = moves[:, sound], fit[1:, sound]
    # The size of a cause is as uncertain as it is large.
    covariance = slopes.T @ slopes + moves[:, :, None] * moves[:, None, :]
    drives = [table.conditions[k] for k in sound]
    return names, drives, level[sound] + moves, covariance, rough[sound]


def tabulate(experiments: Sequence[Experiment], words: Words, scenario: Scenario) -> pd.DataFrame:
    """Tabulate settings that vary, or are not the scenario's in some row, and the rest of a row."""
    rows, varied = [], dict.fromkeys(key.removeprefix("drive.") for key in CHOICES)
    for each in experiments:
        varied |= {k: None for k, v in each.drive.items() if v != scenario.get(f"drive.{k}")}
    for each in experiments:
        row = {name: each.drive[name] for name in varied}
        row |= {"why": words.note(each.why), "separation": each.separation**0.5}
        for name, predicted in each.predictions.items():
            row |= {f"expected_{name}": predicted["velocity"], f"sd_{name}": predicted["sd"]}
        rows.append(row)
    return pd.DataFrame(rows)
